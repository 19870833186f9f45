"""A random machine and its study as data, from which plugin and run file are written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from random_terms import Term

IMPORTS = """\
from math import cos, pi, sin

from contwalk.system import Mode, Parameter, State, Symmetry, System, Transition

"""


@dataclass(frozen=True)
class Recipe:
    """A machine and its study.

    `modes` holds the terms of every equation of every mode; `functions` further functions by name (guards,
    resets, maps), each as the lines of its body and its arguments; `declared` is what `System` is told of
    them.
    """

    seed: int
    family: str
    states: int
    parameters: Mapping[str, float]
    modes: Mapping[str, tuple[tuple[Term, ...], ...]]
    start: str
    range: tuple[float, float]
    free: str = "lam"
    functions: Mapping[str, tuple[str, tuple[str, ...]]] = field(default_factory=dict)
    declared: tuple[str, ...] = ()
    depth: int = 2
    max_points: int = 150

    @property
    def name(self) -> str:
        return f"{self.family}-{self.seed}"

    def small(self) -> Recipe:
        """The same machine with a study of few points and branches."""
        return replace(self, depth=min(self.depth, 1), max_points=min(self.max_points, 100))

    def functions_text(self) -> str:
        """Fields and the other functions, as a plugin has them."""
        lines: list[str] = []
        for mode, equations in self.modes.items():
            lines.append(f"def {mode}(t, x, p, dx):")
            for i, terms in enumerate(equations):
                lines.append(f"    dx[{i}] = {' + '.join(term.text for term in terms) or '0.0*x[0]'}")
            lines += ["", ""]
        for name, (arguments, body) in self.functions.items():
            lines += [f"def {name}({arguments}):", *(f"    {line}" for line in body), "", ""]
        return "\n".join(lines)

    def plugin_text(self) -> str:
        """The whole plugin."""
        states = ", ".join(f'State("x{i}")' for i in range(self.states))
        parameters = ", ".join(f'Parameter("{k}", {v!r})' for k, v in self.parameters.items())
        modes = ", ".join(f'Mode("{mode}", {mode})' for mode in self.modes)
        rest = "".join(f"    {line},\n" for line in self.declared)
        return (
            f'{IMPORTS}\n{self.functions_text()}SYSTEM = System(\n    name="machine",\n'
            f"    states=({states},),\n    parameters=({parameters},),\n    modes=({modes},),\n{rest})\n"
        )

    def run_text(self) -> str:
        """The run file beside it."""
        low, high = self.range
        return (
            f"contwalk: 1\nsystem: ./machine.py\nstart: {self.start}\n"
            f"continue: {{parameter: {self.free}, range: [{low}, {high}], max_points: {self.max_points}}}\n"
            f"diagram: {{follow: [BP, HB, PD], depth: {self.depth}}}\n"
        )
