"""Step: what a group shows of its own, in a line; what an engineer accepted into a model is known, and left out."""

from estimator.groups import GroupFinding
from estimator.groups.fixed import EMPIRICAL
from service.judging.model_in_force import in_force
from service.records.group import Group, Level
from service.records.model import SCOPES, Scope
from service.storage.group_document import read_group
from service.storage.store import Store
from service.words.group import own_of_group
from service.words.group_finding import holds

LEVELS = {scope: Level(level) for level, scope in SCOPES.items()}
"""Whose sessions show what becomes part of a model."""


def tell_own(store: Store, scope: Scope, subject: str) -> None:
    """Of the stored answer, after it or the model in force changed."""
    group = store.groups.find(LEVELS[scope], subject)
    answer = store.groups.get(group)
    if answer is None or answer.document is None:
        return
    shown = read_group(answer.document)
    known = {r.cause for r in in_force(store.models.of_subject(scope, subject))}
    unexplained = EMPIRICAL not in known and any(text.endswith(f"({group.name})") for text in shown.structures)
    store.groups.put_own(group, own_of_group(group, unknown(store, group, shown.findings), unexplained=unexplained))


def unknown(store: Store, group: Group, findings: tuple[GroupFinding, ...]) -> tuple[GroupFinding, ...]:
    """The findings that no model in force holds."""
    accepted = in_force(store.models.of_subject(SCOPES[group.level.value], group.name))
    return tuple(f for f in findings if not any(holds(revision, f) for revision in accepted))
