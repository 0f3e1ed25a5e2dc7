"""Every table of every subject, for migrations, backups and tests.

Measurements and results are written once; only summaries that can be made again are ever updated: `conditions`,
`outlooks`, `flags`, `jobs`, counts of the fleet, and of a session the revision in force, its verdict and its stage.

unit_types ──< tolerance_revisions          stands ──< stand_certificates, append-only
    └──< units ──< services                   │
           ├──< custody                       │      locations and custodians of units, append-only
           ├──< notes ──1 note_withdrawals    │
           ├──< flags ──┐                     │
           ├──< notices ┴──< deliveries >── webhooks
           ├──1 conditions                    │
           ├──1 outlooks, ──< histories
           └──< sessions >────────────────────┘
                   ├──< calibrations          refusals   refused uploads
                   ├──< parameters            audit      actions of people, append-only
                   ├──< decisions
                   ├──< common_motions
                   ├──1 diagnoses, session_statistics
                   ├──< reference_choices     record_states   states of sessions and services, append-only
                   ├──< certificates ──< certificate_signatures, certificate_files   papers issued, append-only
                   └──< model_revisions ──< recomputations   accepted causes, and their effects
group_diagnoses                                joint diagnoses of the sessions of a unit, a unit type or a stand
work                                           pending background work, and the process that does it
jobs                                           requested long work, and its progress
accounts ──< tokens, sign_ins, sign_in_links, identities   accounts, their credentials, and attempts to sign in
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
