"""Curves in two parameters end to end: run file, database, JSON, figures, going on."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from demo_ab import AB

import contwalk as cw
from contwalk.errors import ContwalkError, NotFinite
from contwalk.storage.document import document
from contwalk.studies import loci as studies_of_loci
from contwalk.workflow import runner
from contwalk.workflow.run_file.reading import read_run_file

PLUGIN = '''
"""Bazykin's predator and prey."""
from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    eaten = x[0] * x[1] / (1.0 + p.alpha * x[0])
    dx[0] = x[0] - eaten - 0.01 * x[0] ** 2
    dx[1] = -x[1] + eaten - p.delta * x[1] ** 2


SYSTEM = System(
    "bazykin",
    states=(State("x"), State("y")),
    parameters=(Parameter("alpha", 0.3), Parameter("delta", 0.2)),
    modes=(Mode("only", field),),
)
'''
ONE = """
system: ./bazykin.py
start: {state: {x: 2.0, y: 2.0}}
continue: {parameter: alpha, range: [0.01, 0.9]}
diagram: none
output: one.h5
"""
TWO = """
system: ./bazykin.py
start: [{from: one.h5, point: b1/HB1}, {from: one.h5, point: b1/LP1}, {from: one.h5, point: b1/HB2}]
continue: {parameters: [alpha, delta], range: {alpha: [0.01, 2.0], delta: [0.001, 1.0]}}
output: two.h5
figures: [locus]
"""
ALL = """
system: ./bazykin.py
start: {state: {x: 2.0, y: 2.0}}
continue: {parameter: alpha, range: [0.01, 0.9]}
diagram: none
loci: {with: delta, range: [0.001, 1.0], of: HB, follow: all}
output: all.h5
"""
FOLD = """
from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = p.a + p.b - x[0] ** 2


SYSTEM = System(
    "fold",
    states=(State("x"),),
    parameters=(Parameter("a", 1.0), Parameter("b", 0.0)),
    modes=(Mode("only", field),),
)
"""
FOLDING = """
system: ./fold.py
start: {state: {x: 1.0}}
continue: {parameter: a, range: [-1.0, 1.0]}
loci: {with: b, range: [-1.0, 1.0]}
output: fold.h5
"""
AB_RUN = """
system: ./ab.py
start: {state: {u1: 0.0, u2: 0.0}}
continue: {parameter: p1, range: [0.0, 0.5]}
diagram: none
loci: {with: p2, range: [10.0, 25.0], of: all, follow: [BT]}
"""
# Recomputed with 40 digits; alpha and delta of the Bogdanov-Takens point.
BT = (0.45362432777812945522, 0.17512759295021742421)


@pytest.fixture(scope="module")
def place(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("loci")
    (folder / "bazykin.py").write_text(PLUGIN)
    (folder / "one.yaml").write_text(ONE)
    (folder / "two.yaml").write_text(TWO)
    (folder / "all.yaml").write_text(ALL)
    cw.run(cw.read_run_file(folder / "one.yaml", output=str(folder / "one.h5")))
    return folder


def computed(place: Path, name: str, *overrides: str, output: str = "", **options: bool) -> cw.run:
    run_file = cw.read_run_file(place / f"{name}.yaml", overrides, str(place / (output or f"{name}.h5")))
    return cw.run(run_file, **options)


@pytest.fixture(scope="module")
def two(place) -> Path:
    return computed(place, "two").path


@pytest.mark.long
def test_points_of_another_database(two) -> None:
    with cw.open_database(two) as db:
        assert db.branch_names() == ["b1", "b2"]  # HB2 lies on the curve of HB1
        assert any("b1/HB2 of one.h5 lies on branch b1" in text for text in db.notes().values())
        for name in db.branch_names():
            branch = db.branch(name)
            assert branch.info.free == ("alpha", "delta")
            point = next(p for p in branch.special_points if p.label == "BT")
            for parameter, value in zip(branch.info.free, BT, strict=True):
                error = abs(point.parameters[parameter] - value)
                assert error <= point.errors[parameter] + 2.0**-52 * value
            # A row tells both parameters, and the solution has them.
            np.testing.assert_array_equal(branch["delta"], branch.points["free"][:, 1])
            x, y = branch["x"], branch["y"]
            eaten = x * y / (1.0 + branch["alpha"] * x)
            np.testing.assert_allclose(eaten - y, branch["delta"] * y**2, atol=1e-13)


def test_the_document_obeys_version_2_of_the_schema(two) -> None:
    schema = json.loads(files("contwalk.storage").joinpath("interface.schema.json").read_text())
    with cw.open_database(two) as db:
        told = document(db, points=True)
    jsonschema.validate(told, schema)
    assert told["schema_version"] == 2
    hopf, fold = told["branches"]
    assert (hopf["problem"], hopf["of"], hopf["of_problem"]) == ("locus", "HB", "equilibrium")
    assert (fold["of"], fold["free"]) == ("LP", ["alpha", "delta"])
    kinds = [row["kind"] for row in hopf["points"]]
    assert set(kinds) == {None, "neutral_saddle"}
    for row in hopf["points"]:
        saddle = row["kind"] == "neutral_saddle"
        assert saddle == (row["observables"]["frequency_squared"] <= 0.0)
        assert not (saddle and row["stable"] and row["observables"]["frequency_squared"] < 0.0)
    point = next(p for p in hopf["special_points"] if p["label"] == "BT")
    assert point["error"] == point["errors"]["alpha"]
    assert set(point["errors"]) == {"alpha", "delta"}


def test_documents_without_curves_stay_at_version_1(place) -> None:
    with cw.open_database(place / "one.h5") as db:
        told = document(db)
    assert told["schema_version"] == 1
    assert "of" not in told["branches"][0]
    assert "errors" not in told["branches"][0]["special_points"][0]


def test_a_curve_that_was_cut_goes_on_to_the_last_bit(place, two) -> None:
    computed(place, "two", "continue.max_points=37", output="cut.h5", figures=False)
    path = computed(place, "two", output="cut.h5", resume=True, figures=False).path
    with cw.open_database(two) as whole, cw.open_database(path) as resumed:
        for name in whole.branch_names():
            a, b = whole.branch(name), resumed.branch(name)
            assert [p.name for p in a.special_points] == [p.name for p in b.special_points]
            for column in a.points.dtype.names or ():
                if column != "seconds":
                    np.testing.assert_array_equal(a.points[column], b.points[column])


def test_curves_of_all_points_of_a_study_and_those_born_on_them(place) -> None:
    path = computed(place, "all", figures=False).path
    with cw.open_database(path) as db:
        branches = {name: db.branch(name) for name in db.branch_names()}
        notes = list(db.notes().values())
    assert [b.info.settings.get("of") for b in branches.values()] == [None, "HB", "LP"]
    assert branches["b2"].info.parent[0] == "b1"
    assert branches["b3"].info.parent[0] == "b2"  # the folds are begun at BT points of the curve
    assert any("b1/HB2 lies on branch b2" in text for text in notes)
    # Its cusp lies beyond alpha = 0.9: the curve of folds leaves the range there, and comes back.
    assert len(branches["b3"].gaps()) == 1
    assert [p.status for p in branches["b3"].special_points if p.label == "BT"] == ["located", "located"]
    again = computed(place, "all", resume=True, figures=False)
    assert [b.name for b in again.branches] == list(branches)


@pytest.mark.slow
def test_points_of_the_study_begin_curves_before_points_of_curves_do(place) -> None:
    """The curve of folds meets that of Hopf points, which a point of the study begins too: the first
    generation has both, and what is born on them is the second."""
    (place / "ab.py").write_text(AB)
    (place / "ab.yaml").write_text(AB_RUN)
    path = computed(place, "ab", output="first.h5").path
    with cw.open_database(path) as db:
        branches, notes = db.branches(), db.notes()
    points = [p.label for p in branches[0].special_points if p.label in ("LP", "HB")]
    assert points[0] == "LP"  # whose curve, with all that grows out of it, would come before the other
    curves = [b for b in branches if b.info.problem == "locus"]
    assert sorted(b.info.settings["of"] for b in curves) == ["HB", "LP"]
    assert [b.info.parent[0] for b in curves] == ["b1", "b1"]
    assert "depth" not in notes


@pytest.mark.long
def test_what_is_not_followed_beyond_the_last_generation_is_told(place) -> None:
    given = ("diagram={follow: none, depth: 1}", "loci.follow=[BT]")
    path = computed(place, "all", *given, output="shallow.h5").path
    with cw.open_database(path) as db:
        branches, notes = db.branches(), db.notes()
    assert [b.info.settings.get("of") for b in branches] == [None, "HB"]
    told = [f"b2/{p.name}" for p in branches[1].special_points if p.label == "BT"]
    assert told
    assert f"What begins or crosses at {', '.join(told)} was not followed" in notes["depth"]
    assert "`diagram.depth` = 1" in notes["depth"]


def test_the_figure_of_curves(place, two) -> None:
    assert (place / "two_locus.png").stat().st_size > 10_000
    from contwalk import plotting

    with cw.open_database(two) as db:
        ax = plotting.plot_locus(db.branches())
    gids = {line.get_gid() for line in ax.lines}
    assert {"b1-0", "b1-1", "b1-2", "b2-0", "b1-BT1", "b2-CP1"} <= gids
    styles = {line.get_gid(): line.get_linestyle() for line in ax.lines}
    assert styles["b1-0"] != styles["b1-1"]  # neutral saddles
    with cw.open_database(place / "one.h5") as db:
        branches = db.branches()
    with pytest.raises(ContwalkError, match="no curve in two parameters to draw"):
        plotting.plot_locus(branches)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("continue.parameters=[alpha, alpha]", "names the same parameter twice"),
        ("continue.parameters=[alpha]", "has 1 names"),
        ("continue.parameters=[alpha, beta]", "'beta' is not a parameter of 'bazykin'"),
        ("continue.parameter=alpha", "both two parameters and a parameter are given"),
        ("continue.range=[0.1, 0.2]", "gives no range for each of two parameters"),
        ("continue.range={alpha: [0.1, 0.2]}", "delta: the key is missing"),
        ("continue.range={alpha: [0.1, 0.2], delta: [2, 1]}", "is empty or the wrong way round"),
        ("continue.range={alpha: [0.1, 0.2], delta: [1, 2], eps: [0, 1]}", "'eps' is not free"),
        ("start={state: {x: 1, y: 1}}", "starts at a special point of a database"),
        ("loci={with: delta, range: [0, 1]}", "belongs to a study along one parameter"),
    ],
)
def test_what_is_wrong_with_a_run_along_two_parameters(place, change, words) -> None:
    with pytest.raises(ContwalkError, match=words.replace("(", r"\(")):
        cw.read_run_file(place / "two.yaml", [change])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("loci={with: alpha, range: [0, 1]}", "'alpha' is continued already"),
        ("loci={with: gamma, range: [0, 1]}", "'gamma' is not a parameter"),
        ("loci={with: delta, range: [0, 1], of: [CP]}", "CP"),
        ("loci={with: delta}", "range"),
        ("continue.range={alpha: [0.1, 0.2]}", "gives ranges by name"),
    ],
)
def test_what_is_wrong_with_curves_of_a_study(place, change, words) -> None:
    with pytest.raises(ContwalkError, match=words):
        cw.read_run_file(place / "all.yaml", [change])


@pytest.mark.parametrize(
    ("point", "words"),
    [
        ("b1/EP1", "No curve in two parameters can be followed from EP1"),
        ("b1/12", "is no special point"),
        ("b1/HB7", "no special point 'HB7'"),
    ],
)
def test_points_that_no_curve_begins_at(place, point, words) -> None:
    run_file = cw.read_run_file(
        place / "two.yaml", [f"start={{from: one.h5, point: {point}}}"], str(place / "none.h5")
    )
    with pytest.raises(ContwalkError, match=words):
        cw.run(run_file)
    assert not (place / "none.h5").exists()


DOUBLE_ZERO = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0], dx[1] = x[1], p.b1 + p.b2 * x[0] + x[0] ** 2 - x[0] * x[1]

SYSTEM = System(name="double_zero", states=(State("x"), State("y")),
    parameters=(Parameter("b1", -1.2e-4), Parameter("b2", -0.01)), modes=(Mode("flow", field),))
"""
AROUND_IT = """
contwalk: 1
system: ./double_zero.py
start: {state: {x: -0.007, y: 0.0}}
continue: {parameter: b1, range: [-2.0e-4, 1.0e-4]}
diagram: {follow: none}
loci: {with: b2, range: [-0.5, 0.5], of: all, follow: all}
output: double_zero.h5
"""


def test_the_curve_of_a_double_zero_in_a_narrow_range_is_walked_once(tmp_path):
    """Hopf points b1 = 0 and folds b1 = b2^2 / 4. At the double zero itself F_x vanishes, so that its row on
    the curve of Hopf points went the way of the folds, and the curve was not known again.
    """
    (tmp_path / "double_zero.py").write_text(DOUBLE_ZERO)
    (tmp_path / "study.yaml").write_text(AROUND_IT)
    run_file = read_run_file(tmp_path / "study.yaml", output=str(tmp_path / "double_zero.h5"))
    curves = runner.run(run_file, figures=False).branches[1:]
    assert [curve.info.settings["of"] for curve in curves] == ["HB", "LP"]
    for curve in curves:
        assert [p.label for p in curve.special_points].count("BT") == 1


def test_a_study_without_the_points_that_are_asked_for_says_that_there_is_no_curve(tmp_path):
    (tmp_path / "bazykin.py").write_text(PLUGIN)
    study = ALL.replace("[0.01, 0.9]", "[0.9, 1.0]").replace("x: 2.0, y: 2.0", "x: 50.0, y: 2.0")
    (tmp_path / "none.yaml").write_text(study.replace("start: {", "parameters: {alpha: 0.95}\nstart: {"))
    notes = []

    class Told(runner.Reporter):
        def note(self, text):
            notes.append(text)

    run_file = read_run_file(tmp_path / "none.yaml", output=str(tmp_path / "none.h5"))
    runner.run(run_file, figures=False, reporter=Told())
    assert runner.NO_CURVE in notes


class Told(runner.Reporter):
    """What is told, until Ctrl-C at the point of a given number."""

    def __init__(self, points=None):
        self.notes, self.left = [], points

    def note(self, text):
        self.notes.append(text)

    def point(self, *told):
        if self.left is not None:
            self.left -= 1
            if not self.left:
                raise KeyboardInterrupt


def test_a_study_that_was_interrupted_before_its_curves_does_not_say_that_there_are_none(tmp_path):
    (tmp_path / "bazykin.py").write_text(PLUGIN)
    (tmp_path / "all.yaml").write_text(ALL)
    run_file = read_run_file(tmp_path / "all.yaml", output=str(tmp_path / "all.h5"))
    told = Told(3)
    assert runner.run(run_file, figures=False, reporter=told).interrupted
    assert runner.NO_CURVE not in told.notes


def test_that_there_was_no_curve_is_no_longer_said_when_there_is_one(tmp_path):
    """A study goes on, with more points, to the fold that its first points did not reach."""
    (tmp_path / "fold.py").write_text(FOLD)
    (tmp_path / "fold.yaml").write_text(FOLDING)
    notes = []
    for number in (2, 200):
        told = Told()
        changes = [f"continue.max_points={number}"]
        run_file = read_run_file(tmp_path / "fold.yaml", changes, output=str(tmp_path / "fold.h5"))
        runner.run(run_file, figures=False, reporter=told, resume=number > 2)
        with cw.open_database(tmp_path / "fold.h5") as database:
            notes.append((runner.NO_CURVE in told.notes, "loci" in database.notes()))
            curves = [branch for branch in database.branches() if branch.info.problem == "locus"]
    assert notes == [(True, True), (False, False)]
    # x is zero to rounding all along: by what it does not do any magnitude is told of it, and errors of 110.
    assert np.nanmax(curves[0].points["error"]) < 1e-14  # in the metric: some ulps of parameters of size one


@pytest.mark.long
def test_a_start_beside_which_equations_have_no_value_does_not_end_the_run(place, monkeypatch):
    """What is beside it is asked of the walk: the curves from the other starts are walked all the same."""

    def valueless(*_: object) -> None:
        raise NotFinite("the equations have no value there")

    monkeypatch.setattr(studies_of_loci, "correct", valueless)
    result = computed(place, "two", output="valueless.h5", figures=False)
    assert [branch.info.settings["of"] for branch in result.branches] == ["HB", "LP"]


def test_a_curve_that_cannot_be_begun_is_told_as_one(place, monkeypatch) -> None:
    def valueless(*args, **others) -> None:
        raise NotFinite("the equations have no value there")

    monkeypatch.setattr(studies_of_loci, "begin", valueless)
    result = computed(place, "two", output="unbegun.h5", figures=False)
    assert {branch.outcome.status for branch in result.branches} == {"failed"}
    with cw.open_database(result.path) as db:
        told = document(db)
    jsonschema.validate(
        told, json.loads(files("contwalk.storage").joinpath("interface.schema.json").read_text())
    )
    curves = [(b["problem"], b["of"], b["of_problem"], b["free"]) for b in told["branches"]]
    both = ["alpha", "delta"]
    assert curves[:2] == [("locus", of, "equilibrium", both) for of in ("HB", "LP")]
