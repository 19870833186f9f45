"""AUTO plp: an enzyme reaction with folds of cycles."""

from peers.form import COLLOCATION, FORTY_DIGITS, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    r = x[0] * x[1] / (1 + x[0] + p.k * x[0] ** 2)
    dx[0] = (p.s0 - x[0]) - p.rho * r
    dx[1] = p.al * (p.a0 - x[1]) - p.rho * r


SYSTEM = System(
    name="plp",
    states=(
        State("s"),
        State("a"),
    ),
    parameters=(
        Parameter("s0", 110.0),
        Parameter("a0", 500.0),
        Parameter("al", 0.2),
        Parameter("rho", 2.021628),
        Parameter("k", 0.1),
    ),
    modes=(Mode("smooth", field),),
    reference="AUTO-07p (Doedel et al.), demo plp",
)

PEER = Peer(
    "AUTO plp: an enzyme reaction with folds of cycles",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"state": {"s": 45.55974, "a": 177.7987}},
                "continue": {"parameter": "rho", "range": [2.0, 6.0]},
            },
            values=(
                Value("HB", 3.4999538279869022, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("HB", 4.6504578126027045, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", 2.7596874554986286, 3e-13, COLLOCATION, of="orbit"),
                Value("LP", 5.007839760762865, 1e-13, COLLOCATION, of="orbit"),
            ),
            endings=(Ending("shrunk", "the Hopf point at 4.650", 4.65045781, 2e-2),),
        ),
    ),
)
