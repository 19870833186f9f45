"""Machines that are linear by pieces, with soft transitions only, against matrix exponentials.

Between switches the motion is exact, so that its closure and its multipliers are known to rounding: those of
the product of the exponentials, since a field that is continuous has no saltation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
import pytest
from hybrid_runs import ACCURACY, diagram, machine
from scipy.linalg import expm
from scipy.optimize import brentq

from contwalk.branch import Branch
from contwalk.system import Symmetry, System, Transition

# What the walk's solutions are known to: a hundred times the accuracy, and what multipliers make of it.
WALKED, SPREAD = 100.0 * ACCURACY, 1e3 * ACCURACY
# Steps in which switches are looked for; none of these machines switches twice within one unseen.
LOOKS = 2000


def exact(
    state: Sequence[float], period: float, matrix: Callable[[float], np.ndarray], corners: Sequence[float]
) -> tuple[np.ndarray, np.ndarray]:
    """State and fundamental matrix after a period of dy/dt = A(y0) y; A changes at the corners of y0."""
    y, whole, t, h = np.array(state), np.eye(len(state)), 0.0, period / LOOKS
    while t < period - 1e-15 * period:
        middle = float((expm(1e-9 * period * matrix(y[0])) @ y)[0])  # a corner is left to one side
        a, step = matrix(middle), min(h, period - t)
        after = expm(step * a) @ y
        for corner in corners:
            if (middle - corner) * (after[0] - corner) < 0.0 and abs(y[0] - corner) > 1e-12:
                step = brentq(lambda s, a=a, y=y, c=corner: (expm(s * a) @ y)[0] - c, 0.0, step, xtol=1e-16)
        part = expm(step * a)
        y, whole, t = part @ y, part @ whole, t + step
    return y, whole


# -- Chua's circuit: autonomous, an orbit that leaves one region as it grows ---------------------------------

MODES, EVENTS = (("right", "left"),), (("out_right", "out_left"), ("in_right", "in_left"))
INNER, OUTER, BETA = -8.0 / 7.0, -5.0 / 7.0, 14.28


def circuit(slope: float, offset: float) -> Callable[..., None]:
    def field(t, x, p, dx):
        dx[0] = p.alpha * (x[1] - x[0] - (slope * x[0] + offset))
        dx[1] = x[0] - x[1] + x[2]
        dx[2] = -BETA * x[1]

    return field


def reflected(t, x, p, image):
    for i in range(3):
        image[i] = -x[i]


def chua() -> System:
    return machine(
        ["x", "y", "z"],
        {"alpha": 7.5},
        {
            "middle": circuit(INNER, 0.0),
            "right": circuit(OUTER, INNER - OUTER),
            "left": circuit(OUTER, OUTER - INNER),
        },
        [
            Transition("out_right", "middle", "right", lambda t, x, p: x[0] - 1.0, "rising", role="soft"),
            Transition("in_right", "right", "middle", lambda t, x, p: x[0] - 1.0, "falling", role="soft"),
            Transition("out_left", "middle", "left", lambda t, x, p: x[0] + 1.0, "falling", role="soft"),
            Transition("in_left", "left", "middle", lambda t, x, p: x[0] + 1.0, "rising", role="soft"),
        ],
        symmetries=(
            Symmetry(
                "mirror",
                "spatial",
                reflected,
                modes={a: b for pair in MODES for a, b in (pair, pair[::-1])},
                events={a: b for pair in EVENTS for a, b in (pair, pair[::-1])},
            ),
        ),
    )


def chua_matrix(alpha: float) -> Callable[[float], np.ndarray]:
    def matrix(x: float) -> np.ndarray:
        slope = INNER if abs(x) < 1.0 else OUTER
        offset = 0.0 if abs(x) < 1.0 else math.copysign(1.0, x) * (INNER - OUTER)
        return np.array(
            [
                [-alpha * (1.0 + slope), alpha, 0.0, -alpha * offset],
                [1.0, -1.0, 1.0, 0.0],
                [0.0, -BETA, 0.0, 0.0],
                [0.0, 0.0, 0.0, 0.0],
            ]
        )

    return matrix


@cache
def chua_branches() -> list[Branch]:
    """The orbit beside one equilibrium, and the one that leaves it with twice the period."""
    return diagram(
        chua(), "alpha", (6.9, 8.8), [2.0, 0.1, -2.0], until="settled", mode="right", follow=("PD",), depth=1
    )


def exact_chua(alpha: float, state: Sequence[float], period: float) -> tuple[np.ndarray, np.ndarray]:
    """By how much the orbit misses, and its multipliers but for the flow's own 1, largest first."""
    begin = np.append(state, 1.0)
    end, whole = exact(begin, period, chua_matrix(alpha), (-1.0, 1.0))
    values = np.linalg.eigvals(whole[:3, :3])
    others = np.delete(values, np.argmin(np.abs(values - 1.0)))
    return end[:3] - begin[:3], others[np.argsort(-np.abs(others))]


class TestChua:
    def test_the_branch_has_its_period_doubling_and_nothing_else(self):
        first = chua_branches()[0]
        assert first.info.signature == ()
        assert [p.label for p in first.special_points] == ["EP", "PD", "EP"]
        assert first.outcome.reason == "bound"

    def test_the_family_of_cycles_of_the_outer_region_is_no_fold(self):
        """At its Hopf point the linear region has cycles of all sizes, with a multiplier that is 1."""
        (branch,) = diagram(
            chua(), "alpha", (5.0, 8.8), [2.0, 0.1, -2.0], until="settled", mode="right", direction="down"
        )
        assert branch.outcome.reason == "shrunk"
        assert [p.label for p in branch.special_points] == ["EP"]
        assert set(branch.points["unstable"].tolist()) == {0}
        # s^3 + (c + 1) s^2 + (c + beta - alpha) s + c beta, c = alpha (1 + slope), has two imaginary roots.
        k = 1.0 + OUTER
        hopf = brentq(lambda a: (k * a + 1.0) * (k * a + BETA - a) - k * a * BETA, 6.0, 7.5)
        standing = np.abs(branch["alpha"] - hopf) < 100.0 * WALKED
        assert np.ptp(branch["amp:x"][standing]) > 0.49  # from x = 1.5 to the corner at 1
        assert np.abs(branch.points["spectrum"][standing, 0] - 1.0).max() < 100.0 * WALKED

    def test_rows_are_orbits_with_the_multipliers_of_the_exponentials(self):
        for branch in chua_branches():
            for k in range(0, len(branch), 9):
                row = branch.points[k]
                missed, values = exact_chua(branch["alpha"][k], row["state"], row["period"])
                assert np.max(np.abs(missed)) < WALKED
                found = row["spectrum"][:2]
                np.testing.assert_allclose(np.poly(found), np.poly(values), rtol=0, atol=SPREAD)
                if np.min(np.abs(np.abs(values) - 1.0)) > SPREAD:
                    assert row["unstable"] == np.sum(np.abs(values) > 1.0)

    def test_the_period_doubling_is_one(self):
        (point,) = (p for p in chua_branches()[0].special_points if p.label == "PD")
        state = [point.state[name] for name in "xyz"]
        missed, values = exact_chua(point.parameters["alpha"], state, point.period)
        assert np.max(np.abs(missed)) < ACCURACY * 10.0
        assert values[0] == pytest.approx(-1.0, abs=10.0 * ACCURACY)


# -- a bilinear oscillator: forced, always between both of its springs ---------------------------------------

ZETA, STIFF = 0.05, 6.0


def spring(stiffness: float) -> Callable[..., None]:
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = math.cos(p.omega * t) - 2.0 * ZETA * x[1] - stiffness * x[0]

    return field


def bilinear(role: str = "soft") -> System:
    return machine(
        ["q", "v"],
        {"omega": 2.0},
        {"pulled": spring(1.0), "pushed": spring(STIFF)},
        [
            Transition("press", "pulled", "pushed", lambda t, x, p: x[0], "rising", role=role),
            Transition("release", "pushed", "pulled", lambda t, x, p: x[0], "falling", role=role),
        ],
        period=lambda p: 2.0 * math.pi / p.omega,
    )


def bilinear_matrix(omega: float) -> Callable[[float], np.ndarray]:
    def matrix(q: float) -> np.ndarray:
        stiffness = STIFF if q > 0.0 else 1.0
        result = np.zeros((4, 4))
        result[0, 1], result[1] = 1.0, [-stiffness, -2.0 * ZETA, 1.0, 0.0]
        result[2, 3], result[3, 2] = -omega, omega
        return result

    return matrix


@cache
def bilinear_branch() -> Branch:
    return diagram(bilinear(), "omega", (0.6, 3.0), [0.0, 0.0], until="settled")[0]


def exact_bilinear(omega: float, state: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    begin = np.array([*state, 1.0, 0.0])
    end, whole = exact(begin, 2.0 * math.pi / omega, bilinear_matrix(omega), (0.0,))
    values = np.linalg.eigvals(whole[:2, :2])
    return (end - begin)[:2], values[np.argsort(-np.abs(values))]


@pytest.mark.long
class TestBilinear:
    """Resonances add and take contacts: at omega = 0.716 one more begins."""

    def test_the_branch_is_one(self):
        branch = bilinear_branch()
        assert branch.outcome.reason == "bound"
        assert {p.label for p in branch.special_points} == {"EP", "PD"}
        assert all(p.status == "located" for p in branch.special_points)

    def test_rows_are_orbits_with_the_multipliers_of_the_exponentials(self):
        branch = bilinear_branch()
        for k in range(0, len(branch), 9):
            row = branch.points[k]
            missed, values = exact_bilinear(branch["omega"][k], row["state"])
            assert np.max(np.abs(missed)) < WALKED
            np.testing.assert_allclose(np.poly(row["spectrum"][:2]), np.poly(values), rtol=0, atol=SPREAD)
            if np.min(np.abs(np.abs(values) - 1.0)) > SPREAD:
                assert row["unstable"] == np.sum(np.abs(values) > 1.0)

    def test_period_doublings_are_such(self):
        for point in bilinear_branch().special_points:
            missed, values = exact_bilinear(point.parameters["omega"], [point.state["q"], point.state["v"]])
            assert np.max(np.abs(missed)) < WALKED
            if point.label == "PD":
                assert values[0] == pytest.approx(-1.0, abs=10.0 * ACCURACY)

    @pytest.mark.long
    def test_declared_hard_it_grazes_where_a_contact_begins_and_goes_on(self):
        """The same period doublings, on both sides of the grazing."""
        found = diagram(
            bilinear("hard"),
            "omega",
            (0.6, 0.9),
            [0.0, 0.0],
            {"omega": 0.8},
            until="settled",
            events={"GR": "switch"},
        )
        assert [len(branch.info.signature) for branch in found] == [2, 4]
        doublings = sorted(p.parameters["omega"] for b in found for p in b.special_points if p.label == "PD")
        soft = [p.parameters["omega"] for p in bilinear_branch().special_points if p.label == "PD"]
        assert doublings == pytest.approx(sorted(soft)[:2], abs=10.0 * ACCURACY)
        grazings = [p.parameters["omega"] for b in found for p in b.special_points if p.label == "GR"]
        assert grazings == pytest.approx([grazings[0]] * 2, abs=ACCURACY)


# -- a spring, and a wall behind the other side --------------------------------------------------------------


@pytest.mark.long
def test_a_quiet_orbit_meets_its_spring_before_its_wall():
    """Without hard events so far; where the wall is grazed the orbits with hits leave, springs and all."""

    def free(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = p.force * math.cos(1.2 * t) - 0.1 * x[1] - x[0]

    def held(t, x, p, dx):
        free(t, x, p, dx)
        dx[1] = dx[1] - 6.0 * (x[0] + 0.5)

    def bounce(t, x, p, after):
        after[0], after[1] = x[0], -0.7 * x[1]

    system = machine(
        ["q", "v"],
        {"force": 0.05},
        {"free": free, "spring": held},
        [
            Transition("hit", "free", "free", lambda t, x, p: 1.0 - x[0], reset=bounce),
            Transition("reach", "free", "spring", lambda t, x, p: x[0] + 0.5, role="soft"),
            Transition("let_go", "spring", "free", lambda t, x, p: -x[0] - 0.5, role="soft"),
        ],
        period=lambda p: 2.0 * math.pi / 1.2,
    )
    quiet, hitting = diagram(
        system, "force", (0.02, 0.4), [0.0, 0.0], until="settled", events={"GR": "switch"}, direction="up"
    )
    assert quiet.info.signature == ()
    assert [p.label for p in quiet.special_points] == ["LP", "LP", "GR", "EP"]
    # The spring is reached where the linear oscillator's amplitude is the gap.
    touch = 0.5 * math.hypot(1.0 - 1.44, 0.12)
    alone = np.abs(np.prod(quiet.points["spectrum"][:, :2], axis=1) - np.exp(-0.1 * 2.0 * math.pi / 1.2))
    assert np.max(alone) < SPREAD  # springs take nothing
    assert quiet.special_points[0].parameters["force"] > touch
    graze = quiet.special_points[2]
    assert hitting.info.signature == ("hit",)
    assert hitting.points["free"][0] == pytest.approx(graze.parameters["force"], rel=1e-3)
    assert hitting.outcome.reason == "bound"
