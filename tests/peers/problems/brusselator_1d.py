"""Brusselator on a line by differences."""

from peers.form import CLOSED_FORM, Peer, Study, Value

from contwalk.system import Mode, Parameter, Start, State, System

N = 12  # inner points


def field(t, x, p, dx):
    h = p.L / (N + 1)
    for i in range(N):
        u, v = x[2 * i], x[2 * i + 1]
        left = x[2 * i - 2] if i > 0 else p.A
        right = x[2 * i + 2] if i < N - 1 else p.A
        below = x[2 * i - 1] if i > 0 else p.B / p.A
        above = x[2 * i + 3] if i < N - 1 else p.B / p.A
        dx[2 * i] = u**2 * v - (p.B + 1) * u + p.A + p.Dx * (left - 2 * u + right) / h**2
        dx[2 * i + 1] = -(u**2) * v + p.B * u + p.Dy * (below - 2 * v + above) / h**2


SYSTEM = System(
    name="brusselator_1d",
    states=tuple(State(f"{name}{i + 1}") for i in range(N) for name in "uv"),
    parameters=(
        Parameter("A", 2.0),
        Parameter("B", 5.45),
        Parameter("Dx", 0.008),
        Parameter("Dy", 0.004),
        Parameter("L", 0.3),
    ),
    modes=(Mode("smooth", field),),
    starts=(Start("rest", lambda p: [[p.A, p.B / p.A] * N]),),
    reference="Holodniok, Knedlík & Kubíček (1987); AUTO-07p, demos brf and brc",
)

PEER = Peer(
    "Brusselator on a line by differences",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"equilibrium": "rest"},
                "continue": {"parameter": "L", "range": [0.3, 2.2]},
                "diagram": {"follow": ["BP"], "depth": 1},
            },
            values=(
                Value("HB", 0.5117724939852191, 2e-15, CLOSED_FORM),
                Value("HB", 1.0160821925968397, 2e-15, CLOSED_FORM),
                Value("HB", 1.5055751248225626, 2e-15, CLOSED_FORM),
                Value("HB", 1.9731133814684467, 2e-15, CLOSED_FORM),
            ),
        ),
    ),
)
