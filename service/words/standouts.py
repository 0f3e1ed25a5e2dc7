"""How a unit or a production lot drifts unlike the others of its type, in words."""

from service.records.outlook import Rate
from service.words.names import PARAMETER_NAMES


def drift_stands_out(rate: Rate) -> str:
    """Of one parameter of one unit."""
    drift = f"drifts by {100 * abs(rate.value):.0f} % of its tolerance a year, unlike the other units of its type."
    return f"{rate.sensor} {PARAMETER_NAMES[rate.parameter]} {drift}"


def lot_stands_out(lot: str, unit_type: str, parameter: str) -> str:
    """Of one parameter of a lot."""
    return f"Lot {lot} of {unit_type}: {PARAMETER_NAMES[parameter]} drifts unlike that of the other units."
