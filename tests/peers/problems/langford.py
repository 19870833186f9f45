"""Langford's fold-Hopf system."""

from peers.form import COLLOCATION, FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = (p.lam - 1) * x[0] - p.omega * x[1] + x[0] * x[2]
    dx[1] = p.omega * x[0] + (p.lam - 1) * x[1] + x[1] * x[2]
    dx[2] = p.lam * x[2] - (x[0] ** 2 + x[1] ** 2 + x[2] ** 2)


SYSTEM = System(
    name="langford",
    states=(
        State("x"),
        State("y"),
        State("z"),
    ),
    parameters=(
        Parameter("lam", 0.2),
        Parameter("omega", 10.0),
    ),
    modes=(Mode("smooth", field),),
    reference=(
        "Langford (1979), SIAM J. Appl. Math. 37, 22; closed forms: cycles z = 1 - lam, r^2 = z (lam - z)"
    ),
)

PEER = Peer(
    "Langford's fold-Hopf system",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"x": 0, "y": 0, "z": 0.2}},
                "continue": {"parameter": "lam", "range": [0.1, 1.2]},
            },
            values=(
                Value("HB", 0.5, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("NS", 0.6666666666666476, 1e-13, COLLOCATION, of="orbit"),
            ),
            long=True,
        ),
    ),
)
