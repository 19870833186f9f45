"""`contwalk new`: a plugin and a run file that run as they are, to be changed."""

from __future__ import annotations

import keyword
from pathlib import Path

import click

from contwalk.cli.new_files import write_new
from contwalk.errors import ContwalkError

_PLUGIN = '''\
"""{name}: a chemical oscillator, the Brusselator. Put your own equations in its place."""

from contwalk.system import Mode, Parameter, State, System


def field(t, state, p, rate):
    """Write the rates of the states; derivatives are taken of it, none need be given."""
    x, y = state
    rate[0] = p.A - (p.B + 1.0) * x + x**2 * y
    rate[1] = p.B * x - x**2 * y


SYSTEM = System(
    name="{name}",
    states=(
        State("x", unit="1", start=1.0, about="activator"),
        State("y", unit="1", start=1.5, about="inhibitor"),
    ),
    parameters=(
        Parameter("A", 1.0, unit="1", bounds=(0.0, None), about="feed"),
        Parameter("B", 1.5, unit="1", bounds=(0.0, None), about="control"),
    ),
    modes=(Mode("smooth", field),),
    reference="Prigogine & Lefever (1968)",
)
'''
_RUN = """\
# What {name} does while B varies. contwalk init ./{name}.py -o other.yaml writes every key.
contwalk: 1
system: ./{name}.py
# near an equilibrium; or where a motion settles: {{simulate: {{state: {{...}}, until: settled}}}}
start: {{state: {{x: 1.0, y: 1.5}}}}
continue: {{parameter: B, range: [1.0, 3.0]}}
output: {name}.h5
figures: [bifurcation_diagram]
"""


@click.command("new")
@click.argument("name")
def command(name: str) -> None:
    """Write NAME.py, a plugin, and NAME.yaml, a run file for it: both run as they are.

    Files that exist are not replaced. Who has a model already takes `contwalk import`.
    """
    path = Path(name.removesuffix(".py"))
    if not path.name.isidentifier() or keyword.iskeyword(path.name):
        raise ContwalkError(
            f"'{path.name}' is no name of a system.",
            "Use letters, digits and underscores, not starting with a digit.",
        )
    plugin, run_file = path.with_name(f"{path.name}.py"), path.with_name(f"{path.name}.yaml")
    write_new({plugin: _PLUGIN.format(name=path.name), run_file: _RUN.format(name=path.name)})
    click.echo(f"Wrote {plugin} and {run_file}. Next: contwalk continue {run_file}")
