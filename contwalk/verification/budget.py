"""The CPU that a check may still take: asked for wherever a motion is followed, within a record as well."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from contwalk.errors import ContwalkError

_UNTIL: ContextVar[float] = ContextVar("until", default=math.inf)


class UsedUp(ContwalkError):
    """What is asked for costs more than there is left."""

    def __init__(self) -> None:
        super().__init__("the budget of CPU is used up")


@contextmanager
def within(seconds: float) -> Iterator[None]:
    """Whatever is followed inside takes so many seconds of CPU at most."""
    token = _UNTIL.set(time.process_time() + seconds)
    try:
        yield
    finally:
        _UNTIL.reset(token)


def ask() -> None:
    """Refuse to go on when they are over.

    Raises
    ------
    UsedUp
    """
    if time.process_time() > _UNTIL.get():
        raise UsedUp
