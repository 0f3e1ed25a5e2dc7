"""Timings against what a user would pick instead, as ratios of one run on one machine: ``python -m benchmarks``."""
