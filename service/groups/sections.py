"""Joint diagnosis of a group of sessions, as a section of the page of its unit, unit type or stand."""

from dataclasses import dataclass
from urllib.parse import quote

from estimator.groups import GroupFinding
from estimator.groups.pictures import ANGLES
from estimator.groups.results import Picture
from estimator.message import say
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.fleet.records import Announced
from service.groups.charts import forest_chart, picture_chart, picture_table
from service.groups.records import Group, Level
from service.groups.store import Groups, read_group
from service.groups.words import GroupView, group_view
from service.kit.failure import group_failed
from service.models.records import SCOPES
from service.models.rules import in_force
from service.models.store import ModelQuery, Models
from service.records.refresh_group import rests_on_now
from service.sessions.charts import ChartSet
from service.settings import VERSION
from service.storage.queries import Store

HOMES = {Level.UNIT: "units", Level.TYPE: "unit-types", Level.STAND: "stands"}
"""Path of the pages of groups, and of their answers as JSON, by level."""
MOST_FOUND = 4
"""Groups that the fleet page names before it counts the rest."""
MOST_REVISIONS = 10_000
"""Most revisions that are read, more than anybody accepts."""


@dataclass(frozen=True)
class Drawn:
    """Charts of an effect or of a learned term, and what the last of them shows as a table."""

    forest: ChartSet | None
    picture: ChartSet | None
    is_angle: bool
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class GroupSection:
    """Everything the section shows."""

    group: Group
    view: GroupView | None
    """Contents of the section; None until it is made of the group's current records."""
    failed: str
    """Reason why it cannot be made; empty otherwise."""
    effects: tuple[Drawn, ...] = ()
    """Charts of every effect in turn."""
    terms: tuple[Drawn, ...] = ()
    """Charts of every learned term in turn."""


@dataclass(frozen=True)
class FoundLine:
    """Findings of all groups in one line."""

    found: tuple[tuple[str, str, str], ...]
    """Address of the group's page, the group in words, and its findings."""
    more: int
    """Number of other groups."""


def found_line(announced: Announced) -> FoundLine | None:
    """The line of the fleet page; None where no group has findings."""
    lines = tuple((home_of(shown.group), whose(shown.group), shown.own) for shown in announced.found)
    return FoundLine(lines, announced.groups - len(lines)) if lines else None


def home_of(group: Group) -> str:
    """The section on the page of a group."""
    return f"/{HOMES[group.level]}/{quote(group.name)}#together"


def whose(group: Group) -> str:
    """``unit type RA-6``."""
    return say("{scopes} {name}", scopes=SCOPES[group.level.value], name=group.name)


def group_section(store: Store, level: Level, name: str) -> GroupSection:
    """The joint diagnosis of a unit, a unit type or a stand; without a view where it is not made of the current records
    yet.
    """
    group, answer, is_asked, failed = Groups(store).known(level, name)
    if failed:
        return GroupSection(group, None, group_failed(failed))
    if answer is None or answer.is_of_another(VERSION):
        return GroupSection(group, None, "")
    if is_asked and (level is not Level.UNIT or not rests_on_now(store, group, answer)):
        return GroupSection(group, None, "")
    if answer.document is None:
        return GroupSection(group, None, answer.summary)
    shown = read_group(answer.document)
    if not shown.sessions:
        return GroupSection(group, None, "")
    accepted = in_force(Models(store).page(ModelQuery(limit=MOST_REVISIONS))) if shown.findings or shown.terms else ()
    return GroupSection(
        group,
        group_view(shown, accepted),
        "",
        effects=tuple(_drawn_effect(f, f"effect-{k}") for k, f in enumerate(shown.findings, 1)),
        terms=tuple(_drawn(None, t.picture, t.units[0], f"term-{k}") for k, t in enumerate(shown.terms, 1)),
    )


def _drawn_effect(finding: GroupFinding, name: str) -> Drawn:
    return _drawn(forest_chart(finding, name), finding.picture, "rad/s" if finding.kind == GYROSCOPE else "", name)


def _drawn(forest: ChartSet | None, picture: Picture | None, unit: str, name: str) -> Drawn:
    if picture is None:
        return Drawn(forest, None, False, (), ())
    kind = GYROSCOPE if unit.startswith("rad/s") else ACCELEROMETER
    return Drawn(forest, picture_chart(picture, kind, name), picture.of in ANGLES, *picture_table(picture, kind))
