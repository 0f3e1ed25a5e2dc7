"""Steps: what engineers do with records, units, types and stands."""

from urllib.parse import quote

from hypothesis import strategies as st
from hypothesis.stateful import rule

from tests.lives.steps import BY, NUMBERS, WHICH, Steps
from tests.lives.units import day

KINDS = ("adjustment", "repair", "sensor-swap", "reference", "service")
TOLERANCES = ("scale", "bias", "quadratic", "axis")


class Records(Steps):
    """Steps of recording and taking back."""

    @rule(which=WHICH, what=st.sampled_from(["withdraw", "withdraw", "accept", "accept", "accept", "correct"]))
    def changes_a_session(self, which: int, what: str) -> None:
        """A session is withdrawn, accepted again, or put right as is proposed."""
        states = {"withdraw": ("accepted", "questioned"), "accept": ("withdrawn", "questioned")}
        if session := self.some_session(which, *states.get(what, ("questioned",))):
            self.tries(f"/sessions/{session['id']}/{what}", BY if what != "correct" else {"by": BY["by"]})

    @rule(which=WHICH, other=WHICH)
    def supersedes(self, which: int, other: int) -> None:
        """A session is said to be replaced by another of the same unit, or by none."""
        if (session := self.some_session(which, "accepted")) is None:
            return
        same = [one["id"] for one in self.world.sessions("accepted", unit=session["unit"])]
        by = same[other % len(same)] if other % 3 else None
        if by != session["id"]:
            self.tries(f"/sessions/{session['id']}/supersede", BY | {"superseded_by": by})

    @rule(which=WHICH)
    def chooses_a_reference(self, which: int) -> None:
        """An engineer says which session the others are judged against."""
        session = self.some_session(which, "accepted")
        if session and self.tries(f"/units/{quote(session['unit'])}/reference", BY | {"session": session["id"]}):
            self.world.chosen.append(session["id"])

    @rule(which=WHICH, is_check=st.booleans(), stage=st.sampled_from(["as-found", "as-left", None]))
    def says_what_a_session_is(self, which: int, is_check: bool, stage: str | None) -> None:
        """A check, or a calibration after all; before an adjustment, or after it."""
        if session := self.some_session(which):
            self.tries(f"/sessions/{session['id']}/check", BY | {"is_check": is_check}, "PUT")
            self.tries(f"/sessions/{session['id']}/stage", {"by": BY["by"], "stage": stage}, "PUT")

    @rule(which=WHICH, number=NUMBERS, kind=st.sampled_from(KINDS), zone=st.sampled_from(["Z", "+05:30"]))
    def services(self, which: int, number: int, kind: str, zone: str) -> None:
        """Records a service to a unit, before or after what is on record."""
        if unit := self.some_unit(which):
            at = day(number).replace("Z", zone)
            new = {"kind": kind, "at": at, "by": "R. Lind", "note": "shock"}
            if made := self.tries(f"/units/{quote(unit)}/services", new):
                self.world.services[made["id"]] = (unit, new)

    @rule(which=WHICH)
    def takes_a_service_back(self, which: int) -> None:
        """It was another unit's, or another day's."""
        if self.world.services:
            id = sorted(self.world.services)[which % len(self.world.services)]
            self.expect(self.tries(f"/services/{id}/withdraw", BY), f"service {id} cannot be withdrawn")
            del self.world.services[id]

    @rule(which=WHICH, factor=st.sampled_from([0.2, 0.7, 1.5, 4.0]), interval=st.sampled_from([None, 90.0, 730.0]))
    def changes_tolerances(self, which: int, factor: float, interval: float | None) -> None:
        """Changes the tolerances of a unit type, with a preview first."""
        found = self.world.listed("unit-types")
        if not found:
            return
        kind = found[which % len(found)]
        new = {
            name: {one: kind[name][one] and kind[name][one] * factor for one in TOLERANCES}
            for name in ("tolerances", "gyro_tolerances")
            if kind[name]
        }
        if "tolerances" not in new:
            return
        path = f"/unit-types/{quote(kind['name'], safe='')}"
        self.tries(f"{path}/preview", new)
        self.world.is_dated = True
        if made := self.tries(path, new | {"maximum_interval_days": interval}, "PUT"):
            self.world.tolerances[kind["name"], made["revision"]] = new

    @rule(which=WHICH, lot=st.sampled_from(["2024-07", None]), customer=st.sampled_from(["ООО «Курс»", ""]))
    def says_whose_it_is(self, which: int, lot: str | None, customer: str) -> None:
        """A unit's lot and customer."""
        if unit := self.some_unit(which):
            self.tries(f"/units/{quote(unit)}/lot", {"lot": lot}, "PUT")
            self.tries(f"/units/{quote(unit)}/customer", {"name": customer, "address": "Hall 3\n2nd floor"}, "PUT")

    @rule(which=WHICH, year=st.integers(2018, 2027))
    def certifies_a_stand(self, which: int, year: int) -> None:
        """The certificate of a stand's own calibration."""
        stands = [one["stand"] for one in self.world.sessions() if one["stand"]]
        if stands:
            path = f"/stands/{quote(stands[which % len(stands)], safe='')}/certificate"
            new = {"number": f"PTB-{year}", "issued_by": "PTB", "issued_on": f"{year}-02-01"}
            new |= {"valid_until": f"{year + 2}-02-01", "by": BY["by"]}
            if self.tries(path, new, "PUT"):
                self.world.certificates.append((path, new))

    @rule(which=WHICH, of_unit=st.booleans(), text=st.sampled_from(["moved by road", "<b>=1+1</b> №5", "x" * 1900]))
    def remarks(self, which: int, of_unit: bool, text: str) -> None:
        """A note and a file on a unit or a session, perhaps taken back."""
        if (session := self.some_session(which)) is None:
            return
        of = f"/units/{quote(session['unit'])}" if of_unit else f"/sessions/{session['id']}"
        note = self.tries(f"{of}/notes", {"text": text, "by": BY["by"]})
        form = {"by": BY["by"], "text": "photograph"}
        form |= {"unit": session["unit"]} if of_unit else {"session": session["id"]}
        file = {"file": ("stand №3.png", b"\x89PNG" + bytes([which]))}
        answer = self.world.ask("POST", "/api/v1/attachments", data=form, files=file)
        self.expect(answer.status_code in (200, 201), f"attachment: {answer.text[:300]}")
        if which % 3 == 0:
            self.tries(f"/notes/{note['id']}/withdraw", BY)
            self.tries(f"/attachments/{answer.json()['id']}/withdraw", BY)
