"""A contour of the largest real part goes on where another eigenvalue takes the lead, from one mark on it."""

from __future__ import annotations

import numpy as np
import pytest

import contwalk as cw
from contwalk.workflow import runner
from contwalk.workflow.run_file.reading import read_run_file

PLUGIN = """
from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
{body}


SYSTEM = System(
    "corner",
    states=(State("x"), State("y"), State("z")),
    parameters=(Parameter("a", 2.0), Parameter("b", 3.0)),
    modes=(Mode("only", field),),
)
"""
# A real eigenvalue -a and a pair -b +- 2 i; real eigenvalues -a and -b of which one acts on the other.
REAL_AND_PAIR = "dx[0] = 1.0 - p.a * x[0]\ndx[1] = -p.b * x[1] - 2.0 * x[2]\ndx[2] = 2.0 * x[1] - p.b * x[2]"
TWO_REAL = "dx[0] = 1.0 - p.a * x[0]\ndx[1] = x[0] - p.b * x[1]\ndx[2] = -7.0 * x[2]"
# Selkov's glycolysis beside a state that dies out.
SELKOV = "used = (p.a + x[0] ** 2) * x[1]\ndx[0] = used - x[0]\ndx[1] = p.b - used\ndx[2] = -7.0 * x[2]"
RUN = """
system: ./corner.py
{start}
diagram: none
mark: {{max_re: [{level}]}}
loci: {{with: {second}, follow: none}}
output: corner.h5
"""


@pytest.fixture(autouse=True)
def in_its_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def contour(folder, body, start, second, level):
    indented = "\n".join(f"    {line}" for line in body.splitlines())
    (folder / "corner.py").write_text(PLUGIN.format(body=indented), encoding="utf-8")
    text = RUN.format(start=start, second=second, level=level)
    (folder / "corner.yaml").write_text(text, encoding="utf-8")
    runner.run(read_run_file(folder / "corner.yaml"))
    with cw.open_database(folder / "corner.h5") as database:
        curves = [branch for branch in database.branches() if branch.info.settings.get("of") == "UZ"]
    for branch in curves:
        leads = np.max([branch[f"re_{k}"] for k in (1, 2, 3)], axis=0)
        np.testing.assert_allclose(
            leads, level, rtol=1e-7
        )  # two equal ones are known to the root of rounding
    return curves


def corner_of(branch):
    (end,) = (point for point in branch.special_points if point.label == "EP" and point.kind == "stop_at")
    return [end.parameters[name] for name in branch.info.free]


@pytest.mark.drawn(1)
@pytest.mark.parametrize("body", [REAL_AND_PAIR, TWO_REAL], ids=["a pair", "a real one"])
def test_two_eigenvalues_with_one_real_part(tmp_path, body):
    """max(-a, -b) = -1 is a = 1 above b = 1, and b = 1 beyond a = 1."""
    start = "start: {state: {x: 0.3, y: 0.1, z: 0.0}}\ncontinue: {parameter: a, range: [0.2, 4.0]}"
    first, second = contour(tmp_path, body, start, "b, range: [0.3, 5.0]", -1.0)
    for branch in (first, second):
        assert corner_of(branch) == pytest.approx([1.0, 1.0], rel=1e-12)
    np.testing.assert_allclose(first["a"], 1.0, rtol=1e-13)
    np.testing.assert_allclose(second["b"], 1.0, rtol=1e-12)
    assert (first["b"].max(), second["a"].max()) == (5.0, 4.0)


@pytest.mark.long
def test_a_pair_that_becomes_two_real_ones(tmp_path):
    """From the pair at the mark to the real eigenvalue: both curves meet where the two are equal."""
    start = "parameters: {a: 0.025, b: 0.2}\nstart: {state: {x: 0.2, y: 3.0, z: 0.0}}\n"
    start += "continue: {parameter: b, range: [0.05, 1.2]}"
    pair, real = contour(tmp_path, SELKOV, start, "a, range: [0.01, 0.2]", -0.2)
    # At (b, a) = (sqrt(0.0128), 0.0272): trace -0.4 and determinant 0.04. Beside a double eigenvalue each of
    # both moves by the root of how far it is, which is known to some 1e-10 by their sum.
    for branch in (pair, real):
        assert corner_of(branch) == pytest.approx([np.sqrt(0.0128), 0.0272], rel=1e-9)
    assert [branch.info.settings["curve"]["name"] for branch in (pair, real)] == ["pair", "real"]
    assert real["b"].min() == 0.05
