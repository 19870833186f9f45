"""What is derived from a program is kept on disk, and derived anew where it is damaged or of another one."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from contwalk import object_cache
from contwalk.fields import kept_kernels
from contwalk.fields.kept_kernels import KeptKernels
from contwalk.fields.kernel import Kernel
from contwalk.fields.trace import Program, trace
from contwalk.problems.equilibrium import equations
from contwalk.problems.equilibrium.equations import Equations
from contwalk.system import Mode, Parameter, State, System


@pytest.fixture(autouse=True)
def cache_of_its_own(tmp_path, monkeypatch):
    monkeypatch.setenv("CONTWALK_CACHE_DIR", str(tmp_path))


def entries(tmp_path) -> list:
    """Files of kernels, which are no code of Python."""
    found = []
    for path in sorted((tmp_path / "objects").glob("*.o")):
        values = object_cache.load_values(path.stem)
        if values is not None and len(values) == 4:
            found.append(path)
    return found


def pendulum(factor: float = 2.0) -> Equations:
    """Two states, with a table, a choice and an entry of the Jacobian that is zero for good."""

    def field(t, x, p, dx):
        dx[0] = x[1] + 0.0 * p.a
        dx[1] = -factor * np.sin(x[0]) * np.interp(x[0], [0.0, 1.0, 2.0], [1.0, 3.0, p.a * 0.0 + 4.0])
        dx[1] += -p.a * x[1] if x[1] > 0.0 else -3.0 * x[1]

    system = System(
        "pendulum",
        states=(State("q", "1", 1.0, "angle"), State("v", "1/s", 1.0, "rate")),
        parameters=(Parameter("a", 0.5, "1/s", (0.0, 9.0), "damping"),),
        modes=(Mode("swings", field),),
    )
    return Equations(system, "a")


NAMES = ("residual", "linearization", "rounding", "linearization_and_rounding", "rounding_of_matrix")


def told(own: Equations) -> list:
    """Values of kernels of every kind, in floats and in 40 digits."""
    inputs = [0.7, 0.25], [0.5], [0.0], [0.0], []
    values = [getattr(own, name)(*inputs).tolist() for name in NAMES]
    values.append(own.along(2)(*inputs, [1.0, 0.5, 0.25], [0.5, 1.0, 0.125]).tolist())
    values.append(own.jacobian_of_first(*inputs, [1.0, 0.5, 0.25]).tolist())
    values += [
        kernel(*inputs).tolist() for kernel in own.of_function(lambda t, x, p: p.a * x[0, 1] ** 2, along=True)
    ]
    with mpmath.workdps(40):
        exact = own.linearization.exactly(*[[mpmath.mpf(v) for v in group] for group in inputs])
        values.append([mpmath.nstr(value, 35) for value in exact])
    return values


def test_nothing_is_derived_where_an_earlier_process_has_kept_it(monkeypatch):
    first = told(pendulum())
    for name in ("jacobian", "directional", "error_bounds"):
        monkeypatch.setattr(equations, name, None)
    monkeypatch.setattr(Kernel, "__init__", None)
    assert told(pendulum()) == first


def test_what_was_derived_before_decides_nothing():
    """The graph grows by what is derived; what is kept is known by the graph as it was traced."""
    first, other = pendulum(), pendulum()
    first.along(2), first.residual
    assert told(first) == told(other)


def test_another_field_is_another_entry():
    other = told(pendulum(factor=3.0))
    assert told(pendulum())[0] != other[0]
    assert told(pendulum(factor=3.0)) == other


def test_another_generator_makes_its_own_entries(monkeypatch):
    told(pendulum())
    asked = []
    monkeypatch.setattr(kept_kernels, "generator", lambda module: "another version")
    own = equations.jacobian
    monkeypatch.setattr(equations, "jacobian", lambda *a: asked.append(1) or own(*a))
    told(pendulum())
    assert asked


@pytest.mark.parametrize("damage", ["cut", "flipped", "foreign", "no entry", "no kernel"])
def test_a_damaged_or_foreign_entry_is_made_anew(tmp_path, damage):
    def program() -> Program:
        return trace(lambda tracer: [tracer.symbol("u", 0) * 2.0 + 1.0])

    def kept() -> float:
        own = program()
        return float(KeptKernels(own, __name__).kernel("one", lambda: Kernel(own, ("u",)))([3.0])[0])

    def kept_other() -> None:
        own = program()
        KeptKernels(own, __name__).kernel("two", lambda: Kernel(own, ("u",)))

    assert kept() == 7.0
    (path,) = entries(tmp_path)
    good = path.read_bytes()
    if damage == "cut":
        path.write_bytes(good[:-7])
    elif damage == "flipped":
        path.write_bytes(good[:-7] + bytes([good[-7] ^ 1]) + good[-6:])
    elif damage == "foreign":  # sound in itself, but another one
        kept_other()
        other = next(one for one in entries(tmp_path) if one != path)
        path.write_bytes(other.read_bytes())
    elif damage == "no entry":
        object_cache.store(path.stem, b"3")
    else:
        object_cache.store_values(path.stem, (1, 2, 3, 4))
    assert kept() == 7.0
    assert path.read_bytes() == good
