"""The conditions that hold for every result of a session: temperature, gravity, site, elevation of the stand."""

from collections.abc import Iterator
from math import degrees

import numpy as np

from estimator.applied_vector import gravity
from estimator.session import ACCELEROMETER, CalibrationSession
from service.kit.xml import Element
from service.papers.dcc.elements import DCC, english
from service.papers.dcc.quantities import INPUT, bare_quantity

CELSIUS, DEGREE, METRE = r"\degreecelsius", r"\degree", r"\metre"
ELEVATIONS = {
    "alpha": "Elevation α of the head's axis above the horizon",
    "chi": "Elevation χ of the head's axis above the plane orthogonal to the Earth's axis",
}
"""How a stand was set, by the attribute that holds it."""


def conditions(source: CalibrationSession) -> Element:
    """Every condition that is known; of the temperature also that it was not recorded."""
    return DCC.influenceConditions(_temperature(source), *_site(source), *_elevations(source))


def _condition(name: str, *data: Element) -> Element:
    return DCC.influenceCondition(english("name", name), DCC.data(*data))


def _temperature(source: CalibrationSession) -> Element:
    if source.temperature is None:
        return _condition("Temperature", english("text", "not recorded"))
    extremes = (("lowest", np.min(source.temperature)), ("highest", np.max(source.temperature)))
    return _condition("Temperature", *(bare_quantity(name, float(value), CELSIUS) for name, value in extremes))


def _site(source: CalibrationSession) -> Iterator[Element]:
    site = source.site
    if site.latitude is not None:
        latitude = bare_quantity("latitude", degrees(site.latitude), DEGREE)
        yield _condition("Site", latitude, bare_quantity("height", site.height, METRE))
    if any(sensor.kind == ACCELEROMETER for sensor in source.sensors):
        origin = "measured" if site.gravity is not None else "by the formula for latitude and height"
        yield _condition(f"Gravity, {origin}", bare_quantity("gravity", gravity(site), INPUT[True]))


def _elevations(source: CalibrationSession) -> Iterator[Element]:
    for attribute, name in ELEVATIONS.items():
        angle = None if source.stand is None else getattr(source.stand, attribute)
        if angle is not None:
            yield _condition(name, bare_quantity("elevation", degrees(angle), DEGREE))
