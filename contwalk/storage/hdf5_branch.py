"""One branch in a file: a group with four record logs."""

from __future__ import annotations

from collections.abc import Mapping

import h5py
import numpy as np

from contwalk.branch import BranchInfo, Outcome, SpecialPoint
from contwalk.storage.hdf5_file import publish
from contwalk.storage.records import RecordLog, describe
from contwalk.storage.schema import (
    POINT_CHUNK,
    SPECIAL_CHUNK,
    TEXT_CHUNK,
    TEXT_DTYPE,
    info_from_text,
    info_text,
    joined,
    outcome_from_text,
    outcome_text,
    pieces,
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
        self.points = RecordLog(group["points"], point_record_dtype(info))
        self.special_points = RecordLog(group["special_points"], special_record_dtype(info))
        self.outcomes = RecordLog(group["outcome"], TEXT_DTYPE)
        texts = joined(self.outcomes.read())
        self._end = outcome_from_text(texts[-1] if texts else None)

    @classmethod
    def open(cls, group: h5py.Group) -> StoredBranch:
        """An existing branch."""
        (text,) = joined(RecordLog(group["info"], TEXT_DTYPE).read())
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
        """A new branch, empty or with the given records."""
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
            ("points", np.empty(0, point_record_dtype(info)) if rows is None else rows, POINT_CHUNK),
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

    def copy_to(self, file: h5py.File, order: int, rows: int | None, specials: int | None) -> None:
        """Write the branch into another file, with its first `rows` and `specials` (all for None)."""
        StoredBranch.create(
            file,
            order,
            self.info,
            self.points.read()[:rows],
            self.special_points.read()[:specials],
            self.outcomes.read(),
        )

    def append_row(self, row: np.ndarray) -> None:
        """Append one row of dtype `info.point_dtype()`."""
        packed = row.astype(self.info.point_dtype().newbyteorder("<"), copy=False)
        self.points.append(packed.view(self.points.dtype))

    def special_record(self, point: SpecialPoint) -> np.ndarray:
        """The record of a special point, checked to fit."""
        return special_record(self.info, point, self.special_points.dtype)

    def rows(self) -> np.ndarray:
        """Whole points in the order of appending."""
        dtype = self.info.point_dtype()
        return self.points.read().view(dtype.newbyteorder("<")).astype(dtype)

    def specials(self) -> list[SpecialPoint]:
        """Whole special points in the order of appending."""
        return [special_from_text(text.decode()) for text in self.special_points.read()["record"].tolist()]

    def end(self) -> tuple[Outcome, dict[str, float]] | None:
        """Outcome and cost; None while the branch is not finished."""
        return self._end

    def write_end(self, outcome: Outcome, cost: Mapping[str, float]) -> None:
        """Finish the branch."""
        text = outcome_text(outcome, cost)
        self.outcomes.append(pieces(text))
        self._end = outcome_from_text(text)

    def reopen(self) -> None:
        """Take the outcome back."""
        self.outcomes.append(pieces(REOPENED))
        self._end = None
