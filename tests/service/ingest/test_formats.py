"""The same content in any accepted format is the same session; damaged content is refused, never a crash."""

import json
from io import BytesIO

import polars as pl
import pytest

from estimator.errors import FormatError, SessionError
from estimator.reading import read_session
from service.ingest import read_upload
from tests import builders
from tests.estimator.test_reading_csv import csv_of, same


def metadata(document):
    return json.dumps({key: value for key, value in document.items() if key != "table"})


def json_bytes(document):
    return json.dumps(document).encode()


def parquet_bytes(document):
    buffer = BytesIO()
    pl.DataFrame(document["table"]).write_parquet(buffer, metadata={"imu-session": metadata(document)})
    return buffer.getvalue()


WRITERS = {"json": json_bytes, "csv": csv_of, "parquet": parquet_bytes}
BUILDERS = (
    builders.accelerometer_block,
    builders.gyro_block,
    builders.mixed_block,
    builders.arbitrary_orientations,
    builders.raw_log,
)


@pytest.mark.parametrize("build", BUILDERS)
@pytest.mark.parametrize("kind", WRITERS)
def test_every_format_gives_the_same_session(kind, build):
    document = build()
    assert same(read_upload(WRITERS[kind](document), f"x.{kind}"), read_session(document))


@pytest.mark.parametrize("kind", WRITERS)
def test_empty_cells_survive_every_format(kind):
    document = builders.arbitrary_orientations()
    document["table"]["A1_se"][3] = None
    document["table"]["position"] = ["p1", *["p2"] * 22, None]
    assert same(read_upload(WRITERS[kind](document), "x"), read_session(document))


@pytest.mark.parametrize("kind", WRITERS)
def test_a_fault_has_its_row_in_every_format(kind):
    document = builders.accelerometer_block()
    document["table"]["A3_se"][6] = -1.0
    with pytest.raises(FormatError, match=f"tuesday.{kind}: A3_se, row 7: is -1") as caught:
        read_upload(WRITERS[kind](document), f"tuesday.{kind}")
    assert len(caught.value.problems) == 1


@pytest.mark.parametrize("kind", WRITERS)
def test_a_file_cut_short_is_refused(kind):
    content = WRITERS[kind](builders.accelerometer_block())
    for size in (4, 8, 200, len(content) // 2, len(content) - 9):
        with pytest.raises(SessionError):
            read_upload(content[:size], "x")
