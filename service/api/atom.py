"""Atom (RFC 4287): what happened to flags and verdicts, newest first."""

from collections.abc import Sequence
from urllib.parse import quote

from lxml.builder import ElementMaker

from service.records.flag import Notice, NoticeKind
from service.reports.xml import ILLEGAL, Element, document

NAMESPACE = "http://www.w3.org/2005/Atom"
"""Section 1.2 of the standard."""
NEVER = "1970-01-01T00:00:00+00:00"
"""Stands where the standard wants the date of the last change and there was none."""
TITLES = {
    NoticeKind.RAISED: "flag raised",
    NoticeKind.SEEN: "flag seen again",
    NoticeKind.CLEAR: "flag no longer seen",
    NoticeKind.ACKNOWLEDGED: "flag acknowledged",
    NoticeKind.ASSIGNED: "flag assigned",
    NoticeKind.RESOLVED: "flag resolved",
    NoticeKind.VERDICT: "verdict changed",
}
"""Of entries, after the unit."""


def _write(element: Element, text: str) -> None:
    element.text = _legal(text)


ATOM = ElementMaker({str: _write}, NAMESPACE, {None: NAMESPACE})
"""``ATOM.name(...)`` makes an element of its children or its text, without what XML cannot hold."""


def atom_feed(notices: Sequence[Notice], address: str, site: str) -> bytes:
    """The feed; an entry's identifier is the same wherever and whenever it is read."""
    feed = ATOM.feed(
        ATOM.id(address),
        ATOM.title("imu-health: flags and verdicts"),
        ATOM.updated(notices[0].at.isoformat() if notices else NEVER),
        ATOM.link(rel="self", href=_legal(address)),
        ATOM.link(rel="alternate", href=_legal(site)),
        ATOM.author(ATOM.name("imu-health")),
        *(_entry(notice, _legal(site)) for notice in notices),
    )
    return document(feed)


def _entry(notice: Notice, site: str) -> Element:
    return ATOM.entry(
        ATOM.id(f"urn:uuid:{notice.key}"),
        ATOM.title(f"{notice.unit}: {TITLES[notice.kind]}"),
        ATOM.updated(notice.at.isoformat()),
        ATOM.link(rel="alternate", href=f"{site}units/{quote(notice.unit)}#flags"),
        ATOM.category(term=notice.kind.value),
        ATOM.author(ATOM.name(notice.who)),
        ATOM.content(notice.text, type="text"),
    )


def _legal(text: str) -> str:
    return ILLEGAL.sub("", text)
