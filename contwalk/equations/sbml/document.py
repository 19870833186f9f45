"""A text of SBML as libsbml's model, after what could harm or cannot be read has been refused."""

from __future__ import annotations

import importlib
from typing import Any
from xml.parsers import expat

from contwalk.equations.model import Model
from contwalk.equations.nodes import LIMITS, ModelError

# Elements inside each other: each operation is one, and what is around an expression.
LARGEST = {"characters": 4 * 1024 * 1024, "depth": LIMITS["operations"] + 30}
_LEVELS = (2, 3)
# What libsbml calls the functions that version 2 of level 3 has added: no package of a file.
_ADDED = "l3v2extendedmath"


def library() -> Any:
    """libsbml.

    Raises
    ------
    ModelError
        Where it is not installed.
    """
    try:
        return importlib.import_module("libsbml")
    except ImportError:
        raise ModelError(
            "SBML is read by python-libsbml, which is not installed.", "pip install 'contwalk[sbml]'"
        ) from None


def document_of(text: str, source: str) -> Any:
    """The model of a text of SBML, as libsbml has it.

    Raises
    ------
    ModelError
        With the line of what is wrong.
    """
    told = Model(source)
    if len(text) > LARGEST["characters"]:
        raise ModelError(
            f"{source} has {len(text)} characters.", f"At most {LARGEST['characters']} are read."
        )
    _check_elements(text, told)
    libsbml = library()
    # libsbml puts a line of its own in front of a text without a declaration.
    declared = text if text.startswith("<?xml") else f'<?xml version="1.0" encoding="UTF-8"?>{text}'
    document = libsbml.readSBMLFromString(declared)
    if document.getLevel() not in _LEVELS:
        raise told.wrong(
            1, f"this is level {document.getLevel()} of SBML.", "Levels 2 and 3 are read: convert it."
        )
    for i in range(document.getNumErrors()):
        error = document.getError(i)
        if error.getSeverity() >= libsbml.LIBSBML_SEV_ERROR:
            what = " ".join(error.getShortMessage().split()) or "it is no SBML"
            raise told.wrong(error.getLine(), f"{what}.", "Check the file by a validator of SBML.")
    for i in range(document.getNumPlugins() if document.getLevel() > _LEVELS[0] else 0):
        package = document.getPlugin(i).getPackageName()
        if package != _ADDED and document.getPackageRequired(package):
            raise told.wrong(
                1,
                f"the package '{package}' changes what the equations mean.",
                "It is not read: write the model without it (comp: flatten it).",
            )
    if document.getModel() is None:
        raise told.wrong(1, "there is no model.", "Is it SBML?")
    return document


def _check_elements(text: str, told: Model) -> None:
    """Refuse what is no XML, declarations of entities, and elements too deep inside each other.

    Raises
    ------
    ModelError
    """
    parser, depth = expat.ParserCreate(), 0

    def begin(element: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > LARGEST["depth"]:
            raise told.wrong(
                parser.CurrentLineNumber,
                f"more than {LARGEST['depth']} elements stand inside each other.",
                "Give parts of the expression names of their own, by rules.",
            )

    def end(element: str) -> None:
        nonlocal depth
        depth -= 1

    def declared(*given: object) -> None:
        raise told.wrong(
            parser.CurrentLineNumber, "a document type is declared.", "Remove it: SBML has none."
        )

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.StartDoctypeDeclHandler = declared
    try:
        parser.Parse(text.encode("utf-8", errors="surrogatepass").decode("utf-8", errors="replace"), True)
    except expat.ExpatError as error:
        sentence = f"this is no XML: {expat.ErrorString(error.code)}."
        raise told.wrong(error.lineno, sentence, "Take the file anew from where it came.") from None
