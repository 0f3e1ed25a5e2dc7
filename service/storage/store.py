"""Every query, by subject, within one transaction. `Database` makes a store and commits it."""

from functools import cached_property

from sqlalchemy.orm import Session

from service.records.work import WorkKind
from service.storage.queries.accounts import Accounts
from service.storage.queries.announced import Announcements
from service.storage.queries.arrivals import Arrivals
from service.storage.queries.attachments import Attachments
from service.storage.queries.attempts import Attempts
from service.storage.queries.audit import Audit
from service.storage.queries.calibrations import Calibrations
from service.storage.queries.certificates import Certificates
from service.storage.queries.derivations import Derivations
from service.storage.queries.diagnoses import Diagnoses
from service.storage.queries.failures import Failures
from service.storage.queries.flags import Flags
from service.storage.queries.fleet import Fleet
from service.storage.queries.fleet_rows import FleetRows
from service.storage.queries.groups import Groups
from service.storage.queries.history import History
from service.storage.queries.identities import Identities
from service.storage.queries.jobs import Jobs, UploadJobs
from service.storage.queries.layouts import Layouts
from service.storage.queries.log import Log
from service.storage.queries.models import Models
from service.storage.queries.noises import Noises
from service.storage.queries.notes import Notes
from service.storage.queries.notices import Notices
from service.storage.queries.outlooks import Outlooks
from service.storage.queries.populations import Populations
from service.storage.queries.recomputations import Recomputations
from service.storage.queries.said import SaidOf
from service.storage.queries.saved_views import SavedViews
from service.storage.queries.services import Services
from service.storage.queries.sessions import Sessions
from service.storage.queries.sign_ins import SignIns
from service.storage.queries.signatures import Signatures
from service.storage.queries.stand_certificates import StandCertificates
from service.storage.queries.stands import Stands
from service.storage.queries.states import States
from service.storage.queries.statistics import Statistics
from service.storage.queries.tallies import Tallies
from service.storage.queries.tokens import Tokens
from service.storage.queries.unit_types import UnitTypes
from service.storage.queries.units import Units
from service.storage.queries.webhooks import Webhooks
from service.storage.queries.work import WorkQueue


class Store:
    """The stored fleet as one transaction sees it."""

    def __init__(self, session: Session, account: str = "") -> None:
        self._session, self._account = session, account

    @cached_property
    def unit_types(self) -> UnitTypes:
        """Kinds of unit and their tolerances."""
        return UnitTypes(self._session)

    @cached_property
    def units(self) -> Units:
        """Units by serial number."""
        return Units(self._session)

    @cached_property
    def sessions(self) -> Sessions:
        """Uploaded sessions and their decisions."""
        return Sessions(self._session)

    @cached_property
    def noises(self) -> Noises:
        """What the rests of sessions say of noise."""
        return Noises(self._session)

    @cached_property
    def layouts(self) -> Layouts:
        """People's own layouts of tables."""
        return Layouts(self._session)

    @cached_property
    def states(self) -> States:
        """What became of sessions and services."""
        return States(self._session)

    @cached_property
    def derivations(self) -> Derivations:
        """What is derived of accepted sessions."""
        return Derivations(self._session)

    @cached_property
    def calibrations(self) -> Calibrations:
        """Calibrations as they were computed, covariance included."""
        return Calibrations(self._session)

    @cached_property
    def history(self) -> History:
        """Parameters through time."""
        return History(self._session)

    @cached_property
    def diagnoses(self) -> Diagnoses:
        """What the simulation gets wrong."""
        return Diagnoses(self._session)

    def work(self, kind: WorkKind) -> WorkQueue:
        """Work beside the requests that is still to be done."""
        return WorkQueue(self._session, kind)

    @cached_property
    def failures(self) -> Failures:
        """Work beside the requests that has failed."""
        return Failures(self._session)

    @cached_property
    def statistics(self) -> Statistics:
        """What sessions tell of their groups."""
        return Statistics(self._session)

    @cached_property
    def groups(self) -> Groups:
        """Units, unit types and stands as groups of sessions."""
        return Groups(self._session)

    @cached_property
    def populations(self) -> Populations:
        """How the units of types drift."""
        return Populations(self._session)

    @cached_property
    def tallies(self) -> Tallies:
        """Counts of the fleet."""
        return Tallies(self._session)

    @cached_property
    def models(self) -> Models:
        """Causes that engineers accepted, as numbered revisions."""
        return Models(self._session)

    @cached_property
    def recomputations(self) -> Recomputations:
        """What model revisions brought, unit by unit."""
        return Recomputations(self._session)

    @cached_property
    def jobs(self) -> Jobs:
        """Long work that somebody asked for."""
        return Jobs(self._session)

    @cached_property
    def upload_jobs(self) -> UploadJobs:
        """Those of them that take in long files."""
        return UploadJobs(self._session)

    @cached_property
    def services(self) -> Services:
        """Known breaks of units' histories."""
        return Services(self._session)

    @cached_property
    def notes(self) -> Notes:
        """Remarks on units' histories."""
        return Notes(self._session)

    @cached_property
    def attachments(self) -> Attachments:
        """Files that people attached."""
        return Attachments(self._session)

    @cached_property
    def said_of(self) -> SaidOf:
        """What people said of units and sessions."""
        return SaidOf(self._session)

    @cached_property
    def flags(self) -> Flags:
        """Matters that somebody must look after."""
        return Flags(self._session)

    @cached_property
    def notices(self) -> Notices:
        """What happened to flags and verdicts."""
        return Notices(self._session)

    @cached_property
    def stands(self) -> Stands:
        """What stands do to the units that are measured on them."""
        return Stands(self._session)

    @cached_property
    def stand_certificates(self) -> StandCertificates:
        """What the traceability of sessions on stands hangs on."""
        return StandCertificates(self._session)

    @cached_property
    def certificates(self) -> Certificates:
        """Numbers of the certificates that were issued."""
        return Certificates(self._session)

    @cached_property
    def signatures(self) -> Signatures:
        """Who put their name under certificates, and what was approved."""
        return Signatures(self._session)

    @cached_property
    def outlooks(self) -> Outlooks:
        """When units must come back."""
        return Outlooks(self._session)

    @cached_property
    def webhooks(self) -> Webhooks:
        """Addresses that are told of notices, and their outbox."""
        return Webhooks(self._session)

    @cached_property
    def saved_views(self) -> SavedViews:
        """Views of lists that people keep."""
        return SavedViews(self._session)

    @cached_property
    def fleet(self) -> Fleet:
        """All units at a glance."""
        return Fleet(self._session)

    @cached_property
    def announced(self) -> Announcements:
        """What the fleet page says before its list."""
        return Announcements(self._session)

    @cached_property
    def fleet_rows(self) -> FleetRows:
        """What a report of the whole fleet reads."""
        return FleetRows(self._session)

    @cached_property
    def log(self) -> Log:
        """Refused uploads."""
        return Log(self._session)

    @cached_property
    def arrivals(self) -> Arrivals:
        """Uploads, stored or refused."""
        return Arrivals(self._session)

    @cached_property
    def audit(self) -> Audit:
        """Who did what."""
        return Audit(self._session, self._account)

    @cached_property
    def accounts(self) -> Accounts:
        """Who may sign in."""
        return Accounts(self._session)

    @cached_property
    def tokens(self) -> Tokens:
        """What programs show instead of a password."""
        return Tokens(self._session)

    @cached_property
    def sign_ins(self) -> SignIns:
        """Signed-in browsers, and links that sign somebody in once."""
        return SignIns(self._session)

    @cached_property
    def attempts(self) -> Attempts:
        """How often somebody tried to sign in."""
        return Attempts(self._session)

    @cached_property
    def identities(self) -> Identities:
        """Who accounts are to a provider that signs people in."""
        return Identities(self._session)
