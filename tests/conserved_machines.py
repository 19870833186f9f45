"""Machines that conserve their energy: a pendulum, Hénon-Heiles, a ball without losses."""

from __future__ import annotations

import math

from contwalk.system import Conserved, Mode, Parameter, State, System, Transition


def swings(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.g / p.l * math.sin(x[0])


def energy_of_pendulum(t, x, p):
    return 0.5 * p.l**2 * x[1] ** 2 + p.g * p.l * (1.0 - math.cos(x[0]))


PENDULUM = System(
    "pendulum",
    states=(State("q"), State("w")),
    parameters=(Parameter("g", 9.81), Parameter("l", 1.0)),
    modes=(Mode("swing", swings),),
    conserved=(Conserved("energy", energy_of_pendulum, "J/kg", "energy per mass"),),
)


def henon_heiles(t, x, p, dx):
    dx[0], dx[1] = x[2], x[3]
    dx[2] = -x[0] - 2.0 * p.k * x[0] * x[1]
    dx[3] = -x[1] - p.k * (x[0] ** 2 - x[1] ** 2)


def energy_of_henon_heiles(t, x, p):
    squares = x[0] ** 2 + x[1] ** 2 + x[2] ** 2 + x[3] ** 2
    return 0.5 * squares + p.k * (x[0] ** 2 * x[1] - x[1] ** 3 / 3.0)


HENON_HEILES = System(
    "henon_heiles",
    states=(State("x"), State("y"), State("u"), State("v")),
    parameters=(Parameter("k", 1.0),),
    modes=(Mode("only", henon_heiles),),
    conserved=(Conserved("energy", energy_of_henon_heiles),),
)


def falls(t, x, p, dx):
    dx[0], dx[1] = x[1], -p.g


def bounces(t, x, p, after):
    after[0], after[1] = x[0], -x[1]


def energy_of_ball(t, x, p):
    return 0.5 * x[1] ** 2 + p.g * x[0]


BALL = System(
    "ball",
    states=(State("y"), State("v")),
    parameters=(Parameter("g", 9.81),),
    modes=(Mode("flight", falls),),
    transitions=(Transition("bounce", "flight", "flight", lambda t, x, p: x[0], reset=bounces),),
    conserved=(Conserved("energy", energy_of_ball, "J/kg"),),
)
