"""`contwalk simulate` and `contwalk warmup` in a folder of their own."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest

from contwalk import plotting
from contwalk.storage.trajectory import read_trajectory

# x'' = -x with x = cos t; `high` is passed twice within 0.1, far less than a step.
PLUGIN = """\
from contwalk.system import Mode, Parameter, Start, State, System, Transition

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - p.damping * x[1]

def high(t, x, p):
    return x[0] - p.level

def reset(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = -x[1]

def make(name, **options):
    return System(
        name=name,
        states=(State("x", unit="m"), State("v", unit="m/s")),
        parameters=(Parameter("damping", 0.0), Parameter("level", 0.999)),
        modes=(Mode("free", field),),
        transitions=(Transition("high", "free", "free", high, direction="both", **options),),
        starts=(Start("rest", lambda p: [[0.0, 0.0]]),),
    )

SYSTEM = make("spring", role="watched")
"""

RUN = """\
system: ./spring.py
start: {state: {x: 1.0, v: 0.0}}
report_at: {section: {v: 0.0}, direction: rising}
simulate: {until: 10, points: 101}
figures: [{phase_portrait: {x: x, y: v}}, time_series, bifurcation_diagram]
output: s.h5
"""


@pytest.fixture
def spring(folder):
    (folder / "spring.py").write_text(PLUGIN, encoding="utf-8")
    (folder / "hard.py").write_text(PLUGIN.replace('role="watched"', "reset=reset"), encoding="utf-8")
    (folder / "s.yaml").write_text(RUN, encoding="utf-8")
    return folder


def test_a_time_series_of_several_states(contwalk, spring):
    done = contwalk("simulate", "s.yaml", "--set", "figures=[{time_series: {y: [x, v]}}]")
    assert (done.code, done.err) == (0, "")
    assert [path.name for path in spring.glob("*.png")] == ["s_time_series.png"]
    done = contwalk("simulate", "s.yaml", "--force", "--set", "figures=[{time_series: {y: [x, 3]}}]")
    assert done.code == 2
    assert "key figures.0.time_series.y.1: is 3, which is not a text" in done.err


def test_a_motion_is_stored_drawn_and_told(contwalk, spring):
    done = contwalk("simulate", "s.yaml")
    assert (done.code, done.err) == (0, "")
    files = {path.name for path in spring.glob("s_*")}
    assert files == {
        "s_trajectory.h5", "s_trajectory.csv", "s_events.csv", "s_phase_portrait.png", "s_time_series.png"
    }  # fmt: skip
    stored = read_trajectory(spring / "s_trajectory.h5")
    np.testing.assert_allclose(stored.times, np.linspace(0, 10, 101))
    # The default tolerance is 1e-10 a step, a step about 0.3.
    np.testing.assert_allclose(stored.values[:, 0], np.cos(stored.times), atol=1e-8)
    assert stored.event_names == ("high", "v = 0", "high", "high", "v = 0")
    half = math.acos(0.999)
    exact = [half, math.pi, 2 * math.pi - half, 2 * math.pi + half, 3 * math.pi]
    np.testing.assert_allclose(stored.event_times, exact, atol=1e-8)
    assert stored.event_rising.tolist() == [False, True, True, False, True]
    assert set(stored.event_modes) == {"free"}
    assert stored.header["provenance"]["plugin_sha256"]
    for words in ("5 events", "high", "falling", "from t = 0 to 10", "s_time_series.png"):
        assert words in done.out
    with (spring / "s_events.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["t"]) for row in rows] == stored.event_times.tolist()
    assert float(rows[0]["before.x"]) == stored.event_before[0, 0]


def test_settling_and_perturbation(contwalk, spring):
    changes = [
        "start={equilibrium: rest}", "simulate={until: settled, perturb: {x: 0.5}}", "parameters.damping=0.5"
    ]  # fmt: skip
    options = [word for change in changes for word in ("--set", change)]
    done = contwalk("simulate", "s.yaml", *options, "--no-figures", "--output", "d.h5")
    assert done.code == 0
    assert "settled" in done.out
    assert "NOT" not in done.out
    stored = read_trajectory(spring / "d_trajectory.h5")
    assert stored.values[0].tolist() == [0.5, 0.0]
    assert np.abs(stored.values[-1]).max() < 1e-6  # as far as extremes may differ
    assert not list(spring.glob("d_*.png"))


def test_from_a_stored_point(contwalk, folder):
    assert contwalk("continue", "run.yaml", "--quiet").code == 0
    text = "system: ./fork.py\nstart: {from: fork.h5, point: b1/0}\n"
    text += "simulate: {until: 1, perturb: {x: 0.01}}\n"
    (folder / "from.yaml").write_text(text)
    assert contwalk("simulate", "from.yaml").code == 0
    stored = read_trajectory(folder / "from_trajectory.h5")
    r = stored.parameters["r"]
    # Linear to 1e-4 of itself: x stays near 0.01.
    assert stored.values[-1, 0] == pytest.approx(0.01 * math.exp(r), rel=1e-3)


def test_files_that_exist_are_kept_unless_told_otherwise(contwalk, spring):
    assert contwalk("simulate", "s.yaml", "--quiet").code == 0
    again = contwalk("simulate", "s.yaml")
    assert again.code == 2
    assert "exists" in again.err
    assert contwalk("simulate", "s.yaml", "--force", "--quiet").out == ""


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("simulate.until=-1", "Allowed: settled, or a positive"),
        ("simulate.points=1", "simulate.points"),
        ("simulate.perturb.z=1", "'z' is not a state"),
        ("simulate.method=euler", "Allowed: dop853, verner98, radau5, radau9"),
        ("simulate.tolerance=1e-20", "finer than double precision"),
        ("simulate.untill=3", "Did you mean 'until'"),
        ("start=null", "the key is missing"),
        ("start=[{equilibrium: rest}, {state: {x: 1, v: 0}}]", "has 2 starts"),
        ("figures=[{phase_portrait: {x: x}}]", "says of no plane"),
        ("figures=[{phase_portrait: {x: x, y: w}}]", "'w' is not a state"),
        ("figures=[{time_series: {z: x}}]", "has no third axis"),
    ],
)
def test_bad_input_is_a_sentence_and_writes_nothing(contwalk, spring, change, said):
    done = contwalk("simulate", "s.yaml", "--set", change)
    assert done.code == 2
    assert said in done.err
    assert "s.yaml" in done.err
    assert not list(spring.glob("s_*"))


def test_a_motion_that_ends_early_is_stored_and_told(contwalk, folder):
    (folder / "up.py").write_text(
        "from contwalk.system import Mode, State, System\n"
        "def field(t, x, p, dx):\n    dx[0] = x[0] * x[0]\n"
        "SYSTEM = System(name='up', states=(State('x'),), parameters=(), modes=(Mode('m', field),))\n"
    )
    (folder / "up.yaml").write_text("system: ./up.py\nstart: {state: {x: 1}}\nsimulate: {until: 2}\n")
    done = contwalk("simulate", "up.yaml")
    assert done.code == 1
    assert "ended early" in done.err
    stored = read_trajectory(folder / "up_trajectory.h5")
    assert stored.status != "ok"
    assert 0.9 < stored.times[-1] <= 1.0 + 1e-6  # x = 1 / (1 - t)


def test_warmup_says_what_it_did_and_where(contwalk, monkeypatch, tmp_path):
    from contwalk.workflow import warming

    folder = tmp_path / "cache"
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(folder))

    def compile_it():
        (folder / "objects").mkdir(parents=True, exist_ok=True)
        (folder / "objects" / "part.o").write_bytes(b"code")

    def nothing():
        pass

    parts = dict.fromkeys(warming.parts(), nothing)
    parts[next(iter(parts))] = compile_it
    monkeypatch.setattr(warming, "parts", lambda: parts)
    done = contwalk("warmup")
    assert done.code == 0
    lines = done.out.splitlines()
    assert "compiled" in lines[0]
    assert "was there" in lines[1]
    assert f"cache: {folder}" in done.out
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(tmp_path / "none"))
    monkeypatch.setattr(warming, "parts", lambda: dict.fromkeys(parts, nothing))
    assert {part.state for part in warming.warm()[0]} == {"not kept"}


@pytest.mark.parametrize("system", ["./spring.py", "./hard.py"])
def test_portraits_have_no_corners_however_few_instants_are_stored(contwalk, spring, monkeypatch, system):
    seen, draw = [], plotting.plot_phase_portrait

    def watched(curves, *given, **options):
        seen.extend(curves)
        return draw(curves, *given, **options)

    monkeypatch.setattr(plotting, "plot_phase_portrait", watched, raising=False)
    given = (f"system={system}", "parameters.level=0.5", "simulate.points=7", "simulate.until=20")
    assert contwalk("simulate", "s.yaml", *(word for one in given for word in ("--set", one))).code == 0
    assert len(read_trajectory("s_trajectory.h5").times) < 60  # both sides of each impact among them
    (curve,) = seen
    radius, way = np.hypot(*curve.T), np.hypot(*np.diff(curve, axis=0).T)
    np.testing.assert_allclose(radius[np.isfinite(radius)], 1.0, atol=1e-6)  # x = cos t, reflected by impacts
    # A step of order eight is one to two radians long, and eight parts of it are drawn.
    assert np.nanmax(way) < 0.35
