"""A verdict and what speaks against it, in one breath."""

from dataclasses import replace

import pytest

from estimator.diagnosis.results import Course, Structure
from service.judging.words import named, otherwise, size_in_words, unexplained, verdict_in_words
from service.sessions.decision import Verdict
from service.sessions.doubt import DoubtKind as Doubt
from service.sessions.doubt import Reservation, Reservations
from service.sessions.words.conditions import FIT, REFERENCE, UNDECIDED, said_with
from tests.service.findings import JUMP

JUMPED = Reservation(Doubt.CAUSE, "the bias of A2 has one step", "repeat the session", share=1.0)
UNFIT = Reservation(Doubt.OTHER_MODEL, "unfit with warm up (A2) corrected", "repeat the session")
WRONG = Reservation(Doubt.RECORD, "the channels of A1 and A2 are exchanged", "correct the file and upload it again")


@pytest.mark.parametrize(
    ("reservations", "said"),
    [
        ((), "Fit"),
        (None, "Fit; the search for causes is not finished"),
        ((JUMPED,), "Fit, but the bias of A2 has one step: repeat the session"),
        ((JUMPED, UNFIT), f"Fit, but {JUMPED.text}; and {UNFIT.text}: repeat the session"),
        ((JUMPED, UNFIT, UNFIT), f"Fit, but {JUMPED.text}; and {UNFIT.text}; and 1 more: repeat the session"),
        ((WRONG, JUMPED), f"Fit, but {WRONG.text}; and {JUMPED.text}: correct the file and upload it again"),
    ],
)
def test_a_verdict_is_said_with_its_reservations(reservations: Reservations, said: str) -> None:
    assert verdict_in_words(FIT, reservations) == said


def test_the_same_is_not_advised_twice() -> None:
    stand = replace(JUMPED, advice="correct the stand and repeat the session")
    assert verdict_in_words(FIT, (stand, UNFIT)).endswith(": correct the stand and repeat the session")


def test_a_reference_is_said_with_them_too() -> None:
    assert verdict_in_words(REFERENCE, (JUMPED,)).startswith("Reference set, but the bias of A2")


def test_a_verdict_with_a_reservation_is_marked_in_words_and_keeps_its_rank() -> None:
    marked = said_with(FIT, (JUMPED,))
    assert (marked.word, marked.reserved, marked.rank) == ("Fit, with reservation", True, FIT.rank)
    assert said_with(UNDECIDED, ()) is UNDECIDED
    assert said_with(UNDECIDED, None) is UNDECIDED


def test_a_cause_is_a_clause_with_its_size() -> None:
    plain = replace(JUMP, alternatives=(), sentence="A2 is clipped: its reading stops at a limit.")
    assert named(plain, "") == "A2 is clipped: its reading stops at a limit"
    assert named(replace(plain, sentence="The stand was not level."), "9") == "the stand was not level (9)"


def test_of_several_causes_the_first_is_a_clause_and_the_others_are_named() -> None:
    assert named(JUMP, "9") == "the zero of A1 and A2 jumped, or possibly warm up (9)"


def test_a_size_stands_beside_its_tolerance_in_one_measure_with_its_expanded_uncertainty() -> None:
    micro_g = 9.80665e-6
    size = size_in_words("accelerometer", "bias", (51 * micro_g, 2 * micro_g), 50 * micro_g)
    assert size == "51.0\u00a0±\u00a04.0\u202fµg, tolerance 50\u202fµg"
    rough = size_in_words("accelerometer", "bias", (41.81 * micro_g, None), 50 * micro_g)
    assert rough == "about 42\u202fµg, tolerance 50\u202fµg"


def test_another_verdict_names_the_model_that_gives_it() -> None:
    assert otherwise(Verdict.FAIL, ("warm-up", "bias-ramp"), ("A2",)) == (
        "unfit with warm up (A2) and bias ramp corrected"
    )
    assert otherwise(Verdict.PASS, ("warm-up",), (), named=True) == "fit with these effects corrected"
    assert otherwise(Verdict.PASS, (), ()) == "fit if the cause is not a known one"


def test_structure_says_where_it_is() -> None:
    own = Structure("harmonic 5 of β", ("A5",), 1e-9, 9.0)
    assert unexplained((own,), "42 µg") == "an effect in A5 that no known cause explains (42 µg)"
    common = replace(own, sensors=(), course=Course("β", ("α",), ((1e-5,),)))
    assert unexplained((common,), "9 µg") == "an effect in all sensors that no known cause explains (9 µg)"
    assert unexplained((replace(own, of_record=True),), "") == "the record is wrong"
