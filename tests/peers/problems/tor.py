"""AUTO tor: an electronic circuit with a torus."""

from peers.form import COLLOCATION, FORTY_DIGITS, Ending, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, Symmetry, System

# Found on whole orbits, without the mirror declared: another problem with twice the segments.
WHOLE = "the whole orbits of the circuit, its mirror not declared"
# Of the last three that are known otherwise: folds near to Shilnikov's orbit are apart by a geometric series.
LAW = "the geometric series of the folds before"
BEFORE = (-0.79748107300, -0.7975296077732696, -0.7975173626733856)
RATIO = (BEFORE[2] - BEFORE[1]) / (BEFORE[1] - BEFORE[0])
FURTHER = tuple(BEFORE[2] + (BEFORE[2] - BEFORE[1]) * sum(RATIO**k for k in range(1, n + 1)) for n in (1, 2))


def field(t, x, p, dx):
    c = (x[1] - x[0]) ** 3
    dx[0] = (-(p.be + p.nu) * x[0] + p.be * x[1] - p.a3 * x[0] ** 3 + p.b3 * c) / p.r
    dx[1] = p.be * x[0] - (p.be + p.ga) * x[1] - x[2] - p.b3 * c
    dx[2] = x[1]


def mirror(t, x, p, image):
    for i in range(3):
        image[i] = -x[i]


SYSTEM = System(
    name="tor",
    states=(
        State("x"),
        State("y"),
        State("z"),
    ),
    parameters=(
        Parameter("nu", -0.9),
        Parameter("be", 0.5),
        Parameter("ga", -0.6),
        Parameter("r", 0.6),
        Parameter("a3", 0.328578),
        Parameter("b3", 0.933578),
    ),
    modes=(Mode("smooth", field),),
    symmetries=(Symmetry("mirror", "spatial", mirror),),
    reference="AUTO-07p (Doedel et al.), demo tor; Freire et al. (1984)",
)

PEER = Peer(
    "AUTO tor: an electronic circuit with a torus",
    SYSTEM.reference,
    (
        Study(
            "torus",
            {
                "start": {"state": {"x": 0, "y": 0, "z": 0}},
                "parameters": {"nu": -0.61},
                "continue": {"parameter": "nu", "range": [-0.612, -0.4]},
            },
            values=(
                Value("HB", -0.5893364779917943, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("BP", -0.5, 1e-15, FORTY_DIGITS, kind="symmetry-breaking"),
                Value("LP", -0.5843347718661825, 1e-13, COLLOCATION, of="orbit"),
                Value("BP", -0.587028974364877, 1e-13, COLLOCATION, of="orbit"),
                Value("NS", -0.591650195032125, 1e-13, COLLOCATION, of="orbit", times=2),
            ),
        ),
        Study(
            "homoclinic end",
            {
                "start": {"state": {"x": 0, "y": 0, "z": 0}},
                "continue": {"parameter": "nu", "range": [-0.9, -0.55]},
                "diagram": {"follow": ["HB"]},
            },
            values=(
                Value("HB", -0.5893364779917943, 1e-15, FORTY_DIGITS, criticality="supercritical"),
                Value("LP", -0.5843347718661825, 1e-13, COLLOCATION, of="orbit"),
                Value("BP", -0.5870289743648769, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", -0.8325141453832922, 1e-13, COLLOCATION, of="orbit"),
                Value("BP", -0.8324379312674394, 1e-13, COLLOCATION, of="orbit"),
                Value("BP", -0.7875928462114923, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", -0.7875903110321292, 1e-13, COLLOCATION, of="orbit"),
                Value("LP", -0.7998991741552155, 1e-13, COLLOCATION, of="orbit"),
                Value("BP", -0.7998991433038745, 1e-13, COLLOCATION, of="orbit"),
            ),
            endings=(Ending("homoclinic", "the folds accumulate: Shilnikov's orbit"),),
            long=True,
            # Folds and branch points without end, nearer to each other than to their own rounding.
            real=(
                Value("LP", -0.79748107300, 1e-10, WHOLE, of="orbit"),
                Value("BP", -0.79748107300, 1e-10, WHOLE, of="orbit"),
                Value("BP", -0.7969090558215661, 2e-13, COLLOCATION, of="orbit"),
                Value("LP", -0.7969090552817116, 2e-13, COLLOCATION, of="orbit"),
                Value("LP", -0.7976731385057393, 4e-12, COLLOCATION, of="orbit"),
                Value("BP", -0.7976731384972856, 4e-12, COLLOCATION, of="orbit"),
                Value("LP", -0.7975296077732696, 3e-11, COLLOCATION, of="orbit"),
                Value("BP", -0.7975296077732696, 3e-11, COLLOCATION, of="orbit"),
                Value("LP", -0.7975173626733856, 1e-9, WHOLE, of="orbit"),
                Value("BP", -0.7975173626733854, 1e-9, WHOLE, of="orbit"),
                *(Value(label, value, 5e-9, LAW, of="orbit") for label in ("LP", "BP") for value in FURTHER),
            ),
        ),
    ),
)
