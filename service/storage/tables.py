"""The tables. What was measured and computed is written once; only summaries that can be rebuilt are ever updated:
`conditions`, `outlooks`, `flags`, `fleet_tables`, `jobs`, and of a session the revision in force, its verdict and its
stage.

unit_types ──< tolerance_revisions          stands ──< stand_certificates, append-only
    └──< units ──< services                   │
           ├──< notes ──1 note_withdrawals    │
           ├──< flags ──┐                     │
           ├──< notices ┴──< deliveries >── webhooks
           ├──1 conditions                    │
           ├──1 outlooks, ──< histories
           └──< sessions >────────────────────┘
                   ├──< calibrations          refusals   what was turned away
                   ├──< parameters            audit      who did what when, append-only
                   ├──< decisions
                   ├──< common_motions
                   ├──1 diagnoses, session_statistics
                   ├──< reference_choices     record_states   what became of sessions and services, append-only
                   ├──< certificates ──< certificate_signatures, certificate_files   papers issued, append-only
                   └──< model_revisions ──< recomputations   causes that engineers accepted, and what they moved
group_diagnoses                                what the sessions of a unit, a unit type or a stand show together
saved_views                                    lists as people asked for them, under a name
work                                           what is still to be done beside the requests, and who is at it
jobs                                           long work that somebody asked for, and how far it has come
accounts ──< tokens, sign_ins, sign_in_links, identities   who may sign in, and what they show for it; attempts
"""

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, ForeignKey, Index, LargeBinary, MetaData, String, UniqueConstraint, false
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

from service.storage.columns import BYTES, IS_FAILED, IS_OPEN, IS_QUESTIONED, IS_WAITING, UtcDateTime, only_where


class Base(DeclarativeBase):
    """All tables, with constraint names that migrations can rely on."""

    metadata = MetaData(
        naming_convention={
            "ix": "ix_%(table_name)s_%(column_0_N_name)s",
            "uq": "uq_%(table_name)s_%(column_0_N_name)s",
            "fk": "fk_%(table_name)s_%(column_0_name)s",
            "pk": "pk_%(table_name)s",
        }
    )
    type_annotation_map = {  # noqa: RUF012 - SQLAlchemy reads it from the class
        datetime: UtcDateTime(),
        dict[str, Any]: JSON(),
        list[Any]: JSON(),
        bytes: LargeBinary(),
    }


class UnitTypeRow(Base):
    """A kind of unit; its tolerances are in `ToleranceRow`, the largest revision holds."""

    __tablename__ = "unit_types"
    id: Mapped[int] = mapped_column(primary_key=True)
    name: Mapped[str] = mapped_column(String(200), unique=True)
    block: Mapped[str] = mapped_column(String(40))
    sensors: Mapped[list[Any]]
    nominal_axes: Mapped[list[Any]]
    nominal_scales: Mapped[list[Any]]
    revision: Mapped[int]
    maximum_interval_days: Mapped[float]


class ToleranceRow(Base):
    """One revision of a type's tolerances; never changed, so that past decisions keep theirs."""

    __tablename__ = "tolerance_revisions"
    unit_type_id: Mapped[int] = mapped_column(ForeignKey("unit_types.id"), primary_key=True)
    revision: Mapped[int] = mapped_column(primary_key=True)
    since: Mapped[datetime]
    tolerances: Mapped[dict[str, Any]]
    gyro_tolerances: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))


class UnitRow(Base):
    """One physical IMU."""

    __tablename__ = "units"
    id: Mapped[int] = mapped_column(primary_key=True)
    serial: Mapped[str] = mapped_column(String(200), unique=True)
    unit_type_id: Mapped[int] = mapped_column(ForeignKey("unit_types.id"), index=True)
    simulated: Mapped[bool]
    lot: Mapped[str | None] = mapped_column(String(200))
    customer: Mapped[str] = mapped_column(String(200), server_default="")
    customer_address: Mapped[str] = mapped_column(String(2000), server_default="")


class StandRow(Base):
    """A stand that sessions were measured on."""

    __tablename__ = "stands"
    id: Mapped[int] = mapped_column(primary_key=True)
    name: Mapped[str] = mapped_column(String(200), unique=True)


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
    uploaded_at: Mapped[datetime]
    verdict: Mapped[str] = mapped_column(String(20))
    reason: Mapped[str]
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
    tells: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))
    temperature: Mapped[float | None]
    is_check: Mapped[bool] = mapped_column(server_default=false())


class CalibrationRow(Base):
    """The whole imu-calibration/1 of a session under one model revision, and its verdict; JSON, deflated."""

    __tablename__ = "calibrations"
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), primary_key=True)
    revision: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    method: Mapped[str] = mapped_column(String(80))
    document: Mapped[bytes]
    computed_at: Mapped[datetime]
    verdict: Mapped[str] = mapped_column(String(20))
    reason: Mapped[str]
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


class CommonMotionRow(Base):
    """What the axes, or the scales, of all sensors of one kind did together since the reference."""

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


class DiagnosisRow(Base):
    """What the simulation gets wrong about a session: imu-diagnosis/1, deflated, or why there is none."""

    __tablename__ = "diagnoses"
    __table_args__ = (Index("ix_diagnoses_failed", "state", **only_where(IS_FAILED)),)
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), primary_key=True)
    model_revision: Mapped[int]
    state: Mapped[str] = mapped_column(String(20))
    summary: Mapped[str]
    document: Mapped[bytes | None]
    verdict_after: Mapped[str | None] = mapped_column(String(20))
    estimator_version: Mapped[str] = mapped_column(String(40))
    created_at: Mapped[datetime]
    reservations: Mapped[list[Any] | None] = mapped_column(JSON(none_as_null=True))
    """NULL where there are none, so that units with one are found."""
    tells: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))


class ModelRow(Base):
    """One cause accepted into the model of a unit, a unit type or a stand, or withdrawn from it; never changed."""

    __tablename__ = "model_revisions"
    __table_args__ = (Index("ix_model_revisions_scope", "scope", "subject", "id"),)
    id: Mapped[int] = mapped_column(primary_key=True)
    scope: Mapped[str] = mapped_column(String(20))
    subject: Mapped[str] = mapped_column(String(200))
    cause: Mapped[str] = mapped_column(String(60))
    sensors: Mapped[list[Any]]
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), index=True)
    evidence: Mapped[dict[str, Any]]
    accepted_by: Mapped[str]
    note: Mapped[str]
    accepted_at: Mapped[datetime]
    withdraws: Mapped[int | None]


class ConditionRow(Base):
    """A unit's line on the fleet page: its latest session in short, rewritten with every upload."""

    __tablename__ = "conditions"
    __table_args__ = (
        Index("ix_conditions_worst_first", "severity", "margin", "unit_id"),
        Index("ix_conditions_stand_id_last_at", "stand_id", "last_at"),
    )
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    sessions: Mapped[int]
    last_session: Mapped[str] = mapped_column(ForeignKey("sessions.id"))
    severity: Mapped[int]
    margin: Mapped[float | None]
    flags: Mapped[int]
    last_at: Mapped[datetime | None] = mapped_column(index=True)
    stand_id: Mapped[int | None]


class ServiceRow(Base):
    """A known break in a unit's history."""

    __tablename__ = "services"
    __table_args__ = (UniqueConstraint("unit_id", "at", "kind", "sensor"),)
    id: Mapped[int] = mapped_column(primary_key=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"))
    at: Mapped[datetime]
    kind: Mapped[str] = mapped_column(String(40))
    note: Mapped[str]
    recorded_at: Mapped[datetime]
    who: Mapped[str]
    sensor: Mapped[str] = mapped_column(String(200))
    state: Mapped[str] = mapped_column(String(20), default="accepted")


class FlagRow(Base):
    """A matter that somebody must look after, as its notices left it; of one matter only one flag is open."""

    __tablename__ = "flags"
    __table_args__ = (
        Index("ix_flags_unit_id", "unit_id", "id"),
        Index("ix_flags_state", "state", "id"),
        Index("ix_flags_open", "id", **only_where(IS_OPEN)),
        Index("uq_flags_open", "unit_id", "matter", "place", unique=True, **only_where(IS_OPEN)),
    )
    id: Mapped[int] = mapped_column(primary_key=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"))
    matter: Mapped[str] = mapped_column(String(20))
    place: Mapped[str] = mapped_column(String(200))
    state: Mapped[str] = mapped_column(String(20))
    severity: Mapped[int]
    summary: Mapped[str]
    proposal: Mapped[str]
    session_id: Mapped[str | None] = mapped_column(ForeignKey("sessions.id"))
    raised_at: Mapped[datetime]
    changed_at: Mapped[datetime]
    assignee: Mapped[str] = mapped_column(String(200), server_default="")
    assignee_login: Mapped[str] = mapped_column(String(60), server_default="")
    scope: Mapped[str] = mapped_column(String(10), server_default="unit")
    subject: Mapped[str] = mapped_column(String(200), server_default="")


class NoticeRow(Base):
    """What happened to a flag or to a unit's verdict, when and through whom; append-only."""

    __tablename__ = "notices"
    __table_args__ = (Index("ix_notices_flag_id", "flag_id", "id"),)
    id: Mapped[int] = mapped_column(primary_key=True)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"))
    flag_id: Mapped[int | None] = mapped_column(ForeignKey("flags.id"))
    kind: Mapped[str] = mapped_column(String(20))
    at: Mapped[datetime]
    who: Mapped[str]
    text: Mapped[str]
    session_id: Mapped[str | None] = mapped_column(ForeignKey("sessions.id"))


class WebhookRow(Base):
    """An address that is told of notices; one that was removed keeps its deliveries."""

    __tablename__ = "webhooks"
    id: Mapped[int] = mapped_column(primary_key=True)
    url: Mapped[str]
    secret: Mapped[str]
    who: Mapped[str]
    created_at: Mapped[datetime]
    removed_at: Mapped[datetime | None]


class DeliveryRow(Base):
    """One notice on its way to one address: the outbox."""

    __tablename__ = "deliveries"
    __table_args__ = (
        UniqueConstraint("webhook_id", "notice_id"),
        Index("ix_deliveries_next_at", "next_at", **only_where(IS_WAITING)),
        Index("ix_deliveries_failed", "state", **only_where(IS_FAILED)),
    )
    id: Mapped[int] = mapped_column(primary_key=True)
    notice_id: Mapped[int] = mapped_column(ForeignKey("notices.id"))
    webhook_id: Mapped[int] = mapped_column(ForeignKey("webhooks.id"))
    state: Mapped[str] = mapped_column(String(20))
    attempts: Mapped[int]
    next_at: Mapped[datetime]
    outcome: Mapped[str]


class RefusalRow(Base):
    """An upload that could not be used; its bytes are not kept."""

    __tablename__ = "refusals"
    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime] = mapped_column(index=True)
    filename: Mapped[str]
    sha256: Mapped[str] = mapped_column(String(64))
    size: Mapped[int] = mapped_column(BYTES)
    problems: Mapped[list[Any]]


class AuditRow(Base):
    """Who did what when, each line with a hash of itself and of the one before; the database refuses to change it."""

    __tablename__ = "audit"
    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime] = mapped_column(index=True)
    who: Mapped[str]
    account: Mapped[str] = mapped_column(String(260), server_default="")
    action: Mapped[str] = mapped_column(String(40))
    subject: Mapped[str]
    details: Mapped[dict[str, Any]]
    hash: Mapped[str] = mapped_column(String(64), server_default="")
