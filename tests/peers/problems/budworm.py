"""Outbreak of the spruce budworm."""

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = p.r * x[0] * (1 - x[0] / p.k) - x[0] ** 2 / (1 + x[0] ** 2)


SYSTEM = System(
    name="budworm",
    states=(State("x"),),
    parameters=(
        Parameter("r", 0.3),
        Parameter("k", 10.0),
    ),
    modes=(Mode("smooth", field),),
    reference="Ludwig, Jones & Holling (1978); Strogatz, Nonlinear Dynamics and Chaos, section 3.7",
)

PEER = Peer(
    "Outbreak of the spruce budworm",
    SYSTEM.reference,
    (
        Study(
            "",
            {"start": {"state": {"x": 0.5}}, "continue": {"parameter": "r", "range": [0.2, 0.8]}},
            values=(
                Value("LP", 0.5595250124456357, 1e-15, FORTY_DIGITS),
                Value("LP", 0.3839707316274608, 1e-15, FORTY_DIGITS),
            ),
        ),
    ),
)
