"""Every number of docs/methods/two-axis-stand.md: ``python -m benchmarks.two_axis_stand``."""

from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.block import GRAVITY, sessions
from estimator import CalibrationSession, Site, StandErrors, calibrate, calibrate_many
from estimator.applied_vector import gravity
from estimator.parameters import nominal
from estimator.results import ARCSEC
from estimator.session import Array
from estimator.simulate import scattered, simulate, stand_schedule

ALPHA = np.radians(40.0)
TRIALS = 2000


def table(title: str, columns: tuple[str, ...], rows: list[tuple[object, ...]]) -> Table:
    """A table to print; numbers to four digits."""
    made = Table(*columns, title=title)
    for row in rows:
        made.add_row(*(f"{x:.4g}" if isinstance(x, float) else str(x) for x in row))
    return made


def rank_defect() -> Table:
    """The published matrix (26) and the corrected one."""
    rows: list[tuple[object, ...]] = []
    for N in (12, 24, 36):
        beta, C = 2 * np.pi * np.arange(N) / N, GRAVITY * np.cos(ALPHA)
        n1, n3 = -C * np.sin(beta), C * np.cos(beta)
        printed = np.column_stack([np.ones(N), n1, n3, n1**2, n3**2])
        ours = np.column_stack([np.ones(N), n1, n3, n1**2 - n3**2])
        rows.append(
            (N, int(np.linalg.matrix_rank(printed)), float(np.linalg.cond(printed)), float(np.linalg.cond(ours)))
        )
    return table("Matrix (26)", ("N", "rank of 5", "condition, printed", "condition, corrected"), rows)


def gravity_formula() -> Table:
    """The published formula (9) against Helmert's."""
    phi = np.radians(55.8)
    printed = 9.78030 + 0.005302 * np.sin(phi) ** 2 - 0.000007 * np.sin(2 * phi) ** 2
    ours = gravity(Site(latitude=phi))
    rows: list[tuple[object, ...]] = [(f"{printed:.5f}", f"{ours:.5f}", float(1e3 * (ours - printed) / ours))]
    return table("Gravity at 55.8°, sea level, m/s²", ("printed (9)", "Helmert 1901", "difference, mg"), rows)


def on_stand(schedule: CalibrationSession, sigma: StandErrors) -> CalibrationSession:
    """The schedule under other errors of the stand, the sensors' zeros repeatable."""
    assert schedule.stand is not None
    sensors = tuple(replace(s, bias_repeatability=0.0) for s in schedule.sensors)
    stand = replace(schedule.stand, sigma=sigma)
    return stand_schedule(sensors, stand, schedule.site, 24)


def scatter(schedule: CalibrationSession, noise: float) -> tuple[Array, Array]:
    """(m,) Monte Carlo variance of relative scale, and of the axis."""
    rng, truth = np.random.default_rng(1), nominal(schedule.sensors)
    results = calibrate_many([simulate(schedule, truth, rng, noise=noise) for _ in range(TRIALS)])
    scale = np.array([[s.scale.value for s in r.sensors] for r in results]) / truth.scale - 1
    axis = np.stack([[s.axis for s in r.sensors] for r in results]) - truth.axis
    return (scale**2).mean(axis=0), (axis**2).sum(axis=-1).mean(axis=0)


def closed_forms() -> Table:
    """Closed forms, the printed ones and Monte Carlo, for e2² = 1/3 (the cone about the head), 24 positions."""
    base, s, share, N = sessions(1)[0], 2.5e-5, 1 / 3, 24
    tan2, sin2, cos2 = np.tan(ALPHA) ** 2, np.sin(ALPHA) ** 2, np.cos(ALPHA) ** 2
    unit, ramp = s**2 / (N * GRAVITY**2), 20 * ARCSEC
    noisy = scatter(on_stand(base, StandErrors()), 0.12 * s)
    raised = scatter(on_stand(base, StandErrors(alpha=ramp)), 0.12 * 1e-7)
    lean = (share / np.sqrt(tan2) - (1 - share) * np.sqrt(tan2)) ** 2
    rows: list[tuple[object, ...]] = [
        ("scale, reading noise", 1e6 * np.sqrt(unit * ((1 - share) / cos2 + share / (2 * sin2))),
         1e6 * np.sqrt(unit * (2 * (1 - share) / cos2 + share / sin2)), 1e6 * float(np.sqrt(noisy[0].mean()))),
        ("axis, reading noise", 1e6 * np.sqrt(unit * ((1 + share) / cos2 + (1 - share) / (2 * sin2))),
         1e6 * np.sqrt(unit * (2 * (1 - share) / cos2 + (1 - 2 * share) / (2 * sin2))),
         1e6 * float(np.sqrt(noisy[1].mean()))),
        ("scale, raise of 20″", 1e6 * ramp * np.sqrt(lean),
         1e6 * ramp * np.sqrt((1 - share) * tan2 + share * (share / tan2 - 2 * (1 - share))),
         1e6 * float(np.sqrt(raised[0].mean()))),
        ("axis, raise of 20″", 1e6 * ramp * np.sqrt(share * (1 - share) * (tan2 + 1 / tan2 + 2)),
         1e6 * ramp * np.sqrt(share * (1 - share) * (tan2 + 1 / tan2 + 2)), 1e6 * float(np.sqrt(raised[1].mean()))),
    ]  # fmt: skip
    columns = ("one sigma, ppm or µrad", "closed form", "as printed, (29) and (30)", f"{TRIALS} simulated sessions")
    return table("Accuracy in closed form", columns, rows)


def honesty() -> Table:
    """Coverage, and normalised error squared, of simulated sessions with the stand's errors."""
    base = sessions(1)[0]
    rng = np.random.default_rng(2)
    truth = scattered(base.sensors, np.full(len(base.sensors), GRAVITY), rng)
    results = calibrate_many([simulate(base, truth, rng, noise=3e-6) for _ in range(TRIALS)])
    scale = np.array(
        [[(s.scale.value - k) / s.scale.sigma for s, k in zip(r.sensors, truth.scale, strict=True)] for r in results]
    )
    bias = np.array(
        [[(s.bias.value - b) / s.bias.sigma for s, b in zip(r.sensors, truth.bias, strict=True)] for r in results]
    )
    axis = np.array(
        [
            [
                (s.axis - e) @ s.axis_tangents / np.sqrt(np.diagonal(s.axis_covariance))
                for s, e in zip(r.sensors, truth.axis, strict=True)
            ]
            for r in results
        ]
    )
    rows: list[tuple[object, ...]] = [
        (name, float(np.mean(z**2)), 100 * float(np.mean(np.abs(z) < 1.96)))
        for name, z in (("scale", scale), ("bias", bias), ("axis", axis))
    ]
    return table(
        f"{TRIALS} simulated sessions", ("parameter", "mean square error in sigmas", "95 % interval holds, %"), rows
    )


def example() -> Table:
    """Uncertainties of one session of the published block."""
    sensor = calibrate(sessions(1)[0]).sensors[0]
    assert sensor.axis_sigma is not None
    rows: list[tuple[object, ...]] = [
        (
            "scale, ppm",
            1e6 * sensor.scale.sigma / sensor.scale.value,
            1e6 * sensor.scale.repeatability / sensor.scale.value,
        ),
        ("bias, µg", 1e6 * sensor.bias.sigma / GRAVITY, 1e6 * sensor.bias.repeatability / GRAVITY),
        ("quadratic, µg/g²", 1e6 * sensor.quadratic.sigma * GRAVITY, 1e6 * sensor.quadratic.repeatability * GRAVITY),
        ("axis, ″", sensor.axis_sigma / ARCSEC, ""),
    ]
    return table("One session, N = 24, one sigma", ("parameter", "total", "repeatability"), rows)


def main() -> None:
    """Print all tables."""
    console = Console(width=110)
    for made in (rank_defect(), gravity_formula(), closed_forms(), honesty(), example()):
        console.print(made)


if __name__ == "__main__":
    main()
