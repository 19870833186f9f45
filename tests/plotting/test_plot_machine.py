"""The machine as its plugin draws it."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.errors import ContwalkError, PluginError
from contwalk.plotting import new_axes, plot_machine, units_of
from contwalk.system import Mode, Parameter, State, System


def swing(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -np.sin(x[0]) / p.length


def draw(axes, t, x, p):
    axes.plot([0.0, p.length * np.sin(x[0])], [0.0, -p.length * np.cos(x[0])], "o-", gid="rod")


def pendulum(draw=draw):
    return System(
        "pendulum",
        states=(State("phi", "rad"), State("phi_dot", "rad/s")),
        parameters=(Parameter("length", 2.0, "m"), Parameter("damping", 0.1, "N m s")),
        modes=(Mode("swinging", swing),),
        draw=draw,
    )


@pytest.mark.parametrize("state", [[np.pi / 2, 0.0], {"phi_dot": 0.0, "phi": np.pi / 2}])
def test_draw_gets_the_state_and_all_parameters(state):
    ax = plot_machine(pendulum(), state, {"length": 3.0}, title="hanging")
    (rod,) = ax.lines
    np.testing.assert_allclose(rod.get_xdata(), [0.0, 3.0])
    assert ax.get_title(loc="left") == "hanging"
    assert ax.get_aspect() == 1.0


def test_defaults_fill_in_parameters_and_axes_may_be_given():
    ax = new_axes("machine")
    assert plot_machine(pendulum(), [np.pi / 2, 0.0], {}, ax=ax) is ax
    np.testing.assert_allclose(ax.lines[0].get_xdata(), [0.0, 2.0])


def test_a_system_without_draw_is_told_how_to_get_one():
    with pytest.raises(ContwalkError, match=r"declares no draw.*def draw|draw\(axes, t, x, p\)"):
        plot_machine(pendulum(draw=None), [0.0, 0.0], {})


@pytest.mark.parametrize(
    ("state", "parameters", "words"),
    [
        ([0.0], {}, r"shape \(1,\)"),
        ({"phi": 0.0}, {}, "lacks phi_dot"),
        ({"phi": 0.0, "phy_dot": 0.0}, {}, "Did you mean 'phi_dot'"),
        ([0.0, 0.0], {"lenght": 1.0}, "Did you mean 'length'"),
    ],
)
def test_what_does_not_fit_the_system_is_refused(state, parameters, words):
    with pytest.raises(ContwalkError, match=words):
        plot_machine(pendulum(), state, parameters)


def test_an_error_in_draw_names_its_line():
    def broken(axes, t, x, p):
        axes.plot(1.0 / 0.0)

    with pytest.raises(PluginError, match=r"test_plot_machine.py, line \d+: ZeroDivisionError"):
        plot_machine(pendulum(draw=broken), [0.0, 0.0], {})


def test_units_of_a_system():
    units = {"period": "s", "phi": "rad", "phi_dot": "rad/s", "length": "m", "damping": "N m s"}
    assert units_of(pendulum()) == units
