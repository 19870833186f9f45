"""The site in headless Chromium, opened from the disk: it asks no network, and its search finds.

`make browser` runs this, on the site that `make docs` has built, or on one that is built for it.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

pytestmark = pytest.mark.browser
ROOT = Path(__file__).parents[2]
BUILT = ROOT / "build/site/html"


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    if (BUILT / "searchindex.js").exists():
        return BUILT
    from tools.site.__main__ import main

    where = tmp_path_factory.mktemp("site")
    assert main(where) == 0
    return where / "html"


@pytest.fixture(scope="module")
def page():
    found = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if found is None:
        pytest.fail("There is no Chromium here: apt-get install chromium.", pytrace=False)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        yield opened.new_page()
        opened.close()


def test_it_asks_no_network_and_says_nothing(site, page):
    asked, said = [], []
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    for name in ("index", "start", "coming_from/auto", "howto/machines", "reference/api", "studies/thesis"):
        page.goto((site / f"{name}.html").as_uri())
        page.wait_for_load_state("load")
        wide = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
        assert page.evaluate(wide) <= 0, name
    assert [url for url in asked if not url.startswith("file:")] == []
    assert said == []


@pytest.mark.parametrize(
    ("word", "found"),
    [("grazing", "Labels, codes and JSON"), ("MatCont", "From MatCont"), ("continue_branch", "Python")],
)
def test_search_finds(site, page, word, found):
    page.goto((site / "search.html").as_uri() + f"?q={word}")
    page.wait_for_selector(f"#search-results a:text-is('{found}')")
