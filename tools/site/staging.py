"""The pages where Sphinx reads them: `docs/` as the root, the pages beside it, and what they link to.

What a page links to in the repository, as a run file, is copied and becomes a download.
"""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

from tools.gallery import PAGES, SLOW

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
# Pages that lie elsewhere in the repository, and where they stand in the site.
ELSEWHERE = {
    "runs/README.md": "studies/run_files.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changes.md",
}
# Parts of the site, in the order in which they stand beside each page; `*` is what nothing else names.
CHAPTERS = {
    "Start": "start overview tutorials/first_plugin tutorials/first_orbit "
    "tutorials/impact_oscillator tutorials/*",
    "Coming from": "coming_from/index coming_from/*",
    "How to": "howto/*",
    "Reference": "reference/run_file reference/cli reference/plugin reference/equations reference/interface "
    "reference/figures reference/api reference/glossary schema stable",
    "Gallery": "gallery",
    "Systems and studies": "systems/* studies/thesis studies/* peers",
    "How well": "theory limits verification benchmarks release *",
    "Inside": "architecture reference/modules contributing changes notebook",
}
_LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^)\s]+)\)")


def staged(where: Path) -> list[str]:
    """Write all pages to a folder; their names without `.md`."""
    shutil.rmtree(where, ignore_errors=True)
    pages = {path.relative_to(ROOT).as_posix(): path.relative_to(DOCS) for path in DOCS.rglob("*.md")}
    pages |= {name: Path(place) for name, place in ELSEWHERE.items()}
    shutil.copytree(DOCS / "images", where / "images")
    for name, place in pages.items():
        text = (ROOT / name).read_text(encoding="utf-8")
        (where / place).parent.mkdir(parents=True, exist_ok=True)
        # To Pygments these are shells, in which `continue` is a word of its own.
        text = re.sub(r"^( *```)(console|bash|sh)$", r"\1text", text, flags=re.MULTILINE)
        (where / place).write_text(_relinked(text, name, place, pages, where), encoding="utf-8")
    _explored(where)
    return [place.with_suffix("").as_posix() for place in pages.values()]


def _explored(where: Path) -> None:
    """Pages of the explorer that `make gallery` and `make runs` have left, as downloads of the gallery."""
    parts = []
    for place, words in ((PAGES, "These pages"), (SLOW, "Pages of the run files that come along")):
        found = sorted(place.glob("*.html"))
        if not found:
            continue
        folder = where / "files" / place.name
        folder.mkdir(parents=True, exist_ok=True)
        for page in found:
            shutil.copy(page, folder)
        links = "".join(f"- [{page.stem}](files/{place.name}/{page.name})\n" for page in found)
        parts.append(f"\n{words}, made with this site:\n\n{links}")
    if parts:
        with (where / "gallery.md").open("a", encoding="utf-8") as gallery:
            gallery.write("".join(parts))


def _relinked(text: str, name: str, place: Path, pages: dict[str, Path], where: Path) -> str:
    """The text of a page with its links as they are in the site."""

    def link(found: re.Match[str]) -> str:
        image, words, target = found.groups()
        path, _, fragment = target.partition("#")
        if "://" in target or not path:
            return found.group()
        meant = (ROOT / name).parent.joinpath(path).resolve().relative_to(ROOT).as_posix()
        if meant == "README.md":
            meant = "docs/index.md"
        if meant in pages:
            there = os.path.relpath(pages[meant], place.parent)
            return f"{image}[{words}]({there}{'#' if fragment else ''}{fragment})"
        if meant.startswith("docs/images/"):
            there = os.path.relpath(meant.removeprefix("docs/"), place.parent)
            return f"{image}[{words}]({there})"
        if not (ROOT / meant).is_file():
            return words
        copy = where / "files" / meant
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / meant, copy)
        return f"{image}[{words}]({os.path.relpath(copy, (where / place).parent)})"

    # Links within code are none: a mark stands in its place meanwhile.
    parts = re.split(r"(^```.*?^```$|`[^`\n]*`)", text, flags=re.DOTALL | re.MULTILINE)
    code = parts[1::2]
    marks = [f"\0{k}\0" for k in range(len(code))]
    marked = "".join(part for pair in zip(parts[::2], [*marks, ""], strict=True) for part in pair)
    return re.sub("\0(\\d+)\0", lambda found: code[int(found.group(1))], _LINK.sub(link, marked))


def contents(pages: list[str]) -> str:
    """The tables of contents of all chapters; every page is in one of them."""
    named = {name for names in CHAPTERS.values() for name in names.split() if not name.endswith("*")}
    left, found = [page for page in sorted(pages) if page != "index"], []
    for chapter, names in CHAPTERS.items():
        listed: list[str] = []
        for name in names.split():
            if name.endswith("*"):
                folder = name.removesuffix("*")
                inside = [page for page in left if page.startswith(folder) and page not in named]
                listed += [page for page in inside if folder or "/" not in page]
            elif name in left:
                listed.append(name)
        left = [page for page in left if page not in listed]
        rows = "\n".join(listed)
        if listed:
            found.append(f"```{{toctree}}\n:hidden:\n:caption: {chapter}\n\n{rows}\n```\n")
    if left:
        raise SystemExit(f"These pages are in no chapter of the site: {', '.join(left)}.")
    return "\n".join(found)
