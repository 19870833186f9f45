"""Lorenz, FitzHugh-Nagumo and a forced Duffing oscillator as text, function, SymPy and plugin: one result."""

from __future__ import annotations

import math

import pytest
import sympy as sp

import contwalk as cw
from contwalk.system import Mode, Parameter, State, System

x, y, z, t = sp.symbols("x y z t")
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
CASES = {
    # The Hopf point at r = s (s + b + 3) / (s - b - 1).
    "lorenz": (LORENZ, "r", (15, 30), {"x": 7.0, "y": 7.0, "z": 19.0}, ["EP", "HB", "EP"]),
    "nerve": (NERVE, "I", (0, 2), {"x": -1.2, "y": -0.6}, ["EP", "HB", "HB", "EP"]),
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
