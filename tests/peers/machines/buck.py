"""Buck converter under voltage control with a ramp: an autonomous machine with a clock."""

from peers.form import SHOOTING, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System, Transition

VOLTAGE, CURRENT, CLOCK = range(3)


def circuit(switched_on):
    def field(t, x, p, dx):
        dx[VOLTAGE] = (x[CURRENT] - x[VOLTAGE] / p.R) / p.C
        dx[CURRENT] = (switched_on * p.E - x[VOLTAGE]) / p.L
        dx[CLOCK] = 1.0

    return field


def ramp_above_control(t, x, p):
    ramp = p.low + (p.high - p.low) * x[CLOCK] / p.T
    return ramp - p.a * (x[VOLTAGE] - p.wanted)


def time_left(t, x, p):
    return p.T - x[CLOCK]


def tick(t, x, p, x_plus):
    x_plus[VOLTAGE], x_plus[CURRENT], x_plus[CLOCK] = x[VOLTAGE], x[CURRENT], 0.0


SYSTEM = System(
    name="buck",
    states=(State("v", "V"), State("i", "A"), State("clock", "s")),
    parameters=(
        Parameter("E", 20.0, "V"),
        Parameter("R", 22.0, "ohm"),
        Parameter("C", 47e-6, "F"),
        Parameter("L", 20e-3, "H"),
        Parameter("T", 400e-6, "s"),
        Parameter("a", 8.4),
        Parameter("wanted", 11.3, "V"),
        Parameter("low", 3.8, "V"),
        Parameter("high", 8.2, "V"),
    ),
    modes=(Mode("off", circuit(0.0)), Mode("on", circuit(1.0))),
    transitions=(
        Transition("switch_on", "off", "on", ramp_above_control, "rising", level=True),
        Transition("switch_off", "on", "off", ramp_above_control, "falling", level=True),
        Transition("tick_on", "on", "off", time_left, reset=tick),
        Transition("tick_off", "off", "off", time_left, reset=tick),
    ),
    reference=(
        "Deane & Hamill (1990); di Bernardo, Garofalo, Glielmo & Vasca (1998), IEEE Trans. CAS-I 45, 133"
    ),
)

EXPONENTIALS = "matrix exponentials in 40-digit arithmetic"

PEER = Peer(
    "Buck converter",
    SYSTEM.reference,
    (
        Study(
            "",
            {
                "start": {
                    "simulate": {
                        "state": {"v": 12.0, "i": 0.55, "clock": 0.0},
                        "mode": "off",
                        "until": "settled",
                    }
                },
                "continue": {"parameter": "E", "range": [18.0, 40.0]},
                "diagram": {"depth": 1},
            },
            values=(
                Value("PD", 24.5165728285633787, 1e-15, EXPONENTIALS, of="orbit"),
                Value("PD", 31.1179020067707, 1e-13, SHOOTING, of="orbit", period=8e-4),
                Value("OC", 36.353237064076765, 1e-15, EXPONENTIALS, of="orbit", kind="corner"),
            ),
            endings=(
                Ending("order_change", "a cycle is skipped beyond", 36.353237064076765, 1e-8),
                Ending("bound", "the orbit of one cycle goes on"),
            ),
        ),
    ),
)
