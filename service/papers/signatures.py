"""How the certificates of a session stand: who signed them, and whether they still state what is stored."""

from dataclasses import dataclass

from estimator.message import say
from service.errors import ConflictError
from service.kit.answer import answer
from service.papers.desk import Desk, certified
from service.papers.records import Issue, Meaning, Signature
from service.papers.store import Certificates, Signatures
from service.papers.words import CHANGED_HASH, NO_LONGER, NOT_COUNTED
from service.sessions.store import Sessions


@answer
@dataclass(frozen=True)
class SignedIssue(Issue):
    """One issue of a session's certificate."""

    signatures: tuple[Signature, ...]
    """Who signed it, in their order."""

    @property
    def is_approved(self) -> bool:
        """Whether it is released."""
        return any(signature.meaning is Meaning.APPROVED for signature in self.signatures)


@answer
@dataclass(frozen=True)
class Papers:
    """Every issue of a session's certificate."""

    certificates: tuple[SignedIssue, ...]
    """The first one first; the last one holds."""
    is_current: bool
    """Whether the last one states what is stored now; another number is due if not."""
    concerns: tuple[str, ...]
    """What speaks against using the last one, in words."""


def papers_of(desk: Desk, id: str) -> Papers:
    """Every issue; of the latest one what it rests on is worked out again and compared."""
    with desk.storage.database.reading() as store:
        Sessions(store).get(id)
        issued, signatures = Certificates(store).of_session(id), Signatures(store).of_session(id)
    issues = tuple(
        SignedIssue(**vars(one), signatures=tuple(s for s in signatures if s.certificate == one.number))
        for one in issued
    )
    if not issues:
        return Papers((), is_current=False, concerns=())
    latest = issues[-1]
    counts, is_current = _compared(desk, id, latest)
    told = ((CHANGED_HASH, _is_other(latest)), (NOT_COUNTED, not counts), (NO_LONGER, counts and not is_current))
    concerns = (say(words, number=latest.number, done=_done(latest)) for words, holds in told if holds)
    return Papers(issues, is_current=is_current, concerns=tuple(concerns))


def _compared(desk: Desk, id: str, issue: Issue) -> tuple[bool, bool]:
    """Whether the session counts, and whether its certificate would state the same today."""
    try:
        _, statement = certified(desk, id)
    except ConflictError:
        return False, False
    return True, statement.content_hash == issue.content_hash


def _is_other(latest: SignedIssue) -> bool:
    """Whether something else was signed than is on record."""
    return any(signature.content_hash != latest.content_hash for signature in latest.signatures)


def _done(latest: SignedIssue) -> str:
    return latest.signatures[-1].meaning if latest.signatures else "issued"
