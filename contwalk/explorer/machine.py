"""The machine of a branch in motion: what its plugin draws at some instants of each orbit, in little room.

An outline that only moves and turns is written once for the branch, and each instant has four numbers of it.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

import numpy as np

from contwalk.explorer.packing import predicted, varints
from contwalk.plotting.drawn_elements import TEXT, Element

# Parts of a picture's width, and of a turn's cosine, that a number tells.
SCALE = {"view": 2048, "turn": 4096, "outline": 16}
# So many outlines an element has before its points are written one by one.
MOST = {"outlines": 12}
# What an element is, its look, its text, its number of points, and the how many-th of its like it is.
Kind = tuple[str, int, str, int, int]


@dataclass
class Track:
    """One element while it is there: the number of its key, the first instant, numbers of shape (k, c)."""

    key: int
    first: int
    values: np.ndarray

    @property
    def form(self) -> tuple[int, int]:
        """What it has to share with the track of the orbit before, to be foretold by it."""
        return self.first, self.values.shape[1]


@dataclass
class MachineOfBranch:
    """What is drawn of the orbits of a branch, collected one after the other.

    Outlines are whole numbers, shape (2 k,): x and y of k points in turn; `shapes` the same as complex
    numbers, shape (k,).
    """

    looks: dict[str, int] = field(default_factory=dict)
    keys: dict[Kind, list[int]] = field(default_factory=dict)
    shapes: list[np.ndarray | None] = field(default_factory=list)
    described: list[list[Any]] = field(default_factory=list)
    outlines: list[np.ndarray] = field(default_factory=list)
    tracks: list[list[list[int]]] = field(default_factory=list)
    heights: list[int] = field(default_factory=list)
    body: bytearray = field(default_factory=bytearray)
    _before: dict[int, Track] = field(default_factory=dict)

    def add(self, frames: Sequence[tuple[list[Element], np.ndarray | None]]) -> None:
        """The instants of one orbit: elements, and limits (left, right, low, high), shape (4,), or None."""
        common = None if all(limits is not None for _, limits in frames) else _around(frames)
        height, places = 0, []
        for elements, limits in frames:
            view = limits if common is None or limits is None else common
            view = common if view is None else view
            assert view is not None
            height = max(height, round(SCALE["view"] * abs((view[3] - view[2]) / (view[1] - view[0]))))
            places.append(self._placed(elements, view, height))
        tracks = self._tracks(places)
        self.heights.append(height)
        self.tracks.append([[track.key, *track.form, len(track.values)] for track in tracks])
        for track in tracks:
            before = self._before.get(track.key)
            alike = before is not None and before.form == track.form
            self.body += varints(predicted(track.values, before.values if alike and before else None))
        self._before = {track.key: track for track in reversed(tracks)}

    def header(self) -> dict[str, Any]:
        """What a page needs beside the numbers."""
        return {
            "scale": SCALE,
            "looks": [json.loads(look) for look in self.looks],
            "keys": self.described,
            "outlines": [outline.tolist() for outline in self.outlines],
            "tracks": self.tracks,
            "heights": self.heights,
        }

    def _placed(self, elements: list[Element], view: np.ndarray, height: int) -> dict[int, np.ndarray]:
        """Numbers of each element of an instant, by its key."""
        left, right, _, high = view
        unit = SCALE["view"] / (right - left)
        counted: dict[Kind, int] = {}
        found = {}
        for element in elements:
            x, y = element.points.T
            if element.fixed:
                at = SCALE["view"] * x + 1j * height * (1.0 - y)
            else:
                at = unit * ((x - left) + 1j * (high - y))
            at = np.where(np.isfinite(at), at, 0.0)
            look = self.looks.setdefault(json.dumps(dict(element.look), sort_keys=True), len(self.looks))
            plain: Kind = (element.kind, look, element.text, len(at), 0)
            counted[plain] = counted.get(plain, 0) + 1
            key, numbers = self._numbers((*plain[:4], counted[plain]), at)
            if element.kind == TEXT:
                numbers = np.append(numbers, np.array(element.offset) * SCALE["outline"])
            found[key] = np.round(numbers).astype(np.int64)
        return found

    def _numbers(self, kind: Kind, at: np.ndarray) -> tuple[int, np.ndarray]:
        """The number of a key, and four numbers of an outline that has moved and turned; else both
        coordinates of each of its points.
        """
        both = np.array([at.real, at.imag]).T.ravel()
        own = self.keys.setdefault(kind, [])
        if len(at) < 4 or kind[0] == TEXT:
            return (own[0] if own else self._new(kind, None)), both
        middle = at.mean()
        for key in own:
            shape = self.shapes[key]
            turn = 0.0j if shape is None else _turn(shape, at - middle)
            if shape is None:
                return key, both
            if np.max(np.abs(middle + turn * shape - at)) <= 1.0:
                return key, np.array(
                    [SCALE["turn"] * turn.real, SCALE["turn"] * turn.imag, middle.real, middle.imag]
                )
        if len(own) >= MOST["outlines"]:  # it changes its form
            return self._new(kind, None), both
        return self._new(kind, at - middle), np.array([SCALE["turn"], 0.0, middle.real, middle.imag])

    def _new(self, kind: Kind, shape: np.ndarray | None) -> int:
        """A key, with an outline of its own or none."""
        outline = -1
        if shape is not None:
            outline = len(self.outlines)
            whole = np.round(SCALE["outline"] * np.array([shape.real, shape.imag])).astype(int)
            self.outlines.append(whole.T.ravel())
            shape = (whole[0] + 1j * whole[1]) / SCALE["outline"]
        self.shapes.append(shape)
        self.keys[kind].append(len(self.described))
        self.described.append([kind[0], kind[1], kind[2], kind[3], outline])
        return len(self.described) - 1

    def _tracks(self, places: list[dict[int, np.ndarray]]) -> list[Track]:
        """Elements while they are there, those behind first; one whose numbers are of another kind is new."""
        order = list(dict.fromkeys(key for place in places for key in place))
        found = []
        for key in order:
            there = [(k, place[key]) for k, place in enumerate(places) if key in place]
            runs = groupby(enumerate(there), lambda entry: (entry[1][0] - entry[0], len(entry[1][1])))
            for _, run in runs:
                own = [entry[1] for entry in run]
                found.append(Track(key, own[0][0], np.stack([values for _, values in own])))
        return found


def _turn(shape: np.ndarray, at: np.ndarray) -> complex:
    """By what an outline is turned and stretched, in the mean."""
    size = np.vdot(shape, shape).real
    return complex(np.vdot(shape, at) / size) if size else 1.0 + 0.0j


def _around(frames: Sequence[tuple[list[Element], np.ndarray | None]]) -> np.ndarray:
    """Limits that hold all instants, with a twentieth beside them as matplotlib leaves it."""
    points = [each.points for elements, _ in frames for each in elements if not each.fixed]
    all_points = np.concatenate(points) if points else np.zeros((1, 2))
    finite = all_points[np.isfinite(all_points).all(axis=1)]
    if not len(finite):
        finite = np.zeros((1, 2))
    low, high = finite.min(axis=0), finite.max(axis=0)
    middle, half = 0.5 * (low + high), 0.55 * (high - low)
    half = np.maximum(half, 0.1 * half.max()) if half.max() > 0.0 else np.ones(2)
    return np.stack([middle - half, middle + half], axis=1).ravel()
