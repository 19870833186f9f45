"""Branches that are not begun, or not gone on with, in words: reason codes, sentences and remedies."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation import outcomes
from contwalk.errors import ContwalkError

# What is said of a start whose motion has come near to where it was, and where no orbit is beside it.
PERHAPS_NOT_PERIODIC = (
    "The simulation has come near to where it was, and no periodic orbit was reached from there: the motion "
    "may not be periodic, but quasi-periodic or chaotic; its next returns tell (contwalk simulate)."
)
# What may be done where equations are singular.
ELSEWHERE = "Start elsewhere, or continue over another parameter."


def no_start(reason: str, sentence: str, what: str = "an equilibrium, or simulate until settled") -> Outcome:
    """The start could not be corrected to a solution."""
    if reason in ("not_finite", "plugin_error"):
        return Outcome("failed", reason, f"The start fails: {sentence} Start elsewhere, or mend the plugin.")
    return Outcome(
        "failed",
        "no_convergence",
        f"The start does not converge to a solution: {sentence} Give a state nearer to {what}.",
    )


def refused(sentence: str, remedy: str) -> Outcome:
    """The start leads to no solution, for a reason with a remedy of its own."""
    return Outcome("failed", "no_convergence", f"The start leads to no solution. {sentence} {remedy}".strip())


def broken_by(error: ContwalkError | np.linalg.LinAlgError, what: str) -> Outcome:
    """The outcome of a branch that an error ended, and of what cannot be done for it."""
    said = str(error) if isinstance(error, ContwalkError) else f"{outcomes.singular(error)} {ELSEWHERE}"
    return Outcome("failed", outcomes.reason_of(error), f"{what}: {said}")


def interrupted() -> Outcome:
    """The user interrupted the run."""
    return Outcome(
        "stopped", "interrupted", "Interrupted. Everything found is stored; run again with --resume to go on."
    )
