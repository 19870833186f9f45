"""What a guard's margin on a leg is, of what is told of the guard: its dips, and where it begins."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from contwalk.problems.hybrid.margin_values import LITTLE, _of_watch, _sign, largest


def watched(values, dips, own=False, scale=1.0):
    """A guard of some scale for which both ways across zero matter."""
    guard = SimpleNamespace(own=own, opens=False, edges=False)
    ends = {"first": float(values[0]), "last": float(values[-1]), "samples": len(values)}
    return SimpleNamespace(guard=guard, dips=dips, scale=scale, **ends)


@pytest.mark.parametrize("begin", [0.0, 0.7])
def test_its_margin_is_its_least_dip_wherever_it_begins(begin):
    watch = watched([begin, 0.9, 0.5, 0.8, 0.4, 1.0], [(1, 0.4, 0.5), (3, 0.8, 0.4)])
    assert _of_watch("dip", watch, 1.0) == (0.4, 1.0, 0.8)


def test_what_has_just_been_zero_and_leaves_is_no_dip():
    """It turns beside its zero, within rounding; the dip that comes later counts."""
    watch = watched([0.0, 0.9, 0.5, 0.8], [(0, 1e-6, -1e-16), (1, 0.6, 0.5)])
    assert _of_watch("dip", watch, 1.0) == (0.5, 1.0, 0.6)
    assert _of_watch("dip", watched([0.0, 0.9], [(0, 1e-6, -1e-16)]), 1.0)[0] == np.inf


@pytest.mark.parametrize("scale", [1e-8, 1.0, 1e8])
def test_what_turns_just_before_its_own_event_is_no_dip(scale):
    """Its own event is where it is zero but for rounding, in whatever units it is."""
    values = scale * np.array([0.8, 0.5, 0.8, 1e-10])
    watch = watched(values, [(0, 0.3, 0.5 * scale), (2, 1.0, 0.0)], own=True, scale=scale)
    assert _of_watch("dip", watch, 1.0) == (0.5 * scale, scale, 0.3)


@pytest.mark.parametrize("scale", [1e-8, 1.0, 1e8])
def test_a_turn_of_its_own_guard_above_zero_is_a_dip_also_right_before_the_end(scale):
    values = scale * np.array([0.8, 0.5, 0.8, 0.3])
    watch = watched(values, [(0, 0.3, 0.5 * scale), (2, 0.9, 0.2 * scale)], own=True, scale=scale)
    assert _of_watch("dip", watch, 1.0) == (0.2 * scale, scale, 0.9)


@pytest.mark.parametrize(
    ("direction", "falls", "values", "sign"),
    [
        ("falling", None, [1.0, -3.0], 1.0),
        ("rising", None, [1.0, 3.0], -1.0),
        ("both", True, [1.0, -3.0], 1.0),
        ("both", False, [1.0, 3.0], -1.0),
        ("both", None, [1.0, -3.0], -1.0),  # it is mostly below zero: what matters is how near it comes to it
        ("both", None, [3.0, -1.0], 1.0),
    ],
)
def test_a_guard_is_positive_before_its_event(direction, falls, values, sign):
    assert _sign(SimpleNamespace(direction=direction), falls, np.array(values)) == sign


@pytest.mark.parametrize("duration", [1e-3, 1e-6, 1e-9])
def test_on_a_leg_of_nearly_no_time_a_guard_is_measured_by_its_rate(duration):
    """A guard 3 t, on legs of an orbit of two seconds: by what it is after a little of these."""
    share = np.linspace(0.0, 1.0, 5)
    values, rates = 3.0 * duration * share, np.full(5, 3.0 * duration)  # over the leg's own time
    expected = 3.0 * max(duration, 2.0 * LITTLE)
    assert largest(values, rates, duration, 2.0) == pytest.approx(expected, rel=1e-14)
