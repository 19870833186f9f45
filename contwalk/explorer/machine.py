"""The machine of a branch in motion: what its plugin draws at some instants of each orbit, in little room.

An outline that only moves and turns is written once for the branch, and each instant has four numbers of it.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import count, groupby
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
    _known: dict[tuple[tuple[str, Any], ...], int] = field(default_factory=dict)

    def add(self, frames: Sequence[tuple[list[Element], np.ndarray | None]]) -> None:
        """The instants of one orbit: elements, and limits (left, right, low, high), shape (4,), or None."""
        common = None if all(limits is not None for _, limits in frames) else _around(frames)
        views = np.array([limits if common is None else common for _, limits in frames], dtype=float)
        left, right, low, high = views.T
        heights = np.maximum.accumulate(np.round(SCALE["view"] * np.abs((high - low) / (right - left))))
        tracks = self._tracks(self._placed([elements for elements, _ in frames], views, heights))
        self.heights.append(int(heights[-1]))
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

    def _placed(
        self, frames: list[list[Element]], views: np.ndarray, heights: np.ndarray
    ) -> list[dict[int, np.ndarray]]:
        """Numbers of each element of each instant, by its key, those behind first.

        Elements of one kind are taken together, over all instants: views (f, 4), heights (f,).
        """
        kinds: dict[Kind, tuple[list[int], list[Element]]] = {}
        order: list[list[Kind]] = []
        for frame, elements in enumerate(frames):
            counted: dict[Kind, int] = {}
            shown = []
            for element in elements:
                plain: Kind = (element.kind, self._look(element), element.text, len(element.points), 0)
                counted[plain] = counted.get(plain, 0) + 1
                kind = (*plain[:4], counted[plain])
                there, alike = kinds.setdefault(kind, ([], []))
                there.append(frame)
                alike.append(element)
                shown.append(kind)
            order.append(shown)
        found: dict[tuple[Kind, int], tuple[int, np.ndarray]] = {}
        for kind, (there, alike) in kinds.items():
            entries = self._numbers(kind, _on_paper(alike, views[there], heights[there]))
            for frame, element, (key, numbers) in zip(there, alike, entries, strict=True):
                if element.kind == TEXT:
                    numbers = np.append(numbers, np.array(element.offset) * SCALE["outline"])
                found[kind, frame] = key, np.round(numbers).astype(np.int64)
        return [dict(found[kind, frame] for kind in shown) for frame, shown in enumerate(order)]

    def _look(self, element: Element) -> int:
        """The number of an element's look."""
        plain = tuple(element.look.items())
        if plain not in self._known:
            text = json.dumps(dict(element.look), sort_keys=True)
            self._known[plain] = self.looks.setdefault(text, len(self.looks))
        return self._known[plain]

    def _numbers(self, kind: Kind, at: np.ndarray) -> list[tuple[int, np.ndarray]]:
        """Of elements of one kind, complex (m, k), each with the number of its key: four numbers of an
        outline that has moved and turned; else both coordinates of each of its points.
        """
        both = np.stack([at.real, at.imag], axis=-1).reshape(len(at), -1)
        own = self.keys.setdefault(kind, [])
        if at.shape[1] < 4 or kind[0] == TEXT:
            key = own[0] if own else self._new(kind, None)
            return [(key, numbers) for numbers in both]
        middle = at.mean(axis=1)
        found: dict[int, tuple[int, np.ndarray]] = {}
        left = np.arange(len(at))
        for tried in count():
            if not len(left):
                break
            if tried == len(own):  # no outline that is known will do for the first of them
                whole = len(own) < MOST["outlines"]
                self._new(kind, at[left[0]] - middle[left[0]] if whole else None)
            key = own[tried]
            shape = self.shapes[key]
            if shape is None:  # it changes its form
                found |= {int(row): (key, both[row]) for row in left}
                break
            turn = _turn(shape, at[left] - middle[left, None])
            apart = middle[left, None] + turn[:, None] * shape - at[left]
            near = np.max(np.abs(apart), axis=1) <= 1.0
            for row, by in zip(left[near], turn[near], strict=True):
                moved = [SCALE["turn"] * by.real, SCALE["turn"] * by.imag, middle[row].real, middle[row].imag]
                found[int(row)] = key, np.array(moved)
            left = left[~near]
        return [found[row] for row in range(len(at))]

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


def _on_paper(alike: list[Element], views: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Points of elements of one kind, complex (m, k), x to the right and y downwards; what is not finite is
    zero. An element stands in a view (4,) of views (m, 4), with heights (m,), or is fixed on the axes.
    """
    points = np.array([element.points for element in alike])
    x, y = points[..., 0], points[..., 1]
    left, right, high = views[:, [0]], views[:, [1]], views[:, [3]]
    unit = SCALE["view"] / (right - left)
    on_axes = SCALE["view"] * x + 1j * heights[:, None] * (1.0 - y)
    fixed = np.array([[element.fixed] for element in alike])
    at = np.where(fixed, on_axes, unit * ((x - left) + 1j * (high - y)))
    return np.where(np.isfinite(at), at, 0.0)


def _turn(shape: np.ndarray, at: np.ndarray) -> np.ndarray:
    """By what an outline (k,) is turned and stretched, in the mean, to each of some others (m, k)."""
    size = np.vdot(shape, shape).real
    return at @ shape.conj() / size if size else np.ones(len(at), dtype=complex)


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
