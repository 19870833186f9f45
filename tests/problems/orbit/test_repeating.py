"""Steps that are alike in all parts of a closure."""

from itertools import pairwise

import numpy as np
import pytest
from small_systems import circle, small_system

from contwalk.problems.initial.orbit_from_state import orbit_at
from contwalk.problems.orbit.repeated_steps import repeating
from contwalk.problems.parameter_line import ParameterLine


@pytest.mark.parametrize("parts", [2, 3])
@pytest.mark.parametrize("segments", [1, 4])
def test_steps_too_short_for_a_later_part_are_left_out_of_all(parts, segments):
    """From 1e-23 on times of the later parts were one: a step without length, where paths are told apart."""
    ends = np.arange(segments + 1) / segments
    short = 10.0 ** np.arange(-23.0, -1.0)
    steps = [
        np.concatenate([[low], low + short[short < 0.9 / segments], [high]]) for low, high in pairwise(ends)
    ]
    found = repeating([np.unique(part) for part in steps], parts)
    assert len(found) == segments
    for part in found:
        assert np.all(np.diff(part) > 0.0)
    if segments == 1:
        lengths = np.diff(found[0]).reshape(parts, -1)
        # Times are rounded at the size of the closure, one.
        assert lengths[1:] == pytest.approx(np.broadcast_to(lengths[0], lengths[1:].shape), abs=5e-16)
        assert lengths[0].min() < 1e-11  # and no longer ones are lost than need be


def test_steps_of_an_orbit_are_alike_in_its_halves():
    """So that pitchforks of orbits stay pitchforks, though nobody has declared a symmetry."""
    system = small_system(circle, "xy", {"mu": 0.5})
    problem, _ = orbit_at(
        system,
        ParameterLine.of(system, system.defaults(), "mu"),
        None,
        np.array([np.sqrt(0.5), 0.0]),
        2.0 * np.pi,
    )
    (steps,) = problem.mesh.steps
    first, second = np.diff(steps).reshape(2, -1)
    assert second == pytest.approx(first, abs=5e-16)  # times are rounded at the size of the closure, one
