"""FitzHugh-Nagumo with folds of cycles."""

from peers.form import FORTY_DIGITS, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = x[0] - x[0] ** 3 / 3 - x[1] + p.I
    dx[1] = p.eps * (x[0] + p.a - p.b * x[1])


SYSTEM = System(
    name="fitzhugh_nagumo",
    states=(
        State("v"),
        State("w"),
    ),
    parameters=(
        Parameter("I", 0.0),
        Parameter("a", 0.7),
        Parameter("b", 0.8),
        Parameter("eps", 0.08),
    ),
    modes=(Mode("smooth", field),),
    reference="FitzHugh (1961), Biophys. J. 1, 445; Nagumo et al. (1962)",
)

PEER = Peer(
    "FitzHugh-Nagumo with folds of cycles",
    SYSTEM.reference,
    (
        Study(
            "",
            {"start": {"state": {"v": -1.2, "w": -0.6}}, "continue": {"parameter": "I", "range": [0.0, 2.0]}},
            values=(
                Value("HB", 0.33128133745474575, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("HB", 1.418718662545254, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", 0.3241785225, 3e-10, "AUTO-07p at two meshes", of="orbit"),
                Value("LP", 1.4258214775, 3e-10, "AUTO-07p at two meshes", of="orbit"),
            ),
            long=True,
        ),
        # Along both explosions the parameter stands still to its last digit, and deviations grow by 1e80.
        Study(
            "eps=0.01",
            {
                "parameters": {"eps": 0.01},
                "start": {"state": {"v": -1.2, "w": -0.6}},
                "continue": {"parameter": "I", "range": [0.0, 2.0], "max_points": 2000},
            },
            values=(
                Value("HB", 0.29666066400809676, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("HB", 1.4533393359919033, 1e-15, FORTY_DIGITS, criticality="subcritical"),
                Value("LP", 0.29572901011, 2e-11, "AUTO-07p at two meshes", of="orbit"),
                Value("LP", 1.4542709899, 2e-11, "AUTO-07p at two meshes", of="orbit"),
            ),
            endings=(Ending("shrunk", "the Hopf point at 1.4533", 1.453340, 1e-3),),
            long=True,
        ),
    ),
)
