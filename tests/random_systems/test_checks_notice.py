"""The checks of random systems notice what is wrong: a right study is spoilt in one place each time."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import random_independent
import run_random_systems
from random_checks import Study, faults
from random_recipe import Recipe
from random_recipes import FIRST_WIDE, recipe
from random_rows import _norms
from random_shrink import shrunk
from random_study import record, studied
from random_summary import page

# A supercritical Hopf point with its cycle, and an oscillator with two modes.
CYCLE, RELAY = 16, 10
RESTING = 387


@pytest.fixture(scope="module")
def studies(tmp_path_factory) -> dict[int, Study]:
    folders = {seed: tmp_path_factory.mktemp(f"seed{seed}") for seed in (CYCLE, RELAY)}
    return {seed: studied(recipe(seed).small(), folder) for seed, folder in folders.items()}


def codes(study: Study) -> set[str]:
    return {fault.code for fault in faults(study)}


def spoilt(study: Study, number: int, change: Callable[[np.ndarray], None]) -> Study:
    """The study with the rows of one branch changed."""
    branches = list(study.branches)
    rows = branches[number].points.copy()
    change(rows)
    branches[number] = replace(branches[number], points=rows)
    return replace(study, branches=branches)


def test_these_studies_are_right(studies):
    assert [b.info.problem for b in studies[CYCLE].branches] == ["equilibrium", "periodic_orbit"]
    assert [b.info.problem for b in studies[RELAY].branches] == ["hybrid_orbit"]
    assert codes(studies[CYCLE]) == set()
    assert codes(studies[RELAY]) == set()


def test_a_point_that_solves_nothing_is_noticed(studies):
    def moved(rows):
        rows["state"][10, 0] += 1e-9
        rows["unknowns"][10, 0] += 1e-9

    def off_the_orbit(rows):  # 1e-2 of an orbit that is about one in size; a hundred times what is allowed
        rows["unknowns"][10, 0] += 1e-2

    assert "residual" in codes(spoilt(studies[CYCLE], 0, moved))
    assert "residual" in codes(spoilt(studies[CYCLE], 1, off_the_orbit))
    assert "residual" in codes(spoilt(studies[RELAY], 0, off_the_orbit))


def test_rows_that_no_integration_can_check_are_given_up_and_counted(tmp_path, monkeypatch):
    # A relay that creeps past an equilibrium: the longest of its orbits are those that take the most.
    study, left_out = studied(recipe(RESTING).small(), tmp_path), []
    monkeypatch.setattr(random_independent, "MOST", 250)  # what most of them take, and some do not
    assert list(faults(study, left_out)) == []
    assert 0 < len(left_out) < len(study.branches[0])


def test_deviations_beyond_numbers_have_grown_without_bound():
    matrices = np.array([[[3.0]], [[np.nan]], [[np.inf]]])
    assert _norms(matrices).tolist() == [3.0, np.inf, np.inf]


def test_nothing_of_a_branch_that_can_be_checked_is_a_fault(studies, monkeypatch):
    monkeypatch.setattr(random_independent, "MOST", 1)
    assert "unchecked" in codes(studies[CYCLE])


def test_a_wrong_count_is_noticed(studies):
    def one_row(rows):
        rows["unstable"][8] += 1

    def all_rows(rows):
        rows["unstable"] += 1

    for seed, number in ((CYCLE, 0), (CYCLE, 1), (RELAY, 0)):
        assert "count" in codes(spoilt(studies[seed], number, one_row))
        assert "unstable" in codes(spoilt(studies[seed], number, all_rows))


def test_a_crossing_that_is_not_told_is_noticed(studies):
    study = studies[CYCLE]
    first = study.branches[0]
    kept = [p for p in first.special_points if p.label != "HB"]
    branches = [replace(first, special_points=kept), study.branches[1]]
    assert "count" in codes(replace(study, branches=branches))


def test_an_end_that_is_missing_is_noticed(studies):
    for seed in (CYCLE, RELAY):
        first = studies[seed].branches[0]
        kept = [p for p in first.special_points if p.name != "EP2"]
        others = studies[seed].branches[1:]
        spoilt_study = replace(studies[seed], branches=[replace(first, special_points=kept), *others])
        assert "direction" in codes(spoilt_study)


def test_a_reason_that_is_not_true_is_noticed(studies):
    first, second = studies[CYCLE].branches
    ends = [replace(p, kind="closed") if p.name == "EP2" else p for p in first.special_points]
    branches = [replace(first, special_points=ends), second]
    assert "end" in codes(replace(studies[CYCLE], branches=branches))
    outcome = replace(first.outcome, status="failed")
    branches = [replace(first, outcome=outcome), second]
    assert {"reason", "exit-code"} <= codes(replace(studies[CYCLE], branches=branches))


def test_a_cycle_that_does_not_grow_and_one_that_is_missing_are_noticed(studies):
    first, cycle = studies[CYCLE].branches
    short = replace(cycle, points=cycle.points[:1], special_points=[cycle.special_points[0]])
    short.special_points[0] = replace(short.special_points[0], index=0)
    assert "creeps" in codes(replace(studies[CYCLE], branches=[first, short]))
    assert "no-child" in codes(replace(studies[CYCLE], branches=[first]))


def test_a_branch_that_is_told_twice_is_noticed(studies):
    for seed in (CYCLE, RELAY):
        last = studies[seed].branches[-1]
        again = replace(last, info=replace(last.info, name="b9"))
        assert "twice" in codes(replace(studies[seed], branches=[*studies[seed].branches, again]))
    first = studies[CYCLE].branches[0]
    again = replace(first, info=replace(first.info, name="b9"))
    assert "twice" in codes(replace(studies[CYCLE], branches=[*studies[CYCLE].branches, again]))


def test_what_is_printed_and_warned_is_noticed(studies):
    study = studies[RELAY]
    assert codes(replace(study, said="internal error: ZeroDivisionError")) == {"internal"}
    assert codes(replace(study, warned=("step.py:1: divide by zero",))) == {"warning"}
    assert codes(replace(study, code=1)) == {"exit-code"}


def test_seeds_repeat_themselves():
    assert recipe(3).plugin_text() == recipe(3).plugin_text()
    assert len({recipe(seed).plugin_text() for seed in range(20)}) == 20


def test_results_are_taken_up_and_summed(tmp_path, monkeypatch, capsys):
    results, summary = tmp_path / "results.jsonl", tmp_path / "summary.md"
    # The first line is whole, the second one was cut by a kill.
    results.write_text(
        '{"seed": 1, "family": "fire", "states": 2, "faults": [], "rows": 5}\n{"seed": 2, "fam'
    )
    asked = []

    def checked(chosen: Recipe) -> dict:
        asked.append(chosen.seed)
        return {"seed": chosen.seed, "family": chosen.family, "faults": [], "points": {"HB": 2}, "rows": 7}

    monkeypatch.setattr(run_random_systems, "checked", checked)
    options = ["--systems", "3", "--results", str(results), "--summary", str(summary)]
    monkeypatch.setattr("sys.argv", ["run", *options])
    assert run_random_systems.main() == 0
    assert asked == [0, 2]
    assert run_random_systems.main() == 0
    assert asked == [0, 2]  # nothing is left to do
    text = summary.read_text()
    assert "3 systems" in text
    assert "19 stored points" in text
    assert "| HB | 4 |" in text


def test_the_summary_lists_faults(studies):
    found = record(studies[CYCLE], list(faults(replace(studies[CYCLE], code=1))))
    assert f"| exit-code | wrong exit code, or a run that one branch has ended | 1 | 1 | {CYCLE} |" in page(
        [json.loads(json.dumps(found))], "command"
    )


def test_shrinking_keeps_the_fault_and_little_else():
    def check(chosen: Recipe) -> dict:
        """A machine is faulty that has the term `x[1]**3` in any equation."""
        found = any("x[1]**3" in t.text for terms in chosen.modes["flow"] for t in terms)
        return {"faults": [{"code": "cube"}] if found else []}

    polynomials = (recipe(seed) for seed in range(100) if recipe(seed).family == "polynomial")
    start = next(chosen for chosen in polynomials if check(chosen)["faults"])
    small, left = shrunk(start, check)
    assert left["faults"] == [{"code": "cube"}]
    assert sum(len(terms) for terms in small.modes["flow"]) == 1
    assert small.depth == 0


def test_a_study_runs_in_its_own_folder(tmp_path: Path, studies):
    assert studies[RELAY].code == 0
    assert not list(tmp_path.iterdir())


def test_a_wrong_count_of_kinds_that_have_died_out_is_noticed(tmp_path: Path) -> None:
    study = studied(recipe(FIRST_WIDE + 4).small(), tmp_path)
    assert codes(study) == set()

    def one_more(rows):
        rows["unstable"] += 1

    assert "unstable" in codes(spoilt(study, 0, one_more))


@pytest.mark.long
def test_a_wave_of_a_ring_that_is_not_told_is_noticed(tmp_path: Path) -> None:
    study = studied(recipe(FIRST_WIDE + 3), tmp_path)
    rest = study.branches[0]
    kept = [point for point in rest.special_points if point.label == "EP"]
    assert rest.outcome.reason == "bound"
    assert "lost" not in codes(study)
    assert "lost" in codes(replace(study, branches=[replace(rest, special_points=kept)]))
