"""The table of the audit trail.

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

from sqlalchemy import String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


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
