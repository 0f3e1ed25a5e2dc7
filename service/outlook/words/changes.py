"""What changed in a parameter, in words: a jump between two dates, a drift since one, no steady rate."""

from estimator.message import say
from service.kit.measures import Measure, deviation_measure, in_words, signed
from service.kit.names import PARAMETER_NAMES, day_of
from service.outlook.records import FoundChange, ParameterTrend, TemperatureCoefficient


def changes_of(trend: ParameterTrend) -> tuple[str, ...]:
    """One sentence a change that chance does not explain; the temperature's last."""
    warm = trend.temperature
    followed = (_follows(trend, warm),) if warm is not None and warm.is_found else ()
    return (*(change_in_words(trend, change) for change in trend.changes), *followed)


def change_in_words(trend: ParameterTrend, change: FoundChange) -> str:
    """``A3 bias has jumped between 2 Mar 2026 and 4 May 2026 by +40 ± 3 µg; 50 µg are allowed.``"""
    allowed = say("{kind} are allowed", kind=in_words(trend.kind, trend.parameter, trend.tolerance))
    after, before = day_of(change.after), day_of(change.before)
    moved = _sized(trend, change.size, change.sigma)
    says = {
        "jump": say("has jumped between {after} and {before} by {moved}", after=after, before=before, moved=moved),
        "drift": say(
            "has been drifting since {after} by {trend}",
            after=after,
            trend=_sized(trend, change.size, change.sigma, "{rate} a year"),
        ),
        "aging": say(
            "is aging since {after}, by {moved} in the first year and slower from then on", after=after, moved=moved
        ),
        "walk": say("has moved since {after}, at no steady rate; by {moved} so far", after=after, moved=moved),
    }
    return say("{trend} {says}; {allowed}.", trend=place_of(trend), says=says[change.kind], allowed=allowed)


def place_of(trend: ParameterTrend) -> str:
    """``A3 bias``."""
    return say("{sensor} {parameter_names}", sensor=trend.sensor, parameter_names=PARAMETER_NAMES[trend.parameter])


def _follows(trend: ParameterTrend, warm: TemperatureCoefficient) -> str:
    return say(
        "{trend} follows the temperature of the session, by {trend2}; its trend goes on without that.",
        trend=place_of(trend),
        trend2=_sized(trend, warm.value, warm.sigma, "{rate} per °C"),
    )


def _sized(trend: ParameterTrend, size: float, sigma: float, per: str = "{rate}") -> str:
    """With U, k = 2."""
    measure = deviation_measure(trend.kind, trend.parameter, abs(size))
    return signed(size, 2 * sigma, Measure(say(per, rate=measure.label), measure.factor))
