"""Names of a group are held against courses that no cause describes."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from estimator import CalibrationSession, diagnose, diagnose_group, diagnose_statistics, statistics_of
from estimator.causes.catalogue import UNEXPLAINED
from estimator.groups.course import AnsweredGroup, Where, answered, judged
from estimator.groups.layout import pool_of
from estimator.groups.pool import LIBRARY
from estimator.groups.priors import DOUBT, UNIT
from estimator.groups.search import GroupModel, search, weigh
from estimator.groups.session_statistics import as_kept
from tests.blind.world import Effect
from tests.estimator.groups.cases import measured, worlds

CUBIC = Effect("cubic-nonlinearity", (6e-7,), (1,))
WARM = Effect("|a|·T", (9e-5,), (1,), (900.0,))


@cache
def sessions(effect: Effect | None, count: int = 8) -> tuple[CalibrationSession, ...]:
    """Sessions of one unit with an effect on A2, or with none."""
    acting = [] if effect is None else [effect]
    return tuple(measured(w, acting, 400 + k) for k, w in enumerate(worlds(count)))


@cache
def answer(effect: Effect) -> AnsweredGroup:
    """The model of the sessions of an effect, held against unknown courses."""
    records = [statistics_of(s) for s in sessions(effect)]
    return answered(pool_of(records, UNIT), records, sessions(effect))


def test_the_catalogue_alone_names_what_it_does_not_have_and_a_course_takes_its_place() -> None:
    records = [statistics_of(s) for s in sessions(WARM)]
    assert search(GroupModel(pool_of(records, UNIT))).named
    left = answer(WARM)
    assert left.model.named == []
    ((where, says),) = left.courses.items()
    (course,) = says.course
    assert (where.sensor, course.cause, course.words) == ("A2", LIBRARY, ("|a|·(T − T̄)",))
    assert says.statistic > 50
    assert says.probability > 0.5


def test_a_cause_of_the_catalogue_stays_without_a_doubt() -> None:
    left = answer(CUBIC)
    assert {left.model.pool[t.place].sensor for t in left.model.named} == {"A2"}
    assert (left.courses, left.doubted) == ({}, frozenset())


def test_the_probability_of_a_course_is_that_of_all_sets_with_one() -> None:
    """One name against each course in its place, by the evidence of single hypotheses."""
    left = answer(CUBIC)
    where = Where(UNIT, sessions(CUBIC)[0].unit, "A2", "accelerometer")
    pool = left.pool(where)
    (name,) = [h for h in pool.places if h.cause == CUBIC.cause]
    weighed = weigh(pool.given())
    names = np.logaddexp.reduce([v for _, _, v in weighed.ranked()])
    courses = np.logaddexp.reduce([v for _, _, v in weighed.ranked(nameless=True)])
    instead = 1 / (1 + np.exp(names - courses))
    assert instead <= judged(pool, [name]).probability + 1e-9 < instead + DOUBT


def test_a_withdrawn_name_is_reported_with_the_terms_that_fit_better() -> None:
    found = diagnose_group(sessions(WARM))
    assert (found.findings, found.unexplained) == ((), True)
    assert "|a|·(T − T̄) agrees better: it has no name" in " ".join(found.notes)
    assert [term.words for term in found.terms] == [("|a|·(T − T̄)",)]


FIFTH = [Effect("a·a⁴", (3e-4,), (1,)), Effect("sign a·a⁴", (3e-4,), (1,))]


@pytest.mark.parametrize("effect", FIFTH, ids=lambda e: e.cause)
def test_a_power_that_the_catalogue_lacks_is_not_surely_the_one_that_it_has(effect: Effect) -> None:
    (found,) = diagnose_group(sessions(effect)).findings
    assert found.cause == "cubic-nonlinearity"
    assert UNEXPLAINED in found.alternatives


def test_what_differs_every_time_may_be_outside_the_catalogue() -> None:
    sizes = (1.0, -1.0, 0.2, 1.4, -0.7, 0.9, 0.0, 1.3)
    acting = [replace(CUBIC, amplitude=(x * CUBIC.k,)) for x in sizes]
    own = [measured(w, [effect], 400 + k) for k, (w, effect) in enumerate(zip(worlds(8), acting, strict=True))]
    (found,) = diagnose_group(own).findings
    assert (found.cause, found.form) == ("cubic-nonlinearity", "varying")
    assert UNEXPLAINED in found.alternatives


def test_records_alone_do_not_make_a_name_sure() -> None:
    whole, kept = sessions(CUBIC), [statistics_of(s) for s in sessions(CUBIC)]
    assert [UNEXPLAINED in f.alternatives for f in diagnose_statistics(kept).findings] == [True]
    assert [UNEXPLAINED in f.alternatives for f in diagnose_statistics(kept, sessions=whole).findings] == [False]


@pytest.mark.slow
@pytest.mark.parametrize("at_hand", [7, 4])
def test_the_history_of_a_diagnosis_is_held_against_the_library(at_hand: int) -> None:
    """``at_hand`` of seven earlier sessions, records of all."""
    for effect, causes in ((WARM, set()), (CUBIC, {"cubic-nonlinearity"})):
        *earlier, latest = sessions(effect)
        found = diagnose(latest, earlier[-at_hand:], records=[statistics_of(s) for s in earlier])
        assert {f.cause for f in found.findings if f.over_sessions} == causes
        assert not any(UNEXPLAINED in f.alternatives for f in found.findings)


def test_a_session_is_fitted_as_its_record_took_it() -> None:
    (session, *_) = sessions(None)
    readings = session.readings.copy()
    readings[7, 1] += 30 * np.hypot(session.standard_errors[7, 1], session.readings[:, 1].std() * 1e-5)
    spoilt = replace(session, readings=readings)
    baseline = as_kept(spoilt, statistics_of(spoilt))
    assert baseline.variance[7, 1] > 1e6 * np.median(baseline.variance[:, 1])
    assert (
        np.abs(baseline.residual[:, 0]).max()
        < 10 * np.sqrt(as_kept(session, statistics_of(session)).variance[:, 0]).max()
    )


def test_a_name_that_no_session_at_hand_can_show_is_in_doubt() -> None:
    """Warm-up of nine tenths of the sessions; the only one at hand has no clock."""
    effect = Effect("bias-temperature", (3e-5,), (1,))
    whole = [measured(w, [effect], 500 + k) for k, w in enumerate(worlds(8))]
    kept = [statistics_of(s) for s in whole]
    blind = replace(whole[-1], temperature=None)
    found = diagnose_statistics([*kept[:-1], statistics_of(blind)], sessions=[blind])
    assert [(f.cause, UNEXPLAINED in f.alternatives) for f in found.findings] == [("bias-temperature", True)]
