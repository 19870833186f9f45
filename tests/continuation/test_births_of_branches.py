"""How many directions are unstable right beside the branch point that a branch is born at."""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import labelled, small_system

from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.studies.opening import opened
from contwalk.system import State


def away_from_zero(critical, sign):
    """(lam - critical) (u - 1) + sign (u - 1)^3 multiplied out, beside a slow direction, all turned.

    Rounding of its terms, of size one, moves solutions at a distance d from u = 1 by 1e-16 / d.
    """

    def field(t, x, p, dx):
        u, v = x[0] + 0.7 * x[1], x[1] - 0.4 * x[0]
        f = (p.lam - critical) * u - (p.lam - critical) + sign * (u**3 - 3.0 * u**2 + 3.0 * u - 1.0)
        g = -0.01 * (v - 0.3)
        dx[0], dx[1] = f - 0.7 * g, g + 0.4 * f

    return field


@pytest.mark.parametrize("critical", [0.3, 1.1])
@pytest.mark.parametrize(("sign", "unstable"), [(1.0, 1), (-1.0, 0)], ids=["subcritical", "supercritical"])
def test_the_count_of_a_branch_that_is_born_is_told_where_it_is_certain(critical, sign, unstable):
    """Right beside the point rounding decided, and two made-up points 1e-11 away contradicted the rows."""
    system, start = small_system(away_from_zero(critical, sign), "xy", {"lam": 0.0}), 0.8 * critical
    settings = Settings(range=(0.75 * critical, 1.25 * critical), max_points=60)
    parameters = {"lam": start}
    opening = opened(system, parameters, "lam", np.array([0.79, 0.7]) / 1.28, settings)
    diagram = Diagram([Start(system, "lam", parameters, opening, "start")], Plan(settings, depth=1))
    assert list(diagram.events())
    _, born = diagram.branches
    assert labelled(born, "LP", "BP", "HB") == []
    beside = born.points["s"] != 0.0
    assert born.points["unstable"][beside].tolist() == [unstable] * int(beside.sum())


@pytest.mark.parametrize("critical", [0.3, 1.1])
def test_a_branch_away_from_zero_is_measured_by_how_far_it_goes(critical):
    """Its equations, singular there, told of magnitudes of 3000 for states of 0.6: it took 400 points."""
    system = small_system(away_from_zero(critical, -1.0), "xy", {"lam": 0.0})
    settings, parameters = Settings(range=(0.75 * critical, 1.25 * critical)), {"lam": 0.8 * critical}
    opening = opened(system, parameters, "lam", np.array([0.79, 0.7]) / 1.28, settings)
    diagram = Diagram([Start(system, "lam", parameters, opening, "start")], Plan(settings, depth=1))
    assert list(diagram.events())
    _, born = diagram.branches
    assert born.outcome.reason == "bound"
    assert born.points["weights"][:, :2].max() < 2.0
    assert (
        len(born) < 2 * 64
    )  # steps move the parameter by at most a 64th of the range, over half of it twice


@pytest.mark.parametrize("scale", [0.1, 1e4])
def test_declared_scales_stay(scale):
    system = small_system(
        away_from_zero(0.3, -1.0), [State(name, scale=scale) for name in "xy"], {"lam": 0.0}
    )
    settings, parameters = Settings(range=(0.2, 0.4), max_points=40), {"lam": 0.25}
    opening = opened(system, parameters, "lam", np.array([0.79, 0.7]) / 1.28, settings)
    diagram = Diagram([Start(system, "lam", parameters, opening, "start")], Plan(settings, depth=1))
    assert list(diagram.events())
    _, born = diagram.branches
    assert born.points["weights"][born["s"] == 0.0, :2].tolist() == [[scale, scale]]
