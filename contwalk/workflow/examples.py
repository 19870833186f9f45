"""Run files that packages bring along: what each does, which others it begins at, and its commands.

A package offers a folder of run files by an entry point of the group `contwalk.examples`, whose value is the
name of a package that has them as data.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import entry_points
from importlib.resources import files

from contwalk.errors import ContwalkError
from contwalk.system.names import nearest
from contwalk.workflow.run_file.yaml_lines import parse_yaml

GROUP = "contwalk.examples"
_SUFFIX = ".yaml"
# What a section of a run file is for, in the order in which it is done.
_COMMANDS = {
    "sample": "sample",
    "simulate": "simulate",
    "continue": "continue",
    "path": "continue",
    "margins": "margins",
}


@dataclass(frozen=True)
class Example:
    """A run file that is installed.

    Parameters
    ----------
    name : str
        Without its suffix.
    text : str
        All of it.
    """

    name: str
    text: str

    @property
    def file(self) -> str:
        """What its copy is called."""
        return f"{self.name}{_SUFFIX}"

    @property
    def about(self) -> str:
        """The first sentence of the comment that it begins with."""
        comment = re.match(r"(?:#.*\n)+", self.text)
        words = " ".join((comment.group() if comment else "").replace("#", " ").split())
        return re.split(r"(?<=[.!?])\s+(?=[A-Z`])", words)[0]

    @property
    def commands(self) -> list[str]:
        """What is done with it, in this order."""
        return list(dict.fromkeys(_COMMANDS[section] for section in _COMMANDS if section in self._data))

    @property
    def output(self) -> str:
        """Its database."""
        return str(self._data.get("output", f"{self.name}.h5"))

    @property
    def begins_at(self) -> list[str]:
        """Databases of others that it names."""
        named = dict.fromkeys(name for name in _sources(self._data) if name.endswith(".h5"))
        return [name for name in named if name != self.output]

    @property
    def _data(self) -> Mapping[str, object]:
        data, _ = parse_yaml(self.text, self.file)
        return data if isinstance(data, dict) else {}


def _sources(data: object) -> Iterator[str]:
    """All that stands behind a key `from`."""
    if isinstance(data, dict):
        for key, value in data.items():
            if key == "from" and isinstance(value, str):
                yield value
            yield from _sources(value)
    elif isinstance(data, list):
        for value in data:
            yield from _sources(value)


def examples() -> dict[str, Example]:
    """All that are installed, by name.

    Raises
    ------
    ContwalkError
        If a package offers a folder that is not there.
    """
    found: dict[str, Example] = {}
    for point in sorted(entry_points(group=GROUP), key=lambda point: point.name):
        try:
            folder = files(point.value)
        except ImportError as error:
            raise ContwalkError(
                f"The examples '{point.name}' ({point.value}) cannot be found: {error}.",
                "Install the package again that offers them.",
            ) from None
        for file in sorted(folder.iterdir(), key=lambda file: file.name):
            if file.name.endswith(_SUFFIX):
                name = file.name.removesuffix(_SUFFIX)
                found.setdefault(name, Example(name, file.read_text(encoding="utf-8")))
    return found


def with_what_it_needs(name: str) -> list[Example]:
    """An example, behind those whose databases it begins at.

    Raises
    ------
    ContwalkError
        If there is none of this name.
    """
    known = examples()
    name = name.removesuffix(_SUFFIX)
    if name not in known:
        hint = f"{nearest(name, list(known))} See all: contwalk examples".strip()
        raise ContwalkError(f"There is no example '{name}'.", hint)
    ordered: dict[str, Example] = {}

    def add(example: Example, asked: tuple[str, ...]) -> None:
        wanted = [database for database in example.begins_at if database not in ordered]
        others = [other for other in known.values() if other.output in wanted] if wanted else []
        for other in others:
            if other.name not in asked:
                add(other, (*asked, other.name))
        ordered.setdefault(example.output, example)

    add(known[name], (name,))
    return list(ordered.values())
