"""The paper's numbers beside ours, and what a covariance analysis says of going on from there."""

import numpy as np

from benchmarks.papers.markdown import section, table
from benchmarks.papers_alignment.observability import expected, gramian, mounting_effect, planned_path
from benchmarks.papers_alignment.runs import MOUNTING, QUIET, SITE, TRUTH, Errors, G, errors
from estimator.alignment import InertialModel, rate_table
from estimator.alignment.filtering import FilterSetting
from estimator.alignment.noise import FilterNoise
from estimator.alignment.simulate import Imperfections, Truth, TurntableProgramme, simulate_rate_table, triads
from estimator.applied_vector import gravity
from estimator.results import ARCSEC
from estimator.session import Site

MICRO_G = 1e-6 * G
NOISE = FilterNoise((5e-6 * G) ** 2 * np.eye(3), (0.06 * ARCSEC) ** 2 * np.eye(3), 0.0, stated=True)
"""5 µg/√Hz and 0.001 °/√h."""
DEGREE_PER_HOUR = np.pi / 180 / 3600
LATITUDE = SITE.latitude or 0.0
SETTING = FilterSetting(LATITUDE, G, NOISE, wobble=0.5 * ARCSEC, table=0.5 * ARCSEC)
EXPECTED = (
    "One sigma at the end by covariance analysis, turntable 0.5″; *told* counts the directions of φ, ε, ∇, E, κ "
    "that are known well enough to be of use (60″, 1 °/h, 0.3 mg). The eigenvalue is the least of the "
    "observability Gramian in those units: above 1, gyros without noise could tell the direction."
)
TURNS = {
    "0°, 180°": (0.0, np.pi),
    "0°, 90°, 180°": (0.0, np.pi / 2, np.pi),
    "0°, 180°, 0°": (0.0, np.pi, 0.0),
    "0°, 90°, 180°, 270°": (0.0, np.pi / 2, np.pi, 1.5 * np.pi),
    "0°, 90°, 180°, 270°, 360°": (0.0, np.pi / 2, np.pi, 1.5 * np.pi, 2 * np.pi),
}


def end_values(ten: Errors, turntable: Errors) -> str:
    """Print, prediction and both models."""
    left = mounting_effect(*MOUNTING, G)
    quiet = errors(InertialModel.TEN, noise=QUIET)
    rows = []
    for name, unit, one, place, printed in (
        ("phi_E", "φ_E, ″", ARCSEC, 0, "−8"),
        ("phi_N", "φ_N, ″", ARCSEC, 1, "4"),
        ("nabla_x", "∇_x, 1e-6 g", MICRO_G, 2, "−20"),
        ("nabla_y", "∇_y, 1e-6 g", MICRO_G, 3, "−40"),
    ):
        found = [np.concatenate([e.phi[-1, :2], e.nabla[-1]])[place] / one for e in (quiet, ten, turntable)]
        sigma = [e.sigmas[-1, (2, 3, 8, 9)[place]] / one for e in (ten, turntable)]
        rows.append(
            (
                unit,
                printed,
                float(left[name] / one),
                float(found[0]),
                f"{found[1]:.3g} ± {sigma[0]:.2g}",
                f"{found[2]:.2g} ± {sigma[1]:.2g}",
            )
        )
    columns = ("error at the end", "printed", "(5)", "ten states, no noise", "ten states", "with E and the turntable")
    return section(
        "Figures 1 and 2",
        "Two positions, 180° apart, 300 s each; E_xz = 4″, E_yz = 8″, 0.01 °/h, 5e-5 g; noise 0.001 °/√h and "
        "5 µg/√Hz; ± is one sigma of the filter.",
        "![φ_E and φ_N](../../docs/pictures/alignment-figure-1.png)",
        "![∇_x and ∇_y](../../docs/pictures/alignment-figure-2.png)",
        table(columns, rows),
        "The printed values are reproduced; they are rounded, for 4″ and 8″ of g are 19.4 and 38.8 µg. The ten-state "
        "filter does not know of the mounting errors: it is wrong by more than ten, for ∇_y forty, of its sigmas. "
        "Before the turn our curves lie nearer to zero than a single position allows, because coarse alignment looks "
        "at both stops. The paper's text was at hand, not its pictures: of the curves only the end values compare.",
    )


def prediction(trials: int = 40) -> str:
    """Equation (5) over random mounting errors, latitudes and headings."""
    rng = np.random.default_rng(7)
    worst = np.zeros(2)
    for _ in range(trials):
        E_xz, E_yz = rng.uniform(-60, 60, 2) * ARCSEC
        heading, site = rng.uniform(0, 2 * np.pi), Site(latitude=rng.uniform(-1.2, 1.2))
        truth = Truth(mounting=(E_xz, E_yz), heading=heading)
        programme = TurntableProgramme(dwell=120.0, row=0.5)
        found = errors(InertialModel.TEN, truth, site=site, programme=programme, noise=QUIET)
        left = mounting_effect(E_xz, E_yz, gravity(site))
        turn = np.array([[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]])
        tilt = np.abs(found.phi[-1, :2] - turn @ [left["phi_E"], left["phi_N"]]).max() / ARCSEC
        zero = np.abs(found.nabla[-1] - [left["nabla_x"], left["nabla_y"]]).max() / MICRO_G
        worst = np.maximum(worst, [tilt, zero])
    return section(
        "Equation (5)",
        f"{trials} alignments without noise, E_xz and E_yz within 60″, any heading, latitudes to 69°: the ten-state "
        f"filter's errors differ from the equation's by {worst[0]:.2g}″ and {worst[1]:.2g} µg at most. In a heading "
        "other than east, φ_E and φ_N of the equation are turns about the axes on which x and y lay at the first stop.",
    )


def plans() -> str:
    """Expected sigmas of every programme under every model, 15 minutes in all."""
    rows = []
    for name, angles in TURNS.items():
        path = planned_path(TurntableProgramme(angles, 900 / len(angles), row=1.0), LATITUDE, G)
        for model in InertialModel:
            found = expected(path, SETTING, model)
            rows.append(
                (
                    name,
                    model.value,
                    f"{found.rank} of {len(found.names)}",
                    found.sigma("E_xz") / ARCSEC if model is not InertialModel.TEN else "taken for 0",
                    found.sigma("nabla_x") / MICRO_G,
                    found.sigma("eps_x") / DEGREE_PER_HOUR,
                    found.sigma("eps_z") / DEGREE_PER_HOUR,
                    found.sigma("phi_U") / ARCSEC,
                    float(np.linalg.eigvalsh(gramian(path, SETTING, model))[0]),
                )
            )
    heads = ("stops", "model", "told", "E_xz, ″", "∇_x, µg", "ε_x, °/h", "ε_z, °/h", "φ_U, ″", "least eigenvalue")
    return section(
        "What a programme of 15 minutes tells",
        f"{EXPECTED}\n\n{table(heads, rows)}",
        "Velocity alone (*mounting*) does not tell E, whatever the number of positions and the sense of the turns; it "
        "takes the turntable's own direction. That the eigenvalue is not zero is the Earth's rotation at work, at "
        "5e-5 a second: gyro noise drowns it. The ten-state sigmas of ∇ hold only where E is zero.",
    )


def rate_tables() -> str:
    """Accuracy of E from a rate table, by the length of the run."""
    rows = []
    for turns in (3, 6, 12, 24):
        time = turns * 36.0 + 0.5
        runs = ((np.radians(10.0), time), (np.radians(-10.0), time))
        sigmas, off = [], []
        for seed in range(20):
            rng = np.random.default_rng(seed)
            session = simulate_rate_table(triads(), SITE, runs, TRUTH, rng, imperfections=Imperfections())
            found = rate_table(session)
            sigmas.append(np.sqrt(found.covariance[0, 0]) / ARCSEC)
            off.append((found.estimate[0] - MOUNTING[0]) / ARCSEC)
        rows.append((turns, float(np.median(sigmas)), float(np.sqrt(np.mean(np.square(off))))))
    return section(
        "Rate table",
        "E_xz from turns at ±10 °/s, gyros of 0.001 °/√h; 20 runs each.",
        table(("whole turns each way", "stated sigma, ″", "root mean square error, ″"), rows),
    )
