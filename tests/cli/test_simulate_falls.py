"""`contwalk simulate` ends where the plugin says that its machine has fallen, and says so."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from contwalk_systems.planar_walker import SYSTEM as PLANAR
from contwalk_systems.walker3d import SYSTEM as WALKERS

from contwalk.plotting import stick_figure
from contwalk.storage.trajectory import read_trajectory

# A pencil on its tip, x'' = x: from rest at x = a it is at a cosh t.
PENCIL = """\
from contwalk.system import Mode, State, System

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = x[0]

SYSTEM = System(
    name="pencil",
    states=(State("x"), State("v")),
    parameters=(),
    modes=(Mode("tip", field),),
    fallen=lambda t, x, p: x[0] - 1.0,
)
"""
# A wall before it, from which it comes back four times as fast: enough to fall to the other side.
BETWEEN = """\
from contwalk.system import Mode, State, System, Transition

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = x[0]

def thrown_back(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = -4.0 * x[1]

SYSTEM = System(
    name="between",
    states=(State("x"), State("v")),
    parameters=(),
    modes=(Mode("tip", field),),
    transitions=(Transition("wall", "tip", "tip", lambda t, x, p: x[0] + 0.5, reset=thrown_back),),
    fallen=lambda t, x, p: x[0] - 1.0,
)
"""
RUNS = Path(__file__).parents[2] / "runs"


@pytest.fixture
def pencil(folder):
    (folder / "pencil.py").write_text(PENCIL, encoding="utf-8")
    (folder / "between.py").write_text(BETWEEN, encoding="utf-8")
    text = "system: ./{}.py\nstart: {{state: {{x: {}, v: 0.0}}}}\nsimulate: {{until: 20}}\n"
    for name, x in (("pencil", 0.125), ("between", -0.125), ("down", 1.5)):
        plugin = "pencil" if name == "down" else name
        (folder / f"{name}.yaml").write_text(text.format(plugin, x), encoding="utf-8")
    return folder


@pytest.fixture
def drawn_machines(monkeypatch):
    """Of each stick figure the instants at which the machine is drawn."""
    found = []
    own = stick_figure.instants

    def noted(motion, events):
        found.append(list(own(motion, events)))
        return found[-1]

    monkeypatch.setattr(stick_figure, "instants", noted)
    return found


def test_a_smooth_motion_ends_where_it_has_fallen(contwalk, pencil):
    done = contwalk("simulate", "pencil.yaml", "--no-figures")
    assert (done.code, done.err) == (0, "")
    stored = read_trajectory(pencil / "pencil_trajectory.h5")
    assert stored.status == "fallen"
    # The integration's tolerance is 1e-10.
    assert stored.times[-1] == pytest.approx(math.acosh(8.0), abs=1e-9)
    assert stored.values[-1] == pytest.approx([1.0, math.sqrt(1.0 - 0.125**2)], abs=1e-9)
    assert stored.event_names == ()
    said = next(line for line in done.out.splitlines() if "fallen" in line)
    assert f"t = {float(stored.times[-1])!r}" in said
    assert f"x = {float(stored.values[-1, 0])!r}" in said


def test_events_before_the_fall_happen(contwalk, pencil):
    done = contwalk("simulate", "between.yaml", "--no-figures")
    assert (done.code, done.err) == (0, "")
    stored = read_trajectory(pencil / "between_trajectory.h5")
    assert (stored.status, stored.event_names) == ("fallen", ("wall",))
    assert stored.values[-1, 0] == pytest.approx(1.0, abs=1e-9)


def test_what_has_fallen_already_does_not_move(contwalk, pencil):
    done = contwalk("simulate", "down.yaml", "--no-figures")
    assert (done.code, done.err) == (0, "")
    stored = read_trajectory(pencil / "down_trajectory.h5")
    assert stored.status == "fallen"
    assert stored.times[-1] == 0.0
    assert stored.values[-1].tolist() == [1.5, 0.0]


def test_the_planar_walker_falls(contwalk, folder):
    """On its face or its back at 60 degrees from the normal, which is how the walker says that it has."""
    more = ["--set", "simulate={until: 50, perturb: {u1: 0.3}}", "--output", "fall.h5", "--no-figures"]
    done = contwalk("simulate", f"{RUNS}/planar_gait.yaml", *more)
    assert (done.code, done.err) == (0, "")
    stored = read_trajectory(folder / "fall_trajectory.h5")
    assert stored.status == "fallen"
    assert abs(stored.values[-1, PLANAR.state_names.index("q1")]) == pytest.approx(math.pi / 3, abs=1e-9)
    assert stored.times[-1] < 50.0


def test_a_shipped_study_that_begins_by_simulating_is_simulated(contwalk, folder):
    """Its motion comes to the same gait as the printed state: the same event in each step, to 1e-6."""
    ends = []
    for name in ("planar_slope", "planar_gait"):
        more = ["--set", "parameters.alpha=0.09", "--set", "simulate.until=settled", "--no-figures"]
        done = contwalk("simulate", f"{RUNS}/{name}.yaml", *more, "--output", f"{name}.h5")
        assert (done.code, done.err) == (0, "")
        stored = read_trajectory(folder / f"{name}_trajectory.h5")
        ends.append(stored.event_before[stored.event_names.index("heel_strike", 20)])
    np.testing.assert_allclose(*ends, rtol=1e-6, atol=1e-6)


def test_the_walker_in_space_falls(contwalk, folder):
    """Its hip is then at 0.6 of the length of its leg, which is how it says that it has."""
    more = ["--set", "simulate={until: 50, perturb: {u3: -1.0}}", "--output", "fall.h5", "--no-figures"]
    done = contwalk("simulate", f"{RUNS}/walker3d_overlap.yaml", *more)
    assert (done.code, done.err) == (0, "")
    stored = read_trajectory(folder / "fall_trajectory.h5")
    assert stored.status == "fallen"
    system = WALKERS.build(scuffing="felt")
    height = stored.values[:, system.state_names.index("q2")]
    leg = -stored.parameters["knee_y"] - stored.parameters["toe_inner_y"]
    assert height[-1] == pytest.approx(0.6 * leg, abs=1e-9)
    assert (height[:-1] > 0.6 * leg).all()


def test_a_stick_figure_shows_the_fall(contwalk, folder, drawn_machines):
    """At the start, at both strikes, and where it lies, strong; others between them."""
    more = ["--set", "start.state.u1=-1.0", "--set", "figures=[stick_figure]", "--output", "fall.h5"]
    done = contwalk("simulate", f"{RUNS}/planar_gait.yaml", *more)
    assert (done.code, done.err) == (0, "")
    assert [line for line in done.out.splitlines() if "figure:" in line] == ["figure: fall_stick_figure.png"]
    assert (folder / "fall_stick_figure.png").exists()
    stored = read_trajectory(folder / "fall_trajectory.h5")
    (times,) = drawn_machines
    assert {stored.times[0], stored.times[-1], *stored.event_times} <= set(times)
    assert len(times) > 8


def test_a_machine_without_a_picture_has_no_stick_figure(contwalk, pencil):
    done = contwalk("simulate", "pencil.yaml", "--set", "figures=[stick_figure]")
    assert done.code == 2
    assert "figures.0.stick_figure: 'pencil' declares no draw." in done.err
    assert not (pencil / "pencil_trajectory.h5").exists()
