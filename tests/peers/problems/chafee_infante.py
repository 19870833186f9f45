"""Chafee-Infante by differences."""

import math

from peers.form import FORTY_DIGITS, Peer, Study, Value

from contwalk.system import Mode, Parameter, Start, State, System

N = 11  # inner points


def field(t, x, p, dx):
    h = math.pi / (N + 1)
    for i in range(N):
        left = x[i - 1] if i > 0 else 0.0
        right = x[i + 1] if i < N - 1 else 0.0
        dx[i] = (left - 2 * x[i] + right) / h**2 + p.lam * (x[i] - x[i] ** 3)


SYSTEM = System(
    name="chafee_infante",
    states=tuple(State(f"u{i + 1}") for i in range(N)),
    parameters=(Parameter("lam", 0.5),),
    modes=(Mode("smooth", field),),
    starts=(Start("rest", lambda p: [[0.0] * N]),),
    reference=(
        "Chafee & Infante (1974), Appl. Anal. 4, 17; closed form (2 (N + 1) sin(k pi / (2 (N + 1))) / pi)^2"
    ),
)

PEER = Peer(
    "Chafee-Infante by differences",
    SYSTEM.reference,
    (
        Study(
            "",
            {"start": {"equilibrium": "rest"}, "continue": {"parameter": "lam", "range": [0.5, 12.0]}},
            values=(
                Value("BP", 0.9943014562635543, 1e-15, FORTY_DIGITS, kind="pitchfork"),
                Value("BP", 3.9094458239707035, 1e-15, FORTY_DIGITS, kind="pitchfork"),
                Value("BP", 8.546770831966052, 1e-15, FORTY_DIGITS, kind="pitchfork"),
            ),
        ),
    ),
)
