"""Sessions as lines of a table, wherever sessions are listed."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.message import say
from estimator.results import Calibration, Residuals
from estimator.session import Array
from service.kit.measures import deviation_measure, number
from service.sessions.records import StoredSession
from service.sessions.words.conditions import Condition, condition_of, said_with


@dataclass(frozen=True)
class SessionLine:
    """One session in a list."""

    session: StoredSession
    condition: Condition


def session_lines(sessions: Sequence[StoredSession]) -> tuple[SessionLine, ...]:
    """Lines in the order of the sessions."""
    return tuple(SessionLine(session, _condition(session)) for session in sessions)


def _condition(session: StoredSession) -> Condition:
    plain = condition_of(session.verdict, is_reference=session.is_reference)
    return said_with(plain, session.reservations)


RUNS = ("direct", "flipped")
"""Names of the runs, by whether the head is turned over."""


@dataclass(frozen=True)
class ResidualRow:
    """One row of the session."""

    number: int
    run: str
    beta: str
    values: tuple[str, ...]


@dataclass(frozen=True)
class ResidualTable:
    """Residuals of all sensors, or other columns, row by row."""

    heads: tuple[str, ...]
    beta: bool
    """Whether the session has angles and runs of a stand."""
    rows: tuple[ResidualRow, ...]


def residual_table(calibration: Calibration) -> ResidualTable:
    """Residuals with the measure in each column's head."""
    found = calibration.residuals
    largest = np.nanmax(np.abs(found.value), axis=0, initial=0.0)
    measures = [deviation_measure(s.kind, "bias", x) for s, x in zip(calibration.sensors, largest, strict=True)]
    shown = found.value * [measure.factor for measure in measures]
    return ResidualTable(
        heads=tuple(
            say("{name}, {label}", name=s.name, label=u.label)
            for s, u in zip(calibration.sensors, measures, strict=True)
        ),
        beta=found.beta is not None,
        rows=rows_of(shown, found),
    )


def rows_of(shown: Array, residuals: Residuals) -> tuple[ResidualRow, ...]:
    """Columns (rows, columns), in people's measures, with the run and the angle of every row."""
    beta, flipped = residuals.beta, residuals.flipped
    return tuple(
        ResidualRow(
            number=row + 1,
            run="" if flipped is None else RUNS[int(flipped[row])],
            beta="" if beta is None else number(float(np.degrees(beta[row])), 1),
            values=tuple(number(float(value)) for value in shown[row]),
        )
        for row in range(len(shown))
    )
