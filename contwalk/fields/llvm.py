"""From LLVM IR to functions in memory, by way of the cache of object code.

LLVM is asked for what changes no result: no reassociation, and no fused multiply-add, which would round an
expression differently from one place of its use to the next.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import os
import threading
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

import llvmlite
from llvmlite import binding

from contwalk import object_cache
from contwalk.fields.special_functions import called_in

_LOCK = threading.RLock()
# Lines of a block up to which operations are paired into vectors. The time that looking for pairs takes grows
# faster than the block: of a Jacobian of 10,000 lines 5 s of 6, for a tenth of the time of its calls.
MOST_PAIRED = 5000


@cache
def _processor() -> tuple[str, str, str]:
    """Triple, name and features of the machine that this runs on, or of the one that numba is held to."""
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    held = os.environ.get("NUMBA_CPU_NAME")
    features = "" if held else binding.get_host_cpu_features().flatten()
    name = held or binding.get_host_cpu_name()
    return binding.get_process_triple(), name, os.environ.get("NUMBA_CPU_FEATURES", features)


def _target() -> binding.TargetMachine:
    triple, cpu, features = _processor()
    target = binding.Target.from_triple(triple)
    return target.create_target_machine(
        cpu=cpu, features=features, opt=2, reloc="default", codemodel="jitdefault", jit=True
    )


class Code:
    """Functions in memory, as long as this object lives.

    Parameters
    ----------
    content : bytes
        Object code, of this machine.
    symbols : sequence of str
        Names of the functions that will be called.
    """

    def __init__(self, content: bytes, symbols: Sequence[str]) -> None:
        _find_mathematics()
        # An engine is created from a module; an empty one, since the code exists already.
        self._engine = binding.create_mcjit_compiler(binding.parse_assembly(""), _target())
        self._engine.add_object_file(binding.ObjectFileRef.from_data(content))
        self._engine.finalize_object()
        self.addresses = {name: self._engine.get_function_address(name) for name in symbols}

    def function(self, name: str, result: Any, *arguments: Any) -> Callable[..., Any]:
        """A function as `ctypes` calls it, without the interpreter's lock."""
        call = ctypes.CFUNCTYPE(result, *arguments)(self.addresses[name])
        call.code = self  # type: ignore[attr-defined]  # memory that must outlive the function
        return call


def code_of(text: str, symbols: Sequence[str]) -> Code:
    """The functions `symbols` of a module of LLVM IR, compiled or taken from the cache."""
    for name, address in called_in(text).items():
        known_to_the_linker(name, address)
    return cached_code((text,), symbols, lambda: compiled(text))


def code_derived_from(text: str, symbols: Sequence[str], version: str, derive: Callable[[], str]) -> Code:
    """The functions `symbols` of another module that `derive` makes of a text, called by what the text calls.

    The cache knows it by the text and by `version`, which tells how it is made; it is derived if the cache
    has none.
    """
    for name, address in called_in(text).items():
        known_to_the_linker(name, address)
    return cached_code((text, version), symbols, lambda: compiled(derive()))


def cached_code(made_from: Sequence[str], symbols: Sequence[str], compile_it: Callable[[], bytes]) -> Code:
    """Object code from the cache, or from `compile_it`.

    Parameters
    ----------
    made_from : sequence of str
        Texts that determine the result of `compile_it`, but for the machine and llvmlite.
    symbols : sequence of str
        Names of the functions that will be called.
    compile_it : callable
        Gives object code; called if the cache has none.
    """
    with _LOCK:
        name = object_cache.key(*made_from, *_processor(), llvmlite.__version__)
        content = object_cache.load(name)
        if content is None:
            content = compile_it()
            object_cache.store(name, content)
        return Code(content, symbols)


def compiled(text: str) -> bytes:
    """Object code of a module of LLVM IR, optimized."""
    with _LOCK:
        target = _target()
        return bytes(target.emit_object(_optimized(text, target)))


def optimized(text: str) -> str:
    """What LLVM makes of a module before it is machine code."""
    with _LOCK:
        return str(_optimized(text, _target()))


def _optimized(text: str, target: binding.TargetMachine) -> binding.ModuleRef:
    module = binding.parse_assembly(text)
    module.verify()
    options = binding.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization = True
    options.slp_vectorization = _longest_block(text) <= MOST_PAIRED
    binding.create_pass_builder(target, options).getModulePassManager().run(
        module, binding.create_pass_builder(target, options)
    )
    return module


def _longest_block(text: str) -> int:
    """Lines of the longest straight line of operations: between labels, and heads and ends of functions."""
    longest = current = 0
    for line in text.splitlines():
        current = current + 1 if line.startswith((" ", "\t")) else 0
        longest = max(longest, current)
    return longest


def linked_code(text: str, symbols: Sequence[str], called: Mapping[str, int]) -> Code:
    """As `code_of`, for a module that calls functions in memory, which must outlive it: name -> address."""
    with _LOCK:
        for symbol, address in called.items():
            known_to_the_linker(symbol, address)
        return code_of(text, symbols)


def known_to_the_linker(symbol: str, address: int) -> None:
    """Let code that is linked from now on call a function in memory, which must outlive it, by a name."""
    binding.add_symbol(symbol, address)


@cache
def _find_mathematics() -> None:
    """Make the functions of the C library known to the linker where the process does not export them."""
    names = ("sin", "cos", "sincos", "erf", "erfc", "tgamma", "lgamma", "cbrt", "fmod", "hypot")
    if all(binding.address_of_symbol(name) for name in names):
        return
    library = ctypes.util.find_library("m") or ctypes.util.find_library("msvcrt")
    if library:
        binding.load_library_permanently(library)
