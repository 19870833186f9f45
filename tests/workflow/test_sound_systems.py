"""What is refused when a system is loaded or first used from Python, and what is not."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import contwalk as cw
from contwalk.errors import SystemDefinitionError
from contwalk.plugin_check.at_load import refuse_unsound
from contwalk.plugin_check.system import check_system
from contwalk.system import Mode, Observable, Parameter, Signal, State, Symmetry, System, Transition


def oscillator(field, states=("x", "y"), **more):
    return System(
        name="oscillator",
        states=tuple(State(name) for name in states),
        parameters=(
            Parameter("a", 1.0),
            Parameter("f", 0.0),
            Parameter("w", 2.0),
            Parameter("n", 3.0),
        ),
        modes=(Mode("only", field),),
        **more,
    )


def driven(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.a * x[0] - 0.1 * x[1] + p.f * math.cos(p.w * t) * math.sin(p.n * p.w * t)


def free(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.a * x[0] - 0.1 * x[1]


def forcing(p):
    return 2.0 * math.pi / p.w


def line(function):
    return f"{__file__}, line {function.__code__.co_firstlineno}"


class TestTime:
    """Without a period there is no equilibrium and no orbit of a field that depends on time."""

    system = oscillator(driven)

    @pytest.mark.parametrize("kind", [cw.Equilibrium, cw.PeriodicOrbit])
    def test_problems_are_refused(self, kind):
        problem = kind(self.system, self.system.defaults(), free="a")
        given = {} if kind is cw.Equilibrium else {"period": 3.0}
        with pytest.raises(SystemDefinitionError, match="depends on the time t") as caught:
            cw.continue_branch(problem, np.array([0.1, 0.0]), range=(0.5, 2.0), **given)
        assert line(driven) in caught.value.sentence

    def test_time_that_cancels_is_none(self):
        def field(t, x, p, dx):
            dx[0] = p.f - x[0] + 0.0 * t
            dx[1] = -x[1]

        system = oscillator(field)
        problem = cw.Equilibrium(system, system.defaults(), free="f")
        branch = cw.continue_branch(problem, np.zeros(2), range=(-1.0, 1.0))
        assert np.allclose(branch["x"], branch["f"], rtol=0.0, atol=1e-14)

    def test_loading_does_not_refuse_what_can_be_simulated(self):
        refuse_unsound(self.system)


class TestPeriods:
    def test_a_period_holds_for_all_harmonics(self):
        refuse_unsound(oscillator(driven, period=forcing))

    @pytest.mark.parametrize("wrong", [lambda p: 2.0, lambda p: 1.5 * math.pi / p.w, lambda p: 6.2831 / p.w])
    def test_a_wrong_period_shows_though_the_force_is_off_by_default(self, wrong):
        with pytest.raises(SystemDefinitionError, match=r"does not repeat .* with f = 1") as caught:
            refuse_unsound(oscillator(driven, period=wrong))
        assert line(driven) in caught.value.sentence

    def test_switching_a_zero_on_respects_bounds(self):
        system = oscillator(driven, period=lambda p: 2.0)
        off = replace(
            system,
            parameters=(
                *system.parameters[:1],
                Parameter("f", 0.0, bounds=(0.0, 0.0)),
                *system.parameters[2:],
            ),
        )
        refuse_unsound(off)


class TestSymmetries:
    @staticmethod
    def minus(t, x, p, x_image):
        x_image[0] = -x[0]
        x_image[1] = -x[1]

    @staticmethod
    def half(t, x, p, x_image):
        x_image[0] = -x[0]
        x_image[1] = x[1]

    def test_right_ones_pass(self):
        refuse_unsound(oscillator(free, symmetries=(Symmetry("minus", "spatial", self.minus),)))

    def test_wrong_ones_are_refused(self):
        with pytest.raises(SystemDefinitionError, match="does not hold in mode 'only'") as caught:
            refuse_unsound(oscillator(free, symmetries=(Symmetry("half", "spatial", self.half),)))
        assert line(self.half) in caught.value.sentence


class TestParameters:
    system = oscillator(free)

    @pytest.mark.parametrize("kind", [cw.Equilibrium, cw.PeriodicOrbit])
    @pytest.mark.parametrize(
        ("given", "said"),
        [
            ({"a": 1.0, "n": 2.0}, "lack f, w"),
            ({"a": 1.0, "f": 0.0, "w": 1.0, "n": 1.0, "omega": 2.0}, "'omega' is not a parameter"),
            ({"a": None, "f": 0.0, "w": 1.0, "n": 1.0}, "The parameter a of 'oscillator' is None"),
        ],
    )
    def test_what_is_missing_or_wrong_is_named(self, kind, given, said):
        with pytest.raises(SystemDefinitionError, match=said):
            kind(self.system, given, free="a")

    @pytest.mark.parametrize("kind", [cw.Equilibrium, cw.PeriodicOrbit])
    def test_the_free_one_must_exist(self, kind):
        with pytest.raises(SystemDefinitionError, match=r"'b' is not a parameter of 'oscillator'"):
            kind(self.system, self.system.defaults(), free="b")

    def test_both_ends_of_a_path_are_complete(self):
        ends = self.system.defaults(), {"a": 2.0}
        with pytest.raises(SystemDefinitionError, match="lack f, w, n"):
            cw.Equilibrium(self.system, self.system.defaults(), free="path", path=ends)


class TestNames:
    @pytest.mark.parametrize(
        "name", ["stable", "period", "special", "max_re", "max_abs", "split", "path", "re_1", "im_12"]
    )
    def test_names_of_results_are_refused(self, name):
        with pytest.raises(SystemDefinitionError, match=f"calls a state '{name}'"):
            oscillator(free, states=("x", name))

    @pytest.mark.parametrize("name", ["s", "step", "error", "real", "T", "x_1", "stable_2"])
    def test_others_are_not(self, name):
        assert oscillator(free, states=("x", name)).state_names == ("x", name)

    def test_an_observable_may_be_a_measure_of_a_state(self):
        measure = Observable("x", lambda t, x, p: x[:, 0].max())
        assert oscillator(free, observables=(measure,)).observable_names == ("x",)

    def test_an_observable_is_no_parameter(self):
        with pytest.raises(SystemDefinitionError, match="'a' is a parameter and an observable"):
            oscillator(free, observables=(Observable("a", lambda t, x, p: x[:, 0].max()),))


class TestSignals:
    @pytest.mark.parametrize(
        ("function", "said"),
        [
            (lambda t, x, p: x[:, 0].max(), "gives an array of shape ()"),
            (lambda t, x, p: x, "gives an array of shape (5, 2)"),
            (lambda t, x, p: p.b * x[:, 0], "the system has no parameter 'b'"),
            (lambda t, x, p: exit(), "raises SystemExit"),
        ],
    )
    def test_wrong_ones_are_told(self, function, said):
        found = check_system(oscillator(free, signals=(Signal("force", function),)))
        (error,) = [finding for finding in found if finding.level == "error"]
        assert said in error.sentence
        assert error.line == function.__code__.co_firstlineno

    def test_right_ones_pass(self):
        signal = Signal("force", lambda t, x, p: np.where(x[:, 0] > 0.0, p.a * x[:, 1], np.nan))
        assert not [f for f in check_system(oscillator(free, signals=(signal,))) if f.level == "error"]


class TestSoftTransitions:
    """A damper that acts one way: its force is zero where it begins, but for dry friction it is not."""

    @staticmethod
    def system(force, reset=None):
        def damped(t, x, p, dx):
            dx[0] = x[1]
            dx[1] = -p.a * x[0] - force(x[1])

        def speed(t, x, p):
            return x[1]

        return System(
            name="damper",
            states=(State("x"), State("v")),
            parameters=(Parameter("a", 1.0),),
            modes=(Mode("out", free_of(1.0)), Mode("back", damped)),
            transitions=(
                Transition("turns", "out", "back", guard=speed, reset=reset, role="soft"),
                Transition("returns", "back", "out", guard=speed, direction="rising", role="soft"),
            ),
        )

    def errors(self, system):
        return [finding.sentence for finding in check_system(system) if finding.level == "error"]

    def test_a_viscous_damper_is_soft(self):
        assert self.errors(self.system(lambda v: 3.0 * v)) == []

    def test_dry_friction_is_not(self):
        found = self.errors(self.system(lambda v: -0.2))
        assert any("the field jumps there" in sentence for sentence in found)

    def test_a_reset_that_jumps_is_not(self):
        def jump(t, x, p, x_plus):
            x_plus[0] = x[0] + 0.1
            x_plus[1] = x[1]

        system = self.system(lambda v: 3.0 * v, jump)
        assert any("but its reset changes x" in sentence for sentence in self.errors(system))
        with pytest.raises(SystemDefinitionError, match="but its reset changes x"):
            refuse_unsound(system)

    def test_a_reset_that_keeps_the_state_is_soft(self):
        def kept(t, x, p, x_plus):
            x_plus[:] = x

        system = self.system(lambda v: 3.0 * v, kept)
        assert self.errors(system) == []
        refuse_unsound(system)


class TestResetsThatKeepTheState:
    """An event that changes nothing is refused, unless it says so."""

    @staticmethod
    def system(kept):
        def reset(t, x, p, x_plus):
            x_plus[0], x_plus[1] = kept(t, x, p)

        event = Transition("zero", "only", "only", lambda t, x, p: x[0] - p.w, reset=reset)
        return oscillator(free, transitions=(event,))

    @pytest.mark.parametrize(
        "kept",
        [
            lambda t, x, p: (p.w, x[1]),
            lambda t, x, p: (2.0 * x[0] - p.w, x[1]),
            lambda t, x, p: (x[0], x[1] * (1.0 + 3e-16 * x[1])),
        ],
    )
    def test_what_comes_to_the_same_at_the_guard_is_refused(self, kept):
        with pytest.raises(SystemDefinitionError, match="It changes nothing: wherever its guard is zero"):
            refuse_unsound(self.system(kept))

    @pytest.mark.parametrize(
        "kept",
        [
            lambda t, x, p: (p.w, 0.9 * x[1]),  # pinned, and slowed down
            lambda t, x, p: (p.w, x[1] + p.f),  # a kick that is zero by default
            lambda t, x, p: (2.0, x[1]),  # the guard's place for one value of the parameter only
            lambda t, x, p: (p.w, x[1] if x[1] > -9.0 else -x[1]),  # for slow motions only
            lambda t, x, p: (x[0], x[1]),  # says so
        ],
    )
    def test_what_changes_something_or_says_so_is_not(self, kept):
        refuse_unsound(self.system(kept))

    def test_a_reset_that_says_so_is_no_stop_of_the_wrong_sign(self):
        found = [each.sentence for each in check_system(self.system(lambda t, x, p: (x[0], x[1])))]
        assert "keeps the state, and says so." in found
        assert not [sentence for sentence in found if "goes on through it" in sentence]


def free_of(stiffness):
    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -stiffness * p.a * x[0]

    return field


@pytest.mark.parametrize(
    "name", ["autobalancer", "planar_walker", "walker3d", "rimless_wheel", "bouncing_ball", "straight_walker"]
)
def test_first_party_systems_are_sound(name):
    assert cw.load_system(name).name == name


class TestNeverFinite:
    """A NaN among the constants of a function is there at all states and parameters."""

    @staticmethod
    def hit(guard):
        transition = Transition("hit", "only", "only", guard, reset=lambda t, x, p, y: free(t, x, p, y))
        return oscillator(free, transitions=(transition,))

    def test_a_guard_that_is_never_a_number_is_refused(self):
        with pytest.raises(SystemDefinitionError, match="guard of transition 'hit': It is not finite at any"):
            refuse_unsound(self.hit(lambda t, x, p: x[0] * math.nan))

    def test_a_field_that_is_never_a_number_is_refused(self):
        def field(t, x, p, dx):
            dx[0] = x[1]
            dx[1] = x[0] + math.nan

        with pytest.raises(SystemDefinitionError, match="field of mode 'only'"):
            refuse_unsound(oscillator(field))

    def test_one_that_is_a_number_elsewhere_is_not(self):
        refuse_unsound(self.hit(lambda t, x, p: (x[0] - 100.0) ** 0.5 - 1.0))


def point_mirror(t, x, p, image):
    image[0], image[1] = -x[0], -x[1]


def test_a_forced_system_without_a_period_is_told_so_before_its_symmetry():
    def forced(t, x, p, dx):
        dx[0], dx[1] = x[1], -x[0] + p.a * math.cos(p.w * t)

    # Half a period later the mirror holds; without a period it cannot.
    mirrored = oscillator(forced, symmetries=(Symmetry("mirror", "spatial", point_mirror),))
    with pytest.raises(SystemDefinitionError, match="depends on t, but the system declares no period"):
        refuse_unsound(mirrored)

    def growing(t, x, p, dx):
        dx[0], dx[1] = x[1], -p.a * x[0] * (1.0 + math.exp(-t))

    # One that holds at each instant is no reason to ask for a period: such a motion can be simulated.
    refuse_unsound(oscillator(growing, symmetries=(Symmetry("mirror", "spatial", point_mirror),)))
