"""How a unit or a production lot drifts unlike the others of its type, in words."""

from service.kit.names import PARAMETER_NAMES


def drift_stands_out(sensor: str, parameter: str, value: float) -> str:
    """Of one parameter of one unit; its rate in tolerances a year."""
    drift = f"drifts by {100 * abs(value):.0f} % of its tolerance a year, unlike the other units of its type."
    return f"{sensor} {PARAMETER_NAMES[parameter]} {drift}"


def lot_stands_out(lot: str, unit_type: str, parameter: str) -> str:
    """Of one parameter of a lot."""
    return f"Lot {lot} of {unit_type}: {PARAMETER_NAMES[parameter]} drifts unlike that of the other units."
