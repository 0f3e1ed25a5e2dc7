"""Coverage factors and effective degrees of freedom against JCGM 100:2008."""

import pytest

from estimator.coverage import chance, combined, coverage_factor, nominal_factor, positions_to_add


@pytest.mark.parametrize(
    ("dof", "factor"), [(1, 13.97), (2, 4.53), (3, 3.31), (5, 2.65), (10, 2.28), (20, 2.13), (50, 2.05)]
)
def test_the_factor_is_that_of_table_g_2(dof: int, factor: float) -> None:
    assert coverage_factor(2.0, dof) == pytest.approx(factor, abs=0.006)


def test_known_noise_keeps_the_factor() -> None:
    assert coverage_factor(2.0, None) == nominal_factor(2.0, None) == 2.0


def test_the_factor_for_known_noise_is_found_again() -> None:
    assert nominal_factor(coverage_factor(2.5, 3.4), 3.4) == pytest.approx(2.5)


def test_effective_degrees_of_freedom_of_the_end_gauge_example() -> None:
    """H.1.6: 25 nm (18), 9.7 nm (25.6), 2.9 nm (50), 16.6 nm (2) give 16.7."""
    parts = ((25.0**2, 18.0), (9.7**2, 25.6), (2.9**2, 50.0), (16.6**2, 2.0))
    assert combined(*parts) == pytest.approx(16.7, abs=0.15)


def test_a_known_part_adds_degrees_of_freedom() -> None:
    assert combined((1.0, None), (1.0, 3.0)) == pytest.approx(12.0)
    assert combined((1.0, None), (1.0, None)) is None


def test_students_law_has_the_heavier_tail() -> None:
    assert chance(-2.0, 3.0) > chance(-2.0, 30.0) > chance(-2.0, None) == pytest.approx(0.02275, abs=1e-5)


def test_five_degrees_of_freedom_are_measured_for() -> None:
    assert [positions_to_add(0, 1), positions_to_add(0, 4), positions_to_add(-3, 1)] == [5, 2, 8]
