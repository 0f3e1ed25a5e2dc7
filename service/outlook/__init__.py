"""Next calibrations of units and their reasons: drift, forecast, risk."""
