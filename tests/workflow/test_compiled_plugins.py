"""Functions compiled with `@numba.njit`, their helpers included, are used as if they were plain Python."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contwalk.cli.entry import run
from contwalk.plugin_check.system import check_reference
from contwalk.storage import open_database
from contwalk.storage.trajectory import read_trajectory

# Both are written twice: with `@numba.njit` before every function, and without.
HELPERS = """\
import math
import numpy as np
import numba

{njit}
def pull(p, x):
    return p.k * x

"""

# x' = r - k x - x^3: one equilibrium, x = 1 at r = 3, k = 2.
SMOOTH = """\
import math
import numpy as np
import numba
import helpers_{name} as helpers
from helpers_{name} import pull
from contwalk.system import Mode, Observable, Parameter, Start, State, Symmetry, System

{njit}
def cube(x):
    return x ** 3

{njit}
def field(t, x, p, dx):
    dx[0] = p.r - pull(p, x[0]) - cube(x[0])
    dx[1] = -helpers.pull(p, x[1])

{njit}
def mirror(t, x, p, x_image):
    x_image[0] = x[0]
    x_image[1] = -x[1]

{njit}
def level(t, x, p):
    return cube(x[:, 0].max())

def both(t, x, p):
    return float(np.max(pull(p, x[:, 0])))

{njit}
def resting(p):
    return [[1.0, 0.0]]

SYSTEM = System(
    name="smooth",
    states=(State("x", "1", scale=1.0), State("y", "1", scale=1.0)),
    parameters=(Parameter("r", 3.0, "1"), Parameter("k", 2.0, "1")),
    modes=(Mode("only", field),),
    symmetries=(Symmetry("mirror", "spatial", mirror),),
    observables=(Observable("level", level), Observable("both", both)),
    starts=(Start("resting", resting),),
)
"""

# A ball of restitution e on a table that heaves. It bounces once a period, with the speed pi g, where
# (1 - e) pi g = (1 + e) a cos(phase): just after such a bounce is t = 0 at a = 0.5, e = 0.8.
PHASE = math.acos((1.0 - 0.8) * math.pi / (1.8 * 0.5))
HYBRID = """\
import math
import numpy as np
import numba
from contwalk.system import Condition, Mode, Observable, Parameter, State, System, Transition

{njit}
def heave(t, p):
    return p.a * math.sin(t + {phase!r})

{njit}
def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.g

{njit}
def height(t, x, p):
    return x[0] - heave(t, p)

{njit}
def bounce(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = -p.e * x[1] + (1.0 + p.e) * p.a * math.cos(t + {phase!r})

{njit}
def period(p):
    return 2.0 * math.pi

{njit}
def fast(t, x, p):
    return -x[1]

SYSTEM = System(
    name="ball",
    states=(State("z", "m"), State("v", "m/s")),
    parameters=(Parameter("g", 1.0, "1"), Parameter("e", 0.8, "1"), Parameter("a", 0.5, "1")),
    modes=(Mode("flight", field),),
    transitions=(Transition("impact", "flight", "flight", guard=height, reset=bounce),),
    conditions=(Condition("falls", fast, at="impact"),),
    observables=(Observable("speed", fast, at="impact"),),
    period=period,
)
"""

CONTINUE = """\
contwalk: 1
system: ./{name}.py
start: {start}
continue: {{parameter: {free}, range: {range}, max_points: 6}}
diagram: none
output: {name}.h5
"""
SIMULATE = """\
contwalk: 1
system: ./{name}.py
start: {{state: {state}}}
simulate: {{until: {until}}}
output: {name}_motion.h5
"""


def _written(folder, text, **runs):
    """The plugin as `python.py` and as `compiled.py`, each with its run files."""
    for name, njit in (("python", ""), ("compiled", "@numba.njit")):
        (folder / f"helpers_{name}.py").write_text(HELPERS.format(njit=njit), encoding="utf-8")
        (folder / f"{name}.py").write_text(text.format(njit=njit, name=name, phase=PHASE), encoding="utf-8")
        for kind, run_file in runs.items():
            (folder / f"{name}_{kind}.yaml").write_text(run_file.replace("NAME", name), encoding="utf-8")


def _runs(given, motion):
    return {
        "continue": CONTINUE.format(name="NAME", **given),
        "simulate": SIMULATE.format(name="NAME", **motion),
    }


@pytest.fixture
def smooth(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    given = {"start": "{equilibrium: resting}", "free": "r", "range": "[1.0, 4.0]"}
    state = {"state": "{x: 0.5, y: 1.0}", "until": "1.0"}
    sample = (
        "system: ./NAME.py\nstart: {state: {x: 0.5, y: 1.0}}\n"
        "sample: {count: 20, seed: 1, draw: {y: [0.5, 2]}, until: 9, "
        "measure: {observable: level, level: 0.5, direction: rising, crossing: last}, "
        "settled: {equilibrium: resting, within: {x: 0.1, y: 0.1}}}\n"
        "output: NAME_sample.h5\n"
    )
    runs = {
        "continue": CONTINUE.format(name="NAME", **given),
        "simulate": SIMULATE.format(name="NAME", **state),
    }
    _written(tmp_path, SMOOTH, sample=sample, **runs)
    return tmp_path


@pytest.fixture
def hybrid(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    state = f"{{z: {0.5 * math.sin(PHASE) + 1e-9!r}, v: {math.pi!r}}}"
    given = {"start": f"{{simulate: {{state: {state}, until: settled}}}}", "free": "a", "range": "[0.4, 0.6]"}
    motion = {"state": "{z: 2.0, v: 0.0}", "until": "3.0"}
    runs = {
        "continue": CONTINUE.format(name="NAME", **given),
        "simulate": SIMULATE.format(name="NAME", **motion),
    }
    _written(tmp_path, HYBRID, **runs)
    return tmp_path


@pytest.mark.parametrize("system", ["smooth", "hybrid"])
def test_compiled_plugins_pass_the_same_checks(system, request):
    folder = request.getfixturevalue(system)
    python, compiled = (check_reference(name, folder) for name in ("./python.py", "./compiled.py"))
    assert [(f.level, f.what, f.sentence) for f in compiled] == [
        (f.level, f.what, f.sentence) for f in python
    ]
    assert not [f for f in compiled if f.level == "error"]


@pytest.mark.parametrize("system", ["smooth", "hybrid"])
def test_compiled_plugins_give_the_same_branches_and_motions(system, request):
    folder = request.getfixturevalue(system)
    branches, motions = [], []
    for name in ("python", "compiled"):
        assert run(("continue", f"{name}_continue.yaml", "--no-figures")) == 0
        assert run(("simulate", f"{name}_simulate.yaml", "--no-figures")) == 0
        assert run(("verify", f"{name}.h5", "--trust")) == 0
        with open_database(folder / f"{name}.h5") as db:
            branches.append(db.branch("b1"))
        motions.append(read_trajectory(folder / f"{name}_motion_trajectory.h5"))
    python, compiled = branches
    assert len(python) > 2
    for column in ("free", "state", "observables", "spectrum"):
        np.testing.assert_array_equal(compiled.points[column], python.points[column])
    np.testing.assert_array_equal(motions[1].states, motions[0].states)


def test_compiled_observables_are_sampled(smooth):
    for name in ("python", "compiled"):
        assert run(("sample", f"{name}_sample.yaml", "--no-figures")) == 0
    tables = [(smooth / f"{name}_sample_samples.csv").read_text() for name in ("python", "compiled")]
    assert tables[0] == tables[1]
