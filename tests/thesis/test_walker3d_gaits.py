"""Both gaits of the 3D walker at the inclination of the papers: state, period, multipliers.

The derivative of half a stride is compared with differences of simulated motions and with the implicit
method.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from autobalancer_figures import RUNS, figure_run
from scipy.optimize import linear_sum_assignment

from benchmarks.event_map import Mapped, StepMap
from contwalk.branch import Branch, SpecialPoint
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import HybridMachine, MotionSegment, hybrid_machine, motion_segments
from contwalk.workflow.run_file.reading import RunFile, read_run_file

pytestmark = [pytest.mark.thesis, pytest.mark.slow]

REFERENCE = json.loads((Path(__file__).parent / "walker3d_reference.json").read_text(encoding="utf-8"))
GAITS = REFERENCE["gaits"]
# What takes longest is asked of one gait, and of the other by `make long`: each is compiled for itself.
ONE_AND_THE_OTHER = ["overlap", pytest.param("no_overlap", marks=pytest.mark.long)]
PINS = {"overlap": ["across", "along"], "no_overlap": ["across", "along", "pitch"]}
METHODS = ("dop853", "radau9")
# Events of half a stride, those of the ground's dampers included.
EVENTS = {"overlap": 14, "no_overlap": 20}
# Runs ask for 1e-10, and the reference is known to 1e-12. States are in units of their largest values.
NEAR = 1e-9
# A derivative by a state is up to a hundred, and so much less is known of it. Small multipliers are known
# better.
NEAR_MULTIPLIER, SMALL = 1e-8, 1e-2
# Not compared below: 1e-12 and less is noise, of directions in which toes lose what they knew.
FORGOTTEN = 1e-6
# Of simulated motions; the derivative of the explicit pair's steps in stiff directions is known to 2e-8 then.
TOLERANCE = 1e-13
# Of differences, in units of the largest values. What is left of the fourth order is 1e-8, and rounding, over
# this and times a hundred, a few 1e-8.
STEP = 3e-5
# A part of a derivative shorter than this is as good as zero: that of a knee's angle when it unlocks is.
SHORT = 1e-3


@cache
def run_file(name: str) -> RunFile:
    return read_run_file(RUNS / f"walker3d_{name}_inclination.yaml")


def gait(name: str, *overrides: str) -> tuple[Branch, SpecialPoint]:
    """The gait to which the printed state leads, as a marked point."""
    (branch,) = figure_run(
        f"walker3d_{name}_inclination",
        "continue.range=[0.0799, 0.0801]",
        "continue.max_points=2",
        "mark={alpha: [0.08]}",
        "diagram.follow=none",
        "accuracy=1e-10",
        *overrides,
    )
    (point,) = [point for point in branch.special_points if point.label == "UZ"]
    assert point.parameters["alpha"] == pytest.approx(0.08, rel=1e-15)
    return branch, point


@cache
def machine(name: str) -> HybridMachine:
    return hybrid_machine(run_file(name).system, run_file(name).parameters)


def printed(name: str) -> tuple[np.ndarray, str]:
    """State and mode that the run sets out from, at the section."""
    start = run_file(name).starts[0]
    assert start.state is not None
    assert start.mode is not None
    return start.state, start.mode


def known_state(name: str) -> np.ndarray:
    """The reference's state at the section, of full length."""
    return np.array([GAITS[name]["state"].get(state, 0.0) for state in machine(name).system.state_names])


def state_of(name: str, point: SpecialPoint) -> np.ndarray:
    return np.array([point.state[state] for state in machine(name).system.state_names])


@cache
def stride(name: str) -> tuple[MotionSegment, ...]:
    """The reference's gait, for a stride."""
    begins, lasts = known_state(name), GAITS[name]["period"]
    return tuple(
        motion_segments(
            machine(name), 0.0, begins, printed(name)[1], lasts, Control(TOLERANCE, np.ones(len(begins)))
        )
    )


def sizes(name: str) -> np.ndarray:
    """The largest value of each state in a stride."""
    return np.max([np.abs(arc.states).max(axis=0) for arc in stride(name)], axis=0)


def stepped(name: str, **options: Any) -> StepMap:
    """A map through modes of the gait: over half a stride from the section, where nothing else is said."""
    through = list(dict.fromkeys(arc.mode for arc in stride(name)))
    options = {"mode": printed(name)[1], "events": EVENTS[name]} | options
    return StepMap(machine(name), weights=sizes(name), modes=through, **options)


def known_multipliers(name: str) -> np.ndarray:
    """Of half a stride and the mirror."""
    return np.array([complex(*pair) for pair in GAITS[name]["half_multipliers"]])


def assert_same_multipliers(found: Iterable[complex], expected: Iterable[complex]) -> None:
    """As many that are not forgotten, and each is near to one of the others."""
    ours, theirs = (np.array([v for v in side if abs(v) > FORGOTTEN]) for side in (found, expected))
    assert len(ours) == len(theirs)
    distances = np.abs(np.subtract.outer(ours, theirs)) / np.maximum(np.abs(theirs), SMALL)
    assert distances[linear_sum_assignment(distances)].max() < NEAR_MULTIPLIER


# -- the gaits -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "method"),
    [
        ("overlap", "dop853"),
        pytest.param("overlap", "radau9", marks=pytest.mark.long),
        ("no_overlap", "dop853"),
        pytest.param("no_overlap", "radau9", marks=pytest.mark.long),
    ],
)
class TestGait:
    """What each method finds from the printed state."""

    def test_it_closes_in_the_mirror(self, name, method):
        branch, point = gait(name, f"engine.method={method}")
        assert branch.info.closure == "mirror"
        assert branch.info.settings["pins"] == PINS[name]
        assert point.period_full == 2.0 * point.period

    def test_state_at_the_section(self, name, method):
        found = state_of(name, gait(name, f"engine.method={method}")[1])
        exists = list(machine(name).system.states_of(printed(name)[1]))
        assert ((np.abs(found - known_state(name)) / sizes(name))[exists]).max() < NEAR
        assert not np.delete(found, exists).any()

    def test_period(self, name, method):
        _, point = gait(name, f"engine.method={method}")
        assert point.period_full == pytest.approx(GAITS[name]["period"], rel=NEAR)

    def test_multipliers_of_half_a_stride(self, name, method):
        _, point = gait(name, f"engine.method={method}")
        assert_same_multipliers(point.spectrum, known_multipliers(name))


@pytest.mark.long
@pytest.mark.parametrize("name", GAITS)
def test_both_methods_find_the_same_multipliers(name):
    explicit, implicit = (gait(name, f"engine.method={method}")[1].spectrum for method in METHODS)
    assert explicit != implicit  # they are two methods
    assert_same_multipliers(implicit, explicit)


def test_what_the_papers_print():
    """Paper 7: period and largest modulus of a stride's multipliers; Paper 8, 2.8: the latter."""
    overlap, no_overlap = (gait(name, "engine.method=dop853")[1] for name in GAITS)
    assert overlap.period_full == pytest.approx(1.6230, abs=0.5e-4)
    assert abs(overlap.spectrum[0]) ** 2 == pytest.approx(0.9685, abs=0.5e-4)
    assert abs(no_overlap.spectrum[0]) ** 2 == pytest.approx(0.942, abs=0.5e-3)


def test_stride_from_the_printed_state():
    """Paper 7, Tables IV and VI: twelve events in their order.

    The tests of the system have the same by an integrator that is not contwalk's.
    """
    begins, mode = printed("overlap")
    motion = motion_segments(
        machine("overlap"), 0.0, begins, mode, 1.43, Control(TOLERANCE, sizes("overlap"))
    )
    hard = [arc for arc in motion if arc.transition and not arc.transition.endswith("loads")]
    first = ["knee1_locks", "toe11_on", "toe12_on", "toe21_off", "toe22_off", "knee2_unlocks"]
    (mirror,) = machine("overlap").system.symmetries
    assert [arc.transition for arc in hard] == [*first, *(mirror.events[event] for event in first)]
    # Six decimals are printed, of the event itself and of the state that the motion begins with.
    assert [arc.times[-1] for arc in hard] == pytest.approx(REFERENCE["table_IV"], abs=1e-5)


# -- a whole stride, without the mirror ----------------------------------------------------------------------


@pytest.mark.parametrize("name", GAITS)
def test_multipliers_of_a_stride_are_squares(name):
    """The derivative over all events of a stride, one after another, from right after one of them on."""
    _, point = gait(name, "engine.method=dop853")
    begins, units = state_of(name, point), sizes(name)
    control = Control(TOLERANCE, units)
    (arc,) = islice(motion_segments(machine(name), 0.0, begins, printed(name)[1], 1.0, control), 1)
    first, mode = arc.transition, machine(name).transition(arc.transition, arc.mode).target
    whole = stepped(name, mode=mode, events=2 * EVENTS[name], just_after=first)
    after = whole.mapped(float(arc.times[-1]), arc.after, TOLERANCE)
    assert (after.mode, after.itinerary[-1]) == (mode, first)
    assert after.time - arc.times[-1] == pytest.approx(point.period_full, rel=NEAR)
    exists = list(machine(name).system.states_of(mode))
    matrix = (after.monodromy * units / units[:, None])[np.ix_(exists, exists)]
    ones = [1.0] * (1 + len(PINS[name]))  # along the flow, and along what is pinned
    assert_same_multipliers(np.linalg.eigvals(matrix), [*(v**2 for v in point.spectrum), *ones])


@pytest.mark.long
@pytest.mark.parametrize("name", GAITS)
def test_legs_of_their_own_close_after_a_stride(name):
    """A machine that does not know of its mirror image."""
    branch, point = gait(name, "model={legs: free}")
    assert branch.info.closure == "full"
    assert point.period == pytest.approx(GAITS[name]["period"], rel=NEAR)
    assert_same_multipliers(point.spectrum, known_multipliers(name) ** 2)


# -- the derivative of half a stride -------------------------------------------------------------------------


def in_units(name: str, matrix: np.ndarray, last: str) -> np.ndarray:
    """A derivative of the state in a mode and, in its last row, of the time, by the state at the section."""
    system, units = machine(name).system, np.append(sizes(name), GAITS[name]["period"])
    rows, columns = [*system.states_of(last), len(units) - 1], list(system.states_of(printed(name)[1]))
    return (matrix * units[:-1] / units[:, None])[np.ix_(rows, columns)]


def derivative(name: str, mapped: Mapped) -> np.ndarray:
    """Of state and time of the last event, whenever it happens."""
    by_state = mapped.monodromy + np.outer(mapped.velocity, mapped.shift)
    return in_units(name, np.vstack([by_state, mapped.shift]), mapped.mode)


def apart(found: np.ndarray, expected: np.ndarray) -> float:
    """The largest difference of rows and of columns, each relative to its own length."""
    sides = [
        np.linalg.norm(found - expected, axis=axis) / np.maximum(np.linalg.norm(expected, axis=axis), SHORT)
        for axis in (0, 1)
    ]
    return float(np.max(np.concatenate(sides)))


def simulated(name: str, x: np.ndarray, word: tuple[str, ...]) -> np.ndarray:
    """State and time after half a stride that has these events."""
    motion = motion_segments(machine(name), 0.0, x, printed(name)[1], 1.0, Control(TOLERANCE, sizes(name)))
    passed = list(islice(motion, EVENTS[name]))
    assert tuple(arc.transition for arc in passed) == word
    return np.append(passed[-1].after, passed[-1].times[-1])


def differences(name: str, word: tuple[str, ...]) -> np.ndarray:
    """Central ones with two steps, extrapolated to none."""
    found = np.zeros((len(sizes(name)) + 1, len(sizes(name))))
    for state in machine(name).system.states_of(printed(name)[1]):
        quotients = []
        for step in STEP * sizes(name)[state] * np.array([1.0, 0.5]):
            ahead, behind = known_state(name), known_state(name)
            ahead[state] += step
            behind[state] -= step
            quotients.append((simulated(name, ahead, word) - simulated(name, behind, word)) / (2.0 * step))
        found[:, state] = (4.0 * quotients[1] - quotients[0]) / 3.0
    return found


@pytest.mark.parametrize("name", ONE_AND_THE_OTHER)
def test_derivative_is_that_of_simulated_motions(name):
    mapped = stepped(name).mapped(0.0, known_state(name), TOLERANCE)
    expected = in_units(name, differences(name, mapped.itinerary), mapped.mode)
    assert apart(derivative(name, mapped), expected) < 1e-6


@pytest.mark.parametrize("name", ONE_AND_THE_OTHER)
def test_derivative_is_that_of_the_implicit_method(name):
    explicit, implicit = (
        stepped(name, method=method).mapped(0.0, known_state(name), TOLERANCE) for method in METHODS
    )
    assert implicit.itinerary == explicit.itinerary
    assert implicit.steps < explicit.steps / 5  # the ground is stiff
    assert apart(derivative(name, implicit), derivative(name, explicit)) < 1e-7
