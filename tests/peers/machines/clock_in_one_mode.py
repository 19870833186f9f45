"""The same pendulum clock in its textbook form: one mode, and a push where x rises through zero.

After its push x goes on in the direction in which it has passed zero.
"""

from peers.form import Peer
from peers.machines import clock_escapement as two_modes

from contwalk.system import Mode, Parameter, State, System, Transition

SYSTEM = System(
    name="clock_in_one_mode",
    states=(State("x"), State("v")),
    parameters=(Parameter("J", 0.1), Parameter("z", 0.02)),
    modes=(Mode("swing", two_modes.field),),
    transitions=(Transition("tick", "swing", "swing", lambda t, x, p: x[0], "rising", reset=two_modes.push),),
    reference=two_modes.SYSTEM.reference,
)

PEER = Peer("Pendulum clock in one mode", SYSTEM.reference, two_modes.PEER.studies)
