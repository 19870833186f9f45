"""`contwalk simulate` for machines with impacts and several modes."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest

from contwalk.storage.trajectory import read_trajectory

BALL = """\
import math
from contwalk.system import Mode, Observable, Parameter, Start, State, System, Transition

def fall(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.g

def height(t, x, p):
    return x[0]

def bounce(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = -p.e * x[1]

def top(t, x, p):
    return x[1]

SYSTEM = System(
    name="ball",
    states=(State("y", unit="m"), State("v", unit="m/s")),
    parameters=(Parameter("g", 10.0), Parameter("e", 1.0)),
    modes=(Mode("flight", fall),),
    transitions=(
        Transition("impact", "flight", "flight", height, reset=bounce),
        Transition("top", "flight", "flight", top, role="watched"),
    ),
    observables=(Observable("height", lambda t, x, p: x[0, 0], unit="m"),),
    starts=(Start("rest", lambda p: [[0.0, 0.0]]),),
)
"""

TANK = """\
from contwalk.system import Mode, Parameter, State, System, Transition

def leak(t, x, p, dx):
    dx[1] = -x[1]

def fly(t, x, p, dx):
    dx[0] = x[2]
    dx[2] = -2.0

def launch(t, x, p, x_plus):
    x_plus[0] = 0.0
    x_plus[2] = 4.0 * x[1]

def fill(t, x, p, x_plus):
    x_plus[1] = 1.0

SYSTEM = System(
    name="tank",
    states=(State("y"), State("z"), State("v")),
    parameters=(),
    modes=(Mode("leaking", leak, states=("z",)), Mode("flying", fly, states=("y", "v"))),
    transitions=(
        Transition("empty", "leaking", "flying", lambda t, x, p: x[1] - 0.5, reset=launch),
        Transition("landed", "flying", "leaking", lambda t, x, p: x[0], reset=fill),
        Transition("high", "flying", "flying", lambda t, x, p: x[0] - 0.75, direction="both", role="watched"),
    ),
)
"""

RELAY = """\
from contwalk.system import Mode, Parameter, State, System, Transition

def on(t, x, p, dx):
    dx[0] = -1.0
    dx[1] = x[0]

def off(t, x, p, dx):
    dx[0] = p.f
    dx[1] = x[0]

def surface(t, x, p):
    return x[0]

SYSTEM = System(
    "relay",
    states=(State("x"), State("y")),
    parameters=(Parameter("f", 0.5),),
    modes=(Mode("on", on), Mode("off", off)),
    transitions=(
        Transition("drops", "on", "off", surface, direction="falling", level=True),
        Transition("rises", "off", "on", surface, direction="rising", level=True),
    ),
)
"""

RUN = """\
system: ./ball.py
start: {state: {y: 1.0, v: 0.0}}
report_at: {section: {y: 0.5}, direction: falling}
simulate: {until: 2, points: 101}
figures: [{phase_portrait: {x: y, y: v}}, time_series]
"""


@pytest.fixture
def ball(folder):
    (folder / "ball.py").write_text(BALL, encoding="utf-8")
    (folder / "tank.py").write_text(TANK, encoding="utf-8")
    (folder / "b.yaml").write_text(RUN, encoding="utf-8")
    (folder / "t.yaml").write_text(
        "system: ./tank.py\nstart: {state: {z: 1.0}}\nsimulate: {until: 9, points: 50}\n", encoding="utf-8"
    )
    return folder


def test_both_instants_of_each_impact_are_stored(contwalk, ball):
    done = contwalk("simulate", "b.yaml")
    assert (done.code, done.err) == (0, "")
    stored = read_trajectory(ball / "b_trajectory.h5")
    fall = math.sqrt(0.2)
    impacts = [fall, 3 * fall]
    assert stored.event_names == ("y = 0.5", "impact", "top", "y = 0.5", "impact", "top")
    at = [t for name, t in zip(stored.event_names, stored.event_times, strict=True) if name == "impact"]
    np.testing.assert_allclose(at, impacts, atol=1e-13)
    twice = np.flatnonzero(np.diff(stored.times) == 0.0)
    np.testing.assert_array_equal(stored.times[twice], at)
    np.testing.assert_array_equal(stored.values[twice, 1], -stored.values[twice + 1, 1])
    assert (stored.values[twice, 1] < 0).all()
    # All else is evenly spaced.
    rest = np.delete(stored.times, [*twice, *(twice + 1)])
    np.testing.assert_allclose(rest, np.linspace(0.0, 2.0, 101), atol=1e-15)
    phase = np.mod(stored.times + fall, 2 * fall) - fall
    np.testing.assert_allclose(stored.values[:, 0], 1.0 - 5.0 * phase**2, atol=1e-12)
    assert (stored.event_before[1] != stored.event_after[1]).any()
    assert (stored.event_before[0] == stored.event_after[0]).all()
    assert set(stored.event_modes) == {"flight"}
    assert (ball / "b_phase_portrait.png").is_file()


def test_modes_and_states_that_come_and_go(contwalk, ball):
    done = contwalk("simulate", "t.yaml")
    assert (done.code, done.err) == (0, "")
    stored = read_trajectory(ball / "t_trajectory.h5")
    assert stored.mode_names == ("leaking", "flying")
    leaks = stored.modes == 0
    assert not stored.values[leaks][:, [0, 2]].any()
    assert not stored.values[~leaks, 1].any()
    assert (stored.values[leaks, 1] >= 0.5 - 1e-9).all()
    assert stored.event_names[:4] == ("empty", "high", "high", "landed")
    assert stored.event_modes[:4] == ("flying", "flying", "flying", "leaking")
    np.testing.assert_allclose(stored.event_times[[0, 3]], [math.log(2.0), math.log(2.0) + 2.0], atol=1e-9)
    assert "mode after" in done.out
    assert "in mode leaking" in done.out or "in mode flying" in done.out
    with (ball / "t_trajectory.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["mode"] for row in rows] == [stored.mode_names[mode] for mode in stored.modes]


def test_a_motion_may_begin_in_any_mode_and_with_a_transition(contwalk, ball):
    start = "start={state: {y: 0.25, v: 0.0}, mode: flying}"
    assert contwalk("simulate", "t.yaml", "--set", start, "--quiet").code == 0
    stored = read_trajectory(ball / "t_trajectory.h5")
    assert stored.event_names[0] == "landed"
    assert stored.event_times[0] == pytest.approx(0.5, abs=1e-12)
    start = "start={state: {z: 0.5}, at: empty}"
    assert contwalk("simulate", "t.yaml", "--set", start, "--quiet", "--force").code == 0
    stored = read_trajectory(ball / "t_trajectory.h5")
    assert (stored.event_names[0], stored.event_times[0]) == ("empty", 0.0)
    np.testing.assert_array_equal(stored.values[:2], [[0.0, 0.5, 0.0], [0.0, 0.0, 2.0]])
    np.testing.assert_array_equal(stored.times[:2], [0.0, 0.0])


def test_hybrid_motions_settle(contwalk, ball):
    # The two times of the tank repeat from the first fill on.
    done = contwalk("simulate", "t.yaml", "--set", "simulate.until=settled", "--set", "start.state.z=3.0")
    assert done.code == 0
    assert "settled" in done.out
    assert "NOT" not in done.out


def test_from_a_stored_orbit(contwalk, ball):
    (ball / "o.yaml").write_text(
        "system: impact_oscillator\nparameters: {force: 0.9}\n"
        "start: {simulate: {state: {q: 0.0, v: 0.0}, until: settled}}\n"
        "continue: {parameter: force, range: [0.8, 1.0], direction: up, max_points: 5}\n"
    )
    assert contwalk("continue", "o.yaml", "--quiet").code == 0
    (ball / "p.yaml").write_text(
        "system: impact_oscillator\nstart: {from: o.h5, point: b1/2}\nsimulate: {until: 25}\n"
    )
    assert contwalk("simulate", "p.yaml", "--quiet").code == 0
    stored = read_trajectory(ball / "p_trajectory.h5")
    period = 2.0 * math.pi / 1.3
    # It begins right after an impact, at the time of it, and comes back after each period.
    impacts = stored.times[0] + period * np.arange(1, 6)
    np.testing.assert_allclose(stored.event_times, impacts, atol=1e-8)
    np.testing.assert_allclose(stored.event_after, np.tile(stored.values[0], (5, 1)), atol=1e-7)


def test_chatter_is_stored_and_told(contwalk, ball):
    done = contwalk("simulate", "b.yaml", "--set", "parameters.e=0.5", "--set", "simulate.until=settled")
    assert done.code == 1
    instant = math.sqrt(0.2) * 3.0
    assert f"infinitely many of it happen until t = {instant:.12g}"[:-2] in " ".join(done.err.split())
    assert "What came before is stored" in done.err
    assert "SETTLED" not in done.out
    stored = read_trajectory(ball / "b_trajectory.h5")
    assert stored.status == "chatter"
    assert stored.times[-1] == pytest.approx(instant, abs=1e-12)


def test_sticking_is_told(contwalk, ball):
    done = contwalk("simulate", "b.yaml", "--set", "parameters.e=0")
    assert done.code == 1
    assert "does not leave its guard behind" in " ".join(done.err.split())
    assert read_trajectory(ball / "b_trajectory.h5").status == "sticking"


def test_sliding_is_told_with_what_derives_its_mode(contwalk, folder):
    """Both sides lead to the surface: the next of the events has no time between it and the last."""
    (folder / "relay.py").write_text(RELAY, encoding="utf-8")
    run = "{system: ./relay.py, start: {state: {x: 1, y: 0}, mode: 'on'}, simulate: {until: 5}}"
    (folder / "relay.yaml").write_text(run, encoding="utf-8")
    done = contwalk("simulate", "relay.yaml", "--no-figures")
    assert done.code == 1
    assert "slides along the guard is derived by contwalk systems slide" in " ".join(done.err.split())


@pytest.mark.parametrize(
    ("file", "change", "said"),
    [
        ("b.yaml", "start={state: {y: -1.0, v: 0.0}}", "'impact' is -1 at the start"),
        ("b.yaml", "start={state: {y: 1.0}}", "no value for v"),
        ("b.yaml", "start={state: {y: 1.0, v: 0.0}, mode: fligt}", "Did you mean 'flight'"),
        ("b.yaml", "start={state: {y: 1.0, v: 0.0}, at: top}", "watched and changes nothing"),
        ("b.yaml", "start={state: {y: 1.0, v: 0.0}, at: impct}", "Did you mean 'impact'"),
        ("b.yaml", "start={state: {y: 1.0, v: -1.0}, at: impact}", "is 1 there, and not zero"),
        ("b.yaml", "start={equilibrium: rest, mode: flight}", "without a state of its own"),
        ("t.yaml", "start={state: {z: 1.0}, mode: flying}", "'z' does not exist in mode 'flying'"),
        ("t.yaml", "start={state: {z: 1.0}, mode: flying}", "no value for y, v"),
        ("t.yaml", "start={state: {y: 1.0, v: 0.0}, at: landed, mode: leaking}", "leads out of mode flying"),
        ("t.yaml", "start={simulate: {state: {z: 1.0}}, mode: leaking}", "{state: {...}, mode: NAME}}"),
    ],
)  # fmt: skip
def test_bad_starts_are_sentences(contwalk, ball, file, change, said):
    done = contwalk("simulate", file, "--set", change)
    assert done.code == 2
    assert said in " ".join(done.err.split())
    assert not list(ball.glob("?_trajectory.h5"))


def test_a_problem_of_the_file_has_its_line(contwalk, ball):
    (ball / "l.yaml").write_text("system: ./tank.py\nstart:\n  state: {z: 1.0}\n  mode: flowing\n")
    done = contwalk("simulate", "l.yaml")
    assert done.code == 2
    assert "line 4, key start.mode" in done.err
    (ball / "l.yaml").write_text("system: ./ball.py\nstart:\n  state: {y: -1.0, v: 0}\n")
    done = contwalk("simulate", "l.yaml")
    assert done.code == 2
    assert "key start: " in done.err


def test_sampling_of_machines_with_transitions_is_refused(contwalk, ball):
    many = "{count: 3, draw: {y: [1, 2]}, measure: {observable: height, level: 0.1}, until: 9, "
    many += "settled: {equilibrium: rest, within: {y: 0.01}}}"
    (ball / "m.yaml").write_text(f"system: ./ball.py\nstart: {{state: {{y: 1, v: 0}}}}\nsample: {many}\n")
    done = contwalk("sample", "m.yaml")
    assert done.code == 2
    assert "smooth machines only" in " ".join(done.err.split())
