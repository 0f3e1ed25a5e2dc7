"""Steps: files that come in, of every programme and in every format, once, again, corrected, wrong."""

import json
from typing import Any

from hypothesis import strategies as st
from hypothesis.stateful import rule

from tests.lives.oddities import ODDITIES
from tests.lives.steps import NUMBERS, Steps
from tests.lives.units import Document
from tests.service.ingest.test_formats import WRITERS, rounded

BENCHES = ("LV-101", "LV-102", "LV-240", "LV-350", "HM-460", "RA-570", "LG-680", "FL-790", "MX-890")
WRONG = ("no json", "a column less", "reading of text", "NaN", "no sensors")
"""Files that are refused."""
TAKEN = (200, 201)


def written(document: Document, kind: str) -> bytes:
    """The file of a document in a format."""
    return WRITERS[kind](rounded(document))


class Uploads(Steps):
    """Uploads of a crew."""

    @rule(
        serial=st.sampled_from(BENCHES),
        number=NUMBERS,
        kind=st.sampled_from(list(WRITERS)),
        odd=st.lists(st.sampled_from(list(ODDITIES)), max_size=3, unique=True),
        is_check=st.sampled_from([False, False, False, True]),
    )
    def sends(self, serial: str, number: int, kind: str, odd: list[str], is_check: bool) -> None:
        """One session as a file."""
        document = self.measured(serial, number)
        for name in odd:
            ODDITIES[name](document)
        receipt = self.upload(written(document, kind), f"{serial}-{number}.{kind}", check=is_check)
        if receipt and "no type" in odd:
            self.world.typeless.add(receipt["id"])

    @rule(serial=st.sampled_from(BENCHES[:4]), number=NUMBERS, count=st.integers(2, 6), step=st.sampled_from([1, 2]))
    def sends_a_series(self, serial: str, number: int, count: int, step: int) -> None:
        """Several sessions of one unit, one after another, as a history grows."""
        for one in range(number, number + count * step, step):
            self.upload(written(self.measured(serial, one), "json"), f"{serial}-{one}.json")

    @rule(serial=st.sampled_from(BENCHES), number=NUMBERS, kind=st.sampled_from(list(WRITERS)))
    def sends_again(self, serial: str, number: int, kind: str) -> None:
        """Sends the same content in two formats, which must become one session."""
        document = self.measured(serial, number)
        first = self.upload(written(document, "json"), "first.json")
        again = self.upload(written(document, kind), f"again.{kind}")
        if first and again:
            self.expect(first["id"] == again["id"], f"the same content became {first['id']} and {again['id']}")

    @rule(number=st.integers(0, 40), far=st.booleans())
    def corrects(self, number: int, far: bool) -> None:
        """A corrected file in place of a session: another reading, or another date."""
        if (session := self.some_session(number, "accepted", "questioned")) is None:
            return
        document = self.document_of(session["id"])
        if document is None:
            return
        if far and "started_at" in document:
            document["started_at"] = str(int(document["started_at"][:4]) - 1) + document["started_at"][4:]
        else:
            name = document["sensors"][0]["name"]
            document["table"][name][-1] *= 1 + 1e-9
        params = {"supersedes": session["id"], "by": "K. Ito", "why": "corrected"}
        self.upload(json.dumps(document).encode(), "corrected.json", **params)

    @rule(serial=st.sampled_from(BENCHES), number=NUMBERS, factor=st.sampled_from([1e3, -1.0, 1 / 9.80665]))
    def slips(self, serial: str, number: int, factor: float) -> None:
        """A file in another unit, or with a turned sign: is questioned, or found by its diagnosis."""
        document = self.measured(serial, number)
        names = [sensor["name"] for sensor in document["sensors"]][: 1 if factor < 0 else None]
        for name in names:
            document["table"][name] = [cell * factor for cell in document["table"][name]]
        if receipt := self.upload(written(document, "json"), "slip.json"):
            self.world.rescaled.add(receipt["unit"])

    @rule(serial=st.sampled_from(BENCHES), wrong=st.sampled_from(WRONG))
    def sends_what_cannot_be_used(self, serial: str, wrong: str) -> None:
        """A file that is refused with words, and with nothing stored."""
        document: Any = self.measured(serial, 0)
        name = document["sensors"][0]["name"]
        if wrong == "a column less":
            del document["table"][name]
        elif wrong == "reading of text":
            document["table"][name][0] = "0,7 V"
        elif wrong == "NaN":
            document["table"][name][0] = float("nan")
        elif wrong == "no sensors":
            document["sensors"] = []
        content = b'{"format": "imu-session/1",' if wrong == "no json" else json.dumps(document).encode()
        answer = self.world.ask("POST", "/api/v1/sessions", content=content)
        self.expect(answer.status_code == 422 and answer.json()["problems"], f"{wrong}: {answer.text[:300]}")

    @rule(serial=st.sampled_from(BENCHES), number=NUMBERS)
    def asks_before(self, serial: str, number: int) -> None:
        """Asks about a measurement that is still going on."""
        content = json.dumps(self.measured(serial, number)).encode()
        for path in ("/plan/missing", "/plan/ready", "/layouts/preview"):
            answer = self.world.ask("POST", f"/api/v1{path}", files={"file": ("begun.json", content)})
            self.expect(answer.status_code in (200, 422), f"{path}: {answer.text[:300]}")

    def measured(self, serial: str, number: int) -> Document:
        """The session of a number, of one of the unit's programmes in turn."""
        programmes = list(self.world.benches[serial].programmes.values())
        return dict(json.loads(json.dumps(programmes[number % len(programmes)](number // len(programmes)))))

    def upload(self, content: bytes, filename: str, **params: Any) -> dict[str, Any] | None:
        """The answer to a file; None where it was refused."""
        how: dict[str, Any] = {"params": {k: str(v).lower() if v is True else v for k, v in params.items() if v}}
        answer = self.world.ask("POST", "/api/v1/sessions", files={"file": (filename, content)}, **how)
        self.world.counts["uploads"] += 1
        if answer.status_code not in TAKEN:
            self.expect(answer.status_code in (409, 422), f"{filename}: {answer.status_code} {answer.text[:300]}")
            self.world.refused[_why(answer.json())] += 1
            return None
        receipt: dict[str, Any] = answer.json()
        self.world.stored.setdefault(receipt["id"], content)
        return receipt

    def document_of(self, id: str) -> Document | None:
        """Document of a session that came as JSON."""
        content = self.world.stored.get(id, b"")
        return dict(json.loads(content)) if content.startswith(b"{") else None


def _why(problem: dict[str, Any]) -> str:
    found = problem.get("problems") or [{"field": "", "message": problem.get("detail", "")}]
    return f"{found[0]['field']}: {found[0]['message']}"[:160]
