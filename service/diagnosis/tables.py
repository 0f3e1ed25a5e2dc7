"""The tables of diagnoses and of those still to be made.

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

from sqlalchemy import JSON, ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.columns import IS_FAILED, only_where
from service.storage.tables import Base


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
