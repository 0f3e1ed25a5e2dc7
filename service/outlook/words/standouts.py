"""How a unit or a production lot drifts unlike the others of its type, in words."""

from estimator.message import say
from service.kit.names import PARAMETER_NAMES


def drift_stands_out(sensor: str, parameter: str, value: float) -> str:
    """Of one parameter of one unit; its rate in tolerances a year."""
    drift = say(
        "drifts by {value} % of its tolerance a year, unlike the other units of its type.",
        value=f"{100 * abs(value):.0f}",
    )
    return say(
        "{sensor} {parameter_names} {drift}", sensor=sensor, parameter_names=PARAMETER_NAMES[parameter], drift=drift
    )


def lot_stands_out(lot: str, unit_type: str, parameter: str) -> str:
    """Of one parameter of a lot."""
    return say(
        "Lot {lot} of {unit_type}: {parameter_names} drifts unlike that of the other units.",
        lot=lot,
        unit_type=unit_type,
        parameter_names=PARAMETER_NAMES[parameter],
    )
