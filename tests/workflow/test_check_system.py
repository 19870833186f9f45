"""`contwalk systems check`: good plugins pass, and each kind of mistake is told with its line."""

from __future__ import annotations

import pytest
from checked_plugins import IMPACT, PENDULUMS, broken, checked, line_of, troubles

from contwalk.errors import SystemDefinitionError
from contwalk.plugin_check import system as module
from contwalk.plugin_check.system import check_reference, check_system
from contwalk.system import Choice, Family, Mode, Parameter, State, System, load_system


def test_good_smooth_plugin_passes(tmp_path):
    findings = checked(tmp_path, PENDULUMS)
    assert troubles(findings) == []
    said = {finding.what: finding for finding in findings}
    for what, text in (
        ("field of mode 'free'", "def field"),
        ("symmetry 'mirror'", "def mirror"),
        ("neutral direction 'shift'", "def shift"),
        ("observable 'swing'", "def swing"),
        ("start 'hanging'", "def hanging"),
    ):
        assert said[what].line == line_of(PENDULUMS, text)
    assert "f(S x) = DS f(x) holds" in said["symmetry 'mirror'"].sentence
    assert "1 equilibrium" in said["start 'hanging'"].sentence


def test_good_forced_plugin_with_impacts_passes(tmp_path):
    findings = checked(tmp_path, IMPACT)
    assert troubles(findings) == []
    sentences = [finding.sentence for finding in findings]
    assert any("leaves its guard behind" in sentence for sentence in sentences)
    assert any("4.83322 s" in sentence for sentence in sentences)  # 2 pi / 1.3


def test_first_party_system_passes_with_every_model():
    findings = check_reference("autobalancer")
    assert troubles(findings) == []
    assert list(dict.fromkeys(f.model for f in findings)) == [
        "masses=2, suspension=isotropic",
        "masses=1, suspension=isotropic",
        "masses=3, suspension=isotropic",
        "masses=2, suspension=anisotropic",
    ]
    assert any(f.what == "symmetry 'exchange_2_3'" for f in findings)


def test_same_findings_twice(tmp_path):
    source = broken(PENDULUMS, "x_image[1] = -x[1]", "x_image[1] = x[1]")
    assert checked(tmp_path, source) == checked(tmp_path, source)


# source, the old text, the new text, level, what, a part of the sentence, a text on the line
MISTAKES = {
    "component not written": (
        PENDULUMS, "    dx[2] = -x[2] + x[0] ** 3\n", "", "error",
        "field of mode 'free'", "does not write dx[2] (state drive)", "def field",
    ),
    "wrong symmetry": (
        PENDULUMS, "x_image[1] = -x[1]", "x_image[1] = x[1]", "error",
        "symmetry 'mirror'", "does not hold in mode 'free': the rate of", "def mirror",
    ),
    "symmetry broken by the field": (
        PENDULUMS, "x[0] ** 3", "x[0] ** 2", "error",
        "symmetry 'mirror'", "the rate of drive at the image is", "def mirror",
    ),
    "image not written": (
        PENDULUMS, "    x_image[2] = -x[2]\n", "", "error",
        "symmetry 'mirror'", "does not write x_image[2]", "def mirror",
    ),
    "generator not written": (
        PENDULUMS, "    v[1] = 0.0\n", "", "error",
        "neutral direction 'shift'", "does not write v[1] (state speed)", "def shift",
    ),
    "not finite at the defaults": (
        PENDULUMS, "dx[0] = x[1]", "dx[0] = x[1] / p.k", "error",
        "field of mode 'free'", "not finite at any state", "dx[0] = x[1] / p.k",
    ),
    "not finite at some states": (
        PENDULUMS, "dx[0] = x[1]", "dx[0] = x[1] * math.sqrt(1.0 - x[1] ** 2)", "warning",
        "field of mode 'free'", "A run that gets there ends", "math.sqrt",
    ),
    "raises everywhere": (
        PENDULUMS, "dx[0] = x[1]", "dx[0] = x[7]", "error",
        "field of mode 'free'", "raises IndexError", "dx[0] = x[7]",
    ),
    "raises at some states": (
        PENDULUMS, "    dx[0] = x[1]\n",
        "    if x[0] > 100.0:\n        raise ValueError('overturned')\n    dx[0] = x[1]\n",
        "warning", "field of mode 'free'", "ValueError: overturned", "raise ValueError",
    ),
    "unknown parameter": (
        PENDULUMS, "dx[0] = x[1]", "dx[0] = x[1] * p.mass", "error",
        "field of mode 'free'", "has no parameter 'mass'", "p.mass",
    ),
    "number of arguments": (
        PENDULUMS, "def field(t, x, p, dx):", "def field(x, p, dx):\n    t = 0.0", "error",
        "field of mode 'free'", "Its form is field(t, x, p, dx)", "def field",
    ),
    "whole number of a state": (
        PENDULUMS, "dx[0] = x[1]", "dx[0] = math.cos(int(x[0]))", "error",
        "field of mode 'free'", "made a whole number", "int(x[0])",
    ),
    "loop that depends on the state": (
        PENDULUMS, "    dx[0] = x[1]\n",
        "    y = x[1]\n    while y > 1e-9:\n        y = y / 2\n    dx[0] = y\n",
        "error", "field of mode 'free'", "fixed number of passes", "while y > 1e-9",
    ),
    "random number": (
        PENDULUMS, "dx[0] = x[1]", "dx[0] = x[1] + __import__('random').random()", "error",
        "field of mode 'free'", "depends on something besides t, x and p", "def field",
    ),
    "time without a period": (
        PENDULUMS, "dx[0] = x[1]", "dx[0] = x[1] + math.cos(t)", "error",
        "field of mode 'free'", "declares no period", "def field",
    ),
    "not an equilibrium": (
        PENDULUMS.replace("-p.g * math.sin(x[0])", "-p.g * (2.0 + math.sin(x[0]))"),
        "return [[0.0, 0.0, 0.0]]", "return [[0.1, 0.0, 0.001]]", "error",
        "start 'hanging'", "not an equilibrium", "def hanging",
    ),
    "a guess": (
        PENDULUMS, "return [[0.0, 0.0, 0.0]]", "return [[0.1, 0.0, 0.001]]", "warning",
        "start 'hanging'", "corrects it wherever it is used, here by 0.1 in angle", "def hanging",
    ),
    "start of another length": (
        PENDULUMS, "return [[0.0, 0.0, 0.0]]", "return [[0.0, 0.0]]", "error",
        "start 'hanging'", "3 entries", "def hanging",
    ),
    "start that raises": (
        PENDULUMS, "return [[0.0, 0.0, 0.0]]", "return [[1 / p.k, 0.0, 0.0]]", "error",
        "start 'hanging'", "ZeroDivisionError", "1 / p.k",
    ),
    "observable of one instant": (
        PENDULUMS, "return x[:, 0].max() - x[:, 0].min()", "return x[1, 0]", "error",
        "observable 'swing'", "motion of 1 instant it raises IndexError", "return x[1, 0]",
    ),
    "observable that is an array": (
        PENDULUMS, "return x[:, 0].max() - x[:, 0].min()", "return x[:, 0]", "error",
        "observable 'swing'", "one finite number", "def swing",
    ),
    "preset outside the bounds": (
        PENDULUMS, '{"c": 4.0}', '{"c": 6.0}', "error",
        "preset 'damped'", "c = 6.0 lies outside [0, 5]", None,
    ),
    "no unit of a state": (
        PENDULUMS, 'State("drive", unit="1", ', 'State("drive", ', "warning",
        "state 'drive'", "No unit is given", 'State("drive"',
    ),
    "empty unit of a parameter": (
        PENDULUMS, 'unit="1/s", ', 'unit="", ', "warning",
        "parameter 'c'", "No unit is given", 'Parameter("c"',
    ),
    "no meaning": (
        PENDULUMS, ', about="gravity"', "", "warning",
        "parameter 'g'", "No meaning is given", 'Parameter("g"',
    ),
    "no reference": (
        PENDULUMS, '    reference="any textbook",\n', "", "warning",
        "system 'pendulums'", "no reference", None,
    ),
    "syntax": (
        PENDULUMS, "def swing(t, x, p):", "def swing(t, x, p)", "error", "plugin", "SyntaxError", "def swing",
    ),
    "import": (
        PENDULUMS, "import math", "import mathh", "error",
        "plugin", "No module named 'mathh'", "import mathh",
    ),
    "no SYSTEM": (PENDULUMS, "SYSTEM =", "SYTSEM =", "error", "plugin", "exports no SYSTEM", None),
    "default outside the bounds": (
        PENDULUMS, 'Parameter("c", 0.1,', 'Parameter("c", 7.0,', "error",
        "plugin", "outside its bounds", 'Parameter("c"',
    ),
    "plugin that exits": (
        PENDULUMS, "import math", "raise SystemExit(0)", "error", "plugin", "SystemExit", "raise SystemExit",
    ),
    "guard that returns nothing": (
        IMPACT, "return p.gap - x[0]", "p.gap - x[0]", "error",
        "guard of transition 'impact'", "returns nothing", "def clearance",
    ),
    "guard that is a condition": (
        IMPACT, "return p.gap - x[0]", "return p.gap > x[0]", "error",
        "guard of transition 'impact'", "True or False", "def clearance",
    ),
    "guard that is constant": (
        IMPACT, "return p.gap - x[0]", "return p.gap", "error",
        "guard of transition 'impact'", "never passes zero", "def clearance",
    ),
    "reset that writes too little": (
        IMPACT, "    x_plus[0] = x[0]\n", "", "error",
        "reset of transition 'impact'", "does not write x_plus[0] (state q)", "def rebound",
    ),
    "reset that does not turn round": (
        IMPACT, "-p.restitution * x[1]", "p.restitution * x[1]", "warning",
        "reset of transition 'impact'", "goes on through it, at every state", "def rebound",
    ),
    "reset that does not turn round, of a level": (
        IMPACT.replace("reset=rebound", "reset=rebound, level=True"),
        "-p.restitution * x[1]", "p.restitution * x[1]", "error",
        "reset of transition 'impact'", "not left behind at every state", "def rebound",
    ),
    "reset that goes through the stop": (
        IMPACT, "x_plus[0] = x[0]", "x_plus[0] = x[0] + 0.1", "warning",
        "reset of transition 'impact'", "past zero, or goes on through it, at every state", "def rebound",
    ),
    "reset that turns round fast motions only": (
        IMPACT, "-p.restitution * x[1]", "0.5 - p.restitution * x[1]", "warning",
        "reset of transition 'impact'", "goes on through it, at", "def rebound",
    ),
    "wrong period": (
        IMPACT, "2.0 * math.pi / p.omega", "math.pi / p.omega", "error",
        "field of mode 'free'", "does not repeat after period(p) = 2.4166", "def field",
    ),
    "negative period": (
        IMPACT, "2.0 * math.pi / p.omega", "-2.0 * math.pi / p.omega", "error",
        "period", "must be a positive number", "def period",
    ),
    "period that raises": (
        IMPACT, "2.0 * math.pi / p.omega", "2.0 * math.pi / p.frequency", "error",
        "period", "raises AttributeError", "p.frequency",
    ),
    "period in whole numbers": (
        IMPACT, "2.0 * math.pi / p.omega", "2.0 * math.pi / int(p.omega)", "error",
        "period", "made a whole number", "int(p.omega)",
    ),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistake_is_told_with_its_line(tmp_path, mistake):
    source, old, new, level, what, sentence, on_line = MISTAKES[mistake]
    source = broken(source, old, new)
    found = [f for f in checked(tmp_path, source) if f.level == level and f.what.startswith(what)]
    assert any(sentence in f.sentence for f in found), [f.sentence for f in found]
    finding = next(f for f in found if sentence in f.sentence)
    assert finding.line == (None if on_line is None else line_of(source, on_line))


@pytest.mark.parametrize("mistake", [name for name in MISTAKES if MISTAKES[name][3] == "warning"])
def test_warnings_are_not_errors(tmp_path, mistake):
    source, old, new, *_ = MISTAKES[mistake]
    assert all(finding.level != "error" for finding in checked(tmp_path, broken(source, old, new)))


def test_derivative_of_a_staircase(tmp_path):
    # Steps of 1e-9: the values are nearly those of x[1], the exact derivative is zero nearly everywhere.
    source = broken(PENDULUMS, "dx[0] = x[1]", "dx[0] = math.floor(x[1] * 1e9) / 1e9")
    found = [
        f
        for f in checked(tmp_path, source)
        if "derivative of dx[0] (state angle) by speed is 0" in f.sentence
    ]
    assert [(f.level, f.line) for f in found] == [("error", line_of(source, "def field"))]
    assert "central difference" in found[0].sentence


def test_start_that_does_not_exist_is_no_mistake(tmp_path):
    source = broken(PENDULUMS, "return [[0.0, 0.0, 0.0]]", "return []")
    findings = checked(tmp_path, source)
    assert troubles(findings) == []
    assert any("not checked" in f.sentence and "does not exist" in f.sentence for f in findings)


def test_guard_out_of_reach_is_said(tmp_path):
    source = broken(IMPACT, "return p.gap - x[0]", "return 2.0 - 2.0 * x[0] + x[0] ** 2")
    findings = checked(tmp_path, source)
    (found,) = troubles(findings)
    assert found.level == "warning"
    assert "No state was found at which it passes zero (falling): it is positive" in found.sentence
    assert any("no state at the event was found" in f.sentence for f in findings)


def test_reset_into_a_mode_without_the_guard(tmp_path):
    source = broken(IMPACT, 'Mode("free", field),', 'Mode("free", field), Mode("held", field),')
    source = broken(source, 'target="free"', 'target="held"')
    findings = checked(tmp_path, source)
    (found,) = troubles(findings)  # that is right for a motion, and no orbit can be found
    assert "never come round" in found.sentence
    assert any("does not have its guard" in f.sentence for f in findings)


def test_symmetry_half_a_period_later(tmp_path):
    source = broken(
        IMPACT,
        "def period",
        "def turned(t, x, p, x_image):\n    x_image[0] = -x[0]\n    x_image[1] = -x[1]\n\ndef period",
    )
    source = broken(
        source,
        "    period=period,",
        '    period=period, symmetries=(Symmetry("turned", "spatial", turned),),',
    )
    source = broken(source, "System, Transition", "Symmetry, System, Transition")
    # Its field is symmetric; one stop on one side is not, and that is all there is to say.
    (found,) = troubles(checked(tmp_path, source))
    assert (found.level, found.what) == ("warning", "symmetry 'turned'")
    assert "does not take transition 'impact' to itself" in found.sentence


# A start of the forced plugin. Under force it is in balance at t = 0 for q = force, but not later.
STANDING = """\
def standing(p):
    return [[{q}, 0.0]]

def period"""


@pytest.mark.parametrize(
    ("q", "force", "level", "sentence"),
    [
        ("0.0", "(p.force - p.force) * ", "ok", "gives 1 constant solution at the defaults."),
        ("p.force", "p.force * ", "error", "not a constant solution at the defaults: dx[1] (state v) is"),
    ],
)
def test_start_of_a_forced_system_is_a_constant_solution(tmp_path, q, force, level, sentence):
    source = broken(IMPACT, "def period", STANDING.format(q=q))
    source = broken(source, "p.force * ", force)
    source = broken(source, "    period=period,", '    period=period, starts=(Start("standing", standing),),')
    source = broken(source, "Parameter, State", "Parameter, Start, State")
    (finding,) = [f for f in checked(tmp_path, source) if f.what == "start 'standing'"]
    assert (finding.level, finding.line) == (level, line_of(source, "def standing"))
    assert sentence in finding.sentence


def test_several_mistakes_are_all_told(tmp_path):
    source = broken(PENDULUMS, "    dx[2] = -x[2] + x[0] ** 3\n", "")
    source = broken(source, "    v[1] = 0.0\n", "")
    source = broken(source, '{"c": 4.0}', '{"c": 6.0}')
    errors = [f.what for f in checked(tmp_path, source) if f.level == "error"]
    assert errors == ["field of mode 'free'", "neutral direction 'shift'", "preset 'damped'"]


def test_no_such_plugin_is_bad_input(tmp_path):
    with pytest.raises(SystemDefinitionError, match="does not exist"):
        check_reference(str(tmp_path / "none.py"))
    with pytest.raises(SystemDefinitionError, match="no installed system named 'autobalancr'"):
        check_reference("autobalancr")


def test_system_built_in_python():
    def field(t, x, p, dx):
        dx[0] = p.a - x[0]

    system = System("tank", (State("h", "m", about="height"),), (Parameter("a", 1.0, "m", about="inflow"),),
                    (Mode("filling", field),), reference="none")  # fmt: skip
    assert troubles(check_system(system)) == []
    assert {f.line for f in check_system(system)} == {None, field.__code__.co_firstlineno}


def test_model_that_cannot_be_built(tmp_path, monkeypatch):
    def build(masses):
        if masses == 1:
            raise RuntimeError("one is too few")
        return load_system("autobalancer", {"masses": masses})

    family = Family("machine", (Choice("masses", 2, minimum=1),), build)
    plugin = tmp_path / "family.py"
    plugin.write_text("", encoding="utf-8")
    monkeypatch.setattr(module, "load_declaration", lambda reference, base: family)
    errors = [f for f in check_reference(str(plugin)) if f.level == "error"]
    assert [(f.model, f.sentence) for f in errors] == [
        ("masses=1", "It raises RuntimeError: one is too few.")
    ]
    assert errors[0].line == build.__code__.co_firstlineno + 2


@pytest.mark.parametrize(
    "force", ["np.clip(x[0], -1.0, 1.0)", "np.clip(x, -1.0, 1.0)[0]", "min(max(x[0], -1.0), 1.0)"]
)
def test_a_force_that_is_cut_off_is_told_by_its_two_bends(tmp_path, force):
    text = PENDULUMS[: PENDULUMS.index("from")] + (
        "import numpy as np\n"
        "from contwalk.system import Mode, Parameter, State, System\n\n"
        "def field(t, x, p, dx):\n"
        f"    dx[0] = p.a - {force} - 0.1 * x[0]\n"
        "    dx[1] = -x[1]\n\n"
        'SYSTEM = System("cut", (State("x", "m", about="place"), State("y", "m", about="width")),\n'
        '    (Parameter("a", 0.0, "m/s", about="speed"),), (Mode("only", field),), reference="none")\n'
    )
    told = troubles(checked(tmp_path, text))
    assert [finding.level for finding in told] == ["warning"] * 2
    assert all("Its slopes jump here" in finding.sentence for finding in told)
    assert {finding.line for finding in told} == {line_of(text, "dx[0]")}
