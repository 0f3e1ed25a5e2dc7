"""The examples and the field lists of the documentation are true."""

import json
import re
from pathlib import Path

import pytest

from benchmarks.bounds import PAGE as BOUNDS_PAGE
from benchmarks.bounds import page as bounds_page
from estimator.reading import read_session
from estimator.reading.keys import COLUMNS, SENSOR, SIGMA, SITE, STAND, TOP
from tests.estimator.test_reading_csv import same

PAGE = (Path(__file__).parents[2] / "docs" / "session-file.md").read_text(encoding="utf-8")


def example(language):
    block, *_ = re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)
    return block.encode()


def test_the_examples_work_and_are_the_same_session():
    session = read_session(example("json"))
    assert session.readings.shape == (8, 3)
    facts = {key: value for key, value in json.loads(example("json")).items() if key != "table"}
    first, rows = example("csv").split(b"\n", 1)
    assert first.startswith(b"# ")
    assert same(read_session(b"# " + json.dumps(facts).encode() + b"\n" + rows), session)


@pytest.mark.parametrize("key", [*TOP, *SITE, *STAND, *SIGMA, *SENSOR, *COLUMNS])
def test_every_field_is_described(key):
    assert f"`{key}`" in PAGE


def test_the_bounds_of_every_number_are_written_down():
    assert BOUNDS_PAGE.read_text(encoding="utf-8") == bounds_page(), "run `python -m benchmarks.bounds`"
