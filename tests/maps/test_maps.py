"""Maps as themselves: fixed points, cycles, their bifurcations and curves against closed forms."""

from __future__ import annotations

import json
import math
from pathlib import Path

import jsonschema
import numpy as np
import pytest

import contwalk as cw
from contwalk import storage
from contwalk.errors import SystemDefinitionError
from contwalk.storage.document import document
from contwalk.system import Conserved, Mode, Parameter, State, System, Transition

LOGISTIC = "x+ = r*x*(1 - x); r = 2.5; x(0) = 0.5"
HENON = "x+ = 1 - a*x^2 + y; y+ = b*x; a = 0.2; b = 0.3; x(0) = 0.9; y(0) = 0.3"
DELAYED = "x+ = r*x*(1 - y); y+ = x + b*y; r = 1.95; b = 0; x(0) = 0.5; y(0) = 0.5"
IKEDA = """
s = 0.4 - 6/(1 + x^2 + y^2)
x+ = A + B*(x*cos(s) - y*sin(s)); y+ = B*(x*sin(s) + y*cos(s))
A = 0.1; B = 0.7; x(0) = 0.1; y(0) = 0
"""

ODE = "x(t+1)=a*x*(1-x)\npar a=2.8\ninit x=.6\n@ parmin=2.8,parmax=3.2\ndone\n"


def found(text, *arguments, **keywords):
    return cw.diagram(cw.system_from_text(text), *arguments, **keywords)


def field(t, x, p, x_next):
    x_next[0] = p.r * x[0] * (1.0 - x[0])


def logistic(**more):
    given = {"states": (State("x", start=0.5),), "parameters": (Parameter("r", 2.5),)} | more
    return System("logistic", modes=(Mode("m", field, kind="map"),), **given)


@cw.model(r=2.5, start={"x": 0.5}, map=True)
def doubling(x, *, r):
    return r * x * (1 - x)


@pytest.mark.parametrize("system", [cw.system_from_text(LOGISTIC), doubling], ids=["text", "decorator"])
def test_each_form_of_a_map(system):
    single = cw.diagram(system, "r", (2.9, 3.1), diagram="none")
    assert single["b1/PD1"].parameters["r"] == pytest.approx(3.0, abs=1e-11)
    assert single.start == "the simulation from the declared state until settled, at r = 2.9"


def test_the_cascade_of_the_logistic_map():
    """Doublings at 3 and 1 + sqrt(6); x = 1 - 1/r, and the cycle of two in closed form."""
    cascade = cw.diagram(logistic(), "r", (2.8, 3.5), diagram={"depth": 1})
    first, second = cascade["b1/PD1"], cascade["b2/PD1"]
    assert first.parameters["r"] == pytest.approx(3.0, abs=1e-11)
    assert second.parameters["r"] == pytest.approx(1 + math.sqrt(6), abs=1e-11)
    assert (first.criticality, second.criticality) == ("supercritical", "supercritical")
    assert (first.period, second.period) == (1.0, 2.0)
    r = cascade["b1"]["r"]
    assert np.allclose(cascade["b1"]["x"], 1 - 1 / r, rtol=1e-10)
    # c of xi -> -(1 + mu) xi + c xi^3: b^2 + c of Taylor's form, with f'' / 2 = -3 and f''' = 0 at r = 3
    assert first.coefficients["c"] == pytest.approx(9.0, rel=1e-8)
    end = cascade["b2"].points[-1]
    r = float(end["free"][0])
    pair = [(r + 1 + sign * math.sqrt((r + 1) * (r - 3))) / (2 * r) for sign in (1, -1)]
    assert min(abs(float(end["state"][0]) - x) for x in pair) < 1e-9

    told = document(cascade.database)
    first, second = told["branches"]
    assert (first["problem"], first["signature"], first["subharmonic"]) == ("fixed_point", None, 1)
    assert (second["problem"], second["subharmonic"]) == ("fixed_point", 2)
    assert second["special_points"][0]["period"] == 2.0
    assert repr(cascade["b1"]).startswith("<b1: ")
    assert "fixed point" in repr(cascade["b1"])
    schema = Path(storage.__file__).parent / "interface.schema.json"
    jsonschema.validate(told, json.loads(schema.read_text()))


def test_the_fold_of_the_cycle_of_three():
    """It is born at r = 1 + sqrt(8)."""
    window = found(LOGISTIC, "r", (3.8, 3.85), parameters={"r": 3.84}, diagram="none")
    (fold,) = (point for point in window["b1"].special_points if point.label == "LP")
    assert window["b1"].info.subharmonic == 3
    assert fold.parameters["r"] == pytest.approx(1 + math.sqrt(8), rel=1e-10)


@pytest.mark.slow
def test_henon_and_its_curves():
    """LP at -(1 - b)^2 / 4, PD at 3 (1 - b)^2 / 4, also as both parameters vary."""
    henon = found(
        HENON,
        "a",
        (-0.13, 0.4),
        diagram="none",
        continue_={"max_points": 200},
        loci={"with": "b", "range": [0.25, 0.35]},
    )
    labels = {point.label: point.parameters["a"] for point in henon["b1"].special_points}
    assert labels["LP"] == pytest.approx(-(0.7**2) / 4, rel=1e-10)
    assert labels["PD"] == pytest.approx(3 * 0.7**2 / 4, rel=1e-10)
    curves = {b.info.settings["of"]: b for b in henon if b.info.problem == "locus"}
    for label, factor in (("LP", -0.25), ("PD", 0.75)):
        a, b = curves[label]["a"], curves[label]["b"]
        assert np.allclose(a, factor * (1 - b) ** 2, rtol=1e-8)
    told = [entry.get("of_problem") for entry in document(henon.database)["branches"]]
    assert told == [None, "fixed_point", "fixed_point"]


def test_henon():
    henon = found(HENON, "a", (0.3, 0.4), diagram="none")
    assert henon["b1/PD1"].parameters["a"] == pytest.approx(3 * 0.7**2 / 4, rel=1e-10)


def test_the_torus_of_the_delayed_logistic_map():
    """At r = 2 the multipliers are exp(+- i pi / 3): resonance 1:6, which is no strong one."""
    delayed = found(DELAYED, "r", (1.9, 2.1))
    torus = delayed["b1/NS1"]
    assert torus.parameters["r"] == pytest.approx(2.0, abs=1e-11)
    assert torus.coefficients["theta"] == pytest.approx(math.pi / 3, abs=1e-9)
    assert torus.coefficients["d"] == pytest.approx(delayed_logistic_d(), rel=1e-8)
    assert torus.criticality == "supercritical"


def delayed_logistic_d():
    """Re d of Kuznetsov (2004), section 5.4, by hand: the map is bilinear, B = (-r (u0 v1 + u1 v0), 0)."""
    r, theta = 2.0, math.pi / 3
    jacobian = np.array([[1.0, -1.0], [1.0, 0.0]])
    values, vectors = np.linalg.eig(jacobian)
    q = vectors[:, np.argmax(values.imag)]
    q = q / np.linalg.norm(q)
    values, vectors = np.linalg.eig(jacobian.T)
    p = vectors[:, np.argmin(values.imag)]
    p = p / np.conj(np.vdot(p, q))

    def second(u, v):
        return np.array([-r * (u[0] * v[1] + u[1] * v[0]), 0.0])

    one, twice = np.eye(2), np.exp(2j * theta) * np.eye(2)
    conjugate = q.conj()
    inner = 2 * second(q, np.linalg.solve(one - jacobian, second(q, conjugate)))
    inner = inner + second(conjugate, np.linalg.solve(twice - jacobian, second(q, q)))
    return float((np.exp(-1j * theta) * np.vdot(p, inner) / 2).real)


@pytest.mark.slow
def test_strong_resonances_on_a_curve_of_tori():
    """Tori at r = 2 for all b, with the trace 1 + b: 1:4 at b = -1, 1:3 at -2, 1:2 at -3."""
    delayed = found(
        DELAYED, "r", (1.9, 2.1), diagram="none", loci={"with": "b", "range": [-3.2, 0.5], "follow": "none"}
    )
    (curve,) = (branch for branch in delayed if branch.info.problem == "locus")
    assert np.allclose(curve["r"], 2.0, rtol=1e-9)
    at = {point.label: point.parameters["b"] for point in curve.special_points}
    for label, b in (("R4", -1.0), ("R3", -2.0), ("R2", -3.0)):
        assert at[label] == pytest.approx(b, abs=1e-7)


def test_ikeda():
    """The determinant is B^2 everywhere; where it doubles its period the trace is -(1 + B^2)."""
    ikeda = found(IKEDA, "A", (0.1, 1.2), diagram="none")
    doublings = [point for point in ikeda["b1"].special_points if point.label == "PD"]
    assert doublings
    for point in doublings:
        product = np.prod([complex(*value) for value in map(_pair, point.spectrum)])
        assert product == pytest.approx(0.49, rel=1e-9)
        x, y = point.state["x"], point.state["y"]
        assert _ikeda_trace(x, y, 0.7) == pytest.approx(-1.49, rel=1e-8)


def _pair(value):
    return (value.real, value.imag) if isinstance(value, complex) else tuple(value)


def _ikeda_trace(x, y, b):
    s, size = 0.4 - 6 / (1 + x * x + y * y), (1 + x * x + y * y) ** 2
    sx, sy = 12 * x / size, 12 * y / size
    first = math.cos(s) - (x * math.sin(s) + y * math.cos(s)) * sx
    second = math.cos(s) + (x * math.cos(s) - y * math.sin(s)) * sy
    return b * (first + second)


def test_a_map_of_an_ode_file(contwalk, tmp_path):
    (tmp_path / "logistic.ode").write_text(ODE)
    assert contwalk("import", "logistic.ode", "--run", "run.yaml")[0] == 0
    code, said = contwalk("continue", "run.yaml", "--quiet", "--set", "diagram.follow=none")
    assert code == 0, said
    (flip,) = (p for p in cw.open_database("run.h5")["b1"].special_points if p.label == "PD")
    assert flip.parameters["a"] == pytest.approx(3.0, abs=1e-11)
    code, said = contwalk("show", "run.h5")
    assert "b1  fixed point, a from 2.8 to 3.2" in said
    assert "integrated by" not in said
    code, said = contwalk("show", "run.h5", "b1/PD1")
    assert "signature" not in said
    assert contwalk("verify", "run.h5", "--trust")[0] == 0


def still(t, x, p, dx):
    dx[0] = -x[0]


def keep(t, x, p, x_plus):
    x_plus[0] = 0.5


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"period": lambda p: 1.0}, "is a map and has period"),
        ({"transitions": (Transition("a", "m", "m", lambda t, x, p: x[0], reset=keep),)}, "has transitions"),
        ({"conserved": (Conserved("e", lambda t, x, p: x[0]),)}, "has conserved"),
    ],
)
def test_what_a_map_does_not_have(more, said):
    with pytest.raises(SystemDefinitionError, match=said):
        logistic(**more)


def test_what_is_no_map():
    with pytest.raises(SystemDefinitionError, match=r"kind 'maps'. Allowed: flow, map"):
        Mode("m", field, kind="maps")
    with pytest.raises(SystemDefinitionError, match="a map among 2 modes"):
        System("s", (State("x"),), (), (Mode("m", field, kind="map"), Mode("n", still)))
    step = Transition("iterate", "n", "n", lambda t, x, p: x[0], reset=keep)
    with pytest.raises(SystemDefinitionError, match="calls a transition 'iterate', as contwalk calls"):
        System("s", (State("x"),), (), (Mode("n", still),), transitions=(step,))
    for text in ("x+ = x/2; period = 1", "x+ = x/2; event e: x falls, x = 1"):
        with pytest.raises(SystemDefinitionError, match="a map has neither a period nor events"):
            cw.system_from_text(text)


CHAOTIC = "x+ = 1 - a*x^2 + y; y+ = b*x; a = 1.4; b = 0.3"


def test_a_motion_is_its_iterates(contwalk, tmp_path):
    """As a loop in Python has them, but for rounding that the map makes larger."""
    (tmp_path / "henon.yaml").write_text(
        f'system: {{equations: "{CHAOTIC}"}}\nstart: {{state: {{x: 0.1, y: 0.2}}}}\nsimulate: {{until: 12}}\n'
    )
    code, said = contwalk("simulate", "henon.yaml", "--no-figures")
    assert (code, "12 steps" in said) == (0, True), said
    table = np.loadtxt(tmp_path / "henon_trajectory.csv", delimiter=",", skiprows=1)
    x, y, exact = 0.1, 0.2, [(0.1, 0.2)]
    for _ in range(12):
        x, y = 1 - 1.4 * x * x + y, 0.3 * x
        exact.append((x, y))
    assert table[:, 0].tolist() == list(range(13))
    assert table[:, 1:] == pytest.approx(np.array(exact), rel=1e-12)
    code, said = contwalk(
        "simulate", "henon.yaml", "--no-figures", "--force", "--set", "simulate.until=200000"
    )
    assert (code, "200000 steps" in said) == (0, True), said
    table = np.loadtxt(tmp_path / "henon_trajectory.csv", delimiter=",", skiprows=1)
    assert table.shape == (1000, 3)
    assert (table[0, 0], table[-1, 0]) == (0.0, 200000.0)
    assert np.abs(table[:, 1]).max() < 1.3


def test_a_motion_ends_where_a_map_has_no_value(contwalk, tmp_path):
    (tmp_path / "log.yaml").write_text(
        'system: {equations: "x+ = log(x)"}\nstart: {state: {x: 2.0}}\nsimulate: {until: 9}\n'
    )
    code, said = contwalk("simulate", "log.yaml", "--no-figures")
    assert (code, "no finite value at iterate 3" in said) == (1, True), said
    table = np.loadtxt(tmp_path / "log_trajectory.csv", delimiter=",", skiprows=1)
    assert table[:, 1] == pytest.approx([2.0, math.log(2), math.log(math.log(2))], rel=1e-15)
