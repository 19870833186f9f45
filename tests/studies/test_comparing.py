"""`diff`: what is the same is told to be, and whatever is turned or moved is found."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import contwalk as cw
from contwalk.branch import Branch, BranchInfo
from contwalk.comparing.databases import Comparison
from contwalk.comparing.document import document_of
from contwalk.storage import Database, MemoryDatabase, RunHeader

RUN = """
contwalk: 1
system: autobalancer
model: {masses: 2}
preset: heavy
parameters: {omega: 5.0}
accuracy: 1e-8
start: {equilibrium: balanced, parameters: {delta: 0.0065}}
continue: {parameter: delta, range: [0.003, 0.0065], direction: backward}
diagram: {follow: [HB], depth: 1}
mark: {delta: [0.0055]}
output: small.h5
"""


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """An equilibrium, its Hopf point, and the orbits to their doubling; at two accuracies."""
    folder = tmp_path_factory.mktemp("diff")
    (folder / "small.yaml").write_text(RUN, encoding="utf-8")
    found = {}
    for accuracy in ("1e-6", "1e-10"):
        output = str(folder / f"{accuracy}.h5")
        run_file = cw.read_run_file(folder / "small.yaml", [f"accuracy={accuracy}"], output)
        found[accuracy] = folder / f"{accuracy}.h5"
        cw.run(run_file, figures=False)
    return found


def copied(database: Database, change=lambda branch: branch, order=lambda branches: branches) -> Database:
    """A database with some other branches."""
    copy = MemoryDatabase(database.header)
    for branch in order([change(each) for each in database.branches()]):
        copy.start_branch(branch.info)
        for row in branch.points:
            copy.append(branch.name, row)
        for point in branch.special_points:
            copy.append_special(branch.name, point)
        copy.finish(branch.name, branch.outcome, branch.cost)
    return copy


def with_point(branch: Branch, name: str, **values: object) -> Branch:
    points = [replace(p, **values) if p.name == name else p for p in branch.special_points]
    return replace(branch, special_points=points)


def whats(found: Comparison) -> set[str]:
    return {each.what for each in found.all_differences}


def test_a_database_is_the_same_as_itself_and_as_one_of_another_accuracy(study):
    with cw.open_database(study["1e-6"]) as a, cw.open_database(study["1e-10"]) as b:
        assert [len(each) for each in a] != []
        for found in (cw.diff(a, a), cw.diff(a, b), cw.diff(b, a)):
            assert found.same, [each.text for each in found.all_differences]
            assert [each.by for each in found.branches] == ["curve"] * len(a)
        assert any(note.startswith("Accuracy") for note in cw.diff(a, b).notes)


@pytest.mark.parametrize("name", ["HB1", "UZ1"])
def test_a_parameter_moved_by_a_hundred_errors_is_found(study, name):
    with cw.open_database(study["1e-6"]) as a:
        point = a["b1"].special(name)
        moved = point.parameters["delta"] + 100.0 * max(point.error, 4e-16 * point.parameters["delta"])

        def change(branch: Branch) -> Branch:
            parameters = {**point.parameters, "delta": moved}
            return with_point(branch, name, parameters=parameters) if branch.name == "b1" else branch

        for found in (cw.diff(a, copied(a, change)), cw.diff(copied(a, change), a)):
            (difference,) = found.all_differences
            assert (difference.what, difference.quantity) == ("value", "delta")
            assert difference.a == f"b1/{name}"
            assert difference.difference > difference.allowed


@pytest.mark.parametrize("branch", ["b1", "b2"])
def test_a_row_moved_by_a_hundred_errors_is_found(study, branch):
    with cw.open_database(study["1e-6"]) as a:
        stored = a[branch]
        regular = ~stored.points["special"] & np.isfinite(stored.points["error"])
        row = int(np.flatnonzero(regular)[len(stored) // 3])
        moved = stored.points.copy()
        if branch == "b1":
            moved["state"][row, 2] += 100.0 * stored.points["error"][row] * stored.points["weights"][row, 2]
        else:
            moved["period"][row] *= 1.0 + 100.0 * stored.points["error"][row]

        def change(each: Branch) -> Branch:
            return replace(each, points=moved) if each.name == branch else each

        found = cw.diff(a, copied(a, change))
        assert whats(found) & {"value", "rows"}
        assert all(f"Row {row} " in each.text for each in found.all_differences)


@pytest.mark.parametrize(("column", "what"), [("unstable", "stability"), ("admissible", "admissibility")])
def test_a_turned_row_is_found(study, column, what):
    with cw.open_database(study["1e-6"]) as a, cw.open_database(study["1e-10"]) as b:
        points = a["b1"].points.copy()
        row = int(np.flatnonzero(~points["special"])[3])
        points[column][row] = 1 if column == "unstable" else not points[column][row]

        def change(each: Branch) -> Branch:
            return replace(each, points=points) if each.name == "b1" else each

        for found in (cw.diff(copied(a, change), a), cw.diff(copied(a, change), b)):
            (difference,) = found.all_differences
            assert difference.what == what
            assert f"Row {row} " in difference.text


def test_criticality_status_and_lost_points_are_found(study):
    with cw.open_database(study["1e-6"]) as a:
        for values, what in (
            ({"criticality": "subcritical"}, "criticality"),
            ({"status": "unlocated"}, "kind"),
            ({"unstable_after": 4}, "stability"),
        ):
            found = cw.diff(a, copied(a, lambda each, v=values: with_point(each, "HB1", **v)))
            assert whats(found) == {what}

        def without(each: Branch) -> Branch:
            kept = [point for point in each.special_points if point.label != "HB"]
            return replace(each, special_points=kept)

        found = cw.diff(a, copied(a, without))
        assert any(each.what == "special_point" and each.a == "b1/HB1" for each in found.all_differences)


def test_names_order_and_directions_do_not_matter(study):
    def turned(branch: Branch) -> Branch:
        """The same branch, walked the other way, under another name."""
        points = branch.points[::-1].copy()
        points["s"], points["tangent"] = -points["s"], -points["tangent"]
        special = [
            replace(p, s=-p.s, unstable_before=p.unstable_after, unstable_after=p.unstable_before)
            for p in branch.special_points
        ]
        info = replace(branch.info, name=f"other_{branch.name}", parent=None)
        return Branch(info, points, special, branch.outcome, branch.cost)

    with cw.open_database(study["1e-6"]) as a:
        other = copied(a, turned, lambda branches: branches[::-1])
        found = cw.diff(a, other)
        assert found.same, [each.text for each in found.all_differences]
        assert [each.b for each in found.branches] == [(f"other_{each.name}",) for each in a]


def test_a_branch_that_only_one_has_is_named_and_told(study):
    with cw.open_database(study["1e-6"]) as a:
        fewer = copied(a, order=lambda branches: branches[:1])
        (difference,) = cw.diff(a, fewer).all_differences
        assert (difference.what, difference.a, difference.b) == ("branch", "b2", "")
        assert "periodic orbit, delta from" in difference.text
        (other,) = cw.diff(fewer, a).all_differences
        assert (other.a, other.b) == ("", "b2")


def test_a_branch_cut_in_two_is_the_same(study):
    def cut(branches: list[Branch]) -> list[Branch]:
        first, middle = branches[0], len(branches[0]) // 2
        s = first.points["s"][middle]
        pieces = []
        for name, keep, specials in (
            ("left", slice(None, middle + 1), [p for p in first.special_points if p.s < s]),
            ("right", slice(middle, None), [p for p in first.special_points if p.s >= s]),
        ):
            info = replace(first.info, name=name)
            pieces.append(Branch(info, first.points[keep].copy(), specials, first.outcome, first.cost))
        return [*pieces, *branches[1:]]

    with cw.open_database(study["1e-6"]) as a:
        found = cw.diff(a, copied(a, order=cut))
        assert found.same, [each.text for each in found.all_differences]
        assert found.branches[0].b == ("left", "right")
        assert any("other pieces" in note for note in found.notes)


def test_models_and_fixed_parameters_are_told(study):
    with cw.open_database(study["1e-6"]) as a:
        other = MemoryDatabase(RunHeader(a.header.system, {"masses": 3}, "", a.header.provenance))
        info: BranchInfo = a["b1"].info
        parameters = {name: value for name, value in info.parameters.items() if name != "gamma"} | {"c": 9.0}
        other.start_branch(replace(info, parameters=parameters))
        for row in a["b1"].points:
            other.append("b1", row)
        texts = [each.text for each in cw.diff(a, other).all_differences]
        assert any("model choice masses is 2 in A and 3 in B" in text for text in texts)
        assert any("Only A has the parameters gamma" in text for text in texts)
        assert any("fixed parameter c is 2.0 in A and 9.0 in B" in text for text in texts)


def test_the_document_has_every_difference(study):
    with cw.open_database(study["1e-6"]) as a:
        fewer = copied(a, order=lambda branches: branches[:1])
        document = document_of(cw.diff(a, fewer))
    assert list(document) == ["diff_version", "a", "b", "same", "differences", "branches", "notes"]
    assert document["same"] is False
    assert document["branches"][1]["differences"][0]["b"] is None
    assert document["branches"][0]["a"] == document["branches"][0]["b"] == ["b1"]
    assert document["branches"][1]["n_points"][1] == 0 < document["branches"][1]["n_points"][0]


def test_lines_of_a_chart_are_laid_beside_those_at_the_same_value(study):
    """Two lines that differ in a parameter that neither varies: each has its own, in any order."""

    def lines(branches: list[Branch]) -> list[Branch]:
        (first,) = [each for each in branches if each.name == "b1"]
        parameters = {**first.info.parameters, "omega": 6.0}
        return [first, replace(first, info=replace(first.info, name="b9", parameters=parameters))]

    with cw.open_database(study["1e-6"]) as a:
        found = cw.diff(copied(a, order=lines), copied(a, order=lambda own: lines(own)[::-1]))
        assert found.same, [each.text for each in found.all_differences]
        assert [(each.a, each.b) for each in found.branches] == [(("b1",), ("b1",)), (("b9",), ("b9",))]


def test_a_branch_of_the_point_alone_at_which_it_is_born_is_the_same_as_itself(study):
    """What solutions there are known to is not told: 4 differences were, of a database and itself."""

    def born(branch: Branch) -> Branch:
        if branch.info.parent is None:
            return branch
        return replace(branch, points=branch.points[branch.points["s"] == 0.0])

    with cw.open_database(study["1e-6"]) as a:
        own, other = copied(a, born), copied(a, born)
    assert [len(branch) for branch in own][1:] == [1]
    assert not cw.diff(own, other).all_differences
