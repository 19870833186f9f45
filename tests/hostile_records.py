"""Databases whose records are whole by their checksums and say what no run would."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from contwalk.storage.records import RecordLog
from contwalk.storage.schema import SPECIAL_CHUNK, TEXT_CHUNK, TEXT_DTYPE, joined, pieces

# JSON texts of values: of other types, not to be computed with, too large, too deep, no texts, and acting.
HOSTILE = (
    "null",
    "true",
    "-1",
    "0",
    "1e999",
    "NaN",
    "9" * 4000,
    "9" * 5000,
    '""',
    '"\\ud800"',
    '"../x"',
    '"\\u001b[31m"',
    '"a/b"',
    "[]",
    "{}",
    "[[1.0]]",
    '{"a": 1}',
    "[" * 900 + "]" * 900,
    "[" * 90_000,
    '{"$number": "x"}',
    '{"$complex": [1, 2, 3]}',
    '["x", "y", "z"]',
)


class Texts:
    """The JSON texts of a file: header, notes, and each branch's `info`, `outcome` and special points."""

    def __init__(self, file: h5py.File) -> None:
        self._file = file
        self.logs = ["header", "notes"]
        self.logs += [f"branches/{name}/{log}" for name in file["branches"] for log in ("info", "outcome")]
        self.specials = [
            (f"branches/{name}/special_points", row)
            for name in file["branches"]
            for row in range(len(file[f"branches/{name}/special_points"]))
        ]

    def read(self, place: str | tuple[str, int]) -> list[str]:
        """The texts of a log, or the one of a special point."""
        if isinstance(place, str):
            return joined(RecordLog(self._file[place], TEXT_DTYPE).read())
        records = self._specials(place[0])
        return [records["record"][place[1]].decode()]

    def write(self, place: str | tuple[str, int], texts: list[str]) -> bool:
        """Put others in their place; whether they have room."""
        if isinstance(place, str):
            records, chunk, name = np.concatenate([pieces(text) for text in texts]), TEXT_CHUNK, place
        else:
            name, row = place
            records, chunk = self._specials(name).copy(), SPECIAL_CHUNK
            if len(texts[0].encode()) > records.dtype["record"].itemsize:
                return False
            records["record"][row] = texts[0].encode()
            self._without_extent(name.removesuffix("special_points") + "outcome")
        del self._file[name]
        group, _, own = name.rpartition("/")
        RecordLog.create(self._file[group or "/"], own, records, chunk)
        return True

    def _specials(self, name: str) -> np.ndarray:
        stored = self._file[name].dtype
        names = [each for each in stored.names if each != "crc32"]
        return RecordLog(self._file[name], np.dtype([(each, stored[each]) for each in names])).read()

    def _without_extent(self, name: str) -> None:
        texts = self.read(name)
        if texts and "extent" in texts[-1]:
            ended = json.loads(texts[-1])
            del ended["extent"]
            self.write(name, [json.dumps(ended)])


def paths_of(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Where values stand in a value; of a list its first one."""
    yield path
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from paths_of(inner, (*path, key))
    elif isinstance(value, list) and value:
        yield from paths_of(value[0], (*path, 0))


def with_text(value: Any, path: tuple[Any, ...], text: str) -> str:
    """JSON of a value in which another one stands at a place, as text."""
    if not path:
        return text
    mark = "\x00here\x00"
    return json.dumps(_with(value, path, mark)).replace(json.dumps(mark), text, 1)


def _with(value: Any, path: tuple[Any, ...], inner: Any) -> Any:
    if not path:
        return inner
    copy = value.copy()
    copy[path[0]] = _with(value[path[0]], path[1:], inner)
    return copy


def changed(source: Path, target: Path, seed: int) -> str:
    """Write a copy in which one value is hostile; what was changed, in words."""
    random_ = random.Random(seed)
    target.write_bytes(source.read_bytes())
    with h5py.File(target, "r+") as file:
        texts = Texts(file)
        kinds = [
            ["header"],
            *([log for log in texts.logs if log.endswith(end)] for end in ("info", "outcome")),
        ]
        kinds += [texts.specials, ["notes"]]
        place = random_.choice(random_.choice([kind for kind in kinds if kind]))
        told = texts.read(place)
        if not told:
            return "nothing"
        value = json.loads(told[-1])
        path = random_.choice(list(paths_of(value)))
        text = random_.choice(HOSTILE)
        told[-1] = with_text(value, path, text)
        done = texts.write(place, told)
    return f"{place} {path} = {text[:40]}" if done else "nothing"


# Datasets that stand where another one should.
ARRAYS = (
    np.zeros(0),
    np.full(2, np.nan),
    np.full(2, np.inf),
    np.full(2, 1e308),
    np.full(2, 2**63 - 1),
    np.full(2, -1),
    np.zeros((2, 2, 2)),
    np.float64(1.0),
    np.zeros(2, dtype=complex),
    np.zeros(2, dtype=[("a", float)]),
    np.array([b"x", b"../x"]),
)
TEXTS = ("", "../x", "\x1b[31m", "x" * 70_000, "=1+1", "{}", "[" * 90_000, "9" * 5000, '{"a": 1e999}')
PACKED = 1 << 27  # numbers that take a few bytes in a file


def changed_plain(source: Path, target: Path, seed: int) -> str:
    """As `changed`, of a file of margins or of a trajectory: arrays and texts without checksums."""
    random_ = random.Random(seed)
    target.write_bytes(source.read_bytes())
    with h5py.File(target, "r+") as file:
        places: list[str] = []
        file.visit(places.append)
        how = random_.choice((_header, _attribute, _array, _text, _packed, _elsewhere, _missing, _group))
        return how(file, random_, random_.choice(places))


def _header(file: h5py.File, random_: random.Random, _: str) -> str:
    name = random_.choice([each for each in ("header", "parameters") if each in file.attrs])
    value, text = json.loads(file.attrs[name]), random_.choice(HOSTILE)
    path = random_.choice(list(paths_of(value)))
    told = with_text(value, path, text)
    del file.attrs[name]
    if len(told) < 60_000:  # what HDF5 keeps in an attribute
        file.attrs[name] = told
    return f"{name} {path} = {text[:40]}"


def _attribute(file: h5py.File, random_: random.Random, _: str) -> str:
    name = random_.choice(list(file.attrs))
    value = random_.choice([*TEXTS[:3], *ARRAYS[:6], 2**62, -1, h5py.Empty("f8")])
    file.attrs[name] = value
    return f"attribute {name} = {value!r}"


def _put(file: h5py.File, place: str, value: Any, **options: Any) -> str:
    del file[place]
    file.create_dataset(place, data=value, **options)
    return f"{place} = {value!r}"[:80]


def _array(file: h5py.File, random_: random.Random, place: str) -> str:
    return _put(file, place, random_.choice(ARRAYS))


def _text(file: h5py.File, random_: random.Random, place: str) -> str:
    count = len(file[place]) if isinstance(file[place], h5py.Dataset) and file[place].shape else 1
    return _put(file, place, [random_.choice(TEXTS)] * count, dtype=h5py.string_dtype())


def _packed(file: h5py.File, _: random.Random, place: str) -> str:
    del file[place]
    file.create_dataset(place, shape=(PACKED,), dtype="f8", chunks=(1 << 20,), compression="gzip")
    return f"{place} packed"


def _elsewhere(file: h5py.File, random_: random.Random, place: str) -> str:
    del file[place]
    file[place] = random_.choice(
        [h5py.SoftLink("/"), h5py.SoftLink("/nowhere"), h5py.ExternalLink("/etc/passwd", "/"), file["/"]]
    )
    return f"{place} is a link"


def _missing(file: h5py.File, _: random.Random, place: str) -> str:
    del file[place]
    return f"{place} is missing"


def _group(file: h5py.File, _: random.Random, place: str) -> str:
    del file[place]
    file.create_group(place)
    return f"{place} is a group"
