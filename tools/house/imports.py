"""Who imports whom in `contwalk/`, read from its files: lazy imports and those of annotations as well."""

from __future__ import annotations

import ast
import tomllib
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = "contwalk"
CONTRACT = "Layers import downwards only"

Graph = Mapping[str, Collection[str]]


@dataclass(frozen=True)
class House:
    """The modules of the package, and what they import of it.

    Attributes
    ----------
    docs : dict
        First line of the docstring of each module and package, by dotted name.
    packages : frozenset of str
        The names of these that are folders.
    imports : dict
        The modules and packages that each one imports.
    layers : tuple of tuple of str
        The layers of the contract in `pyproject.toml`, from the top: packages and modules side by side.
    """

    docs: dict[str, str]
    packages: frozenset[str]
    imports: dict[str, frozenset[str]]
    layers: tuple[tuple[str, ...], ...]

    @classmethod
    def read(cls, root: Path = ROOT) -> House:
        """The house as it stands in a folder."""
        paths = {_dotted(path, root): path for path in sorted((root / PACKAGE).rglob("*.py"))}
        packages = frozenset(name for name, path in paths.items() if path.name == "__init__.py")
        docs, imports = dict[str, str](), dict[str, frozenset[str]]()
        # One tree after another: the collector of cycles looks through all that are kept, again and again.
        for name, path in paths.items():
            tree = _parsed(path)
            docs[name] = _first_line(tree, path)
            imports[name] = frozenset(imported(tree, paths)) - {name}
        return cls(docs, packages, imports, _layers(root))

    def folder(self, name: str) -> str:
        """The package that a module stands in; a package itself."""
        return name if name in self.packages else name.rpartition(".")[0]

    def modules(self, package: str) -> list[str]:
        """The modules that stand in a package itself, in the order of their names."""
        return [name for name in self.docs if name not in self.packages and self.folder(name) == package]

    def between(self, place: Mapping[str, str]) -> dict[str, set[str]]:
        """Which places import which others, of a map from modules to places; what has none is left out."""
        found: dict[str, set[str]] = {p: set() for p in place.values()}
        for name, imported in self.imports.items():
            for other in imported:
                if name in place and other in place and place[name] != place[other]:
                    found[place[name]].add(place[other])
        return found


def _dotted(path: Path, root: Path) -> str:
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def _first_line(tree: ast.Module, path: Path) -> str:
    text = ast.get_docstring(tree)
    if not text:
        raise ValueError(f"{path} has no docstring. Say in its first line what the module is for.")
    return text.splitlines()[0]


def imported(tree: ast.Module, known: Collection[str]) -> Iterator[str]:
    """The modules of the package that are imported anywhere in a file."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom) and node.module in known:
            named = {f"{node.module}.{alias.name}" for alias in node.names}
            yield from named & set(known) or {node.module}


def _layers(root: Path) -> tuple[tuple[str, ...], ...]:
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    (layers,) = [contract["layers"] for contract in contracts if contract["name"] == CONTRACT]
    return tuple(tuple(name.strip() for name in line.split("|")) for line in layers)


def reachable(graph: Graph, start: str) -> set[str]:
    """What can be reached from a node in one step or more."""
    seen: set[str] = set()
    ahead = list(graph.get(start, ()))
    while ahead:
        node = ahead.pop()
        if node not in seen:
            seen.add(node)
            ahead.extend(graph.get(node, ()))
    return seen


def circles(graph: Graph) -> dict[str, frozenset[str]]:
    """Of each node, those that it is in a circle with, itself included."""
    reach = {node: reachable(graph, node) for node in graph}
    return {node: frozenset({node} | {o for o in reach[node] if node in reach[o]}) for node in graph}


def reduced(graph: Graph) -> set[tuple[str, str]]:
    """The arrows that do not follow from others: those inside circles, and those between them that are left.

    An arrow from one circle to another follows where there is a way over a third one.
    """
    group = circles(graph)
    between: dict[frozenset[str], set[frozenset[str]]] = defaultdict(set)
    for a, others in graph.items():
        between[group[a]] |= {group[b] for b in others} - {group[a]}

    def ways(start: frozenset[str]) -> set[frozenset[str]]:
        seen: set[frozenset[str]] = set()
        ahead = list(between[start])
        while ahead:
            node = ahead.pop()
            if node not in seen:
                seen.add(node)
                ahead.extend(between[node])
        return seen

    follows = {(a, c) for a in set(group.values()) for b in between[a] for c in ways(b)}
    return {
        (a, b)
        for a, others in graph.items()
        for b in others
        if group[a] == group[b] or (group[a], group[b]) not in follows
    }
