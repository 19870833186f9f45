"""Special points and marks are the same by shooting and by collocation, within the errors that both claim."""

from __future__ import annotations

import json

import pytest

import contwalk as cw

pytestmark = pytest.mark.slow

LORENZ = '''"""Lorenz' equations."""
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = 10.0 * (x[1] - x[0])
    dx[1] = p.r * x[0] - x[1] - x[0] * x[2]
    dx[2] = x[0] * x[1] - 8.0 / 3.0 * x[2]

SYSTEM = System(
    name="lorenz",
    states=(State("x"), State("y"), State("z")),
    parameters=(Parameter("r", 100.5),),
    modes=(Mode("smooth", field),),
)
'''
STUDIES = {
    "rotor on an anisotropic suspension": {
        "system": "autobalancer",
        "model": {"masses": 2, "suspension": "anisotropic"},
        "preset": "fig19",
        "parameters": {"omega": 5.0},
        "start": {"equilibrium": "balanced"},
        "continue": {"parameter": "omega", "range": [5.0, 5.2], "direction": "forward"},
        "diagram": "none",
        "mark": {"omega": [5.1]},
    },
    "first doubling of the cascade": {
        "system": "autobalancer",
        "model": {"masses": 2},
        "preset": "heavy",
        "parameters": {"omega": 5.0},
        "start": {"equilibrium": "balanced", "parameters": {"delta": 0.0065}},
        "continue": {"parameter": "delta", "range": [0.0048, 0.0065], "direction": "backward"},
        "diagram": {"follow": ["HB"], "depth": 1},
        "mark": {"delta": [0.0055]},
    },
    # Legs between impacts are solved on either kind of steps; a period doubling lies on the way.
    "gait of the planar walker": {
        "system": "planar_walker",
        "parameters": {"alpha": 0.09},
        "start": {
            "simulate": {
                "state": {"q1": -0.5196, "q2": 0.1528388, "u1": -1.933, "u2": -2.037},
                "at": "heel_strike",
                "until": "settled",
            }
        },
        "continue": {"parameter": "alpha", "range": [0.09, 0.1], "direction": "forward"},
        "diagram": "none",
        "mark": {"alpha": [0.095]},
        "events": {"GR": "ignore"},
    },
    "first doubling of Lorenz' cycle": {
        "system": "lorenz.py",
        "start": {"simulate": {"state": {"x": 10.0, "y": 10.0, "z": 100.0}, "until": "settled"}},
        "continue": {"parameter": "r", "range": [99.9, 100.5], "direction": "backward"},
        "diagram": "none",
    },
}


def told(study, scheme, folder):
    """Special points of all branches by branch and name."""
    path = folder / f"{scheme}.yaml"
    path.write_text(
        json.dumps({"contwalk": 1, **study, "engine": {"discretization": scheme}}), encoding="utf-8"
    )
    branches = cw.run(cw.read_run_file(path, output=folder / f"{scheme}.h5"), figures=False).branches
    return {
        (branch.name, point.name): (branch, point) for branch in branches for point in branch.special_points
    }


def agree(study, folder):
    """Compare all special points, and return how many there are beside the ends."""
    by = {scheme: told(study, scheme, folder) for scheme in ("shooting", "collocation")}
    assert by["shooting"].keys() == by["collocation"].keys()
    for key, (branch, point) in by["shooting"].items():
        other = by["collocation"][key][1]
        free = branch.info.free[0]
        apart, claimed = abs(point.parameters[free] - other.parameters[free]), point.error + other.error
        if point.label != "EP":
            assert point.status == other.status == "located", (point, other)
            assert apart <= claimed + 1e-15 * abs(point.parameters[free])
            # To the accuracy that is asked for.
            assert (other.period or 0.0) == pytest.approx(point.period or 0.0, rel=1e-8)
    return sum(point.label != "EP" for _, point in by["shooting"].values())


@pytest.mark.parametrize(
    "name",
    [name if "Lorenz" in name else pytest.param(name, marks=pytest.mark.long) for name in STUDIES],
)
def test_both_discretisations_agree(name, tmp_path):
    (tmp_path / "lorenz.py").write_text(LORENZ, encoding="utf-8")
    assert agree(STUDIES[name], tmp_path) >= 1
