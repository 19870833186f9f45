"""Pest control by natural enemies that are released at regular times."""

from peers.form import CLOSED_FORM, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition

PEST, ENEMY, CLOCK = range(3)


def field(t, x, p, dx):
    dx[PEST] = x[PEST] * (p.r - p.a * x[PEST] - p.b * x[ENEMY])
    dx[ENEMY] = x[ENEMY] * (p.c * x[PEST] - p.d)
    dx[CLOCK] = 1.0


def time_left(t, x, p):
    return p.T - x[CLOCK]


def release(t, x, p, x_plus):
    x_plus[PEST], x_plus[ENEMY], x_plus[CLOCK] = x[PEST], x[ENEMY] + p.m, 0.0


SYSTEM = System(
    name="pest_control",
    states=(State("pest", scale=1.0), State("enemy"), State("clock")),
    parameters=(
        Parameter("r", 1.0),
        Parameter("a", 1.0),
        Parameter("b", 1.2),
        Parameter("c", 0.5),
        Parameter("d", 0.4),
        Parameter("m", 0.8),
        Parameter("T", 2.0),
    ),
    modes=(Mode("growing", field),),
    transitions=(Transition("release", "growing", "growing", time_left, reset=release),),
    reference="Liu, Teng & Chen (2006); Liu & Chen (2003), Chaos Solitons Fractals 16, 311: b m = r d T",
)

PEER = Peer(
    "Pest control",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {
                    "simulate": {"state": {"pest": 0.0, "enemy": 1.5, "clock": 0.0}, "until": "settled"}
                },
                "continue": {"parameter": "m", "range": [0.3, 1.0]},
                "diagram": {"depth": 1},
            },
            values=(Value("BP", 2 / 3, 1e-15, CLOSED_FORM, of="orbit", kind="transcritical"),),
            long=True,
        ),
    ),
)
