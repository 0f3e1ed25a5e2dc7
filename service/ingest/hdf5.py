"""HDF5: group `readings` with one dataset a column; the metadata as JSON in the root's text attribute `imu-session`.

Only plain datasets inside the file are followed: links to other files, and data kept in them, are refused.
"""

from io import BytesIO

import h5py
import numpy as np

from estimator.errors import FormatError
from service.ingest.limits import MOST_TEXT, check_cells, refusal
from service.ingest.metadata import KEY, with_metadata

MAGIC = b"\x89HDF\r\n\x1a\n"
GROUP = "readings"
MOST_LABELS = 200_000
DAMAGED = (OSError, RuntimeError, ValueError, TypeError, LookupError, ArithmeticError)
PLAIN = "must be a one-dimensional dataset of numbers or text inside the file"


def read_hdf5(content: bytes, filename: str) -> dict[str, object]:
    """The document that an HDF5 file holds."""
    try:
        with h5py.File(BytesIO(content), "r") as file:
            metadata = file.attrs.get(KEY)
            columns = _columns(file, filename)
    except FormatError:
        raise
    except DAMAGED as error:
        raise refusal(filename, "is damaged or not a readable HDF5 file; write it again") from error
    if not isinstance(metadata, str):
        raise refusal(filename, f"has no text attribute {KEY}; put the session's JSON without its table there")
    return with_metadata(metadata, columns, filename)


def _columns(file: h5py.File, filename: str) -> dict[str, object]:
    if not isinstance(file.get(GROUP, getlink=True), h5py.HardLink) or not isinstance(file[GROUP], h5py.Group):
        raise refusal(filename, f"has no group {GROUP}; put one dataset per column there")
    group = file[GROUP]
    check_cells(filename, 1, len(group))
    datasets = {name: _dataset(group, name, filename) for name in group}
    check_cells(filename, max((dataset.size for dataset in datasets.values()), default=0), len(datasets))
    return {name: _cells(dataset, name, filename) for name, dataset in datasets.items()}


def _dataset(group: h5py.Group, name: str, filename: str) -> h5py.Dataset:
    if not isinstance(group.get(name, getlink=True), h5py.HardLink):
        raise refusal(filename, f"is a link; {PLAIN}", name)
    item = group[name]
    if not isinstance(item, h5py.Dataset) or item.ndim != 1 or item.is_virtual or item.external:
        raise refusal(filename, f"is not a plain column; {PLAIN}", name)
    return item


def _cells(dataset: h5py.Dataset, name: str, filename: str) -> object:
    if dataset.dtype.kind in "fiu":
        return np.asarray(dataset[()])
    if h5py.check_string_dtype(dataset.dtype) is None:
        raise refusal(filename, f"is of type {dataset.dtype}; {PLAIN}", name)
    if dataset.size > MOST_LABELS:
        raise refusal(filename, f"has {dataset.size} texts; at most {MOST_LABELS}, so use whole numbers", name)
    return _texts(dataset, name, filename)


def _texts(dataset: h5py.Dataset, name: str, filename: str) -> list[str | None]:
    """One by one: rows may all share one long text, which would fill the memory."""
    texts, total = [], 0
    for row in range(dataset.size):
        text = dataset[row].decode("utf-8")
        total += len(text)
        if total > MOST_TEXT:
            raise refusal(filename, "holds far too much text; labels should be short", name)
        texts.append(text or None)
    return texts
