"""Every table of every subject, for migrations, backups and tests.

What was measured and computed is written once; only summaries that can be made again are ever updated: `conditions`,
`outlooks`, `flags`, `jobs`, counts of the fleet, and of a session the revision in force, its verdict and its stage.

unit_types ──< tolerance_revisions          stands ──< stand_certificates, append-only
    └──< units ──< services                   │
           ├──< custody                       │      where units are and who has them, append-only
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
work                                           what is still to be done in the background, and who is at it
jobs                                           long work that somebody asked for, and how far it has come
accounts ──< tokens, sign_ins, sign_in_links, identities   who may sign in, and what they show for it; attempts
"""

from service.diagnosis import tables as diagnosis
from service.flags import tables as flags
from service.fleet import tables as fleet
from service.groups import tables as groups
from service.jobs import tables as jobs
from service.models import tables as models
from service.outlook import tables as outlook
from service.papers import tables as papers
from service.people import tables as people
from service.queue import tables as queue
from service.sessions import tables as sessions
from service.stands import tables as stands
from service.storage import audit
from service.storage.tables import Base
from service.types import tables as types
from service.units import tables as units
from service.uploads import tables as uploads

SUBJECTS = (
    audit, people, types, units, sessions, models, stands, diagnosis, queue, jobs, outlook, groups, flags, fleet,
    papers, uploads,
)  # fmt: skip
"""Modules in which tables are defined."""
METADATA = Base.metadata
