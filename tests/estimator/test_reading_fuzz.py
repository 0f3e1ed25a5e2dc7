"""Whatever the bytes, the answer is a session or a SessionError that can be shown and stored."""

import copy
import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimator.errors import SessionError
from estimator.reading import read_session
from tests import builders
from tests.estimator.test_reading_csv import csv_of

SEEDS = [
    builders.accelerometer_block(3, positions=2),
    builders.gyro_block(3, positions=2),
    builders.mixed_block(3, positions=2),
    builders.arbitrary_orientations(3, orientations=3, direction_sigma_deg=1.0),
    builders.raw_log(3, orientations=2, still=2, moving=1),
]
ODD = st.one_of(
    st.none(), st.booleans(), st.text(max_size=5), st.floats(), st.integers(), st.just(10**400), st.just(-(10**4000)),
    st.sampled_from(["", "1", "nan", "\ud800", "\x00", 1e308, -1e308, 5e-324, -0.0, [], {}, [[]], [None], "x" * 300]),
)  # fmt: skip
JSON = st.recursive(ODD, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner))


def answer(source):
    """Read it; any refusal must be printable and storable text with rows from 1."""
    refusal = None
    try:
        read_session(source)
    except SessionError as error:
        refusal = error
    if refusal is not None:
        assert refusal.problems
        str(refusal).encode("utf-8")
        assert all(p.row is None or p.row >= 1 for p in refusal.problems)


def places(node, way=()):
    """The path of every value in a document."""
    yield way
    children = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, child in children:
        yield from places(child, (*way, key))


@st.composite
def mutated(draw):
    """A valid document with up to four values replaced, taken out or renamed."""
    document = copy.deepcopy(draw(st.sampled_from(SEEDS)))
    for _ in range(draw(st.integers(1, 4))):
        way = draw(st.sampled_from([place for place in places(document) if place] or [("format",)]))
        parent = document
        for key in way[:-1]:
            parent = parent[key]
        change = draw(st.sampled_from(["put", "put", "drop", "repeat"]))
        if change == "put":
            parent[way[-1]] = copy.deepcopy(draw(JSON))
        elif change == "drop":
            del parent[way[-1]]
        elif isinstance(parent, dict):
            parent[draw(st.text(max_size=10)) + str(way[-1])] = copy.deepcopy(parent[way[-1]])
    return document


@pytest.mark.slow
@given(mutated())
@settings(max_examples=150, deadline=None, derandomize=True)
def test_mutated_documents(document):
    answer(document)


@given(mutated())
@settings(max_examples=100, deadline=None, derandomize=True)
def test_mutated_json(document):
    answer(json.dumps(document).encode())


@given(JSON)
@settings(max_examples=100, deadline=None, derandomize=True)
def test_any_json(document):
    answer(json.dumps(document).encode())
    answer(document)


@given(st.binary(max_size=200), st.sampled_from([b"", b"{", b"#", b'{"format":', b"# {}\n", b"\xef\xbb\xbf"]))
@settings(max_examples=150, deadline=None, derandomize=True)
def test_any_bytes(content, start):
    answer(start + content)


@given(st.data())
@settings(max_examples=150, deadline=None, derandomize=True)
def test_damaged_bytes(data):
    seed = data.draw(st.sampled_from(SEEDS))
    content = bytearray(data.draw(st.sampled_from([json.dumps(seed).encode(), csv_of(seed)])))
    for _ in range(data.draw(st.integers(1, 5))):
        at = data.draw(st.integers(0, len(content) - 1))
        content[at : at + data.draw(st.integers(0, 20))] = data.draw(st.binary(max_size=6))
        content = content or bytearray(b" ")
    answer(bytes(content))


@given(st.text(alphabet='0123456789.,;"\n\r\t#-eE nanif', max_size=300))
@settings(max_examples=300, deadline=None, derandomize=True)
def test_any_csv_table(text):
    document = {key: value for key, value in SEEDS[3].items() if key != "table"}
    answer(f"#{json.dumps(document)}\ntime_s,A1,A2,A3\n{text}".encode())
