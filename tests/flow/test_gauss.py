"""Collocation at Gauss points: its numbers, its order for every degree, and what its steps are."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from flow_fields import compiled, forced, forced_flow, lorenz, van_der_pol
from small_flows import field_of

from contwalk.flow import (
    ErrorControl,
    Field,
    adaptive,
    along,
    along_with_tangents,
    controlled,
    errors_on,
    interpolation,
    tangents,
)
from contwalk.flow.tableaus.gauss import gauss_points

DEGREES = range(2, 8)
METHODS = tuple(f"gauss{2 * degree}" for degree in DEGREES)


def kepler() -> Field:
    def rates(t, x, p):
        cube = (x[0] ** 2 + x[1] ** 2) ** 1.5
        return [x[2], x[3], -p[0] * x[0] / cube, -p[0] * x[1] / cube]

    return field_of(rates, 4, 1)


@pytest.mark.parametrize("degree", range(2, 9))
def test_numbers_follow_from_the_definition(degree: int) -> None:
    """Zeros of the Legendre polynomial, and derivatives and values of the interpolating one, in 40 digits."""
    found = gauss_points(degree)
    with mpmath.workdps(40):
        shifted = [
            (mpmath.mpf(1) + mpmath.findroot(lambda x: mpmath.legendre(degree, x), 2 * c - 1)) / 2
            for c in found.nodes
        ]
        np.testing.assert_allclose(found.nodes, [float(c) for c in shifted], atol=2e-16)
        places = [mpmath.mpf(0), *shifted]
        for j in range(1, degree + 1):
            others = [places[k] for k in range(degree + 1) if k != j]

            def basis(x, others=others, own=places[j]):
                return mpmath.fprod((x - other) / (own - other) for other in others)

            assert found.end[j - 1] == pytest.approx(float(basis(mpmath.mpf(1))), rel=1e-13)
            for i in range(1, degree + 1):
                slope = float(mpmath.diff(basis, places[i]))
                assert found.inverse[i - 1, j - 1] == pytest.approx(slope, rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("degree", [1, 9])
def test_other_degrees_are_refused(degree: int) -> None:
    with pytest.raises(ValueError, match="2 to 8"):
        gauss_points(degree)


# Steps that are short enough for the order to be seen and long enough for errors above rounding.
COUNTS = {2: (40, 80), 3: (20, 40), 4: (14, 28), 5: (10, 20), 6: (5, 10), 7: (4, 8)}


@pytest.mark.parametrize("degree", DEGREES)
def test_order_on_the_kepler_problem(degree: int) -> None:
    """A planet of eccentricity 0.4: t = E - e sin E, x = cos E - e, y = sqrt(1 - e^2) sin E; order 2 s."""
    e, end = 0.4, 2.0
    with mpmath.workdps(30):
        anomaly = mpmath.findroot(lambda E: E - mpmath.mpf(e) * mpmath.sin(E) - end, end)
        truth = [
            float(mpmath.cos(anomaly) - e),
            float(mpmath.sqrt(1 - mpmath.mpf(e) ** 2) * mpmath.sin(anomaly)),
        ]
    field, start = kepler(), [1.0 - e, 0.0, 0.0, np.sqrt((1.0 + e) / (1.0 - e))]
    c, counts = field.constants([1.0]), COUNTS[degree]
    errors = [
        np.linalg.norm(
            along(field, c, np.linspace(0.0, end, n + 1), start, f"gauss{2 * degree}")[-1, :2] - truth
        )
        for n in counts
    ]
    assert errors[1] > 5e-14  # above rounding
    measured = np.log(errors[0] / errors[1]) / np.log(counts[1] / counts[0])
    assert measured == pytest.approx(2 * degree, abs=0.04 * 2 * degree)


@pytest.mark.parametrize("method", METHODS)
def test_between_nodes_it_is_as_exact_as_at_them(method: str) -> None:
    field = compiled(forced, 2, 0)
    c = field.constants([])
    path = adaptive(field, c, 0.0, [1.0, 1.0], 6.0, 1e-10, [1.0, 1.0], method)
    at = np.linspace(0.0, 6.0, 400)
    found = interpolation(field, c, path.times, path.states, method)(at)
    nodes = np.abs(path.states - forced_flow(path.times)).max()
    assert nodes < 5e-8
    assert np.abs(found - forced_flow(at)).max() < 3.0 * nodes + 1e-10
    again = interpolation(field, c, path.times, path.states, method)(path.times)
    assert np.array_equal(again, path.states)


@pytest.mark.parametrize("method", METHODS)
def test_steps_are_symmetric_in_time(method: str) -> None:
    """Back on the same steps from the end is the start again, to rounding: what grows there shrinks here."""
    field = compiled(van_der_pol, 2, 1)
    c, times = field.constants([0.3]), np.linspace(0.0, 8.0, 60)
    end = along(field, c, times, [2.0, 0.0], method)[-1]
    back = along(field, c, times[::-1], end, method)[-1]
    np.testing.assert_allclose(back, [2.0, 0.0], atol=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_what_grows_by_1e15_is_known_to_nine_digits(method: str) -> None:
    """x grows at a constant rate by 1e15, y shrinks by as much."""
    rate, degree = np.log(1e15), int(method[5:]) // 2
    field = field_of(lambda t, x, p: [p[0] * x[0], -p[0] * x[1]], 2, 1)
    steps = np.linspace(0.0, 1.0, {2: 3000, 3: 400, 4: 140}.get(degree, 80) + 1)
    _, moved = tangents(field, field.constants([rate]), steps, [0.0, 0.0], np.eye(2), [-1, -1], method)
    assert moved[0, 0] == pytest.approx(1e15, rel=1e-9)
    assert moved[0, 0] * moved[1, 1] == pytest.approx(1.0, rel=1e-12)  # by symmetry in time, exactly


@pytest.mark.parametrize("method", METHODS)
def test_a_given_grid_is_the_path_bit_for_bit(method: str) -> None:
    field = compiled(lorenz, 3, 3, columns=(1, 0))
    c, start = field.constants([10.0, 28.0, 8.0 / 3.0]), np.array([1.0, 2.0, 20.0])
    path = adaptive(field, c, 0.0, start, 1.0, 1e-8, [10.0] * 3, method)
    assert path.status == "ok"
    assert np.array_equal(along(field, c, path.times, start, method), path.states)
    half = len(path.times) // 2
    times = np.concatenate([path.times[: half + 1], path.times[half:]])
    states, ends = along_with_tangents(
        field, c, times, path.states[[0, half]], np.eye(3, 4), [-1, -1, -1, 0], method
    )
    assert np.array_equal(states, np.concatenate([path.states[: half + 1], path.states[half:]]))
    state, moved = tangents(
        field, c, path.times[half:], path.states[half], np.eye(3, 4), [-1, -1, -1, 0], method
    )
    assert np.array_equal(state, path.states[-1])
    assert np.array_equal(moved, ends[1])


@pytest.mark.parametrize("method", METHODS)
def test_derivatives_are_those_of_coarse_steps(method: str) -> None:
    field = compiled(lorenz, 3, 3, columns=(1, 0))
    values, start, times = (
        np.array([10.0, 28.0, 8.0 / 3.0]),
        np.array([1.0, 2.0, 20.0]),
        np.linspace(0.0, 0.8, 9),
    )
    c = field.constants(values)
    _, found = tangents(field, c, times, start, np.eye(3, 5), [-1, -1, -1, 0, 1], method)

    def end(column: int, s: float) -> np.ndarray:
        if column < 3:
            return along(field, c, times, start + s * np.eye(3)[column], method)[-1]
        moved = values + s * np.eye(3)[{3: 1, 4: 0}[column]]
        return along(field, field.constants(moved), times, start, method)[-1]

    h = 1e-3
    expected = np.column_stack(
        [(8.0 * (end(i, h) - end(i, -h)) - (end(i, 2 * h) - end(i, -2 * h))) / (12.0 * h) for i in range(5)]
    )
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-8 * np.abs(expected).max())


@pytest.mark.drawn(1)
@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
def test_errors_are_those_of_the_steps(method: str) -> None:
    """What one more point changes is the error of a step, to the part by which that is more exact."""
    field = compiled(forced, 2, 0)
    c, times = field.constants([]), np.linspace(0.0, 2.0, 5)
    told = errors_on(field, c, times, [1.0, 1.0], method, [1.0, 1.0])
    states = along(field, c, times, [1.0, 1.0], method)
    for k, (t, x) in enumerate(zip(times[:-1], states[:-1], strict=True)):
        end = adaptive(field, c, t, x, times[k + 1], 1e-15, [1.0, 1.0], "verner98").states[-1]
        error = float(np.linalg.norm(end - states[k + 1]) / np.sqrt(2.0))
        if error > 1e-12:
            assert told[k] == pytest.approx(error, rel=0.5)


@pytest.mark.parametrize("method", METHODS)
def test_stiff_steps_stay_bounded(method: str) -> None:
    """Steps of a hundred time constants: the method is A-stable."""
    field = field_of(lambda t, x, p: [p[0] * (1.0 - x[0])], 1, 1)
    c = field.constants([1e4])
    states = along(field, c, np.linspace(0.0, 1.0, 101), [0.0], method)
    assert np.all(np.abs(states - 1.0) <= 1.0)


def test_how_paths_end() -> None:
    pole = field_of(lambda t, x, p: [p[0] * x[0] ** 2], 1, 1)
    c = pole.constants([1.0])
    assert adaptive(pole, c, 0.0, [1.0], 2.0, 1e-8, [1.0], "gauss10").status in (
        "step_too_small",
        "not_finite",
    )
    control = ErrorControl(1e-8, [1.0], max_steps=2)
    assert controlled(pole, c, 0.0, [1.0], 0.9, control, "gauss10").status == "too_many_steps"
    root = field_of(lambda t, x, p: [-p[0] * np.sqrt(x[0])], 1, 1)
    ended = adaptive(root, root.constants([1.0]), 0.0, [-1.0], 1.0, 1e-8, [1.0], "gauss10")
    assert ended.status == "not_finite"
    assert not np.isfinite(along(root, root.constants([1.0]), [0.0, 1.0], [-1.0], "gauss10")[-1]).any()


@pytest.mark.parametrize("steps", [300, 700])
def test_paths_of_many_steps(steps: int) -> None:
    """More steps than memory is set aside for at first."""
    field = compiled(van_der_pol, 2, 1)
    c, end = field.constants([0.1]), 0.05 * steps
    path = adaptive(field, c, 0.0, [2.0, 0.0], end, 1e-11, [1e-3, 1e-3], "gauss4")
    assert path.status == "ok"
    assert len(path.times) > steps
    assert path.times[-1] == end


def test_a_state_that_stays_zero_costs_no_passes() -> None:
    field = field_of(lambda t, x, p: [p[0] * x[0], x[1]], 2, 1)
    path = adaptive(field, field.constants([-1.0]), 0.0, [0.0, 1.0], 1.0, 1e-10, [1.0, 1.0], "gauss10")
    assert path.status == "ok"
    assert np.array_equal(path.states[:, 0], np.zeros(len(path.times)))
    assert path.states[-1, 1] == pytest.approx(np.e, rel=1e-9)


@pytest.mark.parametrize("method", METHODS[2:])
def test_tolerances_below_rounding_are_no_reason_to_stop(method: str) -> None:
    """States of a thousand, in units of one: their roundings are far above the tolerance."""
    field = field_of(lambda t, x, p: [p[0] * (x[1] - 1000.0), 1000.0 - x[0]], 2, 1)
    start = [1001.0, 1000.0]
    path = adaptive(field, field.constants([1.0]), 0.0, start, 2.0 * np.pi, 3e-15, [1.0, 1.0], method)
    assert len(path.times) < 2000
    assert path.status == "ok"
    np.testing.assert_allclose(path.states[-1], start, rtol=1e-13)


@pytest.mark.parametrize("method", METHODS)
def test_a_state_that_is_zero_but_for_rounding_is_solved_apart_from_what_it_drives(method: str) -> None:
    """It grows as exp(t), and drives another, strongly: its equations are not mixed with those of that."""

    def rates(t, x, p):
        return [-x[1] + p[0] * x[2], x[0], x[2]]

    field = field_of(rates, 3, 1)
    times = np.linspace(0.0, 1.0, 5)
    states = along(field, field.constants([1e3]), times, [1.0, 0.0, 1e-33], method)
    assert np.all(np.isfinite(states))
    np.testing.assert_allclose(states[:, 2], 1e-33 * np.exp(times), rtol=1e-5, atol=0)


def test_what_is_zero_because_terms_cancel_is_solved() -> None:
    """Two masses opposite each other on a rotor leave nothing but the rounding of their pulls: as its rate,
    it is far more than the displacement itself, which that rate drives.
    """

    def rates(t, x, p):
        turned = [angle + p[0] * t for angle in x[2:4]]
        pull = p[0] ** 2 * (np.cos(turned[0]) + np.cos(turned[1])) - 0.1 * x[1] - x[0]
        rolls = [np.sin(angle) * pull - 0.5 * speed for angle, speed in zip(turned, x[4:], strict=True)]
        return [x[1], pull, x[4], x[5], *rolls]

    field, turn = field_of(rates, 6, 1), 2.0 * np.pi / 5.0
    constants = field.constants([5.0])
    for angle in np.linspace(0.1, 3.0, 20):
        for method in METHODS:
            start = [0.0, 0.0, angle, angle + np.pi, 0.0, 0.0]
            states = along(field, constants, np.linspace(0.0, turn, 21), start, method)
            assert np.all(np.abs(states[:, :2]) < 1e-13)
