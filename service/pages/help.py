"""The pages that explain the service.

What a word means is what `docs/glossary.md` says first, to the letter; a test holds the two together.
"""

from dataclasses import dataclass

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse

from service.pages.reference import reference_page
from service.pages.settings import settings_page
from service.sessions.states import RecordState
from service.sessions.words.states import MEANINGS, STATES
from service.web.dependencies import SettingsOf
from service.web.render import render

WORDS = (
    ("unit", "one IMU, known by its serial number"),
    ("unit type", "what units share: nominal axes, tolerances, longest calibration interval"),
    ("lot", "units of one production"),
    ("block", "the sensors of a unit that are mounted together and calibrated together"),
    ("session", "one file, one block, one day: the rows, what was set and who measured"),
    ("position", "one still setting of the block: an angle β on the stand, or an orientation"),
    ("stand, head", "the two-axis stand; its part that turns by β"),
    ("input axis", "the direction in which a sensor answers; it differs a little from the nominal one"),
    ("reference", "the session that the others of its epoch are judged against: the first by time measured, or the one "
     "that an engineer chose"),
    ("epoch", "the time between two services"),
    ("deviation", "the change of a parameter since the reference; of a scale factor relative, of an axis an angle"),
    ("tolerance", "the largest deviation allowed"),
    ("margin", "1 − (\\|y\\| + U)/T: 1 is spotless, 0 the edge of a pass"),
    ("residual", "measured minus modelled, at the input"),
    ("cause", "one physical effect that the baseline lacks: cubic term, eccentric angle scale, exchanged rows"),
    ("baseline", "the model with K, b, c and e of every sensor and the stand's stated random errors, and nothing else"),
    ("flag", "a matter that somebody must look after, from raised to resolved"),
    ("drift", "a steady change of a parameter; a *step* is a sudden one"),
    ("risk", "the chance that any parameter of the unit is out of tolerance by a date"),
    ("due", "the date of the next calibration"),
)  # fmt: skip
"""Term and meaning."""
MEASURES = (
    ("µg, mg", "of accelerometers' bias: a millionth and a thousandth of standard gravity, 9.80665 m/s²"),
    ("ppm, %", "of scale factors: parts in a million, in a hundred"),
    ("arcsec", "of axes: a 3600th of a degree, 4.85 µrad"),
    ("°/h, °/s", "of gyros' bias: degrees an hour, a second"),
    ("µg/g²", "of quadratic terms: µg at one g, growing with the square"),
    ("per g, per °/s", "of scale factors: reading units (V, counts, pulses) for one g, for one degree a second"),
    ("± U", "expanded uncertainty: the true value lies within it in about 95 of 100 cases"),
)
"""Measure, and what is read in it."""
WHEN = (
    ("A unit is to be measured",
     "Ask on the page Ready whether it is warm and still enough; while it is measured, the page Missing says which "
     "positions are still to come."),
    ("A unit is unfit",
     "Do not use it. Adjust or repair it, record the service on its page, and measure it again: the next session is "
     "its new reference."),
    ("A unit is probably unfit, or probably fit",
     "Its worst parameter lies nearer to the tolerance than the measurement can tell. Measure it once more, at more "
     "positions: the page Plan says how many."),
    ("A session is undecided",
     "It did not see what it should, or not well enough; its first sentence says which. Repeat it as the page Plan "
     "proposes."),
    ("A verdict is said with a reservation",
     "Something that was found about the session speaks against it. Read what, and do what it advises before you "
     "rely on the verdict."),
    ("A session is questioned",
     "It cannot be as its file says: a wrong unit, sign, channel or clock. Correct the file, or let an engineer accept "
     "it with a reason. Until then it counts for nothing."),
    ("A file is refused",
     "Nothing was stored. Every problem is listed with its place and what to do: correct the file and send it again."),
    ("The wrong file was uploaded",
     "An engineer withdraws the session on its page. It stays readable, and nothing rests on it any more."),
    ("A unit is overdue",
     "Measure it, or take it out of use: the chance that it is out of tolerance grows."),
    ("A stand says: check before use",
     "All units that were measured on it moved together, or a diagnosis found it at fault. Check stand and fixture; "
     "then an engineer resolves its flags."),
    ("A stand's certificate has expired",
     "Traceability of sessions since then is interrupted. Have the stand calibrated, or record its new certificate on "
     "its page."),
    ("A flag is open",
     "An engineer acknowledges it, with a name and why, does what it asks for, and resolves it. The unit's page shows "
     "its life."),
)  # fmt: skip
"""What one meets, and what to do."""

KEYS = (
    (("/",), "to the field that searches the list"),
    (("j", "k"), "to the next or the previous row, session or flag"),
    (("Enter",), "opens the row"),
    (("x",), "ticks the flag"),
    (("?",), "this page"),
)
"""Keys, and what each does."""


def plainly(meaning: str) -> str:
    """Without the marks that the glossary is set with."""
    return meaning.replace("\\|", "|").replace("*", "")


COUNTS = "It counts: what is known of its unit rests on it."
"""Of an accepted record, where others say what they are not."""


@dataclass(frozen=True)
class HelpPage:
    """Everything the page of help shows, each as a word and what it means."""

    when: tuple[tuple[str, str], ...]
    states: tuple[tuple[str, str], ...]
    measures: tuple[tuple[str, str], ...]
    words: tuple[tuple[str, str], ...]
    keys: tuple[tuple[tuple[str, ...], str], ...]
    """Keys, and what they do."""


def help_page() -> HelpPage:
    """It is the same for everybody."""
    states = tuple((STATES[state], MEANINGS[state] or COUNTS) for state in RecordState)
    return HelpPage(WHEN, states, MEASURES, tuple((word, plainly(meaning)) for word, meaning in WORDS), KEYS)


router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/help")
def show_help(request: Request) -> HTMLResponse:
    """What to do when, and what the words mean."""
    return render(request, "help.html", help_page())


@router.get("/api-reference")
def show_reference(request: Request) -> HTMLResponse:
    """Every call of the API."""
    return render(request, "reference.html", reference_page(request.app.openapi()))


@router.get("/settings")
def show_settings(request: Request, settings: SettingsOf) -> HTMLResponse:
    """What is in force, and where it comes from."""
    return render(request, "settings.html", settings_page(settings))
