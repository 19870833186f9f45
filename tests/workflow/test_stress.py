"""A study in other units: each function of a plugin means the same, and what differs is told."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from contwalk_systems.impact_oscillator import SYSTEM as OSCILLATOR
from contwalk_systems.walker3d import SYSTEM as WALKERS

from contwalk.errors import NotFinite
from contwalk.flow.compiled.traced import field_of
from contwalk.system import (
    Conserved,
    Mode,
    Neutral,
    Observable,
    Parameter,
    Start,
    State,
    Symmetry,
    System,
    Transition,
)
from contwalk.system.declarations import ParameterValues
from contwalk.workflow.run_file.reading import read_run_text
from contwalk.workflow.stress import stressing
from contwalk.workflow.stress.cases import Case, cases_of
from contwalk.workflow.stress.rescaled_run import rescaled_run
from contwalk.workflow.stress.rescaled_system import rescaled_system
from contwalk.workflow.stress.units import Units, units_of


def spring(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.k * x[0] + p.tilt * math.cos(p.w * t)


def kicked(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = -x[1]


def turned(t, x, p, x_image):
    x_image[0] = -x[0]
    x_image[1] = -x[1]


def along(t, x, p, v):
    v[0] = 1.0
    v[1] = 0.0


MACHINE = System(
    name="machine",
    states=(State("q", scale=2.0), State("v")),
    parameters=(
        Parameter("k", 4.0, bounds=(0.0, None)),
        Parameter("tilt", 0.5),
        Parameter("w", 3.0),
        Parameter("place", 0.25),
    ),
    modes=(Mode("on", spring),),
    transitions=(Transition("stop", "on", "on", lambda t, x, p: x[0] + p.k, reset=kicked),),
    symmetries=(Symmetry("turn", "spatial", turned),),
    neutral=(Neutral("aside", along, pin="q", value="place"),),
    conserved=(),
    period=lambda p: 2.0 * math.pi / p.w,
    observables=(Observable("top", lambda t, x, p: x[:, 0].max()),),
    starts=(Start("rest", lambda p: [[p.tilt, 0.0]]),),
    presets={"soft": {"k": 1.0}},
    fallen=lambda t, x, p: x[0] - 3.0 * p.k,
)
# Factors of their own, and the last state first.
UNITS = Units(
    {"q": 8.0, "v": 0.25}, {"k": 16.0, "tilt": 2.0, "w": 0.5, "place": 8.0}, 4.0, ("v", "q"), ("q", "v")
)


def test_every_function_means_the_same():
    other = rescaled_system(MACHINE, UNITS)
    t, own = 0.7, np.array([0.3, -1.1])
    p = ParameterValues(**MACHINE.defaults())
    new = UNITS.new(own)
    assert new.tolist() == [-1.1 * 0.25, 0.3 * 8.0]
    assert UNITS.own(new).tolist() == own.tolist()
    q = ParameterValues(**{name: value * UNITS.of(name) for name, value in MACHINE.defaults().items()})
    rates, result = np.zeros(2), np.zeros(2)
    spring(t, own, p, rates)
    other.modes[0].field(4.0 * t, new, q, result)
    assert result.tolist() == (UNITS.new(rates) / 4.0).tolist()
    assert field_of(other)(4.0 * t, new, field_of(other).constants(np.array(list(vars(q).values()))))[
        ::-1
    ] == pytest.approx(rates * [8.0, 0.25] / 4.0, rel=1e-15)
    stop, own_stop = other.transitions[0], MACHINE.transitions[0]
    assert stop.guard(4.0 * t, new, q) == own_stop.guard(t, own, p)
    for function, image in ((stop.reset, kicked), (other.symmetries[0].map, turned)):
        after = np.zeros(2)
        image(t, own, p, after)
        function(4.0 * t, new, q, result)
        assert result.tolist() == UNITS.new(after).tolist()
    assert other.period(q) == 4.0 * MACHINE.period(p)
    assert other.observables[0].function(np.array([0.0]), new[None], q) == 0.3
    assert other.named_states("rest", vars(q))[0].tolist() == [0.0, 4.0]
    assert other.fallen(t, new, q) == MACHINE.fallen(t, own, p)
    assert other.presets == {"soft": {"k": 16.0}}
    assert [(state.name, state.scale) for state in other.states] == [("v", None), ("q", 16.0)]
    assert other.parameters[0].bounds == (0.0, None)


def test_what_is_pinned_has_the_unit_of_its_state():
    assert units_of(MACHINE, states=8.0).parameters == {"k": 1.0, "tilt": 1.0, "w": 1.0, "place": 8.0}


def test_a_conserved_quantity_is_a_parameter():
    quantity = Conserved("energy", lambda t, x, p: 0.5 * x[1] ** 2 + 0.5 * p.k * x[0] ** 2)
    system = replace(MACHINE, conserved=(quantity,), transitions=(), neutral=(), symmetries=(), period=None)
    units = units_of(system, parameters=4.0)
    other = rescaled_system(system, units)
    p = ParameterValues(k=16.0)
    assert other.conserved[0].of("on")(0.0, np.array([0.5, 3.0]), p) == 4.0 * (4.5 + 0.5)


def test_modes_that_share_a_field_still_do():
    system = WALKERS.build()
    other = rescaled_system(system, units_of(system, states=2.0, turned=True))
    assert len({mode.field for mode in other.modes}) == len({mode.field for mode in system.modes})
    guards = {each.guard for each in system.transitions}
    assert len({each.guard for each in other.transitions}) == len(guards)


def test_periods_extremes_and_rates_have_units():
    found = {name: UNITS.of(name) for name in ("period", "max:q", "amp:v", "max_re", "max_abs", "w", "top")}
    assert found == {
        "period": 4.0,
        "max:q": 8.0,
        "amp:v": 0.25,
        "max_re": 0.25,
        "max_abs": 1.0,
        "w": 0.5,
        "top": 1.0,
    }


RUN = """\
system: impact_oscillator
start: {simulate: {state: {q: 0.0, v: 0.0}, until: 50}}
continue: {parameter: force, range: [0.3, 0.6], stop_at: {"max:q": 0.5}}
mark: {force: [0.4], max_abs: [0.9]}
report_at: {section: {q: 0.1}, direction: rising}
"""


def test_a_run_file_has_all_its_numbers_in_the_new_units(tmp_path):
    run = read_run_text(RUN, tmp_path / "run.yaml")
    units = units_of(OSCILLATOR, states=8.0, parameters=2.0, time=4.0)
    other = rescaled_run(run, units)
    assert other.range == (0.6, 1.2)
    assert other.starts[0].until == 200
    assert other.stop_at == {"max:q": (4.0,)}
    assert {mark.name: mark.values for mark in other.marks} == {"force": (0.8,), "max_abs": (0.9,)}
    assert other.report_at is not None
    assert other.report_at.section == ("q", 0.8)
    assert other.parameters == {name: 2.0 * value for name, value in run.parameters.items()}


def test_what_differs_and_what_is_refused_are_told(tmp_path, monkeypatch):
    run = read_run_text(RUN.partition("mark")[0], tmp_path / "run.yaml")
    as_it_is = units_of(OSCILLATOR)
    wrong = units_of(OSCILLATOR, time=1.25)  # the force would come and go at another pace
    cases = [
        Case("as before", as_it_is),
        Case("another machine", as_it_is),
        Case("no machine", wrong),
    ]
    monkeypatch.setattr(stressing, "cases_of", lambda system: cases)
    make = stressing.rescaled_run

    def other(run_file, units):
        if units is wrong:
            raise NotFinite("The field is not finite.", "Mend it.")
        changed = make(run_file, units)
        damping = {"zeta": 0.1 if seen == ["as it is"] else 0.11}
        starts = tuple(replace(start, parameters={**start.parameters, **damping}) for start in changed.starts)
        return replace(changed, starts=starts)

    seen: list[str] = []
    monkeypatch.setattr(stressing, "rescaled_run", other)
    found = stressing.stressed(run, lambda result: seen.append(result.case))
    assert seen == ["as it is", "as before", "another machine", "no machine"]
    assert [result.verdict for result in found.results] == ["same", "same", "differs", "refused"]
    assert found.results[2].sentences
    assert found.results[3].sentences == ("The field is not finite. Mend it.",)
    assert not found.same


def test_the_changes_are_those_that_are_told():
    names = [case.name for case in cases_of(OSCILLATOR)]
    assert len(names) == len(set(names)) == 11
    assert {case.accuracy for case in cases_of(OSCILLATOR)} == {None, 1e-3, 1e-6, 1e-10, 1e-13}
