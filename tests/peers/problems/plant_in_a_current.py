"""Plant's burster in a constant current: a canard explosion that ends at a saddle."""

import math

from peers.form import FORTY_DIGITS, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    v, h, n, slow, calcium = x[0], x[1], x[2], x[3], x[4]
    vs = 127.0 / 105.0 * v + 8265.0 / 105.0
    am = 0.1 * (50 - vs) / (math.exp((50 - vs) / 10) - 1)
    bm = 4 * math.exp((25 - vs) / 18)
    ah = 0.07 * math.exp((25 - vs) / 20)
    bh = 1 / (math.exp((55 - vs) / 10) + 1)
    an = 0.01 * (55 - vs) / (math.exp((55 - vs) / 10) - 1)
    bn = 0.125 * math.exp((45 - vs) / 80)
    m = am / (am + bm)
    potassium = 0.3 * n**4 + 0.03 * calcium / (0.5 + calcium)
    dx[0] = -(4 * m**3 * h + 0.01 * slow) * (v - 30) - potassium * (v + 75) - 0.003 * (v + 40) + p.I
    dx[1] = (ah * (1 - h) - bh * h) / 12.5
    dx[2] = (an * (1 - n) - bn * n) / 12.5
    dx[3] = (1 / (1 + math.exp(0.15 * (-50 - v))) - slow) / 235
    dx[4] = 0.0003 * (0.0085 * slow * (140 - v) - calcium)


SYSTEM = System(
    name="plant_in_a_current",
    states=tuple(State(name) for name in ("V", "h", "n", "x", "Ca")),
    parameters=(Parameter("I", -0.1),),
    modes=(Mode("smooth", field),),
    reference=("Plant (1981), J. Math. Biol. 11, 15; J. Rinzel & Y. S. Lee (1987), J. Math. Biol. 25, 653"),
)

PEER = Peer(
    "Plant's burster in a constant current",
    SYSTEM.reference,
    (
        # Beyond the fold the cycles follow what repels them, and deviations grow ever more in a round, to
        # a saddle's homoclinic orbit.
        Study(
            "",
            {
                "start": {
                    "state": {"V": -66.535, "h": 0.98736, "n": 0.0086276, "x": 0.0772518, "Ca": 0.135619}
                },
                "continue": {"parameter": "I", "range": [-0.11, -0.08]},
            },
            values=(
                Value("HB", -0.08920132897297836, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("LP", -0.086106129332, 1e-11, "AUTO-07p at two meshes", of="orbit"),
            ),
            endings=(
                # Its ten digits are AUTO's at periods of 3e4.
                Ending("homoclinic", "AUTO-07p at periods of 3e4", -0.0861061912, 5e-11),
            ),
            long=True,
        ),
    ),
)
