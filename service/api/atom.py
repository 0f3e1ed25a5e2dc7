"""Atom (RFC 4287): what happened to flags and verdicts, newest first."""

import re
from collections.abc import Sequence
from urllib.parse import quote
from xml.etree.ElementTree import Element, SubElement, register_namespace, tostring

from service.records.flag import Notice, NoticeKind

NAMESPACE = "http://www.w3.org/2005/Atom"
NEVER = "1970-01-01T00:00:00+00:00"
TITLES = {
    NoticeKind.RAISED: "flag raised",
    NoticeKind.SEEN: "flag seen again",
    NoticeKind.CLEAR: "flag no longer seen",
    NoticeKind.ACKNOWLEDGED: "flag acknowledged",
    NoticeKind.RESOLVED: "flag resolved",
    NoticeKind.VERDICT: "verdict changed",
}
NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that no XML document can hold."""

register_namespace("", NAMESPACE)


def atom_feed(notices: Sequence[Notice], address: str, site: str) -> bytes:
    """The feed; an entry's identifier is the same wherever and whenever it is read."""
    feed = Element(_tag("feed"))
    _add(feed, "id", address)
    _add(feed, "title", "imu-health: flags and verdicts")
    _add(feed, "updated", notices[0].at.isoformat() if notices else NEVER)
    _add(feed, "link", rel="self", href=address)
    _add(feed, "link", rel="alternate", href=site)
    _add(SubElement(feed, _tag("author")), "name", "imu-health")
    for notice in notices:
        _entry(feed, notice, site)
    content: bytes = tostring(feed, encoding="utf-8", xml_declaration=True)
    return content


def _entry(feed: Element, notice: Notice, site: str) -> None:
    entry = SubElement(feed, _tag("entry"))
    _add(entry, "id", f"urn:uuid:{notice.key}")
    _add(entry, "title", f"{notice.unit}: {TITLES[notice.kind]}")
    _add(entry, "updated", notice.at.isoformat())
    _add(entry, "link", rel="alternate", href=_page(notice, site))
    _add(entry, "category", term=notice.kind.value)
    _add(SubElement(entry, _tag("author")), "name", notice.who)
    _add(entry, "content", notice.text, type="text")


def _add(parent: Element, name: str, text: str = "", **attributes: str) -> None:
    child = SubElement(parent, _tag(name), {key: NOT_XML.sub("", value) for key, value in attributes.items()})
    child.text = NOT_XML.sub("", text) or None


def _tag(name: str) -> str:
    return f"{{{NAMESPACE}}}{name}"


def _page(notice: Notice, site: str) -> str:
    """Where people read on."""
    return f"{site}units/{quote(notice.unit)}#flags"
