"""`python -m tools.gallery`: run the commands of docs/gallery.md, and put what they make in its place."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/gallery.md"
# Pages of the explorer, for the site: those of the page's own commands, and those that `make runs` leaves.
PAGES, SLOW = ROOT / "build/gallery", ROOT / "build/runs"
# What a command names itself.
MARGINS = "impact_oscillator_basin_basin.png"


def commands() -> list[str]:
    """The commands of the page, in their order."""
    return re.findall(r"^\$ (contwalk .*)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)


def pictures() -> list[str]:
    """Names of the pictures that the page shows."""
    return re.findall(r"\]\(images/(\w+\.png)\)", PAGE.read_text(encoding="utf-8"))


def make(folder: Path) -> None:
    """Run the commands in a folder; its pictures have the names that the page has.

    Raises
    ------
    SystemExit
        If one fails, or a picture is not made.
    """
    for command in commands():
        words = [sys.executable, "-m", *shlex.split(command)]
        done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{command}\n{done.stdout}{done.stderr}")
    (folder / MARGINS).replace(folder / "gallery_margins.png")
    missing = [name for name in pictures() if not (folder / name).is_file()]
    if missing:
        raise SystemExit(f"The commands of docs/gallery.md do not make {', '.join(missing)}.")


def main() -> None:
    """Put what is made in its places."""
    PAGES.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make(folder)
        for picture in pictures():
            shutil.copy(folder / picture, ROOT / "docs/images" / picture)
        for page in folder.glob("gallery_*.html"):
            shutil.copy(page, PAGES)


if __name__ == "__main__":
    main()
