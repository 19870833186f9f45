"""Machines with events whose start meets none: in a mode without all states, or stiff."""

from __future__ import annotations

import numpy as np
import pytest

import contwalk as cw
from contwalk.errors import SystemDefinitionError

# In the air there is no spring to press; nobody ever gets to the ground.
ORBITING = """\
from contwalk.system import Mode, Parameter, State, System, Transition

def air(t, x, p, dx):
    r2 = x[0]**2 + x[1]**2
    dx[0] = p.a * x[0] - x[1] - x[0] * r2
    dx[1] = x[0] + p.a * x[1] - x[1] * r2

def ground(t, x, p, dx):
    dx[0], dx[1], dx[2] = x[1], -x[0], -x[2]

def land(t, x, p, x_plus):
    x_plus[0], x_plus[1], x_plus[2] = x[0], x[1], 0.0

def lift(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], x[1]

AIR, GROUND = Mode("air", air, states=("x", "y")), Mode("ground", ground)
SYSTEM = System("orbiting", states=(State("x"), State("y"), State("spring")),
    parameters=(Parameter("a", 0.5),),
    modes=MODES,
    transitions=(Transition("down", "air", "ground", lambda t, x, p: x[0] + 100.0, reset=land),
        Transition("up", "ground", "air", lambda t, x, p: x[0] + 50.0, "rising", reset=lift)))
"""
# An impact oscillator with a sensor that follows its velocity within 1 / k seconds and pushes back.
SENSED = """\
import math
from contwalk.system import Mode, Parameter, State, System, Transition

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - 0.1 * x[1] - 0.1 * SENSED + p.a * math.cos(2.0 * t)
    FOLLOWS

def reset(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], -0.6 * x[1]
    KEEPS

SYSTEM = System("sensed", states=(State("x"), State("v"), STATE),
    parameters=(Parameter("a", 0.5), Parameter("k", 1e7)),
    modes=(Mode("m", field),), period=lambda p: math.pi,
    transitions=(Transition("hit", "m", "m", lambda t, x, p: x[0] + 0.05, reset=reset),))
"""
STIFF = {
    "SENSED": "x[2]",
    "FOLLOWS": "dx[2] = -p.k * (x[2] - x[1])",
    "KEEPS": "x_plus[2] = x[2]",
    "STATE": 'State("f"),',
}
REDUCED = {"SENSED": "x[1]", "FOLLOWS": "", "KEEPS": "", "STATE": ""}


def study(folder, plugin, run):
    (folder / "machine.py").write_text(plugin)
    (folder / "run.yaml").write_text(f"contwalk: 1\nsystem: ./machine.py\n{run}output: out.h5\n")
    run = cw.read_run_file(folder / "run.yaml", output=folder / "out.h5")
    return cw.run(run, figures=False, force=True).branches[0]


@pytest.mark.parametrize(("modes", "mode"), [("(AIR, GROUND)", ""), ("(GROUND, AIR)", "mode: air, ")])
def test_an_orbit_in_a_mode_that_lacks_states(tmp_path, modes, mode):
    run = (
        f"start: {{simulate: {{{mode}state: {{x: 0.5, y: 0.0}}, until: settled}}}}\n"
        "continue: {parameter: a, range: [0.1, 0.9]}\n"
    )
    branch = study(tmp_path, ORBITING.replace("MODES", modes), run)
    assert branch.outcome.reason == "bound"
    # r = sqrt(a), once round in 2 pi; multiplier exp(-2 a 2 pi)
    known = branch.points["error"] * branch.points["weights"][:, 0]
    assert np.all(np.abs(branch["max:x"] - np.sqrt(branch["a"])) <= known)
    assert np.all(known <= 1e-6)
    assert np.all(np.abs(branch["period"] - 2.0 * np.pi) <= 2.0 * np.pi * known)
    np.testing.assert_allclose(branch["max_abs"], np.exp(-4.0 * np.pi * branch["a"]), atol=1e-9)


def test_an_equilibrium_of_a_mode_that_lacks_states_is_refused(tmp_path):
    run = "start: {state: {x: 0.5, y: 0.0}}\ncontinue: {parameter: a, range: [0.1, 0.9]}\n"
    with pytest.raises(SystemDefinitionError, match="mode 'air', but 'spring' does not exist there"):
        study(tmp_path, ORBITING.replace("MODES", "(AIR, GROUND)"), run)


def _written(words):
    plugin = SENSED
    for word, text in words.items():
        plugin = plugin.replace(word, text)
    return plugin


@pytest.mark.drawn(1)
@pytest.mark.parametrize("k", [1e5, 1e7, 1e9])
def test_a_stiff_machine_starts_from_a_simulation(tmp_path, k):
    run = (
        "start: {{simulate: {{state: {{x: 0.3, v: 0.0{more}}}, until: settled}}}}\n"
        "continue: {{parameter: a, range: [0.4, 0.6], max_points: 2}}\nparameters: {{k: {k}}}\n"
    )
    stiff = study(tmp_path, _written(STIFF), run.format(more=", f: 0.0", k=k))
    assert stiff.outcome.reason == "max_points"
    reduced = study(tmp_path, _written(REDUCED), run.format(more="", k=k))
    # At each impact the sensor lags by 1 / k: that shifts the velocity by 0.1 / k of its jump.
    start, known = (int(np.argmin(np.abs(branch["a"] - 0.5))) for branch in (stiff, reduced))
    assert stiff["a"][start] == reduced["a"][known] == 0.5
    np.testing.assert_allclose(stiff["state"][start][:2], reduced["state"][known], rtol=10.0 / k + 1e-7)
