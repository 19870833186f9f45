"""Nothing assumes the processor of this machine: programs compile for others, with the same arithmetic.

They are compiled, not run; what numba compiles is its own matter and is not among them.
"""

from __future__ import annotations

import re

import pytest
from llvmlite import binding

from contwalk.fields import llvm
from contwalk.flow.compiled.traced import field_of
from contwalk.flow.explicit.stages import TABLEAUS, text
from contwalk.system import load_system

# Triple, the first bytes of an object file for it, and instructions that multiply and add with one rounding.
PROCESSORS = {
    "aarch64-unknown-linux-gnu": (b"\x7fELF\x02\x01", r"\bf(?:n?m(?:add|sub)|ml[as])\b"),
    "arm64-apple-macosx11.0": (b"\xcf\xfa\xed\xfe", r"\bf(?:n?m(?:add|sub)|ml[as])\b"),
    "x86_64-pc-windows-msvc": (b"\x64\x86", r"\bvfn?m(?:add|sub)"),
}


def programs() -> list[str]:
    """A field with its Jacobian, of one with a linear system in it too, and the steps of an integrator."""
    fields = [field_of(load_system(name)) for name in ("autobalancer", "planar_walker")]
    return [*(field.rhs_jac_text for field in fields), *(text(method) for method in TABLEAUS.values())]


@pytest.mark.parametrize("triple", PROCESSORS)
def test_programs_compile_for_it(triple, monkeypatch):
    binding.initialize_all_targets()
    binding.initialize_all_asmprinters()
    start, fused = PROCESSORS[triple]
    monkeypatch.setattr(llvm, "_processor", lambda: (triple, "", ""))
    for program in programs():
        content = llvm.compiled(program)
        assert content.startswith(start)
        optimized = binding.parse_assembly(llvm.optimized(program))
        assert re.search(fused, llvm._target().emit_assembly(optimized)) is None
