"""A forced oscillator between two stops at +-1 that it touches at once: x'' + 2 z x' + x = A cos w t.

Nobody has declared the symmetry. The motion without impacts has the amplitude A / |1 - w^2 + 2 i z w|: at the
force at which it is one there are orbits that hit both stops, and such that hit one.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, diagram, machine

import contwalk as cw
from contwalk.branch import Branch
from contwalk.system import System, Transition

W, Z, R = 0.8, 0.1, 0.8
TOUCHES = math.hypot(1.0 - W * W, 2.0 * Z * W)
WALKED = 100.0 * ACCURACY


def between_stops() -> System:
    def free(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = p.A * math.cos(W * t) - x[0] - 2.0 * Z * x[1]

    def bounce(t, x, p, after):
        after[0] = x[0]
        after[1] = -R * x[1]

    return machine(
        ["x", "v"],
        {"A": 0.3},
        {"free": free},
        [
            Transition("right", "free", "free", lambda t, x, p: 1.0 - x[0], reset=bounce),
            Transition("left", "free", "free", lambda t, x, p: 1.0 + x[0], reset=bounce),
        ],
        period=lambda p: 2.0 * math.pi / W,
    )


@pytest.fixture(scope="module")
def found() -> list[Branch]:
    return diagram(
        between_stops(), "A", (0.36, 0.45), [0.0, 0.0], {"A": 0.38}, until="settled",
        events={"GR": "switch"}, depth=2,
    )  # fmt: skip


def test_all_orbits_that_begin_there_are_offered(found) -> None:
    quiet, *others = found
    assert sorted(sorted(b.info.signature) for b in others) == [["left"], ["left", "right"], ["right"]]
    (point,) = [p for p in quiet.special_points if p.label == "GR"]
    assert_met(point, "A", TOUCHES)
    for branch in others:
        assert branch["A"].min() == pytest.approx(TOUCHES, abs=WALKED)
        assert branch["A"].max() == pytest.approx(0.45, abs=WALKED)
        assert np.all(branch["admissible"][~branch["special"]])


def test_the_orbit_that_hits_both_stops_is_its_own_image(found) -> None:
    (both,) = [b for b in found if len(b.info.signature) == 2]
    for row in both.points[~both["special"]]:
        first, second = row["unknowns"][:2], row["unknowns"][2:4]
        np.testing.assert_allclose(first, -second, rtol=0, atol=WALKED)


@pytest.mark.long
def test_the_orbits_that_hit_one_stop_are_images_of_each_other(found) -> None:
    right, left = (next(b for b in found if b.info.signature == (name,)) for name in ("right", "left"))
    last = (right.points[~right["special"]][-1], left.points[~left["special"]][-1])
    np.testing.assert_allclose(last[0]["unknowns"][:2], -last[1]["unknowns"][:2], rtol=0, atol=WALKED)
    assert last[0]["free"] == pytest.approx(last[1]["free"])


# -- a start from a stored point at which an impact ceases ---

ONE_STOP = f"""
import math
from contwalk.system import Mode, Parameter, State, System, Transition

def free(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.A * math.cos({W} * t) - x[0] - {2.0 * Z} * x[1]

def bounce(t, x, p, after):
    after[0] = x[0]
    after[1] = -{R} * x[1]

SYSTEM = System(
    name="one_stop",
    states=(State("x"), State("v")),
    parameters=(Parameter("A", 0.38),),
    modes=(Mode("free", free),),
    transitions=(Transition("hit", "free", "free", lambda t, x, p: 1.0 - x[0], reset=bounce),),
    period=lambda p: 2.0 * math.pi / {W},
)
"""


def ran(folder: Path, name: str, start: dict, grazing: str) -> list[Branch]:
    text = {
        "contwalk": 1,
        "system": "./one_stop.py",
        "start": start,
        "continue": {"parameter": "A", "range": [0.36, 0.52]},
        "events": {"GR": grazing},
        "diagram": {"follow": "none", "depth": 1},
        "output": f"{name}.h5",
    }
    (folder / f"{name}.yaml").write_text(json.dumps(text), encoding="utf-8")  # JSON is YAML
    run_file = cw.read_run_file(folder / f"{name}.yaml", output=folder / f"{name}.h5")
    return cw.run(run_file, figures=False).branches


@pytest.mark.long
def test_a_start_where_an_impact_ceases_goes_both_ways_as_the_machine_does(tmp_path):
    """From an orbit with impacts down to the point, and from there: with impacts up, without them down."""
    (tmp_path / "one_stop.py").write_text(ONE_STOP, encoding="utf-8")
    at_rest = {"simulate": {"state": {"x": 0.0, "v": 0.0}, "until": "settled"}}
    _, hits = ran(tmp_path, "first", at_rest, "switch")
    flip = next(p for p in hits.special_points if p.label == "PD")
    (again,) = ran(tmp_path, "second", {"from": "first.h5", "point": f"b2/{flip.name}"}, "stop")
    ceases = next(p for p in again.special_points if p.label == "GR")
    assert ceases.kind == "terminal"
    hits, quiet = ran(tmp_path, "third", {"from": "second.h5", "point": f"b1/{ceases.name}"}, "switch")
    assert hits.info.signature == ("hit",)
    assert not quiet.info.signature
    for branch, side in ((hits, 1.0), (quiet, -1.0)):
        rows = branch.points[~branch["special"]]
        assert np.all(rows["admissible"])
        assert np.all(side * (rows["free"][:, 0] - TOUCHES) > -WALKED)
