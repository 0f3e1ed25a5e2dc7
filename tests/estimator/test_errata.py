"""Every error of the papers' print that docs/errata.md lists, shown in numbers: what print gives, what is true."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from benchmarks.papers.printed import Conditions, checked, printed
from benchmarks.papers.published import ACCELEROMETERS, AXES, GYROS
from benchmarks.papers.tables import fitted_noise, two_sigma
from estimator.applied_vector import gravity, stand_vector
from estimator.planning import conditioning, optimal_elevation, rank_of_orientations
from estimator.session import Array, Site, StandErrors
from tests.builders import ARCSEC, GRAVITY
from tests.estimator.calibration.cases import accelerometers, block

ERRATA = Path(__file__).parents[2] / "docs" / "errata.md"
ALPHA = np.radians(40.0)
N = 12
BETA = 2 * np.pi * np.arange(N) / N
N1, N2, N3 = GRAVITY * stand_vector(ALPHA, BETA).T
E = np.array([0.6, 0.48, 0.64])
K, B, C = 0.12, 2e-3, 1e-5
PERFECT = Conditions(ALPHA, N, GRAVITY, 0.0, 0.0, StandErrors())


def readings(e: Array, c: float = C) -> tuple[Array, Array]:
    """Noiseless direct and flipped readings, each (N,) reading units, of an input axis (3,)."""
    n = np.stack([N1, N2, N3], axis=-1)
    direct, flipped = n @ e, n @ (e * [-1, -1, 1])
    return K * (direct + B + c * direct**2), K * (flipped + B + c * flipped**2)


def matrix_26(beta: Array) -> Array:
    """Matrix (26) as printed: (N, 5) of powers of m/s², for β (N,), rad."""
    reach = GRAVITY * np.cos(ALPHA)
    n1, n3 = -reach * np.sin(beta), reach * np.cos(beta)
    return np.column_stack([np.ones_like(beta), n1, n3, n1**2, n3**2])


def gram_1(beta: Array) -> Array:
    """(2,) C₁ as printed, its fourth column and row, (m/s²)³, for β (N,), rad."""
    sin, cos, r = np.sin(beta), np.cos(beta), GRAVITY * np.cos(ALPHA)
    upper = -(r**3) * (sin**3 * cos).sum()
    lower = -(r**3) * (sin**3).sum()
    return np.array([upper, lower])


def share(e2_squared: float) -> Array:
    """(1, 3) an input axis, dimensionless, with e2² and e3 = 0."""
    return np.array([[np.sqrt(1 - e2_squared), np.sqrt(e2_squared), 0.0]])


@pytest.mark.parametrize("positions", [12, 24, 36])
def test_matrix_26_is_singular(positions: int) -> None:
    printed_matrix = matrix_26(2 * np.pi * np.arange(positions) / positions)
    assert np.linalg.matrix_rank(printed_matrix) == 4
    assert np.linalg.cond(printed_matrix) > 1e16


def test_its_least_squares_solution_gives_another_nonlinearity() -> None:
    """The least-norm solution of the singular system, noiseless: (25) is wrong by this factor, (24) by 309 µg."""
    u, flipped = readings(E)
    q = np.linalg.pinv(matrix_26(BETA), rcond=1e-10) @ ((u + flipped) / 2)
    found = q[3] / (E[0] ** 2 * K)
    assert found / C == pytest.approx(11.3, rel=0.01)
    bias = q[0] / K - found * E[1] ** 2 * N2[0] ** 2
    assert (bias - B) / GRAVITY == pytest.approx(-309e-6, rel=0.01)


def test_the_bracket_of_9_is_worth_three_milli_g() -> None:
    phi = np.radians(55.8)
    as_printed = 9.78030 + 0.005302 * np.sin(phi) ** 2 - 0.000007 * np.sin(2 * phi) ** 2
    assert gravity(Site(latitude=phi)) - as_printed == pytest.approx(3.24e-3 * GRAVITY, rel=0.01)


def test_the_second_matrix_under_10_turns_about_y() -> None:
    first = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    second = np.array([[0, 0, -1], [-1, 0, 0], [0, 1, 0]])
    turn = np.linalg.inv(first) @ second
    assert np.diag(turn).tolist() == [-1, 1, -1]
    said = np.diag([-1, -1, 1])
    assert (first @ said).tolist() == [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]


def test_the_last_term_of_20_is_not_q14() -> None:
    """n1·n3 of the half difference has the coefficient q24 = 2Kc·e1·e3; print names q14 = Kc·e1²."""
    u, flipped = readings(E)
    columns = np.column_stack([np.ones(N), N1, N3, N1 * N3])
    q24 = np.linalg.lstsq(columns, (u - flipped) / 2)[0][3]
    assert q24 == pytest.approx(2 * K * C * E[0] * E[2], rel=1e-6)
    assert K * C * E[0] ** 2 / q24 == pytest.approx(E[0] / (2 * E[2]), rel=1e-6)


def test_24_lacks_the_scale_under_q11() -> None:
    """q11 is K·b where c is known to be zero: print gives K·b for b."""
    u, flipped = readings(E, c=0.0)
    q11 = float(((u + flipped) / 2).mean())
    assert q11 / K == pytest.approx(B, rel=1e-9)
    assert q11 == pytest.approx(0.12 * B, rel=1e-9)


@pytest.mark.parametrize(("e1", "worse"), [(0.6, 4.5), (0.1, 160.0), (0.01, 16_000.0)])
def test_25_amplifies_noise_as_the_input_axis_leaves_x(e1: float, worse: float) -> None:
    """Sigma of c from q14 alone, the best that print could mean, over that from all second-order coefficients."""
    e = np.array([e1, 0.5, np.sqrt(0.75 - e1**2)])
    d = N1**2 - N3**2
    per_c = {"q12": 2 * e[0] * e[1] * N2[0] * N1, "p4": (e[0] ** 2 - e[2] ** 2) / 2 * d}
    per_c |= {"q23": 2 * e[1] * e[2] * N2[0] * N3, "q24": 2 * e[0] * e[2] * N1 * N3}
    together = sum(float((column**2).sum()) for column in per_c.values())
    alone = e1**4 * float((d**2).sum()) / 4
    assert np.sqrt(together / alone) > worse


def test_the_gram_matrix_c1_is_misprinted() -> None:
    """Element (2, 4) is printed with a cosine too many; equal steps make both zero, others do not."""
    unequal = np.array([0.0, 0.5, 1.3, 2.2, 3.0, 4.4, 5.1])
    upper, lower = gram_1(unequal)
    true = (matrix_26(unequal).T @ matrix_26(unequal))[1, 3]
    assert lower == pytest.approx(true)
    assert upper / true == pytest.approx(0.108, abs=0.001)
    assert np.abs(gram_1(BETA)).max() < 1e-9


def test_the_gram_matrix_c2_is_not_symmetric_as_printed() -> None:
    """(4, 2) is printed as zero, (2, 4) is not; the zeros of its first row hold for equal steps only."""
    unequal = np.array([0.0, 0.5, 1.3, 2.2, 3.0, 4.4, 5.1])
    reach = GRAVITY * np.cos(ALPHA)
    n1, n3 = -reach * np.sin(unequal), reach * np.cos(unequal)
    columns = np.column_stack([np.ones_like(n1), n1, n3, n1 * n3])
    gram = columns.T @ columns
    assert abs(gram[3, 1]) > 0.05 * gram[3, 3] / reach
    assert abs(gram[0, 1]) > 0.05 * np.sqrt(gram[0, 0] * gram[1, 1])


def test_28_takes_the_wrong_direction_cosine() -> None:
    """δβ moves the bias by e1² + e3² = 1 − e2², not 1 − e3²."""
    c = replace(PERFECT, stand=StandErrors(beta=20 * ARCSEC))
    ratio = np.sqrt(printed(AXES, c).bias / checked(AXES, c).bias)
    assert (ratio.min(), ratio.max()) == (pytest.approx(0.866, abs=0.01), pytest.approx(1.22, abs=0.01))


def test_the_text_s_bias_is_ten_times_what_28_gives() -> None:
    c = replace(PERFECT, stand=ACCELEROMETERS.conditions.stand)
    assert 3 * np.sqrt(printed(AXES, c).bias.mean()) / GRAVITY == pytest.approx(1.5e-6, rel=0.2)


def test_29_lacks_a_square() -> None:
    """A raise of the head moves the scale by e2² cot α − (1 − e2²) tan α; print gives another variance."""
    lifted = replace(PERFECT, stand=StandErrors(alpha=20 * ARCSEC))
    ratio = np.sqrt(printed(AXES, lifted).scale / checked(AXES, lifted).scale)
    assert ratio == pytest.approx(np.full(6, 2.64), rel=0.01)
    r2, tan = 1 / 3, np.tan(ALPHA) ** 2
    right = (1 - r2) ** 2 * tan + r2 * (r2 / tan - 2 * (1 - r2))
    assert right * (20 * ARCSEC) ** 2 == pytest.approx(checked(AXES, lifted).scale[0])


def test_29_has_twice_the_noise_and_no_scale_under_it() -> None:
    """The noise variance per K², as `printed` takes it, is doubled; to the letter it is K² times D_u besides."""
    noisy = replace(PERFECT, noise=3e-5 * GRAVITY)
    assert printed(AXES, noisy).scale / checked(AXES, noisy).scale == pytest.approx(np.full(6, 2.0))


def test_29_and_30_forget_the_variation_of_the_zero() -> None:
    varied = replace(PERFECT, bias_variation=3e-5 * GRAVITY)
    assert printed(AXES, varied).scale.max() == printed(AXES, varied).axis.max() == 0
    assert np.sqrt(checked(AXES, varied).scale.mean()) > 1e-5


def test_30_s_noise_goes_negative() -> None:
    noisy = replace(PERFECT, noise=3e-5 * GRAVITY)
    assert printed(share(0.95), noisy).axis[0] < 0
    assert checked(share(0.95), noisy).axis[0] > 0


def test_30_s_levelling_term_belongs_to_another_estimator() -> None:
    tilted = replace(PERFECT, stand=StandErrors(theta_y=20 * ARCSEC))
    assert np.sqrt(printed(AXES, tilted).axis[0]) == pytest.approx(21.3 * ARCSEC, rel=0.01)
    assert checked(AXES, tilted).axis[0] == 0


def test_the_beta_terms_of_29_and_30_are_too_large() -> None:
    c = replace(PERFECT, stand=StandErrors(beta=20 * ARCSEC))
    off = [
        np.sqrt(getattr(printed(AXES, c), p).mean() / getattr(checked(AXES, c), p).mean()) for p in ("scale", "axis")
    ]
    assert off == [pytest.approx(1.64, abs=0.02), pytest.approx(1.56, abs=0.02)]


def test_6_is_the_least_of_the_corrected_formulas_over_a_triad() -> None:
    """Formula (6) minimises scale and axis error summed over a triad, with the square that (29) lacks, and without
    θ_y.
    """
    triad = np.linalg.qr(np.array([[0.3, 0.8, -0.5], [0.9, 0.1, 0.4], [0.2, -0.6, -0.7]]))[0]

    def total(alpha: float, formula: object = checked) -> float:
        a = formula(triad, replace(PERFECT, alpha=alpha, stand=StandErrors(alpha=ARCSEC)))  # type: ignore[operator]
        return float((a.scale + a.axis).sum())

    found = minimize_scalar(total, bounds=(0.3, 1.2), method="bounded", options={"xatol": 1e-8}).x
    assert found == pytest.approx(optimal_elevation(StandErrors(alpha=ARCSEC), N), abs=1e-5)
    other = minimize_scalar(lambda a: total(a, printed), bounds=(0.3, 1.2), method="bounded").x
    assert np.degrees(abs(other - found)) > 1


def test_conditioning_does_not_improve_with_the_number_of_positions() -> None:
    few, many = (conditioning(block(accelerometers(), n)) for n in (6, 36))
    assert few == pytest.approx(many, rel=1e-9)


@pytest.mark.parametrize("paper", [ACCELEROMETERS, GYROS], ids=["table 1", "table 2"])
def test_row_36_of_the_tables_is_one_sigma(paper: object) -> None:
    rows = np.array(paper.rows)  # type: ignore[attr-defined]
    expected = rows[0, 1:] * np.sqrt(12 / 36)
    assert rows[1, 1:] == pytest.approx(rows[0, 1:] * np.sqrt(12 / 24), rel=0.06)
    assert expected / rows[2, 1:] == pytest.approx(np.full(3, 2.0), rel=0.09)


def test_table_2_s_axis_does_not_belong_to_its_scale() -> None:
    """Whatever the noise: the axis error is √2 times the relative scale error, 0.93 times by print; the table: 0.48."""
    _, _, scale, axis = GYROS.rows[0]
    noisy = replace(PERFECT, noise=1.0)
    by = [float(np.sqrt(f(AXES, noisy).axis.mean() / f(AXES, noisy).scale.mean())) for f in (checked, printed)]
    assert by == [pytest.approx(1.414, abs=0.01), pytest.approx(0.932, abs=0.01)]
    assert axis * ARCSEC / (scale / 100) == pytest.approx(0.485, abs=0.01)


def test_the_stated_variation_alone_exceeds_table_2() -> None:
    ratio = two_sigma(checked(AXES, GYROS.at(12, 0.0)), GYROS) / np.array(GYROS.rows[0][1:])
    assert fitted_noise(GYROS, checked) == 0
    assert ratio == pytest.approx([0.97, 1.76, 5.1], rel=0.02)


def test_two_axes_of_turns_are_not_enough_when_they_stay_in_their_planes() -> None:
    t = 2 * np.pi * np.arange(50) / 50
    planes = np.concatenate([np.stack([np.sin(t), 0 * t, np.cos(t)], -1), np.stack([0 * t, np.sin(t), np.cos(t)], -1)])
    assert rank_of_orientations(accelerometers(4), planes).rank == 12


def test_every_test_here_is_named_in_the_errata_and_the_other_way_round() -> None:
    listed = set(re.findall(r"`(test_\w+)`", ERRATA.read_text(encoding="utf-8")))
    here = {name for name in globals() if name.startswith("test_") and not name.startswith("test_every")}
    assert listed == here


def test_every_erratum_says_how_wrong_a_reader_would_be() -> None:
    entries = ERRATA.read_text(encoding="utf-8").split("\n### ")[1:]
    assert all("\nCost: " in entry for entry in entries)
