"""A block on a belt with unequal frictions, which the belt cannot hold any more at a closed form.

It sticks while the spring's pull is between -R and the parameter s; slower than the belt x'' = F - x, faster
x'' = -G - x. It slips back at s and sticks at 2 F - s, unless that is below -R: s = 2 F + R.
"""

from peers.form import CLOSED_FORM, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition

F, G, R, V = 0.4, 0.3, 0.5, 1.0


def held(t, x, p, dx):
    dx[0] = V
    dx[1] = 0.0 * x[1]


def slower(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = F - x[0]


def faster(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -G - x[0]


def relative(t, x, p):
    return x[1] - V


SYSTEM = System(
    name="belt_friction",
    states=(State("x"), State("v")),
    parameters=(Parameter("s", 1.0),),
    modes=(Mode("stick", held), Mode("back", slower), Mode("ahead", faster)),
    transitions=(
        Transition("slips", "stick", "back", lambda t, x, p: x[0] - p.s, "rising", level=True),
        Transition("runs", "stick", "ahead", lambda t, x, p: x[0] + R, "falling", level=True),
        Transition("sticks", "back", "stick", relative, "rising"),
        Transition("catches", "ahead", "stick", relative, "falling"),
    ),
    reference="Popp & Stelter (1990), Phil. Trans. R. Soc. A 332, 89",
)

PEER = Peer(
    "Block on a belt",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"x": 0.0, "v": 1.0}, "mode": "stick", "until": "settled"}},
                "continue": {"parameter": "s", "range": [0.6, 2.5]},
                "events": {"GR": "switch", "OC": "switch"},
                "diagram": {"follow": "none", "depth": 3},
            },
            # The orbits on either side are others: the motion jumps.
            values=(Value("OC", 2.0 * F + R, 1e-15, CLOSED_FORM, of="orbit", times=2),),
            long=True,
        ),
    ),
)
