"""AUTO bvp: a nonlinear boundary value problem by differences."""

import math

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, Start, State, System

N = 15  # inner points


def field(t, x, p, dx):
    h = 1 / (N + 1)
    for i in range(N):
        left = x[i - 1] if i > 0 else 0.0
        right = x[i + 1] if i < N - 1 else 0.0
        dx[i] = (left - 2 * x[i] + right) / h**2 + (p.p1 * math.pi) ** 2 * x[i] - x[i] ** 2


SYSTEM = System(
    name="bvp",
    states=tuple(State(f"u{i + 1}") for i in range(N)),
    parameters=(Parameter("p1", 0.5),),
    modes=(Mode("smooth", field),),
    starts=(Start("rest", lambda p: [[0.0] * N]),),
    reference="AUTO-07p (Doedel et al.), demo bvp; closed form p = 2 (N + 1) sin(k pi / (2 (N + 1))) / pi",
)

PEER = Peer(
    "AUTO bvp: a nonlinear boundary value problem by differences",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"equilibrium": "rest"},
                "continue": {"parameter": "p1", "range": [0.5, 3.5]},
                "diagram": {"depth": 1},
            },
            values=(
                Value("BP", 0.9983943930356184, 1e-15, FORTY_DIGITS, kind="transcritical"),
                Value("BP", 1.9871737022884115, 1e-15, FORTY_DIGITS, kind="pitchfork"),
                Value("BP", 2.9568154424885225, 1e-15, FORTY_DIGITS, kind="transcritical"),
                Value("LP", 2.9194719294556375, 1e-15, FORTY_DIGITS),
            ),
        ),
    ),
)
