"""The itineraries on the other side of a limit, and the branches of their orbits.

At a grazing, the orbit itself is an orbit of the neighbouring itinerary too: of one in which the event that
is just touched happens, with no speed, or of one in which the event that arrives with no speed does not. It
solves the neighbour's equations exactly, provided that the transition changes nothing at no speed, as an
impact law does. The same is true where a leg's duration passes zero and two transitions that happen at once
may be exchanged. The branch that leaves is the null direction of the neighbour's equations there, taken the
way in which its own limit grows; its first orbits are simulated to see that the machine goes round in that
itinerary.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import NotFinite, StartError
from contwalk.problems.hybrid import simulated_beside
from contwalk.problems.hybrid.adjacent.at_limit import begun_elsewhere, limit_of, place_of
from contwalk.problems.hybrid.adjacent.branch import seed_of
from contwalk.problems.hybrid.adjacent.orbit import (
    NoAdjacentOrbit,
    Undetermined,
    after_transition,
    starts_and_durations,
    state_on_leg,
)
from contwalk.problems.hybrid.adjacent.together import SAME_TOUCH, built_beyond, met_together
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.limits import transition_of
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.itinerary import Leg
from contwalk.problems.problem import Seed
from contwalk.signatures import folded


def found(problem: LimitedOrbit, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
    """The branches of neighbouring words that leave a limit, and in words what was found, or tried."""
    visited = None
    try:
        limit, place = limit_of(problem, point)
        visited = _visited(problem, point, limit, place)
        seeds = _leaving(*begun_elsewhere(problem, np.array(point.unknowns), limit), place, point.label)
    except Undetermined as reason:
        return (), str(reason)
    except NoAdjacentOrbit as reason:
        simulated, told = simulated_beside.seeds(problem, point, visited)
        return simulated, _beside(reason, told, found=bool(simulated))
    except (NotFinite, np.linalg.LinAlgError) as error:
        return (), f"No neighbour to switch to: its equations have no solution there ({error})."
    words = dict.fromkeys(_signatures(cast("LimitedOrbit", seed.problem)) for seed in seeds)
    branches = "a branch of their own" if len(seeds) == 1 else f"{len(seeds)} branches of their own"
    return seeds, f"The orbits with signature {' and '.join(words)} leave there: {branches}."


def _beside(reason: NoAdjacentOrbit, told: str, *, found: bool) -> str:
    """Why equations say nothing of what lies beyond, and what simulated motions say."""
    lead = "The equations at the limit do not lead beyond it" if found else "No orbit beyond it was found"
    return f"{lead}: {reason} {told}"


def _visited(
    problem: LimitedOrbit, point: SpecialPoint, limit: Limit, place: float
) -> simulated_beside.Begin | None:
    """Right after an event that is touched and leads into another mode than the one that goes on."""
    old, transition = problem.itinerary.legs[limit.leg], transition_of(problem, limit)
    if limit.test != "dip" or transition.target == old.mode:
        return None
    z = np.array(point.unknowns)
    there = discretized(problem, z)
    lasting = float(z[there.layout.durations][limit.leg])
    t = float(there.starting_times(z)[limit.leg]) + place * lasting
    leg = Leg(old.mode, transition, transition.direction != "rising")
    x = after_transition(there, leg, state_on_leg(there, z, limit.leg, place), t, z)
    return simulated_beside.Begin(t, x, transition.target, transition.name)


def _signatures(problem: LimitedOrbit) -> str:
    """The signature, over the whole period."""
    return f"[{folded(problem.itinerary.signature(problem.system)) or 'no events'}]"


def _leaving(problem: LimitedOrbit, z: np.ndarray, limit: Limit, place: float, label: str) -> list[Seed]:
    """The branches that leave a limit. Where several limits are met there, as by an orbit that is its own
    image, all of them may be passed, or one.

    Raises
    ------
    NoAdjacentOrbit
        If there is none; the text says why the first one tried is none.
    """
    alike = met_together(problem, z, limit)
    seeds: list[Seed] = []
    reasons = []
    for changing in ([limit, *alike], *([each] for each in (limit, *alike) if alike)):
        try:
            at = place if changing[0] is limit else place_of(problem, z, changing[0])
            neighbour = built_beyond(problem, z, changing, at)
            seed = seed_of(neighbour, label, _signatures(neighbour.problem))
            if not any(_one(seed, other) for other in seeds):
                seeds.append(seed)
        except NoAdjacentOrbit as reason:
            reasons.append(reason)
        except StartError as reason:
            reasons.append(
                NoAdjacentOrbit(
                    f"the equations of the itinerary beyond have no solution there: {reason.sentence}"
                )
            )
    if not seeds:
        raise reasons[0]
    return seeds


def _one(a: Seed, b: Seed) -> bool:
    """Whether two branches that leave a point are one: their orbits go through the same itinerary alike."""
    one, other = cast("LimitedOrbit", a.problem), cast("LimitedOrbit", b.problem)
    mine, lasting, _ = starts_and_durations(one, a.z)
    theirs, alike, _ = starts_and_durations(other, b.z)
    for k in range(len(one.itinerary)):
        if one.itinerary.rotated(one.system, k) != other.itinerary:
            continue
        shifted = [*mine[k:], *mine[:k]]
        scale = one.mesh.variation
        apart = max(float(np.linalg.norm((x - y) / scale)) for x, y in zip(shifted, theirs, strict=True))
        turned = np.array([*lasting[k:], *lasting[:k]])
        if apart < SAME_TOUCH and float(np.abs(turned - alike).max()) < SAME_TOUCH * one.mesh.total:
            return True
    return False
