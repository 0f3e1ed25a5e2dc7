"""``python -m benchmarks.recorded_life``: the sensor array's six sessions as one unit's history in a running service.

The accelerometers of every session are uploaded as a crew would, oldest first, and the service is asked what it says.
The recordings state no day: each streaming run has one of its own here, a month apart, and within it the time of the
packets. A time constant learned on earlier sessions is judged by the zeros of the next session: per sensor one
zero after settling, common to all sessions, and one amplitude per switching on, with one time constant of all sensors,

    b(t) = b_∞ + k·exp(−t/τ),

by least squares over the readings within the sessions and their zeros together (U and F are the score and information
of the course in a session's whitened residuals, L what the plain calibration's zero takes of it).
"""

import os
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from functools import cache
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import httpx
import numpy as np

from benchmarks.diagnosed_recordings.groups import accelerometers, some
from benchmarks.recordings.sets import recordings
from benchmarks.recordings.tables import table
from benchmarks.u2_uploads import serving
from estimator.causes.environment import WarmUp
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array, CalibrationSession
from estimator.writing import session_document

TRIADS = 8
MILLI_G = 9.80665e-3
RUNS = {"exp_1": 0, "exp_2": 0, "exp_3": 0, "exp_4": 0, "exp_6": 1, "exp_9": 1}
"""Power-on that each session belongs to, by number, from the numbering of the packets."""
APART = 31
"""Days between the two runs, and from the second to today; made up: no recording states its day."""
TODAY = datetime.now(UTC).replace(microsecond=0)
CONSTANTS = np.geomspace(200.0, 3000.0, 40)
"""s."""
LEARNED = (
    (("exp_1", "exp_2"), "exp_3"),
    (("exp_1", "exp_2", "exp_3"), "exp_4"),
    (("exp_4", "exp_6"), "exp_9"),
    (("exp_1", "exp_2", "exp_3", "exp_4", "exp_6"), "exp_9"),
)
"""Earlier sessions, and the next."""
WARM = ("exp_4", "exp_9")
"""Sessions half an hour and more after switching on, of either run."""
LONGEST = 600.0
"""s, for which a diagnosis is waited for."""
TYPE = "MIMU4444"
TOLERANCES = {"scale": 3e-3, "bias": 5 * MILLI_G, "quadratic": None, "axis": float(np.radians(0.3))}
"""Relative, m/s², rad: what a crew could ask of such sensors. The default, ±50 µg, is for others: here it is a fifth of
the U of a bias, so that every verdict is undecidable."""
BIAS = 1
"""Place of the zero among a sensor's five parameters."""


@dataclass(frozen=True, eq=False)
class Course:
    """A session's evidence on a warm-up of one time constant. m sensors."""

    score: Array
    """(m,) U, s²/m."""
    information: Array
    """(m, m) F, (s²/m)²."""
    taken: Array
    """(m, m) L, dimensionless."""
    zero: Array
    """(m,) m/s², of the plain calibration."""
    weight: Array
    """(m, m) inverse covariance of the zeros, (s²/m)²."""


@cache
def array() -> dict[str, CalibrationSession]:
    """The array's sessions by name, oldest first, dated."""
    return {r.name.removeprefix("kth-mimu-"): dated(r.name, r.session) for r in recordings("kth-mimu")}


def dated(name: str, session: CalibrationSession) -> CalibrationSession:
    """The accelerometers, with the day of their run."""
    run, since = RUNS[name.removeprefix("kth-mimu-")], session.time_since_power_on or 0.0
    day = TODAY - timedelta(days=APART * (2 - run))
    own = some(session, accelerometers(session, TRIADS))
    return replace(own, started_at=(day + timedelta(seconds=round(since))).isoformat(), unit_type=TYPE)


@cache
def fitted(name: str) -> WhitenedResiduals:
    """Residuals of the plain calibration of a session."""
    return WhitenedResiduals.of(baseline_of(array()[name]))


@cache
def course(name: str, tau: float) -> Course:
    """The course of one session, every sensor warming up with one time constant."""
    white = fitted(name)
    base, m = white.baseline, len(white.baseline.session.sensors)
    columns = np.zeros((*base.residual.shape, m))
    columns[:, range(m), range(m)] = WarmUp().terms(base.setting, 0, [(tau,)])[0]
    whitened = white.whitened(columns)
    left = white.remaining_of(whitened)
    response = (white.response * base.parameters.si_factors(base.setting.norm)[:, None])[BIAS::5]
    weight = np.linalg.inv(response @ response.T)
    return Course(left.T @ white.z, left.T @ left, response @ whitened, base.parameters.bias, weight)


@dataclass(frozen=True, eq=False)
class Learned:
    """A unit's zeros as learned from earlier sessions."""

    tau: float
    """s."""
    settled: Array
    """(m,) m/s²."""
    amplitude: dict[int, Array]
    """(m,) m/s² of every switching on."""
    misfit: float
    """χ² without what no time constant changes."""


def learned(names: Sequence[str]) -> Learned:
    """The time constant that fits the sessions best, with its zeros and amplitudes."""
    return min((learned_at(names, float(tau)) for tau in CONSTANTS), key=lambda one: one.misfit)


def learned_at(names: Sequence[str], tau: float) -> Learned:
    """Zeros and amplitudes at one time constant, by one least-squares fit."""
    runs = sorted({RUNS[name] for name in names})
    m = len(array()[names[0]].sensors)
    normal, right, square = np.zeros((m * (1 + len(runs)),) * 2), np.zeros(m * (1 + len(runs))), 0.0
    for name in names:
        own, start = course(name, tau), m * (1 + runs.index(RUNS[name]))
        place = slice(start, start + m)
        model = np.zeros((m, len(right)))
        model[:, :m], model[:, place] = np.eye(m), own.taken
        normal += model.T @ own.weight @ model
        right += model.T @ own.weight @ own.zero
        normal[place, place] += own.information
        right[place] += own.score
        square += float(own.zero @ own.weight @ own.zero)
    found = np.linalg.solve(normal, right)
    parts = found.reshape(1 + len(runs), m)
    return Learned(tau, parts[0], dict(zip(runs, parts[1:], strict=True)), square - float(right @ found))


def predicted(known: Learned, name: str) -> Array:
    """(m,) m/s², predicted zeros of the plain calibration of another session."""
    return known.settled + course(name, known.tau).taken @ known.amplitude[RUNS[name]]


def rms(values: Array) -> str:
    """Root mean square of the z axes and of all sensors, mg."""
    both = (values[2::3], values)
    return " / ".join(f"{np.sqrt(np.mean(x**2)) / MILLI_G:.2f}" for x in both)


def predictions() -> Iterator[tuple[str, ...]]:
    """Predictions of the next session's zeros from earlier sessions."""
    for names, following in LEARNED:
        known, zero = learned(names), course(following, CONSTANTS[0]).zero
        last = course(names[-1], CONSTANTS[0]).zero
        left = predicted(known, following) - zero
        yield ", ".join(names), following, f"{known.tau:.0f} s", rms(last - zero), rms(left)


def judged_sessions(http: httpx.Client) -> Iterator[tuple[str, ...]]:
    """The service's verdict on every session as it comes. The first makes the type, whose tolerances are set then."""
    for name, session in array().items():
        receipt = http.post("/sessions", json=session_document(session)).raise_for_status()
        id, unit = receipt.json()["id"], receipt.json()["unit"]
        http.put(f"/unit-types/{TYPE}", json={"tolerances": TOLERANCES}).raise_for_status()
        found = waited_for(http, f"/sessions/{id}/diagnosis")
        after = http.get(f"/sessions/{id}").raise_for_status().json()
        minutes = f"{(session.time_since_power_on or 0.0) / 60:.0f}"
        due = wanted(waited_for(http, f"/units/{unit}/outlook"))
        use = http.get(f"/units/{unit}/usable").raise_for_status().json()["use"]
        yield name, minutes, named(found), after["verdict"], after["reason"], use, due


def wanted(outlook: dict[str, Any]) -> str:
    """The unit's next action, with the days from now."""
    due = outlook["due"]
    days = "" if due is None else f", {(datetime.fromisoformat(due) - datetime.now(UTC)).days} days from today"
    return f"{outlook['action']}{days}"


def named(found: dict[str, Any]) -> str:
    """Causes with the number of their sensors, and how much stays unexplained."""
    causes = [f"`{f['cause']}` ({len(f['sensors'])})" for f in found["findings"]]
    return "; ".join([*causes, *(["unexplained structure"] if found.get("structures") else [])]) or "nothing"


def waited_for(http: httpx.Client, address: str) -> dict[str, Any]:
    """Waits for an answer that is being made."""
    answer = http.get(address)
    while answer.status_code == httpx.codes.ACCEPTED:
        answer = http.get(address)
    document: dict[str, Any] = answer.raise_for_status().json()
    return document


def main() -> None:
    """Print both tables."""
    learned = ("learned on", "next", "τ", "moved since the last, mg rms (z / all)", "left by the prediction")
    print(table(learned, predictions()), flush=True)
    warm = (course(name, CONSTANTS[0]).zero for name in WARM)
    print(f"\nBoth warm, {' and '.join(WARM)} differ by {rms(np.subtract(*warm))} mg rms.", flush=True)
    with (
        tempfile.TemporaryDirectory(prefix="imu-life-", ignore_cleanup_errors=True) as folder,
        serving(folder) as port,
        httpx.Client(base_url=f"http://127.0.0.1:{port}/api/v1", timeout=LONGEST) as http,
    ):
        heads = ("session", "minutes since switching on", "named", "verdict", "reason", "may it be used", "next")
        print("\n" + table(heads, judged_sessions(http)), flush=True)
        lasting = waited_for(http, "/units/mimu4444/diagnosis")["findings"]
        names = "; ".join(f"`{f['cause']}` ({', '.join(f['sensors'])})" for f in lasting)
        print(f"\nWhat lasts over the sessions: {names or 'nothing'}.")


if __name__ == "__main__":
    np.seterr(all="raise", under="ignore")
    main()
