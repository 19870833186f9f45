"""`--set continue.range=[1,6]`: values from the command line put into a run file's data."""

from __future__ import annotations

from typing import Any

from contwalk.errors import RunFileError
from contwalk.workflow.run_file.yaml_lines import Document, Key, dotted, parse_yaml, shown


def apply_override(document: Document, override: str) -> None:
    """Set one `KEY=VALUE` in the document; the value is YAML, missing keys on the way are created.

    Raises
    ------
    RunFileError
        For text that is not `KEY=VALUE`, a value that is not YAML, and a key that leads into a plain value.
    """
    origin = f"--set {override}"
    name, equals, text = override.partition("=")
    pieces = name.strip().split(".")
    if not equals or not all(piece and piece == piece.strip() for piece in pieces):
        raise RunFileError(
            f"{origin}: this is not KEY=VALUE.", "Write, for example, --set parameters.c=0.9, without spaces."
        )
    value, _ = parse_yaml(text, origin, numbered=False)
    here: Any = document.data
    key: Key = ()
    for piece, following in zip(pieces, [*pieces[1:], None], strict=True):
        index = _index(here, key, piece, origin)
        key = (*key, index)
        if following is None:
            here[index] = value
            _forget(document, key)
            document.origins[key] = origin
        else:
            if isinstance(here, dict) and here.get(piece) is None:
                here[piece] = {}
                document.origins[key] = origin
            here = here[index]


def _index(here: Any, key: Key, piece: str, origin: str) -> str | int:
    """What `piece` stands for in `here`: a name in a mapping, a position (from 0) in a list."""
    if isinstance(here, dict):
        return piece
    if isinstance(here, list):
        if piece.isascii() and piece.isdigit() and len(piece) < 7 and int(piece) < len(here):
            return int(piece)
        raise RunFileError(
            f"{origin}: '{dotted(key)}' is a list of {len(here)}, and '{piece}' is no position in it.",
            f"Positions count from 0: allowed 0 to {len(here) - 1}, or set '{dotted(key)}' as a whole.",
        )
    raise RunFileError(
        f"{origin}: '{dotted(key)}' is {shown(here)}, which has no key '{piece}'.",
        f"Set '{dotted(key)}' as a whole.",
    )


def _forget(document: Document, key: Key) -> None:
    """Drop the lines of what is replaced."""
    for known in [known for known in document.origins if known[: len(key)] == key]:
        del document.origins[known]
