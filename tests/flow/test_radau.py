"""Radau IIA: its numbers, its order, stiff problems, error estimates, the frozen grid, and how paths end."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from small_flows import field_of

from contwalk.flow import ErrorControl, Field, adaptive, along, controlled, dense, errors_on, interpolation
from contwalk.flow.radau import radau_iia as radau
from contwalk.flow.tableaus.radau import RADAU5, RADAU9, Collocation

METHODS = ("radau5", "radau9")


def van_der_pol() -> Field:
    return field_of(lambda t, x, p: [x[1], p[0] * (1.0 - x[0] ** 2) * x[1] - x[0]], 2, 1, [0])


def kepler() -> Field:
    def rates(t, x, p):
        cube = (x[0] ** 2 + x[1] ** 2) ** 1.5
        return [x[2], x[3], -p[0] * x[0] / cube, -p[0] * x[1] / cube]

    return field_of(rates, 4, 1)


def robertson() -> Field:
    def rates(t, x, p):
        slow, back, fast = 0.04 * x[0], 1e4 * x[1] * x[2], p[0] * x[1] ** 2
        return [back - slow, slow - back - fast, fast]

    return field_of(rates, 3, 1)


def oregonator() -> Field:
    def rates(t, x, p):
        return [
            p[0] * (x[1] + x[0] * (1.0 - 8.375e-6 * x[0] - x[1])),
            (x[2] - (1.0 + x[0]) * x[1]) / p[0],
            0.161 * (x[0] - x[2]),
        ]

    return field_of(rates, 3, 1)


@pytest.mark.parametrize("tableau", [RADAU5, RADAU9])
def test_numbers_follow_from_the_definition(tableau: Collocation) -> None:
    """Nodes by their polynomial, A by its quadrature conditions, modes as eigenvectors: all in 40 digits."""
    s = tableau.stages
    with mpmath.workdps(40):
        node = [mpmath.mpf(c) for c in tableau.nodes]
        for c in node[:-1]:
            # the (s-1)-th derivative of x^(s-1) (x-1)^s changes sign within two ulps of the node
            values = [
                mpmath.diff(lambda x: x ** (s - 1) * (x - 1) ** s, c + d, s - 1) for d in (-2.3e-16, 2.3e-16)
            ]
            assert values[0] * values[1] < 0
    c, a, inverse = np.array(tableau.nodes), np.array(tableau.matrix), np.array(tableau.inverse)
    for q in range(s):
        # a sum of s products of numbers below 1: a few roundings
        np.testing.assert_allclose(a @ c**q, c ** (q + 1) / (q + 1), atol=4e-16)
    # entries of the inverse reach 30 and its condition 100: 1e-13 is some ten roundings
    np.testing.assert_allclose(a @ inverse, np.eye(s), atol=1e-13)
    for mode in (tableau.real, *tableau.pairs):
        right, left = np.array(mode.right), np.array(mode.left)
        np.testing.assert_allclose(inverse @ right, mode.eigenvalue * right, atol=1e-13)
        np.testing.assert_allclose(left @ inverse, mode.eigenvalue * left, atol=2e-12)
        np.testing.assert_allclose(left @ right, 1.0, atol=1e-13)


@pytest.mark.parametrize("tableau", [RADAU5, RADAU9])
def test_ratio_of_error_and_estimate_for_small_steps(tableau: Collocation) -> None:
    """On the motion t^(s+1) of x' = z x + g(t).

    Its stages have the errors (1 - z A)^-1 e with e = c^(s+1) - (s + 1) A c^s.
    """
    c, a, s = np.array(tableau.nodes), np.array(tableau.matrix), tableau.stages
    stages = c ** (s + 1) - (s + 1) * a @ c**s
    end = np.linalg.matrix_power(a, s - 1)[-1] @ stages
    estimate = np.array(tableau.error) @ (c ** (s + 1) - stages)
    pairs = np.prod([abs(mode.eigenvalue) ** 2 for mode in tableau.pairs])
    # powers of A cancel to 1e-4 of their entries
    assert tableau.linear == pytest.approx(abs(end / estimate) * pairs, rel=1e-11)


@pytest.mark.parametrize(("method", "order", "counts"), [("radau5", 5, (12, 24)), ("radau9", 9, (12, 24))])
def test_order_on_the_kepler_problem(method: str, order: int, counts: tuple[int, int]) -> None:
    """A planet of eccentricity 0.4: t = E - e sin E, x = cos E - e, y = sqrt(1 - e^2) sin E.

    (A Riccati equation like x' = -2 t x^2 is no test: on it the errors of order 9 cancel, to order 12.)
    """
    e, end = 0.4, 2.0
    with mpmath.workdps(30):
        anomaly = mpmath.findroot(lambda E: E - mpmath.mpf(e) * mpmath.sin(E) - end, end)
        truth = [
            float(mpmath.cos(anomaly) - e),
            float(mpmath.sqrt(1 - mpmath.mpf(e) ** 2) * mpmath.sin(anomaly)),
        ]
    field, start = kepler(), [1.0 - e, 0.0, 0.0, np.sqrt((1.0 + e) / (1.0 - e))]
    c = field.constants([1.0])
    errors = [
        np.linalg.norm(along(field, c, np.linspace(0.0, end, n + 1), start, method)[-1, :2] - truth)
        for n in counts
    ]
    assert errors[1] > 1e-13  # above rounding, so that the order can be seen
    # the next term of the expansion is one step length, 1/12, smaller
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize("method", METHODS)
def test_steps_are_those_of_the_definition(method: str) -> None:
    """Z = h A f(t + c h, x + Z), by 40 digits: what the compiled steps give is this to rounding."""
    tableau = {"radau5": RADAU5, "radau9": RADAU9}[method]
    s, steps, x = tableau.stages, 6, mpmath.mpf(1)
    with mpmath.workdps(40):
        h = mpmath.mpf(2) / steps
        for n in range(steps):
            z = mpmath.matrix(s, 1)
            for _ in range(12):
                t = [n * h + mpmath.mpf(c) * h for c in tableau.nodes]
                f = mpmath.matrix([-2 * t[i] * (x + z[i]) ** 2 for i in range(s)])
                slope = mpmath.diag([-4 * t[i] * (x + z[i]) for i in range(s)])
                a = h * mpmath.matrix(tableau.matrix)
                z -= mpmath.lu_solve(mpmath.eye(s) - a * slope, z - a * f)
            x += z[s - 1]
        truth = float(x)
    field = field_of(lambda t, x, p: [-2.0 * t * x[0] ** 2 * p[0]], 1, 1)
    end = along(field, field.constants([1.0]), np.linspace(0.0, 2.0, steps + 1), [1.0], method)[-1, 0]
    assert end == pytest.approx(truth, abs=1e-15)  # six steps, half a rounding of 1 each


@pytest.mark.parametrize("steps", [4, 8, 16])
@pytest.mark.parametrize(("method", "stages"), [("radau5", 3), ("radau9", 5)])
def test_stiff_order_is_at_least_the_stage_order(method: str, stages: int, steps: int) -> None:
    """Prothero and Robinson: x' = -1e7 (x - cos t) - sin t from x = 1.

    For h -> 0 with z = -1e7 h -> -infinity the step's error is that of the stages, M h^(s+1) cos^(s+1) / z
    with
    |M| < 1 / s!: far below the stage order in size, and that is what is asserted, at every step length.
    """
    field = field_of(lambda t, x, p: [-p[0] * (x[0] - np.cos(t)) - np.sin(t)], 1, 1)
    times = np.linspace(0.0, 6.0, steps + 1)
    h = times[1]
    found = along(field, field.constants([1e7]), times, [1.0], method)[:, 0]
    bound = h**stages / (1e7 * np.prod(np.arange(1.0, stages + 1.0)))
    assert np.abs(found - np.cos(times)).max() < max(bound, 4e-16)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-10])
@pytest.mark.parametrize("method", METHODS)
def test_van_der_pol_over_a_relaxation_cycle(method: str, tolerance: float) -> None:
    """The reference at t = 2000 is that of Hairer and Wanner's test set (mu = 1000)."""
    field = van_der_pol()
    path = adaptive(field, field.constants([1e3]), 0.0, [2.0, 0.0], 2000.0, tolerance, [2.0, 1500.0], method)
    assert path.status == "ok"
    assert path.times[-1] == 2000.0
    # a jump shifts the phase by what the error of its steps is; afterwards errors die out along the slow
    # branch
    np.testing.assert_allclose(
        path.states[-1], [1.706167732170483, -0.8928097010247975e-3], rtol=100.0 * tolerance
    )


@pytest.mark.parametrize("method", METHODS)
def test_robertson_over_eleven_decades(method: str) -> None:
    """The reference at t = 1e11 is that of the test set for IVP solvers (Mazzia and Magherini)."""
    field = robertson()
    c, weights = field.constants([3e7]), [1.0, 3.6e-5, 1.0]
    path = adaptive(field, c, 0.0, [1.0, 0.0, 0.0], 1e11, 1e-10, weights, method)
    assert path.status == "ok"
    assert len(path.times) < 1500
    truth = np.array([0.2083340149701255e-7, 0.8333360770334713e-13, 0.9999999791665050])
    # a thousand steps of 1e-10 at most, in units of the weights
    np.testing.assert_array_less(np.abs(path.states[-1] - truth) / weights, 1e-7)
    # what there is in all does not change, but for rounding of three states over the steps
    np.testing.assert_allclose(path.states.sum(axis=1), 1.0, atol=1e-12)


CASES = {
    "kepler": (kepler, [1.0], [0.6, 0.0, 0.0, np.sqrt(1.4 / 0.6)], 20.0, np.ones(4)),
    "van der Pol 5": (van_der_pol, [5.0], [2.0, 0.0], 30.0, np.array([2.0, 7.0])),
    "van der Pol 1000": (van_der_pol, [1e3], [2.0, 0.0], 2000.0, np.array([2.0, 1500.0])),
    "robertson": (robertson, [3e7], [1.0, 0.0, 0.0], 1e6, np.array([1.0, 3.6e-5, 1.0])),
    "oregonator": (oregonator, [77.27], [1.0, 2.0, 3.0], 360.0, np.array([1e5, 1.8e3, 3e4])),
}


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("name", CASES)
def test_errors_of_steps_are_what_was_allowed(name: str, tolerance: float) -> None:
    """Each step against four steps of a quarter, from the same state. Jumps, too, must be resolved."""
    make, p, start, end, weights = CASES[name]
    field = make()
    c = field.constants(p)
    path = adaptive(field, c, 0.0, start, end, tolerance, weights, "radau9")
    assert path.status == "ok"
    nodes = list(zip(path.times[:-1], path.times[1:], path.states[:-1], path.states[1:], strict=True))
    errors = []
    for t, later, x, y in nodes:
        fine = along(field, c, np.linspace(t, later, 5), x, "radau9")[-1]
        errors.append(np.sqrt(np.mean(((y - fine) / weights) ** 2)))
    errors = np.array(errors)
    # the estimate rests on one Jacobian a step: where it changes by its own size, an error is ten times as
    # large
    assert np.max(errors) < 20.0 * tolerance
    assert np.quantile(errors, 0.9) < 2.0 * tolerance
    # nothing is given away: of the embedded formula alone steps would be three times as many at 1e-12
    assert len(path.times) < {1e-6: 130, 1e-9: 200, 1e-12: 400}[tolerance]


@pytest.mark.parametrize("method", METHODS)
def test_steps_of_a_path_are_taken_again_bitwise(method: str) -> None:
    field = van_der_pol()
    c = field.constants([50.0])
    path = adaptive(field, c, 0.0, [2.0, 0.0], 60.0, 1e-8, [2.0, 75.0], method)
    assert path.rejected > 0
    assert np.array_equal(along(field, c, path.times, [2.0, 0.0], method), path.states)
    errors = errors_on(field, c, path.times, [2.0, 0.0], method, [2.0, 75.0])
    assert errors.shape == (len(path.times) - 1,)
    # of a step that was tried again the error was estimated again, too, from a better start: below in both
    # cases
    assert np.median(errors) < 1e-8
    assert np.array_equal(dense(field, c, path.times, path.states, path.times, method), path.states)


@pytest.mark.parametrize("method", METHODS)
def test_a_path_that_is_interpolated_is_marched_once(method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Orbits are looked at everywhere at each point of a branch: a call a step costs more than the rest."""
    field = van_der_pol()
    c = field.constants([50.0])
    path = adaptive(field, c, 0.0, [2.0, 0.0], 60.0, 1e-8, [2.0, 75.0], method)
    starts, lengths = path.times[:-1], np.diff(path.times)
    at = (starts[:, None] + lengths[:, None] * [0.0, 0.3, 0.8]).ravel()
    one_by_one = [
        dense(field, c, path.times[k : k + 2], path.states[k : k + 2], at[3 * k : 3 * k + 3], method)
        for k in range(len(lengths))
    ]
    marches, march = [], radau._march
    monkeypatch.setattr(radau, "_march", lambda *a, **b: marches.append(1) or march(*a, **b))
    found = interpolation(field, c, path.times, path.states, method)(at)
    assert len(marches) == 1
    # both solve the same steps to rounding, which stiffness hardly magnifies
    np.testing.assert_allclose(found, np.concatenate(one_by_one), rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("method", METHODS)
def test_nodes_that_are_no_march_are_gone_on_from_one_by_one(method: str) -> None:
    """Deviations that grow by exp(20) over the path stay what they are at the nodes."""
    field = field_of(lambda t, x, p: [p[0] * x[0]], 1, 1)
    c, times = field.constants([1.0]), np.linspace(0.0, 20.0, 101)
    states = np.exp(times)[:, None] * (1.0 + 1e-3 * np.cos(times))[:, None]
    at = times[:-1] + 0.1
    found = interpolation(field, c, times, states, method)(at)
    # the local error of a step of 0.2 between nodes, of order s + 1: (0.2)^4 / 4! at most
    np.testing.assert_allclose(found[:, 0], states[:-1, 0] * np.exp(0.1), rtol=1e-4)
    assert np.array_equal(interpolation(field, c, times, states, method)(times), states)


@pytest.mark.parametrize("method", METHODS)
def test_backwards_leads_back(method: str) -> None:
    """On a conservative flow, stiff in neither direction; the last step ends on the last bit of t1."""
    field, start = kepler(), np.array([0.6, 0.0, 0.0, np.sqrt(1.4 / 0.6)])
    c = field.constants([1.0])
    there = adaptive(field, c, 0.0, start, 7.0, 1e-11, np.ones(4), method)
    back = adaptive(field, c, 7.0, there.states[-1], 0.0, 1e-11, np.ones(4), method)
    assert back.status == "ok"
    assert back.times[-1] == 0.0
    assert np.all(np.diff(back.times) < 0.0)
    # some hundreds of steps of 1e-11, which grow with time as phases do
    np.testing.assert_allclose(back.states[-1], start, atol=1e-8)
    np.testing.assert_array_equal(along(field, c, back.times, there.states[-1], method), back.states)
    middle = dense(field, c, back.times, back.states, [3.5], method)[0]
    other = dense(field, c, there.times, there.states, [3.5], method)[0]
    # interpolation is of order s + 1: its error is what the embedded estimate may be, 0.1
    # tolerance^((s+1)/2s)
    np.testing.assert_allclose(middle, other, atol=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_how_paths_end(method: str) -> None:
    blowing_up = field_of(lambda t, x, p: [p[0] * x[0] ** 2], 1, 1)  # 1 / (1 - t)
    path = adaptive(blowing_up, blowing_up.constants([1.0]), 0.0, [1.0], 2.0, 1e-8, [1.0], method)
    assert path.status in ("step_too_small", "not_finite")
    assert path.times[-1] == pytest.approx(1.0, abs=1e-3)  # the absolute tolerance stops it where x is large
    assert np.all(np.isfinite(path.states))
    ending = field_of(lambda t, x, p: [-p[0] / np.sqrt(x[0])], 1, 1)  # reaches 0 at t = 2/3
    path = adaptive(ending, ending.constants([1.0]), 0.0, [1.0], 2.0, 1e-8, [1.0], method)
    assert path.status in ("step_too_small", "not_finite")
    assert path.times[-1] == pytest.approx(2.0 / 3.0, abs=1e-3)
    field = van_der_pol()
    control = ErrorControl(1e-8, [1.0, 1.0], max_steps=7)
    path = controlled(field, field.constants([1.0]), 0.0, [2.0, 0.0], 50.0, control, method)
    assert (path.status, len(path.times)) == ("too_many_steps", 8)
    path = adaptive(field, field.constants([1.0]), 0.0, [np.nan, 0.0], 50.0, 1e-8, [1.0, 1.0], method)
    assert (path.status, len(path.times)) == ("not_finite", 1)


@pytest.mark.parametrize("method", METHODS)
def test_a_frozen_grid_that_cannot_be_followed_gives_nan(method: str) -> None:
    field = field_of(lambda t, x, p: [p[0] * x[0] ** 2], 1, 1)
    states = along(field, field.constants([1.0]), np.linspace(0.0, 2.0, 9), [1.0], method)
    assert np.all(np.isfinite(states[:3]))
    assert np.isnan(states[-1, 0]) or abs(states[-1, 0]) > 1.0  # never the value 1 / (1 - 2) by chance


@pytest.mark.parametrize("method", METHODS)
def test_a_stiff_motion_ends_on_the_slow_one_that_it_is_drawn_to(method: str) -> None:
    """y' = -1e8 (y - cos t) from 0: after some 1e-7 s it is cos t, but for 1e-8 of its rate."""
    field = field_of(lambda t, x, p: [-p[0] * (x[0] - np.cos(t))], 1, 1)
    path = adaptive(field, field.constants([1e8]), 0.0, [0.0], 1.0, 1e-6, [1.0], method)
    assert path.status == "ok"
    assert path.states[-1, 0] == pytest.approx(np.cos(1.0), abs=1e-6)
