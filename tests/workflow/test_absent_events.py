"""Events at which a run file or an observable asks for a state, and which a branch's orbits do not have."""

from __future__ import annotations

import json

import numpy as np

from contwalk.cli.entry import run
from contwalk.storage import open_database

# A driven cart before a wall on its right, and another one far on its left that it never reaches.
CART = """\
import math
from contwalk.system import Mode, Observable, Parameter, State, System, Transition

def roll(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(t) - 0.3 * x[1] - 0.4 * x[0] + 0.5

def bump(t, x, p, after):
    after[0] = x[0]
    after[1] = -0.5 * x[1]

SYSTEM = System(
    "cart",
    states=(State("s"), State("v")),
    parameters=(Parameter("force", 1.0),),
    modes=(Mode("rolling", roll),),
    transitions=(
        Transition("wall", "rolling", "rolling", lambda t, x, p: 1.5 - x[0], reset=bump),
        Transition("far", "rolling", "rolling", lambda t, x, p: x[0] + 40.0, reset=bump),
        Transition("top", "rolling", "rolling", lambda t, x, p: x[1], role="watched"),
    ),
    observables=(OBSERVABLES),
    period=lambda p: 2.0 * math.pi,
)
"""
RUN = """\
contwalk: 1
system: ./cart.py
start: {simulate: {state: {s: 1.0, v: 0.2}, until: settled}}
continue: {parameter: force, range: [0.95, 1.3], max_points: 4}
diagram: none
output: out.h5
"""
FAR = (
    "Observable('speed', lambda t, x, p: x[1], at='far'), Observable('hit', lambda t, x, p: x[1], at='wall'),"
)
HIT = "Observable('hit', lambda t, x, p: x[1], at='wall'),"


def told(folder, monkeypatch, capsys, observables="", report="", more=(), cart=CART):
    """What a run prints, its notes, and its branches."""
    monkeypatch.chdir(folder)
    (folder / "cart.py").write_text(cart.replace("OBSERVABLES", observables))
    (folder / "run.yaml").write_text(RUN + report)
    assert run(("continue", "run.yaml", "--no-figures", "--force", *more)) == 0
    printed = " ".join("".join(capsys.readouterr()).split())
    assert run(("show", "out.h5", "--json")) == 0
    stored = json.loads(capsys.readouterr().out)["notes"]
    notes = [note["text"] for note in stored if not note["key"].startswith("method")]
    with open_database("out.h5") as db:
        return printed, notes, list(db)


def test_reported_state_is_told_absent(tmp_path, monkeypatch, capsys):
    printed, notes, (branch,) = told(tmp_path, monkeypatch, capsys, HIT, "report_at: {event: far}\n")
    assert np.isnan(branch.points["state"]).all()
    (note,) = notes
    why = "which never happens on them"
    assert note.startswith(f"b1, its orbits: `report_at` asks for their state at 'far', {why}")
    assert "NaN is stored as their state. They have 'wall'. Let `report_at` name one of these" in note
    assert " ".join(note.split()) in printed


def test_report_at_a_watched_event_is_refused_with_its_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cart.py").write_text(CART.replace("OBSERVABLES", ""))
    (tmp_path / "run.yaml").write_text(RUN + "report_at: {event: top}\n")
    assert run(("continue", "run.yaml", "--no-figures")) == 2
    printed = " ".join("".join(capsys.readouterr()).split())
    line = RUN.count("\n") + 1
    assert f"run.yaml, line {line}, key report_at.event: 'top' is only watched" in printed
    assert "Allowed: wall, far." in printed
    assert "{section: {s: 0.0}}" in printed
    assert not (tmp_path / "out.h5").exists()


# The cart with a spring that it meets softly on its left.
SPRING = (
    CART.replace('(Mode("rolling", roll),)', '(Mode("rolling", roll), Mode("pressed", press))')
    .replace('Transition("far", "rolling", "rolling", lambda t, x, p: x[0] + 40.0, reset=bump)', "SOFT")
    .replace(
        "SOFT",
        'Transition("meets", "rolling", "pressed", lambda t, x, p: x[0] - 0.3, role="soft"),\n'
        '        Transition("leaves", "pressed", "rolling", lambda t, x, p: x[0] - 0.3, "rising", '
        'role="soft")',
    )
    .replace(
        "def bump(",
        "def press(t, x, p, dx):\n    roll(t, x, p, dx)\n    dx[1] = dx[1] - 0.8 * (x[0] - 0.3)\n\ndef bump(",
    )
)


def test_states_at_soft_events_are_told_where_they_happen(tmp_path, monkeypatch, capsys):
    """They come and go along a branch, and are not in its signature: a note said that there are none."""
    speed = "Observable('speed', lambda t, x, p: x[1], at='meets'),"
    report = "report_at: {event: meets}\n"
    _, notes, (branch,) = told(tmp_path, monkeypatch, capsys, speed, report, cart=SPRING)
    assert notes == []
    assert np.allclose(branch["s"], 0.3, atol=1e-12)
    assert (branch["speed"] < 0.0).all()


def test_one_note_names_all_and_is_told_again_with_resume(tmp_path, monkeypatch, capsys):
    printed, (note,), (branch,) = told(tmp_path, monkeypatch, capsys, FAR, "report_at: {event: far}\n")
    assert np.isnan(branch["speed"]).all()
    assert np.isfinite(branch["hit"]).all()
    assert "Observable 'speed' is taken at 'far', which never happens on them: it is NaN." in note
    assert "'hit'" not in note
    assert run(("continue", "run.yaml", "--no-figures", "--resume")) == 0
    again = " ".join("".join(capsys.readouterr()).split())
    assert " ".join(note.split()) in printed
    assert " ".join(note.split()) in again


def test_observable_without_value_at_an_event_that_happens(tmp_path, monkeypatch, capsys):
    """It is no number everywhere, though its event happens: that is told as of any observable."""
    wrong = "Observable('root', lambda t, x, p: x[1] * math.nan, at='wall'),"
    _, (note,), (branch,) = told(tmp_path, monkeypatch, capsys, wrong)
    assert f"observable 'root' is not a number at {len(branch)} of {len(branch)} points" in note


def test_condition_without_value_at_an_event_that_happens(tmp_path, monkeypatch, capsys):
    """Orbits were told to be not admissible, and nothing said why."""
    wrong = (
        "    conditions=(Condition('root', lambda t, x, p: math.sqrt(x[0] - 9.0), at='wall'),),\n    period="
    )
    cart = CART.replace("    period=", wrong).replace("import Mode", "import Condition, Mode")
    printed, (note,), (branch,) = told(tmp_path, monkeypatch, capsys, cart=cart)
    line = 1 + cart[: cart.index("conditions=")].count("\n")
    assert f"cart.py, line {line}: condition 'root' is not a number at {len(branch)} of" in note
    assert not branch["admissible"].any()
    assert " ".join(note.split()) in printed


def test_section_that_no_orbit_passes(tmp_path, monkeypatch, capsys):
    report = "report_at: {section: {s: 9.0}, direction: rising}\n"
    printed, (note,), (branch,) = told(tmp_path, monkeypatch, capsys, HIT, report)
    assert f"its orbits never pass s = 9 at {len(branch)} of {len(branch)} points" in note
    assert " ".join(note.split()) in printed


def test_events_that_happen_are_no_matter_of_notes(tmp_path, monkeypatch, capsys):
    _, notes, (branch,) = told(tmp_path, monkeypatch, capsys, HIT, "report_at: {event: wall}\n")
    assert notes == []
    assert np.isfinite(branch["hit"]).all()
