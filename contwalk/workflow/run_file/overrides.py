"""`--set continue.range=[1,6]`: values from the command line put into a run file's data."""

from __future__ import annotations

from typing import Any

from contwalk.errors import RunFileError
from contwalk.workflow.run_file.document import Document, Key, dotted, shown
from contwalk.workflow.run_file.yaml_lines import parse_yaml


def apply_override(document: Document, override: str) -> None:
    """Set one `KEY=VALUE` in the document; the value is YAML, missing keys on the way are created.

    Raises
    ------
    RunFileError
        For text that is not `KEY=VALUE`, a value that is not YAML, and a key that leads into a plain value.
    """
    origin = f"--set {override if len(override) <= 60 else override[:57] + '...'}"
    name, equals, text = override.partition("=")
    steps = name.strip().split(".")
    if not equals or not all(step and step == step.strip() for step in steps):
        raise RunFileError(
            f"{origin}: this is not KEY=VALUE.", "Write, for example, --set parameters.c=0.9, without spaces."
        )
    value, _ = parse_yaml(text, origin, numbered=False)
    node: Any = document.data
    key: Key = ()
    for step, following in zip(steps, [*steps[1:], None], strict=True):
        index = _index(node, key, step, origin)
        key = (*key, index)
        if following is None:
            node[index] = value
            _forget(document, key)
            document.origins[key] = origin
        else:
            if isinstance(node, dict) and node.get(step) is None:
                node[step] = {}
                document.origins[key] = origin
            node = node[index]


def _index(node: Any, key: Key, step: str, origin: str) -> str | int:
    """What `step` stands for in `node`: a name in a mapping, a position (from 0) in a list."""
    if isinstance(node, dict):
        return step
    if isinstance(node, list):
        if step.isascii() and step.isdigit() and len(step) < 7 and int(step) < len(node):
            return int(step)
        raise RunFileError(
            f"{origin}: '{dotted(key)}' is a list of {len(node)}, and '{step}' is no position in it.",
            f"Positions count from 0: allowed 0 to {len(node) - 1}, or set '{dotted(key)}' as a whole.",
        )
    raise RunFileError(
        f"{origin}: '{dotted(key)}' is {shown(node)}, which has no key '{step}'.",
        f"Set '{dotted(key)}' as a whole.",
    )


def _forget(document: Document, key: Key) -> None:
    """Drop the lines of what is replaced."""
    for known in [known for known in document.origins if known[: len(key)] == key]:
        del document.origins[known]
