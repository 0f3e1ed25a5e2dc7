"""From a frozen record to a PDF by typst, which is given what the record says as data, never as part of its source."""

import json
from datetime import datetime
from pathlib import Path
from typing import Any

import typst

from service.reports.printable import printable_data

TEMPLATES = Path(__file__).parent / "templates"
"""The only folder that typst may read."""


def typeset(template: str, record: Any, at: datetime) -> bytes:
    """The document of a frozen record; the same record gives the same bytes. ``at`` is the date that it carries."""
    return _compiled(template, record, format="pdf", timestamp=at.replace(microsecond=0))


def typeset_svg(template: str, record: Any) -> bytes:
    """The one page of a frozen record as a drawing."""
    return _compiled(template, record, format="svg")


def _compiled(template: str, record: Any, **wanted: Any) -> bytes:
    data = json.dumps(printable_data(record), ensure_ascii=False, allow_nan=False)
    document = typst.compile(
        TEMPLATES / template, root=TEMPLATES, sys_inputs={"data": data}, ignore_system_fonts=True, **wanted
    )
    assert isinstance(document, bytes)
    return document
