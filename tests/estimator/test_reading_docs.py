"""The examples and the field lists of the documentation are true."""

import re
from pathlib import Path

import pytest

from estimator.reading import read_session
from estimator.reading.bounds import BOUNDS
from estimator.reading.keys import COLUMNS, SENSOR, SIGMA, SITE, STAND, TOP
from tests.estimator.test_reading_csv import same

PAGE = (Path(__file__).parents[2] / "docs" / "session-file.md").read_text(encoding="utf-8")


def example(language):
    block, *_ = re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)
    return block.encode()


def test_the_examples_work_and_are_the_same_session():
    session = read_session(example("json"))
    assert session.readings.shape == (8, 3)
    assert same(read_session(example("csv")), session)


@pytest.mark.parametrize("key", [*TOP, *SITE, *STAND, *SIGMA, *SENSOR, *COLUMNS])
def test_every_field_is_described(key):
    assert f"`{key}`" in PAGE


def test_the_page_has_the_bounds_of_every_number():
    stated = {
        line
        for line in PAGE.splitlines()
        if line.startswith("| `") and line.count("|") == 6 and line.rstrip(" |").endswith(("yes", "no"))
    }
    assert stated == {bound.row for bound in BOUNDS}
