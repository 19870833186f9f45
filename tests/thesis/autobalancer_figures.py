"""The run files of the thesis's autobalancer figures, the reference numbers, and how the two are compared."""

from __future__ import annotations

import json
import math
from decimal import Decimal
from functools import cache
from pathlib import Path
from typing import Any

from shared_studies import shared_branches

from contwalk.branch import Branch, SpecialPoint

HERE = Path(__file__).parent
RUNS = HERE.parents[1] / "runs"
# Numbers are kept as text of as many digits as are known.
REFERENCE = json.loads(
    (HERE / "autobalancer_reference.json").read_text(), parse_float=Decimal, parse_int=Decimal
)
EQUILIBRIA, THREE_MASSES = REFERENCE["equilibria"], REFERENCE["three_masses"]
# Points are located to rounding; 1e-9 is what the studies ask for.
LOCATED = 1e-9


@cache
def figure_run(name: str, *overrides: str) -> tuple[Branch, ...]:
    """The branches of a run file, computed once for all files of tests, without its figures."""
    return shared_branches(RUNS / f"{name}.yaml", overrides)


def last_digit(number: Decimal) -> float:
    """One unit of the last digit, or one of the last bit where that is more."""
    exponent = number.as_tuple().exponent
    assert isinstance(exponent, int)
    return max(10.0**exponent if exponent < 0 else 0.0, math.ulp(float(number)))


def assert_located(point: SpecialPoint, parameter: str, expected: Decimal) -> None:
    """The point is where the reference has it, to 1e-9 and to its own estimated error."""
    found = point.parameters[parameter]
    assert point.status == "located", (point.name, point.note)
    assert point.error is not None
    off = abs(found - float(expected))
    assert off <= LOCATED * abs(float(expected)), (point.name, found, expected)
    assert off <= point.error + last_digit(expected), (point.name, found, expected, point.error)


def assert_digits(found: float, expected: Decimal) -> None:
    """Equal to one unit of the last digit that the reference gives, and 1e-12 of the value for rounding."""
    assert abs(found - float(expected)) <= last_digit(expected) + 1e-12 * abs(float(expected)), (
        found,
        expected,
    )


def bifurcations(branches: Any) -> list[tuple[Branch, SpecialPoint]]:
    """Special points that are neither ends nor marks, each with its branch."""
    return [(b, p) for b in branches for p in b.special_points if p.label not in ("EP", "UZ")]


def distinct(branches: Any, parameter: str) -> list[tuple[str, float]]:
    """Labels and positions of all bifurcations, once each.

    A branch that goes on along its own mirror image (masses 1 and 2 exchanged) meets each of them twice.
    """
    found: list[tuple[str, float]] = []
    for _, point in bifurcations(branches):
        at = point.parameters[parameter]
        if not any(label == point.label and math.isclose(at, x, rel_tol=1e-9) for label, x in found):
            found.append((point.label, at))
    return sorted(found, key=lambda f: f[1])


def points_at(
    branches: Any, label: str, parameter: str, expected: Decimal
) -> list[tuple[Branch, SpecialPoint]]:
    """All points of a label within 1e-6 of a position, each with its branch; there is at least one."""
    found = [
        (b, p)
        for b, p in bifurcations(branches)
        if p.label == label and math.isclose(p.parameters[parameter], float(expected), rel_tol=1e-6)
    ]
    assert found, f"no {label} near {parameter} = {expected}"
    return found


def counts(branch: Branch, point: SpecialPoint) -> tuple[int, int]:
    """Unstable eigenvalues below and above the point, in the sense of the parameter."""
    pair = point.unstable_before, point.unstable_after
    return pair if branch["tangent"][point.index, -1] > 0 else pair[::-1]


def start_named(branches: Any, name: str) -> list[Branch]:
    """Branches that began at a named equilibrium."""
    return [b for b in branches if b.info.origin.startswith(f"equilibrium {name}")]
