"""Along a curve in two parameters a turn of either is no special point, and no test names one."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from made_up import line

from contwalk.continuation.double_crossings import _changes_sides, knots_of
from contwalk.continuation.locating import Disagreement
from contwalk.problems.locus.orbit_points.catalogue import POINT_TYPES
from contwalk.problems.sample import Sample


def _with_multiplier(value: float, measure: float, error: float) -> Sample:
    sample = line(lambda z: [-1.0]).sample((0.0, 0.0), (0.0, 1.0))
    told = {"eigenvalues": np.array([value + 0j]), "measures": np.array([measure]), "spectrum_error": 0.0}
    return replace(sample, **told, errors=np.array([error]), unstable=1)


def _curve(label: str) -> Any:
    """A curve of orbits, of which nothing but its kinds of points is asked."""
    return SimpleNamespace(
        kind="locus",
        point_types=POINT_TYPES[label],
        meshed=object(),
        limited=None,
    )


@pytest.mark.parametrize("label", ["LP", "PD", "NS", "BP"])
def test_a_multiplier_that_changes_sides_unseen_asks_for_a_shorter_step(label) -> None:
    """From 5e9 to -3e9 along folds that end on a homoclinic orbit; it was an internal error."""
    a, b = _with_multiplier(5e9, 1.0, 1e-3), _with_multiplier(-3e9, 1.0, 1e-3)
    segment: Any = SimpleNamespace(
        problem=_curve(label),
        a=a,
        b=b,
        length=1.0,
        places=[0.0, 1.0],
        at=lambda theta: _with_multiplier(5e9 - 8e9 * theta, 1.0, 1e-3),
    )
    with pytest.raises(Disagreement, match="beyond 1 to beyond -1"):
        knots_of(segment, [])


def test_a_multiplier_that_is_one_to_its_error_does_not_hide_one_that_changes_sides() -> None:
    """4e79 and 3.8, which is known to 100 and not counted, become -4e81 and -0.04."""
    a, b = (
        replace(
            _with_multiplier(first, 1.0, 1e-3),
            eigenvalues=np.array([first, second], dtype=complex),
            errors=np.array([1e-3, 1e2]),
        )
        for first, second in ((4e79, 3.8), (-4e81, -0.04))
    )
    assert _changes_sides(a, b) == 0
