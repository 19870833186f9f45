"""Events at given times: kicks, sampling instants, switches of a clock; against closed forms.

A guard of time alone goes on past zero whatever its reset does: it has happened then, and happens again when
it comes back from the other side.
"""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, diagram, machine, opened
from scipy.linalg import expm
from scipy.optimize import brentq

from contwalk.branch import Outcome
from contwalk.diagram.opening import Opening
from contwalk.errors import SystemDefinitionError
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.plugin_check.at_load import refuse_unsound
from contwalk.system import Symmetry, System, Transition

# A walk's solutions are known to a hundred times the accuracy.
WALKED = 100.0 * ACCURACY

# The same instants, modulo their phase, written in several ways.
CLOCKS = {
    "sine, rising": (lambda t, x, p: math.sin(2.0 * math.pi * t / p.T), "rising"),
    "sine, falling": (lambda t, x, p: -math.sin(2.0 * math.pi * t / p.T), "falling"),
    "cosine": (lambda t, x, p: math.cos(2.0 * math.pi * t / p.T), "falling"),
    "both ways": (lambda t, x, p: math.sin(math.pi * t / p.T), "both"),
    "modulo": (lambda t, x, p: t % p.T - 0.5 * p.T, "rising"),
}
clocks = pytest.mark.parametrize("clock", CLOCKS.values(), ids=CLOCKS)

# -- pest control: enemies of a pest are released at given times ---------------------------------------------

DIES, EVERY = 0.5, 2.0


def growing(t, x, p, dx):
    dx[0] = x[0] * (1.0 - x[0]) - x[0] * x[1]
    dx[1] = 0.5 * x[0] * x[1] - DIES * x[1]


def released(t, x, p, after):
    after[0], after[1] = x[0], x[1] + p.m


def pests(clock) -> System:
    guard, direction = clock
    return machine(
        ["pest", "enemy"],
        {"m": 1.5, "T": EVERY},
        {"field": growing},
        [Transition("release", "field", "field", guard, direction, reset=released)],
        period=lambda p: p.T,
    )


@clocks
def test_a_clock_is_a_sound_plugin_however_it_is_written(clock):
    """sin(pi t / T) has the other sign a period later, and is passed in both directions."""
    refuse_unsound(pests(clock))
    guard, _ = clock
    if guard(0.3 * EVERY, None, SimpleNamespace(T=EVERY)) != pytest.approx(
        guard(1.3 * EVERY, None, SimpleNamespace(T=EVERY))
    ):
        with pytest.raises(SystemDefinitionError, match="does not repeat after period"):
            refuse_unsound(pests((guard, "rising")))


@pytest.mark.drawn(1)
@pytest.mark.parametrize("name", ["sine, rising", "both ways", "modulo"])
def test_releases_keep_the_pest_away_from_the_known_number_on(name):
    """Without pests the enemies' mean is m / (d T): the pest dies out where that exceeds its growth of 1."""
    (branch,) = diagram(pests(CLOCKS[name]), "m", (0.6, 1.8), [0.3, 0.3], {"m": 1.5}, until="settled")
    assert branch.info.signature == ("release",)
    assert [p.label for p in branch.special_points] == ["EP", "BP", "EP"]
    assert_met(branch.special_points[1], "m", DIES * EVERY)
    assert branch.special_points[1].kind == "transcritical"
    expected = np.sort([np.exp(EVERY - branch["m"] / DIES), np.full(len(branch), math.exp(-DIES * EVERY))], 0)
    found = np.sort(branch.points["spectrum"].real, axis=1).T
    np.testing.assert_allclose(found, expected, rtol=0, atol=WALKED)
    assert np.all(branch["admissible"])


@clocks
def test_each_instant_has_one_event(clock):
    """Also far from t = 0, where an instant is known to many roundings of the phase."""
    given = hybrid_machine(pests(clock), {"m": 0.1, "T": 0.1})
    begin, control = 1000.0 + 1.0 / 3.0, Control(1e-9, np.ones(2))
    times = [
        float(arc.times[-1])
        for arc in motion_segments(given, begin, np.array([0.3, 0.3]), "field", begin + 5.0, control)
        if arc.transition
    ]
    assert len(times) == 50
    np.testing.assert_allclose(np.diff(times), 0.1, rtol=0, atol=1e-9)  # a thousand times rounding of t / T


# -- a pendulum that is held upright by a sampled control ----------------------------------------------------

SAMPLING, DAMPING, BIAS = 0.5, 0.2, 0.1


def upright(t, x, p, dx):
    dx[0], dx[1] = x[1], math.sin(x[0]) - DAMPING * x[1] + x[2] + BIAS
    dx[2] = 0.0


def sampled(t, x, p, after):
    after[0], after[1], after[2] = x[0], x[1], -p.K * x[0] - x[1]


def sampled_multipliers(gain: float) -> np.ndarray:
    """Of the state at rest, where the control holds the bias: exponentials between samples."""
    angle = brentq(lambda a: math.sin(a) - gain * a + BIAS, -1.0, 1.0, xtol=1e-15)
    between = np.array([[0.0, 1.0, 0.0], [math.cos(angle), -DAMPING, 1.0], [0.0, 0.0, 0.0]])
    hold = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-gain, -1.0, 0.0]])
    return np.linalg.eigvals(hold @ expm(SAMPLING * between))


@pytest.mark.drawn(1)
@pytest.mark.parametrize("name", ["sine, rising", "cosine"])
def test_a_state_at_rest_under_sampled_control(name):
    guard, direction = CLOCKS[name]
    system = machine(
        ["angle", "rate", "torque"],
        {"K": 2.5, "T": SAMPLING},
        {"on": upright},
        [Transition("sample", "on", "on", guard, direction, reset=sampled)],
        period=lambda p: p.T,
    )
    (branch,) = diagram(system, "K", (1.5, 8.0), [0.3, 0.0, 0.0], until="settled")
    assert [p.label for p in branch.special_points] == ["EP", "NS", "EP"]
    torus = brentq(lambda k: np.max(np.abs(sampled_multipliers(k))) - 1.0, 3.0, 8.0, xtol=1e-15)
    assert_met(branch.special_points[1], "K", torus)
    for k in range(0, len(branch), 5):
        expected = np.poly(sampled_multipliers(branch["K"][k]))
        np.testing.assert_allclose(np.poly(branch.points["spectrum"][k]), expected, rtol=0, atol=WALKED)


@pytest.mark.long
@pytest.mark.parametrize("mirrored", [True, False])
def test_a_period_doubling_of_a_state_at_rest_is_followed(mirrored):
    """The control is held over each sample: what leaves at D = coth(T / 2) swings from one to the next.

    All states of the parent are zero but for rounding, which is no scale for the steps of what leaves it; and
    a torque that is constant until its image follows has one.
    """

    def free(t, x, p, dx):
        dx[0], dx[1] = x[1], math.sin(x[0]) + x[2]
        dx[2] = 0.0

    def held(t, x, p, after):
        after[0], after[1], after[2] = x[0], x[1], -2.5 * x[0] - p.D * x[1]

    guard, direction = CLOCKS["sine, rising"]
    system = machine(
        ["angle", "rate", "torque"],
        {"D": 1.0, "T": SAMPLING},
        {"on": free},
        [Transition("sample", "on", "on", guard, direction, reset=held)],
        period=lambda p: p.T,
        symmetries=(Symmetry("inversion", "spatial", turned_over),) if mirrored else (),
    )
    rest, swinging = diagram(
        system,
        "D",
        (4.05, 4.15),
        [0.01, 0.0, 0.0],
        {"D": 4.06},
        until="settled",
        follow=("PD",),
        max_points=60,
    )
    assert_met(next(p for p in rest.special_points if p.label == "PD"), "D", 1.0 / math.tanh(0.5 * SAMPLING))
    assert swinging.info.closure == ("inversion" if mirrored else "full")
    # Steps are parts of the orbit's own size, also of the torque: amplitudes grow by factors, not by sums.
    sizes = swinging["amp:rate"]
    assert sizes[-1] > 1.5 * sizes[-11]


def turned_over(t, x, p, image):
    image[:] = -x


# -- a clock that switches on and off ------------------------------------------------------------------------


def test_modes_are_entered_with_the_other_clock_past_zero():
    """x' = 1 - x for the first part of each period, then x' = -x; neither switch is level-triggered."""
    on, whole = 0.3, 2.0
    system = machine(
        ["x"],
        {"share": on},
        {
            "on": lambda t, x, p, dx: dx.__setitem__(0, 1.0 - x[0]),
            "off": lambda t, x, p, dx: dx.__setitem__(0, -x[0]),
        },
        [
            Transition(
                "opens",
                "on",
                "off",
                lambda t, x, p: math.sin(math.pi * t - 2.0 * math.pi * p.share),
                "rising",
            ),
            Transition("closes", "off", "on", lambda t, x, p: math.sin(math.pi * t), "rising"),
        ],
        period=lambda p: whole,
    )
    opening = opened(system, "share", [0.2], until="settled")
    assert isinstance(opening, Opening), opening.message
    sample = opening.state.sample
    assert opening.problem.itinerary.signature(opening.problem.system) in (
        ("opens", "closes"),
        ("closes", "opens"),
    )
    # The state when it closes: x = (x + (e^(share T) - 1)) e^-T.
    expected = math.expm1(on * whole) / math.expm1(whole)
    low = sample.observables[list(opening.problem.observable_names).index("min:x")]
    assert low == pytest.approx(expected, abs=WALKED)
    assert sample.eigenvalues[0] == pytest.approx(math.exp(-whole), abs=WALKED)
    assert np.all(sample.margins >= 0.0)


# -- a converter: a ramp of the time, and a clock ------------------------------------------------------------

C, L, R, CYCLE, LOW, HIGH, GAIN, REFERENCE = 47e-6, 20e-3, 22.0, 400e-6, 3.8, 8.2, 8.4, 11.3


def converter(jumping: bool = False) -> System:
    """The voltage-mode buck converter (di Bernardo, Garofalo, Glielmo, Vasca 1998)."""

    def closed(t, x, p, dx):
        dx[0], dx[1] = (x[1] - x[0] / R) / C, (p.E - x[0]) / L

    def open_(t, x, p, dx):
        dx[0], dx[1] = (x[1] - x[0] / R) / C, -x[0] / L

    def error(t, x, p):
        return GAIN * (x[0] - REFERENCE) - LOW - (HIGH - LOW) * (t / CYCLE % 1.0)

    def tick(t, x, p):
        return math.sin(2.0 * math.pi * t / CYCLE)

    return machine(
        ["v", "i"],
        {"E": 24.0},
        {"open": open_, "closed": closed},
        [
            Transition("close", "open", "closed", error),
            Transition("cut", "closed", "open", error if jumping else tick, "rising"),
        ],
        period=lambda p: CYCLE,
    )


@pytest.mark.long
def test_period_doubling_of_the_buck_converter():
    """A product of matrix exponentials, saltation at the comparator, in 30 digits: E = 24.51657282856338."""
    (branch,) = diagram(converter(), "E", (22.0, 26.0), [12.0, 0.55], until="settled")
    assert sorted(branch.info.signature) == ["close", "cut"]
    (point,) = (p for p in branch.special_points if p.label != "EP")
    assert point.label == "PD"
    assert point.parameters["E"] == pytest.approx(24.51657282856338, abs=max(point.error, 1e-12))
    assert point.error < 10.0 * ACCURACY * 24.5


def test_a_guard_that_jumps_through_zero_is_refused():
    told = opened(converter(jumping=True), "E", [12.0, 0.55], {"E": 20.0}, until=0.0)
    assert isinstance(told, Outcome)
    assert "jumps through zero" in told.message
    assert "of time alone" in told.message


def test_what_follows_a_clock_at_once_does_not_bring_it_back():
    """A comparator is past zero still when the clock cuts: it closes again, once."""
    system = machine(
        ["x"],
        {"T": 1.0},
        {"open": lambda t, x, p, dx: still(dx), "closed": lambda t, x, p, dx: still(dx)},
        [
            Transition("cut", "closed", "open", lambda t, x, p: math.sin(2.0 * math.pi * t / p.T), "rising"),
            Transition("close", "open", "closed", lambda t, x, p: x[0], role="soft"),
        ],
        period=lambda p: p.T,
    )
    given, events = hybrid_machine(system, system.defaults()), []
    for arc in motion_segments(given, 0.3, np.array([0.5]), "open", 5.5, Control(1e-9, np.ones(1))):
        assert arc.status == "ok", arc.reason
        events += [arc.transition] if arc.transition else []
    assert events == ["close", *["cut", "close"] * 5]


def still(dx):
    dx[0] = -1.0


def test_a_clock_that_never_passes_zero_leaves_a_family_of_orbits_which_is_said():
    """T - t % T jumps up just before it would be zero: nothing ever sets the torque."""
    system = machine(
        ["angle", "rate", "torque"],
        {"K": 9.0, "T": SAMPLING},
        {"on": upright},
        [Transition("sample", "on", "on", lambda t, x, p: p.T - t % p.T, reset=sampled)],
        period=lambda p: p.T,
    )
    told = opened(system, "K", [0.3, 0.3, 0.0], until=200.0)
    assert isinstance(told, Outcome)
    assert told.reason == "no_convergence"
    assert "Orbits come in a family there, at the same parameters" in told.message
