"""Steps are made anew for each solution, and may put an eigenvalue on the other side: a count does not change
there, where nothing looks for a special point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_up import LINE, MadeUp, at, line

from contwalk.continuation.marks import Observer
from contwalk.continuation.pseudo_arclength import Point, walk
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState
from contwalk.problems.problem import Sample

HOPF = 0.5


def seen(offset: float) -> MadeUp:
    """A pair of eigenvalues that passes zero at `HOPF`, on steps that see it elsewhere."""
    pair = line(lambda z: [z[1] - HOPF + offset + 1j, z[1] - HOPF + offset - 1j])
    return Remade(pair.f, pair.df, pair.eigenvalues, {"HB": [at(0.0, HOPF)]})


class Remade(MadeUp):
    """The same on other steps at every solution: they see the point 0.03 too early, or where it is."""

    size = 1

    @property
    def anchored(self) -> Remade:
        return self

    def adapted(self, sample: Sample) -> tuple[MadeUp, Sample]:
        assert self.eigenvalues is not None
        early = self.eigenvalues(np.array([0.0, HOPF]))[0].real > 0.0
        there = seen(0.0 if early else 0.03)
        linearization = there.linearize(sample.z)
        return there, there.examine(sample.z, sample.tangent, sample.weights, linearization, sample.unstable)


# From one of these the row before the point lies between where it is and where other steps see it.
@pytest.mark.parametrize("begin", [0.0, 0.02, 0.04, 0.06, 0.08])
def test_a_count_changes_at_a_special_point_only(begin):
    problem = seen(0.0)
    sample = problem.sample((0.0, begin), (0.0, 1.0))
    settings = Settings(range=(-1.0, 1.0), step=0.1, max_share=1.0)
    here = ContinuationState(sample, 0.0, 0.1)
    count, met = 0, []
    for item in walk(problem, here, settings, Observer(LINE, ()), 1.0, 100):
        if not isinstance(item, Point):
            continue
        if item.special is not None:
            met.append(item.special.label)
            count = 2
        else:
            assert item.state.sample.unstable == count, item.state.sample.parameter
    assert met == ["HB"]


def test_a_count_that_is_kept_says_what_it_is_not_known_to():
    sample = replace(seen(0.03).sample((0.0, 0.48), (0.0, 1.0)), spectrum_error=1e-9)
    assert sample.unstable == 2
    kept = sample.counted(0)
    assert kept.unstable == 0
    assert kept.errors == pytest.approx([0.01, 0.01], rel=1e-12)
    assert kept.spectrum_error == pytest.approx(0.01, rel=1e-12)
    assert sample.counted(2) is sample
