"""What is found of one record: three words, and the numbers behind them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from contwalk.errors import ContwalkError
from contwalk.labels import END

# A value may differ by so many times what the two error estimates together allow: estimates are estimates.
SLACK = 5.0
# A record that moved by so many of its errors is to be told, so the second computation is as exact as that.
MOVED = 100.0
AGREES, DISAGREES, CANNOT_TELL = "AGREES", "DISAGREES", "CANNOT TELL"


class CannotTell(ContwalkError):
    """Why a record is not recomputed."""


class Contradiction(CannotTell):
    """What a record says that cannot be, by its own words."""


@dataclass(frozen=True)
class Finding:
    """A stored record beside what is recomputed from its own words.

    Parameters
    ----------
    branch, record : str
        Names, as `b2` and `PD1`, or a row's number.
    quantity : str
        What is compared: a parameter, the solution, a multiplier, how a branch ends.
    stored, recomputed, difference : float
    stored_error, own_error : float
        Estimated absolute errors of both.
    method : str
        How it was recomputed.
    verdict : str
        `AGREES`, `DISAGREES` or `CANNOT_TELL`.
    reason : str
        Why, unless it agrees.
    """

    branch: str
    record: str
    quantity: str = ""
    stored: float = math.nan
    recomputed: float = math.nan
    difference: float = math.nan
    stored_error: float = math.nan
    own_error: float = math.nan
    method: str = ""
    verdict: str = CANNOT_TELL
    reason: str = ""

    @property
    def quotient(self) -> float:
        """|difference| over the stored error, in which one is what an honest estimate allows."""
        return self.difference / self.stored_error if self.stored_error > 0.0 else math.nan

    @property
    def failed(self) -> bool:
        """Whether the stored record is called into question."""
        return self.verdict == DISAGREES

    @property
    def of_row(self) -> bool:
        """Whether it is one of an ordinary row."""
        return self.record.isdecimal()

    @property
    def of_end(self) -> bool:
        """Whether it is one of an end of a branch."""
        return self.record.startswith(END)

    @property
    def of_point(self) -> bool:
        """Whether it is one of a special point."""
        return not self.of_row and not self.of_end


def judged_by_errors(found: Finding, rounding: float) -> Finding:
    """The verdict on two values by the errors of both: a check that would not see 100 errors is none.

    A smaller error than some roundings cannot be told from these: the second computation is in doubles.
    """
    allowed = SLACK * (found.stored_error + found.own_error)
    if found.difference > allowed:
        return replace(found, verdict=DISAGREES, reason=f"more than {SLACK:g} times the errors of both")
    if allowed > MOVED * max(found.stored_error, 4.0 * rounding):
        return replace(found, reason=f"it is recomputed to {found.own_error:.1e} only")
    return replace(found, verdict=AGREES)
