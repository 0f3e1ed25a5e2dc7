"""The cause that has no mean effect: more noise than stated."""

from estimator.causes.contract import Cause


class ExcessNoise(Cause):
    """The amplitude is the extra standard deviation of one reading at the input."""

    identifier = "excess-noise"
    scope = "sensor"
    equation = "variance above the stated one, no mean effect"
    units = ("m/s²",)
    sentence = "{sensors} is noisier than its stated uncertainty."
    advice = "Look for vibration, a loose connector or a bad converter; average longer and state the true uncertainty."
