"""Schema version 2: how the objects of a run become JSON text and fixed-length records.

Stored JSON is standard JSON that round-trips every float: a number that is not finite becomes
`{"$number": "nan"}`, a complex number `{"$complex": [re, im]}`.
"""

from __future__ import annotations

import json
import math
import re
import zlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

import numpy as np

from contwalk.branch import BranchInfo, Outcome, SpecialPoint
from contwalk.errors import DatabaseError
from contwalk.storage.known_keys import Mark, Settings
from contwalk.storage.typed import check_known, typed

FORMAT = "contwalk"
PROBLEMS = ("equilibrium", "periodic_orbit", "hybrid_orbit", "locus")
SCHEMA_VERSION = 3
LABELS = re.compile("[A-Z]{2,8}|R[1-4]")
LABEL = 8  # bytes of a special point's label; those of schema version 1 are in `LABELS_BEFORE`
LABELS_BEFORE = (2,)

PIECE = 1024  # bytes of text in one row of a text log (outcome, notes)
TEXT_CHUNK = 8  # rows in one chunk of a text log
POINT_CHUNK = 64
SPECIAL_CHUNK = 8
TEXT_DTYPE = np.dtype([("text", f"S{PIECE}"), ("left", "<i4")])  # `left`: pieces still to come


@dataclass(frozen=True)
class Extent:
    """What belongs to a finished branch: how many records, and the CRC-32 of all their bytes in order."""

    rows: int
    special_points: int
    crc32: int

    @classmethod
    def of(cls, rows: np.ndarray, specials: np.ndarray) -> Extent:
        """The extent of these records of points and of special points, shapes (k,) and (j,)."""
        return cls(len(rows), len(specials), zlib.crc32(specials.tobytes(), zlib.crc32(rows.tobytes())))


def encode(value: Any, what: str) -> str:
    """JSON text of `value`; `what` names it in the error for things that JSON has no form for."""
    return json.dumps(_plain(value, what), ensure_ascii=False, allow_nan=False)


def decode(text: str) -> Any:
    """Inverse of `encode`; tuples come back as lists.

    Raises
    ------
    ValueError, TypeError
        If it is nothing that `encode` has written, such as a number of thousands of digits.
    """
    value = json.loads(
        text, object_hook=_restored, parse_int=_whole, parse_float=_finite, parse_constant=_finite
    )
    _check_plain(value)
    return value


def _plain(value: Any, what: str) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if value is None or isinstance(value, str | bool | int):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else {"$number": repr(value)}
    if isinstance(value, complex):
        return {"$complex": [_plain(value.real, what), _plain(value.imag, what)]}
    if isinstance(value, Mapping):
        return {_key(key, what): _plain(item, what) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item, what) for item in value]
    raise DatabaseError(
        f"{what[0].upper() + what[1:]} holds {value!r} of type {type(value).__name__}, "
        "which cannot be stored.",
        "Use numbers, text, true/false, null, lists and mappings of them.",
    )


def _key(key: Any, what: str) -> str:
    if isinstance(key, str):
        return key
    raise DatabaseError(f"{what[0].upper() + what[1:]} has the key {key!r}.", "Keys are text.")


def _whole(digits: str) -> int:
    number = int(digits) if len(digits) <= len(str(-(2**63))) else math.inf
    if abs(number) > 2**63:
        raise ValueError("it holds a whole number of more than 64 bits")
    return int(number)


def _finite(digits: str) -> float:
    number = float(digits)
    if not math.isfinite(number):
        raise ValueError(f"it holds {digits[:20]} as a number")
    return number


def _check_plain(value: Any, deeper: int = 20) -> None:
    """Refuse texts that are none, and what is nested deeper than anything that is stored."""
    if deeper < 0:
        raise ValueError("it is nested too deeply")
    if isinstance(value, str):
        value.encode()  # a lone surrogate has no bytes
    elif isinstance(value, dict):
        for name, each in value.items():
            name.encode()
            _check_plain(each, deeper - 1)
    elif isinstance(value, list):
        for each in value:
            if not isinstance(each, float):
                _check_plain(each, deeper - 1)


def _restored(item: dict[str, Any]) -> Any:
    if item.keys() == {"$number"}:
        return float(item["$number"])
    if item.keys() == {"$complex"}:
        return complex(*item["$complex"])
    return item


def info_text(info: BranchInfo) -> str:
    """JSON text of a `BranchInfo`."""
    return encode(asdict(info), f"branch {info.name}")


def info_from_text(text: str) -> BranchInfo:
    """Inverse of `info_text`."""
    info = typed(BranchInfo, _with_tuples(text, "states", "observables", "free", "signature", "parent"))
    check_known(Settings, info.settings)
    if not info.free or min(info.unknowns, info.spectrum) < 0 or info.problem not in PROBLEMS:
        raise ValueError(f"branch {info.name} is none")
    if info.subharmonic < 1 or info.settings.get("fold", 1) < 1 or not is_branch_name(info.name):
        raise ValueError(f"branch {info.name!r} is none")
    return info


def is_branch_name(name: str) -> bool:
    """Whether a branch may be named so: it is part of `branch/point`, and of names of files."""
    return bool(name) and name[0] != "." and not set(name) & set("/\\:") and name.isprintable()


def _with_tuples(text: str, *keys: str) -> dict[str, Any]:
    """A decoded record with tuples where JSON has lists."""
    stored: dict[str, Any] = decode(text)
    return {k: tuple(v) if k in keys and isinstance(v, list) else v for k, v in stored.items()}


def special_text(point: SpecialPoint) -> str:
    """JSON text of a special point, without `name` and `index`, which depend on the whole branch."""
    left_out = ["name", "index", *(name for name in ("errors", "mark") if not getattr(point, name))]
    names = [field.name for field in fields(point) if field.name not in left_out]
    return encode({name: getattr(point, name) for name in names}, f"a special point {point.label}")


def special_from_text(text: str) -> SpecialPoint:
    """Inverse of `special_text`."""
    point = typed(SpecialPoint, _with_tuples(text, "spectrum", "spectrum_full", "unknowns", "tangent"))
    check_known(Mark, point.mark)
    if not LABELS.fullmatch(point.label) or point.status not in ("located", "unlocated"):
        raise ValueError("a special point has no such label or status")
    if point.label == "EP" and point.kind is not None:
        return replace(point, kind=_reason_of(point.kind, point.note or ""))
    return point


# What `closed` stood for as well, before these ends had codes of their own: files of that time tell them by
# their sentences only.
_ONCE_CLOSED = {
    "The orbit shrinks onto an equilibrium": "shrunk",
    "The orbit has become its parent's": "rejoined",
}


def _reason_of(reason: str, sentence: str) -> str:
    """The reason code that a stored one is today."""
    if reason != "closed":
        return reason
    return next((code for words, code in _ONCE_CLOSED.items() if words in sentence), reason)


def note_from_text(text: str) -> tuple[str, str]:
    """Key and text of a note."""
    stored = decode(text)
    if not isinstance(stored, list) or [type(each) for each in stored] != [str, str]:
        raise TypeError("a note is none")
    return stored[0], stored[1]


def outcome_text(outcome: Outcome, cost: Mapping[str, float], extent: Extent | None = None) -> str:
    """JSON text of how a branch ended, what it cost, and what belongs to it."""
    ended = {"outcome": asdict(outcome), "cost": dict(cost)}
    return encode(ended if extent is None else {**ended, "extent": asdict(extent)}, "the outcome")


def extent_from_text(text: str | None) -> Extent | None:
    """What belongs to a finished branch; None where its outcome does not tell."""
    stored = decode(text) if text else None
    return typed(Extent, stored["extent"]) if stored and "extent" in stored else None


def outcome_from_text(text: str | None) -> tuple[Outcome, dict[str, float]] | None:
    """Inverse of `outcome_text`; None for a branch that is not finished (no text, or reopened)."""
    stored = decode(text) if text else None
    if not stored:
        return None
    outcome = typed(Outcome, stored["outcome"])
    if outcome.status not in ("complete", "stopped", "failed"):
        raise ValueError("an outcome has no such status")
    cost = {str(name): float(value) for name, value in stored["cost"].items()}
    if "rhs" in cost:
        cost["rhs"] = int(cost["rhs"])
    return replace(outcome, reason=_reason_of(outcome.reason, outcome.message)), cost


def point_dtype_before(info: BranchInfo) -> np.dtype:
    """`info.point_dtype()` until schema version 2, when stability was always told as known."""
    dtype = info.point_dtype()
    names = [name for name in dtype.names or () if name != "undecided"]
    return np.dtype([(name, "?" if name == "stable" else dtype[name]) for name in names])


def point_record_dtype(dtype: np.dtype) -> np.dtype:
    """Columns of points as stored: little-endian, without the empty columns that HDF5 cannot hold.

    Both are packed, so a row has the same bytes in either.
    """
    dtype = dtype.newbyteorder("<")
    names = [name for name in dtype.names or () if dtype[name].itemsize]
    return np.dtype([(name, dtype[name]) for name in names])


def special_record_dtype(info: BranchInfo, label: int = LABEL) -> np.dtype:
    """One special point as stored: a few numeric columns for other tools, and the whole as JSON text.

    `label` is how many bytes the label has room for.

    The length of the text allows 32 characters a number and twice the numbers that the branch announces,
    plus 8 KiB for coefficients, margins and the note.
    """
    names = (*info.parameters, *info.states, *info.observables, *info.free)
    numbers = len(names) + 2 * info.unknowns + 1 + 4 * max(info.spectrum, len(info.states))
    length = 8192 + 2 * (sum(len(name.encode()) + 4 for name in names) + 32 * numbers)
    return np.dtype(
        [
            ("label", f"S{label}"),
            ("status", "S9"),
            ("s", "<f8"),
            ("free", "<f8", (len(info.free),)),
            ("error", "<f8"),
            ("record", f"S{length}"),
        ]
    )


def special_record(info: BranchInfo, point: SpecialPoint, dtype: np.dtype) -> np.ndarray:
    """One row of `special_record_dtype(info)`, shape (1,).

    Raises
    ------
    DatabaseError
        If the text or the label does not fit: nothing is cut silently.
    """
    text = special_text(point).encode()
    length = dtype["record"].itemsize
    if len(point.label.encode()) > dtype["label"].itemsize:
        raise DatabaseError(
            f"The label {point.label!r} of a special point of branch {info.name} has more than "
            f"{dtype['label'].itemsize} bytes.",
            "Give the kind of point a shorter label.",
        )
    if len(text) > length:
        raise DatabaseError(
            f"A special point {point.label} of branch {info.name} needs {len(text)} bytes, more than the "
            f"{length} that its branch reserves.",
            "Shorten its note, coefficients or margins.",
        )
    free = [point.parameters.get(name, math.nan) for name in info.free]
    error = math.nan if point.error is None else point.error
    return np.array([(point.label.encode(), point.status.encode(), point.s, free, error, text)], dtype)


def pieces(text: str) -> np.ndarray:
    """Text of any length as rows of `TEXT_DTYPE`."""
    raw = text.encode()
    parts = [raw[start : start + PIECE] for start in range(0, len(raw), PIECE)]
    return np.array([(part, len(parts) - 1 - row) for row, part in enumerate(parts)], TEXT_DTYPE)


def joined(rows: np.ndarray) -> list[str]:
    """Texts of a text log, shape (k,), of `TEXT_DTYPE`; a last text that lacks its end is left out."""
    texts, text = [], b""
    for part, left in zip(rows["text"].tolist(), rows["left"].tolist(), strict=True):
        text += part
        if left == 0:
            texts.append(text.decode())
            text = b""
    return texts
