"""Bipedal spring-mass walking: Geyer, Seyfarth & Blickhan (2006), Proc. R. Soc. B 273, 2861."""

import math

from contwalk.system import Conserved, Mode, Parameter, State, System, Transition

X, Y, VX, VY, D = range(5)


def push(x, y, p):
    return p.k / p.m * (p.l0 / math.hypot(x, y) - 1.0)


def single(t, x, p, dx):
    s = push(x[X], x[Y], p)
    dx[X], dx[Y] = x[VX], x[VY]
    dx[VX], dx[VY] = s * x[X], s * x[Y] - p.g


def double(t, x, p, dx):
    s = push(x[X], x[Y], p)
    f = push(x[X] - x[D], x[Y], p)
    dx[X], dx[Y] = x[VX], x[VY]
    dx[VX] = s * x[X] + f * (x[X] - x[D])
    dx[VY] = (s + f) * x[Y] - p.g
    dx[D] = 0.0


def foot_height(t, x, p):
    return x[Y] - p.l0 * math.sin(math.radians(p.alpha))


def rear_length(t, x, p):
    return p.l0 - math.hypot(x[X], x[Y])


def front_length(t, x, p):
    return p.l0 - math.hypot(x[X] - x[D], x[Y])


def set_down(t, x, p, after):
    after[X], after[Y], after[VX], after[VY] = x[X], x[Y], x[VX], x[VY]
    after[D] = x[X] + p.l0 * math.cos(math.radians(p.alpha))


def lift_rear(t, x, p, after):
    after[X], after[Y], after[VX], after[VY] = x[X] - x[D], x[Y], x[VX], x[VY]


def e_single(t, x, p):
    return (
        0.5 * p.m * (x[VX] ** 2 + x[VY] ** 2)
        + p.m * p.g * x[Y]
        + 0.5 * p.k * (p.l0 - math.hypot(x[X], x[Y])) ** 2
    )


def e_double(t, x, p):
    return e_single(t, x, p) + 0.5 * p.k * (p.l0 - math.hypot(x[X] - x[D], x[Y])) ** 2


SYSTEM = System(
    name="slipwalk",
    about="walking on two springs",
    states=(
        State("x", unit="m", about="hip from the rear foot"),
        State("y", unit="m", about="height of the hip"),
        State("vx", unit="m/s", about="forwards"),
        State("vy", unit="m/s", about="upwards"),
        State("d", unit="m", about="front foot from the rear foot"),
    ),
    parameters=(
        Parameter("m", 80.0, unit="kg", bounds=(1.0, None), about="mass"),
        Parameter("g", 9.81, unit="m/s2", bounds=(0.1, None), about="gravity"),
        Parameter("l0", 1.0, unit="m", bounds=(0.1, None), about="length of a leg"),
        Parameter("k", 14000.0, unit="N/m", bounds=(1.0, None), about="stiffness of a leg"),
        Parameter("alpha", 69.0, unit="deg", bounds=(1.0, 90.0), about="angle of attack"),
    ),
    modes=(Mode("single", single, states=("x", "y", "vx", "vy")), Mode("double", double)),
    transitions=(
        Transition("touchdown", "single", "double", foot_height, reset=set_down),
        Transition("takeoff", "double", "single", rear_length, reset=lift_rear),
        Transition("flies", "single", "single", rear_length, role="watched", about="stance leg would pull"),
        Transition(
            "front_pulls", "double", "double", front_length, role="watched", about="front leg would pull"
        ),
    ),
    conserved=(Conserved("energy", {"single": e_single, "double": e_double}, unit="J", about="in all"),),
    reference="Geyer, Seyfarth & Blickhan (2006), Proc. R. Soc. B 273, 2861-2867",
)
