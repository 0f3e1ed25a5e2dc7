"""A message is said in Russian by its parts; a text is said where it stands in the catalogue as a whole."""

from datetime import UTC, datetime

import pytest

from estimator.message import joined, say
from estimator.wording import counted
from service.kit.measures import day_of
from service.languages.catalogue import catalogue_of
from service.languages.language import Language

ZERO = say("{sensors} drifts.", sensors="A2")
SAID = (
    ("Fit", "Годен"),
    ("fit", "годен"),
    (day_of(datetime(2026, 5, 3, tzinfo=UTC)), "3 мая 2026"),
    (joined(" and ", ("bias", "scale factor")), "смещение нуля и масштабный коэффициент"),
    (joined("; ", ("Fit", say("{n} more", n=1))), "Годен; 1 more"),
    (
        say("{place} changed by {change} (U {spread}), beyond the tolerance of ±{tolerance}.",
            place=say("{sensor} {worst}", sensor="A3", worst="bias"),
            change="+85 µg", spread="2.9 µg", tolerance="50 µg"),
        "A3 смещение нуля: изменение +85 µg (U 2,9 µg) больше допуска ±50 µg.",
    ),
)  # fmt: skip


VALUES = (
    ("+62.5\u00a0±\u00a01.2\u202fµg", "+62,5\u00a0±\u00a01,2\u202fµg"),
    ("0.17\u202farcsec", "0,17\u202f″"),
    ("1,234.5 ppm", "1\u202f234,5 млн⁻¹"),
    ("3.20\u202fppm/K", "3,20\u202fмлн⁻¹/K"),
    ("−0.02", "−0,02"),
    ("19.5–22.0\u00a0°C", "19,5–22,0\u00a0°C"),
    ("0.9.1", "0.9.1"),
    ("10.0.0.5:8443", "10.0.0.5:8443"),
    ("BA-1.5", "BA-1.5"),
)


def said(text: str) -> str:
    return catalogue_of(Language.RUSSIAN).say(text)


@pytest.mark.parametrize(("english", "russian"), SAID)
def test_a_message_with_its_parts(english: str, russian: str) -> None:
    assert said(english) == russian


@pytest.mark.parametrize(("count", "expected"), [(1, "1 сеанс"), (3, "3 сеанса"), (11, "11 сеансов"), (21, "21 сеанс")])
def test_a_number_chooses_among_three_forms(count: int, expected: str) -> None:
    assert said(counted(count, "session")) == expected


@pytest.mark.parametrize(("english", "russian"), VALUES)
def test_a_number_has_a_decimal_comma_and_the_measures_of_the_language(english: str, russian: str) -> None:
    assert said(english) == russian
