"""What other tolerances would change: the latest sessions of a type's units, judged by them, and nothing stored.

A recording in service is judged by what was kept of its comparison, as it was with its upload: no file is read.
"""

from collections.abc import Mapping
from dataclasses import replace

from estimator.parity import ParityResult
from estimator.results import Calibration
from estimator.session import IN_SERVICE
from service.judging.calibrate import Comparison
from service.judging.judge import judge, judge_recording
from service.judging.reference import reference_of
from service.records.fleet import FleetQuery
from service.records.tolerance_preview import LatestSession, TolerancePreview, VerdictChange, WantedTolerances
from service.records.unit import UnitType
from service.storage.store import Store

MOST = 100
"""Units that are looked at, the worst first: about two seconds; those far within their tolerances change last."""


def preview_tolerances(
    store: Store, name: str, wanted: WantedTolerances, coverage_factor: float, most: int = MOST
) -> TolerancePreview:
    """By the rule that judges uploads, against the same references; NotFoundError where there is no such type."""
    known = store.unit_types.get(name)
    other = replace(known, tolerances=wanted.tolerances, gyro_tolerances=wanted.gyro_tolerances)
    units = sum(store.unit_types.uses(name)[name].verdicts.values())
    serials = tuple(unit.serial for unit in store.fleet.units(FleetQuery(unit_type=name, limit=most)))
    latest = store.fleet_rows.latest_sessions(serials)
    against = {one.session: _reference(store, one) for one in latest.values()}
    known_of = {session: reference for session, reference in against.items() if reference is not None}
    calibrations = store.calibrations.in_force({*known_of, *known_of.values()})
    alone = {one.session for one in latest.values() if _is_uncompared(one, known_of, calibrations)}
    compared = {session: reference for session, reference in known_of.items() if session not in alone}
    judged = [latest[serial] for serial in serials if serial in latest and latest[serial].session in compared]
    found = (_change(one, compared, calibrations, other, coverage_factor) for one in judged)
    return TolerancePreview(
        units=units,
        judged=len(judged),
        references=len(against) - len(compared) - len(alone),
        recordings=len(alone),
        beyond=units - len(latest),
        changes=tuple(sorted(filter(None, found), key=lambda one: -one.after.severity)),
    )


def _reference(store: Store, one: LatestSession) -> str | None:
    """The session that it is judged against; None of a reference, and where there is none."""
    if one.is_reference:
        return None
    return reference_of(store, one.key, one.block, one.programme, one.started_at).session


def _is_uncompared(one: LatestSession, against: Mapping[str, str], calibrations: Mapping[str, Calibration]) -> bool:
    """Whether it is a recording in service without a calibration to compare it with, or whose file could not be read
    when it was to be compared."""
    return one.programme == IN_SERVICE and (one.session not in against or calibrations[one.session].parity is None)


def _change(
    one: LatestSession,
    against: Mapping[str, str],
    calibrations: Mapping[str, Calibration],
    other: UnitType,
    coverage_factor: float,
) -> VerdictChange | None:
    own, reference = calibrations[one.session], calibrations[against[one.session]]
    if own.parity is None:
        found = judge(own, reference, other, coverage_factor)
    else:
        seen = Comparison(reference, ParityResult.from_dict(own.parity))
        found = judge_recording(own, seen, other, coverage_factor)
    if found.verdict is one.verdict:
        return None
    worst = found.worst
    place = ("", "") if worst is None else (worst.sensor, worst.parameter)
    return VerdictChange(one.unit, one.session, one.verdict, found.verdict, *place, found.reason)
