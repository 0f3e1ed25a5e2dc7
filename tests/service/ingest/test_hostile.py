"""Files made to do harm, and files damaged at random: refused with a reason, at little cost."""

import json
from dataclasses import replace
from io import BytesIO
from zipfile import ZIP_DEFLATED, ZipFile

import h5py
import numpy as np
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from benchmarks.files.hostile import HOSTILE, Hostile
from estimator.errors import FormatError, SessionError
from service.ingest import read_upload
from service.kit import limits
from tests import builders
from tests.service.ingest.test_formats import WRITERS, metadata, parquet_bytes, xlsx_bytes

SMALL = builders.accelerometer_block(3, positions=2)
FILES = {kind: write(SMALL) for kind, write in WRITERS.items()}


def refused(content, words):
    with pytest.raises(FormatError, match=words):
        read_upload(content, "x")


@st.composite
def damaged(draw, kind):
    """A good file of this kind with a few stretches of it overwritten, taken out or grown."""
    content = bytearray(FILES[kind])
    for _ in range(draw(st.integers(1, 6))):
        at = draw(st.integers(0, len(content) - 1))
        content[at : at + draw(st.integers(0, 8))] = draw(st.binary(max_size=8))
    return bytes(content)


def read_or_refused(content):
    refusal = None
    try:
        read_upload(content, "x")
    except SessionError as error:
        refusal = error
    assert refusal is None or refusal.problems


@given(content=st.sampled_from(list(WRITERS)).flatmap(damaged))
@settings(max_examples=300, deadline=None, derandomize=True)
def test_damaged_bytes_are_never_more_than_refused(content):
    read_or_refused(content)


@pytest.fixture
def limited():
    """Other limits, until the test ends."""
    usual = limits.in_force()
    yield lambda **changes: limits.use(replace(usual, **changes))
    limits.use(usual)


LARGE = {"parquet-many-rows", "hdf5-many-columns", "mat-unpacks"}
"""They take seconds to make or to read."""


@pytest.mark.parametrize(
    "hostile",
    [pytest.param(one, id=one.name, marks=[pytest.mark.slow] * (one.name in LARGE)) for one in HOSTILE],
)
def test_a_file_made_to_do_harm_is_refused_with_a_reason(hostile: Hostile, limited):
    if "endless" in hostile.name:
        limited(seconds=1)
    refused(hostile.make(), hostile.says)


@pytest.mark.parametrize("magic", [b"PAR1", b"PK\x03\x04", b"\x89HDF\r\n\x1a\n", b"MATLAB 5.0 MAT-file", b"MATLAB 7.3"])
@pytest.mark.parametrize("rest", [b"", b"\0" * 300, b"\xff" * 300, bytes(range(256))])
def test_a_known_beginning_alone_is_not_enough(magic, rest):
    refused(magic + rest, "x: file:")


def rewritten(content, name, change):
    """A workbook with one of its members changed."""
    buffer = BytesIO()
    with ZipFile(BytesIO(content)) as old, ZipFile(buffer, "w", ZIP_DEFLATED) as new:
        for member in old.namelist():
            data = old.read(member)
            new.writestr(member, change(data) if member == name else data)
    return buffer.getvalue()


def test_a_workbook_without_its_sheets():
    changed = rewritten(xlsx_bytes(SMALL), "xl/workbook.xml", lambda data: data.replace(b'"readings"', b'"Sheet1"'))
    refused(changed, "no sheet readings")


def test_parquet_without_metadata():
    buffer = BytesIO()
    pl.DataFrame(SMALL["table"]).write_parquet(buffer)
    refused(buffer.getvalue(), "no key-value entry imu-session")


def test_parquet_columns_of_lists():
    refused(parquet_bytes(SMALL | {"table": {"A1": [[1.0]] * 4}}), "A1: is of type List")


def hdf5_with(fill):
    buffer = BytesIO()
    with h5py.File(buffer, "w") as file:
        file.attrs["imu-session"] = metadata(SMALL)
        fill(file.create_group("readings"))
    return buffer.getvalue()


def test_hdf5_links_to_other_files_are_not_followed(tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["secret"] = [1.0, 2.0]

    def fill(group):
        group["A1"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "secret")

    refused(hdf5_with(fill), "A1: is a link")


def test_hdf5_data_kept_in_other_files_is_not_read(tmp_path):
    secret = tmp_path / "secret"
    secret.write_bytes(bytes(16))

    def fill(group):
        group.create_dataset("A1", (2,), "f8", external=[(str(secret), 0, 16)])

    refused(hdf5_with(fill), "A1: is not a plain column")


def mat_with(**variables):
    buffer = BytesIO()
    savemat(buffer, {"imu_session": metadata(SMALL), **variables}, oned_as="column")
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ({"a": 1.0}, "A1: is of kind struct"),
        (np.array(["a", "b"], dtype=object), "A1: is of kind cell"),
        (np.zeros((2, 2)), "A1: has the shape"),
        (np.zeros((2, 2, 2)), "A1: has the shape"),
    ],
)
def test_mat_variables_that_are_no_columns(value, words):
    refused(mat_with(A1=value), words)


@pytest.mark.parametrize("version", [0, 2, 7])
def test_mat_whose_header_says_another_version(version):
    content = bytearray(mat_with(A1=[1.0, 2.0]))
    content[125 if content[126:128] == b"IM" else 124] = version
    refused(bytes(content), "damaged")


def test_mat_without_metadata():
    buffer = BytesIO()
    savemat(buffer, {"A1": [1.0, 2.0]})
    refused(buffer.getvalue(), "no text variable imu_session")


def test_metadata_that_holds_the_table_itself():
    buffer = BytesIO()
    pl.DataFrame({"A1": [1.0]}).write_parquet(buffer, metadata={"imu-session": json.dumps(SMALL)})
    refused(buffer.getvalue(), "table: is in the imu-session metadata")
