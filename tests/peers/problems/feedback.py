"""Feedback control of Lur'e type."""

from peers.form import COLLOCATION, FORTY_DIGITS, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = x[2]
    dx[2] = -p.alpha * x[2] - p.beta * x[1] - x[0] + x[0] ** 2


SYSTEM = System(
    name="feedback",
    states=(
        State("x"),
        State("y"),
        State("z"),
    ),
    parameters=(
        Parameter("alpha", 1.0),
        Parameter("beta", 0.5),
    ),
    modes=(Mode("smooth", field),),
    reference="Genesio & Tesi (1992); Kuznetsov (2004), example 5.4 and MatCont's adaptx",
)

PEER = Peer(
    "Feedback control of Lur'e type",
    SYSTEM.reference,
    (
        Study(
            "beta",
            {
                "start": {"state": {"x": 0, "y": 0, "z": 0}},
                "parameters": {"beta": 1.5},
                "continue": {"parameter": "beta", "range": [0.3, 2.0]},
                "diagram": {"depth": 3},
            },
            values=(
                Value("HB", 1.0, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("PD", 0.6273246300697478, 1e-13, COLLOCATION, of="orbit"),
                Value("PD", 0.5417461091063729, 1e-13, COLLOCATION, of="orbit"),
            ),
            # the doubled orbits end where they began to double
            real=(Value("BP", 0.5417461091063729, 1e-13, COLLOCATION, of="orbit"),),
            endings=(
                Ending(
                    "homoclinic",
                    "unstable manifold of x = 1, Runge-Kutta steps of 0.01",
                    0.515489273016,
                    1e-8,
                ),
            ),
        ),
    ),
)
