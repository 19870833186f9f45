"""What integrators written for numba need: memory and functions that are known by their addresses.

Only modules whose functions are compiled import this one, and only processes that compile import those.
All arguments of a compiled entry are 64-bit integers (numbers and addresses) and doubles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numba
import numpy as np
from llvmlite import binding, ir
from numba.core import cgutils, types
from numba.extending import intrinsic
from numba.np.numpy_support import from_dtype

from contwalk.fields.llvm import compiled
from contwalk.flow.compiled.call_record import CallRecord

_TYPES = {"d": types.float64, "q": types.int64, "v": types.void}
_KINDS = {"d": "double", "q": "i64"}


def inlined(function: Callable[..., Any], inline: str = "never") -> Any:
    """A part of a compiled entry: no bounds are checked, divisions by zero give infinities.

    Where it is `inline` "always" numba puts its text in place of a call: only then may it return an array.
    """
    options: dict[str, Any] = {"error_model": "numpy", "boundscheck": False, "_nrt": False, "inline": inline}
    return numba.njit(**options)(function)


def object_code(function: Callable[..., Any], symbol: str, result: str, arguments: str) -> bytes:
    """Object code of a function, to be called by C's rules.

    Parameters
    ----------
    function : callable
        Python that numba can compile without objects and without allocations.
    symbol : str
        The name that the linker will know it by.
    result : str
        "d" for a double, "q" for a 64-bit integer.
    arguments : str
        One letter for each argument.
    """
    kinds = tuple(_TYPES[letter] for letter in arguments)
    dispatcher = inlined(function)
    dispatcher.compile(_TYPES[result](*kinds))
    made = dispatcher.overloads[kinds]
    module = binding.parse_assembly(made.library.get_llvm_str())
    module.link_in(binding.parse_assembly(_wrapper(made.fndesc.llvm_func_name, symbol, result, arguments)))
    for value in (*module.functions, *module.global_variables):
        if not value.is_declaration and value.name != symbol:
            value.linkage = (
                "internal"  # what is not called, such as the way in from the interpreter, is dropped
            )
    return compiled(str(module))


def _wrapper(inner: str, symbol: str, result: str, arguments: str) -> str:
    """IR of a function by C's rules that calls one by numba's: result and exception by reference, first.

    There are no exceptions; were there one, NaN or -1 would be returned.
    """
    given = ", ".join(f"{_KINDS[letter]} %a{i}" for i, letter in enumerate(arguments))
    kinds = ", ".join(["ptr", "ptr", *(_KINDS[letter] for letter in arguments)])
    kind, worst = _KINDS[result], {"d": "0x7FF8000000000000", "q": "-1"}[result]
    return f"""
        declare i32 @"{inner}"({kinds})
        define {kind} @{symbol}({given}) {{
            %result = alloca {kind}
            %exception = alloca ptr
            store {kind} {worst}, ptr %result
            %status = call i32 @"{inner}"(ptr %result, ptr %exception, {given})
            %value = load {kind}, ptr %result
            ret {kind} %value
        }}
    """


def _array_of(element: types.Type, size: int = 8) -> Any:
    @intrinsic
    def array(typing_context: Any, address: Any, length: Any) -> Any:
        array_type = types.Array(element, 1, "C")

        def generate(context: Any, builder: Any, signature: Any, values: Sequence[Any]) -> Any:
            pointer = context.get_data_type(element).as_pointer()
            made = context.make_array(array_type)(context, builder)
            context.populate_array(
                made,
                data=builder.inttoptr(values[0], pointer),
                shape=cgutils.pack_array(builder, [values[1]]),
                strides=cgutils.pack_array(builder, [ir.Constant(ir.IntType(64), size)]),
                itemsize=ir.Constant(ir.IntType(64), size),
                meminfo=None,
            )
            return made._getvalue()

        return array_type(types.int64, types.int64), generate

    return array


doubles = _array_of(types.float64)
"""doubles(address, length): the doubles from an address on, as an array."""

integers = _array_of(types.int64)
"""integers(address, length): the 64-bit integers from an address on, as an array."""

complexes = _array_of(types.complex128, 16)
"""complexes(address, length): the complex numbers from an address on, as an array."""


def record(kind: type[CallRecord]) -> Any:
    """A function `at(address)`: the record of a kind at an address, by its names."""
    record_type = from_dtype(np.dtype(kind))

    @intrinsic
    def at(typing_context: Any, address: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Sequence[Any]) -> Any:
            return builder.inttoptr(values[0], context.get_value_type(record_type))

        return record_type(types.int64), generate

    return at


def caller(result: str, arguments: str) -> Any:
    """A function `call(address, argument, ...)` that calls what is at an address by C's rules.

    Parameters
    ----------
    result, arguments : str
        As for `object_code`; addresses are integers ("q").
    """
    kinds = [_TYPES[letter] for letter in arguments]

    def generate(context: Any, builder: Any, signature: Any, values: Sequence[Any]) -> Any:
        given = cgutils.unpack_tuple(builder, values[1])
        answer = ir.VoidType() if result == "v" else context.get_value_type(_TYPES[result])
        kind = ir.FunctionType(answer, [context.get_value_type(k) for k in kinds])
        found = builder.call(builder.inttoptr(values[0], kind.as_pointer()), given)
        return context.get_dummy_value() if result == "v" else found

    @intrinsic
    def call(typing_context: Any, address: Any, *given: Any) -> Any:
        return _TYPES[result](types.int64, types.Tuple(kinds)), generate

    return call


call_rhs = caller("v", "dqqq")
"""call_rhs(address, t, x, c, out): for `Field.rhs_address` or `rhs_jac_address`; x, c, out are addresses."""
