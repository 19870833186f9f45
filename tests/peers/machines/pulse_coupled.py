"""Two neurons that hinder each other: each fires at x = 1, and then takes e from the other.

x' = S - x between. They fire in turns while neither would fire twice: at the ends of the range one fires just
when the other one comes to its threshold. Both ends are in closed form.
"""

import math

from peers.form import CLOSED_FORM, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition

HINDERED = 0.1


def field(t, x, p, dx):
    dx[0] = p.S1 - x[0]
    dx[1] = p.S2 - x[1]


def first_fires(t, x, p, x_plus):
    x_plus[0], x_plus[1] = 0.0 * x[0], x[1] - p.e


def second_fires(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0] - p.e, 0.0 * x[1]


SYSTEM = System(
    name="pulse_coupled",
    states=(State("x1"), State("x2")),
    parameters=(Parameter("S1", 2.0), Parameter("S2", 2.0), Parameter("e", HINDERED)),
    modes=(Mode("charging", field),),
    transitions=(
        Transition("first", "charging", "charging", lambda t, x, p: 1.0 - x[0], reset=first_fires),
        Transition("second", "charging", "charging", lambda t, x, p: 1.0 - x[1], reset=second_fires),
    ),
    reference="Mirollo & Strogatz (1990), SIAM J. Appl. Math. 50, 1645",
)


def first_for(second: float) -> float:
    """S1 with which the first fires just when the second is at its threshold, unhindered since it has fired.

    The second then has e to make good, which takes t. So the first has S1 (1 - exp(-t)) - e when the second
    fires, and has to come to 1 in the period T = log(S2 / (S2 - 1)).
    """
    decayed = (second - 1.0) / second
    made_good = (second - 1.0) / (second - 1.0 + HINDERED)
    return (1.0 + HINDERED * decayed) / (1.0 - made_good * decayed)


LEAST = first_for(2.0)
# The same with the parts exchanged: first_for(S1) = 2 is (1 + e) S1^2 - (3 + 3 e - e^2) S1 + 2 + e - e^2 = 0.
HALF = 0.5 * (3.0 + 3.0 * HINDERED - HINDERED**2) / (1.0 + HINDERED)
MOST = HALF + math.sqrt(HALF**2 - (2.0 + HINDERED - HINDERED**2) / (1.0 + HINDERED))

PEER = Peer(
    "Pulse-coupled neurons",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {"simulate": {"state": {"x1": 0.2, "x2": 0.7}, "until": "settled"}},
                "continue": {"parameter": "S1", "range": [1.5, 2.5]},
                "events": {"GR": "switch", "OC": "switch"},
                "diagram": {"depth": 1},
            },
            values=(
                Value("OC", LEAST, 1e-15, CLOSED_FORM, of="orbit"),
                Value("OC", MOST, 1e-15, CLOSED_FORM, of="orbit"),
            ),
        ),
    ),
)
