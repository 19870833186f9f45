"""Many motions at once, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from moving_systems import DECAY, EXPLOSION, OSCILLATOR

from contwalk.flow.compiled.traced import field_of
from contwalk.flow.ensemble import sampling_records as records
from contwalk.flow.ensemble.sampling import Measured, Motions, measure
from contwalk.flow.events.guard import Guard


def motions(system, watched, starts, parameters, *, direction="falling", limit=50.0, within=None, **options):
    starts = np.array(starts, dtype=float)
    count, n = starts.shape
    options.setdefault("targets", np.zeros((count, 1, n)))
    return Motions(
        field=field_of(system),
        guard=Guard(system, "watched", watched, direction),
        starts=starts,
        parameters=np.tile(np.asarray(parameters, dtype=float), (count, 1)),
        limits=np.full(count, limit),
        within=np.full(n, 1e-3) if within is None else np.array(within),
        periods=options.pop("periods", np.zeros(n)),
        **options,
    )


def test_decay_crosses_its_level_and_comes_to_rest():
    heights = np.array([0.5, 2.0, 3.0, 10.0])
    made = motions(
        DECAY, lambda t, x, p: x[0] - 0.1, [[h, 0.0] for h in heights], [1.0, 0.0], within=[1e-3, np.inf]
    )
    result = measure(made, 1e-10, np.ones(2))
    # Tens of steps of local error 1e-10; the slope at the crossing is 0.1.
    np.testing.assert_allclose(result.crossed_at, np.log(heights / 0.1), rtol=0, atol=1e-7)
    assert result.crossed.all()
    assert (result.ended == records.SETTLED).all()
    arrival = np.log(heights / 1e-3)
    assert (result.ended_at >= arrival - 1e-6).all()  # noticed at the end of the step that arrives
    assert (result.ended_at < arrival + 5.0).all()


def test_an_oscillation_crosses_often_and_the_last_or_first_counts():
    def high(t, x, p):
        return x[0] - p.level

    for first, exact in ((True, math.pi / 3), (False, 6 * math.pi + math.pi / 3)):
        made = motions(OSCILLATOR, high, [[1.0, 0.0]], [1.0, 0.0, 0.5], limit=23.0, first=first)
        result = measure(made, 1e-11, np.ones(2))
        assert result.crossed_at[0] == pytest.approx(exact, abs=1e-8)  # local errors, the slope is 0.87
        assert result.ended[0] == (records.FOUND if first else records.TIME_UP)
        assert first or result.ended_at[0] == 23.0
    rising = motions(OSCILLATOR, high, [[1.0, 0.0]], [1.0, 0.0, 0.5], limit=23.0, direction="rising")
    assert measure(rising, 1e-11, np.ones(2)).crossed_at[0] == pytest.approx(
        6 * math.pi - math.pi / 3, abs=1e-8
    )


@pytest.mark.parametrize("level", [1.0 - 1e-3, 1.0 - 1e-6])
def test_a_visit_beyond_the_level_within_a_step_is_seen(level):
    made = motions(OSCILLATOR, lambda t, x, p: x[0] - p.level, [[0.0, 1.0]], [1.0, 0.0, level], limit=10.0)
    result = measure(made, 1e-9, np.ones(2))  # x = sin t
    half = math.acos(level)
    # The slope at the crossing is `half`, the error of the path 1e-8 or so.
    assert result.crossed_at[0] == pytest.approx(2.5 * math.pi + half, abs=1e-7 / half)
    missed = motions(OSCILLATOR, lambda t, x, p: x[0] - p.level, [[0.0, 1.0]], [1.0, 0.0, 1.001], limit=10.0)
    assert not measure(missed, 1e-9, np.ones(2)).crossed[0]


def test_angles_rest_wherever_their_turns_have_brought_them():
    target = np.array([[[0.0, 1.0]]])
    made = motions(
        DECAY,
        lambda t, x, p: x[0] - 0.1,
        [[1.0, 1.0 + 6 * math.pi]],
        [1.0, 0.0],
        targets=target,
        periods=np.array([0.0, 2 * math.pi]),
    )
    assert measure(made, 1e-8, np.ones(2)).ended[0] == records.SETTLED
    straight = motions(
        DECAY, lambda t, x, p: x[0] - 0.1, [[1.0, 1.0 + 6 * math.pi]], [1.0, 0.0], targets=target, limit=20.0
    )
    result = measure(straight, 1e-8, np.ones(2))
    assert (result.ended[0], result.ended_at[0]) == (records.TIME_UP, 20.0)


def test_missing_targets_never_settle_and_one_of_several_is_enough():
    nowhere = np.full((1, 2, 2), np.nan)
    made = motions(DECAY, lambda t, x, p: x[0] - 0.1, [[1.0, 0.0]], [1.0, 0.0], targets=nowhere, limit=9.0)
    assert measure(made, 1e-8, np.ones(2)).ended[0] == records.TIME_UP
    somewhere = nowhere.copy()
    somewhere[0, 1] = 0.0
    made = motions(DECAY, lambda t, x, p: x[0] - 0.1, [[1.0, 0.0]], [1.0, 0.0], targets=somewhere)
    assert measure(made, 1e-8, np.ones(2)).ended[0] == records.SETTLED


def test_a_motion_that_leaves_the_numbers_is_told_and_others_are_not_hurt():
    made = motions(
        EXPLOSION, lambda t, x, p: x[0] - 10.0, [[1.0], [-1.0]], np.empty(0), limit=500.0, within=[0.01]
    )
    result = measure(made, 1e-8, np.ones(1))
    assert result.ended[0] in (records.NOT_FINITE, records.GIVEN_UP)
    assert result.ended[1] == records.SETTLED  # x = -1 / (1 + t)
    rising = motions(
        EXPLOSION, lambda t, x, p: x[0] - 10.0, [[1.0]], np.empty(0), direction="rising", first=True
    )
    assert measure(rising, 1e-10, np.ones(1)).crossed_at[0] == pytest.approx(0.9, abs=1e-8)


def test_a_start_that_is_not_a_number_is_told():
    made = motions(OSCILLATOR, lambda t, x, p: x[0], [[np.nan, 0.0]], [1.0, 0.0, 0.0])
    assert measure(made, 1e-8, np.ones(2)).ended[0] == records.NOT_FINITE


def test_results_do_not_depend_on_threads_or_neighbours():
    rng = np.random.default_rng(3)
    starts = np.column_stack([rng.uniform(0.2, 5.0, 90), rng.uniform(-1, 1, 90)])
    made = motions(OSCILLATOR, lambda t, x, p: x[0] - 0.1, starts, [1.0, 0.05, 0.0], limit=200.0)
    done: list[tuple[range, Measured]] = []
    results = [measure(made, 1e-8, np.ones(2), 1)]
    results.append(measure(made, 1e-8, np.ones(2), 3, lambda places, found: done.append((places, found))))
    for name in ("crossed_at", "crossed", "ended_at", "ended"):
        np.testing.assert_array_equal(getattr(results[0], name), getattr(results[1], name))
    assert sorted(place for places, _ in done for place in places) == list(range(90))
    for places, found in done:
        np.testing.assert_array_equal(found.ended_at, results[0].ended_at[list(places)])
    alone = motions(OSCILLATOR, lambda t, x, p: x[0] - 0.1, starts[40:41], [1.0, 0.05, 0.0], limit=200.0)
    assert measure(alone, 1e-8, np.ones(2)).crossed_at[0] == results[0].crossed_at[40]


def test_a_guard_that_is_steep_where_it_passes_zero_is_seen_although_it_is_flat_at_both_ends_of_a_step():
    made = motions(DECAY, lambda t, x, p: math.tanh(300.0 * (x[0] - 0.5)), [[2.0, 0.0]], [1.0, 0.0])
    result = measure(made, 1e-10, np.ones(2))
    assert result.crossed[0]
    # Tens of steps of local error 1e-10; x falls by 0.5 in a unit of time there.
    assert result.crossed_at[0] == pytest.approx(math.log(4.0), abs=1e-7)


def test_a_guard_without_a_value_at_the_start_is_told():
    made = motions(OSCILLATOR, lambda t, x, p: x[0] + math.log(t), [[1.0, 0.0]], [1.0, 0.0, 0.0])
    result = measure(made, 1e-8, np.ones(2))
    assert (result.ended[0], result.ended_at[0]) == (records.NOT_FINITE, 0.0)
