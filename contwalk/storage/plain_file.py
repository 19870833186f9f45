"""A file of arrays and texts, each checked before it is read.

HDF5 lets a file name other files, unfold what is packed, and tell one text a thousand times: nothing is read
from elsewhere, and nothing that is much larger in memory than in the file.
"""

from __future__ import annotations

from typing import Any

import h5py
import numpy as np

from contwalk.storage.records import check_layout
from contwalk.storage.schema import decode
from contwalk.storage.snapshot import LARGEST
from contwalk.storage.typed import check_known


class PlainFile:
    """An open file, looked at.

    Lengths have names, such as `k n` for a table of k rows: what has the same name has the same length
    everywhere.

    Every method raises `ValueError`, `TypeError` or `KeyError` for what is not as it is asked for.
    """

    def __init__(self, file: h5py.File) -> None:
        self._file = file
        self._lengths: dict[str, int] = {}

    def __contains__(self, name: str) -> bool:
        """Whether there is a dataset or a group of this name, in this file itself."""
        parts = name.split("/")
        places = ["/".join(parts[:count]) for count in range(1, len(parts) + 1)]
        return all(isinstance(self._file.get(place, getlink=True), h5py.HardLink) for place in places)

    def array(self, name: str, lengths: str, kinds: str = "f") -> np.ndarray:
        """A dataset of numbers whose NumPy kind is one of `kinds`, such as `biuf`.

        `k n` gives an array of shape (k, n).
        """
        found: np.ndarray = self._dataset(name, lengths, kinds)[()]
        return found

    def texts(self, name: str, lengths: str) -> list[str]:
        """A dataset of texts, of any length each."""
        dataset = self._dataset(name, lengths, "OS")
        if h5py.check_string_dtype(dataset.dtype) is None:
            raise TypeError(f"{name} holds no texts")
        most, left, found = self._at_once(), self._file.id.get_filesize(), []
        for first in range(0, len(dataset), most):
            part = dataset.asstr()[first : first + most].tolist()
            left -= sum(map(len, part))
            if left < 0:
                raise ValueError(f"{name} tells more than the file holds")
            found += part
        return found

    def names(self, name: str, attribute: str, length: str) -> tuple[str, ...]:
        """Texts that are an attribute of a dataset."""
        kept = self._at(name).attrs.get_id(attribute)
        self._check_lengths(f"{name}, {attribute}", kept.shape, length)
        if h5py.check_string_dtype(kept.dtype) is None:
            raise TypeError(f"the attribute {attribute} of {name} holds no texts")
        if kept.shape[0] > self._at_once():
            raise ValueError(f"the attribute {attribute} of {name} tells more than the file holds")
        return tuple(_plain(text) for text in self._at(name).attrs[attribute])

    def text(self, attribute: str, name: str = "/") -> str:
        """A text that is an attribute of the file, or of a dataset."""
        kept = self._at(name).attrs.get_id(attribute)
        if kept.shape != () or h5py.check_string_dtype(kept.dtype) is None:
            raise TypeError(f"the attribute {attribute} of {name} is no text")
        return _plain(self._at(name).attrs[attribute])

    def mapping(self, attribute: str, kind: type) -> dict[str, Any]:
        """JSON that is an attribute of the file, with the keys that `kind` declares."""
        stored = decode(self.text(attribute))
        check_known(kind, stored)
        return dict(stored)

    def _at(self, name: str) -> Any:
        if name == "/":
            return self._file
        if name not in self:
            raise KeyError(f"it has no {name} of its own")
        return self._file[name]

    def _dataset(self, name: str, lengths: str, kinds: str) -> h5py.Dataset:
        dataset = self._at(name)
        if not isinstance(dataset, h5py.Dataset):
            raise TypeError(f"{name} is no dataset")
        check_layout(dataset)
        self._check_lengths(name, dataset.shape, lengths)
        if dataset.size and dataset.dtype.kind not in kinds:
            raise TypeError(f"{name} is of another type")
        return dataset

    def _check_lengths(self, name: str, shape: tuple[int, ...] | None, lengths: str) -> None:
        known = lengths.split()
        if shape is None or len(shape) != len(known):
            raise ValueError(f"{name} has other dimensions")
        for length, size in zip(known, shape, strict=True):
            if self._lengths.setdefault(length, size) != size:
                raise ValueError(f"{name} is of another length")

    def _at_once(self) -> int:
        """How many texts may be read at once: each may be the same one, which is all of the file."""
        return max(1, LARGEST // self._file.id.get_filesize())


def _plain(text: Any) -> str:
    decoded = text.decode() if isinstance(text, bytes) else str(text)
    decoded.encode()  # a lone surrogate has no bytes
    return decoded
