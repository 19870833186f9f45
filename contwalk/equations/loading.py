"""Equations as a module: their plugin compiled so that what is wrong with it is told by lines of the text."""

from __future__ import annotations

import ast
import hashlib
import types
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from contwalk.equations.model import Model
    from contwalk.equations.plugin import Plugin

# A reference to a system that is its equations: these words, then the text.
PREFIX = "equations:"
SOURCE = "the equations"


def is_equations(reference: str) -> bool:
    """Whether a reference to a system is its equations themselves."""
    return reference.startswith(PREFIX)


def hash_of_equations(reference: str) -> dict[str, str]:
    """SHA-256 of a text of equations, as of a plugin's only file."""
    return {SOURCE: digest(reference.removeprefix(PREFIX))}


def digest(text: str) -> str:
    """SHA-256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


@lru_cache(maxsize=16)
def module_of(reference: str) -> types.ModuleType:
    """The module that a text of equations makes; it exports `SYSTEM`.

    Raises
    ------
    ModelError
        With the line of the text.
    """
    from contwalk.equations.plugin import plugin_of  # the grammar: most systems are files
    from contwalk.equations.text import model_of_text

    text = reference.removeprefix(PREFIX)
    model = model_of_text(text, SOURCE)
    return executed(model, plugin_of(replace(model, reference=named(SOURCE, text)), "equations"))


def named(source: str, text: str) -> str:
    """A source's name and hash, as the plugin keeps them."""
    return f"{source}, sha256 {digest(text)}"


def executed(model: Model, plugin: Plugin) -> types.ModuleType:
    """The module of a plugin that was written from a model; its lines are those of the model's text."""
    tree = ast.parse(plugin.text)
    for part in ast.walk(tree):
        if hasattr(part, "lineno"):
            part.lineno = part.end_lineno = max(plugin.origins[part.lineno - 1], 1)  # type: ignore[attr-defined]
            part.col_offset = part.end_col_offset = 0  # type: ignore[attr-defined]
    module = types.ModuleType(f"contwalk_equations_{digest(plugin.text)[:12]}")
    module.__dict__["__file__"] = model.source
    exec(compile(tree, model.source, "exec"), module.__dict__)
    return module
