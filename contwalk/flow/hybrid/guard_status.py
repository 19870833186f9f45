"""How guards stand where a motion begins or goes on after a transition: clear of zero, leaving it, just
passed, or past it.

A guard that is zero but for rounding has the sign that it takes next: that of its first derivative that is
not zero but for rounding. After an impact without restitution that is the second one, and the third where a
mass that sticks is released.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from contwalk.flow.events.guard import EPSILON, Guard
from contwalk.flow.hybrid import guard_taylor_records as records
from contwalk.flow.hybrid.guard_taylor import GuardTaylor
from contwalk.flow.hybrid.machine import ModeFlow

KINDS = "clear", "leaving", "entering", "beyond", "resting", "undefined"
CLEAR, LEAVING, ENTERING, BEYOND, RESTING, UNDEFINED = KINDS
PASSED = "passed"

_KINDS = {getattr(records, kind.upper()): kind for kind in KINDS}

# A guard counts as zero within so many of its uncertainties; right after its own event within more.
ROUNDINGS, AFTER_RESET = 8.0, 1e3


@dataclass(frozen=True)
class GuardStatus:
    """A guard where a motion begins.

    Parameters
    ----------
    kind : str
        `CLEAR`: off zero, on the side from which its event comes. `BEYOND`: off zero on the other side. Zero
        but for rounding are the others: `LEAVING` to the side from which the event comes, `ENTERING` the
        other one, `PASSED` the other one right after its own event, which is not another one, `RESTING`: as
        far as rounding shows it stays zero. `UNDEFINED`: it is not finite.
    side : int
        Its sign right after.
    value, rate, bend : float
        Itself and its first two derivatives by time; of a guard that is zero these are 0 where they are not
        more than rounding.
    value_noise : float
        Uncertainty of the value.
    """

    kind: str
    side: int
    value: float
    rate: float
    bend: float
    value_noise: float

    @property
    def bends_back(self) -> bool:
        """Whether it leaves zero and turns back."""
        return self.kind == LEAVING and self.rate * self.bend < 0.0

    @property
    def returns_after(self) -> float:
        """Time until it is zero again, if its second derivative stays; infinite where it does not."""
        return 2.0 * abs(self.rate / self.bend) if self.bends_back else np.inf

    @property
    def excursion(self) -> float:
        """How far from zero it goes until then."""
        return 0.5 * self.rate * (self.rate / abs(self.bend)) if self.bends_back else np.inf


def guard_statuses(
    flow: ModeFlow,
    t: float,
    x: np.ndarray,
    noise: np.ndarray,
    weights: np.ndarray,
    own: Collection[str] = (),
    passed: Collection[str] = (),
) -> list[GuardStatus]:
    """How each guard of a mode stands at an instant.

    Parameters
    ----------
    flow : ModeFlow
    t, x
        Time, and the m states of the mode.
    noise : ndarray, shape (m,)
        Uncertainties of these states by rounding.
    weights : ndarray, shape (m,)
        Their magnitudes on the way here: each step has rounded them.
    own : collection of str
        Transitions whose guards are zero because of what has just happened.
    passed : collection of str
        Those of them that have just happened themselves, and happen where their guards pass zero only.
    """
    taylor = flow.guard_taylor
    taylor.at(t, x, noise, weights)
    found = []
    for number, (transition, guard) in enumerate(zip(flow.transitions, flow.guards, strict=True)):
        if flow.acting(number):
            factor = AFTER_RESET if transition.name in own else ROUNDINGS
            stands = _of(taylor, guard, factor, ROUNDINGS)
            if stands.kind == RESTING:
                stands = _of_higher_order(flow, number, t, x, noise, stands)
            found.append(_unless_passed(stands, transition.name in passed))
        else:
            found.append(_of_watched(taylor, guard, flow, t, x))
    return found


def _unless_passed(stands: GuardStatus, passed: bool) -> GuardStatus:
    """A guard that goes on through zero has been passed; one whose rate the event has taken has not been."""
    goes_on = passed and stands.kind == ENTERING and stands.rate != 0.0
    return replace(stands, kind=PASSED) if goes_on else stands


def _of(taylor: GuardTaylor, guard: Guard, factor: float, beside: float) -> GuardStatus:
    kind, answer = taylor.standing(guard, factor, beside)
    return GuardStatus(
        _KINDS[kind], int(answer.side), answer.value, answer.rate, answer.bend, answer.value_noise
    )


def _of_higher_order(
    flow: ModeFlow, number: int, t: float, x: np.ndarray, noise: np.ndarray, resting: GuardStatus
) -> GuardStatus:
    """As its third derivative says, or the first after it that is not zero."""
    full = np.zeros(len(flow.code.system.states))
    full[flow.states] = x
    uncertain = np.concatenate([[EPSILON * abs(t)], noise])
    side = flow.code.derivatives(number).side_from_third(t, full, flow.p, uncertain, ROUNDINGS)
    if side == 0:
        return resting
    return replace(resting, kind=ENTERING if side == flow.guards[number].direction else LEAVING, side=side)


def leaving_zero(standing: Sequence[GuardStatus]) -> dict[int, int]:
    """The guards that are zero but for rounding and nothing happens: position -> their sign right after."""
    return {i: guard.side for i, guard in enumerate(standing) if guard.kind in (LEAVING, PASSED)}


def happens_at_once(flow: ModeFlow, number: int, guard: GuardStatus) -> bool:
    """Whether a transition happens where its mode is entered with its guard like this."""
    entered = guard.kind == ENTERING or (guard.kind == BEYOND and flow.transitions[number].at_entry)
    return entered and flow.acting(number)


def _of_watched(taylor: GuardTaylor, guard: Guard, flow: ModeFlow, t: float, x: np.ndarray) -> GuardStatus:
    """As for the others; its slopes are compiled only where they are needed."""
    value, rate, own = guard.along(np.array([t]), x[None], flow.p, taylor.velocity[None])[0].tolist()
    if abs(value) <= AFTER_RESET * own:
        return _of(taylor, guard, AFTER_RESET, 0.0)
    side = 1 if value > 0.0 else -1
    kind = UNDEFINED if not np.isfinite(value) else BEYOND if side == guard.direction else CLEAR
    return GuardStatus(kind, side, value, rate, np.nan, own)
