"""Tangents are the derivatives of the steps that were made, coarse ones included."""

from __future__ import annotations

import numpy as np
import pytest
from flow_fields import compiled, lorenz

from contwalk import flow
from contwalk.problems.equilibrium.equations import Equations
from contwalk.system import load_system

METHODS = ("dop853", "verner98")
EVERY_METHOD = (*METHODS, "radau5", "radau9")
PARAMETERS = [10.0, 28.0, 8.0 / 3.0]
START = np.array([1.0, 2.0, 20.0])


@pytest.fixture(scope="module")
def field():
    return compiled(lorenz, 3, 3, columns=(1, 0))


def differences(at, h):
    """Central differences of fourth order."""
    return (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("steps", [8, 60])
def test_derivatives_of_the_steps(field, method, steps):
    """Eight steps are so coarse that the flow itself is far away: the derivative is that of the steps.

    Differences of fourth order with h = 1e-3 are off by h^4 and by rounding / h: 1e-11 or so, times the
    growth of perturbations.
    """
    times = np.linspace(0.0, 0.8, steps + 1)
    c = field.constants(PARAMETERS)
    _, found = flow.tangents(field, c, times, START, np.eye(3, 5), [-1, -1, -1, 0, 1], method)
    expected = np.empty((3, 5))
    for i in range(3):
        unit = np.eye(3)[i]
        expected[:, i] = differences(
            lambda s, unit=unit: flow.along(field, c, times, START + s * unit, method)[-1], 1e-3
        )
    for column, parameter in ((3, 1), (4, 0)):

        def at(s, parameter=parameter):
            shifted = np.array(PARAMETERS)
            shifted[parameter] += s
            return flow.along(field, field.constants(shifted), times, START, method)[-1]

        expected[:, column] = differences(at, 1e-3)
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("method", METHODS)
def test_volumes_shrink_by_the_divergence(field, method):
    """Liouville: the divergence of this field is constant, -(10 + 1 + 8/3)."""
    c = field.constants(PARAMETERS)
    path = flow.adaptive(field, c, 0.0, START, 1.0, 1e-13, [10.0] * 3, method)
    _, x = flow.tangents(field, c, path.times, START, np.eye(3), [-1] * 3, method)
    # the determinant cancels: its terms are a thousand times larger, each with errors of 1e-13
    expected = np.exp(-(10.0 + 1.0 + 8.0 / 3.0))
    assert abs(np.linalg.det(x) - expected) < 1e-8 * np.prod(np.linalg.norm(x, axis=0))
    assert abs(np.linalg.det(x) / expected - 1.0) < 1e-5


@pytest.mark.parametrize("method", METHODS)
def test_every_node(field, method):
    times = np.linspace(0.0, 0.5, 11)
    c = field.constants(PARAMETERS)
    start = np.array([[1.0, 0.0], [0.5, 0.0], [-2.0, 1.0]])
    states, x = flow.tangents(field, c, times, START, start, [-1, 0], method, every=True)
    assert states.shape == (11, 3)
    assert x.shape == (11, 3, 2)
    assert np.array_equal(x[0], start)
    for i in (0, 3, 10):
        last = flow.tangents(field, c, times[: i + 1], START, start, [-1, 0], method)
        assert np.array_equal(last[0], states[i])
        assert np.array_equal(last[1], x[i])


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 8, 9])
def test_columns_do_not_depend_on_their_company(field, count):
    """Whatever number of them is computed at once, each comes out the same, bitwise."""
    times = np.linspace(0.0, 0.5, 21)
    c = field.constants(PARAMETERS)
    start = np.random.default_rng(5).normal(size=(3, 9))
    sources = [-1, 0, 1, -1, 0, -1, 1, 1, -1]
    _, together = flow.tangents(field, c, times, START, start, sources)
    _, some = flow.tangents(field, c, times, START, start[:, :count], sources[:count])
    assert np.array_equal(some, together[:, :count])


def test_no_columns(field):
    c = field.constants(PARAMETERS)
    x, empty = flow.tangents(field, c, [0.0, 0.1], START, np.empty((3, 0)), [])
    assert np.array_equal(x, flow.along(field, c, [0.0, 0.1], START)[-1])
    assert empty.shape == (3, 0)


@pytest.mark.parametrize("method", METHODS)
def test_a_step_of_no_length_changes_nothing(field, method):
    """As where a leg is cut at an instant that is a step already."""
    c, given = field.constants(PARAMETERS), (START, np.eye(3, 4), [-1, -1, -1, 1], method)
    x, derivatives = flow.tangents(field, c, [0.0, 0.1, 0.2], *given)
    for times in ([0.0, 0.1, 0.1, 0.2], [0.0, 0.0, 0.1, 0.2], [0.0, 0.1, 0.2, 0.2]):
        again, moved = flow.tangents(field, c, times, *given)
        np.testing.assert_array_equal(again, x)
        np.testing.assert_array_equal(moved, derivatives)


@pytest.mark.parametrize("method", [*EVERY_METHOD, "gauss4"])
@pytest.mark.parametrize("columns", [0, 3, 5, 90])
def test_a_path_with_its_tangents_in_one_pass(field, method, columns):
    """The same steps, and the same derivatives of them, to the last bit; 90 columns go in a second pass."""
    c, rng = field.constants(PARAMETERS), np.random.default_rng(7)
    given = flow.Tangents(rng.normal(size=(3, columns)), ([0, 1, -1, -1, -1] * 18)[:columns])
    there = field, c, 0.0, START, 1.5, flow.ErrorControl(1e-7, np.array([10.0, 10.0, 20.0]))
    path = flow.controlled(*there, method)
    _, expected = flow.tangents(field, c, path.times, START, *given, method)
    found, derivatives = flow.adaptive_with_tangents(*there, given, method)
    assert found.times.tobytes() == path.times.tobytes()
    assert found.states.tobytes() == path.states.tobytes()
    assert (found.status, found.rejected) == ("ok", path.rejected)
    assert derivatives.tobytes() == expected.tobytes()


def test_a_driven_tangent_of_a_forced_field():
    """x' = -x + a cos t from 0: dx/da = (cos t + sin t - exp(-t)) / 2."""
    from math import cos

    driven = compiled(lambda t, x, p: [-x[0] + p[0] * cos(t)], 1, 1, columns=(0,))
    times = np.linspace(0.0, 3.0, 31)
    _, x = flow.tangents(driven, driven.constants([2.0]), times, [0.0], [[0.0]], [0], every=True)
    expected = (np.cos(times) + np.sin(times) - np.exp(-times)) / 2.0
    np.testing.assert_allclose(x[:, 0, 0], expected, atol=1e-13)  # steps of 0.1: truncation below rounding


def test_a_machine():
    """Eight states and a parameter, against differences along a random direction."""
    system = load_system("autobalancer", {"masses": 2})
    equations = Equations(system, "m")
    b = [system.defaults()[name] for name in system.parameter_names]
    machine = flow.Field(equations.program, [("u", i) for i in range(8)], {"l": 1, "b": len(b)}, [("l", 0)])
    rng = np.random.default_rng(11)
    x0, v, dm = rng.normal(0.0, 0.3, 8), rng.normal(size=8), 0.003
    c = machine.constants([0.01, *b])
    path = flow.adaptive(machine, c, 0.0, x0, 5.0, 1e-10, np.ones(8))
    _, x = flow.tangents(machine, c, path.times, x0, np.eye(8, 9), [-1] * 8 + [0])

    def at(s):
        return flow.along(machine, machine.constants([0.01 + s * dm, *b]), path.times, x0 + s * v)[-1]

    found = x @ [*v, dm]
    np.testing.assert_allclose(found, differences(at, 1e-3), rtol=1e-8, atol=1e-8 * np.abs(found).max())


@pytest.mark.parametrize("method", EVERY_METHOD)
def test_several_paths_at_once(field, method):
    """Each is the path alone, bitwise: its states, and the derivatives of its end."""
    times = [np.linspace(0.0, 0.2, 6), np.linspace(0.2, 0.3, 11), np.linspace(0.3, 0.31, 2)]
    starts = np.array([START, START + 1.0, 0.5 * START])
    c, columns, sources = field.constants(PARAMETERS), np.eye(3, 5), [-1, -1, -1, 0, 1]
    states, ends = flow.along_with_tangents(field, c, np.concatenate(times), starts, columns, sources, method)
    for t, x, own, end in zip(times, starts, np.split(states, [6, 17]), ends, strict=True):
        assert np.array_equal(own, flow.along(field, c, t, x, method))
        last, moved = flow.tangents(field, c, t, x, columns, sources, method)
        assert np.array_equal(own[-1], last)
        assert np.array_equal(end, moved)


def test_several_paths_need_a_start_each(field):
    times, c = np.array([0.0, 0.1, 0.1, 0.2]), field.constants(PARAMETERS)
    with pytest.raises(ValueError, match="starts"):
        flow.along_with_tangents(field, c, times, START[None], np.eye(3), [-1] * 3)


@pytest.mark.parametrize("method", EVERY_METHOD)
def test_several_paths_are_interpolated_at_once(field, method):
    """As each alone, bitwise; where two meet it is the later one's start."""
    times, c = [np.linspace(0.0, 0.2, 6), np.linspace(0.2, 0.3, 11)], field.constants(PARAMETERS)
    nodes = [flow.along(field, c, t, x, method) for t, x in zip(times, (START, 0.5 * START), strict=True)]
    found = flow.interpolation(field, c, np.concatenate(times), np.concatenate(nodes), method)
    for t, x in zip(times, nodes, strict=True):
        inside = np.linspace(t[0], t[-1], 50, endpoint=False)
        assert np.array_equal(found(inside), flow.interpolation(field, c, t, x, method)(inside))
    assert np.array_equal(found([0.2, 0.3]), [0.5 * START, nodes[1][-1]])
