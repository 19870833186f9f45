"""Normal forms in coordinates of sizes from 1e-8 to 1e8: the curves and their points are what they are.

The states are x = 1e8 exp(u), y = 1e-8 (v + u^2), and the parameters p = 1e-8 mu and q = 1e8 nu.
"""

from __future__ import annotations

import math

import pytest
from hybrid_runs import branch_of
from loci_of_orbits import FINE, map_as_machine
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.diagram.reopening import reopened
from contwalk.system import State

SCALES = (1e8, 1e-8)
RANGES = {"p": (-1e-8, 1e-8), "q": (-1e8, 1e8)}


def plain(x, p):
    """u, v, mu and nu."""
    u = math.log(x[0] / 1e8)
    return u, x[1] / 1e-8 - u * u, p.p * 1e8, p.q * 1e-8


def within_errors(point, **values: float) -> None:
    assert point.status == "located"
    for name, value in values.items():
        assert abs(point.parameters[name] - value) <= point.errors[name] + 2.0**-52 * abs(value)


def driven(t, x, p, dx):
    """u' = mu + nu u - u^3, v' = u^2 - v."""
    u, v, mu, nu = plain(x, p)
    du = mu + nu * u - u**3
    dx[0] = x[0] * du
    dx[1] = 1e-8 * (u * u - v + 2.0 * u * du)


def test_a_cusp_beside_which_the_field_has_no_value() -> None:
    """The logarithm has none of what Newton's method tries: derivatives were one NaN, and not one each."""
    system = small_system(driven, ["x", "y"], {"p": -1e-8, "q": 1e8})
    u = -1.3247179572447460  # u^3 = u - 1
    problem = cw.Equilibrium(system, system.defaults(), "p")
    start = [1e8 * math.exp(u), 2e-8 * u * u]
    branch = cw.continue_branch(problem, start, range=RANGES["p"])
    curve = cw.continue_locus(system, branch, "LP1", RANGES)
    (cusp,) = labelled(curve, "CP")
    within_errors(cusp, p=0.0, q=0.0)
    assert cusp.coefficients["c"] == pytest.approx(-1e-16, rel=1e-9)  # u = 1e-8 of the unit of x


def passed(t, x, p, dx):
    """u' = v, v' = mu - u^2 + v (nu + u^3 - u/2)."""
    u, v, mu, nu = plain(x, p)
    du, dv = v, mu - u * u + v * (nu + u**3 - 0.5 * u)
    dx[0] = x[0] * du
    dx[1] = 1e-8 * (dv + 2.0 * u * du)


@pytest.mark.long
def test_folds_of_a_state_that_only_drives_the_other_pass_the_double_zero() -> None:
    """There the matrix is triangular, with 1e16 in it: in such units the eigenvalue nu was zero to errors."""
    system = small_system(passed, ["x", "y"], {"p": 0.25e-8, "q": -0.3e8})
    problem = cw.Equilibrium(system, system.defaults(), "p")
    branch = cw.continue_branch(problem, [1e8 * math.exp(0.5), 0.25e-8], range=RANGES["p"])
    (fold,) = labelled(branch, "LP")
    assert fold.note is None
    assert fold.coefficients["a"] == pytest.approx(-1e-8 / 0.3, rel=1e-9)
    curve = cw.continue_locus(system, branch, "LP1", RANGES)
    (double,) = labelled(curve, "BT")
    within_errors(double, p=0.0, q=0.0)


def turning(t, x, p, dx):
    """z' = z (mu + nu |z|^2 - |z|^4 + 2 i), z = u + i v."""
    u, v, mu, nu = plain(x, p)
    r = u * u + v * v
    g = mu + nu * r - r * r
    du, dv = g * u - 2.0 * v, 2.0 * u + g * v
    dx[0] = x[0] * du
    dx[1] = 1e-8 * (dv + 2.0 * u * du)


@pytest.mark.long
def test_folds_of_cycles_begin_at_a_generalized_hopf_point() -> None:
    """They are where mu = -nu^2 / 4."""
    system = small_system(turning, [State("x", scale=1e8), State("y", scale=1e-8)], {"p": -6e-9, "q": -1e8})
    problem = cw.Equilibrium(system, system.defaults(), "p")
    branch = cw.continue_branch(problem, [1e8, 0.0], range=RANGES["p"])
    curve = cw.continue_locus(system, branch, "HB1", RANGES)
    (point,) = labelled(curve, "GH")
    within_errors(point, p=0.0, q=0.0)
    there, _ = reopened(system, curve, point)
    (kind,) = [kind for kind in there.point_types if kind.has(point)]
    (seed,) = kind.seeds(there, point)
    state = begin(seed.problem, seed.z, Settings(range=RANGES["p"], second_range=RANGES["q"]), seed.tangent)
    assert isinstance(state, ContinuationState)
    nu, mu = state.sample.z[-2] * 1e-8, state.sample.z[-1] * 1e8
    assert nu > 1e-4  # where cycles fold
    assert mu == pytest.approx(-(nu**2) / 4.0, rel=1e-5)  # on steps of 1e-6


def doubled(x, p):
    """u -> -(1 + mu) u + nu u^3 + u^5, v -> 0.3 v + u^2."""
    u, v, mu, nu = plain(x, p)
    to_u, to_v = -(1.0 + mu) * u + nu * u**3 + u**5, 0.3 * v + u * u
    return 1e8 * math.exp(to_u), 1e-8 * (to_v + to_u**2)


@pytest.mark.long
def test_a_map_whose_states_have_scales_of_their_own() -> None:
    """Orbits that rest between kicks are measured in declared scales, and coefficients in these too."""
    system = map_as_machine(doubled, "xy", {"p": -4e-9, "q": 0.5e8}, *SCALES)
    branch = branch_of(system, "p", RANGES["p"], [1e8, 0.0])
    (doubling,) = labelled(branch, "PD")
    assert (doubling.criticality, doubling.note) == ("supercritical", None)
    assert doubling.coefficients["c"] == pytest.approx(0.5, rel=1e-9)  # 5e-17 by x itself
    curve = cw.continue_locus(system, branch, "PD1", RANGES, **FINE)
    (point,) = labelled(curve, "GPD")
    within_errors(point, p=0.0, q=0.0)
