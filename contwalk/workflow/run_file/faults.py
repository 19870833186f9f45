"""What is wrong with values of a run file, as it is found: where, a sentence, and what is allowed instead."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from contwalk.workflow.run_file.yaml_lines import Key


@dataclass(frozen=True)
class Fault:
    """One of them.

    Parameters
    ----------
    sentence, remedy : str
        What is wrong, and what is allowed; no remedy where the key's own description is one.
    at : tuple of (str or int)
        The key path from the value that was checked.
    unknown_in : type, optional
        The section that does not know the key at the end of `at`.
    """

    sentence: str
    remedy: str = ""
    at: Key = ()
    unknown_in: type | None = None

    def under(self, key: str | int, description: str = "") -> Fault:
        """The same seen from what holds the value under `key`, in whose description is what is allowed."""
        remedy = self.remedy or (f"Allowed: {description}." if description else "")
        return replace(self, at=(key, *self.at), remedy=remedy)


class Invalid(Exception):
    """A value is not what it must be; all faults that were found in it."""

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__(" ".join(fault.sentence for fault in self.faults))


def wrong(sentence: str, remedy: str = "") -> Invalid:
    """A single fault; without a remedy, the description of the key is one."""
    return Invalid([Fault(sentence, remedy)])
