"""`python -m tools.site [FOLDER]`: build the site, warnings being errors, and check all its links."""

from __future__ import annotations

import sys
from pathlib import Path

from sphinx.cmd.build import build_main

from tools.site import reference
from tools.site.links import broken
from tools.site.staging import ROOT, contents, staged


def main(where: Path) -> int:
    """Build it; 0 where all is well."""
    source, site = where / "source", where / "html"
    pages = staged(source)
    (source / "reference/api.md").write_text(reference.page(), encoding="utf-8")
    index = source / "index.md"
    text = index.read_text(encoding="utf-8") + "\n" + contents([*pages, "reference/api"])
    index.write_text(text, encoding="utf-8")
    options = ["-q", "-W", "--keep-going", "-c", str(Path(__file__).parent), "-d", str(where / "doctrees")]
    code = build_main([*options, str(source), str(site)])
    found = broken(site)
    for line in found:
        print(line)
    if code or found:
        return 1
    print(f"The site is {site / 'index.html'}: {len(pages) + 1} pages.")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build" / "site"))
