"""One branch in a file: a group with four record logs."""

from __future__ import annotations

from collections.abc import Mapping

import h5py
import numpy as np

from contwalk.branch import BranchInfo, Outcome, SpecialPoint
from contwalk.storage.hdf5_file import dataset_in, publish
from contwalk.storage.records import RecordLog, describe
from contwalk.storage.schema import (
    LABEL,
    LABELS_BEFORE,
    POINT_CHUNK,
    SPECIAL_CHUNK,
    TEXT_CHUNK,
    TEXT_DTYPE,
    Extent,
    extent_from_text,
    info_from_text,
    info_text,
    joined,
    outcome_from_text,
    outcome_text,
    pieces,
    point_dtype_before,
    point_record_dtype,
    special_from_text,
    special_record,
    special_record_dtype,
)

REOPENED = "null"  # the text in the log of outcomes that takes the one before it back


class StoredBranch:
    """A branch group and its logs `info`, `points`, `special_points` and `outcome`."""

    def __init__(self, group: h5py.Group, info: BranchInfo) -> None:
        self.info = info
        points = dataset_in(group, "points")
        earlier = "undecided" not in (points.dtype.names or ())
        dtype = point_dtype_before(info) if earlier else info.point_dtype()
        self._packed = dtype.newbyteorder("<")
        self.points = RecordLog(points, point_record_dtype(dtype))
        self.special_points = _special_points(dataset_in(group, "special_points"), info)
        self.outcomes = RecordLog(dataset_in(group, "outcome"), TEXT_DTYPE)
        texts = joined(self.outcomes.read())
        self._end = outcome_from_text(texts[-1] if texts else None)
        self._extent = extent_from_text(texts[-1] if texts else None)

    @classmethod
    def open(cls, group: h5py.Group) -> StoredBranch:
        """An existing branch."""
        (text,) = joined(RecordLog(dataset_in(group, "info"), TEXT_DTYPE).read())
        return cls(group, info_from_text(text))

    @classmethod
    def create(
        cls,
        file: h5py.File,
        order: int,
        info: BranchInfo,
        rows: np.ndarray | None = None,
        specials: np.ndarray | None = None,
        outcomes: np.ndarray | None = None,
    ) -> StoredBranch:
        """A new branch, empty or with the given records.

        Of points, special points (packed) and the outcome's text there are arrays of shape (k,) each.
        """
        text = info_text(info)
        # Nameless until it is whole and on disk: a kill meanwhile leaves no half branch behind.
        group = file.create_group(None)
        describe(
            group,
            problem=info.problem,
            free=", ".join(info.free),
            states=", ".join(info.states),
            observables=", ".join(info.observables),
        )
        for name, records, chunk in (
            ("info", pieces(text), TEXT_CHUNK),
            ("points", _packed(info, np.empty(0, info.point_dtype()) if rows is None else rows), POINT_CHUNK),
            (
                "special_points",
                np.empty(0, special_record_dtype(info)) if specials is None else specials,
                SPECIAL_CHUNK,
            ),
            ("outcome", np.empty(0, TEXT_DTYPE) if outcomes is None else outcomes, TEXT_CHUNK),
        ):
            RecordLog.create(group, name, records, chunk)
        file.flush()
        publish(file, order, info.name, group)
        return cls(group, info_from_text(text))

    @staticmethod
    def room(info: BranchInfo) -> int:
        """Bytes that a new branch takes, and more."""
        return 2 * len(info_text(info)) + (1 << 15)

    def copy_to(self, file: h5py.File, order: int, rows: int | None, specials: list[int] | None) -> None:
        """Write the branch into another file, with its first `rows` and some `specials` (all for None)."""
        stored, special_points = self._read()
        special_points = special_points.astype(special_record_dtype(self.info), copy=False)
        kept, special_points = (
            self._of_today(stored)[:rows],
            special_points if specials is None else special_points[specials],
        )
        ended = None
        if self._end is not None:
            ended = pieces(outcome_text(*self._end, Extent.of(_packed(self.info, kept), special_points)))
        StoredBranch.create(file, order, self.info, kept, special_points, ended)

    def _read(self) -> tuple[np.ndarray, np.ndarray]:
        """Points and special points; of a finished branch exactly those that belong to it."""
        extent = self._extent
        if self._end is None or extent is None:
            return self.points.read(), self.special_points.read()
        found = self.points.read(extent.rows), self.special_points.read(extent.special_points)
        if Extent.of(*found) != extent:
            raise ValueError(f"the rows of branch {self.info.name} are not those that it was finished with")
        return found

    def append_row(self, row: np.ndarray) -> None:
        """Append one row of dtype `info.point_dtype()`, shape (1,)."""
        self.points.append(row.astype(self._packed, copy=False).view(self.points.dtype))

    def special_record(self, point: SpecialPoint) -> np.ndarray:
        """The record of a special point, shape (1,), checked to fit."""
        return special_record(self.info, point, self.special_points.dtype)

    def rows(self) -> np.ndarray:
        """Whole points in the order of appending, shape (k,), of dtype `info.point_dtype()`."""
        return self._of_today(self._read()[0])

    def _of_today(self, records: np.ndarray) -> np.ndarray:
        """Records of points, shape (k,), with the columns of `info.point_dtype()`."""
        stored, dtype = records.view(self._packed), self.info.point_dtype()
        if self._packed.names == dtype.names:
            return stored.astype(dtype)
        rows = np.zeros(len(stored), dtype)
        for name in stored.dtype.names or ():
            rows[name] = stored[name]
        return rows

    def specials(self) -> list[SpecialPoint]:
        """Whole special points in the order of appending."""
        return [special_from_text(text.decode()) for text in self._read()[1]["record"].tolist()]

    def end(self) -> tuple[Outcome, dict[str, float]] | None:
        """Outcome and cost; None while the branch is not finished."""
        return self._end

    def write_end(self, outcome: Outcome, cost: Mapping[str, float]) -> None:
        """Finish the branch."""
        extent = Extent.of(self.points.read(), self.special_points.read())
        text = outcome_text(outcome, cost, extent)
        self.outcomes.append(pieces(text))
        self._end, self._extent = outcome_from_text(text), extent

    def reopen(self) -> None:
        """Take the outcome back."""
        self.outcomes.append(pieces(REOPENED))
        self._end = self._extent = None


def _packed(info: BranchInfo, rows: np.ndarray) -> np.ndarray:
    """Rows of dtype `info.point_dtype()`, shape (k,), as they are stored."""
    stored = point_record_dtype(info.point_dtype())
    return rows.astype(info.point_dtype().newbyteorder("<"), copy=False).view(stored)


def _special_points(dataset: h5py.Dataset, info: BranchInfo) -> RecordLog:
    """The log of special points; in files of earlier schemas its labels have less room."""
    names = dataset.dtype.names or ()
    stored = dataset.dtype["label"].itemsize if "label" in names else LABEL
    label = stored if stored in LABELS_BEFORE else LABEL
    return RecordLog(dataset, special_record_dtype(info, label))
