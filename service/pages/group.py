"""What a group of sessions shows, as a section of the page of its unit, unit type or stand."""

from dataclasses import dataclass
from urllib.parse import quote

from service.flows.refresh_group import current
from service.judging.model_in_force import in_force
from service.records.group import Group, Level
from service.storage.group_document import read_group
from service.storage.queries.models import ModelQuery
from service.storage.store import Store
from service.words.group_finding import SCOPES, GroupView, group_view

HOMES = {Level.UNIT: "units", Level.TYPE: "unit-types", Level.STAND: "stands"}
"""Of the pages of groups, and of their answers as JSON."""
MOST_FOUND = 4
"""Groups that the fleet page names before it counts the rest."""
MOST_REVISIONS = 10_000
"""More than anybody accepts."""


@dataclass(frozen=True)
class GroupSection:
    """Everything the section shows."""

    group: Group
    view: GroupView | None
    """None until it is made of the group's records of now."""
    failed: str
    """Why it cannot be made; empty else."""


@dataclass(frozen=True)
class FoundLine:
    """What was found anywhere, in one line."""

    found: tuple[tuple[str, str, str], ...]
    """Address of its page, whose sessions, and what they show together."""
    more: int
    """Others."""


def found_line(store: Store) -> FoundLine | None:
    """Of the fleet page; None where no sessions together show anything."""
    count, found = store.groups.found(MOST_FOUND)
    lines = tuple((home_of(one.group), whose(one.group), one.summary.partition(": ")[2]) for one in found)
    return FoundLine(lines, count - len(lines)) if lines else None


def home_of(group: Group) -> str:
    """The section on the page of a group."""
    return f"/{HOMES[group.level]}/{quote(group.name)}#together"


def whose(group: Group) -> str:
    """``unit type RA-6``."""
    return f"{SCOPES[group.level.value]} {group.name}"


def group_section(store: Store, level: Level, name: str) -> GroupSection:
    """What the sessions of a unit, a unit type or a stand show together, where it is made of its records of now."""
    group = store.groups.find(level, name)
    answer = current(store, group)
    if answer is None:
        return GroupSection(group, None, "")
    if answer.document is None:
        return GroupSection(group, None, answer.summary)
    shown = read_group(answer.document)
    if not shown.sessions:
        return GroupSection(group, None, "")
    accepted = in_force(store.models.page(ModelQuery(limit=MOST_REVISIONS))) if shown.findings else ()
    return GroupSection(group, group_view(answer, shown, accepted), "")
