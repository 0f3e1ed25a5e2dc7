"""Many who change the same units, types and flags at once, in any order: nobody waits for one who waits for him."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from random import Random

import httpx
import psycopg
import pytest

from service.settings import Settings
from tests.patience import until
from tests.service.made_sessions import session_bytes
from tests.serving import TLS, serving

UNITS, CLIENTS, EACH = ("BA-101", "BA-202", "BA-303"), 8, 9
BY = {"by": "K. Ito", "why": "seen"}
Change = tuple[str, str, object]


def changes(number: int, ids: list[str], flags: list[int], kind: str) -> Iterator[Change]:
    """Requests of one client, one after another: method, path and body."""
    chance = Random(number)
    for step in range(EACH):
        unit, session = chance.choice(UNITS), chance.choice(ids)
        several = chance.sample(flags, len(flags))
        tolerances = {"scale": 1e-4, "bias": 5e-4 * chance.choice([1, 2]), "quadratic": None, "axis": 1e-4}
        yield chance.choice(
            [
                ("POST", "sessions", session_bytes(unit=unit, seed=100 * number + step, month=4 + step % 9)),
                ("POST", f"units/{unit}/recalibrate", None),
                ("POST", f"units/{unit}/services", {"kind": "service", "at": f"2026-02-{10 + step}T09:00:00Z"}),
                ("PUT", f"units/{unit}/lot", {"lot": chance.choice(["A", "B"])}),
                ("PUT", f"unit-types/{kind}", {"tolerances": tolerances, "gyro_tolerances": None}),
                ("POST", "flags/assign", BY | {"to": f"Person {number}", "flags": several}),
                ("POST", f"sessions/{session}/{chance.choice(['withdraw', 'accept'])}", BY),
                ("POST", f"sessions/{session}/supersede", BY | {"superseded_by": None}),
            ]
        )


@pytest.mark.slow
@pytest.mark.parametrize("databases", ["postgresql"], indirect=True)
def test_writers_of_the_same_rows_never_wait_for_each_other(settings: Settings) -> None:
    settings = settings.model_copy(update={"diagnosis_workers": 1})
    with serving(settings) as address, httpx.Client(base_url=f"{address}/api/v1", timeout=None, verify=TLS) as client:
        files = [
            session_bytes(unit=unit, seed=month, month=month, a3_moved=moved)
            for unit in UNITS
            for month, moved in ((1, 0.0), (2, 90.0), (3, 0.0))
        ]
        ids = [client.post("/sessions", content=file).raise_for_status().json()["id"] for file in files]
        flags = [flag["id"] for flag in client.get("/flags").json()["flags"]]
        kind = client.get("/unit-types").json()["unit_types"][0]["name"]

        def ask(number: int) -> list[int]:
            with httpx.Client(base_url=f"{address}/api/v1", timeout=None, verify=TLS) as own:
                return [answered(own, one) for one in changes(number, ids, flags, kind)]

        with ThreadPoolExecutor(CLIENTS) as pool:
            answers = [status for own in pool.map(ask, range(CLIENTS)) for status in own]
    assert len(flags) >= len(UNITS)
    assert {status // 100 for status in answers} <= {2, 4}
    assert sum(status < 400 for status in answers) > len(answers) / 2
    with psycopg.connect(settings.database.replace("+psycopg", "")) as connection:
        found = connection.execute("SELECT deadlocks FROM pg_stat_database WHERE datname = current_database()")
        assert found.fetchone() == (0,)


def answered(client: httpx.Client, change: Change) -> int:
    """The status of what is not to be asked again."""
    method, path, body = change
    what = {"content": body} if isinstance(body, bytes) else {"json": body}
    statuses = list[int]()

    def is_answered() -> bool:
        statuses.append(client.request(method, path, **what).status_code)
        return statuses[-1] != httpx.codes.SERVICE_UNAVAILABLE

    until(is_answered)
    return statuses[-1]
