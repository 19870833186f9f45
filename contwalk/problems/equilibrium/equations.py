"""The equations of an equilibrium as traced programs: residual, Jacobian, and all higher derivatives.

The unknowns are u = (x, a): the states, and one drift a_j for each pinned neutral direction g_j. The
equations are

    f(x, p) + sum_j a_j g_j(x, p) = 0,    pin_j(x, p) = 0.

On a true family of equilibria every a_j vanishes; a drift that does not is reported, never hidden.
The parameters are p = b, except that the free one is lambda itself, or, on a path, p = b + lambda d. Along a
curve in two parameters the second one is an unknown as well, the last of u.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.errors import SystemDefinitionError
from contwalk.fields.derivative import directional, jacobian
from contwalk.fields.kept_kernels import KeptKernels
from contwalk.fields.kernel import Kernel
from contwalk.fields.rebind import rebound
from contwalk.fields.rounding import error_bounds
from contwalk.fields.trace import Program, Tracer, trace
from contwalk.memory import memory_of, remembered
from contwalk.problems.held_quantities import HeldQuantity
from contwalk.problems.tracing import parameter_symbols, refuse_time, state_symbols, written
from contwalk.system import Neutral, System
from contwalk.system.declarations import ParameterValues

GROUPS = ("u", "l", "b", "d", "r")


class Equations:
    """Traced equations of the equilibria of one system.

    Parameters
    ----------
    system : System
    free : str or None
        Name of the free parameter; None for a path through the parameter space.
    moving : sequence of int
        On a path, the positions of the parameters that change along it.
    pins : sequence of Neutral
        Pinned neutral directions.
    second : str, optional
        A second free parameter, which is the last of the unknowns u.
    """

    def __init__(
        self,
        system: System,
        free: str | None,
        moving: Sequence[int] = (),
        pins: Sequence[Neutral] = (),
        second: str | None = None,
    ) -> None:
        self.system = system
        self.states = len(system.states)
        self.size = self.states + len(pins)
        self.unknowns = self.size + (second is not None)
        self._second = second
        self._free = free
        self._moving = frozenset(moving)
        self._pins = tuple(pins)
        self._field = rebound(system.modes[0].field)
        self._generators = [
            pin.generator if isinstance(pin, HeldQuantity) else rebound(pin.generator) for pin in pins
        ]
        self._symmetries: dict[Callable[..., None], Kernel] = {}
        self._along_several: dict[int, Kernel] = {}

    # -- tracing -----------------------------------------------------------------------------------------

    def _parameters(self, tracer: Tracer) -> ParameterValues:
        names = self.system.parameter_names
        unknown = {} if self._second is None else {self._second: self.size}
        return parameter_symbols(tracer, names, self._free, self._moving, unknown)

    def _residual(self, tracer: Tracer) -> list[Any]:
        n, p = self.states, self._parameters(tracer)
        x = state_symbols(tracer, n)
        result = written(self._field, self.system.modes[0].name, 0.0, x, p)
        pinned: list[Any] = []
        offset = 0  # position in the reference values `r`
        for j, pin in enumerate(self._pins):
            drift = tracer.symbol("u", n + j)
            if isinstance(pin, HeldQuantity):
                added, apart = pin.held(tracer, self.system.modes[0].name, x, p, drift)
                result = [r + a for r, a in zip(result, added, strict=True)]
                pinned.append(apart)
                continue
            v = written(self._generators[j], pin.name, 0.0, x, p)
            result = [r + drift * v[i] for i, r in enumerate(result)]
            if pin.pin is None:
                # held: motion along the generator of the start, g(x0) . (x - x0) = 0
                terms = [
                    tracer.symbol("r", offset + n + i) * (x[i] - tracer.symbol("r", offset + i))
                    for i in range(n)
                ]
                pinned.append(sum(terms[1:], terms[0]))
                offset += 2 * n
            else:
                k = self.system.state_names.index(pin.pin)
                held = tracer.symbol("r", offset) if pin.value is None else getattr(p, pin.value)
                pinned.append(x[k] - held)
                offset += 1
        return [*result, *pinned]

    @property
    def program(self) -> Program:
        """The residual, N outputs."""
        return self._traced[0]

    @cached_property
    def _traced(self) -> tuple[Program, KeptKernels]:
        """The residual, and what has been derived of it, which is known by its graph as it is now."""
        mode = self.system.modes[0]
        _refuse_absent(self.system, mode.name)
        refuse_time(self.system, mode.name, mode.field, f"field of mode '{mode.name}'")
        for pin in self._pins:
            if isinstance(pin, HeldQuantity):  # which the plugin's check refuses to depend on time
                continue
            refuse_time(self.system, mode.name, pin.generator, f"neutral direction '{pin.name}'")
        program = trace(self._residual)
        return program, KeptKernels(program, __name__)

    def _inputs(self) -> list[int]:
        graph = self.program.graph
        return [*[graph.input("u", i) for i in range(self.unknowns)], graph.input("l", 0)]

    # -- kernels -----------------------------------------------------------------------------------------

    def _dense_rows(self, outputs: Sequence[int], inputs: Sequence[int]) -> list[int]:
        graph = self.program.graph
        rows = jacobian(graph, outputs, inputs)
        return [row.get(k, graph.zero) for row in rows for k in range(len(inputs))]

    def _kernel(
        self,
        name: str,
        change: Callable[[tuple[int, ...]], Sequence[int]],
        groups: Sequence[str] = GROUPS,
        shape: tuple[int, ...] | None = None,
    ) -> Kernel:
        """A kernel of what `change` makes of F's nodes, under a name of its own among these equations."""
        described = name, tuple(groups), shape, self.states, self.size, self.unknowns
        return self._traced[1].kernel(described, lambda: self._derived(change, groups, shape))

    def _derived(
        self,
        change: Callable[[tuple[int, ...]], Sequence[int]],
        groups: Sequence[str],
        shape: tuple[int, ...] | None,
    ) -> Kernel:
        program = self.program.transformed(change)
        if shape is None:
            return Kernel(program, groups)
        # Keep only entries that can be nonzero on some path; the others are zero for good.
        graph, zero = program.graph, program.graph.zero
        leaves = [leaf.nodes for leaf in program.leaves() if hasattr(leaf, "nodes")]
        where = [k for k in range(int(np.prod(shape))) if any(leaf[k] != zero for leaf in leaves)]
        kept = Program(graph, program.transformed(lambda o: [o[k] for k in where]).tree)
        return Kernel(kept, groups, shape, where)

    @cached_property
    def residual(self) -> Kernel:
        """F, shape (N,)."""
        return self._kernel("residual", lambda o: o)

    def _beside_each_other(self, outputs: tuple[int, ...]) -> list[list[int]]:
        """For each equation F and its row of the Jacobian."""
        inputs = self._inputs()
        flat, width = self._dense_rows(outputs, inputs), len(inputs)
        return [[o, *flat[i * width : (i + 1) * width]] for i, o in enumerate(outputs)]

    @cached_property
    def linearization(self) -> Kernel:
        """F and its Jacobian side by side, (N, 1 + unknowns + 1): column 0 is F, the last dF/dlambda."""
        return self._kernel(
            "linearization",
            lambda o: [node for row in self._beside_each_other(o) for node in row],
            shape=(self.size, self.unknowns + 2),
        )

    @cached_property
    def rounding(self) -> Kernel:
        """Bounds of the rounding error of F, in units of the machine epsilon, shape (N,)."""
        graph = self.program.graph
        return self._kernel("rounding", lambda o: error_bounds(graph, o))

    @cached_property
    def linearization_and_rounding(self) -> Kernel:
        """Both of these in one pass, (N, 1 + unknowns + 2): the last column are the bounds."""
        graph = self.program.graph

        def change(outputs: tuple[int, ...]) -> list[int]:
            rows, bounds = self._beside_each_other(outputs), error_bounds(graph, outputs)
            return [node for row, bound in zip(rows, bounds, strict=True) for node in (*row, bound)]

        return self._kernel("linearization_and_rounding", change, shape=(self.size, self.unknowns + 3))

    def _along(self, group: str, with_parameter: bool = True) -> dict[int, int]:
        graph = self.program.graph
        inputs = self._inputs()
        directions = {node: graph.input(group, i) for i, node in enumerate(inputs[:-1])}
        if with_parameter:
            directions[inputs[-1]] = graph.input(group, self.unknowns)
        return directions

    @cached_property
    def first(self) -> Kernel:
        """DF(z) v for a direction v of length N + 1, shape (N,)."""
        graph, v = self.program.graph, self._along("v")
        return self._kernel("first", lambda o: directional(graph, o, v), (*GROUPS, "v"))

    @cached_property
    def second(self) -> Kernel:
        """D2F(z)(v, w), shape (N,); directions may be complex."""
        graph, v, w = self.program.graph, self._along("v"), self._along("w")
        return self._kernel(
            "second", lambda o: directional(graph, directional(graph, o, v), w), (*GROUPS, "v", "w")
        )

    @cached_property
    def third(self) -> Kernel:
        """D3F(z)(v, w, y), shape (N,); directions may be complex."""
        graph = self.program.graph
        v, w, y = self._along("v"), self._along("w"), self._along("y")

        def change(outputs: tuple[int, ...]) -> list[int]:
            return directional(graph, directional(graph, directional(graph, outputs, v), w), y)

        return self._kernel("third", change, (*GROUPS, "v", "w", "y"))

    def along(self, order: int) -> Kernel:
        """The derivative of F along so many directions, shape (N,), which may be complex."""
        if order not in self._along_several:
            graph, groups = self.program.graph, [f"v{k}" for k in range(order)]
            directions = [self._along(group) for group in groups]

            def change(outputs: tuple[int, ...]) -> list[int]:
                nodes = list(outputs)
                for direction in directions:
                    nodes = directional(graph, nodes, direction)
                return nodes

            self._along_several[order] = self._kernel(f"along {order}", change, (*GROUPS, *groups))
        return self._along_several[order]

    @cached_property
    def jacobian_of_first(self) -> Kernel:
        """Jacobian of DF(z) v by z, shape (N, N + 1)."""
        graph, v, inputs = self.program.graph, self._along("v"), self._inputs()
        return self._kernel(
            "jacobian_of_first",
            lambda o: self._dense_rows(directional(graph, o, v), inputs),
            (*GROUPS, "v"),
            (self.size, self.unknowns + 1),
        )

    def _adjoint_nodes(self, outputs: tuple[int, ...]) -> list[int]:
        """Nodes of psi . DF(z), N + 1 of them, with psi in group `v`."""
        graph, inputs = self.program.graph, self._inputs()
        total = graph.zero
        for i, output in enumerate(outputs):
            total = graph.add(total, graph.mul(graph.input("v", i), output))
        return self._dense_rows([total], inputs)

    @cached_property
    def adjoint(self) -> Kernel:
        """psi . DF(z), shape (N + 1,)."""
        return self._kernel("adjoint", self._adjoint_nodes, (*GROUPS, "v"))

    @cached_property
    def jacobian_of_adjoint(self) -> Kernel:
        """Jacobian of psi . DF(z) by z, shape (N + 1, N + 1)."""
        inputs = self._inputs()
        return self._kernel(
            "jacobian_of_adjoint",
            lambda o: self._dense_rows(self._adjoint_nodes(o), inputs),
            (*GROUPS, "v"),
            (self.unknowns + 1, self.unknowns + 1),
        )

    @cached_property
    def rate_of_matrix(self) -> Kernel:
        """Derivative of A = df/dx along a direction of z, shape (n, n)."""
        graph, v, inputs = self.program.graph, self._along("v"), self._inputs()[: self.states]

        def change(outputs: tuple[int, ...]) -> list[int]:
            return directional(graph, self._dense_rows(outputs[: self.states], inputs), v)

        return self._kernel("rate_of_matrix", change, (*GROUPS, "v"), (self.states, self.states))

    @cached_property
    def rounding_of_matrix(self) -> Kernel:
        """Bounds of the rounding errors of A = df/dx, in units of the machine epsilon, shape (n, n)."""
        graph, inputs = self.program.graph, self._inputs()[: self.states]
        return self._kernel(
            "rounding_of_matrix",
            lambda o: error_bounds(graph, self._dense_rows(o[: self.states], inputs)),
            shape=(self.states, self.states),
        )

    def of_function(self, function: Callable[..., Any], along: bool) -> tuple[Kernel, Kernel]:
        """A function's value, shape (1,), and its gradient by z, shape (N + 1,), at an equilibrium.

        `along`: it takes instants and states of a motion, as observables do, and not one of each, as guards.
        """
        copy = rebound(function)

        def value(tracer: Tracer) -> list[Any]:
            x = state_symbols(tracer, self.states)
            # The numbers of unknowns agree with `program`, so that graphs have the same inputs.
            if along:
                return [copy(np.zeros(1), x.reshape(1, self.states), self._parameters(tracer))]
            return [copy(0.0, x, self._parameters(tracer))]

        program = trace(value)
        kept, graph = KeptKernels(program, __name__), program.graph
        inputs = [*[graph.input("u", i) for i in range(self.unknowns)], graph.input("l", 0)]

        def gradient(outputs: tuple[int, ...]) -> list[int]:
            row = jacobian(graph, outputs, inputs)[0]
            return [row.get(k, graph.zero) for k in range(len(inputs))]

        return (
            kept.kernel("value", lambda: Kernel(program, GROUPS)),
            kept.kernel(("gradient", self.unknowns), lambda: Kernel(program.transformed(gradient), GROUPS)),
        )

    def of_symmetry(self, function: Callable[..., None]) -> Kernel:
        """Jacobian of a symmetry's map of the states by z, shape (n, N + 1)."""
        if function not in self._symmetries:
            self._symmetries[function] = self._slopes_of(function)
        return self._symmetries[function]

    def _slopes_of(self, function: Callable[..., None]) -> Kernel:
        copy = rebound(function)

        def image(tracer: Tracer) -> list[Any]:
            x = state_symbols(tracer, self.states)
            return written(copy, "symmetry", 0.0, x, self._parameters(tracer))

        program = trace(image)
        graph = program.graph
        inputs = [*[graph.input("u", i) for i in range(self.unknowns)], graph.input("l", 0)]

        def change(outputs: tuple[int, ...]) -> list[int]:
            rows = jacobian(graph, outputs, inputs)
            return [row.get(k, graph.zero) for row in rows for k in range(len(inputs))]

        return Kernel(program.transformed(change), GROUPS, (self.states, len(inputs)))


# Equations of one system that are kept.
_MOST_KNOWN = 64


def equations_of(
    system: System,
    free: str | None,
    moving: tuple[int, ...],
    pins: tuple[Neutral, ...],
    second: str | None = None,
) -> Equations:
    """As `Equations(...)`, traced only once for the same arguments (no values of parameters among them)."""
    # They keep their pins, and so the ids of these.
    key, known = (free, moving, tuple(id(pin) for pin in pins), second), memory_of(system, "equations")
    found: Equations = remembered(
        known, key, _MOST_KNOWN, lambda: Equations(system, free, moving, pins, second)
    )
    return found


def _refuse_absent(system: System, mode: str) -> None:
    """Refuse equilibria of a mode in which not all states exist.

    Raises
    ------
    SystemDefinitionError
    """
    own = system.states_of(mode)
    absent = [f"'{name}'" for k, name in enumerate(system.state_names) if k not in own]
    if absent:
        raise SystemDefinitionError(
            f"An equilibrium is looked for in mode '{mode}', but {', '.join(absent)} "
            f"{'does' if len(absent) == 1 else 'do'} not exist there: equilibria of such modes are not "
            "continued.",
            "For an orbit, let a motion settle (`start: {simulate: {state: {...}, until: settled}}`); for "
            "equilibria name a mode in which all states exist (`start: {state: {...}, mode: NAME}`).",
        )
