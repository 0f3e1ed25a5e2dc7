"""``python -m benchmarks.thermal --sessions 100 --seed 1``: how far curves over temperature hold.

Blocks of known truth are set down at soaks or along a slow course of temperature, straight from u = K·(a + b + c·a²)
with K and b polynomials of (T − 20)/50; nothing here is shared with the package's own simulator. Printed as Markdown:
how often the band of 95 % holds the true curve at twelve temperatures, how often the orders are the true ones, the
Cramér–Rao bound of the true orders over the squared errors, and how often a hysteresis, lag or misfit is named. The
twelve temperatures of one curve go together: a curve counts as one figure.
"""

import argparse
import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from dataclasses import dataclass, field

import numpy as np

from estimator import Calibration, calibrate, read_session
from estimator.curves import Curve
from estimator.json_object import Json
from estimator.session import Array

G, SCALE = 9.81, 0.12
"""m/s²; V per m/s²."""
EARTH = 7.292115e-5
"""rad/s."""
ROW, SOAK = 120.0, 3600.0
"""s."""
RATE_NOISE = 2e-5
"""rad/s, of a gyro's row."""
SOAKS = (20.0, -40.0, -10.0, 20.0, 45.0, 70.0, 45.0, 20.0, -10.0)
"""°C."""
SLOW = tuple(np.linspace(-40.0, 70.0, 23).tolist())
"""°C, five apart."""
GRID = np.linspace(-40.0, 70.0, 12)
"""°C, where curves are compared."""


@dataclass(frozen=True)
class Case:
    """One kind of session."""

    name: str
    soaks: tuple[float, ...] = SOAKS
    each: int = 9
    """Orientations a soak."""
    noise: float = 1e-4
    """g, one sigma of a row."""
    orders: tuple[int, int] = (2, 3)
    """True ones of scale factor and bias; every second sensor's bias is a line."""
    stated: bool = True
    faces: float | None = None
    """One sigma of known directions, rad, of the six faces; None for unknown orientations all over the sphere."""
    gyros: int = 0
    loop: float = 0.0
    """g, width of a hysteresis loop of every bias."""
    misfit: float = 0.0
    """g, of a wave over temperature that no polynomial of the order follows."""


CASES = (
    Case("nine orientations, nine soaks"),
    Case("the same, noise not stated", stated=False),
    Case("six faces known to 0.1°", each=6, faces=2e-3),
    Case("with three gyros", gyros=3),
    Case("noise 2 mg, lines", noise=2e-3, orders=(1, 1)),
    Case("hysteresis of 1 mg", loop=1e-3),
    Case("soaks 5 °C apart", soaks=SLOW),
    Case("the same, a wave of 0.5 mg", soaks=SLOW, misfit=5e-4),
)


@dataclass(frozen=True, eq=False)
class Truth:
    """The true parameters of the sensors; polynomials of (T − 20)/50."""

    scale: list[Array]
    """V per m/s²."""
    bias: list[Array]
    """m/s², of gyros, which stand last, rad/s."""
    axes: Array
    directions: Array
    temperature: Array


@dataclass
class Tally:
    """Results of a case."""

    held: list[float] = field(default_factory=list)
    right: list[bool] = field(default_factory=list)
    bound: float = 0.0
    error: float = 0.0
    named: int = 0


def reduced(temperature: Array) -> Array:
    """The argument of the true polynomials."""
    return (np.asarray(temperature) - 20.0) / 50.0


def at(coefficients: Array, temperature: Array) -> Array:
    """A true polynomial."""
    return np.asarray(np.polyval(coefficients[::-1], reduced(temperature)))


def drawn(order: int, size: float, rng: np.random.Generator) -> Array:
    """Coefficients that are plainly there: once to twice ``size``, of any sign."""
    terms = size * (1 + rng.random(order)) * rng.choice([-1.0, 1.0], order)
    return np.r_[size * rng.standard_normal(), terms]


def turned_up(case: Case, rows: int, rng: np.random.Generator) -> Array:
    """(R, 3) directions of the specific force."""
    if case.faces is None:
        up = rng.standard_normal((rows, 3))
    else:
        faces = np.concatenate([np.eye(3), -np.eye(3)])
        up = faces[np.arange(rows) % 6] + case.faces * rng.standard_normal((rows, 3))
    return up / np.linalg.norm(up, axis=1, keepdims=True)


def draw(case: Case, rng: np.random.Generator) -> tuple[Json, Truth]:
    """A session file and its truth."""
    turn = 2 * np.pi * np.arange(6) / 6
    nominal = np.column_stack([np.sin(0.95) * np.cos(turn), np.full(6, np.cos(0.95)), np.sin(0.95) * np.sin(turn)])
    axes = nominal + 1e-3 * rng.standard_normal((6, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    rows = len(case.soaks) * case.each
    T = np.repeat(case.soaks, case.each) + 0.2 * rng.standard_normal(rows)
    up, steps = turned_up(case, rows, rng), np.sign(np.diff(case.soaks, prepend=case.soaks[0]))
    x = 2 * (T - T.min()) / np.ptp(T) - 1
    beside = case.loop * G * np.repeat(steps, case.each) * (1 - x**2) / 2 + case.misfit * G * np.sin(9 * reduced(T))
    scale = [SCALE * (np.r_[1.0, np.zeros(case.orders[0])] + drawn(case.orders[0], 3e-3, rng)) for _ in range(6)]
    bias = [G * drawn(1 if i % 2 else case.orders[1], 3e-3, rng) for i in range(6)]
    sigma = case.noise * G * SCALE
    time = ROW * np.arange(rows) + SOAK * (np.arange(rows) // case.each)
    table: Json = {"time_s": time.tolist(), "temperature_c": T.tolist()}
    sensors = []
    for i in range(6):
        u = at(scale[i], T) * (G * up @ axes[i] + at(bias[i], T) + beside) + sigma * rng.standard_normal(rows)
        sensors.append(
            {"name": f"A{i + 1}", "nominal_axis": nominal[i].tolist(), "nominal_scale": SCALE, "reading_unit": "V"}
        )
        table |= {f"A{i + 1}": u.tolist()} | ({f"A{i + 1}_se": [sigma] * rows} if case.stated else {})
    spin = rng.standard_normal((rows, 3))
    spin *= EARTH / np.linalg.norm(spin, axis=1, keepdims=True)
    for i in range(case.gyros):
        bias.append(drawn(2, 1e-3, rng))
        w = spin @ nominal[i] + at(bias[-1], T) + RATE_NOISE * rng.standard_normal(rows)
        own = {"name": f"G{i + 1}", "kind": "gyroscope", "nominal_axis": nominal[i].tolist(), "nominal_scale": 1.0}
        sensors.append(own | {"reading_unit": "rad/s"})
        table |= {f"G{i + 1}": w.tolist(), f"G{i + 1}_se": [RATE_NOISE] * rows}
    document: Json = {
        "format": "imu-session/1", "unit": "TWIN", "block": "accelerometer", "programme": "thermal",
        "site": {"gravity_m_s2": G}, "sensors": sensors, "table": table,
    }  # fmt: skip
    if case.faces is not None:
        stated = np.concatenate([np.eye(3), -np.eye(3)])[np.arange(rows) % 6]
        document["direction_sigma_deg"] = float(np.degrees(case.faces))
        table |= {f"direction_{c}": stated[:, k].tolist() for k, c in enumerate("xyz")}
    return document, Truth(scale, bias, axes, up, T)


def knows_quadratic(result: Calibration) -> bool:
    """Whether the second-order terms were estimated, which are not there."""
    return result.sensor("A1").observable["quadratic"]


def bound(case: Case, truth: Truth, *, quadratic: bool) -> Array:
    """(12,) variances, V² per (m/s²)² and (m/s²)², scale factors and biases in turn, summed over `GRID`: Cramér–Rao
    under the true orders, orientations unknown or drawn about the stated ones."""
    T, up = truth.temperature, truth.directions
    R, m = len(T), 6
    blocks, places, start = [], [], 0
    helper = np.cross(up, np.where(np.abs(up[:, :1]) < 0.7, [[1.0, 0, 0]], [[0, 1.0, 0]]))
    tips = np.stack([helper, np.cross(up, helper)], axis=-1) / np.linalg.norm(helper, axis=1)[:, None, None]
    turns = np.zeros((m, R, 2 * R))
    for i in range(m):
        K, a, side = at(truth.scale[i], T), G * up @ truth.axes[i], np.linalg.svd(truth.axes[i][None])[2][1:].T
        q, b = len(truth.scale[i]), len(truth.bias[i])
        z = np.vander(reduced(T), 5, increasing=True)
        by_scale = z[:, :q] * (a + at(truth.bias[i], T))[:, None]
        own = np.hstack([by_scale, z[:, :b] * K[:, None], K[:, None] * G * up @ side])
        own = np.column_stack([own, K * a * a]) if quadratic else own
        blocks.append(own)
        places.append((start, q, b))
        start += own.shape[1]
        for k in range(2):
            turns[i, np.arange(R), 2 * np.arange(R) + k] = K * G * (tips[..., k] @ truth.axes[i])
    J = np.zeros((m, R, start + 2 * R))
    for i, (at_, own) in enumerate(zip(places, blocks, strict=True)):
        J[i, :, at_[0] : at_[0] + own.shape[1]] = own
    J[:, :, start:] = turns
    F = J.reshape(m * R, -1).T @ J.reshape(m * R, -1) / (case.noise * G * SCALE) ** 2
    if case.faces is not None:
        F[range(start, start + 2 * R), range(start, start + 2 * R)] += case.faces**-2
    size = np.sqrt(np.diagonal(F))
    C = np.linalg.pinv(F / size / size[:, None], rcond=1e-11, hermitian=True) / size / size[:, None]
    z, found = np.vander(reduced(GRID), 5, increasing=True), []
    for first, q, b in places:
        for begin, count in ((first, q), (first + q, b)):
            found.append(
                float(np.trace(z[:, :count] @ C[begin : begin + count, begin : begin + count] @ z[:, :count].T))
            )
    return np.array(found)


def compared(result: Calibration, truth: Truth, tally: Tally) -> Array:
    """(12,) squared errors over `GRID`, as in `bound`, of the accelerometers; everything else goes into the tally."""
    curves = result.thermal
    assert curves is not None
    squares = []
    for i, own in enumerate(curves.sensors):
        pairs: list[tuple[Curve, Array]] = [(own.bias, truth.bias[i])]
        if own.scale is not None:
            pairs.insert(0, (own.scale, truth.scale[i]))
        for curve, true in pairs:
            error = curves.value(curve, GRID) - at(true, GRID)
            tally.held.append(float((np.abs(error) < curves.expanded(curve, GRID)).mean()))
            tally.right.append(curve.order == len(true) - 1)
            if own.scale is not None:
                squares.append(float((error**2).sum()))
    return np.array(squares)


def run(case: Case, sessions: int, seed: int) -> Tally:
    """Runs so many sessions of a case."""
    tally, rng = Tally(), np.random.default_rng([seed, *case.name.encode()])
    for _ in range(sessions):
        document, truth = draw(case, rng)
        result = calibrate(read_session(document))
        squares = compared(result, truth, tally)
        best = bound(case, truth, quadratic=knows_quadratic(result))
        tally.error += float((squares / best).mean())
        tally.bound += 1.0
        tally.named += bool(result.thermal and result.thermal.findings)
    return tally


def row(case: Case, sessions: int, seed: int) -> str:
    """One line of the table."""
    tally = run(case, sessions, seed)
    unfair = case.misfit > 0
    right, efficiency = f"{100 * np.mean(tally.right):.0f} %", f"{tally.bound / tally.error:.2f}"
    cells = (f"{100 * np.mean(tally.held):.1f} %", "—" if unfair else right, "—" if unfair else efficiency)
    return f"| {case.name} | {' | '.join(cells)} | {tally.named} of {sessions} |"


HEAD = """| sessions of six accelerometers | bands hold | orders right | bound over squared error | something named |
| --- | --- | --- | --- | --- |"""


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.thermal", description=__doc__)
    parser.add_argument("--sessions", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print(HEAD)
    for case in CASES:
        print(row(case, options.sessions, options.seed), flush=True)


if __name__ == "__main__":
    main()
