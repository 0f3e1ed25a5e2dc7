"""Structure without a name in words: of one sensor, of the stand, of the record."""

import pytest

from estimator.diagnosis.results import Course, Structure
from service.diagnosis.words.findings import course_in_words, headline_of, in_words, summed_up, what_to_do_about

OWN = Structure("harmonic 3 of β", ("A2",), 1e-9, 9.0)
COURSE = Structure("of the stand", (), 1e-9, 9.0, Course("β", ("α",), ((1e-5,), (-1e-5,))))
PATTERN = Structure("the applied vector, common to all sensors: harmonic 3 of β", (), 1e-9, 9.0)
MIXED = Structure("input axes 74° off: columns are mixed up", ("A1", "A2"), 0.0, 9.0, of_record=True)
COMMON = "An effect common to all sensors, of the stand or fixture, that no known cause explains"


def test_what_one_sensor_does_is_told_of_that_sensor() -> None:
    assert in_words([OWN]) == "An effect in A2 that no known cause explains: harmonic 3 of β."


def test_what_all_sensors_show_is_told_of_the_stand() -> None:
    assert in_words([COURSE]) == f"{COMMON}: the applied vector deviates in α, smoothly along β."
    assert in_words([PATTERN]) == f"{COMMON}: harmonic 3 of β."


def test_a_mixed_up_record_is_told_before_all_else() -> None:
    assert in_words([OWN, MIXED]) == "The record is wrong: input axes 74° off: columns are mixed up."


@pytest.mark.parametrize(
    ("one", "step"), [(OWN, "another unit or stand"), (COURSE, "the fixture"), (MIXED, "the file")]
)
def test_what_to_do_depends_on_where_it_is(one: Structure, step: str) -> None:
    advice = {structure: what_to_do_about([structure]) for structure in (OWN, COURSE, MIXED)}
    assert [structure for structure, said in advice.items() if step in said] == [one]


def test_the_headline_is_that_of_the_first() -> None:
    assert (headline_of([COURSE, OWN]), headline_of([PATTERN])) == (COMMON, COMMON)
    assert headline_of([OWN, COURSE]) != COMMON


def test_a_flag_tells_of_the_stand_and_of_the_sensors_beside_it() -> None:
    beside = "In addition: an effect in A2 that no known cause explains."
    assert summed_up([OWN, COURSE]) == f"{COMMON}. {beside}"
    assert summed_up([OWN]) == "An effect in A2 that no known cause explains."


@pytest.mark.parametrize(
    ("order", "components", "words"),
    [
        ("β, each run separately", ("β", "size"), "deviates in β and size, smoothly along β, each run separately"),
        ("no order: independent in every row", ("α",), "deviates in α, independently in every row"),
        ("turned as a whole", (), "turned as a whole"),
    ],
)
def test_a_course_is_said_in_words(order: str, components: tuple[str, ...], words: str) -> None:
    assert course_in_words(Course(order, components, ())) == words
