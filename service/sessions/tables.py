"""The tables of sessions: calibrations, parameters, decisions, common motions, noise, states."""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, ForeignKey, Index, String, false, or_
from sqlalchemy.orm import Mapped, mapped_column

from estimator.json_object import Json
from service.storage.columns import BYTES, IS_QUESTIONED, Sentence, only_where
from service.storage.tables import Base


class SessionRow(Base):
    """One uploaded session; the id is the head of the content's hash."""

    __tablename__ = "sessions"
    __table_args__ = (
        Index("ix_sessions_unit_id_started_at", "unit_id", "started_at", "id"),
        Index("ix_sessions_stand_id_started_at", "stand_id", "started_at"),
        Index("ix_sessions_questioned", "uploaded_at", **only_where(IS_QUESTIONED)),
    )
    id: Mapped[str] = mapped_column(String(20), primary_key=True)
    sha256: Mapped[str] = mapped_column(String(64), unique=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"))
    stand_id: Mapped[int | None] = mapped_column(ForeignKey("stands.id"))
    filename: Mapped[str]
    size: Mapped[int] = mapped_column(BYTES)
    block: Mapped[str] = mapped_column(String(20))
    programme: Mapped[str] = mapped_column(String(40))
    operator: Mapped[str]
    notes: Mapped[str]
    started_at: Mapped[datetime] = mapped_column(index=True)
    utc_offset: Mapped[int | None]
    """Minutes, of the place, as the file states it."""
    uploaded_at: Mapped[datetime]
    verdict: Mapped[str] = mapped_column(String(20))
    reason: Mapped[str] = mapped_column(Sentence)
    worst_sensor: Mapped[str | None]
    worst_parameter: Mapped[str | None] = mapped_column(String(20))
    margin: Mapped[float | None]
    is_reference: Mapped[bool]
    simulated: Mapped[bool]
    revision: Mapped[int]
    stage: Mapped[str | None] = mapped_column(String(20))
    state: Mapped[str] = mapped_column(String(20), default="accepted")
    superseded_by: Mapped[str | None] = mapped_column(String(20))
    content_digest: Mapped[str | None] = mapped_column(String(64), index=True)
    readings_digest: Mapped[str | None] = mapped_column(String(64), index=True)
    basis: Mapped[str | None] = mapped_column(String(160), index=True)
    tells: Mapped[Json | None] = mapped_column(JSON(none_as_null=True))
    temperature: Mapped[float | None]
    time_since_power_on: Mapped[float | None]
    is_check: Mapped[bool] = mapped_column(server_default=false())


MOVES_DATES = or_(~SessionRow.is_check, SessionRow.is_reference)
"""A check moves no date; one that is a reference counts, for all changes are counted from it."""


class CalibrationRow(Base):
    """The whole imu-calibration/1 of a session under one model revision, and its verdict; JSON, deflated."""

    __tablename__ = "calibrations"
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), primary_key=True)
    revision: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    method: Mapped[str] = mapped_column(String(80))
    document: Mapped[bytes]
    computed_at: Mapped[datetime]
    verdict: Mapped[str] = mapped_column(String(20))
    reason: Mapped[str] = mapped_column(Sentence)
    worst_sensor: Mapped[str | None]
    worst_parameter: Mapped[str | None] = mapped_column(String(20))
    margin: Mapped[float | None]


class ParameterRow(Base):
    """One parameter of one sensor at one session; for the axis the components instead of a value."""

    __tablename__ = "parameters"
    __table_args__ = (Index("ix_parameters_history", "unit_id", "at", "session_id", "sensor_index", "parameter"),)
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), primary_key=True)
    revision: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    sensor: Mapped[str] = mapped_column(String(200), primary_key=True)
    parameter: Mapped[str] = mapped_column(String(20), primary_key=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"))
    at: Mapped[datetime]
    sensor_index: Mapped[int]
    kind: Mapped[str] = mapped_column(String(20))
    value: Mapped[float | None]
    u: Mapped[float | None]
    axis_x: Mapped[float | None]
    axis_y: Mapped[float | None]
    axis_z: Mapped[float | None]


class DecisionRow(Base):
    """One parameter of one sensor of one session, judged."""

    __tablename__ = "decisions"
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), primary_key=True)
    revision: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    sensor: Mapped[str] = mapped_column(String(200), primary_key=True)
    parameter: Mapped[str] = mapped_column(String(20), primary_key=True)
    position: Mapped[int]
    kind: Mapped[str] = mapped_column(String(20))
    value: Mapped[float | None]
    reference: Mapped[float | None]
    deviation: Mapped[float | None]
    uncertainty: Mapped[float | None]
    expanded: Mapped[float | None]
    coverage_factor: Mapped[float]
    tolerance: Mapped[float]
    guard_band: Mapped[float | None]
    probability_out: Mapped[float | None]
    verdict: Mapped[str] = mapped_column(String(20))
    rule: Mapped[str]
    critical: Mapped[float | None]
    change: Mapped[list[Any] | None] = mapped_column(JSON(none_as_null=True))
    change_own: Mapped[list[Any] | None] = mapped_column(JSON(none_as_null=True))
    change_origin: Mapped[list[Any] | None] = mapped_column(JSON(none_as_null=True))
    common: Mapped[float | None]
    common_sigma: Mapped[float | None]
    common_p: Mapped[float | None]
    dof: Mapped[float | None]
    temperature_correction: Mapped[Json | None] = mapped_column(JSON(none_as_null=True))


class CommonMotionRow(Base):
    """Common motion of the axes, or of the scales, of all sensors of one kind since the reference."""

    __tablename__ = "common_motions"
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), primary_key=True)
    revision: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    kind: Mapped[str] = mapped_column(String(20), primary_key=True)
    quantity: Mapped[str] = mapped_column(String(20), primary_key=True)
    state: Mapped[str] = mapped_column(String(20))
    value: Mapped[list[Any]]
    covariance: Mapped[list[Any]]
    p_value: Mapped[float | None]
    sensors: Mapped[list[Any]]
    left_out: Mapped[list[Any]]


class SessionNoiseRow(Base):
    """imu-noise/1 of one session, with the curves; deflated. The terms are parameters of its history."""

    __tablename__ = "session_noise"
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), primary_key=True)
    document: Mapped[bytes]
    estimator_version: Mapped[str] = mapped_column(String(40))
    made_at: Mapped[datetime]


class RecordStateRow(Base):
    """Changes of state of a session or a service, by whom, when and why; append-only, the last line is its state."""

    __tablename__ = "record_states"
    __table_args__ = (Index("ix_record_states_record", "kind", "record", "id"),)
    id: Mapped[int] = mapped_column(primary_key=True)
    kind: Mapped[str] = mapped_column(String(20))
    record: Mapped[str] = mapped_column(String(20))
    state: Mapped[str] = mapped_column(String(20))
    who: Mapped[str]
    at: Mapped[datetime]
    why: Mapped[str] = mapped_column(Sentence)
    superseded_by: Mapped[str | None] = mapped_column(String(20))
    remedies: Mapped[Json | None] = mapped_column(JSON(none_as_null=True))


class ReferenceChoiceRow(Base):
    """A session that an engineer chose as the reference of its epoch; append-only, the last one that holds is used."""

    __tablename__ = "reference_choices"
    id: Mapped[int] = mapped_column(primary_key=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), index=True)
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"))
    who: Mapped[str]
    at: Mapped[datetime]
    why: Mapped[str] = mapped_column(Sentence)
