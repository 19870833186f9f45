"""Leaky integrate-and-fire neuron with a periodic current: 1:1 locking from fold to fold.

Between spikes v' = I + A sin(w t) - v; at v = 1 the neuron fires and v becomes 0. The stationary voltage
without a threshold is I + R sin(w t - d) with R = A / sqrt(1 + w^2). A neuron that fires once a period T,
at the phase s, has (I + R sin(w s - d)) (1 - e^-T) = 1; its multiplier is
e^-T v'(s before) / v'(s after), which is 1 where the sine is +-1.
"""

import math

from peers.form import CLOSED_FORM, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition


def field(t, x, p, dx):
    dx[0] = p.current + p.swing * math.sin(p.omega * t) - x[0]


def below_threshold(t, x, p):
    return 1.0 - x[0]


def fire(t, x, p, x_plus):
    x_plus[0] = 0.0


SYSTEM = System(
    name="integrate_and_fire",
    states=(State("v"),),
    parameters=(Parameter("current", 1.58), Parameter("swing", 0.3), Parameter("omega", 2.0 * math.pi)),
    modes=(Mode("charging", field),),
    transitions=(Transition("spike", "charging", "charging", below_threshold, reset=fire),),
    period=lambda p: 2.0 * math.pi / p.omega,
    reference="Keener, Hoppensteadt & Rinzel (1981), SIAM J. Appl. Math. 41, 503",
)

MIDDLE = 1.0 / (1.0 - math.exp(-1.0))
REACH = 0.3 / math.sqrt(1.0 + 4.0 * math.pi**2)

PEER = Peer(
    "Integrate-and-fire neuron, forced",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"v": 0.0}, "until": "settled"}},
                "continue": {"parameter": "current", "range": [1.3, 1.9]},
            },
            values=(
                Value("LP", MIDDLE - REACH, 1e-15, CLOSED_FORM, of="orbit"),
                Value("LP", MIDDLE + REACH, 1e-15, CLOSED_FORM, of="orbit"),
            ),
            endings=(Ending("closed", "all phases of the spike have been gone through"),),
        ),
    ),
)
