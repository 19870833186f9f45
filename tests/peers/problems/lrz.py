"""AUTO lrz: the Lorenz equations."""

from peers.form import FORTY_DIGITS, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = p.sigma * (x[1] - x[0])
    dx[1] = p.rho * x[0] - x[1] - x[0] * x[2]
    dx[2] = x[0] * x[1] - p.beta * x[2]


SYSTEM = System(
    name="lrz",
    states=(
        State("x"),
        State("y"),
        State("z"),
    ),
    parameters=(
        Parameter("rho", 0.0),
        Parameter("beta", 2.6666666666666665),
        Parameter("sigma", 10.0),
    ),
    modes=(Mode("smooth", field),),
    reference="AUTO-07p (Doedel et al.), demo lrz; Lorenz (1963)",
)

PEER = Peer(
    "AUTO lrz: the Lorenz equations",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"x": 0, "y": 0, "z": 0}},
                "continue": {"parameter": "rho", "range": [0.0, 30.0]},
            },
            values=(
                Value("BP", 1.0, 1e-15, FORTY_DIGITS, kind="pitchfork"),
                Value("HB", 24.736842105263158, 1e-15, FORTY_DIGITS, criticality="subcritical", times=2),
            ),
            endings=(
                Ending(
                    "homoclinic",
                    "Sparrow (1982); shooting along the unstable manifold of the origin",
                    13.926557407,
                    1e-9,
                ),
            ),
            long=True,
        ),
    ),
)
