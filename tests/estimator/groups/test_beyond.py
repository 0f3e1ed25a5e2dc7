"""Names are held against the library of terms, and against sessions that took no part in them."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from estimator import CalibrationSession, diagnose, diagnose_group, diagnose_statistics, statistics_of
from estimator.causes.catalogue import UNEXPLAINED
from estimator.groups.evidence import SAME
from estimator.groups.gain import gained, names_that_predict
from estimator.groups.lack_of_fit import LackOfFitGroup, names_that_fit
from estimator.groups.layout import TERMS, UNIT, GroupLayout
from estimator.groups.selection import Found, GroupSelection, select
from estimator.groups.session_statistics import as_kept
from estimator.groups.terms import Library, confirmed
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
def selected(effect: Effect | None) -> GroupSelection:
    """Selection from the catalogue alone."""
    return select(GroupLayout.of([statistics_of(s) for s in sessions(effect)], UNIT))


def test_the_catalogue_alone_names_what_it_does_not_have_and_the_library_takes_it_back() -> None:
    state = selected(WARM)
    assert state.found
    left = names_that_fit(LackOfFitGroup(state, sessions(WARM)))
    assert left.found == ()
    ((structure, statistic),) = left.structures
    assert (structure.cause, structure.sensor, structure.words) == (TERMS, "A2", ("|a|·(T − T̄)",))
    assert statistic > 50


def test_a_cause_of_the_catalogue_stays_without_a_doubt() -> None:
    left = names_that_fit(LackOfFitGroup(selected(CUBIC), sessions(CUBIC)))
    assert {f.hypothesis.sensor for f in left.found} == {"A2"}
    assert (left.structures, left.doubted) == ((), frozenset())


def test_what_is_taken_back_is_told_with_the_terms_that_fit_better() -> None:
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


def test_a_name_by_which_other_sessions_are_less_likely_is_none() -> None:
    state = selected(CUBIC)
    (name,) = state.found
    assert gained(state, name) > 10
    w, table = 1, state.layout.hypotheses[1]
    other = next(k for k, h in enumerate(table) if (h.cause, h.sensor) == ("cubic-nonlinearity", "A5"))
    false = Found((w, other), table[other], SAME, 0, 0.0)
    assert gained(replace(state, found=(name, false)), false) < 3
    noise = replace(state, found=tuple(Found((w, k), h, SAME, 0, 0.0) for k, h in enumerate(table) if h.sensor == "A5"))
    assert len(names_that_predict(noise).found) < len(noise.found)


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


@pytest.mark.parametrize("extra", [("a before",), ("run",)])
def test_no_term_is_confirmed_that_the_sessions_left_out_lose_by(extra: tuple[str, ...]) -> None:
    """The held-out sessions have the opposite effect, so that whatever was learned is a loss."""

    def whole(sign: float, count: int) -> list[Library]:
        effect = replace(WARM, amplitude=(sign * WARM.k,))
        return [Library.of(as_kept(s, statistics_of(s)), "A2", []) for s in sessions(effect, count)]

    fit, held = whole(1.0, 4), whole(-1.0, 4)
    assert confirmed("A2", fit, held, (("|a|·(T − T̄)",), extra)) in ((), (extra,))
    assert confirmed("A2", fit, fit, (("|a|·(T − T̄)",),)) == (("|a|·(T − T̄)",),)
