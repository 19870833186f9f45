"""A block on a shaken floor: v' = sin t + b - f sign v, and at rest as long as the force is less than f.

With little friction it comes to rest for an instant only and slides back at once: the phase of rest is passed
in no time. With more it stays at rest for a while. Where such a phase vanishes, sin t + b = f or -f just when
the block stops. With a bias b the two phases of rest vanish one after the other.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache

import mpmath
import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, diagram, machine, opened

from contwalk.branch import Branch
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Noted, Plan
from contwalk.system import System, Transition

B = 0.05
WALKED = 100.0 * ACCURACY
PERIOD = 2.0 * math.pi


def block() -> System:
    def slides_up(t, x, p, dx):
        dx[0] = math.sin(t) + p.b - p.f

    def slides_down(t, x, p, dx):
        dx[0] = math.sin(t) + p.b + p.f

    def rests(t, x, p, dx):
        dx[0] = 0.0 * x[0]

    def too_much(t, x, p):
        return math.sin(t) + p.b - p.f

    def too_little(t, x, p):
        return math.sin(t) + p.b + p.f

    return machine(
        ["v"],
        {"f": 0.6, "b": B},
        {"rest": rests, "up": slides_up, "down": slides_down},
        [
            Transition("stops", "up", "rest", lambda t, x, p: x[0]),
            Transition("halts", "down", "rest", lambda t, x, p: x[0], "rising"),
            Transition(
                "goes_up", "rest", "up", lambda t, x, p: math.sin(t) + p.b - p.f, "rising", level=True
            ),
            Transition("goes_down", "rest", "down", too_little, "falling", level=True),
        ],
        period=lambda p: PERIOD,
    )


def gained(f: float, start: float, end: float) -> float:
    """Velocity after sliding from rest, with the friction f, which is negative on the way down."""
    return mpmath.cos(start) - mpmath.cos(end) + (B - f) * (end - start)


def solved(equations: Callable[..., list], guess: Sequence[float]) -> list[float]:
    with mpmath.workdps(30):
        return [float(v) for v in mpmath.findroot(lambda *u: equations(*u), guess)]


@cache
def vanishing() -> tuple[float, float]:
    """Frictions at which the rest before the way down vanishes, and that before the way up."""
    first = solved(
        lambda start, stop, f: [
            mpmath.sin(start) + B - f, gained(f, start, stop), mpmath.sin(stop) + B + f
        ],
        (0.6, 3.8, 0.56),
    )  # fmt: skip
    second = solved(
        lambda start, stop, f: [
            mpmath.sin(start) + B - f, gained(f, start, stop), gained(-f, stop, start + 2 * mpmath.pi)
        ],
        (0.5, 3.8, 0.51),
    )  # fmt: skip
    return first[2], second[2]


def branches(f: float, b: float = B) -> list[Branch]:
    return diagram(
        block(), "f", (0.3, 0.9), [0.0], {"f": f, "b": b}, until="settled",
        events={"OC": "switch", "GR": "switch"}, depth=4,
    )  # fmt: skip


def rests(branch: Branch) -> list[bool]:
    """Of the ways down and up, whether the block stays at rest before."""
    legs = {leg[1]: leg for leg in branch.info.settings["legs"]}
    return [len(legs[name]) == 3 for name in ("goes_down", "goes_up")]


@pytest.mark.drawn(1)
@pytest.mark.parametrize(
    ("start", "expected"),
    [
        (0.8, [[True, True], [False, True], [False, False]]),
        (0.35, [[False, False], [False, True], [True, True]]),
        (0.53, [[False, True], [True, True], [False, False]]),
    ],
)
def test_branches_pass_where_a_phase_of_rest_vanishes_or_appears(start, expected) -> None:
    found = branches(start)
    assert sorted(map(rests, found)) == sorted(expected)
    assert rests(found[0]) == expected[0]
    first, second = vanishing()
    ends = {(True, True): (first, 0.9), (False, True): (second, first), (False, False): (0.3, second)}
    for branch in found:
        low, high = ends[tuple(rests(branch))]
        assert branch["f"].min() == pytest.approx(low, abs=1e-9)
        assert branch["f"].max() == pytest.approx(high, abs=1e-9)
        for point in branch.special_points:
            assert point.label in ("OC", "EP")
            if point.label == "OC":
                assert_met(point, "f", min((first, second), key=lambda f: abs(f - point.parameters["f"])))
        assert np.all(branch["admissible"][~branch["special"]])
        check(branch)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("start", [0.8, 0.4])
def test_without_a_bias_both_phases_of_rest_vanish_together(start) -> None:
    """Nobody has declared the symmetry. The way up lasts half a period from sin t = f on: 2 cos t = pi f."""
    together = 1.0 / math.hypot(1.0, 0.5 * math.pi)
    found = branches(start, 0.0)
    assert sorted(map(rests, found)) == [[False, False], [True, True]]
    (point,) = [p for branch in found for p in branch.special_points if p.label == "OC"]
    assert_met(point, "f", together)
    for branch in found:
        low, high = (together, 0.9) if rests(branch)[0] else (0.3, together)
        assert branch["f"].min() == pytest.approx(low, abs=1e-9)
        assert branch["f"].max() == pytest.approx(high, abs=1e-9)
        assert np.all(branch["admissible"][~branch["special"]])


def from_there(f: float, known: list[Branch], bias: float) -> tuple[list[Branch], list[str]]:
    """The diagram of a start beside branches that are known already, and what is noted of them."""
    settings = Settings(range=(0.3, 0.9), events={"OC": "switch"})
    values = {"f": f, "b": bias}
    opening = opened(block(), "f", [0.0], values, until="settled", settings=settings)
    made = Diagram([Start(block(), "f", values, opening, "the start")], Plan(settings, depth=4))
    made.branches = list(known)
    notes = [event.text for event in made.events() if isinstance(event, Noted)]
    return made.branches[len(known) :], [note for note in notes if "already known" in note]


def test_a_branch_shorter_than_a_step_is_known_from_its_other_end() -> None:
    """Where the first step passed its end there was no point to compare it by."""
    bias = 1e-3
    (_, short, _), _ = from_there(0.8, [], bias)
    assert rests(short) == [False, True]
    assert np.ptp(short["f"]) < 1e-3
    (other,), notes = from_there(0.35, [short], bias)
    assert rests(other) == [False, False]
    assert notes == [f"{other.name}/OC1 lies on branch {short.name}, already known."]


def check(branch: Branch) -> None:
    """Every row is the motion in closed form, and so is its multiplier."""
    stays_before_down, stays_before_up = rests(branch)
    order = [leg[1] for leg in branch.info.settings["legs"]]
    for row in branch.points[~branch["special"]]:
        f = float(row["free"][0])
        lasting = dict(zip(order, row["unknowns"][4:8].tolist(), strict=True))
        begins = float(row["unknowns"][8])
        times = dict(zip(order, (begins + np.cumsum(list(lasting.values()))).tolist(), strict=True))
        up, stop, down, halt = (times[name] for name in ("goes_up", "stops", "goes_down", "halts"))
        assert abs(lasting["goes_down"]) < 1e-15 or stays_before_down
        assert abs(lasting["goes_up"]) < 1e-15 or stays_before_up
        for place, stays, friction in ((up, stays_before_up, f), (down, stays_before_down, -f)):
            beyond = (math.sin(place) + B - friction) * math.copysign(1.0, friction)
            assert abs(beyond) < WALKED if stays else beyond > -WALKED
        for begin, end, friction in ((up, stop, f), (down, halt, -f)):
            assert abs(float(gained(friction, begin, begin + (end - begin) % PERIOD))) < WALKED
        expected = 0.0  # a release from rest forgets when the rest began
        if not stays_before_down and not stays_before_up:
            begun = (math.sin(up) + B - f) * (math.sin(down) + B + f)
            expected = begun / ((math.sin(stop) + B - f) * (math.sin(halt) + B + f))
        assert abs(row["spectrum"][0] - expected) < 100.0 * WALKED
