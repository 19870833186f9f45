"""The reference numbers of the planar walker, and how a gait is compared with them."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from decimal import Decimal
from pathlib import Path

import numpy as np

from contwalk.branch import Branch, SpecialPoint

# Numbers are kept as text of as many digits as are known.
REFERENCE = json.loads(
    (Path(__file__).parent / "planar_walker_reference.json").read_text(encoding="utf-8"), parse_float=Decimal
)
GAIT, SLOPE, FEET = REFERENCE["table1_gait"], REFERENCE["slope"], REFERENCE["figure5"]
# The state right before a heel strike: both legs are straight, and q2 follows from q1.
SECTION = ("q1", "u1", "u2")
# What is left of the last digits of states in double precision: a difference of two runs of the reference.
ULPS = 8


def numbers(texts: Iterable) -> np.ndarray:
    """Real numbers that are kept as text."""
    return np.array([float(text) for text in texts])


def complex_numbers(entries: Iterable) -> np.ndarray:
    """Multipliers that are kept as text, as a number, or as a pair (re, im), by descending modulus."""
    found = [
        complex(float(entry[0]), float(entry[1])) if isinstance(entry, list) else complex(str(entry))
        for entry in entries
    ]
    return np.array(sorted(found, key=lambda value: -abs(value)))


def before_heel_strike(state: dict[str, float]) -> np.ndarray:
    """A reported state in the coordinates of the reference; knees are straight there."""
    assert state["q3"] == 0.0
    assert state["q6"] == 0.0
    return np.array([state[name] for name in SECTION])


def opening(lf: float) -> float:
    """q1 + q2 where both feet of straight legs are on the ground (16), for the lengths of Table I."""
    return -2.0 * math.atan2(lf, 0.3132 + 0.35)


def apart(found: Iterable[complex], expected: np.ndarray) -> float:
    """Largest distance between multipliers, each of `expected` paired with the nearest one left."""
    left, largest = list(found), 0.0
    for value in expected:
        nearest = min(left, key=lambda other: abs(other - value))
        left.remove(nearest)
        largest = max(largest, abs(nearest - value))
    return largest


def assert_alpha(point: SpecialPoint, expected: Decimal | str, relative: float = 1e-8) -> None:
    """Located at this slope: within `relative`, and within the error that the point claims of itself."""
    found, truth = point.parameters["alpha"], float(expected)
    assert point.status == "located", point.note
    assert point.error is not None
    off = abs(found - truth)
    assert off <= relative * truth, (point.name, found, truth)
    # The reference itself is known to some roundings.
    assert off <= point.error + ULPS * math.ulp(truth), (point.name, off, point.error)
    assert point.error <= relative * truth, (point.name, point.error)


def only(branch: Branch, label: str, kind: str | None = None, near: float | None = None) -> SpecialPoint:
    """The one special point of this label and kind; with `near`, within a thousandth of this slope."""
    found = [
        p
        for p in branch.special_points
        if p.label == label
        and kind in (None, p.kind)
        and (near is None or math.isclose(p.parameters["alpha"], near, rel_tol=1e-3))
    ]
    (point,) = found
    return point
