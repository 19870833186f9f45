"""`python -m tools.house`: write the picture and the table of modules anew."""

from __future__ import annotations

from tools.house.imports import ROOT, House
from tools.house.modules import MODULES, page
from tools.house.picture import PICTURE, drawn


def main() -> None:
    """Write both files, and say where they are."""
    house = House.read()
    for path, text in ((PICTURE, drawn(house)), (MODULES, page(house))):
        path.write_text(text, encoding="utf-8")
        print(path.relative_to(ROOT))


if __name__ == "__main__":
    main()
