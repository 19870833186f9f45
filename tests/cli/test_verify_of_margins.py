"""`contwalk verify` of margins: what agrees, what was made wrong, what cannot be told."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from contwalk.storage.trajectory import read_margins, write_margins

# A ball on springs beside a wall off which it bounces, lost beyond a place on the other side.
PLUGIN = """\
from contwalk.system import Mode, Parameter, Start, State, System, Transition

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0] - 0.2 * x[1] + p.pull

def bounce(t, x, p, after):
    after[0] = x[0]
    after[1] = -0.9 * x[1]

SYSTEM = System(
    name="walled",
    states=(State("x"), State("v")),
    parameters=(Parameter("pull", 0.0),),
    modes=(Mode("free", field),),
    transitions=(Transition("wall", "free", "free", lambda t, x, p: x[0] + 1.0, reset=bounce),),
    starts=(Start("rest", lambda p: [[0.0, 0.0]]),),
    fallen=lambda t, x, p: x[0] - 1.5,
)
WELLS = System(
    name="wells",
    states=(State("x", scale=1.0), State("v", scale=1.0)),
    parameters=(Parameter("pull", 0.0),),
    modes=(Mode("free", lambda t, x, p, dx: _wells(x, p, dx)),),
    starts=(Start("rest", lambda p: [[1.0, 0.0], [-1.0, 0.0]]),),
)

def _wells(x, p, dx):
    dx[0] = x[1]
    dx[1] = x[0] - x[0] ** 3 - 0.5 * x[1] + p.pull
"""
STUDY = """\
system: ./{name}.py
start: {{equilibrium: rest}}
continue: {{parameter: pull, range: [0.0, 0.1], max_points: 2, direction: up}}
diagram: none
margins: {{of: {{from: {name}.h5, point: b1/0}}, survive: {{time: 12}}, {wanted}}}
output: {name}.h5
"""
WALLED, WELLS = "accuracy: 1e-4", "basin: {states: {x: [-2, 2], v: [-1, 1]}, cells: 5, levels: 1}"


@pytest.fixture
def made(folder, contwalk):
    """The file of margins of a study."""

    def found(name, wanted):
        text = (
            PLUGIN
            if name == "walled"
            else PLUGIN.replace("SYSTEM =", "_OTHER =").replace("WELLS =", "SYSTEM =")
        )
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
        (folder / f"{name}.yaml").write_text(STUDY.format(name=name, wanted=wanted), encoding="utf-8")
        for command in ("continue", "margins"):
            assert contwalk(command, f"{name}.yaml", "--quiet", "--no-figures").code == 0
        return f"{name}_margins.h5"

    return found


def verdicts(contwalk, file, *more):
    done = contwalk("verify", "--trust", str(file), "--json", *more)
    shown = json.loads(done.out)
    return done.code, shown["points"] + shown["rows"]


def changed(file, **rows_or_basin):
    margins = replace(read_margins(file), **rows_or_basin)
    return write_margins(Path("wrong_margins.h5"), margins)


def test_borders_of_survival(contwalk, made):
    file = made("walled", WALLED)
    code, found = verdicts(contwalk, file, "--budget", "60")
    assert (code, len(found)) == (0, 4)
    assert {each["verdict"] for each in found} == {"AGREES"}
    rows = read_margins(file).rows
    wrong = [
        (0, {"border": 1.01 * rows[0]["border"], "borders": [1.01 * rows[0]["border"]]}),
        (0, {"border": rows[0]["border"], "borders": [1.1]}),
        (1, {"ends": "fallen"}),
        (2, {"border": None, "borders": [], "ends": "survived"}),
        (3, {"border": 0.9 * rows[3]["border"], "borders": [0.9 * rows[3]["border"]]}),
    ]
    assert rows[1]["ends"] == "beyond_guard"
    for number, change in wrong:
        false = changed(file, rows=({**rows[number], **change},))
        code, found = verdicts(contwalk, false, "margins", "--budget", "60")
        assert (code, found[0]["verdict"]) == (1, "DISAGREES"), change


def test_what_motions_of_a_plane_come_to(contwalk, made):
    file = made("wells", WELLS)
    code, found = verdicts(contwalk, file, "--budget", "60")
    margins = read_margins(file)
    assert {"b1/0", "b2/0"} <= set(margins.basin["labels"])
    assert code == 0
    assert len(found) >= len(margins.basin["labels"]) // 10
    assert [each["verdict"] for each in found].count("AGREES") >= len(found) - 1  # one may lie on a border
    turned = {"b1/0": "b2/0", "b2/0": "b1/0"}
    labels = tuple(turned.get(label, label) for label in margins.basin["labels"])
    code, found = verdicts(contwalk, changed(file, basin={**margins.basin, "labels": labels}), "basin")
    assert code == 1
    told = [each["verdict"] for each in found]
    assert told.count("DISAGREES") >= sum(label == "b1/0" for label in labels) // 10


def test_without_the_solution_it_is_told_what_is_missing(contwalk, made, folder):
    file = made("walled", WALLED)
    nothing = contwalk("verify", "--trust", file, "basin")
    assert (nothing.code, "has no 'basin'" in nothing.err) == (2, True)
    (folder / "walled.h5").unlink()
    done = contwalk("verify", "--trust", file)
    assert done.code == 2
    assert "is in walled.h5, which is not there" in done.err


def test_a_budget_leaves_borders_out(contwalk, made):
    done = contwalk("verify", "--trust", made("walled", WALLED), "--budget", "1e-9")
    assert (done.code, done.out.count("the budget of CPU is used up")) == (0, 4)
