"""Leaky integrate-and-fire neuron with a constant current: it fires ever more rarely, and no more at I = 1.

v' = I - v, and at v = 1 it becomes 0: the period is log(I / (I - 1)), without bound where the equilibrium
v = I comes to the threshold. Its only multiplier is that of the phase.
"""

import math

from peers.form import CLOSED_FORM, Ending, Peer, Study, Value
from peers.machines.forced_integrate_and_fire import below_threshold, fire

from contwalk.system import Mode, Parameter, State, System, Transition


def field(t, x, p, dx):
    dx[0] = p.current - x[0]


SYSTEM = System(
    name="leaky_neuron",
    states=(State("v"),),
    parameters=(Parameter("current", 1.5),),
    modes=(Mode("charging", field),),
    transitions=(Transition("spike", "charging", "charging", below_threshold, reset=fire),),
    reference="Gerstner & Kistler (2002), Spiking Neuron Models, section 4.1",
)

PERIODS = (0.5, 2.0)


def firing(period: float) -> float:
    """The current with which it fires once in a period."""
    return -1.0 / math.expm1(-period)


PEER = Peer(
    "Integrate-and-fire neuron",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"v": 0.0}, "until": "settled"}},
                "continue": {"parameter": "current", "range": [0.5, 3.0]},
                "mark": {"period": list(PERIODS)},
            },
            values=tuple(Value("UZ", firing(period), 1e-15, CLOSED_FORM, of="orbit") for period in PERIODS),
            endings=(Ending("homoclinic", CLOSED_FORM, 1.0),),
        ),
    ),
)
