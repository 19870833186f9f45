"""A motion is integrated once, whoever looks along it."""

import math

import numpy as np
import pytest
from small_systems import small_system

import contwalk as cw
from contwalk import flow
from contwalk.problems.initial.orbit_from_state import orbit_at
from contwalk.problems.orbit import orbit_section
from contwalk.problems.parameter_line import ParameterLine
from contwalk.system import Observable

VERBS = ("along", "along_with_tangents", "dense", "interpolation", "tangents")


def field(t, x, p, dx):
    """A cycle of radius sqrt(lam) whose period is pi at any lam."""
    s = x[0] ** 2 + x[1] ** 2
    dx[0] = (p.lam - s) * x[0] - 2.0 * x[1]
    dx[1] = 2.0 * x[0] + (p.lam - s) * x[1]


SIZE = Observable("size", lambda t, x, p: float(np.max(np.hypot(x[:, 0], x[:, 1]))))
CYCLE = small_system(field, "xy", {"lam": 1.0}, observables=(SIZE,))


@pytest.fixture
def integrated(monkeypatch):
    """Names of the integrations that have been asked for."""
    asked = []
    for name in VERBS:
        verb = getattr(flow, name)
        monkeypatch.setattr(
            flow, name, lambda *a, name=name, verb=verb, **k: asked.append(name) or verb(*a, **k)
        )
    return asked


@pytest.mark.parametrize("segments", [1, 3])
@pytest.mark.parametrize("method", ["dop853", "verner98", "radau9"])
def test_a_motion_is_integrated_once_with_derivatives_and_once_densely(integrated, segments, method):
    chosen = cw.Discretization(segments=segments, method=method, report_at=(1, 0.5, 1.0))
    problem, z = orbit_at(
        CYCLE,
        ParameterLine.of(CYCLE, CYCLE.defaults(), "lam"),
        None,
        np.array([1.0, 0.0]),
        math.pi,
        discretization=chosen,
    )
    assert problem.mesh.segments == segments
    problem = problem.varied()  # remembers nothing
    integrated.clear()
    linearization = problem.linearize(z)
    assert linearization.finite
    assert np.all(np.isfinite(linearization.magnitudes))
    found = problem.multipliers(z, linearization.jacobian)
    assert problem.observables(z, found)[0] == pytest.approx(1.0, abs=1e-6)
    assert problem.reported(z)[1] == pytest.approx(0.5, abs=1e-6)
    # It goes round evenly; half the range of a state, in which speeds are measured, is that of samples.
    sampled = 1.0 - math.cos(math.pi / len(problem.mesh.times))
    assert problem.slow_places(z)[0].slowness == pytest.approx(1.0, abs=sampled)
    assert len(orbit_section.speeds_of(problem, z)[0]) == len(problem.mesh.times) - segments
    assert problem.first_passed(z, [np.array([0.0, 1.0])]) == 0
    assert integrated == ["along_with_tangents", "interpolation"]


def test_a_walk_looks_densely_along_each_point_once(integrated):
    problem = cw.PeriodicOrbit(CYCLE, CYCLE.defaults(), "lam")
    points = cw.points(problem, np.array([1.0, 0.0]), (0.5, 2.0), period=math.pi, max_points=6)
    next(points)
    integrated.clear()
    following = len(list(points))
    assert 0 < integrated.count("interpolation") <= following
    assert set(integrated) == {"along_with_tangents", "interpolation"}
