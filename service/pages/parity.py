"""What a recording in service tells: how it agrees with the calibration, what would have been seen, what never is."""

from dataclasses import dataclass
from typing import Any

from service.measures import in_words, number
from service.words.fit import FitWords

COMMON = (
    "a bias common to all that some acceleration explains, all axes turned together, all scales by one factor, "
    "and any stretch or shear of the space"
)
ONE_ORIENTATION = (
    "The recording turns too little to tell a change of bias from one of scale or axis: record slow turns as well."
)


@dataclass(frozen=True)
class SightRow:
    """From what size a change of one sensor would have been seen."""

    name: str
    share: str
    limits: tuple[str, str, str]
    """Of bias, scale and axis."""


@dataclass(frozen=True)
class ParityView:
    """What parity sees of a block."""

    level: str
    rows: tuple[SightRow, ...]


def parity_view(document: dict[str, Any]) -> ParityView:
    """The table of `imu-parity/1`."""
    kind = document["kind"]
    rows = tuple(
        SightRow(
            sensor["name"],
            f"{100 * sensor['visible_share']:.0f} %",
            (_limit(kind, "bias", sensor), _limit(kind, "scale", sensor), _limit(kind, "axis", sensor)),
        )
        for sensor in document["sensors"]
    )
    return ParityView(f"{100 * document['false_alarm']:g} %", rows)


def _limit(kind: str, parameter: str, sensor: dict[str, Any]) -> str:
    size = sensor[parameter]["detectable"]
    return "not seen" if size is None else in_words(kind, parameter, size)


def parity_in_words(document: dict[str, Any]) -> FitWords:
    """How the recording agrees with the calibration, and what to be careful of."""
    chance = "less than 0.01" if document["p_value"] < 1e-4 else number(100 * document["p_value"], 1)
    headline = "agree with one another as they did at the calibration"
    if document["detected"]:
        headline = "do not agree with one another as they did at the calibration"
    detail = (
        f"χ² = {number(document['chi2'], 1)} for {document['dof']} numbers; an unchanged block gives this much or more "
        f"in {chance} % of recordings."
    )
    return FitWords(f"The sensors {headline}.", detail, tuple(_warnings(document)))


def _warnings(document: dict[str, Any]) -> list[str]:
    can = 4 * len(document["sensors"])
    found = [f"Parity sees {document['dof']} of {can} numbers that can change. It never sees {COMMON}."]
    if not document["complete"]:
        found.append(ONE_ORIENTATION)
    left = [f"{count} {_why(why, document)}" for why, count in document["left_out"].items() if count]
    if left:
        found.append(f"Left out of {document['blocks']} blocks: {', '.join(left)}.")
    return found


def _why(reason: str, document: dict[str, Any]) -> str:
    if reason == "saturated":
        return f"in which {', '.join(document['saturated'])} stood at the end of the range"
    return "in which the block moved, because its sensors do not sit in one point"
