"""The page of all modules: a table for each folder, in the words of the modules' own docstrings."""

from __future__ import annotations

from tools.house.imports import PACKAGE, ROOT, House

MODULES = ROOT / "docs" / "reference" / "modules.md"

HEAD = """# All modules

Written by `make docs` from the first lines of the modules' docstrings: change them there. What the folders
are for, and why, is in [architecture](../architecture.md). "Imports" names the folders that the modules of
one import from, wherever in a file, for annotations too.
"""


def page(house: House) -> str:
    """The whole page."""
    folders = sorted(house.packages)
    place = {name: house.folder(name) for name in house.docs if name != PACKAGE}
    imports = house.between(place)
    return "\n".join([HEAD, *(_section(house, folder, imports.get(folder, set())) for folder in folders)])


def _section(house: House, folder: str, imports: set[str]) -> str:
    title = "/".join(folder.split(".")) + "/"
    lines = [f"## `{title}`", "", house.docs[folder]]
    modules = house.modules(folder)
    if modules:
        lines += ["", "| module | idea |", "|---|---|"]
        lines += [f"| `{name.rpartition('.')[2]}` | {_cell(house.docs[name])} |" for name in modules]
    if imports:
        lines += ["", "Imports: " + ", ".join(f"`{_short(name)}`" for name in sorted(imports)) + "."]
    return "\n".join([*lines, ""])


def _short(name: str) -> str:
    """A folder as it is spoken of: without the package's own name, which stands for its loose modules."""
    return name.removeprefix(PACKAGE + ".") if name != PACKAGE else "contwalk"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
