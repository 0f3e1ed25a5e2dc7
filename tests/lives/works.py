"""Steps: what is asked of the service's own work, and what happens to the service itself."""

from urllib.parse import quote

from hypothesis import strategies as st
from hypothesis.stateful import rule

from tests.lives.steps import BY, WHICH, Steps

LEVELS = ("units", "unit-types", "stands")
LEARNED = "empirical-term"


class Works(Steps):
    """Diagnoses, models, jobs, flags, webhooks, tokens; restarts."""

    @rule(which=WHICH, scope=st.sampled_from(["unit", "unit-type", "stand"]))
    def accepts_a_cause(self, which: int, scope: str) -> None:
        """Accepts a cause that a session's diagnosis names into a model."""
        if session := self.some_session(which, "accepted"):
            path = f"/sessions/{session['id']}/diagnosis"
            found = self.world.send(path, method="GET")
            named = found.json().get("findings", []) if found.status_code == 200 else []
            if named:
                self.world.is_dated = True
                self.tries(f"{path}/accept", {"cause": named[0]["cause"], "scope": scope, "by": BY["by"]})

    @rule(which=WHICH, level=st.sampled_from(LEVELS))
    def accepts_what_many_show(self, which: int, level: str) -> None:
        """Accepts causes that a group's diagnosis names into a model."""
        if (name := self.some_group(which, level)) is None:
            return
        path = f"/{level}/{quote(name, safe='')}/diagnosis"
        found = self.world.send(path, method="GET")
        self.expect(found.status_code in (200, 202), f"{path}: {found.text[:300]}")
        if found.status_code != 200:
            return
        causes = [(one["cause"], one["sensors"]) for one in found.json()["findings"]]
        causes += [(LEARNED, one["sensors"]) for one in found.json()["terms"]]
        self.world.is_dated = self.world.is_dated or bool(causes)
        for cause, sensors in causes[:2]:
            self.tries(f"{path}/accept", {"cause": cause, "sensors": sensors, "by": BY["by"]})

    @rule(which=WHICH)
    def takes_a_cause_back(self, which: int) -> None:
        """A model loses a cause again."""
        found = self.world.listed("models")
        if found:
            self.tries(f"/models/{found[which % len(found)]['id']}/withdraw", BY)

    @rule(which=WHICH, scope=st.sampled_from([None, "unit"]), cancels=st.booleans())
    def asks_for_a_job(self, which: int, scope: str | None, cancels: bool) -> None:
        """Long work is asked for, perhaps called off at once."""
        unit = self.some_unit(which)
        new = {"scope": scope, "subject": unit or ""} if scope else {}
        self.world.is_dated = True
        asked = [self.tries("/jobs/recalibration", new | {"by": BY["by"]})]
        asked.append(self.tries("/jobs/report", {"format": ("pdf", "xlsx")[which % 2], "by": BY["by"]}))
        for job in asked:
            if cancels and job:
                self.tries(f"/jobs/{job['id']}/cancel", {"by": BY["by"]})

    @rule(which=WHICH)
    def computes_again(self, which: int) -> None:
        """A unit's sessions under the model in force."""
        if unit := self.some_unit(which):
            self.world.is_dated = True
            self.tries(f"/units/{quote(unit)}/recalibrate")

    @rule(which=WHICH, what=st.sampled_from(["acknowledge", "resolve", "assign"]))
    def handles_a_flag(self, which: int, what: str) -> None:
        """Somebody looks after a flag."""
        found = self.world.listed("flags")
        if found:
            body = BY if what != "assign" else {"to": "R. Lind", "by": BY["by"]}
            self.tries(f"/flags/{found[which % len(found)]['id']}/{what}", body)

    @rule(which=WHICH, leaves=st.booleans())
    def registers_a_webhook(self, which: int, leaves: bool) -> None:
        """A receiver that is there, or one that never answers."""
        url = f"http://{self.world.service.hooks[which % 2]}/hook"
        made = self.tries("/webhooks", {"url": url, "secret": "a secret of the hall", "by": BY["by"]})
        if leaves and made:
            self.world.ask("DELETE", f"/api/v1/webhooks/{made['id']}", params={"by": BY["by"]})

    @rule(role=st.sampled_from(["viewer", "crew", "engineer"]), days=st.integers(1, 366))
    def makes_and_revokes_a_token(self, role: str, days: int) -> None:
        """The first one ends the time in which nobody needed to sign in."""
        world = self.world
        if not world.has_accounts:
            world.sign_in()
        shown = world.token(role, days)
        self.expect(world.ask("GET", "/api/v1/me", headers=shown).status_code == 200, "a new token opens nothing")
        number = max(one["id"] for one in world.listed("tokens"))
        gone = world.ask("DELETE", f"/api/v1/tokens/{number}", headers=shown)
        self.expect(gone.status_code in (200, 204), f"a token does not revoke itself: {gone.text[:300]}")
        self.expect(world.ask("GET", "/api/v1/me", headers=shown).status_code == 401, "a revoked token opens")

    @rule(kill=st.booleans())
    def restarts(self, kill: bool) -> None:
        """The machine is switched off, or the service is brought up to date."""
        self.world.restart(kill=kill)

    def some_group(self, which: int, level: str) -> str | None:
        """The name of a unit, a type or a stand that there is."""
        field = {"units": "unit", "unit-types": "unit_type", "stands": "stand"}[level]
        if level == "unit-types":
            found = [one["name"] for one in self.world.listed("unit-types")]
        else:
            found = sorted({one[field] for one in self.world.sessions() if one[field]})
        return found[which % len(found)] if found else None
