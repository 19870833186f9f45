"""Pages in headless Chromium: what a click shows, keys, sizes, no request, no complaint, readable for all.

`make browser` runs these. They need Chromium, as of Debian's package, and the extra `browser`.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from explorer_pages import Opened

from contwalk.explorer import explored
from contwalk.number_words import exact
from contwalk.storage import document, open_database
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import run

pytestmark = pytest.mark.browser
ROOT = Path(__file__).parents[2]
STUDIES = {
    "autobalancer_load": ROOT / "runs",
    "autobalancer_border_chart": ROOT / "runs",
    "autobalancer_cascade": ROOT / "runs",
    "planar_slope": ROOT / "runs",
    "fitzhugh_nagumo": ROOT / "tools" / "same_studies",
    "impact_oscillator": ROOT / "tools" / "same_studies",
}
SIZES = [(320, 640), (1280, 800), (3840, 2160)]
# Megabytes that a page may have.
MOST = {"planar_slope": 1.5}


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The page of each study, and what `contwalk show --json --points` tells of it; each made once."""
    folder, made = tmp_path_factory.mktemp("pages"), {}

    def page(name):
        if name not in made:
            file = read_run_file(STUDIES[name] / f"{name}.yaml", (), str(folder / f"{name}.h5"))
            with open_database(run(file, figures=False).path, trust=True) as database:
                found = explored(database, trust=True)
                (folder / f"{name}.html").write_text(found.page, encoding="utf-8")
                made[name] = folder / f"{name}.html", document(database, points=True), found.missing
        return made[name]

    return page


def points_of(shown):
    """Names of all stored points with the values that their facts must show."""
    for branch in shown["branches"]:
        for row, point in enumerate(branch["points"]):
            yield f"{branch['name']}/{row}", [*point["free"], *point["state"].values()]
        for point in branch["special_points"]:
            values = [*point["parameters"].values(), *point["state"].values()]
            yield f"{branch['name']}/{point['name']}", values


@pytest.mark.parametrize("name", STUDIES)
def test_clicks_show_the_stored_values(browser, pages, name):
    path, shown, missing = pages(name)
    assert missing == ()
    page = Opened(browser, path)
    every = list(points_of(shown))
    among = random.Random(5).sample(every, min(100, len(every)))
    for point, values in among:
        page.click(point)
        assert page.selected() == point
        cells = set(
            page.tab.evaluate("[...document.querySelectorAll('#facts td')].map(cell => cell.textContent)")
        )
        assert {exact(value) for value in values if not isinstance(value, str)} <= cells, point
        assert page.text("facts").startswith("<h2>" + point)
    page.close()
    assert path.stat().st_size <= 1e6 * MOST.get(name, 5.0)


@pytest.mark.parametrize("size", SIZES)
def test_it_moves_and_keys_work(browser, pages, size):
    path, _, _ = pages("autobalancer_cascade")
    page = Opened(browser, path, size, "?point=b2/10")
    assert page.selected() == "b2/10"
    for key, now in (("ArrowRight", "b2/11"), ("ArrowLeft", "b2/10")):
        page.tab.keyboard.press(key)
        assert page.selected() == now
    still = page.text("machine")
    page.tab.wait_for_timeout(300)
    assert page.text("machine") == still
    page.tab.keyboard.press(" ")
    moved = page.moved("machine", still)
    page.moved("machine", moved)
    # Nothing is wider than the window.
    assert page.tab.evaluate("document.documentElement.scrollWidth") <= size[0]
    page.close()


def test_a_click_sets_the_machine_in_motion(browser, pages):
    page = Opened(browser, pages("impact_oscillator")[0])
    page.click("b2/20")
    page.moved("machine", page.text("machine"))
    page.close()


def test_a_whole_branch_has_no_state(browser, pages):
    """Nothing is drawn where a point's state stands: the console would tell of numbers that are none."""
    page = Opened(browser, pages("impact_oscillator")[0], query="?point=b2/20")
    page.tab.locator("#branches button[data-branch='b2']").click()
    assert page.selected() == "b2"
    assert page.tab.locator("#portrait-svg .moving").get_attribute("visibility") == "hidden"
    page.click("b2/20")
    assert page.tab.locator("#portrait-svg .moving").get_attribute("visibility") == "visible"
    page.close()


def test_a_point_of_a_curve_is_shown_in_the_diagram(browser, pages):
    page = Opened(browser, pages("autobalancer_border_chart")[0])
    page.click("b2/40")
    assert page.tab.locator("#diagram .linked line").count() == 1
    page.click("b1/HB1")
    assert page.tab.locator("#plane .linked line").count() == 2
    page.close()


def test_a_first_picture_comes(browser, pages):
    page = Opened(browser, pages("planar_slope")[0])
    # The browser notes its first picture after it has loaded the page, in its own time.
    drawn = "performance.getEntriesByName('first-contentful-paint').length === 1"
    page.wait(lambda: page.tab.evaluate(drawn))
    page.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_everybody_can_read_it(browser, pages, scheme):
    from axe_playwright_python.sync_playwright import Axe

    path, _, _ = pages("autobalancer_border_chart")
    tab = browser.new_page(color_scheme=scheme, bypass_csp=True)
    tab.goto(path.as_uri())
    found = Axe().run(tab).response["violations"]
    assert [(each["id"], [node["html"][:120] for node in each["nodes"]][:3]) for each in found] == []
    tab.close()


HOSTILE = """\
contwalk: 1
description: "<img src=x onerror=alert(1)><script>alert(2)</script>"
author: "</script><b id=bold>"
system: {equations: "x' = r*x - x^3; r = -1"}
start: {state: {x: 0.0}}
continue: {parameter: r, range: [-1, 1]}
output: "<b id=bold>&amp;.h5"
"""


def test_what_a_database_says_is_text(browser, tmp_path):
    (tmp_path / "run.yaml").write_text(HOSTILE, encoding="utf-8")
    file = read_run_file(tmp_path / "run.yaml", (), str(tmp_path / "<b id=bold>&amp;.h5"))
    with open_database(run(file, figures=False).path) as database:
        (tmp_path / "page.html").write_text(explored(database).page, encoding="utf-8")
    page = Opened(browser, tmp_path / "page.html")
    assert page.tab.locator("#bold, img, #notes script").count() == 0
    assert "<b id=bold>&amp;.h5" in page.tab.locator("#model").text_content()
    assert "<img src=x onerror=alert(1)>" in page.tab.locator("#notes").text_content()
    assert "</script><b id=bold>" in page.tab.locator("#config").text_content()
    page.close()
