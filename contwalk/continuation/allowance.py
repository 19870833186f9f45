"""What a branch may cost, in right-hand sides, and what one direction of it has cost so far."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Bound:
    """What a branch may cost, in right-hand sides.

    Parameters
    ----------
    most : float
        Whatever it shows.
    beyond : float
        Beyond what it shows is worth: how far the free parameter has come from one side to the other.
    worth : float
        Of a change of the free parameter by 1.
    """

    most: float = math.inf
    beyond: float = math.inf
    worth: float = 0.0

    @property
    def nothing(self) -> bool:
        """Whether not even a first step may be taken."""
        return min(self.most, self.beyond) <= 0.0

    def part(self, count: int) -> Bound:
        """An equal part, one of so many."""
        return Bound(self.most / count, self.beyond / count, self.worth)


UNBOUNDED = Bound()


@dataclass
class Allowance:
    """What one direction of a branch may cost, and has: no further step is taken once that is spent."""

    bound: Bound = UNBOUNDED
    spent: int = 0
    least: float = math.inf
    largest: float = -math.inf

    def tell(self, parameter: float, cost: int = 0) -> None:
        """A point, special or not, with the value of its free parameter."""
        self.spent += cost
        self.least, self.largest = min(self.least, parameter), max(self.largest, parameter)

    @property
    def used_up(self) -> bool:
        """Whether the direction ends here."""
        return self.spent >= min(self.bound.most, self.bound.beyond + self.earned)

    @property
    def earned(self) -> float:
        """What is worth as much as it costs."""
        return self.bound.worth * max(self.largest - self.least, 0.0)
