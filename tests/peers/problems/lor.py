"""Lorenz equations at high Rayleigh numbers: symmetry breaking and period doublings."""

from peers.form import COLLOCATION, Peer, Study, Value

from contwalk.system import Mode, Parameter, State, Symmetry, System


def field(t, x, p, dx):
    dx[0] = p.sigma * (x[1] - x[0])
    dx[1] = p.rho * x[0] - x[1] - x[0] * x[2]
    dx[2] = x[0] * x[1] - p.beta * x[2]


def mirror(t, x, p, image):
    image[0] = -x[0]
    image[1] = -x[1]
    image[2] = x[2]


SYSTEM = System(
    name="lor",
    states=(
        State("x"),
        State("y"),
        State("z"),
    ),
    parameters=(
        Parameter("rho", 320.0),
        Parameter("beta", 2.6666666666666665),
        Parameter("sigma", 10.0),
    ),
    modes=(Mode("smooth", field),),
    symmetries=(Symmetry("mirror", "spatial", mirror),),
    reference="Sparrow, The Lorenz Equations (1982), chapter 4; AUTO-07p (Doedel et al.), demo lor",
)

PEER = Peer(
    "Lorenz equations at high Rayleigh numbers: symmetry breaking and period doublings",
    SYSTEM.reference,
    (
        Study(
            "high rho",
            {
                "start": {"simulate": {"state": {"x": 10, "y": 10, "z": 300}, "until": "settled"}},
                "continue": {"parameter": "rho", "range": [200.0, 340.0]},
                "diagram": {"depth": 3},
            },
            values=(
                Value("BP", 312.97353298418085, 7e-13, COLLOCATION, of="orbit"),
                Value("PD", 229.40670856144064, 1e-13, COLLOCATION, of="orbit", times=2),
                Value("PD", 218.210127777823, 1e-13, COLLOCATION, of="orbit"),
                Value("PD", 215.9659306324338, 3e-10, COLLOCATION, of="orbit"),
            ),
        ),
    ),
)
