"""The model choices: what the machine is made of, and so what its equations contain."""

from __future__ import annotations

from dataclasses import dataclass

from contwalk.system import Choice

ONE_SIDED, TWO_SIDED, CLIPPED, REBOUND = "one_sided", "two_sided", "clipped", "rebound"
DAMPED, SPRUNG, LOCKED = "damped", "sprung", "locked"
MIRRORED, FREE = "mirrored", "free"
DISREGARDED, FELT = "disregarded", "felt"
GENERAL, BALANCED = "general", "balanced"

CHOICES = (
    Choice(
        "ground_damper",
        ONE_SIDED,
        (ONE_SIDED, TWO_SIDED, CLIPPED),
        about="whether the ground damps a toe that moves into it only, or in both directions; or with two "
        "dampings, and never pulls",
    ),
    Choice(
        "hip",
        DAMPED,
        (DAMPED, SPRUNG, LOCKED),
        about="what holds the torso: dampers, dampers and springs, or gears that make it bisect the legs",
    ),
    Choice(
        "knee_damper",
        TWO_SIDED,
        (TWO_SIDED, REBOUND),
        about="whether the stop of a knee damps alike in both directions, or otherwise as the knee rebounds",
    ),
    Choice(
        "legs",
        MIRRORED,
        (MIRRORED, FREE),
        about="whether the machine is its own mirror image, or each leg has parameters of its own",
    ),
    Choice(
        "scuffing",
        DISREGARDED,
        (DISREGARDED, FELT),
        about="whether a swinging foot may pass through the ground until its knee has locked, or touches it",
    ),
    Choice(
        "torso",
        GENERAL,
        (GENERAL, BALANCED),
        about="any mass distribution, or equal moments of inertia and its centre of mass at T",
    ),
)


@dataclass(frozen=True)
class Model:
    """What is chosen; the names and values of `CHOICES`."""

    ground_damper: str = ONE_SIDED
    hip: str = DAMPED
    knee_damper: str = TWO_SIDED
    legs: str = MIRRORED
    scuffing: str = DISREGARDED
    torso: str = GENERAL
