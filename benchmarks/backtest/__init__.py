"""Forecasts and drift detection against simulated histories whose future is known: `python -m benchmarks.backtest`."""
