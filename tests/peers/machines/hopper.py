"""Hopper with delayed thrust: a mass on a springy leg; some time after touchdown the leg is lengthened.

In flight y'' = -g; on the ground m y'' = F - m g with the leg's force F = -k (y - rest) - c y'. The rest
length is l until `delay` after touchdown and l + push then; the foot leaves the ground where F is zero.
"""

from peers.form import SHOOTING, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition

HEIGHT, SPEED, CLOCK = range(3)


def flies(t, x, p, dx):
    dx[HEIGHT], dx[SPEED] = x[SPEED], -p.g


def force(x, p):
    return -p.k * (x[HEIGHT] - p.l - p.longer * p.push) - p.c * x[SPEED]


def stands(t, x, p, dx):
    dx[HEIGHT], dx[SPEED] = x[SPEED], force(x, p) / p.m - p.g
    dx[CLOCK] = 1.0


def thrusts(t, x, p, dx):
    dx[HEIGHT], dx[SPEED] = x[SPEED], force(x, p) / p.m - p.g


def leg_above_ground(t, x, p):
    return x[HEIGHT] - p.l


def touches_down(t, x, p, x_plus):
    x_plus[HEIGHT], x_plus[SPEED], x_plus[CLOCK] = x[HEIGHT], x[SPEED], 0.0


def pushes_on_ground(t, x, p):
    return force(x, p)


def time_left(t, x, p):
    return p.delay - x[CLOCK]


SYSTEM = System(
    name="hopper",
    states=(State("y", "m"), State("v", "m/s"), State("clock", "s")),
    parameters=(
        Parameter("delay", 0.1, "s"),
        Parameter("push", 0.1, "m"),
        Parameter("k", 2000.0, "N/m"),
        Parameter("c", 20.0, "N s/m"),
        Parameter("m", 10.0, "kg"),
        Parameter("l", 0.7, "m"),
        Parameter("g", 9.81, "m/s2"),
    ),
    modes=(
        Mode("flight", flies, states=("y", "v")),
        Mode("stance", stands, constants={"longer": 0.0}),
        Mode("thrust", thrusts, states=("y", "v"), constants={"longer": 1.0}),
    ),
    transitions=(
        Transition("touchdown", "flight", "stance", leg_above_ground, reset=touches_down),
        Transition("thrust", "stance", "thrust", time_left),
        Transition("liftoff", "stance", "flight", pushes_on_ground),
        Transition("liftoff", "thrust", "flight", pushes_on_ground),
    ),
    reference="after Vakakis, Burdick & Caughey (1991), Int. J. Robotics Research 10, 606",
)

PEER = Peer(
    "Hopper with delayed thrust",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"y": 1.0, "v": 0.0, "clock": 0.0}, "until": "settled"}},
                "continue": {"parameter": "delay", "range": [0.01, 0.4]},
                "diagram": {"depth": 1},
            },
            values=(Value("OC", 0.2719861588289, 1e-12, SHOOTING, of="orbit", kind="crossing"),),
            endings=(Ending("order_change", "the foot leaves before the thrust", 0.2719861588289, 1e-8),),
        ),
    ),
)
