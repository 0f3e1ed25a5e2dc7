"""A session whose parameters take all that its readings tell finds nothing, and clears nothing."""

import json
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np

from benchmarks.study.degrees_of_freedom import measured
from estimator.session import CalibrationSession
from estimator.writing import session_document
from service.flags.records import Matter
from service.flags.store import FlagQuery, Flags
from service.records.diagnose import diagnose
from service.sessions.records import DiagnosisState
from service.storage import Storage
from service.uploads.receive import upload

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def diagnosed(storage: Storage, session: CalibrationSession, month: int) -> DiagnosisState:
    document = session_document(session) | {"unit": "TRIAD-1", "started_at": f"2026-{month:02}-05T08:00:00Z"}
    received = upload(storage, json.dumps(document).encode(), f"{month}.json", NOW)
    return diagnose(storage, received.id, NOW).state


def test_a_session_without_a_degree_of_freedom_clears_no_flag(storage: Storage) -> None:
    full, _ = measured(3, 30, True, np.random.default_rng(5))
    bare, _ = measured(3, 9, False, np.random.default_rng(6))
    jumped = full.readings + np.outer(np.arange(30) >= 15, (0.0, 0.01, 0.0))
    assert diagnosed(storage, replace(full, readings=jumped), 3) is DiagnosisState.NAMED
    assert diagnosed(storage, bare, 4) is DiagnosisState.UNDECIDED
    with storage.database.reading() as store:
        flags = [f for f in Flags(store).page(FlagQuery("TRIAD-1")) if f.matter is Matter.CAUSE]
    assert any("A2" in f.summary for f in flags)
    assert {f.proposal for f in flags} == {""}
