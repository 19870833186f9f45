"""A database is not continued with a plugin that has changed since."""

import pytest
from test_kill_and_resume import PLUGIN, RUN

from contwalk.errors import DatabaseError
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import run


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("old", "new"),
    [("p.mu * x[0]", "1.01 * p.mu * x[0]"), ('Parameter("mu", -0.5)', 'Parameter("mu", -0.4)')],
)
def test_a_changed_plugin_is_refused(tmp_path, old, new):
    (tmp_path / "fork.py").write_text(PLUGIN)
    (tmp_path / "run.yaml").write_text(RUN)
    output = str(tmp_path / "out.h5")
    run(read_run_file(tmp_path / "run.yaml", output=output))
    run(read_run_file(tmp_path / "run.yaml", output=output), resume=True)  # unchanged: nothing to do
    assert old in PLUGIN
    (tmp_path / "fork.py").write_text(PLUGIN.replace(old, new))
    with pytest.raises(DatabaseError, match="another version of the plugin"):
        run(read_run_file(tmp_path / "run.yaml", output=output), resume=True)


CYCLE = """\
from contwalk.system import Mode, Observable, Parameter, State, System

def field(t, x, p, dx):
    r = x[0] ** 2 + x[1] ** 2
    dx[0] = p.mu * x[0] - x[1] - r * x[0]
    dx[1] = x[0] + p.mu * x[1] - r * x[1]

def halved(value):
    return 0.5 * value

def energy(t, x, p):
    return halved(float((x[:, 0] ** 2 + x[:, 1] ** 2).max()))  # of the whole motion

SYSTEM = System(
    "ring", states=(State("x"), State("y")), parameters=(Parameter("mu", 0.25),),
    modes=(Mode("only", field),), observables=(Observable("energy", energy),),
)
"""
HELPERS = "def halved(value):\n    return 0.5 * value\n"
AROUND = """\
contwalk: 1
system: ./ring.py
start: {simulate: {state: {x: 0.5, y: 0.0}, until: settled}}
continue: {parameter: mu, range: [0.2, 0.3], direction: forward}
"""


@pytest.mark.parametrize(
    ("old", "new", "refused"),
    [
        ("x[:, 0] ** 2 + x[:, 1]", "x[:, 0] ** 2 - x[:, 1]", True),
        ("0.5 * value", "0.25 * value", True),
        ("of the whole motion", "of a whole period", False),
    ],
)
def test_what_is_measured_of_orbits_is_a_part_of_the_plugin(tmp_path, old, new, refused):
    """Observables of orbits may do anything with a motion, and are not traced: their source is compared."""
    (tmp_path / "ring.py").write_text(CYCLE)
    (tmp_path / "run.yaml").write_text(AROUND)
    output = str(tmp_path / "out.h5")
    run(read_run_file(tmp_path / "run.yaml", output=output))
    assert old in CYCLE
    (tmp_path / "ring.py").write_text(CYCLE.replace(old, new))
    if refused:
        with pytest.raises(DatabaseError, match="another version of the plugin"):
            run(read_run_file(tmp_path / "run.yaml", output=output), resume=True)
    else:
        run(read_run_file(tmp_path / "run.yaml", output=output), resume=True)
