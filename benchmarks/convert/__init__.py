"""Converters of public recordings to session files. A new format is one file and one entry of `FORMATS`."""

from collections.abc import Sequence
from pathlib import Path

from benchmarks.convert.contract import Converter, Document
from benchmarks.convert.ctu_mat import CTU_MAT
from benchmarks.convert.ferraris_csv import FERRARIS_CSV
from benchmarks.convert.imu_tk import IMU_TK
from benchmarks.convert.kth_mimu import KTH_MIMU
from benchmarks.convert.mpu9150_five import MPU9150_FIVE
from estimator.errors import FormatError, Problem

__all__ = ["FORMATS", "Converter", "Document", "convert"]

FORMATS: tuple[Converter, ...] = (IMU_TK, MPU9150_FIVE, KTH_MIMU, CTU_MAT, FERRARIS_CSV)
"""Every converter; the command line lists them in this order."""


def convert(format_name: str, paths: Sequence[Path]) -> list[tuple[str, Document]]:
    """Suggested file name and session of everything that the files hold; `FormatError` when they cannot be used."""
    for converter in FORMATS:
        if converter.name == format_name:
            return converter.convert(list(paths))
    known = ", ".join(converter.name for converter in FORMATS)
    raise FormatError([Problem("format", f"{format_name!r} is not known; choose one of {known}")])
