"""Whole diagrams by the runner: every half-branch of a branch point, once; failures with their exit code."""

import numpy as np
import pytest
from invariants import check_branch
from plugin_runs import problem_of, run_text, write_plugin
from small_systems import bifurcations

CROSSING = "dx[0] = x[0] * (p.mu - x[0])"
PITCHFORK = "dx[0] = p.mu * x[0] - x[0] ** 3\ndx[1] = -x[1] + x[0]"
ACCURACY = 1e-8  # of points, where nothing else is asked for


def _ends(result, name="x", free="mu"):
    return sorted((round(float(b[name][i]), 9), float(b[free][i])) for b in result.branches for i in (0, -1))


@pytest.mark.parametrize("start", [0.0, -0.6])
def test_all_four_half_branches_of_a_transcritical_point(tmp_path, start):
    write_plugin(tmp_path, CROSSING, "x", mu=-0.6)
    result = run_text(
        tmp_path,
        f"""start: {{state: {{x: {start}}}}}
continue: {{parameter: mu, range: [-1.0, 1.0]}}
diagram: {{follow: [BP]}}
""",
    )
    assert len(result.branches) == 2
    for branch in result.branches:
        check_branch(branch, problem_of(tmp_path, result, "mu"))
    assert _ends(result) == [(-1.0, -1.0), (0.0, -1.0), (0.0, 1.0), (1.0, 1.0)]
    parent, child = result.branches
    assert parent.info.parent is None
    assert child.info.parent == ("b1", parent.special("BP1").s)


@pytest.mark.parametrize(("start", "value"), [(0.0, -0.5), (0.5, 0.25)])
def test_all_four_half_branches_of_a_pitchfork(tmp_path, start, value):
    write_plugin(tmp_path, PITCHFORK, "xy", mu=value)
    result = run_text(
        tmp_path,
        f"""start: {{state: {{x: {start}, y: {start}}}}}
continue: {{parameter: mu, range: [-1.0, 1.0]}}
diagram: {{follow: [BP], depth: 3}}
""",
    )
    assert len(result.branches) == 2
    for branch in result.branches:
        check_branch(branch, problem_of(tmp_path, result, "mu"))
    assert _ends(result) == [(-1.0, 1.0), (0.0, -1.0), (0.0, 1.0), (1.0, 1.0)]


def test_depth_zero_and_follow_none_give_the_branches_of_the_starts_alone(tmp_path):
    write_plugin(tmp_path, PITCHFORK, "xy", mu=-0.5)
    for name, plan in (("zero", "{follow: [BP], depth: 0}"), ("none", "none")):
        result = run_text(
            tmp_path,
            f"""start: {{state: {{x: 0, y: 0}}}}
continue: {{parameter: mu, range: [-1.0, 1.0]}}
diagram: {plan}
""",
            name,
        )
        assert len(result.branches) == 1
        assert [q.label for q in bifurcations(result.branches[0])] == ["BP"]


def test_a_branch_that_joins_two_branch_points_is_computed_once(tmp_path):
    """x' = x (1 - mu^2 - x^2): an ellipse crosses x = 0 at mu = -1 and at mu = 1."""
    write_plugin(tmp_path, "dx[0] = x[0] * (1.0 - p.mu ** 2 - x[0] ** 2)", "x", mu=-1.5)
    result = run_text(
        tmp_path,
        """start: {state: {x: 0}}
continue: {parameter: mu, range: [-2.0, 2.0]}
diagram: {follow: [BP]}
""",
    )
    line, ellipse = result.branches
    for branch in result.branches:
        check_branch(branch, problem_of(tmp_path, result, "mu"))
    assert [q.parameters["mu"] for q in bifurcations(line)] == [-1.0, 1.0]
    assert ellipse.outcome.reason == "closed"
    assert np.allclose(ellipse["mu"] ** 2 + ellipse["x"] ** 2, 1.0, rtol=1e-12)
    assert ellipse["x"].min() < -0.9
    assert ellipse["x"].max() > 0.9


BETWEEN = """rate = p.mu * (1.0 - p.mu) * (p.mu - 2.0) * (p.mu - 3.0) - x[0]**2 - x[1]**2
dx[0] = rate * x[0] - x[1]
dx[1] = rate * x[1] + x[0]"""


def test_a_family_that_joins_two_hopf_points_is_computed_once(tmp_path):
    """Cycles of radius r exist where r^2 = mu (1 - mu) (mu - 2) (mu - 3): from 0 to 1, and from 2 to 3."""
    write_plugin(tmp_path, BETWEEN, "xy", mu=-0.5)
    result = run_text(
        tmp_path,
        """start: {state: {x: 0, y: 0}}
continue: {parameter: mu, range: [-0.6, 3.6]}
diagram: {follow: [HB]}
""",
    )
    rest, *families = result.branches
    places = [point.parameters["mu"] for point in bifurcations(rest)]
    np.testing.assert_allclose(places, [0.0, 1.0, 2.0, 3.0], rtol=0, atol=ACCURACY)
    born = [(family.info.parent, family.outcome.reason) for family in families]
    assert born == [(("b1", rest.special(name).s), "shrunk") for name in ("HB1", "HB3")]
    for family, middle in zip(families, (0.5, 2.5), strict=True):
        assert np.abs(family["mu"] - middle).max() <= 0.5 + ACCURACY


def test_two_starts_on_one_branch_are_one_branch(tmp_path):
    write_plugin(tmp_path, "dx[0] = p.mu - x[0]", "x", mu=0.0)
    result = run_text(
        tmp_path,
        """start:
  - {state: {x: 0.0}}
  - {state: {x: 0.5}, parameters: {mu: 0.5}}
continue: {parameter: mu, range: [-1.0, 1.0]}
""",
    )
    assert len(result.branches) == 1


def test_a_start_that_does_not_converge_is_a_failed_branch(tmp_path):
    write_plugin(tmp_path, "dx[0] = x[0] ** 2 + 1.0 + p.mu", "x", mu=0.0)
    result = run_text(
        tmp_path,
        """start: {state: {x: 1.0}}
continue: {parameter: mu, range: [-0.5, 1.0]}
""",
    )
    (branch,) = result.branches
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", "no_convergence")
    assert len(branch) == 0
    assert "start does not converge" in branch.outcome.message


@pytest.mark.parametrize(
    ("field", "reason", "said"),
    [
        ("dx[0] = 1.0 / p.mu - x[0]", "not_finite", "small.py, line 5"),
        (
            "if p.mu > 0.5:\n    raise ValueError('no more')\ndx[0] = p.mu - x[0]",
            "plugin_error",
            "small.py, line 6",
        ),
    ],
)
def test_a_field_that_fails_keeps_what_was_computed_before(tmp_path, field, reason, said):
    write_plugin(tmp_path, field, "x", mu=0.25)
    start = 4.0 if reason == "not_finite" else 0.25
    result = run_text(
        tmp_path,
        f"""start: {{state: {{x: {start}}}}}
continue: {{parameter: mu, range: [-1.0, 0.75], max_points: 300}}
""",
    )
    (branch,) = result.branches
    if reason == "plugin_error":
        check_branch(branch, problem_of(tmp_path, result, "mu"))
        assert (branch.outcome.status, branch.outcome.reason) == ("failed", reason)
        assert said in branch.outcome.message
    else:  # a pole is never reached: x grows without bound while mu tends to zero
        assert branch.outcome.reason == "unbounded"
    assert len(branch) > 10


def test_the_command_exits_with_1_for_a_failed_branch(tmp_path):
    from contwalk.cli.entry import run

    write_plugin(tmp_path, "dx[0] = x[0] ** 2 + 1.0 + p.mu", "x", mu=0.0)
    text = """contwalk: 1
system: ./small.py
start: {state: {x: 1.0}}
continue: {parameter: mu, range: [-0.5, 1.0]}
"""
    (tmp_path / "bad.yaml").write_text(text, encoding="utf-8")
    output = tmp_path / "bad.h5"
    assert run(["continue", str(tmp_path / "bad.yaml"), "--output", str(output), "--quiet"]) == 1
    assert output.exists()
