"""The tables and formulas of the papers beside ours: ``python -m benchmarks.papers``."""
