"""A recording against its reference: the whole of it at once, or as it comes."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.special import chdtri

from estimator.applied_vector import gravity
from estimator.errors import ScheduleError
from estimator.message import joined, say
from estimator.parity.blocks import ANY, AUTO, MOTIONS, BlockSelection, select
from estimator.parity.course import coarse
from estimator.parity.freed import freed
from estimator.parity.hypotheses import ParityEvidence
from estimator.parity.ledger import BLOCK, Ledger
from estimator.parity.motion import gyros_of
from estimator.parity.nuisance import nuisance_of
from estimator.parity.onset import Looked, faults_of
from estimator.parity.reference import FEWEST, reference_of
from estimator.parity.regression import ParityChange, regress
from estimator.parity.results import NOTHING, ParityResult, SensorParity
from estimator.parity.taken import Taken
from estimator.results import Calibration
from estimator.session import ACCELEROMETER, Array, CalibrationSession, Sensor, Site

FALSE_ALARM = 0.01
"""One unchanged block in a hundred may be called changed, as in a session (`health.rule`)."""

COMMON = 12
"""Dimensions that no recording shows: three of a common bias, nine of a linear map of the applied vector."""


class ParityAccumulator:
    """Takes a recording piece by piece, in memory that does not grow with its length.

    Parameters
    ----------
    unit : whose recording it is.
    sensors : all sensors of the recording, in the order of its columns.
    calibration : the reference.
    kind : which sensors are judged.
    sample_rate : Hz; None when the rows are averages.
    site : for the size of gravity.
    count_time : s, when gyro readings are pulse counts.

    Raises
    ------
    ScheduleError : the reference does not fit the sensors, or there is no redundancy.
    """

    def __init__(
        self,
        unit: str,
        sensors: Sequence[Sensor],
        calibration: Calibration,
        *,
        kind: str = ACCELEROMETER,
        sample_rate: float | None = None,
        site: Site | None = None,
        count_time: float | None = None,
    ) -> None:
        self.unit = unit
        self.reference = reference_of(sensors, calibration, kind)
        self._norm = gravity(site or Site()) if kind == ACCELEROMETER else None
        self._rate = sample_rate
        self._period = np.where([s.kind != ACCELEROMETER for s in sensors], count_time or 1.0, 1.0)
        self._samples = 0
        self._taken = Taken(sample_rate)
        length = 1 if sample_rate is None else max(round(BLOCK * sample_rate), 2)
        gyros = gyros_of(sensors, calibration) if kind == ACCELEROMETER else None
        self.ledger = Ledger(self.reference, length, gyros=gyros)

    def add(self, readings: Array, time: Array | None = None) -> None:
        """The next rows (R, m) of all m sensors, reading units as in the file; a row with NaN says nothing.

        ``time`` (R,) s, of the rows where samples may be missing between them; else they follow at the sample rate.
        """
        known = np.asarray(np.isfinite(readings).all(axis=1))
        self._taken.add(known, time)
        self._samples += len(readings)
        self.ledger.add(readings[known] / self._period)

    def result(self, *, motion: str = AUTO, false_alarm: float = FALSE_ALARM) -> ParityResult:
        """Judges the recording so far; ScheduleError where it cannot be judged. More may be added afterwards.

        Parameters
        ----------
        motion : ``still`` uses stretches at rest only; ``any`` everything, and takes the sensors to sit in one point;
            ``auto`` leaves moving stretches out where they spoil parity.
        false_alarm : chance that an unchanged block is called changed.
        """
        if motion not in MOTIONS:
            raise ValueError(
                say("motion is {motion}; must be one of {motions}", motion=repr(motion), motions=joined(", ", MOTIONS))
            )
        looked = faults_of(self.ledger, self._norm, self._rate)
        sound = [k for k in range(len(self.reference.names)) if k not in looked.silent]
        parts = [self._part(ledger, motion, false_alarm) for ledger in self._parts(looked, sound)]
        before, after = parts if looked.faults else (None, None)
        top = before or after or self._without(looked, motion, false_alarm)
        top = top or self._compared(self.ledger, motion, false_alarm)
        faults = tuple(
            replace(fault, since=self._taken.at(fault.since), until=fault.until and self._taken.at(fault.until))
            for fault in looked.faults
        )
        return replace(self._with_course(self._of_all(top)), faults=faults, before=before, after=after)

    def _of_all(self, top: ParityResult) -> ParityResult:
        """Adds the sensors that took no part, about which nothing is known."""
        seen = {sensor.name: sensor for sensor in top.sensors}
        kept = np.array([name in seen for name in self.reference.names])
        course, sigma = np.full((len(top.course), len(kept)), np.nan), np.full(len(kept), np.nan)
        course[:, kept], sigma[kept] = top.course, top.course_sigma
        unseen = (SensorParity(name, 0.0, NOTHING, NOTHING, NOTHING) for name in self.reference.names)
        sensors = tuple(seen.get(sensor.name, sensor) for sensor in unseen)
        return replace(top, sensors=sensors, course=course, course_sigma=sigma)

    def _parts(self, looked: Looked, sound: list[int]) -> Iterator[Ledger]:
        """The part before the first fault and that after the last has begun or ended.

        A sensor that says nothing takes no part in what follows its failure, if enough remain.
        """
        blocks, length = self.ledger.blocks(), self.ledger.length / (self._rate or 1.0)
        everyone = np.arange(len(self.reference.names))
        living = np.array(sound) if len(sound) >= FEWEST else everyone
        begun = [fault.since - fault.since_sigma for fault in looked.faults]
        over = [fault.since + fault.since_sigma if fault.until is None else fault.until for fault in looked.faults]
        if looked.faults:
            yield self.ledger.part((blocks.first + 1) * length <= min(begun), everyone)
            yield self.ledger.part(blocks.first * length >= max(over), living)

    def _without(self, looked: Looked, motion: str, false_alarm: float) -> ParityResult | None:
        """The result of the sensors that do not fail, all through the recording; None where too few are left."""
        failed = {name for fault in looked.faults for name in fault.suspects}
        kept = np.array([k for k, name in enumerate(self.reference.names) if name not in failed])
        if not failed or len(kept) < FEWEST:
            return None
        return self._part(self.ledger.part(np.ones(len(self.ledger.blocks()), dtype=bool), kept), motion, false_alarm)

    def _part(self, ledger: Ledger, motion: str, false_alarm: float) -> ParityResult | None:
        """The result of a part of the recording; None where it is too short."""
        try:
            return self._compared(ledger, motion, false_alarm)
        except ScheduleError:
            return None

    def _compared(self, ledger: Ledger, motion: str, false_alarm: float) -> ParityResult:
        """Tests whether a parameter has changed since the calibration."""
        selection = select(ledger, motion, self._norm, self._rate)
        allowed = nuisance_of(
            selection.blocks, selection.rest, ledger.reference, self._norm, self._rate, arms=motion != ANY
        )
        still = ParityEvidence(regress(selection, ledger.reference, self._norm))
        change = freed(selection, ledger.reference, self._norm, allowed)
        return self._judged(ledger, selection, change, ParityEvidence(change), still, false_alarm)

    def _with_course(self, result: ParityResult) -> ParityResult:
        """Adds the fine course of every sensor over the whole recording, for people to look at."""
        blocks, start, span = coarse(self.ledger.blocks())
        P = self.reference.parity @ self.reference.parity.T
        second = self.ledger.length / (self._rate or self.ledger.length)
        noise = np.median((blocks.halves @ P) ** 2, axis=0) / chdtri(1, 0.5)
        return replace(
            result,
            course_fine=blocks.mean @ P,
            course_fine_time=self._taken.at((start + (blocks.first + 0.5) * span) * second),
            course_fine_sigma=np.sqrt(noise),
        )

    def _judged(
        self,
        ledger: Ledger,
        selection: BlockSelection,
        change: ParityChange,
        evidence: ParityEvidence,
        still: ParityEvidence,
        false_alarm: float,
    ) -> ParityResult:
        """All that is said of a recording."""
        detected = evidence.detected(false_alarm)
        moving = not detected and still.detected(false_alarm)
        candidates = evidence.candidates() if detected else []
        named = {h.sensor for h in candidates}
        explained = not detected or evidence.explained(candidates[0])
        isolated = candidates if explained and len(named) == 1 else []
        names = ledger.reference.names
        fitted = change.excited @ change.theta
        spread = np.kron(change.excited, np.eye(change.theta.shape[1]))
        return ParityResult(
            unit=self.unit,
            kind=self.reference.kind,
            sensors=tuple(evidence.sensor(i, false_alarm, isolated) for i in range(len(names))),
            chi2=evidence.chi2,
            dof=len(evidence.seen),
            p_value=evidence.p_value(evidence.chi2, len(evidence.seen)),
            detected=detected,
            false_alarm=false_alarm,
            candidates=tuple(map(evidence.candidate, candidates)),
            isolated=names[isolated[0].sensor] if isolated else None,
            explained=explained,
            complete=change.complete,
            constant=fitted[0],
            slope=fitted[1:].T / change.norm,
            covariance=spread @ change.covariance @ spread.T,
            excited=change.excited,
            unobservable=COMMON,
            residual_rms=change.residual_rms,
            blocks=selection.total,
            used=len(selection.blocks),
            groups=selection.groups,
            left_out=selection.left_out,
            saturated=selection.saturated,
            clipped=clipped(ledger, selection.saturated),
            moving=moving,
            chi2_unmoved=still.chi2,
            p_value_unmoved=still.p_value(still.chi2, len(still.seen)),
            suspects=tuple(map(still.candidate, still.candidates())) if moving else (),
            motion_share=evidence.share(change.motion),
            block_seconds=None if self._rate is None else ledger.length / self._rate,
            duration=self._duration(ledger),
            course=change.course,
            course_sigma=change.course_sigma,
            course_time=self._middles(selection),
        )

    def _duration(self, ledger: Ledger) -> float | None:
        """s of a part, or of the whole with what its last block lacks."""
        if self._rate is None:
            return None
        return (self._samples if ledger is self.ledger else float(ledger.blocks().samples.sum())) / self._rate

    def _middles(self, selection: BlockSelection) -> Array:
        """(groups,) middle of each group, s since the start, or a number of blocks where no rate is known."""
        share = np.bincount(selection.group)
        middle = np.bincount(selection.group, weights=selection.blocks.first + 0.5) / share
        return np.asarray(middle if self._rate is None else middle * self.ledger.length / self._rate)


def clipped(ledger: Ledger, names: tuple[str, ...]) -> dict[str, float]:
    """Share of the samples in which the channels stood at an end of their range."""
    top, bottom = ledger.ends
    share = (top.clipped + bottom.clipped) / max(ledger.samples, 1)
    return {name: float(share[ledger.reference.names.index(name)]) for name in names}


def parity_check(
    session: CalibrationSession, calibration: Calibration, *, motion: str = AUTO, false_alarm: float = FALSE_ALARM
) -> ParityResult:
    """Compare a recording with the calibration that its unit's readings are corrected by.

    Parameters
    ----------
    session : any rows of a block with more than three sensors of its kind, samples of a raw log or averages.
    calibration : the reference.
    motion, false_alarm : see `ParityAccumulator.result`.

    Raises
    ------
    ScheduleError
        No redundancy, a sensor that the reference does not know, too short, saturated most of the time, or not at rest
        where rest is asked for.
    """
    accumulator = ParityAccumulator(
        session.unit,
        session.sensors,
        calibration,
        kind=session.block,
        sample_rate=session.sample_rate,
        site=session.site,
        count_time=session.count_time,
    )
    accumulator.add(session.readings, session.time if session.is_raw else None)
    return accumulator.result(motion=motion, false_alarm=false_alarm)
