"""Dates are worked out with little effort, and the same things once, here too."""

from tests.service.conftest import light_forecasts as light_forecasts
from tests.service.conftest import worked_out_once as worked_out_once
