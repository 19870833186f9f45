"""Reference pages agree with the code, and no link is dead."""

from __future__ import annotations

import dataclasses
import json
import re

import pytest
from code_blocks import ROOT

from contwalk import system as contract
from contwalk.branch import LABELS
from contwalk.fields.functions import FUNCTIONS

PAGES = sorted(
    str(path.relative_to(ROOT))
    for path in [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("runs/*.md")]
)
SCHEMA = json.loads((ROOT / "contwalk/storage/interface.schema.json").read_text(encoding="utf-8"))


def read(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


def anchor(heading: str) -> str:
    """What a heading is called in links."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)\s]+)\)", read(page)):
        if "://" in target or target.startswith("mailto:"):
            continue
        path, _, fragment = target.partition("#")
        file = ((ROOT / page).parent / path).resolve() if path else ROOT / page
        assert file.exists(), target
        if fragment:
            headings = re.findall(r"^#+ (.*)$", file.read_text(encoding="utf-8"), re.MULTILINE)
            assert fragment in [anchor(heading) for heading in headings], target


def test_every_label_is_explained():
    page = read("docs/reference/interface.md")
    assert [label for label in LABELS if f"\n| {label} |" not in page] == []


def _names(part: dict) -> list[str]:
    found = []
    for name, value in part.get("properties", {}).items():
        found += [name, *_names(value)]
    return found


def test_every_key_and_code_of_the_json_is_explained():
    page = read("docs/reference/interface.md")
    branch, point = SCHEMA["$defs"]["branch"], SCHEMA["$defs"]["special_point"]
    names = {*_names(SCHEMA), *_names(branch), *_names(point)}
    for key in ("reason", "problem"):
        names |= set(branch["properties"][key]["enum"])
    assert sorted(name for name in names if f"`{name}`" not in page) == []


def _argument(field: dataclasses.Field) -> str:
    """An argument with its default, as in a signature."""
    if field.default_factory is not dataclasses.MISSING:
        return f"{field.name}={field.default_factory()!r}"
    shown = f"{field.default!r}".replace("'", '"')
    return field.name if field.default is dataclasses.MISSING else f"{field.name}={shown}"


def test_every_declaration_is_explained():
    page = read("docs/reference/plugin.md")
    for name in (
        "State",
        "Parameter",
        "Mode",
        "Transition",
        "Symmetry",
        "Neutral",
        "Conserved",
        "Observable",
        "Signal",
        "Start",
    ):
        declaration = getattr(contract, name)
        arguments = ", ".join(_argument(field) for field in dataclasses.fields(declaration))
        assert f"### `{name}({arguments})`" in page
    for field in dataclasses.fields(contract.System):
        assert f"`{field.name}`" in page
    for declaration in (contract.Family, contract.Choice):
        for field in dataclasses.fields(declaration):
            assert re.search(rf"\b{field.name}\b", page)


def test_every_function_of_the_table_is_named():
    page = read("docs/reference/plugin.md")
    named = {"abs": "abs", "trunc": "trunc"}
    assert [f for f in FUNCTIONS if not re.search(rf"\b{named.get(f, f)}\b", page)] == []


def test_sources_named_in_the_code_are_listed():
    page = read("docs/theory.md")
    for author in (
        "Keller",
        "Kuznetsov",
        "Moore & A. Spence",
        "Griewank",
        "Higham",
        "Osborne",
        "Chandrupatla",
    ):
        assert author in page.split("## Sources")[1]


@pytest.mark.parametrize("page", ["docs/architecture.md", "CONTRIBUTING.md"])
def test_files_named_in_the_text_exist(page):
    named = re.findall(r"`((?:[\w.]+/)*\w+\.(?:py|toml|md|yaml))`", read(page))
    assert named
    for name in named:
        assert (ROOT / name).exists() or (ROOT / "contwalk" / name).exists(), name
