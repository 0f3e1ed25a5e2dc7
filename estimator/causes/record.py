"""Causes in the record: what was written down is not what was done."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np

from estimator.causes.contract import CommonCause, Entry, RecordCorrection, SensorCause, Setting
from estimator.forward import jacobian
from estimator.session import ACCELEROMETER, Array, CalibrationSession


class AlphaEntry(Entry):
    identifier = "alpha-entry"
    scope = "record"
    equation = "true α = α + k"
    units = ("rad",)
    needs = frozenset({"stand", "nominal or history"})
    between = True
    sentence = "The elevation α in the record is not the one that the head was set to."
    advice = "Read the elevation off the stand again, correct the record and upload it again."

    def change(self, setting: Setting) -> Array:
        """(R, m, 3, 1) m/s² (rad/s) per rad: α acts on accelerometers; a block of gyros alone has χ in its place."""
        assert setting.d_alpha is not None
        acts = np.array([kind == ACCELEROMETER or ACCELEROMETER not in setting.kinds for kind in setting.kinds])
        return (setting.d_alpha * acts[None, :, None])[..., None]

    def corrected_by(self, session: CalibrationSession, amount: float) -> CalibrationSession:
        stand = session.stand
        assert stand is not None
        if any(s.kind == ACCELEROMETER for s in session.sensors):
            assert stand.alpha is not None
            return replace(session, stand=replace(stand, alpha=stand.alpha + amount))
        assert stand.chi is not None
        return replace(session, stand=replace(stand, chi=stand.chi + amount))


class GravityEntry(CommonCause):
    identifier = "gravity-entry"
    scope = "record"
    equation = "true g = g·(1 + k): all K change by one factor"
    units = ("1",)
    needs = frozenset({"history"})
    kind = ACCELEROMETER
    between = True
    sentence = "All scale factors changed by one factor: latitude, height or gravity in the record is wrong."
    advice = "Check latitude, height and gravity in the record; no sensor needs repair."

    def change(self, setting: Setting) -> Array:
        """(R, m, 3, 1) n itself, m/s², per relative change of g."""
        acts = np.array([kind == ACCELEROMETER for kind in setting.kinds], dtype=float)
        return (setting.n * acts[None, :, None])[..., None]


class SensorDrift(SensorCause):
    """Amplitudes: relative scale, bias, and the axis' turn along its two tangents; zero where nothing moved."""

    identifier = "sensor-drift"
    equation = "K, bias or axis of this sensor alone changed since the history"
    units = ("1", "m/s²", "rad", "rad")
    needs = frozenset({"history"})
    between = True
    moves_parameters = True
    amplitude_words = ("scale factor", "bias", "axis, first tangent", "axis, second tangent")
    sentence = "{sensors} has changed since the earlier sessions, more than stand and fixture explain."
    advice = "Watch this sensor: repeat the session to confirm, and plan its adjustment or replacement."

    moves = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 1), (1, 1, 1, 1))
    """The parameters that may have moved: the scale, the bias or the axis alone, or everything."""

    def grid(self, setting: Setting) -> Iterator[tuple[float, ...]]:
        yield from self.moves

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 4) m/s² (rad/s) per relative scale, unit of bias and rad of each tangent; zero where nothing moved."""
        columns = jacobian(setting.parameters, setting.n, setting.norm)[:, i, :]
        columns[:, 1] = 1.0
        return columns[:, [0, 1, 3, 4]] * np.array(nonlinear)


class RunsSwapped(RecordCorrection):
    identifier = "runs-swapped"
    equation = "direct and flipped labels exchanged"
    needs = frozenset({"stand", "both runs", "nominal or history"})
    sentence = "The direct and the flipped run are exchanged in the record."
    advice = "Exchange the run labels and upload the session again."

    def corrected(self, session: CalibrationSession) -> Iterator[tuple[tuple[int, ...], CalibrationSession]]:
        assert session.flipped is not None
        yield (), replace(session, flipped=~session.flipped)


class BetaReversed(RecordCorrection):
    identifier = "beta-reversed"
    equation = "β counted the wrong way"
    needs = frozenset({"stand", "nominal or history"})
    sentence = "The head's angle was counted in the wrong direction."
    advice = "Change the sign of β and upload the session again."

    def corrected(self, session: CalibrationSession) -> Iterator[tuple[tuple[int, ...], CalibrationSession]]:
        assert session.beta is not None
        yield (), replace(session, beta=-session.beta)


class SignReversed(RecordCorrection):
    identifier = "sign-reversed"
    equation = "u → −u"
    needs = frozenset({"nominal or history"})
    sentence = "The reading of {sensors} has the wrong sign."
    advice = "Check the polarity of this channel's wiring and upload the session again."

    def corrected(self, session: CalibrationSession) -> Iterator[tuple[tuple[int, ...], CalibrationSession]]:
        for i, sensor in enumerate(session.sensors):
            readings = session.readings.copy()
            readings[:, i] = 2 * (sensor.nominal_offset or 0.0) - readings[:, i]
            yield (i,), replace(session, readings=readings)


class ChannelsSwapped(RecordCorrection):
    identifier = "channels-swapped"
    equation = "two sensors' columns exchanged"
    needs = frozenset({"nominal or history"})
    sentence = "The channels of {sensors} are exchanged."
    advice = "Check the wiring or the column headings of these two channels and upload the session again."

    def corrected(self, session: CalibrationSession) -> Iterator[tuple[tuple[int, ...], CalibrationSession]]:
        for i, k in combinations(range(len(session.sensors)), 2):
            if session.sensors[i].kind != session.sensors[k].kind:
                continue
            order = np.arange(len(session.sensors))
            order[[i, k]] = k, i
            yield (
                (i, k),
                replace(
                    session, readings=session.readings[:, order], standard_errors=session.standard_errors[:, order]
                ),
            )


class PositionsSwapped(RecordCorrection):
    identifier = "positions-swapped"
    equation = "two rows exchanged"
    between = False
    of_rows = True
    sentence = "The readings of two positions are exchanged in the record."
    advice = "Exchange the readings of these two rows and upload the session again."

    def corrected(self, session: CalibrationSession) -> Iterator[tuple[tuple[int, ...], CalibrationSession]]:
        for j, k in combinations(range(len(session.readings)), 2):
            yield (j, k), exchange_rows(session, j, k)


def exchange_rows(session: CalibrationSession, j: int, k: int) -> CalibrationSession:
    """The session with the readings of rows j and k exchanged."""
    order = np.arange(len(session.readings))
    order[[j, k]] = k, j
    return replace(session, readings=session.readings[order], standard_errors=session.standard_errors[order])
