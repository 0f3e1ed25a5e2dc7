"""The tables of unit types and the revisions of their tolerances.

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

from sqlalchemy import JSON, ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


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
