"""Records as tables for other programs: CSV, Parquet and Arrow."""

import io
from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any
from urllib.parse import quote

from fastapi import Request, Response

from estimator.json_object import Json
from service.kit.libraries import pl

FORMS = {
    "application/json": "json",
    "text/csv": "csv",
    "application/vnd.apache.parquet": "parquet",
    "application/vnd.apache.arrow.stream": "arrow",
}
"""Media types of tables and their values of the parameter `format`; the first one is the default."""


def wanted_form(request: Request, stated: str | None, forms: Mapping[str, str] = FORMS) -> str:
    """The form in the address, else the one preferred by the header, else the first."""
    if stated is not None:
        return stated
    weights = _weights(request.headers.get("accept", ""))
    ranked = {
        media: max((weights[kind] for kind in _covering(media) if kind in weights), default=0.0) for media in forms
    }
    best = max(ranked, key=ranked.__getitem__)
    return forms[best]


def _covering(media: str) -> tuple[str, str, str]:
    return media, f"{media.partition('/')[0]}/*", "*/*"


def _weights(header: str) -> dict[str, float]:
    """Media types with their weights (RFC 9110, 12.5.1); an invalid weight is ignored."""
    weights = {}
    for part in header.split(","):
        media, _, rest = part.partition(";")
        weight = rest.strip().removeprefix("q=") or "1"
        if weight.replace(".", "", 1).isdecimal():
            weights[media.strip().lower()] = float(weight)
    return weights


BINARY = {"schema": {"type": "string", "format": "binary"}}
"""Schema of a table in OpenAPI."""
TABLES: Json = {media: BINARY for media, form in FORMS.items() if form != "json"}
BY_HEADER = {"Vary": "Accept"}
"""Headers of an answer whose form depends on the header `Accept`."""
FORMULA = r"(^|;)([=+\-@\t\r])"
"""First character of a cell that a spreadsheet would evaluate instead of showing; some split lines at semicolons."""


def as_csv(table: "pl.DataFrame", filename: str) -> Response:
    """A line of names, then one line a row; times in ISO 8601. No text can pass for a formula of a spreadsheet. Where
    one has a semicolon, all are quoted."""
    texts = [column for column in table.iter_columns() if column.dtype == pl.String]
    has_semicolon = any(column.str.contains(";", literal=True).any() for column in texts)
    text = table.with_columns(pl.col(column.name).str.replace_all(FORMULA, "${1}'${2}") for column in texts).write_csv(
        datetime_format="%Y-%m-%dT%H:%M:%S%.6fZ", quote_style="non_numeric" if has_semicolon else "necessary"
    )
    return as_file(text.encode(), "text/csv; charset=utf-8", filename)


def as_parquet(table: "pl.DataFrame", filename: str) -> Response:
    """Parquet."""
    target = io.BytesIO()
    table.write_parquet(target)
    return as_file(target.getvalue(), "application/vnd.apache.parquet", filename)


def as_arrow(table: "pl.DataFrame", filename: str) -> Response:
    """Arrow's streaming format, with text in the layout that every Arrow reader supports."""
    target = io.BytesIO()
    table.write_ipc_stream(target, compat_level=pl.CompatLevel.oldest())
    return as_file(target.getvalue(), "application/vnd.apache.arrow.stream", filename)


WRITERS = {"csv": as_csv, "parquet": as_parquet, "arrow": as_arrow}
"""Writers by the value of the parameter `format`."""


def as_table(table: "pl.DataFrame", form: str, name: str) -> Response:
    """A table in one of these forms, as a file of this name."""
    answer = WRITERS[form](table, f"{name}.{form}")
    answer.headers.update(BY_HEADER)
    return answer


def table_of(rows: Sequence[Mapping[str, Any]], columns: Mapping[str, type]) -> "pl.DataFrame":
    """Rows as columns of their types; times in microseconds, as stored by both databases."""
    cells = {name: [_plain(row[name]) for row in rows] for name in columns}
    time = pl.Datetime("us", "UTC")
    return pl.DataFrame(cells, schema={name: time if kind is datetime else kind for name, kind in columns.items()})


def _plain(value: Any) -> Any:
    """A verdict is written as its text."""
    return str(value) if isinstance(value, str) else value


def as_file(content: bytes, media_type: str, filename: str) -> Response:
    """Bytes as a file of this name in the browser."""
    return Response(content, media_type=media_type, headers={"Content-Disposition": disposition(filename)})


def disposition(filename: str) -> str:
    """The header for saving an answer under a name, whatever characters it has."""
    return f"attachment; filename*=UTF-8''{quote(filename, safe='')}"


PDF = "application/pdf"
"""Media type."""


XLSX = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"
"""Media type (ISO/IEC 29500)."""
