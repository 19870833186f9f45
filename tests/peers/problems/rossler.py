"""Rössler's band."""

from peers.form import COLLOCATION, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = -x[1] - x[2]
    dx[1] = x[0] + p.a * x[1]
    dx[2] = p.b + x[2] * (x[0] - p.c)


SYSTEM = System(
    name="rossler",
    states=(
        State("x"),
        State("y"),
        State("z"),
    ),
    parameters=(
        Parameter("a", 0.2),
        Parameter("b", 0.2),
        Parameter("c", 2.0),
    ),
    modes=(Mode("smooth", field),),
    reference="Rössler (1976), Phys. Lett. A 57, 397",
)

PEER = Peer(
    "Rössler's band",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"x": 1, "y": 1, "z": 0}, "until": "settled"}},
                "continue": {"parameter": "c", "range": [1.0, 5.0]},
                "diagram": {"depth": 3},
            },
            values=(
                Value("PD", 2.8324450278625393, 1e-13, COLLOCATION, of="orbit"),
                Value("PD", 3.8373581684101032, 1e-13, COLLOCATION, of="orbit"),
                Value("PD", 4.124214732075604, 4e-11, COLLOCATION, of="orbit"),
                Value("PD", 4.18699699939434, 3e-12, COLLOCATION, of="orbit"),
            ),
            long=True,
        ),
    ),
)
