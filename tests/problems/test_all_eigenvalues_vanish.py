"""A point at which all eigenvalues pass zero together: nothing else is left to compare them with."""

import numpy as np
import pytest
from small_systems import labelled, small_system

from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.studies.opening import opened


def cubics(t, x, p, dx):
    """Homogeneous at lam = critical, where the Jacobian of x = 0 is a matrix of zeros."""
    rate = 0.03 * (p.lam - p.critical)
    dx[0] = rate * x[0] + 0.8 * x[1] * x[0] ** 2 - 1.08 * x[0] ** 3
    dx[1] = rate * x[1] + 0.8 * x[0] * x[1] ** 2 - 1.08 * x[1] ** 3


@pytest.mark.drawn(1)
@pytest.mark.parametrize("critical", [0.0, 0.3])
def test_the_point_is_located_and_the_walk_goes_on(critical):
    """The walk crept up to it in steps of 1e-12 and told of an unlocated point."""
    parameters = {"lam": 0.14, "critical": critical}
    system = small_system(cubics, "xy", parameters)
    settings = Settings(range=(-1.2, 1.8))
    opening = opened(system, parameters, "lam", np.zeros(2), settings)
    made = Diagram([Start(system, "lam", parameters, opening, "start")], Plan(settings, depth=1))
    assert list(made.events())
    branch, *others = made.branches
    (point,) = labelled(branch, "LP", "BP", "HB")
    assert (point.label, point.status, point.unstable_before, point.unstable_after) == ("BP", "located", 0, 2)
    # Known to more digits than a float has.
    assert point.parameters["lam"] == pytest.approx(critical, rel=2.3e-16, abs=1e-30)
    assert "2 real eigenvalues vanish together" in point.note
    assert [p.kind for p in labelled(branch, "EP")] == ["bound", "bound"]
    # Either state alone, and both alike: 0.8 x - 1.08 x < 0 in both equations, up or down in either.
    assert len(others) == 4
    assert all(other.outcome.reason == "bound" for other in others)
