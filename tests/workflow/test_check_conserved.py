"""What is declared to be conserved, and is not, is refused with the plugin's line."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from conserved_machines import BALL, PENDULUM

from contwalk.errors import SystemDefinitionError
from contwalk.plugin_check.at_load import refuse_unsound
from contwalk.plugin_check.system import check_system
from contwalk.system import Conserved, Neutral, Observable, Parameter, Transition


def findings(system, level):
    return [f for f in check_system(system) if "conserved quantity" in f.what and f.level == level]


def test_what_is_conserved_is_found_to_be():
    for system in (BALL, PENDULUM):
        refuse_unsound(system)
        assert not findings(system, "error")
        (found,) = findings(system, "ok")
        assert "is conserved at" in found.sentence


def without_potential(t, x, p):
    return 0.5 * x[1] ** 2


def test_a_field_that_does_not_conserve_it():
    system = replace(BALL, conserved=(Conserved("energy", without_potential),))
    (found,) = findings(system, "error")
    assert "not conserved in mode 'flight'" in found.sentence
    assert found.file == __file__
    assert found.line == without_potential.__code__.co_firstlineno
    with pytest.raises(SystemDefinitionError, match="not conserved in mode 'flight'"):
        refuse_unsound(system)


def loses(t, x, p, after):
    after[0], after[1] = x[0], -0.9 * x[1]


def test_a_transition_that_does_not_keep_it():
    (bounce,) = BALL.transitions
    system = replace(BALL, transitions=(replace(bounce, reset=loses),))
    (found,) = findings(system, "error")
    assert "Transition 'bounce' does not keep it" in found.sentence
    assert found.line == loses.__code__.co_firstlineno
    with pytest.raises(SystemDefinitionError, match="'bounce' does not keep it"):
        refuse_unsound(system)


def test_only_states_at_the_event_count():
    """What a reset does to a ball that rises through the floor is nobody's business."""

    def turned(t, x, p, after):
        after[0], after[1] = x[0], -x[1] if x[1] < 0.0 else 2.0 * x[1]

    (bounce,) = BALL.transitions
    refuse_unsound(replace(BALL, transitions=(replace(bounce, reset=turned),)))


def test_a_function_of_time_is_none():
    def clock(t, x, p):
        return t + 0.0 * x[0]

    (found,) = findings(replace(PENDULUM, conserved=(Conserved("energy", clock),)), "error")
    assert "depends on t" in found.sentence


def test_a_function_for_each_mode():
    def energy(t, x, p):
        return 0.5 * x[1] ** 2 + p.g * x[0]

    system = replace(BALL, conserved=(Conserved("energy", {"flight": energy}),))
    refuse_unsound(system)
    with pytest.raises(SystemDefinitionError, match="no function for mode 'flight'"):
        replace(BALL, conserved=(Conserved("energy", {}),))
    with pytest.raises(SystemDefinitionError, match="function for mode 'fligth'"):
        replace(BALL, conserved=(Conserved("energy", {"flight": energy, "fligth": energy}),))


def test_its_value_is_a_parameter():
    """Without a value of its own the start's is meant: NaN, which no other parameter may have."""
    (energy,) = [p for p in BALL.parameters if p.name == "energy"]
    assert energy.conserved
    assert math.isnan(energy.default)
    assert energy.unit == "J/kg"
    declared = replace(BALL, parameters=(Parameter("g", 9.81), Parameter("energy", 3.0, "J/kg")))
    assert declared.defaults() == {"g": 9.81, "energy": 3.0}
    assert replace(BALL, name="other").parameter_names == BALL.parameter_names
    with pytest.raises(SystemDefinitionError, match="outside its bounds"):
        Parameter("g", math.nan)


def test_names_stand_for_one_thing():
    with pytest.raises(SystemDefinitionError, match="'v' is a state and a conserved quantity"):
        replace(BALL, parameters=BALL.parameters[:1], conserved=(Conserved("v", without_potential),))
    with pytest.raises(SystemDefinitionError, match="a conserved quantity and an observable"):
        replace(BALL, observables=(Observable("energy", lambda t, x, p: 0.0),))


def test_forced_machines_have_none():
    with pytest.raises(SystemDefinitionError, match="belongs to a system with a period"):
        replace(PENDULUM, period=lambda p: 1.0)


@pytest.mark.parametrize("wrong", [Conserved("energy", without_potential, "J", "its energy"), ()])
def test_the_form_of_the_declaration(wrong):
    """One alone need not be a tuple, as of all declarations; others are refused by name."""
    assert replace(PENDULUM, parameters=PENDULUM.parameters[:2], conserved=wrong)
    with pytest.raises(SystemDefinitionError, match="must be a Conserved"):
        replace(PENDULUM, conserved=(Neutral("energy", loses),))
    with pytest.raises(SystemDefinitionError, match="must be a function"):
        Conserved("energy", 3.0)  # type: ignore[arg-type]


def test_a_relabelling_that_keeps_it():
    """A reset that swaps the states, and then the names: the energy is the same in the other's words."""
    from contwalk.system import Mode, State, Symmetry, System

    def field(t, x, p, dx):
        dx[0], dx[1], dx[2], dx[3] = x[2], x[3], -x[0], -4.0 * x[1]

    def swap(t, x, p, image):
        image[0], image[1], image[2], image[3] = x[1], x[0], x[3], x[2]

    def energy(t, x, p):
        return x[2] ** 2 + x[3] ** 2 + x[0] ** 2 + 4.0 * x[1] ** 2

    def system(reset):
        return System(
            "legs",
            states=tuple(State(name) for name in "abcd"),
            parameters=(),
            modes=(Mode("only", field),),
            transitions=(
                Transition("step", "only", "only", lambda t, x, p: x[0] - 0.1, reset=reset, relabel="swap"),
            ),
            symmetries=(Symmetry("swap", "relabel", swap),),
            conserved=(Conserved("energy", energy),),
        )

    (found,) = findings(system(None), "error")
    assert "'step' does not keep it" in found.sentence
    assert not findings(system(swap), "error")


def test_what_init_writes_can_be_read(tmp_path):
    """The value need not be given: its line is a comment, and no example sweeps over nothing."""
    from contwalk.workflow.run_file.template import starting_file

    text = starting_file(PENDULUM, "./pendulum.py")
    assert "nan" not in text
    assert "  # energy:" in text
