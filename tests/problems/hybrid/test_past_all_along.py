"""A run says which transitions its first orbit never makes though their guards are past zero all along it."""

from __future__ import annotations

import pytest
from hybrid_runs import machine, opened

from contwalk.diagram.opening import Opening
from contwalk.system import State, Symmetry, Transition


def neurons(pulse: float, **declared: bool):
    """Two leaky neurons, each of which pushes the other one by a pulse when it fires."""

    def rest(t, x, p, dx):
        dx[0] = p.drive - x[0]
        dx[1] = 1.25 - x[1]

    def first(t, x, p, after):
        after[0], after[1] = 0.0 * x[0], x[1] + pulse

    def second(t, x, p, after):
        after[0], after[1] = x[0] + pulse, 0.0 * x[1]

    one = Transition("one", "rest", "rest", lambda t, x, p: x[0] - 1.0, "rising", reset=first)
    two = Transition("two", "rest", "rest", lambda t, x, p: x[1] - 1.0, "rising", reset=second, **declared)
    return machine(["a", "b"], {"drive": 1.3}, {"rest": rest}, [one, two])


@pytest.mark.parametrize(("pulse", "told"), [(0.4, True), (-0.2, False)])
def test_a_neuron_that_never_fires_beyond_its_threshold_is_told(pulse, told):
    opening = opened(neurons(pulse), "drive", [0.3, 0.1], until="settled")
    assert isinstance(opening, Opening)
    assert ("'two' never happens here though its guard is past zero all along" in opening.message) == told
    assert ("Declare level=True" in opening.message) == told


def test_what_stands_beyond_in_both_halves_is_told_once():
    """An orbit that closes up to a mirror: a wall is beyond reach, and a stop is past all along."""

    def swings(side):
        def field(t, x, p, dx):
            dx[0], dx[1] = x[1], -x[0] + side * p.push - 0.3 * x[1]

        return field

    def mirrored(t, x, p, image):
        image[0], image[1] = -x[0], -x[1]

    system = machine(
        [State("x"), State("v")],
        {"push": 1.0},
        {"up": swings(1.0), "down": swings(-1.0)},
        [
            Transition("turns", "up", "down", lambda t, x, p: x[0] - 0.5, "rising"),
            Transition("turns", "down", "up", lambda t, x, p: x[0] + 0.5, "falling"),
            Transition("stop", "up", "down", lambda t, x, p: x[0] + 5.0, "rising"),
            Transition("stop", "down", "up", lambda t, x, p: x[0] - 5.0, "falling"),
            Transition("wall", "up", "down", lambda t, x, p: x[0] - 5.0, "rising"),
            Transition("wall", "down", "up", lambda t, x, p: x[0] + 5.0, "falling"),
        ],
        symmetries=(Symmetry("mirror", "spatial", mirrored, modes={"up": "down", "down": "up"}),),
    )
    opening = opened(system, "push", [0.0, 1.0], mode="up", until="settled")
    assert isinstance(opening, Opening)
    assert opening.message.count("'stop' never happens here") == 1
    assert "'wall'" not in opening.message
