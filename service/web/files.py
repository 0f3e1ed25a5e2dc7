"""Records as tables that other programs read: CSV, Parquet and Arrow."""

import io
from collections.abc import Mapping, Sequence
from typing import Any
from urllib.parse import quote

import polars as pl
from fastapi import Request, Response

from estimator.json_object import Json

FORMS = {
    "application/json": "json",
    "text/csv": "csv",
    "application/vnd.apache.parquet": "parquet",
    "application/vnd.apache.arrow.stream": "arrow",
}
"""Media types of tables and what the parameter `format` calls them; the first one is for whoever names none."""


def wanted_form(request: Request, named: str | None, forms: Mapping[str, str] = FORMS) -> str:
    """What the address names, else what the header likes best, else the first form."""
    if named is not None:
        return named
    liked = _liked(request.headers.get("accept", ""))
    offered = {media: max((liked[kind] for kind in _covering(media) if kind in liked), default=0.0) for media in forms}
    best = max(offered, key=offered.__getitem__)
    return forms[best]


def _covering(media: str) -> tuple[str, str, str]:
    return media, f"{media.partition('/')[0]}/*", "*/*"


def _liked(header: str) -> dict[str, float]:
    """Media types with their weights (RFC 9110, 12.5.1); one whose weight is no number is passed over."""
    found = {}
    for part in header.split(","):
        media, _, rest = part.partition(";")
        weight = rest.strip().removeprefix("q=") or "1"
        if weight.replace(".", "", 1).isdecimal():
            found[media.strip().lower()] = float(weight)
    return found


TIME = pl.Datetime("us", "UTC")
"""Microseconds, as both databases keep them."""
BINARY = {"schema": {"type": "string", "format": "binary"}}
"""How OpenAPI describes a table."""
TABLES: Json = {media: BINARY for media, form in FORMS.items() if form != "json"}
BY_HEADER = {"Vary": "Accept"}
"""Of an answer whose form the header `Accept` may choose."""
FORMULA = r"^[=+\-@\t\r]"
"""How a cell begins that a spreadsheet would work out instead of showing."""


def as_csv(table: pl.DataFrame, filename: str) -> Response:
    """A line of names, then one line a row; times in ISO 8601. No text can pass for a formula of a spreadsheet."""
    harmless = [_harmless(column.name) for column in table.iter_columns() if column.dtype == pl.String]
    text = table.with_columns(harmless).write_csv(datetime_format="%Y-%m-%dT%H:%M:%S%.6fZ")
    return as_file(text.encode(), "text/csv; charset=utf-8", filename)


def _harmless(column: str) -> pl.Expr:
    cell = pl.col(column)
    return pl.when(cell.str.contains(FORMULA)).then(pl.concat_str(pl.lit("'"), cell)).otherwise(cell).alias(column)


def as_parquet(table: pl.DataFrame, filename: str) -> Response:
    """Parquet."""
    target = io.BytesIO()
    table.write_parquet(target)
    return as_file(target.getvalue(), "application/vnd.apache.parquet", filename)


def as_arrow(table: pl.DataFrame, filename: str) -> Response:
    """Arrow's streaming format, with text in the layout that every reader of Arrow knows."""
    target = io.BytesIO()
    table.write_ipc_stream(target, compat_level=pl.CompatLevel.oldest())
    return as_file(target.getvalue(), "application/vnd.apache.arrow.stream", filename)


WRITERS = {"csv": as_csv, "parquet": as_parquet, "arrow": as_arrow}
"""By what the parameter `format` calls them."""


def as_table(table: pl.DataFrame, form: str, name: str) -> Response:
    """A table in one of these forms, as a file of this name."""
    answer = WRITERS[form](table, f"{name}.{form}")
    answer.headers.update(BY_HEADER)
    return answer


def table_of(rows: Sequence[Mapping[str, Any]], columns: Mapping[str, pl.DataType]) -> pl.DataFrame:
    """Rows as columns of their types."""
    cells = {name: [_plain(row[name]) for row in rows] for name in columns}
    return pl.DataFrame(cells, schema=dict(columns))


def _plain(value: Any) -> Any:
    """A verdict is written as its text."""
    return str(value) if isinstance(value, str) else value


def as_file(content: bytes, media_type: str, filename: str) -> Response:
    """Bytes that a browser keeps as a file of this name."""
    return Response(content, media_type=media_type, headers={"Content-Disposition": disposition(filename)})


def disposition(filename: str) -> str:
    """The header that makes a browser keep an answer under a name, whatever is written in it."""
    return f"attachment; filename*=UTF-8''{quote(filename, safe='')}"


PDF = "application/pdf"
"""Media type."""


XLSX = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"
"""Media type (ISO/IEC 29500)."""
