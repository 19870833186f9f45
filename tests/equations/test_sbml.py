"""Models of SBML in the style of published ones, each against its equations by hand at random states."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from by_hand import CLOSE, largest_difference
from mutated import mutated

import contwalk as cw
from contwalk.equations.sbml.document import LARGEST
from contwalk.errors import ContwalkError, SystemDefinitionError
from contwalk.python_functions import plain
from contwalk.system.declarations import ParameterValues
from contwalk.workflow.importing import imported

FOLDER = Path(__file__).parent / "sbml"


def brusselator(t, p, x, y):
    inflow, conversion = p.inflow_k * p.A, p.conversion_k * p.B * x
    fast = p.autocatalysis_k * x * x * y
    return (inflow, -conversion, fast, -p.outflow_k * x), (conversion, -fast)


def enzyme(t, p, s, e, es, product):
    ei = p.EI_total - e - es
    bound, turned, free = p.kf * s * e - p.kr * es, p.kcat * es, p.I_total - ei
    inhibited = p.ki * e * free - p.kd * ei
    return (p.feed, -bound), (-bound, turned, -inhibited), (bound, -turned), (turned, -p.decay * product)


def mitosis(t, p, c, m, x):
    v1, v3 = p.VM1 * c / (p.Kc + c), m * p.VM3
    return (
        (p.vi, -c * p.kd, -p.vd * x * c / (p.Kd + c)),
        (v1 * (1 - m) / (p.K1 + (1 - m)), -p.V2 * m / (p.K1 + m)),
        (v3 * (1 - x) / (p.K3 + (1 - x)), -p.V4 * x / (p.K3 + x)),
    )


def mapk(t, p, a, b, b1, c, c1):
    a1, b2, c2 = p.MKKK_P_total - a, p.MKK_PP_total - b - b1, p.MAPK_PP_total - c - c1
    on = p.V1 * a / ((1 + (c2 / p.Ki) ** p.n) * (p.K1 + a))
    return (
        (-on, p.V2 * a1 / (p.KK2 + a1)),
        (-p.k3 * a1 * b / (p.KK3 + b), p.V6 * b1 / (p.KK6 + b1)),
        (
            p.k3 * a1 * b / (p.KK3 + b),
            -p.k4 * a1 * b1 / (p.KK4 + b1),
            p.V5 * b2 / (p.KK5 + b2),
            -p.V6 * b1 / (p.KK6 + b1),
        ),
        (-p.k7 * b2 * c / (p.KK7 + c), p.V10 * c1 / (p.KK10 + c1)),
        (
            p.k7 * b2 * c / (p.KK7 + c),
            -p.k8 * b2 * c1 / (p.KK8 + c1),
            p.V9 * c2 / (p.KK9 + c2),
            -p.V10 * c1 / (p.KK10 + c1),
        ),
    )


def repressilator(t, p, mx, px, my, py, mz, pz):
    decay, lasting = math.log(2) / p.tau_mRNA, math.log(2) / p.tau_prot
    found = []
    for m, own, other in ((mx, px, pz), (my, py, px), (mz, pz, py)):
        free = (p.tps_active - p.tps_repr) * 60 * p.KM**p.n / (p.KM**p.n + other**p.n)
        found += [
            (-decay * m, p.tps_repr * 60, free),
            (p.eff / (p.tau_mRNA / math.log(2)) * m, -lasting * own),
        ]
    return found


def division(t, p, mass, signal, divisions):
    used = p.kd * signal / (p.J + signal)
    return (p.mu * mass, -p.mu * mass * mass / 10), (p.ks * mass, -used), (0.0,)


def clock(t, p, mrna, cytosol, nucleus):
    light = 1 + p.depth * math.cos(2 * math.pi * t / p.day)
    made = light * p.vs * p.KI**p.n / (p.KI**p.n + nucleus**p.n)
    moved = p.k1 * p.cytosol * cytosol, -p.k2 * p.nucleus * nucleus
    return (
        (made, -p.vm * mrna / (p.Km + mrna)),
        (p.ks * mrna, -p.vd * cytosol / (p.Kd + cytosol), *(-each / p.cytosol for each in moved)),
        tuple(each / p.nucleus for each in moved),
    )


def growing(t, p, volume, s_amount, d_amount, g):
    s, d, n = s_amount / volume, d_amount / volume, p.N_amount / volume
    half = 0.5 if s < 2 * g else 0.0
    taken = p.k * (1.0 if s < g else half)
    pairs, parts = volume * p.k * s * s, volume * p.b * d * n
    return (
        (p.g * volume, -p.g * volume * volume / p.Vmax),
        (taken * p.outside * g, -taken * p.outside * s, -2 * pairs, 2 * parts),
        (pairs, -parts),
        (-taken * g, taken * s, p.b, -p.b * g),
    )


def calcium(t, p, z, y):
    pumped = p.Vm2 * z**p.period_ / (p.K2**p.period_ + z**p.period_)
    freed = p.Vm3 * y**2 / (p.KR**2 + y**2) * z**4 / (p.KA**4 + z**4)
    stored = p.cytosol / p.buffer / p.store
    return (
        (p.v0, p.v1 * p.lambda_, -p.k * z, -pumped, freed, p.kf * y),
        (pumped * stored, -freed * stored, -p.kf * y * stored),
    )


def epidemic(t, p, s, i, virus):
    caught = p.beta * s * i / (1 + virus)
    back = p.wane * p.R_total, -p.wane * s, -p.wane * i
    return (-caught, *back), (caught, -p.gam * i), (2 * p.shed * i, -2 * p.shed * p.clear * virus)


MODELS = {name: globals()[name] for name in (path.stem for path in FOLDER.glob("*.xml"))}


def test_there_are_ten():
    assert len(MODELS) == 10


@pytest.mark.parametrize("name", sorted(MODELS))
def test_rates_are_those_by_hand(name):
    system = imported(FOLDER / f"{name}.xml").system
    assert largest_difference(system, MODELS[name]) < CLOSE


def starts(system):
    return {state.name: state.start for state in system.states}


def test_what_else_a_file_says():
    enzyme_, mapk_, growing_, cells, clock_ = (
        imported(FOLDER / f"{name}.xml") for name in ("enzyme", "mapk", "growing", "repressilator", "clock")
    )
    totals = {name: value for name, value in enzyme_.system.defaults().items() if name.endswith("_total")}
    assert totals == pytest.approx({"EI_total": 1.1, "I_total": 0.7}, rel=1e-15)
    assert [len(mapk_.system.states), len(mapk_.system.signals)] == [5, 3]
    assert starts(growing_.system) == {"V": 2.0, "S_amount": 3.0, "D_amount": 0.8, "G": 2.0}
    assert growing_.system.defaults()["N_amount"] == 1.2
    assert "t_ave" not in cells.system.defaults()  # it follows tau_mRNA along a branch
    period = clock_.system.period(ParameterValues(**clock_.system.defaults()))
    assert period == pytest.approx(24.0, rel=1e-15)
    assert "sha256" in cells.system.reference
    assert any("S, ES" in note or "EI, E, ES" in note for note in enzyme_.model.notes)


def test_events_are_transitions():
    system = imported(FOLDER / "division.xml").system
    divide, starve = system.transitions
    p = ParameterValues(**system.defaults())
    x, after = np.array([0.6, 0.7, 0.0]), np.zeros(3)
    assert plain(divide.guard)(0.0, x, p) == pytest.approx(0.0, abs=1e-16)
    assert (divide.direction, starve.direction) == ("rising", "falling")
    plain(divide.reset)(0.0, x, p, after)
    assert after.tolist() == pytest.approx([0.3, 0.07, 1.0], rel=1e-15)


def test_a_model_runs_as_it_is(contwalk, tmp_path):
    """The Brusselator with rates that are not 1: its Hopf point from the trace of its Jacobian."""
    (tmp_path / "brusselator.xml").write_text((FOLDER / "brusselator.xml").read_text())
    code, said = contwalk("import", "brusselator.xml", "--run", "run.yaml")
    assert code == 0, said
    setting = (
        "--set",
        "continue.parameter=B",
        "--set",
        "continue.range=[1, 3]",
        "--set",
        "diagram.follow=none",
    )
    code, said = contwalk("continue", "run.yaml", "--quiet", "--no-figures", *setting)
    assert code == 0, said
    (hopf,) = (p for p in cw.open_database("run.h5")["b1"].special_points if p.label == "HB")
    # x = k1 A / k4; of the trace k2 B - k4 - k3 x^2 = 0.
    exact = (1.05 + 0.9 * (1.0 / 1.05) ** 2) / 1.1
    assert hopf.parameters["B"] == pytest.approx(exact, rel=1e-12)


HEAD = '<sbml xmlns="http://www.sbml.org/sbml/level3/version2/core" level="3" version="2">\n<model>\n'
MATH = '<math xmlns="http://www.w3.org/1998/Math/MathML" '
MATH += 'xmlns:sbml="http://www.sbml.org/sbml/level3/version2/core">'


def with_rate(inside, parameters=("a", "x")):
    """A model of one state x whose rate is an expression."""
    declared = "\n".join(
        f'<parameter id="{each}" value="{2 + k}" constant="{str(each != "x").lower()}"/>'
        for k, each in enumerate(parameters)
    )
    rule = f'<rateRule variable="x">{MATH}{inside}</math></rateRule>'
    return (
        f"{HEAD}<listOfParameters>\n{declared}\n</listOfParameters>\n<listOfRules>\n{rule}\n</listOfRules>\n"
        "{more}</model></sbml>"
    )


def applied(function, *arguments):
    return f"<apply><{function}/>{''.join(arguments)}</apply>"


def cn(value):
    return f"<cn>{value!r}</cn>"


X, A = "<ci>x</ci>", "<ci>a</ci>"
TIME = '<csymbol encoding="text" definitionURL="http://www.sbml.org/sbml/symbols/time">t</csymbol>'
AVOGADRO = '<csymbol encoding="text" definitionURL="http://www.sbml.org/sbml/symbols/avogadro">N</csymbol>'
PIECES = "<piecewise><piece>{}{}</piece><piece>{}{}</piece><otherwise>{}</otherwise></piecewise>"
VALUES = {
    applied("plus", X, A, cn(0.5)): 5.5,
    applied("plus"): 0.0,
    applied("minus", X): -3.0,
    applied("times", X, A, applied("divide", A, X)): 4.0,
    applied("power", X, A): 9.0,
    applied("root", A): math.sqrt(2),
    applied("root", f"<degree>{cn(3.0)}</degree>", X): 3 ** (1 / 3),
    applied("log", X): math.log10(3),
    applied("log", f"<logbase>{cn(2.0)}</logbase>", X): math.log2(3),
    applied("ln", X): math.log(3),
    applied("exp", A): math.exp(2),
    applied("factorial", X): 6.0,
    applied("ceiling", applied("floor", cn(2.5))): 2.0,
    applied("abs", cn(-2.5)): 2.5,
    applied("sec", X): 1 / math.cos(3),
    applied("coth", X): 1 / math.tanh(3),
    applied("arccsc", X): math.asin(1 / 3),
    applied("arccot", X): math.atan(1 / 3),
    applied("arcsech", cn(0.5)): math.acosh(2),
    applied("arctan", applied("tanh", X)): math.atan(math.tanh(3)),
    applied("max", X, A, applied("min", X, cn(7.0))): 3.0,
    applied("quotient", cn(-7.0), A): -3.0,
    applied("rem", cn(-7.0), A): -1.0,
    PIECES.format(cn(1.0), applied("lt", X, A), cn(2.0), applied("lt", A, X, cn(9.0)), cn(3.0)): 2.0,
    PIECES.format(cn(1.0), applied("xor", "<true/>", applied("eq", X, X)), cn(2.0), "<false/>", cn(5.0)): 5.0,
    PIECES.format(
        cn(1.0), applied("not", applied("implies", "<true/>", "<false/>")), cn(2.0), "<false/>", cn(5.0)
    ): 1.0,
    applied("times", "<pi/>", "<exponentiale/>"): math.pi * math.e,
    '<cn type="e-notation">1.5<sep/>2</cn>': 150.0,
    '<cn type="rational">1<sep/>3</cn>': 1 / 3,
    '<cn type="integer">4</cn>': 4.0,
    applied("times", TIME, X): 1.5,
    applied("divide", AVOGADRO, cn(1e23)): 6.02214179,
}


@pytest.mark.parametrize("inside", VALUES, ids=lambda inside: inside[:40])
def test_functions(tmp_path, inside):
    path = tmp_path / "model.xml"
    path.write_text(with_rate(applied("plus", inside, applied("times", cn(0.0), X))).format(more=""))
    system = imported(path).system
    rate = np.zeros(1)
    plain(system.modes[0].field)(0.5, np.array([3.0]), ParameterValues(**system.defaults()), rate)
    assert rate[0] == pytest.approx(VALUES[inside], rel=1e-15)


EVENT = (
    "<listOfEvents>\n<event useValuesFromTriggerTime='true'>\n"
    "<trigger initialValue='true' persistent='true'>{trigger}</trigger>\n{more}"
    "<listOfEventAssignments><eventAssignment variable='{sets}'>{to}</eventAssignment>"
    "</listOfEventAssignments>"
    "</event></listOfEvents>"
)
GROWS = f"{MATH}{applied('gt', X, A)}</math>"
HALF = f"{MATH}{cn(0.5)}</math>"
DELAY = f"<delay>{HALF}</delay>\n"
REFUSED = {
    "not xml at all": "line 1: this is no XML",
    "<a>\n<b></a>": "line 2: this is no XML",
    '<!DOCTYPE x [<!ENTITY a "b">]>\n<x/>': "line 1: a document type is declared",
    "<html></html>": "line 1",
    '<sbml xmlns="http://www.sbml.org/sbml/level1" level="1" version="2"><model/></sbml>': "is level 1",
    HEAD + "</model></sbml>": "there is no equation",
    HEAD + "<nonsense/></model></sbml>": "Encountered unrecognized element",
    with_rate(A, ("x",)).format(more=""): "'a' is not defined",
    with_rate(X, ("a",)).format(more=""): "the rule sets 'x', which is no compartment, species or parameter",
    with_rate(applied("plus", A, "<infinity/>")).format(more=""): "line 8: the number inf is none",
    with_rate("<apply><ci>f</ci><ci>x</ci></apply>").format(more=""): "there is no function 'f'",
    with_rate(
        '<apply><csymbol encoding="text" definitionURL="http://www.sbml.org/sbml/symbols/delay">d</csymbol>'
        "<ci>x</ci><ci>a</ci></apply>"
    ).format(more=""): "line 8: the past of a quantity stands in an expression",
    with_rate(X).format(
        more=EVENT.format(trigger=GROWS, more=DELAY, sets="x", to=HALF)
    ): "an event acts after",
    with_rate(X).format(
        more=EVENT.format(trigger=GROWS, more="", sets="a", to=HALF)
    ): "'a', which is constant",
    with_rate(X).format(
        more=EVENT.format(trigger=f"{MATH}{applied('eq', X, A)}</math>", more="", sets="x", to=HALF)
    ): "line 12: the trigger of the event is no comparison of sizes",
    with_rate(A)
    .replace("<rateRule variable", "<algebraicRule><!--")
    .replace(">" + MATH, "-->" + MATH)
    .replace("</rateRule>", "</algebraicRule>")
    .format(more=""): "an algebraic rule is solved",
    with_rate(X).replace('value="2"', "").format(more=""): "'a' has no finite value",
    with_rate(applied("minus", *[X] * 1))
    .replace(X, "<apply><minus/>" * 400 + X + "</apply>" * 400, 1)
    .format(more=""): "elements stand inside each other",
    with_rate(X).replace('id="a"', 'id="x"').format(more=""): "defined again",
}


@pytest.mark.parametrize("text", REFUSED, ids=lambda text: REFUSED[text][:40])
def test_what_is_refused(tmp_path, text):
    path = tmp_path / "model.xml"
    path.write_text(text)
    with pytest.raises(ContwalkError) as caught:
        imported(path)
    assert REFUSED[text] in str(caught.value)
    assert str(caught.value).startswith(str(path))


def test_reactions_that_cannot_be_rates(tmp_path):
    whole, path = (FOLDER / "enzyme.xml").read_text(), tmp_path / "model.xml"
    law = whole.index("<kineticLaw>")
    cases = {
        whole.replace('fast="false"', 'fast="true"', 1): "a fast reaction is solved at each instant",
        whole[:law] + whole[whole.index("</kineticLaw>") + len("</kineticLaw>") :]: "'bind' has no rate",
        whole.replace('species="ES" stoichiometry="1"', 'species="none" stoichiometry="1"'): "is no species",
        whole.replace('compartment="cell"', 'compartment="none"', 1): "is in no compartment",
    }
    for text, why in cases.items():
        path.write_text(text)
        with pytest.raises(ContwalkError, match=rf"model.xml, line \d+: .*{why}"):
            imported(path)


def test_without_the_library_it_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "libsbml", None)
    with pytest.raises(ContwalkError, match=r"not installed\. pip install 'contwalk"):
        imported(FOLDER / "enzyme.xml")


def test_large_files_are_refused(tmp_path):
    path = tmp_path / "model.xml"
    path.write_text(HEAD + " " * LARGEST["characters"] + "</model></sbml>")
    with pytest.raises(ContwalkError, match="are read"):
        imported(path)


def test_mutated_files_are_models_or_refused(tmp_path, monkeypatch):
    """Thousands of them were tried once, under other seeds."""
    monkeypatch.chdir(tmp_path)
    texts = sorted(path.read_text() for path in FOLDER.glob("*.xml"))
    models, path = 0, tmp_path / "model.xml"
    for text in mutated(texts, 100, seed=1):
        path.write_text(text, encoding="utf-8", errors="replace")
        try:
            imported(path)
            models += 1
        except SystemDefinitionError:
            pass
    assert 2 < models < 98
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]
