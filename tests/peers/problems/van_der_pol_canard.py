"""Van der Pol's canards: cycles that explode from small ones to relaxation oscillations and back."""

from peers.form import CLOSED_FORM, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = (x[1] - x[0] ** 3 / 3 + x[0]) / p.eps
    dx[1] = p.a - x[0]


SYSTEM = System(
    name="van_der_pol_canard",
    states=(
        State("x"),
        State("y"),
    ),
    parameters=(
        Parameter("a", 1.2),
        Parameter("eps", 0.1),
    ),
    modes=(Mode("smooth", field),),
    reference="Benoit, Callot, Diener & Diener (1981), Collect. Math. 32, 37",
)


def study(eps: float, long: bool) -> Study:
    """All cycles, from one Hopf point to the other: their parameter never turns."""
    return Study(
        f"eps={eps}",
        {
            "parameters": {"a": 1.2, "eps": eps},
            "start": {"state": {"x": 1.2, "y": -0.624}},
            "continue": {"parameter": "a", "range": [-1.5, 1.5], "max_points": 2000},
        },
        values=(
            Value("HB", -1.0, 1e-15, CLOSED_FORM, criticality="supercritical"),
            Value("HB", 1.0, 1e-15, CLOSED_FORM, criticality="supercritical"),
        ),
        endings=(Ending("shrunk", "the other Hopf point", 1.0, 1e-3),),
        slow=True,
        long=long,
    )


PEER = Peer("Van der Pol's canards", SYSTEM.reference, (study(0.1, False), study(0.02, True)))
