"""What a guard's margin on a leg is, of what is told of the guard: its dips, and where it begins."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from contwalk.problems.hybrid.limits import _of_watch


def watched(values, dips, **rest):
    """A guard of size one for which both ways across zero matter."""
    told = {"own": False, "opens": False, "edges": False, **rest}
    values = np.array(values)
    times = np.linspace(0.0, 1.0, len(values))
    return SimpleNamespace(scale=1.0, values=values, rates=0.0 * values, times=times, dips=dips, **told)


@pytest.mark.parametrize("begin", [0.0, 0.7])
def test_its_margin_is_its_least_dip_wherever_it_begins(begin):
    watch = watched([begin, 0.9, 0.5, 0.8, 0.4, 1.0], [(1, 0.4, 0.5), (3, 0.8, 0.4)])
    assert _of_watch("dip", watch, 1.0) == (0.4, 1.0, 0.8)


def test_what_has_just_been_zero_and_leaves_is_no_dip():
    """It turns beside its zero, within rounding; the dip that comes later counts."""
    watch = watched([0.0, 0.9, 0.5, 0.8], [(0, 1e-6, -1e-16), (1, 0.6, 0.5)])
    assert _of_watch("dip", watch, 1.0) == (0.5, 1.0, 0.6)
    assert _of_watch("dip", watched([0.0, 0.9], [(0, 1e-6, -1e-16)]), 1.0)[0] == np.inf


def test_what_turns_just_before_its_own_event_is_no_dip():
    watch = watched([0.8, 0.5, 0.8, 0.0], [(0, 0.3, 0.5), (2, 1.0, 0.0)], own=True)
    assert _of_watch("dip", watch, 1.0) == (0.5, 1.0, 0.3)
