"""Parquet: one column a column of the table, the metadata as JSON in the key-value entry `imu-session`."""

from io import BytesIO

import polars as pl

from service.ingest.metadata import KEY, with_metadata
from service.kit.limits import check_table, refusal

MOST_TEXT = 64 * 1024 * 1024
"""Bytes of the labels of a column."""


def read_parquet(content: bytes, filename: str) -> dict[str, object]:
    """The document that a Parquet file holds."""
    columns = table_of(content, filename)
    metadata = pl.read_parquet_metadata(BytesIO(content)).get(KEY)
    if metadata is None:
        raise refusal(filename, "has no key-value entry {key}; put the session's JSON without its table there", key=KEY)
    return with_metadata(metadata, columns, filename)


def has_metadata(content: bytes) -> bool:
    """Whether a readable file has a session's metadata."""
    try:
        return KEY in pl.read_parquet_metadata(BytesIO(content))
    except (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError):
        return True  # what cannot be read is refused as it always is


def table_of(content: bytes, filename: str) -> dict[str, object]:
    """The columns of a Parquet file."""
    try:
        scan = pl.scan_parquet(BytesIO(content))
        schema = scan.collect_schema()
        check_table(filename, scan.select(pl.len()).collect().item(), len(schema))
        for name, dtype in schema.items():
            _check_type(name, dtype, filename)
        frame = scan.collect()
    except (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError) as error:
        raise refusal(filename, "is damaged or not a readable Parquet file; write it again") from error
    return columns_of(frame, filename)


def columns_of(frame: pl.DataFrame, filename: str) -> dict[str, object]:
    """Column name → numbers as an array where none is missing, else a list with None."""
    return {series.name: _cells(series, filename) for series in frame}


def _check_type(name: str, dtype: pl.DataType, filename: str) -> None:
    """Raises for a type that is no column of a table, before it is unpacked."""
    labels = (pl.String, pl.Categorical, pl.Enum, pl.Boolean)
    if not (dtype.is_numeric() or dtype in labels or isinstance(dtype, pl.Enum | pl.Categorical)):
        raise refusal(filename, "is of type {dtype}; a column contains numbers or text", name, dtype=dtype)


def _cells(series: pl.Series, filename: str) -> object:
    _check_type(series.name, series.dtype, filename)
    if series.dtype.is_numeric() and not series.has_nulls():
        return series.to_numpy()
    if series.dtype.is_numeric() or series.dtype == pl.Boolean:
        return series.to_list()
    if series.dtype in (pl.Categorical, pl.Enum):
        series = series.cast(pl.String)
    if (series.str.len_bytes().sum() or 0) > MOST_TEXT:
        raise refusal(filename, "contains far too much text; labels should be short", series.name)
    return series.to_list()
