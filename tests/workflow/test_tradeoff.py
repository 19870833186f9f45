"""A study measured over accuracies and integrators: a cycle whose Hopf point and fold are known exactly."""

from __future__ import annotations

import csv
import math
from dataclasses import replace

import pytest

from contwalk.errors import ContwalkError
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.tradeoff import measuring
from contwalk.workflow.tradeoff.branches import measure
from contwalk.workflow.tradeoff.files import names_of_files, write
from contwalk.workflow.tradeoff.sentences import digits, recommendation
from contwalk.workflow.tradeoff.trials import BRANCHES, MODELS, Setting, Tradeoff, Trial

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
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(measuring, "REPEATS", measuring.LEAST)
        found = measure(run_file, (1e-6, 1e-8), ("dop853", "collocation"), progress=told.append)
    return run_file, found, told


def test_the_truth_is_true(study):
    _, found, _ = study
    assert found.truth["b1/HB1"] == pytest.approx(0.0, abs=1e-15)  # growth at r = 0 is mu
    assert found.truth["b2/LP1"] == pytest.approx(-1.0, abs=1e-10)  # a hundredth of the tightest asked
    assert found.sure
    assert "at accuracy 1e-10, recomputed by" in found.compared


def test_every_setting_is_measured(study):
    _, found, told = study
    settings = [(trial.setting.method, trial.setting.accuracy) for trial in found.trials]
    assert settings == [(m, a) for m in ("dop853", "collocation") for a in (1e-6, 1e-8)]
    for trial in found.trials:
        assert found.held(trial)
        assert trial.worst <= trial.setting.accuracy
        assert len(trial.times) >= 3
        assert trial.found == 2
        assert trial.work > 0
    assert any("dop853: accuracy 1e-08" in text for text in told)


def test_table_and_figure(study):
    run_file, found, _ = study
    table, picture = write(run_file.output, found)
    assert (table, picture) == names_of_files(run_file.output)
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


def trial(accuracy, seconds, error, method="dop853", spread=0.0, **rest):
    return Trial(Setting(accuracy, method), (seconds, seconds + spread), 1, {"b1/HB1": error}, **rest)


def tradeoff(*trials):
    return Tradeoff(BRANCHES, 1e-6, {"b1/HB1": 1.0}, "", 1e-12, trials)


def test_the_cheapest_that_meets_the_accuracy_is_recommended():
    found = tradeoff(trial(1e-4, 1.0, 1e-5), trial(1e-6, 2.0, 1e-8), trial(1e-8, 3.0, 1e-10))
    assert [each.setting.accuracy for each in found.ties] == [1e-6]
    assert "accuracy: 1e-06 with engine: {method: dop853}" in recommendation(found)
    assert "Tie" not in recommendation(found)


def test_collocation_is_recommended_as_the_discretisation_that_it_is():
    found = tradeoff(trial(1e-6, 1.0, 1e-8, method="collocation"), trial(1e-6, 2.0, 1e-8))
    assert "accuracy: 1e-06 with engine: {discretization: collocation}" in recommendation(found)


def test_a_cheaper_one_that_promises_less_is_said_to():
    found = tradeoff(trial(1e-4, 1.0, 1e-9), trial(1e-6, 2.0, 1e-9))
    assert "promises 0.0001 only; accuracy: 1e-06 keeps its promise for 2 s" in recommendation(found)


def test_times_within_their_scatter_are_ties_and_the_most_accurate_is_taken():
    found = tradeoff(trial(1e-4, 1.0, 1e-9, spread=0.1), trial(1e-6, 1.15, 1e-9, spread=0.1))
    assert [each.setting.accuracy for each in found.ties] == [1e-6, 1e-4]
    said = recommendation(found)
    assert said.startswith("Tie: the times of 2 settings")
    assert "The most accurate of them is accuracy: 1e-06" in said
    apart = tradeoff(trial(1e-4, 1.0, 1e-9, spread=0.1), trial(1e-6, 1.25, 1e-9, spread=0.1))
    assert [each.setting.accuracy for each in apart.ties] == [1e-4]


def test_the_slowest_of_many_times_says_nothing():
    """A run during which the machine did something else as well."""
    times = (1.0, 1.01, 1.02, 1.03, 9.0)
    assert Trial(Setting(1e-6, "auto"), times).spread == pytest.approx(0.03)
    assert Trial(Setting(1e-6, "auto"), times[2:]).spread == pytest.approx(7.98)


def test_a_model_that_saves_nothing_is_not_recommended():
    full = Trial(Setting(1e-8, ""), (1.0, 1.2), 1, {"b1/HB1": 0.0})
    simple = Trial(Setting(1e-8, "", "hip=locked"), (0.9, 1.1), 1, {"b1/HB1": 0.004})
    found = Tradeoff(MODELS, 0.01, {"b1/HB1": 1.0}, "", 1e-9, [full, simple])
    assert "is model: {as it is}" in recommendation(found)
    faster = Trial(Setting(1e-8, "", "hip=locked,torso=balanced"), (0.2, 0.3), 1, {"b1/HB1": 0.004})
    found = Tradeoff(MODELS, 0.01, {"b1/HB1": 1.0}, "", 1e-9, [full, simple, faster])
    assert "is model: {hip: locked, torso: balanced}" in recommendation(found)


def test_what_digits_given_up_buy_is_told():
    few, many = trial(1e-4, 1.0, 1e-9, spread=0.1), trial(1e-10, 1.5, 1e-12, spread=0.1)
    same = trial(1e-4, 1.0, 1e-9, "auto", 0.1), trial(1e-10, 1.1, 1e-12, "auto", 0.1)
    assert digits(tradeoff(few, many, *same)) == (
        "Giving up 6 digits, from 1e-10 to 0.0001, makes it 1.5 times as fast with dop853; "
        "buys nothing (a tie, 1.1 s and 1 s) with auto."
    )
    assert digits(tradeoff(few)) == ""
    assert digits(tradeoff(trial(1e-4, 1.0, math.nan), many)) == ""  # nothing is bought by what is lost


def test_what_is_missing_or_too_much_keeps_no_promise():
    for kept in (
        trial(1e-4, 1.0, math.nan),
        trial(1e-4, 1.0, 1e-9, extra=("b1/LP1",)),
        trial(1e-4, 1.0, 1e-9, failed="why"),
    ):
        assert not tradeoff(kept).held(kept)
    assert "No setting met" in recommendation(tradeoff(trial(1e-4, 1.0, 1e-3)))
