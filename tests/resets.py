"""Studies of machines with one mode and one event whose reset begins each round anew."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import contwalk as cw
from contwalk.branch import Branch

PLUGIN = """\
import math
from contwalk.system import Mode, Parameter, State, System, Transition

def field(t, x, p, dx):
{field}

def reset(t, x, p, x_plus):
{reset}

SYSTEM = System("small", states=({states},), parameters=(Parameter("I", {value}),), modes=(Mode("m", field),),
    transitions=(Transition("spike", "m", "m", lambda t, x, p: x[0] - {peak}, "rising", reset),))
"""


def study(
    folder: Path,
    field: str,
    reset: str,
    states: Sequence[str],
    start: str,
    value: float,
    low: float,
    high: float,
    peak: float,
    max_points: int = 300,
) -> Branch:
    """The branch of a machine's orbits as I goes from `value` to both ends, `low` and `high`.

    An event happens at `peak` of the first state. Lines of the functions are parted by semicolons.
    """

    def lines(text: str) -> str:
        return "\n".join("    " + line for line in text.split("; "))

    declared = ", ".join(f'State("{name}")' for name in states)
    text = PLUGIN.format(field=lines(field), reset=lines(reset), states=declared, value=value, peak=peak)
    (folder / "small.py").write_text(text)
    (folder / "run.yaml").write_text(
        f"contwalk: 1\nsystem: ./small.py\nstart: {{simulate: {{state: {start}, until: settled}}}}\n"
        f"continue: {{parameter: I, range: [{low}, {high}], max_points: {max_points}}}\n"
        "diagram: {follow: none}\n"
    )
    result = cw.run(cw.read_run_file(folder / "run.yaml", output=folder / "run.h5"), figures=False)
    return result.branches[0]


def told_limit(branch: Branch) -> tuple[float, float]:
    """The parameter at which the message says that the period is infinite, and its error."""
    found = re.search(r"at I = (\S+) \+- (\S+),", branch.outcome.message)
    assert found, branch.outcome.message
    return float(found[1]), float(found[2])
