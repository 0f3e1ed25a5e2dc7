"""Dates are worked out with little effort here too."""

from tests.service.conftest import light_forecasts as light_forecasts
