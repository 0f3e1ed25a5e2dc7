"""Rules for the text of every page."""

import re

from fastapi import Request

from estimator.errors import Problem
from service.pages.session.pages import session_page
from service.settings import Settings
from service.uploads.pages import FileOutcome, upload_page
from service.web.render import TEMPLATES, embed, render
from tests.service.pages.records import session_report


def request_for(path: str) -> Request:
    return Request({"type": "http", "path": path, "headers": [], "query_string": b""})


def test_data_cannot_end_its_block() -> None:
    assert "</script>" not in embed({"note": "</script><script>alert(1)</script>"})


def test_what_a_file_says_is_text_never_markup() -> None:
    report = session_report(operator="<b>O</b>", notes="<script>x</script>", filename='"><img src=x>')
    page = bytes(render(request_for("/sessions/5e55"), "session.html", session_page(report)).body).decode()
    assert "<b>O</b>" not in page
    assert "<script>x" not in page
    assert "<img" not in page


def test_problems_name_field_row_and_what_to_do() -> None:
    outcome = FileOutcome("bad.json", None, (Problem("table.A3", "is NaN; measure again", 7),))
    page = bytes(render(request_for("/upload"), "upload.html", upload_page([outcome], Settings())).body).decode()
    row = re.search(r"<tr><td><code>(.*?)</code></td><td[^>]*>(.*?)</td><td>(.*?)</td>", page)
    assert row is not None
    assert row.groups() == ("table.A3", "7", "is NaN; measure again")


def test_templates_hold_no_inline_style_and_no_inline_script() -> None:
    templates = [template for folder in TEMPLATES for template in folder.glob("*.html")]
    assert templates
    for template in templates:
        text = template.read_text()
        assert "style=" not in text
        assert "<style" not in text
        assert re.findall(r"<script(?! type=\"application/json\"| type=\"module\" src=)", text) == []
        assert re.findall(r"\son\w+=", text) == []
