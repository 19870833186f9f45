"""Finding a system: by entry-point name, by the path of a plugin file, or by its equations."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
import traceback
from collections.abc import Mapping
from dataclasses import replace
from importlib.machinery import SourceFileLoader
from pathlib import Path
from typing import Any, NoReturn

from contwalk.equations.loading import hash_of_equations, is_equations, module_of
from contwalk.errors import ContwalkError, SystemDefinitionError, called
from contwalk.memory import remembered
from contwalk.system.declarations import System, nearest
from contwalk.system.family import Family
from contwalk.system.installed import installed
from contwalk.system.names import HELD
from contwalk.system.plugin_files import hash_of, hashes_of_file, hashes_of_installed

# Systems that Python has made in this process, by the references that stand for them.
_MADE: dict[str, tuple[System, dict[str, str]]] = {}
_MADE_IN_PYTHON = "python:"
# Files of the systems that were loaded lately, by the hash of all.
_LOADED: dict[str, dict[str, str]] = {}
_MOST_LOADED = 16


def list_systems() -> dict[str, str]:
    """Installed systems: entry-point name -> `module:attribute`."""
    return {point.name: point.value for point in sorted(installed(), key=lambda e: e.name)}


def made(system: System, digest: str) -> System:
    """A system that is not from a file, with a reference by which this process finds it again."""
    reference = f"{_MADE_IN_PYTHON}{system.name} {digest[:12]}"
    files = {reference: digest}
    _MADE[reference] = replace(system, source=hash_of(files), loaded_from=reference), files
    return _MADE[reference][0]


def is_path(reference: str) -> bool:
    """Whether a reference to a system is the path of a plugin file, and neither a name nor equations."""
    if is_equations(reference) or reference.startswith(_MADE_IN_PYTHON):
        return False
    return reference.endswith(".py") or "/" in reference or "\\" in reference


def load_declaration(reference: str, base: Path | None = None) -> System | Family:
    """The plugin's `SYSTEM`, as declared.

    Parameters
    ----------
    reference : str
        An installed system's name, the path of a plugin file, or `equations:` with the text behind it.
    base : Path, optional
        What a relative path is relative to; the current directory by default.

    Raises
    ------
    SystemDefinitionError
        If there is no such system, or its file cannot be imported or exports no `SYSTEM`.
    """
    if is_equations(reference):
        return _checked(module_of(reference).SYSTEM, reference)
    if reference.startswith(_MADE_IN_PYTHON):
        return _of_this_process(reference)
    if is_path(reference):
        return _from_file((base or Path.cwd()) / reference, reference, base)
    for point in installed():
        if point.name == reference:
            try:
                return _checked(point.load(), reference)
            except ImportError as error:
                raise SystemDefinitionError(
                    f"The installed system '{reference}' ({point.value}) cannot be imported: {error}.",
                    "Install it again, or give the path of its plugin file.",
                ) from error
    known = list(list_systems())
    raise SystemDefinitionError(
        f"There is no installed system named '{reference}'.",
        f"Installed: {', '.join(known) or 'none'}. {nearest(reference, known)} "
        "For a plugin file of your own, give its path, as in ./my_model.py.".replace("  ", " "),
    )


def load_system(
    reference: str | Path, model: Mapping[str, Any] | None = None, base: Path | None = None
) -> System:
    """The system of this name or plugin file, built with these model choices.

    A choice `parameters.b` is an expression of other parameters that holds the parameter `b`.

    Raises
    ------
    SystemDefinitionError
        As `load_declaration`, and for a model choice that the system does not have.
    """
    reference = str(reference)
    if reference in _MADE and not model:
        return _MADE[reference][0]
    files = plugin_files(reference, base)  # of what is loaded in the next line
    source = hash_of(files)
    remembered(_LOADED, source, _MOST_LOADED, lambda: files)
    declared = load_declaration(reference, base)
    held = {key.removeprefix(HELD): text for key, text in (model or {}).items() if key.startswith(HELD)}
    model = {key: choice for key, choice in (model or {}).items() if not key.startswith(HELD)}
    if isinstance(declared, Family):
        system = called(f"system '{reference}'", declared.with_model, model)
    elif model:
        raise SystemDefinitionError(
            f"System '{reference}' has no model choices, but {', '.join(model)} is given.",
            "Remove the key `model`.",
        )
    else:
        system = declared
    place = str(Path(os.path.abspath((base or Path.cwd()) / reference))) if is_path(reference) else reference
    system = replace(system, source=source, loaded_from=place)
    if not held:
        return system
    from contwalk.system.held import holding  # most systems hold no parameter

    return holding(system, held)


def files_of(system: System, reference: str, base: Path | None = None) -> dict[str, str]:
    """As `plugin_files`, of a system that has been loaded: as the files were then, where that is known."""
    return _LOADED.get(system.source) or plugin_files(reference, base)


def plugin_files(reference: str, base: Path | None = None) -> dict[str, str]:
    """SHA-256 of each file of a plugin, by name; nothing of it is run.

    They are the plugin's own file and the files of its folder, or package, that it imports; see
    `contwalk.system.plugin_files`. Empty where there is no such plugin.
    """
    if is_equations(reference):
        return hash_of_equations(reference)
    if reference.startswith(_MADE_IN_PYTHON):
        return _MADE[reference][1] if reference in _MADE else {}
    if is_path(reference):
        return hashes_of_file((base or Path.cwd()) / reference)
    point = next((point for point in installed() if point.name == reference), None)
    return {} if point is None else hashes_of_installed(point)


def _of_this_process(reference: str) -> System:
    if reference in _MADE:
        return _MADE[reference][0]
    name = reference.removeprefix(_MADE_IN_PYTHON).split()[0]
    raise SystemDefinitionError(
        f"The system '{name}' was made in Python by another process, or has changed since.",
        "Put it into a plugin file, or give its equations as text: others can load it then.",
    )


class _AsItStands(SourceFileLoader):
    """Compiles what a file says now.

    What Python keeps compiled it knows by length and second alone: a plugin that was written anew within a
    second, with another digit, would be the old one.
    """

    def path_stats(self, path: str) -> NoReturn:
        """Nothing is looked for beside the file, nor kept there."""
        raise OSError


def _from_file(path: Path, reference: str, base: Path | None) -> System | Family:
    if path.is_dir():
        raise SystemDefinitionError(
            f"{path} is a directory, not a plugin file.", "Name a file in it, ending in .py."
        )
    if not path.is_file():
        raise SystemDefinitionError(
            f"The plugin file {path} does not exist.",
            f"Relative paths are relative to the {'current directory' if base is None else 'run file'}; "
            "check the name.",
        )
    name = f"contwalk_plugin_{hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:12]}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise SystemDefinitionError(f"{path} is not a Python file.", "A plugin's name ends in .py.")
    if isinstance(spec.loader, SourceFileLoader):
        spec.loader = _AsItStands(name, spec.loader.path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except ContwalkError as error:
        raise type(error)(
            f"{_where(error, path)}: {error.sentence}",
            error.remedy,
        ) from error
    except (Exception, SystemExit) as error:
        raise SystemDefinitionError(
            f"{_where(error, path)}: {type(error).__name__}: {_sentence(error)}",
            "The plugin file must import without an error.",
        ) from error
    if not hasattr(module, "SYSTEM"):
        raise SystemDefinitionError(
            f"The plugin file {path} exports no SYSTEM.", "Add SYSTEM = System(...) at its end."
        )
    return _checked(module.SYSTEM, reference)


def _sentence(error: BaseException) -> str:
    """What an exception says, with a full stop; of a SyntaxError without its place, which is told already."""
    text = error.msg if isinstance(error, SyntaxError) else str(error)
    return text if text.endswith((".", "!", "?")) else f"{text}."


def _where(error: BaseException, path: Path) -> str:
    """`file, line n` of the plugin's own frame that an error came through."""
    if isinstance(error, SyntaxError) and error.lineno is not None:
        return f"{path}, line {error.lineno}"
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        if Path(frame.filename).resolve() == path.resolve():
            return f"{path}, line {frame.lineno}"
    return str(path)


def _checked(declared: Any, reference: str) -> System | Family:
    if isinstance(declared, System | Family):
        return declared
    raise SystemDefinitionError(
        f"SYSTEM of '{reference}' is a {type(declared).__name__}.",
        "It must be a System(...) or a Family(...).",
    )
