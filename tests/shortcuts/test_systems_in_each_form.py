"""The same systems as text, function, SymPy and plugin, and a ball that bounces as text and plugin."""

from __future__ import annotations

import math

import pytest
import sympy as sp

import contwalk as cw
from contwalk.system import Mode, Parameter, State, System

x, y, z, t, v, m, h, n = sp.symbols("x y z t v m h n")
s_, r_, b_, i_, g_, w_ = sp.symbols("s r b I g w")


def lorenz_field(t, u, p, du):
    du[0] = p.s * (u[1] - u[0])
    du[1] = u[0] * (p.r - u[2]) - u[1]
    du[2] = u[0] * u[1] - p.b * u[2]


@cw.model(s=10.0, r=20.0, b=8 / 3)
def lorenz(x, y, z, *, s, r, b):
    return s * (y - x), x * (r - z) - y, x * y - b * z


def nerve_field(t, u, p, du):
    du[0] = u[0] - u[0] ** 3 / 3 - u[1] + p.I
    du[1] = 0.08 * (u[0] + 0.7 - 0.8 * u[1])


@cw.model(I=0.0)
def nerve(x, y, *, I):  # noqa: E741  (its name in the field)
    return x - x**3 / 3 - y + I, 0.08 * (x + 0.7 - 0.8 * y)


def duffing_field(t, u, p, du):
    du[0] = u[1]
    du[1] = -0.1 * u[1] - u[0] - u[0] ** 3 + p.g * math.cos(p.w * t)


@cw.model(g=0.3, w=0.8, period=lambda w: 2 * math.pi / w)
def duffing(t, x, y, *, g, w):
    return y, -0.1 * y - x - x**3 + g * math.cos(w * t)


def membrane(exp, v, m, h, n, I):  # noqa: E741
    """Hodgkin & Huxley (1952), with the voltage from rest: rates of v, m, h, n."""
    sodium, potassium = 120 * m**3 * h * (v - 115), 36 * n**4 * (v + 12)
    return (
        I - sodium - potassium - 0.3 * (v - 10.599),
        0.1 * (25 - v) / (exp((25 - v) / 10) - 1) * (1 - m) - 4 * exp(-v / 18) * m,
        0.07 * exp(-v / 20) * (1 - h) - 1 / (exp((30 - v) / 10) + 1) * h,
        0.01 * (10 - v) / (exp((10 - v) / 10) - 1) * (1 - n) - 0.125 * exp(-v / 80) * n,
    )


def axon_field(t, u, p, du):
    du[0], du[1], du[2], du[3] = membrane(math.exp, u[0], u[1], u[2], u[3], p.I)


@cw.model(I=0.0)
def axon(v, m, h, n, *, I):  # noqa: E741
    return membrane(math.exp, v, m, h, n, I)


def plugin(name, states, values, field, **more):
    parameters = tuple(Parameter(key, value) for key, value in values.items())
    modes = (Mode("only", field),)
    return System(name, states=tuple(map(State, states)), parameters=parameters, modes=modes, **more)


LORENZ = (
    cw.system_from_text("x' = s*(y-x); y' = x*(r-z)-y; z' = x*y-b*z; s = 10; r = 20; b = 8/3"),
    lorenz,
    cw.system_from_sympy(
        [x, y, z], [s_ * (y - x), x * (r_ - z) - y, x * y - b_ * z], {s_: 10, r_: 20, b_: 8 / 3}
    ),
    plugin("lorenz", "xyz", {"s": 10.0, "r": 20.0, "b": 8 / 3}, lorenz_field),
)
NERVE = (
    cw.system_from_text("x' = x-x^3/3-y+I; y' = 0.08*(x+0.7-0.8*y); I = 0"),
    nerve,
    cw.system_from_sympy([x, y], [x - x**3 / 3 - y + i_, 0.08 * (x + 0.7 - 0.8 * y)], {i_: 0.0}),
    plugin("nerve", "xy", {"I": 0.0}, nerve_field),
)
DUFFING = (
    cw.system_from_text("x' = y; y' = -0.1*y-x-x^3+g*cos(w*t); g = 0.3; w = 0.8; period = 2*pi/w"),
    duffing,
    cw.system_from_sympy(
        [x, y],
        [y, -sp.Rational(1, 10) * y - x - x**3 + g_ * sp.cos(w_ * t)],
        {g_: 0.3, w_: 0.8},
        period=2 * sp.pi / w_,
    ),
    plugin("duffing", "xy", {"g": 0.3, "w": 0.8}, duffing_field, period=lambda p: 2 * math.pi / p.w),
)
AXON = (
    cw.system_from_text(
        """
        v' = I - 120*m^3*h*(v-115) - 36*n^4*(v+12) - 0.3*(v-10.599)
        m' = 0.1*(25-v)/(exp((25-v)/10)-1)*(1-m) - 4*exp(-v/18)*m
        h' = 0.07*exp(-v/20)*(1-h) - h/(exp((30-v)/10)+1)
        n' = 0.01*(10-v)/(exp((10-v)/10)-1)*(1-n) - 0.125*exp(-v/80)*n
        I = 0
        """
    ),
    axon,
    cw.system_from_sympy([v, m, h, n], list(membrane(sp.exp, v, m, h, n, i_)), {i_: 0.0}),
    plugin("axon", "vmhn", {"I": 0.0}, axon_field),
)
CASES = {
    # The Hopf point at r = s (s + b + 3) / (s - b - 1).
    "lorenz": (LORENZ, "r", (15, 30), {"x": 7.0, "y": 7.0, "z": 19.0}, ["EP", "HB", "EP"]),
    "nerve": (NERVE, "I", (0, 2), {"x": -1.2, "y": -0.6}, ["EP", "HB", "HB", "EP"]),
    "axon": (AXON, "I", (0, 200), {"v": 0.0, "m": 0.05, "h": 0.6, "n": 0.3}, ["EP", "HB", "HB", "EP"]),
    "duffing": (
        DUFFING,
        "w",
        (0.8, 2.0),
        {"simulate": {"state": {"x": 0.0, "y": 0.0}}},
        ["EP", "LP", "LP", "EP"],
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_each_form_has_the_same_points(name):
    systems, parameter, between, start, labels = CASES[name]
    found = []
    for system in systems:
        branch = cw.diagram(system, parameter, between, start=start, diagram="none")["b1"]
        assert [point.label for point in branch.special_points] == labels
        found.append([point.parameters[parameter] for point in branch.special_points])
    for other in found[1:]:
        assert other == pytest.approx(found[0], rel=1e-9)
    if name == "lorenz":
        assert found[0][1] == pytest.approx(470 / 19, rel=1e-12)
    if name == "axon":  # the values of tests/peers/problems/hodgkin_huxley.py
        assert found[0][1:3] == pytest.approx([9.779637995393122, 154.52663366580802], rel=1e-12)


def test_a_ball_as_text_is_the_plugin():
    """Fold and period doubling of one bounce a period: the closed forms of docs/systems/bouncing_ball.md."""
    text = cw.system_from_text(
        """
        y' = v; v' = -g
        A = 0.01; omega = 35; e = 0.5; g = 9.81
        period = 2*pi/omega
        event bounce: y - A*sin(omega*t) falls, v = -e*v + (1 + e)*A*omega*cos(omega*t)
        """
    )
    start = {"simulate": {"state": {"y": 0.0158, "v": -0.7435}, "until": "settled"}}
    least = math.pi / 3  # pi (1 - e) / (1 + e)
    most = math.hypot(least, 10 / 9)  # 2 (1 + e^2) / (1 + e)^2
    for system in (text, "bouncing_ball"):
        given = {"parameters": {"A": 0.0095}, "start": start, "diagram": "none"}
        branch = cw.diagram(system, "A", (0.008, 0.0125), **given)["b1"]
        points = {point.label: point for point in branch.special_points}
        assert branch.info.signature == ("bounce",)
        assert points["LP"].parameters["A"] == pytest.approx(9.81 * least / 35**2, rel=1e-9)
        assert points["PD"].parameters["A"] == pytest.approx(9.81 * most / 35**2, rel=1e-9)
