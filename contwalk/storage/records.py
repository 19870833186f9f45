"""A log of fixed-length records in HDF5 that survives `kill -9`.

A resizable compound dataset. Its last column is the CRC-32 of the bytes before it, so that a record that was
not written to its end is recognised, whatever it holds: the fill value, a hole of zeros, or half of itself.

For each append HDF5 writes the record, then the new length and, last, how far the file reaches. A kill
between these is harmless. But where the index of chunks outgrows its first node, HDF5 moves entries between
nodes in several writes, and a kill between those loses rows in the middle. So a chunk holds many rows, and
a log that is `full` is to be copied, into one with larger chunks, before it grows on.
"""

from __future__ import annotations

import zlib

import h5py
import numpy as np

CRC = "crc32"
LARGEST_ROW = 1 << 24  # bytes, in a file that has no whole row yet
INDEX_ENTRIES = 64  # of one node of the chunk index: 2 K with the default K = 32 of an HDF5 file


def _stored(dtype: np.dtype) -> np.dtype:
    """The dtype with its checksum; text is marked as UTF-8, which changes no byte."""
    columns = []
    for name in dtype.names or ():
        column = dtype[name]
        columns.append((name, h5py.string_dtype("utf-8", column.itemsize) if column.kind == "S" else column))
    return np.dtype([*columns, (CRC, "<u4")])


def _sealed(records: np.ndarray, stored: np.dtype) -> np.ndarray:
    """Records with their checksums, as they are stored."""
    size = records.dtype.itemsize
    raw = records.tobytes()
    parts = []
    for start in range(0, len(raw), size):
        part = raw[start : start + size]
        parts += [part, zlib.crc32(part).to_bytes(4, "little")]
    return np.frombuffer(b"".join(parts), stored)


def describe(target: h5py.Group, **attributes: str) -> None:
    """Texts as attributes, for the reader of an HDF5 browser.

    Of fixed length: HDF5 keeps others in a heap, and can search a damaged heap for ever.
    """
    for name, text in attributes.items():
        raw = text.encode()
        target.attrs.create(name, raw, dtype=h5py.string_dtype("utf-8", max(1, len(raw))))


def check_layout(dataset: h5py.Dataset) -> None:
    """Refuse a dataset that is not in the file as it stands, or is larger than what the file can hold.

    Raises
    ------
    ValueError
    """
    plain = dataset.id.get_create_plist().get_nfilters() == 0 and not dataset.is_virtual
    if not plain or dataset.external:
        raise ValueError(f"{dataset.name} is not stored plainly")
    # The last row may be announced before its chunk is there.
    size, row = dataset.file.id.get_filesize(), dataset.dtype.itemsize
    if dataset.nbytes - row > size or row > max(size, LARGEST_ROW):
        raise ValueError(f"{dataset.name} announces more than the file holds")


class RecordLog:
    """An append-only dataset of records.

    Parameters
    ----------
    dataset : h5py.Dataset
    dtype : numpy.dtype
        Packed dtype of one record without its checksum.
    """

    def __init__(self, dataset: h5py.Dataset, dtype: np.dtype) -> None:
        self.dataset = dataset
        self.dtype = dtype
        self._stored = _stored(dtype)
        # The file's own type in memory as well spares HDF5 a conversion, most of the time of an append.
        self._type = dataset.id.get_type()
        self._one = h5py.h5s.create_simple((1,))
        self._chunk = int(dataset.chunks[0])
        self._capacity = INDEX_ENTRIES * self._chunk
        # Kept here, not read from the dataset: after a Ctrl-C between growing and writing, the dataset has a
        # row that was never written, and the next append must fill it.
        self.count = int(dataset.shape[0])

    @classmethod
    def create(cls, group: h5py.Group, name: str, records: np.ndarray, chunk: int) -> RecordLog:
        """Create the dataset `name` with `records`, a packed structured array, perhaps of length 0.

        A chunk holds `chunk` rows, or more where the log is long already.
        """
        chunk = max(chunk, 2 * len(records) // INDEX_ENTRIES + 1)
        stored = _stored(records.dtype)
        dataset = group.create_dataset(name, (len(records),), stored, maxshape=(None,), chunks=(chunk,))
        if len(records):
            dataset[...] = _sealed(records, stored)
        return cls(dataset, records.dtype)

    def full(self, more: int) -> bool:
        """Whether `more` records would outgrow the first node of the chunk index."""
        return self.count + more > self._capacity

    def room(self, more: int) -> int:
        """Bytes by which the file may grow where `more` records are appended: chunks are written whole."""
        chunk = self._chunk
        chunks = -(-(self.count + more) // chunk) - -(-self.count // chunk)
        return (max(chunks * chunk, more)) * self._stored.itemsize

    def append(self, records: np.ndarray) -> None:
        """Append records, shape (k,), one by one.

        Each is on disk before the next, so that one at most can be torn.
        """
        sealed = _sealed(records, self._stored)
        for row in range(len(sealed)):
            self.dataset.id.set_extent((self.count + 1,))
            self._write(sealed[row : row + 1])
            h5py.h5f.flush(self.dataset.id)
            self.count += 1

    def _write(self, sealed: np.ndarray) -> None:
        space = self.dataset.id.get_space()
        space.select_hyperslab((self.count,), (1,))
        self.dataset.id.write(self._one, space, sealed, self._type)

    def read(self, count: int | None = None) -> np.ndarray:
        """All whole records, shape (k,), of `dtype`; a torn one at the end is left out.

        Parameters
        ----------
        count : int, optional
            How many there are, where that is known: then all of them must be whole, and no others.

        Raises
        ------
        ValueError
            If records are missing other than the very last: the file is damaged.
        """
        raw = self._raw_rows()
        size = self.dtype.itemsize
        whole = [
            len(row) == size + 4 and zlib.crc32(row[:size]) == int.from_bytes(row[size:], "little")
            for row in raw
        ]
        torn = bool(whole) and not whole[-1]
        kept = raw[: len(raw) - torn]
        if not all(whole[: len(kept)]):
            raise ValueError(
                f"row {whole.index(False)} of {len(whole)} of {self.dataset.name} fails its checksum"
            )
        if count is not None and len(kept) != count:
            raise ValueError(f"{self.dataset.name} has {len(kept)} of its {count} rows")
        return np.frombuffer(b"".join(row[:size] for row in kept), self.dtype)

    def _raw_rows(self) -> list[bytes]:
        """The bytes of each row; empty for one that HDF5 cannot read."""
        size = self.dtype.itemsize + 4
        check_layout(self.dataset)
        if self.dataset.dtype != self._stored or self.dataset.ndim != 1:
            raise ValueError(f"the columns of {self.dataset.name} are not those that its branch announces")
        try:
            raw = self.dataset[()].tobytes()
        except OSError:
            return [self._raw_row(row) for row in range(len(self.dataset))]
        return [raw[start : start + size] for start in range(0, len(raw), size)]

    def _raw_row(self, row: int) -> bytes:
        try:
            return bytes(self.dataset[row : row + 1].tobytes())
        except OSError:
            return b""
