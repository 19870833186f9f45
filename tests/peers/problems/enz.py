"""AUTO enz: two coupled cells with an enzyme."""

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = (p.s0 - x[0]) + (x[1] - x[0]) - p.rho * x[0] / (1 + x[0] + p.kappa * x[0] ** 2)
    dx[1] = (p.s0 + p.mu - x[1]) + (x[0] - x[1]) - p.rho * x[1] / (1 + x[1] + p.kappa * x[1] ** 2)


SYSTEM = System(
    name="enz",
    states=(
        State("s1"),
        State("s2"),
    ),
    parameters=(
        Parameter("s0", 0.0),
        Parameter("mu", 0.0),
        Parameter("rho", 100.0),
        Parameter("kappa", 1.0),
    ),
    modes=(Mode("smooth", field),),
    reference="AUTO-07p (Doedel et al.), demo enz",
)

PEER = Peer(
    "AUTO enz: two coupled cells with an enzyme",
    SYSTEM.reference,
    (
        Study(
            "",
            {"start": {"state": {"s1": 0, "s2": 0}}, "continue": {"parameter": "s0", "range": [0.0, 40.0]}},
            values=(
                Value("LP", 34.356924998526196, 1e-15, FORTY_DIGITS),
                Value("BP", 34.22288654419019, 1e-15, FORTY_DIGITS, kind="pitchfork"),
                Value("BP", 22.181637926124232, 1e-15, FORTY_DIGITS, kind="pitchfork"),
                Value("LP", 18.88706765792426, 1e-15, FORTY_DIGITS),
                Value("LP", 25.372714838124004, 1e-15, FORTY_DIGITS, times=2),
                Value("LP", 26.62207177004492, 1e-15, FORTY_DIGITS, times=2),
            ),
        ),
    ),
)
