"""Boost converter with its current's peak controlled: a clock switches on, the current at its reference off.

The diode keeps the current from turning round: it may stay zero until the next tick, in a mode in which it
does not exist.
"""

from peers.form import SHOOTING, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition

CURRENT, VOLTAGE, CLOCK = range(3)


def on(t, x, p, dx):
    dx[CURRENT] = p.E / p.L + 0.0 * x[CURRENT]
    dx[VOLTAGE] = -x[VOLTAGE] / (p.R * p.C)
    dx[CLOCK] = 1.0 + 0.0 * x[CLOCK]


def off(t, x, p, dx):
    dx[CURRENT] = (p.E - x[VOLTAGE]) / p.L
    dx[VOLTAGE] = x[CURRENT] / p.C - x[VOLTAGE] / (p.R * p.C)
    dx[CLOCK] = 1.0 + 0.0 * x[CLOCK]


def idle(t, x, p, dx):
    dx[VOLTAGE] = -x[VOLTAGE] / (p.R * p.C)
    dx[CLOCK] = 1.0 + 0.0 * x[CLOCK]


def clock(t, x, p):
    return p.T - x[CLOCK]


def tick(t, x, p, x_plus):
    x_plus[CURRENT], x_plus[VOLTAGE], x_plus[CLOCK] = x[CURRENT], x[VOLTAGE], 0.0 * x[CLOCK]


def tick_from_zero(t, x, p, x_plus):
    x_plus[CURRENT], x_plus[VOLTAGE], x_plus[CLOCK] = 0.0 * x[VOLTAGE], x[VOLTAGE], 0.0 * x[CLOCK]


def blocks(t, x, p, x_plus):
    x_plus[VOLTAGE], x_plus[CLOCK] = x[VOLTAGE], x[CLOCK]


SYSTEM = System(
    name="boost",
    states=(State("i", "A"), State("v", "V"), State("s", "s")),
    parameters=(
        Parameter("Iref", 0.4, "A"),
        Parameter("E", 5.0, "V"),
        Parameter("L", 1.5e-3, "H"),
        Parameter("C", 1e-5, "F"),
        Parameter("R", 40.0, "Ohm"),
        Parameter("T", 1e-4, "s"),
    ),
    modes=(Mode("on", on), Mode("off", off), Mode("idle", idle, states=("v", "s"))),
    transitions=(
        Transition("peak", "on", "off", lambda t, x, p: p.Iref - x[CURRENT], level=True),
        Transition("tick_off", "off", "on", clock, reset=tick),
        Transition("tick_on", "on", "on", clock, reset=tick),
        Transition("empty", "off", "idle", lambda t, x, p: x[CURRENT], reset=blocks),
        Transition("tick_idle", "idle", "on", clock, reset=tick_from_zero),
    ),
    reference="Tse & di Bernardo (2002), Proc. IEEE 90, 768",
)

PEER = Peer(
    "Boost converter",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {
                    "simulate": {"state": {"i": 0.2, "v": 7.0, "s": 0.0}, "mode": "on", "until": "settled"}
                },
                "continue": {"parameter": "Iref", "range": [0.15, 1.0]},
                "events": {"GR": "switch", "OC": "switch"},
                "diagram": {"depth": 2},
            },
            values=(
                Value("PD", 0.494256698369, 1e-12, SHOOTING, of="orbit", criticality="supercritical"),
                # The current comes to its reference just at a tick; beyond, it is on for all of the next.
                Value("OC", 0.643705585012, 1e-12, SHOOTING, of="orbit", kind="corner"),
            ),
            long=True,
        ),
    ),
)
