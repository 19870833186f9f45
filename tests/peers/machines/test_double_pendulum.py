"""A machine in mass-matrix form and by equations solved by hand: one diagram, at next to the same cost."""

from __future__ import annotations

import inspect
import json
import re
from types import SimpleNamespace

import numpy as np
import pytest
from peers.compare import judge
from peers.machines import double_pendulum
from peers.machines.double_pendulum import BY_HAND, PEER, SYSTEM
from peers.running import run_study

import contwalk as cw
from contwalk.fields.llvm import optimized
from contwalk.flow.compiled.traced import field_of

STUDY = PEER.studies[0]


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    """Special points of the mass-matrix form, by their names."""
    ran = run_study("double_pendulum", STUDY, tmp_path_factory.mktemp("double_pendulum"))
    return {point.name: point for branch in ran.branches for point in branch.special_points}


def test_both_forms_have_the_same_special_points(points, tmp_path):
    """Each to the error that it claims; the tests of published problems compare the values themselves."""
    plugin = tmp_path / "by_hand.py"
    plugin.write_text("from peers.machines.double_pendulum import BY_HAND as SYSTEM\n")
    path = tmp_path / "study.yaml"
    path.write_text(json.dumps({"contwalk": 1, "system": str(plugin), **STUDY.run}))
    branches = cw.run(cw.read_run_file(path, output=tmp_path / "study.h5"), figures=False).branches
    assert not judge(STUDY, branches).complaints
    others = {point.name: point for branch in branches for point in branch.special_points}
    assert {name: point.label for name, point in points.items()} == {n: p.label for n, p in others.items()}
    for name, point in points.items():
        apart = abs(point.parameters["torque"] - others[name].parameters["torque"])
        assert apart <= point.error + others[name].error
        assert point.criticality == others[name].criticality


def test_motions_agree():
    """Rates and changes at impacts, at random states: the same to rounding of numbers below 100."""
    rng = np.random.default_rng(4)
    p = SimpleNamespace(**SYSTEM.defaults())
    for _ in range(20):
        x = rng.normal(size=4)
        for mode, other in (
            (double_pendulum.field, double_pendulum.field_by_hand),
            (double_pendulum.strike, double_pendulum.strike_by_hand),
        ):
            found, expected = np.empty(4), np.empty(4)
            mode(0.3, x, p, found)
            other(0.3, x, p, expected)
            np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


def test_the_cost_of_a_right_hand_side():
    """At most 1.5 times that by hand, counted in what LLVM leaves; sines and cosines alike."""
    fields = [field_of(system) for system in (SYSTEM, BY_HAND)]
    by_matrix, by_hand = (_operations(field.rhs_text) for field in fields)
    assert by_matrix["call"] == by_hand["call"]
    assert by_matrix["fdiv"] <= by_hand["fdiv"] + 3
    weights = {"call": 20, "fdiv": 5}  # a sine takes about 20 additions' time, a quotient 5
    costs = [sum(weights.get(k, 1) * n for k, n in counts.items()) for counts in (by_matrix, by_hand)]
    assert costs[0] <= 1.5 * costs[1]


def _operations(text):
    """How often each instruction stands in what LLVM leaves; of calls only sines and cosines."""
    body = re.search(r"define void @rhs\(.*?^}", optimized(text), re.M | re.S).group()
    found: dict[str, int] = {}
    for line in body.splitlines():
        match = re.match(r"\s+(?:%\S+ = )?(?:tail )?(\w+) (.*)", line)
        if match and (match[1] != "call" or "@sin" in match[2] or "@cos" in match[2]):
            found[match[1]] = found.get(match[1], 0) + 1
    return found


def test_a_singular_mass_matrix_is_named_with_its_line(tmp_path):
    """A rod without a bob at its end: m2 = 0."""
    run = {**STUDY.run, "parameters": {"m2": 0.0}}
    path = tmp_path / "study.yaml"
    path.write_text(json.dumps({"contwalk": 1, "system": str(double_pendulum.__file__), **run}))
    outcome = cw.run(cw.read_run_file(path, output=tmp_path / "s.h5"), figures=False).branches[0].outcome
    lines, first = inspect.getsourcelines(double_pendulum.field)
    assert f"line {first + len(lines) - 1}: the matrix of 2 rows is singular" in outcome.message
