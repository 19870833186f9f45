"""The page on architecture against the code: its picture, the page of all modules, every name in it."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import pytest
from code_blocks import ROOT

from tools.house.imports import House, circles, reachable, reduced
from tools.house.modules import MODULES, page
from tools.house.picture import PICTURE, arrows, boxes, inner_place, outer_place

PAGE = ROOT / "docs" / "architecture.md"
# Pages for who changes the code: files and functions that they name exist.
PAGES = (PAGE, *(ROOT / "docs" / "howto").glob("*.md"), ROOT / "docs" / "theory.md", ROOT / "CONTRIBUTING.md")
# Files that the reader makes.
MADE = {
    "contwalk/flow/classical.py",
    "contwalk/problems/equilibrium/points/neutral_equilibrium.py",
    "contwalk/problems/orbit/points/neutral_cycle.py",
    "contwalk/storage/json_lines.py",
}
PACKAGE = ROOT / "contwalk"
SVG = "{http://www.w3.org/2000/svg}"
ANEW = "Write it anew with `make docs`."


@cache
def house() -> House:
    return House.read()


@cache
def picture() -> ElementTree.Element:
    return ElementTree.parse(PICTURE).getroot()


def drawn_arrows() -> list[tuple[str, str]]:
    paths = picture().iter(f"{SVG}path")
    return sorted((p.attrib["data-from"], p.attrib["data-to"]) for p in paths if "data-from" in p.attrib)


def test_the_picture_has_the_packages_of_today():
    drawn = [group.attrib["data-name"] for group in picture().iter(f"{SVG}g")]
    assert drawn == [box.name for outer in boxes(house()) for box in outer.all()], ANEW


def test_no_box_of_the_picture_covers_another():
    drawn = boxes(house())
    for outer in drawn:
        beside = [box for box in drawn if box.y == outer.y and box is not outer]
        assert all(box.x >= outer.x + outer.width or box.x + box.width <= outer.x for box in beside), (
            outer.name
        )


def test_the_picture_has_the_arrows_of_today():
    assert drawn_arrows() == arrows(house()), ANEW


def test_arrows_of_the_picture_are_imports_and_every_import_follows_from_them():
    tops = sorted(set(outer_place(house()).values()))
    for place in (outer_place(house()), *(inner_place(house(), top) for top in tops)):
        names = set(place.values())
        drawn = {name: {b for a, b in drawn_arrows() if a == name} for name in names}
        for name, imported in house().between(place).items():
            assert drawn[name] <= imported
            assert imported <= reachable(drawn, name)


def test_every_package_has_a_layer():
    layers = {name.partition(".")[2] for layer in house().layers for name in layer}
    assert set(outer_place(house()).values()) == layers


def test_what_follows_from_other_arrows_is_left_out():
    chain = {"a": {"b", "c"}, "b": {"c"}, "c": {"d", "b"}, "d": set()}
    assert circles(chain)["b"] == {"b", "c"}
    assert reduced(chain) == {("a", "b"), ("a", "c"), ("b", "c"), ("c", "b"), ("c", "d")}
    assert reduced({"a": {"b", "c"}, "b": {"c"}, "c": set()}) == {("a", "b"), ("b", "c")}


def test_the_page_of_all_modules_is_that_of_today():
    assert MODULES.read_text(encoding="utf-8") == page(house()), ANEW


def test_the_page_of_all_modules_names_each_once():
    rows = re.findall(r"^\| `(\w+)` \|", MODULES.read_text(encoding="utf-8"), flags=re.MULTILINE)
    files = [path.stem for path in PACKAGE.rglob("*.py") if path.name != "__init__.py"]
    assert sorted(rows) == sorted(files), ANEW


# -- names in the page ---------------------------------------------------------------------------------------


@cache
def quoted() -> tuple[str, ...]:
    """What these pages have in back-quotes."""
    return tuple(text for page in PAGES for text in in_quotes(page))


def in_quotes(page: Path) -> list[str]:
    return re.findall(r"`([^`\n]+)`", page.read_text(encoding="utf-8"))


def written_places() -> list[str]:
    """Those with a folder or a function: other names of files may be the reader's own."""
    found = {q for q in quoted() if re.fullmatch(r"[\w/*]+\.py(:[\w.]+)?", q) and ("/" in q or ":" in q)}
    return sorted(found - MADE)


def written_folders() -> list[str]:
    return sorted({text for text in quoted() if re.fullmatch(r"[\w/]+/", text)})


def _nodes(tree: ast.AST, names: list[str]) -> bool:
    """Whether classes and functions of these names stand in each other."""
    if not names:
        return True
    found = [
        node
        for node in ast.iter_child_nodes(tree)
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name == names[0]
    ]
    return any(_nodes(node, names[1:]) for node in found)


@pytest.mark.parametrize("place", written_places())
def test_files_and_functions_that_the_page_names_exist(place):
    name, _, function = place.partition(":")
    paths = [path for root in (PACKAGE, ROOT) for path in root.glob(name)]
    assert paths, f"There is no file {name}."
    if function:
        tree = ast.parse(paths[0].read_text(encoding="utf-8"))
        assert _nodes(tree, function.split(".")), f"There is no {function} in {name}."


@pytest.mark.parametrize("folder", written_folders())
def test_folders_that_the_page_names_exist(folder):
    assert (PACKAGE / folder).is_dir() or (ROOT / folder).is_dir()


@cache
def known() -> dict[str, list[set[str]]]:
    """The words in the modules of each stem."""
    names: dict[str, list[set[str]]] = {}
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        names.setdefault(path.stem, []).append(set(re.findall(r"\w+", text)))
    return names


def dotted() -> list[str]:
    """What is written as `module.name`, of modules of the package."""
    found = [re.fullmatch(r"([a-z_]+)\.(\w+)(\(.*\))?", text) for text in in_quotes(PAGE)]
    return sorted({f"{m[1]}.{m[2]}" for m in found if m and m[1] in known() and m[2] != "py"})


@pytest.mark.parametrize("name", dotted())
def test_names_in_modules_exist(name):
    module, _, own = name.partition(".")
    assert any(own in names for names in known()[module])


def _section(title: str) -> str:
    return PAGE.read_text(encoding="utf-8").split(f"\n## {title}\n")[1].split("\n## ")[0]


@pytest.mark.parametrize("of", ["a parameter", "a state", "an event"])
def test_each_way_through_the_house_names_functions_of_several_layers(of):
    text = _section(f"The way of {of}")
    steps = re.findall(r"^(\d+)\. ", text, flags=re.MULTILINE)
    assert steps == [str(i + 1) for i in range(len(steps))]
    named = re.findall(r"`([\w/]+)\.py:[\w.]+`", text)
    assert len(named) >= len(steps)
    assert len({name.split("/")[0] for name in named}) >= 4
