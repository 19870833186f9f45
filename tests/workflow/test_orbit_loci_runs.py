"""Curves of special points of orbits end to end: run file, database, JSON, figure, going on."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path

import jsonschema
import numpy as np
import pytest

import contwalk as cw
from contwalk.errors import ContwalkError
from contwalk.storage.document import document

pytestmark = pytest.mark.slow

CYCLES = '''
"""Cycles that fold: r' = r (mu - 1 + a r^2 - r^4)."""
from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    s = x[0] ** 2 + x[1] ** 2
    g, w = p.mu - 1.0 + p.a * s - s * s, 3.0 + 0.4 * s
    dx[0] = g * x[0] - w * x[1]
    dx[1] = w * x[0] + g * x[1]


SYSTEM = System(
    "cycles",
    states=(State("x"), State("y")),
    parameters=(Parameter("mu", 0.9), Parameter("a", 1.0)),
    modes=(Mode("only", field),),
)
'''
ONE = """
system: ./cycles.py
start: {simulate: {state: {x: 1.0, y: 0.0}, until: settled}}
continue: {parameter: mu, range: [0.6, 0.95]}
diagram: none
output: one.h5
"""
TWO = """
system: ./cycles.py
start: {from: one.h5, point: b1/LP1}
continue: {parameters: [mu, a], range: {mu: [0.5, 0.95], a: [0.3, 1.6]}}
output: two.h5
figures: [locus]
"""
ALL = """
system: ./cycles.py
start: {simulate: {state: {x: 1.0, y: 0.0}, until: settled}}
continue: {parameter: mu, range: [0.6, 1.02]}
diagram: none
loci: {with: a, range: [0.5, 1.4], of: all, follow: none}
output: all.h5
"""
STOP = """
system: impact_oscillator
start: {simulate: {state: {q: 0.0, v: 0.0}, until: settled}}
parameters: {omega: 0.98, zeta: 0.05, force: 0.09}
continue: {parameter: force, range: [0.08, 0.4], direction: forward}
events: {GR: switch}
diagram: {follow: [], depth: 1}
output: stop.h5
"""
# The motion without impacts touches the stop; the one with an impact doubles.
CURVES = """
system: impact_oscillator
start: [{from: stop.h5, point: b1/GR1}, {from: stop.h5, point: b2/PD1}]
parameters: {zeta: 0.05}
continue: {parameters: [force, omega], range: {force: [0.05, 0.7], omega: [0.94, 0.99]}}
output: curves.h5
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("orbit_loci")
    (folder / "cycles.py").write_text(CYCLES)
    for name, text in (("one", ONE), ("two", TWO), ("all", ALL), ("stop", STOP), ("curves", CURVES)):
        (folder / f"{name}.yaml").write_text(text)
    computed(folder, "one")
    computed(folder, "stop")
    return folder


def computed(place: Path, name: str, *overrides: str, output: str = "", **options: bool) -> Path:
    run_file = cw.read_run_file(place / f"{name}.yaml", overrides, str(place / (output or f"{name}.h5")))
    return cw.run(run_file, **options).path


@pytest.fixture(scope="module")
def two(place) -> Path:
    return computed(place, "two")


@pytest.fixture(scope="module")
def curves(place) -> Path:
    return computed(place, "curves")


def test_a_fold_of_another_database(place, two) -> None:
    with cw.open_database(two) as db:
        branch = db.branch("b1")
    assert branch.info.free == ("mu", "a")
    np.testing.assert_array_equal(branch["a"], branch.points["free"][:, 1])
    np.testing.assert_allclose(branch["mu"], 1.0 - branch["a"] ** 2 / 4.0, atol=1e-6)
    assert sorted(p.label for p in branch.special_points) == ["EP", "EP"]
    assert list(place.glob("two*.png"))


def test_the_document_obeys_version_2_of_the_schema(two, curves) -> None:
    schema = json.loads(files("contwalk.storage").joinpath("interface.schema.json").read_text())
    for path, problem in ((two, "periodic_orbit"), (curves, "hybrid_orbit")):
        with cw.open_database(path) as db:
            told = document(db, points=True)
        jsonschema.validate(told, schema)
        assert told["schema_version"] == 2
        assert {(curve["problem"], curve["of_problem"]) for curve in told["branches"]} == {("locus", problem)}
        for curve in told["branches"]:
            for point in curve["special_points"]:
                assert point["label"] == "EP" or set(point["errors"]) == set(curve["free"])


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("name", "points"), [("two", 25), ("curves", 30)])
def test_a_curve_that_was_cut_goes_on_to_the_last_bit(place, name, points, request) -> None:
    whole = request.getfixturevalue(name)
    computed(place, name, f"continue.max_points={points}", output=f"cut_{name}.h5", figures=False)
    path = computed(place, name, output=f"cut_{name}.h5", resume=True, figures=False)
    with cw.open_database(whole) as first, cw.open_database(path) as second:
        assert first.branch_names() == second.branch_names()
        for branch in first.branch_names():
            a, b = first.branch(branch), second.branch(branch)
            assert [p.name for p in a.special_points] == [p.name for p in b.special_points]
            for column in a.points.dtype.names or ():
                if column != "seconds":
                    np.testing.assert_array_equal(
                        a.points[column], b.points[column], err_msg=f"{branch} {column}"
                    )


@pytest.mark.long
def test_curves_of_all_points_of_a_study(place) -> None:
    path = computed(place, "all", figures=False)
    with cw.open_database(path) as db:
        branches = [db.branch(name) for name in db.branch_names()]
    curves = [
        (b.info.settings["of"], b.info.settings["of_problem"]) for b in branches if b.info.problem == "locus"
    ]
    assert ("LP", "periodic_orbit") in curves


def test_curves_of_a_machine_with_impacts(curves) -> None:
    with cw.open_database(curves) as db:
        branches = [db.branch(name) for name in db.branch_names()]
    graze, double = (
        next(b for b in branches if b.info.problem == "locus" and b.info.settings["of"] == of)
        for of in ("GR", "PD")
    )
    omega = graze["omega"]
    touch = np.sqrt((1.0 - omega**2) ** 2 + (0.1 * omega) ** 2)
    np.testing.assert_allclose(graze["force"], touch, rtol=1e-6)
    # Linear impacts in closed form, with 40 digits.
    (met,) = [p for p in double.special_points if p.label == "GPD"]
    assert met.parameters["omega"] == pytest.approx(0.9518145295409529, rel=1e-10)
    for w, force in ((0.98, 0.363786754160693626), (0.95, 0.535598788700668797)):
        near = np.argsort(np.abs(double["omega"] - w))[:4]
        found = np.polyval(np.polyfit(double["omega"][near] - w, double["force"][near], 3), 0.0)
        assert found == pytest.approx(force, rel=1e-4)
    assert double.info.signature == ("impact",)


def test_points_of_curves_are_no_starts(place, two) -> None:
    (place / "three.yaml").write_text(
        TWO.replace("one.h5", "two.h5").replace("LP1", "EP1").replace("output: two", "output: three")
    )
    with pytest.raises(ContwalkError, match="a special point of such a curve"):
        computed(place, "three")
