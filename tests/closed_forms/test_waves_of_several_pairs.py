"""Hopf points at which several pairs pass together and no symmetry is declared: which waves are born.

Two oscillators z' = (mu + i) z - |z|^2 z - b |w|^2 z - c conj(z) w^2, and the same of w: one of them alone,
with |z|^2 = mu; both in phase or opposite, with |z|^2 = mu / (1 + b + c); both a quarter apart, with |z|^2 =
mu / (1 + b - c). With c = 0 any phase will do: a family.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.branch import Branch
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.numerics.permutations import as_cycles, generating
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.equilibrium.permutations import permutations_at
from contwalk.studies.opening import opened

B, LAST = 0.3, 0.2


def two(c, units=(1.0, 1.0), order=(0, 1, 2, 3)):
    """Two of them, each in units of its own, their states in some order."""

    def field(t, x, p, dx):
        a, b, u, v = (x[k] / units[i // 2] for i, k in enumerate(order))
        own, other = a * a + b * b, u * u + v * v
        # conj(z) w^2, and conj(w) z^2
        real, imag = a * (u * u - v * v) + 2.0 * b * u * v, 2.0 * a * u * v - b * (u * u - v * v)
        back, aside = u * (a * a - b * b) + 2.0 * v * a * b, 2.0 * u * a * b - v * (a * a - b * b)
        rates = (
            (p.mu - own - B * other) * a - b - c * real,
            (p.mu - own - B * other) * b + a - c * imag,
            (p.mu - other - B * own) * u - v - c * back,
            (p.mu - other - B * own) * v + u - c * aside,
        )
        for i, k in enumerate(order):
            dx[k] = units[i // 2] * rates[i]

    return field


def ring(count, k=0.1):
    """Stuart-Landau oscillators in a ring: two pairs pass at mu = 2 k (1 - cos(2 pi / n))."""

    def field(t, x, p, dx):
        for i in range(count):
            a, b = x[2 * i], x[2 * i + 1]
            j, m = 2 * ((i + 1) % count), 2 * ((i - 1) % count)
            size = a * a + b * b
            dx[2 * i] = (p.mu - size) * a - b + k * (x[j] + x[m] - 2.0 * a)
            dx[2 * i + 1] = a + (p.mu - size) * b + k * (x[j + 1] + x[m + 1] - 2.0 * b)

    return field


def walked(field, count, begin=-0.1, end=LAST, points=400, start=None) -> list[Branch]:
    system = small_system(field, [f"x{i}" for i in range(count)], {"mu": begin})
    settings = Settings(range=(begin, end), max_points=points)
    steps = cw.Discretization(accuracy=1e-8)
    rest = np.zeros(count) if start is None else start
    opening = opened(system, {"mu": begin}, "mu", rest, settings, discretization=steps)
    made = Diagram(
        [Start(system, "mu", {"mu": begin}, opening, "start")], Plan(settings, frozenset({"HB"}), 1)
    )
    assert list(made.events())
    return made.branches


@pytest.mark.parametrize(
    ("units", "order"), [((1.0, 3.0), (0, 1, 2, 3)), ((2e3, 5e2), (3, 0, 2, 1))], ids=["units", "order"]
)
def test_waves_are_those_of_the_cubic_normal_form(units, order) -> None:
    """In like units the two could be exchanged; in these no permutation takes one to the other."""
    c = 0.2
    rest, *waves = walked(two(c, units, order), 4)
    first, _ = labelled(rest, "HB")
    assert "2 pairs of eigenvalues pass together: 6 waves are followed" in first.note
    assert "unchanged under" not in first.note
    assert (first.criticality, first.coefficients["multiplicity"]) == ("supercritical", 2)
    assert "l1" not in first.coefficients  # of which vector?
    found = []
    for branch in waves:
        assert branch.outcome.reason == "bound", branch.outcome
        state = branch.points["state"][-1]
        found.append([np.hypot(*[state[order[i + k]] / units[i // 2] for k in (0, 1)]) ** 2 for i in (0, 2)])
    both, quarter = LAST / (1.0 + B + c), LAST / (1.0 + B - c)
    known = [[0.0, LAST], [both, both], [both, both], [quarter, quarter], [quarter, quarter], [LAST, 0.0]]
    assert np.array(sorted(found)) == pytest.approx(np.array(known), abs=1e-6)  # to the walk's steps


def test_where_any_phase_will_do_it_is_told_and_not_followed() -> None:
    rest, *waves = walked(two(0.0, (1.0, 3.0)), 4)
    first, _ = labelled(rest, "HB")
    assert "2 waves are followed; others lie in a family" in first.note
    assert len(waves) == 2
    for branch in waves:
        assert branch.outcome.reason == "bound"


def test_what_could_be_declared_is_named_and_waves_that_need_it_are_not_followed() -> None:
    """Three in a ring: of waves that stand, the normal form tells no direction to the third order."""
    rest, *waves = walked(ring(3), 6, 0.1, 0.5)
    first = next(p for p in labelled(rest, "HB") if "together" in (p.note or ""))
    assert first.parameters["mu"] == pytest.approx(0.3, abs=1e-14)
    assert "x0 -> x2 -> x0, x1 -> x3 -> x1" in first.note
    assert "others lie in a family" in first.note
    assert all(branch.outcome.status != "failed" for branch in waves)
    sizes = [np.hypot(*branch.points["state"][-1].reshape(3, 2).T) for branch in waves]
    rotating = [each for each in sizes if np.ptp(each) < 1e-6]
    assert len(rotating) == 1  # that the other way round is its image
    assert rotating[0] == pytest.approx(np.full(3, np.sqrt(0.5 - 0.3)), abs=1e-6)


def with_memory(t, x, p, dx):
    """Three kinds that live on the same, with a memory of themselves; two pairs pass at mu = 1/2."""
    total = x[0] + x[2] + x[4]
    for i in range(3):
        a, m = x[2 * i], x[2 * i + 1]
        dx[2 * i] = 4.0 * a * (1.0 - (1.0 - p.mu) * m - 0.5 * p.mu * (total - a))
        dx[2 * i + 1] = a - m


def test_a_wave_that_leaves_almost_straight_up_neither_turns_nor_changes_its_stability() -> None:
    """The parameter moves by 1e-9 there, with the steps' errors, and a multiplier is as near to one."""
    rest, wave = walked(with_memory, 6, 0.3, 0.6, start=np.ones(6))
    assert [p.parameters["mu"] for p in labelled(rest, "HB")] == pytest.approx([0.5, 0.5], abs=1e-14)
    assert wave.outcome.reason == "bound", wave.outcome
    assert [p.label for p in wave.special_points] == ["EP"]
    assert not wave["unstable"].any()
    state, period = wave.points["state"][-1], wave["period"][-1]

    def rates(t, x):
        result = np.zeros(6)
        with_memory(t, x, SimpleNamespace(mu=0.6), result)
        return result

    there = solve_ivp(rates, (0.0, period), state, method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
    assert there == pytest.approx(state, abs=1e-6)


def test_waves_of_pairs_that_pass_together_are_found_in_any_units() -> None:
    """What makes both pass together is no symmetry of these states; a cycle is as large as orders fall."""
    units = np.array([0.0507, 2.4, 0.0189, 0.0031, 0.0041, 0.243])

    def field(t, x, p, dx):
        given = [float(unit) * value for unit, value in zip(units, x, strict=True)]
        rates = [0.0] * 6
        with_memory(t, given, p, rates)
        for i, unit in enumerate(units):
            dx[i] = rates[i] / float(unit)

    rest, *waves = walked(field, 6, 0.3, 0.6, start=1.0 / units)
    assert [p.parameters["mu"] for p in labelled(rest, "HB")] == pytest.approx([0.5, 0.5], abs=1e-14)
    assert "2 vertical to the third order" in labelled(rest, "HB")[0].note
    for wave in waves:
        assert wave.outcome.reason == "bound", wave.outcome
        assert [p.label for p in wave.special_points] == ["EP"]
        assert np.ptp(units * wave.points["state"][-1]) > 0.1
    assert len(waves) == 2


def test_permutations_of_a_field_are_found() -> None:
    system = small_system(ring(4), [f"x{i}" for i in range(8)], {"mu": 0.1})
    problem = Equilibrium(system, system.defaults(), "mu")
    found = permutations_at(problem, np.append(np.zeros(8), 0.1))
    assert len(found) == 7  # those of a square, without the one that moves nothing
    assert len(generating(found)) == 2
    assert as_cycles((2, 3, 0, 1), ("a", "b", "c", "d")) == "a -> c -> a, b -> d -> b"


def test_a_field_that_is_only_alike_at_rest_has_none() -> None:
    def field(t, x, p, dx):
        dx[0], dx[1] = -x[0] + x[0] ** 2, -x[1] + 2.0 * x[1] ** 2

    system = small_system(field, "xy", {"mu": 0.1})
    assert permutations_at(Equilibrium(system, system.defaults(), "mu"), np.array([0.0, 0.0, 0.1])) == []
