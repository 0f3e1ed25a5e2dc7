"""Drifts and jumps from uploads on: flags of their own, what is needed next, and what a type teaches."""

from datetime import UTC, datetime, timedelta

import pytest

from service.flags.changes import resolve_flag
from service.flags.records import FlagState, Matter
from service.flags.store import FlagQuery, Flags
from service.outlook.reading import outlook_of
from service.outlook.records import Action, DueRule, ParameterTrend, UnitOutlook
from service.outlook.words import next_calibration
from service.pages.type.tolerances import Watch, set_tolerances
from service.records.flagging.drift import SMALL
from service.records.flagging.overdue_units import flag_overdue
from service.sessions.store import Sessions
from service.storage import Storage
from service.types.store import UnitTypes
from service.work.watch import update_outlooks
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.dated import upload_and_date
from tests.service.made_sessions import MICRO_G, session_bytes
from tests.service.recordings import recording_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def measure(storage: Storage, moved: dict[int, float], unit: str = "BA-017") -> None:
    """Sessions by month of 2026, with how far A3's bias has moved, µg; 50 are allowed."""
    for month, micro_g in moved.items():
        content = session_bytes(seed=month, month=month, a3_moved=micro_g, unit=unit)
        upload_and_date(storage, content, "a.json", NOW, outlook=month == max(moved))


def outlook(storage: Storage, unit: str = "BA-017") -> UnitOutlook:
    with storage.database.reading() as store:
        return outlook_of(store, unit, NOW)


def a3_bias(storage: Storage) -> ParameterTrend:
    return next(t for t in outlook(storage).trends if (t.sensor, t.parameter) == ("A3", "bias"))


def flags(storage: Storage) -> dict[Matter, str]:
    with storage.database.reading() as store:
        return {flag.matter: flag.summary for flag in Flags(store).page(FlagQuery("BA-017"))}


def test_a_jump_within_the_tolerance_has_a_flag_of_its_own(storage: Storage) -> None:
    measure(storage, {1: 0.0, 2: 0.0, 3: 0.0, 4: 0.0, 5: 25.0, 6: 25.0})
    (change,) = a3_bias(storage).changes
    assert (change.kind, change.after.month, change.before.month) == ("jump", 4, 5)
    assert change.size == pytest.approx(25 * MICRO_G, abs=3 * change.sigma)
    assert list(flags(storage)) == [Matter.JUMP]
    assert flags(storage)[Matter.JUMP].startswith("A3 bias jumped by +")


def test_a_drift_within_the_tolerance_is_flagged_with_its_beginning(storage: Storage) -> None:
    measure(storage, {1: 0.0, 3: 6.0, 5: 12.0, 7: 18.0, 9: 24.0, 10: 27.0})
    assert list(flags(storage)) == [Matter.DRIFT]
    assert flags(storage)[Matter.DRIFT].startswith("A3 bias has drifted at +")


def test_a_jump_below_the_share_that_the_type_says_is_a_remark(storage: Storage) -> None:
    """Half of the tolerance."""
    measure(storage, {1: 0.0, 2: 0.0, 3: 0.0, 4: 0.0, 5: 25.0, 6: 25.0})
    with storage.database.reading() as store:
        known = UnitTypes(store).of_unit("BA-017")
    for share in (0.6, 0.4):
        set_tolerances(storage, known.name, known.tolerances, None, NOW, watch=Watch(flag_share=share))
        assert any(line.startswith("A3 bias jumped") for line in next_calibration(outlook(storage), NOW).moving)
    with storage.database.reading() as store:
        again, first = Flags(store).page(FlagQuery("BA-017"))
    assert (again.matter, again.state) == (Matter.JUMP, FlagState.RAISED)
    assert (first.state, first.changes[-1].text) == (FlagState.RESOLVED, SMALL)


def test_a_jump_that_a_person_resolved_does_not_come_back_with_later_sessions(storage: Storage) -> None:
    measure(storage, {1: 0.0, 2: 0.0, 3: 0.0, 4: 0.0, 5: 40.0, 6: 40.0})
    with storage.database.reading() as store:
        [flag] = Flags(store).page(FlagQuery("BA-017"))
    resolve_flag(storage, flag.id, "K. Ito", "dropped in April, looked at", NOW)
    measure(storage, {8: 40.0})
    assert a3_bias(storage).changes
    with storage.database.reading() as store:
        assert [flag.state for flag in Flags(store).page(FlagQuery("BA-017"))] == [FlagState.RESOLVED]


def test_an_overdue_date_that_a_drift_has_set_is_one_flag(storage: Storage) -> None:
    def opened() -> list[Matter]:
        with storage.database.reading() as store:
            return [flag.matter for flag in Flags(store).page(FlagQuery("BA-017", unresolved=True))]

    measure(storage, {1: 0.0, 3: 6.0, 5: 12.0, 7: 18.0, 9: 24.0, 10: 27.0})
    found = outlook(storage)
    assert found.basis is not None
    assert found.due is not None
    assert (found.basis.rule, found.basis.sensor, opened()) == (DueRule.RISK, "A3", [Matter.DRIFT])
    flag_overdue(storage, found.due + timedelta(days=1))
    assert opened() == [Matter.OVERDUE]
    flag_overdue(storage, found.due - timedelta(days=1))
    assert opened() == [Matter.DRIFT]


def test_nothing_is_flagged_where_nothing_happens(storage: Storage) -> None:
    measure(storage, dict.fromkeys(range(1, 7), 0.0))
    assert flags(storage) == {}


def test_a_unit_found_unfit_needs_a_hand_and_no_date(storage: Storage) -> None:
    measure(storage, {1: 0.0, 3: 90.0})
    found = outlook(storage)
    assert (found.action, found.due, found.overdue) == (Action.NOW, None, False)
    assert "adjust, repair or withdraw it" in found.reason


def test_an_undecided_session_is_repeated_with_what_to_measure(storage: Storage) -> None:
    upload_and_date(storage, session_bytes(month=1), "a.json", NOW)
    sigmas = dict.fromkeys(("theta_x", "theta_y", "alpha", "beta"), 600.0)
    coarse = {"id": "S-2", "alpha_deg": 40.0, "sigma_arcsec": sigmas}
    upload_and_date(storage, session_bytes(seed=2, month=2, stand=coarse), "b.json", NOW)
    found = outlook(storage)
    assert (found.action, found.due) == (Action.REPEAT, None)
    assert "measure" in found.reason


def test_a_recording_in_service_that_finds_a_unit_unfit_leaves_it_no_date(storage: Storage) -> None:
    measure(storage, {1: 0.0, 3: 0.0})
    upload_and_date(storage, recording_bytes(a3_moved=130.0), "flight.json", NOW)
    found = outlook(storage)
    assert (found.action, found.due) == (Action.NOW, None)
    assert found.reason.startswith("Found out of tolerance on 1 May 2026")


@pytest.mark.slow
def test_a_fleet_does_not_depend_on_the_order_in_which_its_sessions_came(storage: Storage) -> None:
    """Another unit of the type tells later what was not known when the first was looked at."""
    measure(storage, {1: 0.0, 3: 0.0, 5: 0.0})
    alone = outlook(storage)
    measure(storage, {1: 0.0, 3: 10.0, 5: 25.0}, unit="BA-018")
    assert update_outlooks(storage, NOW) == 1
    together = outlook(storage)
    assert together.learned_from == 2 * alone.learned_from
    assert together.risk != alone.risk
    assert update_outlooks(storage, NOW + timedelta(hours=1)) == 0


def test_the_temperature_of_a_session_is_kept(storage: Storage) -> None:
    id = upload_and_date(storage, session_bytes(), "a.json", NOW).id
    with storage.database.reading() as store:
        assert Sessions(store).get(id).temperature == 21.0
