"""Koper's extended van der Pol equations."""

from peers.form import COLLOCATION, FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = (p.k * x[1] - x[0] ** 3 + 3 * x[0] - p.lam) / p.eps1
    dx[1] = x[0] - 2 * x[1] + x[2]
    dx[2] = p.eps2 * (x[1] - x[2])


SYSTEM = System(
    name="koper",
    states=(
        State("x"),
        State("y"),
        State("z"),
    ),
    parameters=(
        Parameter("lam", 2.0),
        Parameter("k", -10.0),
        Parameter("eps1", 0.1),
        Parameter("eps2", 1.0),
    ),
    modes=(Mode("smooth", field),),
    reference="Koper (1995), Physica D 80, 72",
)

PEER = Peer(
    "Koper's extended van der Pol equations",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "parameters": {"lam": -10.0},
                "start": {"state": {"x": -1.5, "y": -1.5, "z": -1.5}},
                "continue": {"parameter": "lam", "range": [-10.0, 10.0]},
                "diagram": {"depth": 1},
            },
            values=(
                Value("HB", -7.669551383891134, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("HB", 7.669551383891134, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("PD", -7.460881809724862, 1e-13, COLLOCATION, of="orbit"),
                Value("PD", -6.23500432079248, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", -6.235004318137131, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", -6.283951157189849, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", 6.283951157189848, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", 6.23500431813713, 1e-13, COLLOCATION, of="orbit"),
                Value("PD", 6.235004320792478, 1e-13, COLLOCATION, of="orbit"),
                Value("PD", 7.460881809724862, 1e-13, COLLOCATION, of="orbit"),
            ),
            slow=True,
        ),
    ),
)
