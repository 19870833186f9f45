"""A study measured over accuracies and integrators: a cycle whose Hopf point and fold are known exactly."""

from __future__ import annotations

import csv
import math
from dataclasses import replace

import pytest

from contwalk.errors import ContwalkError
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.tradeoff import Tradeoff, Trial, measure, names_of_files, write

pytestmark = pytest.mark.slow

PLUGIN = """\
from contwalk.system import Mode, Parameter, Start, State, System

def field(t, x, p, dx):
    # r' = r (1 + mu - (r^2 - 1)^2), phase' = 1: cycles fold at mu = -1
    r2 = x[0] ** 2 + x[1] ** 2
    growth = 1.0 + p.mu - (r2 - 1.0) ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]

SYSTEM = System(
    name="folding",
    states=(State("x"), State("y")),
    parameters=(Parameter("mu", 0.5),),
    modes=(Mode("free", field),),
    starts=(Start("rest", lambda p: [[0.0, 0.0]]),),
)
"""
RUN = """\
contwalk: 1
system: ./folding.py
start: {equilibrium: rest}
continue: {parameter: mu, range: [-1.5, 0.6]}
diagram: {follow: [HB]}
output: folding.h5
"""


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tradeoff")
    (folder / "folding.py").write_text(PLUGIN, encoding="utf-8")
    (folder / "run.yaml").write_text(RUN, encoding="utf-8")
    run_file = read_run_file(folder / "run.yaml", output=str(folder / "folding.h5"))
    told: list[str] = []
    return run_file, measure(run_file, (1e-6, 1e-8), ("dop853", "collocation"), told.append), told


def test_the_truth_is_true(study):
    _, found, _ = study
    assert found.truth["b1/HB1"] == pytest.approx(0.0, abs=1e-15)  # growth at r = 0 is mu
    assert found.truth["b2/LP1"] == pytest.approx(-1.0, abs=1e-10)  # a hundredth of the tightest asked
    assert not any(comparison.failed for comparison in found.checked)
    assert found.truth_accuracy == pytest.approx(1e-10)


def test_every_setting_is_measured(study):
    _, found, told = study
    settings = [(trial.method, trial.accuracy) for trial in found.trials]
    assert settings == [(m, a) for m in ("dop853", "collocation") for a in (1e-6, 1e-8)]
    for trial in found.trials:
        assert trial.held
        assert trial.worst <= trial.accuracy
        assert trial.found == 2
        assert trial.rhs > 0
    assert any("dop853: accuracy 1e-08" in text for text in told)


def test_table_and_figure(study):
    run_file, found, _ = study
    table, picture = write(run_file, found)
    assert (table, picture) == names_of_files(run_file)
    with table.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["method"] for row in rows] == ["dop853", "dop853", "collocation", "collocation"]
    assert all(float(row["error b2/LP1"]) <= float(row["accuracy"]) for row in rows)
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_an_impossible_accuracy_is_refused(study):
    run_file, _, _ = study
    with pytest.raises(ContwalkError, match="not possible"):
        measure(run_file, (1e-30,), ("auto",))


def test_a_study_without_points_is_refused(study):
    run_file, _, _ = study
    with pytest.raises(ContwalkError, match="no special point"):
        measure(replace(run_file, range=(0.4, 0.6)), (1e-4,), ("auto",))


def trial(accuracy, seconds, error, method="dop853", **rest):
    return Trial(accuracy, method, seconds, 1, {"b1/HB1": error}, **rest)


def tradeoff(*trials):
    return Tradeoff(1e-6, {"b1/HB1": 1.0}, 1e-10, [], 1e-12, list(trials))


def test_the_cheapest_that_meets_the_accuracy_is_recommended():
    found = tradeoff(trial(1e-4, 1.0, 1e-5), trial(1e-6, 2.0, 1e-8), trial(1e-8, 3.0, 1e-10))
    assert found.best is not None
    assert found.best.accuracy == 1e-6
    assert "accuracy: 1e-06 with engine: {method: dop853}" in found.recommendation


def test_collocation_is_recommended_as_the_discretisation_that_it_is():
    found = tradeoff(trial(1e-6, 1.0, 1e-8, method="collocation"), trial(1e-6, 2.0, 1e-8))
    assert "accuracy: 1e-06 with engine: {discretization: collocation}" in found.recommendation


def test_a_cheaper_one_that_promises_less_is_said_to():
    found = tradeoff(trial(1e-4, 1.0, 1e-9), trial(1e-6, 2.0, 1e-9))
    assert found.best is not None
    assert found.best.accuracy == 1e-4
    assert "promises 0.0001 only; accuracy: 1e-06 keeps its promise for 2 s" in found.recommendation


def test_times_that_are_nearly_equal_are_decided_by_the_promise():
    found = tradeoff(trial(1e-4, 1.0, 1e-9), trial(1e-6, 1.05, 1e-9))
    assert found.best is not None
    assert found.best.accuracy == 1e-6


def test_what_is_missing_or_too_much_keeps_no_promise():
    assert not trial(1e-4, 1.0, math.nan).held
    assert not trial(1e-4, 1.0, 1e-9, extra=("b1/LP1",)).held
    assert not trial(1e-4, 1.0, 1e-9, failed="why").held
    assert "No setting met" in tradeoff(trial(1e-4, 1.0, 1e-3)).recommendation
