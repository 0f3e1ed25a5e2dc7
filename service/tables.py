"""Every table of every subject, for migrations, backups and tests."""

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
from service.storage import audit_table as audit
from service.storage.tables import Base
from service.types import tables as types
from service.units import tables as units
from service.uploads import tables as uploads

SUBJECTS = (
    audit, people, types, units, sessions, models, stands, diagnosis, queue, jobs, outlook, groups, flags, fleet,
    papers, uploads,
)  # fmt: skip
"""Where tables are defined."""
METADATA = Base.metadata
"""All of them."""
