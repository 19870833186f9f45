"""Studies of small plugins: a plugin file and a run file in a folder, run as a user would."""

from __future__ import annotations

from pathlib import Path

import contwalk as cw
from contwalk.workflow.runner import RunResult

PLUGIN = """
from contwalk.system import Mode, Parameter, State, Start, System

def field(t, x, p, dx):
{field}

SYSTEM = System(
    name="small",
    states=({states}),
    parameters=({parameters}),
    modes=(Mode("only", field),),
)
"""


def write_plugin(folder: Path, field: str, states: str, **parameters: float) -> Path:
    """`small.py` with this field, written as lines of Python, and one-letter states."""
    lines = "\n".join(f"    {line}" for line in field.strip().splitlines())
    text = PLUGIN.format(
        field=lines,
        states=" ".join(f'State("{name}"),' for name in states),
        parameters=" ".join(f'Parameter("{name}", {value!r}),' for name, value in parameters.items()),
    )
    path = folder / "small.py"
    path.write_text(text, encoding="utf-8")
    return path


def run_text(folder: Path, text: str, name: str = "study") -> RunResult:
    """Run `text` as a run file in `folder`, with the system `./small.py`, into `<name>.h5`."""
    path = folder / f"{name}.yaml"
    path.write_text(f"contwalk: 1\nsystem: ./small.py\n{text}", encoding="utf-8")
    run_file = cw.read_run_file(path, output=folder / f"{name}.h5")
    return cw.run(run_file, figures=False)


def problem_of(folder: Path, result: RunResult, free: str) -> cw.Equilibrium:
    """The problem that the branches of a run belong to, for `check_branch`."""
    system = cw.load_system(str(folder / "small.py"))
    return cw.Equilibrium(system, {**system.defaults(), **result.branches[0].info.parameters}, free)
