"""Causes that show only while a turntable turns; the columns of their effect are in `estimator.alignment.levers`."""

from collections.abc import Sequence

from estimator.causes.contract import Cause
from estimator.message import joined, say


class LeverArm(Cause):
    """A property of how the block sits on the table, and no fault: an alignment estimates it and takes it off."""

    identifier = "lever-arm"
    scope = "fixture"
    equation = (
        "−ω²·(a_x r_x + a_y r_y) + α·(a_y r_x − a_x r_y) while the table turns, k = (r_x, r_y) from the turn axis"
    )
    units = ("m", "m")
    amplitude_words = ("x =", "y =")
    kind = "accelerometer"
    always_modelled = True
    sentence = "{sensors} is off the turn axis and measures the rotation."
    advice = (
        "The sensor is in order, and the alignment has corrected the effect. State the positions of the sensors "
        "(position_m); they are then checked."
    )
    correct = "Measure the positions of the sensors and correct position_m; check that no two sensors are exchanged."
    """Advice where the turns contradict a stated position."""

    def lever_sentence(self, sensor: str, distance: str) -> str:
        """The sentence with the size: ``A2 is 4.1 ± 0.4 cm from the turn axis and measures the rotation.``"""
        return say(
            "{sensor} is {distance} from the turn axis and measures the rotation.", sensor=sensor, distance=distance
        )

    def contradiction_sentence(self, sensor: str, distance: str) -> str:
        """The sentence where the file states positions, and the turns contradict that of this sensor."""
        return say("{sensor} is {distance} from its stated position.", sensor=sensor, distance=distance)

    def separation_sentence(self, sensors: Sequence[str], distance: str) -> str:
        """The sentence where the turns cannot tell which of two sensors sits elsewhere."""
        return say(
            "{sensors} are not at their stated positions relative to one another: one of them is {distance} away.",
            sensors=joined(" and ", sensors),
            distance=distance,
        )
