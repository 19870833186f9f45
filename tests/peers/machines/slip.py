"""Spring-mass runner: a mass on a spring without mass, which is set down at a given angle of attack.

Nothing is lost, so that steady running comes in families: at a given energy the height of the apex decides.
80 kg, 1 m, 20 kN/m and 5 m/s at an apex of 1 m are the human of the reference, who runs stably at 68 degrees.
"""

import math

from peers.form import Peer, Study, Value

from contwalk.system import Conserved, Mode, Parameter, State, System, Transition

X, Y, VX, VY = range(4)


def flight(t, x, p, dx):
    dx[Y], dx[VX], dx[VY] = x[VY], 0.0, -p.g


def stance(t, x, p, dx):
    push = p.k / p.m * (p.l0 / math.hypot(x[X], x[Y]) - 1.0)
    dx[X], dx[Y] = x[VX], x[VY]
    dx[VX], dx[VY] = push * x[X], push * x[Y] - p.g


def clearance(t, x, p):
    return x[Y] - p.l0 * math.sin(math.radians(p.alpha))


def stretch(t, x, p):
    return math.hypot(x[X], x[Y]) - p.l0


def set_down(t, x, p, after):
    after[X], after[Y] = -p.l0 * math.cos(math.radians(p.alpha)), x[Y]
    after[VX], after[VY] = x[VX], x[VY]


def in_flight(t, x, p):
    return 0.5 * p.m * (x[VX] ** 2 + x[VY] ** 2) + p.m * p.g * x[Y]


def in_stance(t, x, p):
    return in_flight(t, x, p) + 0.5 * p.k * (p.l0 - math.hypot(x[X], x[Y])) ** 2


SYSTEM = System(
    name="slip",
    states=(
        State("x", unit="m", about="from the foot"),
        State("y", unit="m"),
        State("vx", unit="m/s"),
        State("vy", unit="m/s"),
    ),
    parameters=(
        Parameter("m", 80.0, unit="kg"),
        Parameter("l0", 1.0, unit="m"),
        Parameter("k", 20000.0, unit="N/m"),
        Parameter("alpha", 68.0, unit="deg"),
        Parameter("g", 9.81, unit="m/s2"),
    ),
    modes=(Mode("flight", flight, states=("y", "vx", "vy")), Mode("stance", stance)),
    transitions=(
        Transition("touchdown", "flight", "stance", clearance, reset=set_down),
        Transition("takeoff", "stance", "flight", stretch, "rising"),
    ),
    conserved=(Conserved("energy", {"flight": in_flight, "stance": in_stance}, unit="J"),),
    reference="Seyfarth, Geyer, Günther & Blickhan (2002), J. Biomechanics 35, 649",
)

APEX_MAP = "map from apex to apex by SciPy's DOP853, its slope by variational equations; Newton's method"
START = {"simulate": {"state": {"y": 1.0, "vx": 5.0, "vy": 0.0}, "mode": "flight"}}

PEER = Peer(
    "Spring-mass runner",
    SYSTEM.reference,
    (
        Study(
            "at 1785 J",
            {
                "start": START,
                "continue": {"parameter": "alpha", "range": [64.0, 70.0]},
                "diagram": {"follow": "none"},
            },
            values=(
                Value("LP", 66.3054952322366, 1e-12, APEX_MAP, of="orbit"),
                Value("PD", 68.8535987891602, 1e-12, APEX_MAP, of="orbit"),
            ),
            long=True,
        ),
        Study(
            "at 68 degrees",
            {
                "start": START,
                "continue": {"parameter": "energy", "range": [1500.0, 2500.0]},
                "diagram": {"follow": "none"},
            },
            values=(
                Value("LP", 1580.52799910641, 1e-12, APEX_MAP, of="orbit"),
                Value("PD", 1996.16145003234, 1e-12, APEX_MAP, of="orbit"),
            ),
            long=True,
        ),
    ),
)
