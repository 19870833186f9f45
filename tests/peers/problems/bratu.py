"""Bratu's problem by differences."""

import math

from peers.form import FORTY_DIGITS, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, Start, State, System

N = 19  # inner points


def field(t, x, p, dx):
    h = 1 / (N + 1)
    for i in range(N):
        left = x[i - 1] if i > 0 else 0.0
        right = x[i + 1] if i < N - 1 else 0.0
        dx[i] = (left - 2 * x[i] + right) / h**2 + p.lam * math.exp(x[i])


SYSTEM = System(
    name="bratu",
    states=tuple(State(f"u{i + 1}") for i in range(N)),
    parameters=(Parameter("lam", 0.0),),
    modes=(Mode("smooth", field),),
    starts=(Start("rest", lambda p: [[0.0] * N]),),
    reference="Bratu (1914); AUTO-07p, demo exp; Frank-Kamenetskii (1955)",
)

PEER = Peer(
    "Bratu's problem by differences",
    SYSTEM.reference,
    (
        Study(
            "",
            {"start": {"equilibrium": "rest"}, "continue": {"parameter": "lam", "range": [0.0, 4.0]}},
            values=(Value("LP", 3.5092569575207877, 1e-15, FORTY_DIGITS),),
            endings=(Ending("unbounded", "u grows without bound as lam goes to zero", of="equilibrium"),),
        ),
    ),
)
