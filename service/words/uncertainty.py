"""The statement of uncertainty that a certificate makes, in the words of EA-4/02 M:2022, section 6."""

from estimator.coverage import chance
from estimator.results import Calibration
from service.measures import number
from service.words.coverage import coverage_in_words, noise_is_estimated

NORMAL = (
    "The reported expanded uncertainty of measurement is stated as the standard uncertainty of measurement multiplied "
    "by the coverage factor k = {k}, which for a normal distribution corresponds to a coverage probability of "
    "approximately {percent} %."
)
STUDENT = (
    "The reported expanded uncertainty of measurement is stated as the standard uncertainty of measurement multiplied "
    "by the coverage factor {k}; for a t-distribution of these degrees of freedom it corresponds to a coverage "
    "probability of approximately {percent} %."
)
BY = "The standard uncertainty of measurement has been determined in accordance with EA-4/02."


def uncertainty_in_words(calibration: Calibration, k: float) -> str:
    """With the coverage factor that the session was judged with."""
    percent = number(100 * (2.0 * chance(k, None) - 1.0), 0)
    if noise_is_estimated(calibration):
        return f"{STUDENT.format(k=coverage_in_words(calibration, k), percent=percent)} {BY}"
    return f"{NORMAL.format(k=number(k), percent=percent)} {BY}"
