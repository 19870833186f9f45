"""YAML text read into plain data that remembers its lines.

Only data is read: mappings, lists, texts, numbers, true/false and null. A tag that would construct anything
else, a key given twice and an alias that unfolds without end are refused. Numbers follow YAML 1.2, so
that `1e-8` and `.5` are numbers and `no` is a text.
"""

from __future__ import annotations

import sys
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from contwalk.errors import RunFileError
from contwalk.workflow.run_file.document import MAX_CHARACTERS, Key, dotted

MAX_VALUES = 20_000  # a run file has tens; nested aliases reach billions
MAX_DEPTH = 20

_CORE = "tag:yaml.org,2002:"
_TEXTS = ("str", "timestamp", "value")  # a date stays the text that it is


def parse_yaml(text: str, where: str, numbered: bool = True) -> tuple[Any, dict[Key, int | str]]:
    """Plain data of one YAML document, and the line of each key path.

    Parameters
    ----------
    text : str
    where : str
        The file's name or the `--set ...`, for error messages.
    numbered : bool
        Whether error messages name lines.

    Raises
    ------
    RunFileError
        For what is not YAML, and for what this module refuses.
    """
    if len(text) > MAX_CHARACTERS:
        raise RunFileError(
            f"{where} has more than {MAX_CHARACTERS} characters.", "Give a run file; one has a page or two."
        )
    yaml = YAML(typ="safe", pure=True)
    yaml.composer.warn_double_anchors = False
    reader = _Reader(where, numbered)
    try:
        node = yaml.compose(text)
        data = None if node is None else reader.read(node, (), ())
    except RecursionError:
        raise RunFileError(f"{where} is nested too deeply.", "Remove brackets.") from None
    except MarkedYAMLError as error:
        raise reader.syntax_error(error) from None
    except (YAMLError, ValueError) as error:
        what = " ".join(str(error).split())
        raise RunFileError(f"{where} is not YAML text: {what}.", "Save it as plain UTF-8 text.") from None
    return data, reader.lines


class _Reader:
    """Turns nodes into data, counting values and keeping lines."""

    def __init__(self, where: str, numbered: bool) -> None:
        self.where = where
        self.numbered = numbered
        self.lines: dict[Key, int | str] = {}
        self.values = 0

    def problem(self, line: int | None, key: Key, sentence: str, remedy: str) -> RunFileError:
        place = self.where
        if line is not None and self.numbered:
            place += f", line {line}"
        if key:
            place += f", key {dotted(key)}"
        return RunFileError(f"{place}: {sentence}", remedy)

    def syntax_error(self, error: MarkedYAMLError) -> RunFileError:
        mark = error.problem_mark or error.context_mark
        line = None if mark is None else mark.line + 1
        what = " ".join((error.problem or error.context or str(error)).split())
        if "'\\t'" in what:
            return self.problem(line, (), "a tab is used for indentation.", "YAML allows only spaces there.")
        if "another document" in what:
            return self.problem(
                line,
                (),
                "a second document begins here.",
                "A run file is one document: remove the line '---'.",
            )
        return self.problem(
            line, (), f"not valid YAML: {what}.", "Check colons, brackets, quotes and indentation there."
        )

    def read(self, node: Node, key: Key, inside: tuple[int, ...]) -> Any:
        line = node.start_mark.line + 1
        self.values += 1
        if id(node) in inside:
            raise self.problem(line, key, "an alias refers to what contains it.", "Write the value out.")
        if self.values > MAX_VALUES:
            raise self.problem(
                line,
                key,
                f"the file unfolds to more than {MAX_VALUES} values.",
                "Write values without aliases.",
            )
        if len(inside) > MAX_DEPTH:
            raise self.problem(line, key, "nested too deeply.", "Remove brackets.")
        kind = self._kind(node, key, line)
        if isinstance(node, MappingNode) and kind == "map":
            return self._mapping(node, key, (*inside, id(node)))
        if isinstance(node, SequenceNode) and kind == "seq":
            items = []
            for index, item in enumerate(node.value):
                self.lines.setdefault((*key, index), item.start_mark.line + 1)
                items.append(self.read(item, (*key, index), (*inside, id(node))))
            return items
        if isinstance(node, ScalarNode) and kind not in ("map", "seq"):
            value = _scalar(kind, node.value)
            if kind == "int" and _is_beyond_numbers(value):
                raise self.problem(
                    line,
                    key,
                    f"is not finite beyond {sys.float_info.max:.1e}, so not a number to compute with.",
                    "Write a smaller one.",
                )
            return value
        raise self.problem(line, key, f"the tag !!{kind} does not fit what follows.", "Remove the tag.")

    def _kind(self, node: Node, key: Key, line: int) -> str:
        tag = str(node.tag)
        kind = tag.removeprefix(_CORE)
        if kind in ("map", "seq", "null", "bool", "int", "float", "merge", *_TEXTS):
            return kind
        written = f"!!{kind}" if tag.startswith(_CORE) else tag
        raise self.problem(
            line, key, f"the tag {written} is not allowed.", "A run file holds plain data: remove the tag."
        )

    def _mapping(self, node: MappingNode, key: Key, inside: tuple[int, ...]) -> dict[str, Any]:
        data: dict[str, Any] = {}
        for name_node, value_node in node.value:
            line = name_node.start_mark.line + 1
            if not isinstance(name_node, ScalarNode):
                raise self.problem(line, key, "a key is a list or a mapping.", "A key is a name.")
            self._kind(name_node, key, line)
            name = name_node.value  # as written: a parameter called `null` or `e` keeps its name
            if name == "<<":
                raise self.problem(line, key, "the merge key '<<' is not supported.", "Write the values out.")
            if name in data:
                first = self.lines[(*key, name)]
                again = f" (first in line {first})" if self.numbered else ""
                raise self.problem(line, (*key, name), f"the key is given twice{again}.", "Keep one of them.")
            self.lines[(*key, name)] = line
            data[name] = self.read(value_node, (*key, name), inside)
        return data


def _is_beyond_numbers(value: Any) -> bool:
    """Whether a whole number is larger than any other number; one that Python does not read is a text."""
    if isinstance(value, int):
        return value.bit_length() > sys.float_info.max_exp
    return isinstance(value, str) and value.lstrip("+-").isdigit()


def _scalar(kind: str, text: str) -> Any:
    """The value of a scalar; what its kind cannot read stays a text."""
    if kind == "null":
        return None
    if kind == "bool":
        return text.lower() in ("true", "yes", "on", "y")
    plain = text.replace("_", "").lower()
    try:
        if kind == "int":
            digits = plain.lstrip("+-")
            return int(plain, 0) if digits[:2] in ("0x", "0o", "0b") else int(plain)
        if kind == "float":
            return float(plain.replace(".inf", "inf").replace(".nan", "nan"))
    except ValueError:
        return text
    return text
