"""A learned term is read as an equation in people's measures."""

from dataclasses import replace
from math import radians

from estimator.groups.results import EmpiricalTerm, GroupGain
from service.groups.words import gain_in_words, term_view

ARCSEC = radians(1) / 3600
TERM = EmpiricalTerm(
    equation="",
    words=("δβ: sin 3β", "δβ: cos 3β", "δα: (t − t̄)"),
    sensors=(),
    subject="ODG-1",
    amplitude=(0.86 * ARCSEC, 0.04 * ARCSEC, 2 * ARCSEC),
    sigma=(0.08 * ARCSEC, 0.08 * ARCSEC, 0.25 * ARCSEC),
    units=("rad", "rad", "rad"),
    gain=11.0,
    explained=0.241,
    nearest="beta-scale",
    separation=12.4,
    picture={},
)


def plain(text: str) -> str:
    """The text with ordinary spaces."""
    return " ".join(text.replace("\u202f", " ").replace("\u00a0", " ").split())


def test_each_angle_has_its_own_line() -> None:
    lines = [(what, plain(equation)) for what, equation in term_view(TERM).lines]
    assert lines == [
        ("the angle β is larger by", "(0.86 ± 0.16 arcsec) · sin 3β + (0.04 ± 0.16 arcsec) · cos 3β"),
        ("the elevation α is larger by", "(2.00 ± 0.50 arcsec) · (t − t̄)"),
    ]


def test_a_term_of_a_sensor_says_which() -> None:
    own = replace(
        TERM, words=("a·|a|",), sensors=("A2",), amplitude=(9.80665e-5,), sigma=(9.80665e-6,), units=("m/s²",)
    )
    assert [(what, plain(text)) for what, text in term_view(own).lines] == [
        ("A2 reads high by", "(10.0 ± 2.0 µg) · a·|a|")
    ]


def test_what_it_is_worth_and_what_comes_near_it_are_said() -> None:
    told = term_view(TERM)
    assert plain(told.worth).startswith("It removes 24 % of the excess")
    assert told.nearest == "Nearest in the catalogue: beta scale, 12.4 standard errors from it."


def test_a_gain_that_is_none_is_said_as_less() -> None:
    assert gain_in_words(None) == ""
    assert gain_in_words(GroupGain(8, 4, -1.5, 1.2, 1.25, ())).endswith("log score 1.5 less.")
