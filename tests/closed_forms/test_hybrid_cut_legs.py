"""A machine whose only leg lets deviations grow by e^T: its orbits and multipliers in closed form.

u' = u, u = x - sin y, leaves what repels it and ends at u = 1; y' = -1 runs from 0 to -T; z decays. The event
sets u = lambda + c y, so that u(0) = e^-T gives lambda = e^-T + c T. The multipliers are those of two scalar
maps: the derivative of y's is c e^T, of z's s e^(-g T). In x, whose rounding is 1e-16, no start of the leg
tells its end beyond T = 36.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hybrid_runs import assert_met, branch_of, diagram, machine, solution

from contwalk.problems.hybrid import cut_legs, limit_equations
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.rotated import rotated
from contwalk.problems.orbit import condensed, monodromy, variations
from contwalk.system import System, Transition

pytestmark = pytest.mark.slow

C, S, G = 0.1, 0.5, 0.05
# Deviations over a single leg beyond which it must have been cut, and the tolerance of the walk.
GROWN, WALKED = 1e7, 1e-7


def repelling(level: float | None = None, touched: float | None = None) -> System:
    """With a level, an event that changes nothing happens where u passes it on the way; z is pushed at a time
    that is touched first where lambda = 3.
    """

    def field(t, x, p, dx):
        dx[0] = x[0] - np.sin(x[1]) - np.cos(x[1])
        dx[1] = -1.0
        dx[2] = -G * x[2]

    def set_anew(t, x, p, after):
        after[0] = p.lam + C * x[1]
        after[1] = 0.0
        after[2] = S * x[2] + 1.0

    def leaves(t, x, p):
        return 1.0 - x[0] + np.sin(x[1])

    transitions = [Transition("leaves", "near", "near", leaves, reset=set_anew)]
    modes = {"near": field}
    if level is not None:
        modes["off"] = field
        transitions = [
            Transition("passes", "near", "off", lambda t, x, p: level - x[0] + np.sin(x[1])),
            Transition("leaves", "off", "near", leaves, reset=set_anew),
        ]
    if touched is not None:

        def pushed(t, x, p, after):
            after[0], after[1], after[2] = x[0], x[1], x[2] + (x[1] + touched)

        transitions.append(
            Transition(
                "touch", "near", "near", lambda t, x, p: (x[1] + touched) ** 2 + 3.0 - p.lam, reset=pushed
            )
        )
    return machine(["x", "y", "z"], {"lam": 1.0}, modes, transitions)


def parameter(T: float) -> float:
    return math.exp(-T) + C * T


def multipliers(T: float) -> np.ndarray:
    return np.array([C * math.exp(T), S * math.exp(-G * T)])


def start(T: float) -> list[float]:
    return [math.exp(-T), 0.0, 1.0 / (1.0 - S * math.exp(-G * T))]


@pytest.fixture(scope="module", params=[None, pytest.param(0.5, marks=pytest.mark.long)])
def branch(request):
    given = {"lam": parameter(1.0)}
    system = repelling(request.param)
    return branch_of(system, "lam", (0.2, 4.2), start(1.0), given, mode="near", until="settled")


class TestAlongTheBranch:
    def test_it_is_followed_to_the_end_of_its_range(self, branch):
        assert max(branch["period"]) == pytest.approx(42.0, abs=1e-8)
        assert branch.outcome.status == "complete", branch.outcome.message

    def test_its_orbits_are_those_of_the_closed_form(self, branch):
        for T, lam in zip(branch["period"], branch["lam"], strict=True):
            assert lam == pytest.approx(parameter(T), abs=1e-8)

    def test_multipliers_of_1e17_and_of_a_tenth_are_right_at_once(self, branch):
        for T, found in zip(branch["period"], branch.points["spectrum"], strict=True):
            truth = np.sort(multipliers(T))[::-1]
            assert np.abs(found) == pytest.approx(truth, rel=30.0 * WALKED * max(T, 1.0), abs=1e-6)

    def test_the_fold_is_where_it_is(self, branch):
        (fold,) = [p for p in branch.special_points if p.label == "LP"]
        assert_met(fold, "lam", C - C * math.log(C))

    def test_legs_are_cut_where_deviations_grow_and_not_before(self, branch):
        counts = np.isfinite(branch.points["unknowns"]).sum(axis=1)
        assert set(counts[np.exp(branch["period"]) < 1e3]) == {min(counts)}
        assert min(counts[np.exp(branch["period"]) > GROWN]) > min(counts)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("touched", [2.0, 15.0, 28.0])
def test_orbits_beyond_a_grazing_have_segments_too(touched):
    """Deviations grow by e^30 there, so that a simulation tells of a part of the orbit at most."""
    before, beyond = diagram(
        repelling(None, touched), "lam", (0.2, 4.2), start(1.0), {"lam": parameter(1.0)}, mode="near",
        until="settled", events={"GR": "switch"}, follow=("GR",),
    )  # fmt: skip
    (grazing,) = [point for point in before.special_points if point.label == "GR"]
    assert_met(grazing, "lam", 3.0)
    assert max(before["lam"]) == pytest.approx(3.0, abs=1e-12)
    assert beyond.info.signature == ("leaves", "touch")
    assert beyond.outcome.reason == "bound", beyond.outcome.message
    for T, found in zip(beyond["period"][1:], beyond.points["spectrum"][1:], strict=True):
        # The push moves z, and nothing else depends on it.
        assert np.abs(found) == pytest.approx(multipliers(T), rel=1e-4, abs=1e-6)
    assert beyond["lam"] == pytest.approx([parameter(T) for T in beyond["period"]], abs=1e-8)


# -- one orbit, in one segment a leg and in several ---------------------------------------------------------


def forced() -> System:
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -x[0] - 0.1 * x[1] + p.A * np.cos(t)

    def bounces(t, x, p, after):
        after[0] = x[0]
        after[1] = -0.8 * x[1]

    transitions = [
        Transition("hit", "free", "hit", lambda t, x, p: 0.5 - x[0], reset=bounces),
        Transition("seen", "hit", "free", lambda t, x, p: x[0] + 0.2),
    ]
    return machine(
        ["x", "v"], {"A": 1.0}, {"free": field, "hit": field}, transitions, period=lambda p: 2.0 * math.pi
    )


def cut(problem: HybridOrbit, z: np.ndarray, count: int) -> tuple[HybridOrbit, np.ndarray]:
    finer = problem.cut_into(count)
    there = cut_legs.filled(problem, problem.bare(z), count, problem, z)
    return finer.adapted_to(there, finer.weighted(problem.mesh.magnitudes), problem.mesh.tolerance), there


@pytest.fixture(scope="module")
def whole():
    problem, z = solution(forced(), "A", [0.0, 0.0], mode="free", until="settled")
    assert len(problem.itinerary) == 2
    fine = problem.adapted_to(z, problem.weighted(problem.mesh.magnitudes), 1e-12)
    return fine, z


@pytest.fixture(scope="module", params=[2, pytest.param(3, marks=pytest.mark.long)])
def parts(request, whole):
    return cut(*whole, request.param)


def directions(z: np.ndarray) -> np.ndarray:
    return np.random.default_rng(1).standard_normal((2, len(z)))


class TestInSegments:
    def test_derivatives_are_exact(self, parts):
        problem, z = parts
        v, w = directions(z)
        h, found = 1e-6, problem.linearize(z)

        def quotient(function):
            return (function(z + h * w) - function(z - h * w)) / (2.0 * h)

        assert quotient(problem.residual) == pytest.approx(found.jacobian @ w, abs=1e-8)
        second = quotient(lambda y: problem.jacobian(y) @ v)
        assert variations.derivative_along(problem, z, v) @ w == pytest.approx(second, abs=1e-7)
        second = quotient(lambda y: problem.jacobian(y)[:, :-1] @ v[:-1])
        assert variations.cycle_rate(problem, z, v[:-1], w) == pytest.approx(second, abs=1e-7)

    def test_the_condensed_matrix_is_the_matrix(self, parts, monkeypatch):
        problem, z = parts
        b, row = directions(z)
        matrix = np.vstack([problem.jacobian(z), row])
        monkeypatch.setattr(condensed, "FEW", 0)
        found = condensed.factored(problem.layout, matrix, np.ones(len(z)))
        assert isinstance(found, condensed.Condensed)
        assert matrix @ found.solve(b) == pytest.approx(b, abs=1e-11)
        assert matrix.T @ found.solve_adjoint(b) == pytest.approx(b, abs=1e-11)
        assert found.orientation() == np.sign(np.linalg.det(matrix))

    def test_the_orbit_is_told_as_from_whole_legs(self, parts, whole):
        (problem, z), (other, y) = parts, whole
        assert problem.reported(z) == pytest.approx(other.reported(y), abs=1e-7)
        assert problem.margins(z).values == pytest.approx(other.margins(y).values, abs=1e-6)
        own, known = problem.jacobian(z), other.jacobian(y)
        found = np.sort_complex(problem.multipliers(z, own).values)
        assert found == pytest.approx(np.sort_complex(other.multipliers(y, known).values), abs=1e-6)
        assert monodromy.once_round(problem, own, 0) == pytest.approx(
            monodromy.once_round(other, known, 0), abs=1e-5
        )

    def test_maps_for_normal_forms_are_those_of_whole_legs(self, parts, whole):
        ours, known = parts[0].return_map(parts[1]), whole[0].return_map(whole[1])
        q = np.ones(known.basis.shape[1])
        for own, other in zip(ours.curve(q, None, 0.3), known.curve(q, None, 0.3), strict=True):
            assert own == pytest.approx(other, rel=1e-4, abs=1e-4)
        assert ours.size(q) == pytest.approx(known.size(q), rel=1e-6)

    def test_a_limit_on_the_way_has_exact_derivatives(self, parts):
        problem, z = parts
        for leg, name in ((0, problem.itinerary.legs[0].name), (1, problem.itinerary.legs[1].name)):
            limit = next(x for x in problem.limits if x.leg == leg and x.test == "rate")
            assert limit.name == name
            for test, share in (("rate", 1.0), ("dip", 0.4), ("dip", 0.9)):
                own = replace(limit, test=test)
                seconds = share * float(z[problem.layout.durations][leg])
                y = np.append(z, seconds) if test == "dip" else z
                w, h = np.random.default_rng(2).standard_normal(len(y)), 1e-6

                def value(at, own=own, share=share):
                    return limit_equations.rows_of(problem, own, at, share)[0]

                quotient = (value(y + h * w) - value(y - h * w)) / (2.0 * h)
                assert limit_equations.rows_of(problem, own, y, share)[1] @ w == pytest.approx(
                    quotient, rel=1e-6, abs=1e-6
                )

    def test_it_may_begin_with_another_leg(self, parts):
        problem, z = parts
        other, y = rotated(problem, z, 1)
        assert len(y) == len(z)
        found, known = (p.multipliers(x, p.jacobian(x)).values for p, x in ((other, y), (problem, z)))
        assert np.sort_complex(found) == pytest.approx(np.sort_complex(known), abs=1e-6)
        assert np.max(np.abs(other.residual(y))) < 1e-6
