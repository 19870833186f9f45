"""Models that exist, made plugins and run files: what `contwalk import` writes."""

from __future__ import annotations

import keyword
import re
from dataclasses import dataclass, replace
from pathlib import Path

from contwalk.equations.loading import executed, named
from contwalk.equations.model import Model
from contwalk.equations.nodes import ModelError
from contwalk.equations.plugin import plugin_of
from contwalk.equations.text import model_of_text
from contwalk.equations.xppaut.reader import model_of_ode
from contwalk.errors import ContwalkError
from contwalk.plugin_check.at_load import refuse_unsound
from contwalk.system import System
from contwalk.workflow.run_file.template import starting_file


def _sbml(text: str, source: str, folder: Path) -> Model:
    from contwalk.equations.sbml.reader import model_of_sbml  # what only its files need

    return model_of_sbml(text, source)


# What a model's file ends in, and how its text is read.
READERS = {".txt": lambda text, source, folder: model_of_text(text, source), ".ode": model_of_ode}
READERS |= {".xml": _sbml, ".sbml": _sbml}


@dataclass(frozen=True)
class Imported:
    """A model as a plugin: its text, and the system that it makes."""

    plugin: str
    system: System
    model: Model

    def run_file(self, reference: str) -> str:
        """A run file for it, with what the model's options say of a study."""
        text = starting_file(self.system, reference)
        if self.model.until is None:
            return text
        line = f"simulate: {{until: {self.model.until!r}, points: 1000}}   # contwalk simulate: one motion"
        return re.sub(r"(?m)^# simulate: .*$", line, text)


def imported(path: Path) -> Imported:
    """The plugin of a model's file; it has been loaded and found sound.

    Raises
    ------
    ContwalkError
        If the file cannot be read, or something in it cannot be translated; the sentence names its line.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise ContwalkError(
            f"{path} is of a kind that is not known.", f"Its name must end in {', '.join(READERS)}."
        )
    text = _text_of(path)
    model = reader(text, str(path), path.parent)
    model = replace(model, reference=named(path.name, text))
    plugin = plugin_of(model, name_of(path))
    system: System = executed(model, plugin).SYSTEM
    refuse_unsound(system)
    return Imported(plugin.text, system, model)


def name_of(path: Path) -> str:
    """A system's name from that of its file."""
    name = re.sub(r"\W+", "_", path.stem).strip("_") or "model"
    name = name if not name[0].isdigit() else f"model_{name}"
    return f"{name}_" if keyword.iskeyword(name) else name


def _text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        return path.read_text(encoding="latin-1")
    except OSError as error:
        raise ModelError(f"{path} cannot be read: {error.strerror}.", "Check the name.") from None
