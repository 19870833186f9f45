"""Third-order relay feedback with sliding: x' = A x + B u, u = -sign x1.

Crossing-sliding: half a period from (0, -1, x3), at the border of the sliding part of x1 = 0, leads to the
negative of that, E x0 + A^-1 (E - 1) B = -x0 with E = exp(A h): three equations for x3, h and zeta.
"""

import mpmath
from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition


def plant(x, p, dx, u):
    dx[0] = -(2.0 * p.zeta + 1.0) * x[0] + x[1] + u
    dx[1] = -(2.0 * p.zeta + 1.0) * x[0] + x[2] - 2.0 * u
    dx[2] = -x[0] + u


def above(t, x, p, dx):
    plant(x, p, dx, -1.0)


def below(t, x, p, dx):
    plant(x, p, dx, 1.0)


def slides(t, x, p, dx):
    plant(x, p, dx, -x[1])


def output(t, x, p):
    return x[0]


SYSTEM = System(
    name="relay_feedback",
    states=(State("x1"), State("x2"), State("x3")),
    parameters=(Parameter("zeta", 0.2),),
    modes=(Mode("slide", slides), Mode("plus", above), Mode("minus", below)),
    transitions=(
        Transition("comes_down", "plus", "slide", output, "falling"),
        Transition("comes_up", "minus", "slide", output, "rising"),
        Transition("leaves_up", "slide", "plus", lambda t, x, p: x[1] - 1.0, "rising", level=True),
        Transition("leaves_down", "slide", "minus", lambda t, x, p: x[1] + 1.0, "falling", level=True),
    ),
    reference="di Bernardo, Johansson & Vasca (2001), Int. J. Bifurcation Chaos 11, 1121",
)


def _conditions(x3, half, zeta):
    a = mpmath.matrix([[-(2 * zeta + 1), 1, 0], [-(2 * zeta + 1), 0, 1], [-1, 0, 0]])
    moved, start = mpmath.expm(a * half), mpmath.matrix([0, -1, x3])
    end = moved * start + mpmath.lu_solve(a, (moved - mpmath.eye(3)) * mpmath.matrix([1, -2, 1]))
    return list(end + start)


with mpmath.workdps(40):
    SLIDES = float(mpmath.findroot(_conditions, (-4.8, 3.72, 0.34))[2])

PEER = Peer(
    "Relay feedback of third order",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {
                    "simulate": {
                        "state": {"x1": 0.5, "x2": 0.0, "x3": 0.5},
                        "mode": "plus",
                        "until": "settled",
                    }
                },
                "continue": {"parameter": "zeta", "range": [0.1, 0.8]},
                "events": {"GR": "switch", "OC": "switch"},
                "diagram": {"follow": "none", "depth": 3},
            },
            values=(Value("OC", SLIDES, 1e-15, FORTY_DIGITS, of="orbit"),),
            long=True,
        ),
    ),
)
