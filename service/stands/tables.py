"""The tables of stands: what units show of them, their conditions and certificates.

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

transaction, and what types and stands show, which is asked for there and made beside the requests. All of it is a
function of the other tables and can be made again.

    tallied       ──> fleet_tallies     what every unit adds to the counts, and the counts
    stand_units   ──> stand_tallies     the same by stand
    work ──> populations, stand_conditions
"""

from datetime import date, datetime
from typing import Any

from sqlalchemy import ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class StandRow(Base):
    """A stand that sessions were measured on."""

    __tablename__ = "stands"
    id: Mapped[int] = mapped_column(primary_key=True)
    name: Mapped[str] = mapped_column(String(200), unique=True)


class StandUnitRow(Base):
    """How many accepted sessions of a unit were measured on a stand."""

    __tablename__ = "stand_units"
    unit_id: Mapped[int] = mapped_column(ForeignKey("units.id"), primary_key=True, autoincrement=False)
    stand_id: Mapped[int] = mapped_column(ForeignKey("stands.id"), primary_key=True, autoincrement=False)
    sessions: Mapped[int]


class StandTallyRow(Base):
    """How many accepted sessions were measured on a stand, of how many units."""

    __tablename__ = "stand_tallies"
    stand_id: Mapped[int] = mapped_column(ForeignKey("stands.id"), primary_key=True, autoincrement=False)
    sessions: Mapped[int]
    units: Mapped[int]


class StandConditionRow(Base):
    """A stand's own health, as the units measured on it show it."""

    __tablename__ = "stand_conditions"
    stand_id: Mapped[int] = mapped_column(ForeignKey("stands.id"), primary_key=True, autoincrement=False)
    shifts: Mapped[int]
    """How many are known, those that were taken back too."""
    document: Mapped[dict[str, Any]]
    made_at: Mapped[datetime]


class StandCertificateRow(Base):
    """A certificate of a stand as it was recorded; of one number the latest row holds. Append-only."""

    __tablename__ = "stand_certificates"
    id: Mapped[int] = mapped_column(primary_key=True)
    stand_id: Mapped[int] = mapped_column(ForeignKey("stands.id"), index=True)
    number: Mapped[str] = mapped_column(String(200))
    issued_by: Mapped[str] = mapped_column(String(200))
    issued_on: Mapped[date]
    valid_until: Mapped[date]
    who: Mapped[str]
    recorded_at: Mapped[datetime]
