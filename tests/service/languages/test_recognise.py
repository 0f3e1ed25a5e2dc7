"""Sentences made in English, said in Russian."""

import pytest

from service.languages.catalogue import catalogue_of
from service.languages.language import Language

SAID = {
    "Fit": "Годен",
    "A3 bias moved +85 µg (U 2.9 µg) beyond the tolerance of 50 µg.": (
        "A3 смещение нуля: изменение +85 µg (U 2.9 µg) больше допуска 50 µg."
    ),
    "Every parameter is within its tolerance by more than U; closest to it: A6 quadratic term, moved +9 µg/g² "
    "(U 8.3 µg/g²) of 40 µg/g² allowed.": (
        "Все параметры в допуске с запасом больше U; ближе всего к нему: A6 квадратичный член, изменение +9 µg/g² "
        "(U 8.3 µg/g²) при допуске 40 µg/g²."
    ),
    "Fit, but the zero of A2 jumps once and stays (51 ± 4 µg, tolerance 50 µg): repeat the session": (
        "Годен, но нуль A2 один раз скачком меняется и остаётся таким (51 ± 4 µg, допуск 50 µg): повторите сеанс"
    ),
    "A6 scale factor has jumped between 18 Apr 2026 and 9 Aug 2026 by +8.6 ± 3.8 ppm; 100 ppm are allowed.": (
        "A6 масштабный коэффициент: скачок между 18 апреля 2026 и 9 августа 2026 на +8.6 ± 3.8 ppm; "
        "допускается 100 ppm."
    ),
    "Likely bias jump (G2), 91.9 %; less likely sensor drift, 3.5 %; 1 more.": (
        "Вероятно, скачок нуля (G2), 91.9 %; менее вероятно: уход датчика, 3.5 %; ещё 1."
    ),
    "Likely sensor drift (A3, A2), 87.5 %; less likely bias jump, 12.4 %.": (
        "Вероятно, уход датчика (A3, A2), 87.5 %; менее вероятно: скачок нуля, 12.4 %."
    ),
    "The sessions of unit type RA-6 show together: Every gyro of type RA-6 bends with the cube of the input.": (
        "Сеансы приборов типа RA-6 вместе показывают: Каждый гироскоп типа RA-6 нелинеен: отклонение растёт как куб "
        "входа."
    ),
}


@pytest.mark.parametrize("english", SAID)
def test_a_sentence_with_its_values(english: str) -> None:
    assert catalogue_of(Language.RUSSIAN).say(english) == SAID[english]


@pytest.mark.parametrize(("count", "expected"), [(1, "1 сеанс"), (3, "3 сеанса"), (11, "11 сеансов"), (21, "21 сеанс")])
def test_a_number_chooses_among_three_forms(count: int, expected: str) -> None:
    assert catalogue_of(Language.RUSSIAN).say(f"{count} session{'' if count == 1 else 's'}") == expected


@pytest.mark.parametrize(
    "text",
    [
        "",
        "BA-017",
        "12.3 ± 0.4 µg",
        "N. Orlova",
        "Sea and Air Works",
        "Cable was swapped by the night shift",
        "5 µm/(m/s²)",
        "Годен",
    ],
)
def test_what_nobody_translated_stays_as_it_was_written(text: str) -> None:
    assert catalogue_of(Language.RUSSIAN).say(text) == text


@pytest.mark.parametrize("joint", [" and ", ", ", "; ", " along that of ", " (", ": the zero of "])
def test_a_text_that_is_made_to_take_time_does_not(joint: str) -> None:
    """Its reading ends after a bounded number of parts; the process is not held."""
    text = joint.join(f"bias x{k} moved" for k in range(300))[:3000]
    assert "x1" in catalogue_of(Language.RUSSIAN).say(text)


def test_values_that_are_no_words_are_never_changed() -> None:
    text = "There is no unit <b>ru.po</b> {n} \\1."
    assert "<b>ru.po</b> {n} \\1" in catalogue_of(Language.RUSSIAN).say(text)
