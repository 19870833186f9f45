"""Izhikevich's neuron: equilibria in closed form, and a spike that is reset at 30 mV.

With h = 0.04 v^2 + 5 v + 140 + I - u, u' = a (b v - u): equilibria have I = (b - 5) v - 0.04 v^2 - 140, the
fold is at v = (b - 5) / 0.08, and the Hopf point where the trace 0.08 v + 5 - a is zero.
"""

from fractions import Fraction

from peers.form import CLOSED_FORM, Peer, Study, Value

from contwalk.system import Mode, Parameter, Start, State, System, Transition


def field(t, x, p, dx):
    dx[0] = 0.04 * x[0] ** 2 + 5.0 * x[0] + 140.0 - x[1] + p.I
    dx[1] = p.a * (p.b * x[0] - x[1])


def below_peak(t, x, p):
    return 30.0 - x[0]


def after_spike(t, x, p, x_plus):
    x_plus[0], x_plus[1] = p.c, x[1] + p.d


SYSTEM = System(
    name="izhikevich",
    states=(State("v", unit="mV"), State("u", unit="mV")),
    parameters=(
        Parameter("I", -10.0),
        Parameter("a", 0.02),
        Parameter("b", 0.25),
        Parameter("c", -65.0, unit="mV"),
        Parameter("d", 6.0, unit="mV"),
    ),
    modes=(Mode("membrane", field),),
    transitions=(Transition("spike", "membrane", "membrane", below_peak, reset=after_spike),),
    starts=(
        Start(
            "rest",
            lambda p: [
                [v, p.b * v]
                for v in [((p.b - 5.0) - ((5.0 - p.b) ** 2 - 0.16 * (140.0 + p.I)) ** 0.5) / 0.08]
            ],
        ),
    ),
    reference="Izhikevich (2003), IEEE Trans. Neural Networks 14, 1569",
)


def current(slope: float) -> float:
    """The current of the equilibrium at which h_v = 0.08 v + 5 has this value.

    In fractions, of the numbers that the plugin holds for 0.04 and 0.25: terms of size 280 nearly cancel.
    """
    quadratic, b = Fraction(0.04), Fraction(0.25)
    v = (Fraction(slope) - 5) / (2 * quadratic)
    return float((b - 5) * v - quadratic * v**2 - 140)


SPIKE_MAP = (
    "map of u from spike to spike by SciPy's DOP853, its slope by Liouville's formula; Newton's method"
)

PEER = Peer(
    "Izhikevich's neuron",
    SYSTEM.reference,
    (
        Study(
            "rest",
            {
                "start": {"equilibrium": "rest"},
                "continue": {"parameter": "I", "range": [-20.0, 5.0]},
                "diagram": {"follow": "none"},
            },
            values=(
                Value("LP", current(0.25), 1e-15, CLOSED_FORM),
                Value("HB", current(0.02), 1e-15, CLOSED_FORM, criticality="subcritical"),
            ),
        ),
        Study(
            "bursts of five spikes",
            {
                "start": {"simulate": {"state": {"v": -65.0, "u": -10.0}, "until": "settled"}},
                "parameters": {"I": 10.0, "b": 0.2, "c": -50.0, "d": 2.0},
                # Beyond both points the orbits are canards, whose multiplier grows by ten orders within 1e-2.
                "continue": {"parameter": "d", "range": [1.6, 2.2], "stop_at": {"max_abs": 2.0}},
                "diagram": {"follow": "none"},
            },
            values=(
                Value("PD", 1.68953649705744, 1e-12, SPIKE_MAP, of="orbit"),
                Value("LP", 2.05680639540136, 1e-12, SPIKE_MAP, of="orbit"),
            ),
            long=True,
        ),
    ),
)
