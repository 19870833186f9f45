"""FitzHugh-Nagumo with folds of cycles."""

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
