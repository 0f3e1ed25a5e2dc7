"""Answers to a folder, from its files alone: by the diagnosis, or by a rival at a threshold that sound sessions set.

What was made of each session is kept beside the answers while they are made, so that a run that was cut off goes on.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.blind.entrants import ENTRANTS, OURS, Entrant
from benchmarks.blind.folder import Secret, numbers
from benchmarks.blind.given import SAID, Claim, Given, said
from estimator import diagnose

ALARMS = 0.01
"""Share of sound sessions in which a rival names something."""
Look = dict[str, Any]
"""Answers to one session by name of the entrant: an answer, or ``record`` (findings) and ``claims``."""


def looks(folder: Path, names: Sequence[str], parts: Path, processes: int) -> Iterator[Look]:
    """The look of each entrant at every session, in order; those in ``parts`` already are read."""
    done = [json.loads(line) for line in parts.read_text("utf-8").splitlines()] if parts.exists() else []
    if any(set(look) != set(names) for look in done):
        raise ValueError(f"{parts} is of a run by others: remove it, or name them")
    yield from done
    left = numbers(folder)[len(done) :]
    with parts.open("a", encoding="utf-8") as file:
        for look in _each(partial(look_at, folder, names), left, processes):
            file.write(json.dumps(look) + "\n")
            file.flush()
            yield look


def _each(one: "partial[Look]", wanted: Sequence[str], processes: int) -> Iterator[Look]:
    if processes == 1:
        yield from map(one, wanted)
        return
    with get_context("spawn").Pool(processes) as pool:
        yield from pool.imap(one, wanted)


def look_at(folder: Path, names: Sequence[str], number: str) -> Look:
    """One session."""
    given = Given.of(folder / number)
    return {name: ours(given) if name == OURS else claimed(given, ENTRANTS[name]) for name in names}


def ours(given: Given) -> dict[str, Any]:
    """The diagnosis; a failure of the numerics is an answer that names nothing."""
    try:
        found = diagnose(given.session, history=given.history).to_dict()
    except (ArithmeticError, ValueError):
        return {"findings": [], "unexplained": False}
    findings = [{name: finding[name] for name in SAID} for finding in found["findings"]]
    return {"findings": findings, "unexplained": found["unexplained"]}


def claimed(given: Given, entrant: Entrant) -> dict[str, Any]:
    """A rival's claims, and what it puts right of the record; a failure of the numerics claims nothing."""
    try:
        record = [said(finding) for finding in given.of_record()] if entrant.puts_right else []
        return {"record": record, "claims": entrant.method(given)}
    except (ArithmeticError, ValueError):
        return {"record": [], "claims": []}


@dataclass(frozen=True)
class Threshold:
    """The threshold above which a rival's claims are its answer."""

    entrant: Entrant
    level: float

    @classmethod
    def of(cls, name: str, sound: Sequence[Look]) -> "Threshold":
        """The threshold that `ALARMS` of sound sessions pass; for a rival that is given the cause, over all causes in
        all of them.
        """
        entrant = ENTRANTS[name]
        values = [[claim[0] for claim in look[name]["claims"]] for look in sound]
        each = (
            [s for own in values for s in own]
            if entrant.is_given_cause
            else [max(own, default=-np.inf) for own in values]
        )
        return cls(entrant, float(np.quantile(each, 1 - ALARMS, method="higher")))

    def answer(self, look: Mapping[str, Any], acting: Sequence[str]) -> dict[str, Any]:
        """``acting``: the causes that act, for the rival that knows them."""
        claims = [Claim(*claim) for claim in look["claims"]]
        if self.entrant.is_given_cause:
            claims = [claim for claim in claims if claim.finding and claim.finding["cause"] in acting]
        passed = [claim.finding for claim in claims if claim.statistic > self.level]
        return {"findings": [*look["record"], *filter(None, passed)], "unexplained": None in passed}


def causes_given(secret: Secret, looked: Sequence[Look], name: str) -> list[list[str]]:
    """The causes that act in every session; where none of the catalogue's does, one of those looked for, in turn."""
    acting = []
    for k, ((_, case), look) in enumerate(zip(secret.cases(), looked, strict=True)):
        known = [claim[1]["cause"] for claim in look[name]["claims"]]
        acts = [truth.effect.cause for truth in case.truths] if case.kind != "outside" else []
        acting.append(acts or known[k % max(len(known), 1) :][:1])
    return acting
