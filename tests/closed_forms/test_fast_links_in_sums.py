"""A stiff network of which sums are conserved: what is slow passes zero where it does without the network.

u and v move by themselves at the rate `slow`. An intermediate q takes what they give and decays at the rate
`fast`; z takes the rest, so that a weighted sum is constant. In (u, v), (q, z) the linearization is block
triangular: its eigenvalues are those of u and v, -fast for each intermediate, and zero for each sum.
"""

from __future__ import annotations

import numpy as np
import pytest

import contwalk as cw
from contwalk.numerics.spectrum import EPSILON, spectrum
from contwalk.system import Conserved, Mode, Parameter, State, System

RATES = [(1e-3, 1e8), (1e-6, 1e6), (1e-3, 1e9), (1.0, 1e10), (1e-4, 1e12)]


def spiral(p, u, v):
    """A Hopf point at a = 0, supercritical."""
    r2 = u * u + v * v
    return p.slow * (p.a * u - v - u * r2), p.slow * (p.a * v + u - v * r2)


def saddle_node(p, u, v):
    """Equilibria u^2 = a + 1: a fold at a = -1."""
    return p.slow * (p.a + 1.0 - u * u), -2.0 * p.slow * v


def pitchfork(p, u, v):
    """Equilibria u^2 = a, and u = 0."""
    return p.slow * (p.a * u - u**3), -2.0 * p.slow * v


def network(own, order="uvqz", units=(1.0, 1.0, 1.0, 1.0), weights=(1.0, 1.0, 1.0, 1.0), declared=False):
    """One link, its states in some order and units; weights . (u, v, q, z) is constant."""
    place, w = {name: i for i, name in enumerate(order)}, weights

    def field(t, x, p, dx):
        u, v, q, _ = (x[place[name]] / units[k] for k, name in enumerate("uvqz"))
        f, g = own(p, u - 1.0, v - 1.0)
        rates = f, g, (p.slow - w[0] * f) / w[2] - p.fast * q, (w[2] * p.fast * q - p.slow - w[1] * g) / w[3]
        for k, name in enumerate("uvqz"):
            dx[place[name]] = units[k] * rates[k]

    def total(t, x, p):
        return sum(w[k] * x[place[name]] / units[k] for k, name in enumerate("uvqz"))

    sums = (Conserved("total", total),) if declared else ()
    return system(field, order, sums), place, np.array(units)


def system(field, names, conserved=()):
    parameters = Parameter("a", -0.9), Parameter("slow", 1.0), Parameter("fast", 1.0)
    states = tuple(State(name) for name in names)
    return System(
        "network", states=states, parameters=parameters, modes=(Mode("m", field),), conserved=conserved
    )


def walked(made, values, state, reach=(-0.9, 1.0)):
    slow, fast = values
    problem = cw.Equilibrium(made, made.defaults() | {"slow": slow, "fast": fast}, "a")
    branch = cw.continue_branch(problem, state, reach)
    assert branch.outcome.reason == "bound"
    return branch


def with_one_link(own, values, state=(1.0, 1.0), reach=(-0.9, 1.0), **how):
    made, place, units = network(own, **how)
    slow, fast = values
    start = np.empty(4)
    for k, (name, value) in enumerate(zip("uvqz", (*state, slow / fast, 1.0), strict=True)):
        start[place[name]] = units[k] * value
    branch = walked(made, values, start, reach)
    assert "undeclared neutral" not in branch.outcome.message
    return branch


def the_only(branch, label):
    found = [p for p in branch.special_points if p.label != "EP"]
    assert [p.label for p in found] == [label]
    return found[0]


HOW = [
    {},
    {"order": "zquv", "units": (1e4, 1e-3, 1e-6, 1e5)},
    {"order": "qvzu", "weights": (1.0, 2.0, 0.5, 3.0)},
    {"order": "uzvq", "units": (1.0, 1e3, 1e-8, 1e-2), "weights": (0.1, 7.0, 1.0, 20.0)},
    {"declared": True},
]


@pytest.mark.parametrize("values", RATES)
@pytest.mark.parametrize("how", HOW, ids=["plain", "scaled", "weighted", "both", "declared"])
def test_the_hopf_point_is_where_it_is_without_the_link(values, how) -> None:
    hopf = the_only(with_one_link(spiral, values, **how), "HB")
    assert abs(hopf.parameters["a"]) < 1e-12  # of an a of one, to the refinement
    assert hopf.criticality == "supercritical"
    assert (hopf.unstable_before, hopf.unstable_after) == (0, 2)
    assert hopf.coefficients["omega"] == pytest.approx(values[0], rel=1e-12)


@pytest.mark.parametrize("values", RATES[:4])
@pytest.mark.parametrize("how", HOW[:4], ids=["plain", "scaled", "weighted", "both"])
def test_so_are_a_fold_and_a_pitchfork(values, how) -> None:
    """u^2 = a + 1, of which the branch begins on the stable half; and u = 0 up to a = 0."""
    state = (1.0 + np.sqrt(0.1), 1.0)
    fold = the_only(with_one_link(saddle_node, values, state, (-2.0, 1.0), **how), "LP")
    assert fold.parameters["a"] == pytest.approx(-1.0, abs=1e-12)
    assert (fold.unstable_before, fold.unstable_after) in [(0, 1), (1, 0)]
    point = the_only(with_one_link(pitchfork, values, **how), "BP")
    assert abs(point.parameters["a"]) < 1e-12
    assert (point.kind, point.criticality) == ("pitchfork", "supercritical")
    assert (point.unstable_before, point.unstable_after) == (0, 1)


@pytest.mark.parametrize("values", RATES)
@pytest.mark.parametrize("order", [(0, 1, 2, 3, 4, 5), (5, 2, 0, 4, 1, 3)])
def test_of_two_sums_each_has_a_state_that_is_eliminated(values, order) -> None:
    """u + q + z and v + r + y: a link for each of the two, with other weights and rates."""

    def field(t, x, p, dx):
        u, v, q, r = (x[order[k]] for k in range(4))
        f, g = spiral(p, u - 1.0, v - 1.0)
        decays = p.fast * q, 0.3 * p.fast * r
        rates = f, g, p.slow - f - decays[0], 2.0 * p.slow - decays[1], decays[0] - p.slow, 0.0
        for k in range(5):
            dx[order[k]] = rates[k]
        dx[order[5]] = decays[1] - 2.0 * p.slow - g  # of v + r + y

    slow, fast = values
    start = np.empty(6)
    start[list(order)] = 1.0, 1.0, slow / fast, 2.0 * slow / (0.3 * fast), 1.0, 1.0
    branch = walked(system(field, "uvqrzy"), values, start)
    hopf = the_only(branch, "HB")
    assert abs(hopf.parameters["a"]) < 1e-12
    assert (hopf.unstable_before, hopf.unstable_after) == (0, 2)
    assert len(hopf.spectrum) == 4


@pytest.mark.parametrize("values", RATES)
def test_a_fast_exchange_to_and_fro_has_no_slow_state_of_its_own(values) -> None:
    """x and y are exchanged at the rate `fast`, both ways, and z goes with u: x + y, u + z are conserved."""

    def field(t, s, p, dx):
        f, g = spiral(p, s[0] - 1.0, s[1] - 1.0)
        gone = p.fast * (s[3] - 2.0 * s[4])
        dx[0], dx[1], dx[2], dx[3], dx[4] = f, g, -f, -gone, gone

    branch = walked(system(field, "uvzxy"), values, np.array([1.0, 1.0, 3.0, 2.0, 1.0]))
    hopf = the_only(branch, "HB")
    assert abs(hopf.parameters["a"]) < 1e-12
    assert (hopf.unstable_before, hopf.unstable_after) == (0, 2)
    assert min(hopf.spectrum, key=lambda v: v.real) == pytest.approx(-3.0 * values[1], rel=1e-14)


@pytest.mark.parametrize("values", RATES)
@pytest.mark.parametrize("seed", range(3))
def test_errors_of_what_is_slow_are_roundings_of_its_own_size(values, seed) -> None:
    """The linearization itself, in an order and in units that are drawn: slow (a + i) beside the sum."""
    random = np.random.default_rng(seed)
    slow, fast = values
    a = random.choice([-1.0, 1e-3])
    matrix = slow * np.array([[a, -1, 0, 0], [1, a, 0, 0], [-a, 1, 0, 0], [-1, -a, 0, 0]])
    matrix[2:, 2] = -fast, fast
    order, units = random.permutation(4), 10.0 ** random.uniform(-5.0, 5.0, size=4)
    seen = (units[:, None] * matrix / units)[np.ix_(order, order)]
    found = spectrum(seen, np.zeros((4, 4)), EPSILON * np.abs(seen), (1.0 / units)[order, None])
    assert len(found.values) == 3
    assert np.all(np.abs(found.values[:2] - slow * np.array([a + 1j, a - 1j])) <= found.errors[:2])
    assert np.all(found.errors[:2] < 100.0 * EPSILON * slow)
