"""The reference, made from the code: every command, every call of HTTP, every public name of Python."""

import tempfile
from pathlib import Path

import estimator
from docs.site.command_line import command_line_page
from docs.site.http import http_page
from docs.site.python import python_page
from service import client
from service.app import create_app
from service.settings import Settings

MADE = "\n\n*Made from the code by `make docs`.*\n\n"


def reference_pages() -> dict[str, tuple[str, str]]:
    """The line of the index and the text of every page, by path."""
    with tempfile.TemporaryDirectory() as folder:
        described = create_app(Settings(data_folder=Path(folder))).openapi()
    return {
        "reference/command-line.md": (
            "Every command: arguments, options and examples of `imu-health`",
            "# Every command" + MADE + command_line_page(),
        ),
        "reference/http.md": (
            "Every call of HTTP: parameters, bodies and answers, as `/openapi.json` describes them",
            "# Every call of HTTP" + MADE + http_page(described),
        ),
        "reference/estimator.md": (
            "Python, estimator: sessions, calibration, diagnosis and parity without a service",
            "# Python: estimator" + MADE + python_page(estimator),
        ),
        "reference/client.md": (
            "Python, service.client: a running service from another program",
            "# Python: service.client" + MADE + python_page(client),
        ),
    }
