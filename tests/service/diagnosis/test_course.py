"""The course of the applied vector as it is drawn."""

import numpy as np

from estimator import calibrate
from estimator.diagnosis.results import Course
from estimator.reading import read_session
from service.diagnosis.charts import course_charts
from tests.builders import accelerometer_block

RESIDUALS = calibrate(read_session(accelerometer_block())).residuals
ROWS = len(RESIDUALS.value)
ARCSEC = np.radians(1 / 3600)
VALUES = tuple((40 * ARCSEC * np.sin(k), 3e-6, 7 * ARCSEC) for k in range(ROWS))
THREE = ("α", "size", "β")


def marks(order: str) -> list[str]:
    """Marks with which a course along an order is drawn."""
    (angle, _) = course_charts(Course(order, THREE, VALUES), RESIDUALS, "course")
    return [layer["mark"]["type"] for layer in angle.spec["layer"]]


def test_angles_share_a_chart_in_arcseconds_and_the_size_has_its_own_in_ppm() -> None:
    angle, size = course_charts(Course("β", THREE, VALUES), RESIDUALS, "course")
    assert [panel.title for panel in (*angle.panels, *size.panels)] == ["α", "β", "size"]
    assert [panel.datasets["points"][3]["y"] for panel in angle.panels] == [float(f"{40 * np.sin(3):.5g}"), 7.0]
    assert size.panels[0].datasets["points"][0]["y"] == 3.0
    assert [panel.description.split("\u202f")[-1] for panel in (angle.panels[0], size.panels[0])] == ["arcsec", "ppm"]


def test_a_course_along_the_angle_is_drawn_against_it_and_another_in_order() -> None:
    assert RESIDUALS.beta is not None
    along, ordered = (
        course_charts(Course(order, ("α",), VALUES), RESIDUALS, "course")[0].panels[0].datasets["points"]
        for order in ("β, each run separately", "the order measured")
    )
    assert [point["x"] for point in along] == [float(f"{x:.6g}") for x in np.degrees(RESIDUALS.beta) % 360]
    assert [point["x"] for point in ordered] == list(range(1, ROWS + 1))


def test_rows_are_joined_only_where_the_course_is_smooth() -> None:
    assert ("line" in marks("β"), "line" in marks("no order: independent in every row")) == (True, False)


def test_a_vector_that_turned_as_a_whole_has_no_chart() -> None:
    assert course_charts(Course("turned as a whole", (), ((),) * ROWS), RESIDUALS, "course") == ()
