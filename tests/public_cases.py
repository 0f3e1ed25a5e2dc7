"""Folder of the public cases, which are no part of the project."""

import os
from pathlib import Path

CASES = Path(os.environ.get("IMU_HEALTH_CASES", Path(__file__).parents[2] / "shared" / "cases"))
"""Each a folder with its files."""
