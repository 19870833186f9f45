"""Mass on a moving belt, with friction that falls with the velocity at first: a Stribeck curve.

x'' + 2 beta x' + x = mu(v_b - x') with mu(v) = s - 3/2 (s - m) (v/w - (v/w)^3 / 3), which falls from the
static s to the least m at v = w. At rest mu' + 2 beta = 0 is a Hopf point. The cycle grows until its velocity
comes to that of the belt; on a slower belt the mass sticks once in a period.
"""

import math

from peers.form import CLOSED_FORM, SHOOTING, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition

FASTEST, STATIC, LEAST, BETA = 0.5, 0.4, 0.25, 0.05


def friction(v, p):
    r = v / p.w
    return p.s - 1.5 * (p.s - p.m) * (r - r * r * r / 3.0)


def slower(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = friction(p.v_b - x[1], p) - x[0] - 2.0 * p.beta * x[1]


def faster(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -friction(x[1] - p.v_b, p) - x[0] - 2.0 * p.beta * x[1]


def held(t, x, p, dx):
    dx[0] = p.v_b
    dx[1] = 0.0 * x[1]


def relative(t, x, p):
    return x[1] - p.v_b


def pull(t, x, p):
    """What friction has to hold."""
    return x[0] + 2.0 * p.beta * p.v_b


def stick(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], p.v_b


SYSTEM = System(
    name="stribeck",
    states=(State("x"), State("v")),
    parameters=(
        Parameter("v_b", 0.6),
        Parameter("w", FASTEST),
        Parameter("s", STATIC),
        Parameter("m", LEAST),
        Parameter("beta", BETA),
    ),
    modes=(Mode("slower", slower), Mode("stick", held), Mode("faster", faster)),
    transitions=(
        Transition("sticks", "slower", "stick", relative, "rising", reset=stick),
        Transition("catches", "faster", "stick", relative, "falling", reset=stick),
        Transition("slips", "stick", "slower", lambda t, x, p: pull(t, x, p) - p.s, "rising", level=True),
        Transition("runs", "stick", "faster", lambda t, x, p: pull(t, x, p) + p.s, "falling", level=True),
    ),
    reference="Thomsen & Fidlin (2003), Int. J. Non-Linear Mech. 38, 389",
)

TOUCHING = 0.395790288798  # the belt's velocity that the cycle's comes up to

PEER = Peer(
    "Friction oscillator on a belt, Stribeck curve",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"x": 0.25, "v": 0.0}},
                "continue": {"parameter": "v_b", "range": [0.02, 0.7]},
                "events": {"GR": "switch", "OC": "switch"},
                "diagram": {"follow": ["HB"], "depth": 3},
            },
            values=(
                Value(
                    "HB",
                    FASTEST * math.sqrt(1.0 - 4.0 * BETA * FASTEST / (3.0 * (STATIC - LEAST))),
                    1e-15,
                    CLOSED_FORM,
                    criticality="supercritical",
                ),
                Value("GR", TOUCHING, 1e-12, SHOOTING, of="orbit", kind="interior"),
            ),
        ),
    ),
)
