"""The tables of model revisions and recomputations.

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

from sqlalchemy import JSON, ForeignKey, Index, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.columns import IS_WAITING, only_where
from service.storage.tables import Base


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


class RecomputationRow(Base):
    """A unit whose sessions a revision concerns: whether they are computed again, and what moved because of it."""

    __tablename__ = "recomputations"
    __table_args__ = (Index("ix_recomputations_waiting", "asked_at", "revision", "unit_id", **only_where(IS_WAITING)),)
    revision: Mapped[int] = mapped_column(ForeignKey("model_revisions.id"), primary_key=True, autoincrement=False)
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    state: Mapped[str] = mapped_column(String(20))
    asked_at: Mapped[datetime]
    claimed_until: Mapped[datetime | None]
    attempts: Mapped[int]
    """Claims that ended without a word: the process died."""
    failed: Mapped[str | None] = mapped_column(Text)
    """Why the last try failed; NULL where none did."""
    done_at: Mapped[datetime | None]
    outcome: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))
