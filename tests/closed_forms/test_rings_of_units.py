"""Rings of three to eight equal units: eigenvalues of blocks, most of which come twice.

A ring at rest is a block of one unit for each wave number k, J + 2 cos(2 pi k / N) D + .., where J is a
unit's own derivative and D that by each of its neighbours: eigenvalues pass zero, or the imaginary axis, one
by one for k = 0 and N / 2 and two by two for all others.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from small_systems import small_problem

import contwalk as cw


def ring(seed: int) -> tuple[cw.Equilibrium, Callable[[int, float], np.ndarray], float]:
    """A ring at rest, derivatives of its blocks by wave number and parameter, and the end of its range."""
    rng = np.random.default_rng(seed)
    units, size = int(rng.integers(3, 9)), int(rng.choice([1, 2, 2, 3]))
    drawn = [*rng.normal(size=(2, size, size)), *(0.5 * rng.normal(size=(2, size, size)))]
    farther = units > 4 and rng.random() < 0.4  # by the neighbours of neighbours
    drawn.append(0.3 * rng.normal(size=(size, size)) if farther else np.zeros((size, size)))
    sizes = 10.0 ** rng.integers(-3, 4, size) if rng.random() < 0.5 else np.ones(size)
    width = float(10.0 ** rng.uniform(-2.0, 3.0))
    own, own_moved, next_, next_moved, beyond = (sizes[:, None] * each / sizes for each in drawn)

    def field(t, x, p, dx):
        part = p.lam / width
        for i in range(units):
            at = size * i
            after, before, one, other = (size * ((i + k) % units) for k in (1, -1, 2, -2))
            for a in range(size):
                rate = 0.3 * x[at + a] * x[at + (a + 1) % size] / float(sizes[(a + 1) % size])
                rate = rate - x[at + a] ** 3 / float(sizes[a]) ** 2
                for b in range(size):
                    both, others = x[after + b] + x[before + b], x[one + b] + x[other + b]
                    rate = rate + (float(own[a, b]) + part * float(own_moved[a, b])) * x[at + b]
                    rate = rate + (float(next_[a, b]) + part * float(next_moved[a, b])) * both
                    rate = rate + float(beyond[a, b]) * others
                dx[at + a] = rate

    def block(wave: int, lam: float) -> np.ndarray:
        part, angle = lam / width, 2.0 * math.pi * wave / units
        beside = 2.0 * math.cos(angle) * (next_ + part * next_moved) + 2.0 * math.cos(2.0 * angle) * beyond
        return own + part * own_moved + beside

    names = [f"x{i}" for i in range(units * size)]
    problem = small_problem(field, names, {"lam": -width, "units": float(units)}, "lam")
    return problem, block, width


def times(wave: int, units: int) -> int:
    """How often a wave number comes."""
    return 1 if wave == 0 or 2 * wave == units else 2


def crossings(block: Callable[[int, float], np.ndarray], units: int, width: float) -> list[tuple[str, float]]:
    """What passes between -width and width, by blocks: label and place."""

    def unstable(wave: int, lam: float) -> int:
        return int(np.count_nonzero(np.linalg.eigvals(block(wave, lam)).real > 0.0))

    found = []
    grid = np.linspace(-width, width, 4001)
    for wave in range(units // 2 + 1):
        blocks = np.array([block(wave, place) for place in grid])
        counts = np.count_nonzero(np.linalg.eigvals(blocks).real > 0.0, axis=1)
        for k in np.flatnonzero(np.diff(counts)).tolist():
            low, high = float(grid[k]), float(grid[k + 1])
            while high - low > 1e-12 * width:
                middle = 0.5 * (low + high)
                same = unstable(wave, middle) == counts[k]
                low, high = (middle, high) if same else (low, middle)
            found.append(("HB" if abs(counts[k + 1] - counts[k]) == 2 else "BP", low))
    return sorted(found, key=lambda each: each[1])


def is_right(seed: int) -> None:
    """Each crossing is told by its label, nothing else is, and all counts between are those of the blocks."""
    problem, block, width = ring(seed)
    units = int(problem.line.parameters["units"])
    branch = cw.continue_branch(problem, [0.0] * problem.size, (-width, width))
    expected = crossings(block, units, width)
    points = [point for point in branch.special_points if point.label != "EP"]

    def at(label: str, place: float) -> list[cw.SpecialPoint]:
        near = [point for point in points if abs(point.parameters["lam"] - place) <= 1e-9 * width]
        return [point for point in near if point.label == label]

    assert all(at(label, place) for label, place in expected), (expected, points)
    assert len({id(point) for each in expected for point in at(*each)}) == len(points)
    for row in branch.points:
        lam = float(row["free"][0])
        if not row["special"] and all(abs(lam - place) > 1e-6 * width for _, place in expected):
            each = (
                times(wave, units) * np.count_nonzero(np.linalg.eigvals(block(wave, lam)).real > 0.0)
                for wave in range(units // 2 + 1)
            )
            assert row["unstable"] == sum(each), lam


# Of the first two, two pairs that cross the axis hid two real eigenvalues that pass zero on the same step,
# and two real ones that pass together hid one that passes by itself.
@pytest.mark.parametrize("seed", [51, 72, 0, 1])
def test_all_that_pass_are_told(seed):
    is_right(seed)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(4, 150))
def test_all_that_pass_are_told_of_many(seed):
    is_right(seed)
