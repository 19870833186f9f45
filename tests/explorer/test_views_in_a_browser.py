"""Phase planes, charts, margins and a page that grows, in headless Chromium. `make browser` runs these."""

from __future__ import annotations

import threading

import pytest
from explorer_pages import CYCLE, MARGINS, Opened, computed

from contwalk.explorer import explored, margins_page
from contwalk.explorer.watching import Watched, server_of
from contwalk.storage import open_database
from contwalk.storage.trajectory import write_margins

pytestmark = pytest.mark.browser
FOLD = """\
contwalk: 1
system: {equations: "x' = r + x^2; y' = x - y; r = -1"}
start: {state: {x: -1.0, y: -1.0}}
continue: {parameter: r, range: [-1, 1], max_points: COUNT}
output: fold.h5
"""
# Equilibria of x' = a + b x - x^3: a cusp, whose curve of folds parts one solution from three.
CUSP = """\
contwalk: 1
system: {equations: "x' = a + b*x - x^3; y' = -y; a = -1; b = 1"}
start: {state: {x: -1.3, y: 0.0}}
continue: {parameter: a, range: [-1, 1]}
loci: {with: b, range: [-1, 2], of: all, follow: none}
output: cusp.h5
"""


def written(folder, name, text):
    with open_database(computed(folder, name, text)) as database:
        (folder / f"{name}.html").write_text(explored(database).page, encoding="utf-8")
    return folder / f"{name}.html"


def test_a_phase_plane_lies_behind_the_orbit(browser, tmp_path):
    page = Opened(browser, written(tmp_path, "cycle", CYCLE), query="?point=b2/20")
    plane = page.tab.locator("#portrait-svg .plane")
    assert plane.locator("path.null0, path.null1").count() >= 2
    assert plane.locator("circle.hollow").count() == 1
    shown = page.tab.locator("#portrait-svg path.orbit").get_attribute("d")
    # With the axes exchanged it is turned, without its field it fits the orbit.
    page.tab.select_option("#portrait-y", "x")
    assert plane.locator("circle").count() == 0
    page.tab.select_option("#portrait-x", "y")
    assert plane.locator("circle").count() == 1
    page.tab.select_option("#portrait-x", "x")
    page.tab.select_option("#portrait-y", "y")
    assert page.tab.locator("#portrait-svg path.orbit").get_attribute("d") == shown
    page.tab.uncheck("#show-field")
    assert plane.locator("circle").count() == 0
    assert page.tab.locator("#portrait-svg path.orbit").get_attribute("d") != shown
    page.close()


def test_regions_of_a_chart_are_filled(browser, tmp_path):
    page = Opened(browser, written(tmp_path, "cusp", CUSP))
    regions = page.tab.locator("#plane .region")
    assert regions.count() >= 2
    assert page.tab.locator("#chart-key li").count() >= 1
    numbers = page.tab.locator("#plane .regions text").all_text_contents()
    assert "0 0 1" in numbers
    # The axes exchanged, regions lie as the curves do; with others there are none.
    page.tab.select_option("#plane-x", "b")
    page.tab.select_option("#plane-y", "a")
    assert "0 0 1" in page.tab.locator("#plane .regions text").all_text_contents()
    page.tab.select_option("#plane-y", "b")
    assert page.tab.locator("#plane .regions").get_attribute("visibility") == "hidden"
    page.close()


@pytest.mark.parametrize("size", [(320, 640), (1280, 800)])
def test_pushes_are_told_by_a_click(browser, tmp_path, size):
    text, _ = margins_page(write_margins(tmp_path / "x_margins.h5", MARGINS))
    (tmp_path / "margins.html").write_text(text, encoding="utf-8")
    page = Opened(browser, tmp_path / "margins.html", size)
    assert page.tab.locator("[data-push]").count() == 3
    page.tab.locator('[data-push="0/q/up"]').click()
    assert page.selected() == "0/q/up"
    assert "border at 0.25 m" in page.text("facts")
    assert page.tab.locator("#basin path.place").count() == 2
    assert page.tab.evaluate("document.documentElement.scrollWidth") <= size[0]
    page.close()


def test_a_page_that_grows_keeps_what_one_looks_at(browser, tmp_path):
    path = computed(tmp_path, "fold", FOLD.replace("COUNT", "8"))
    server, address = server_of(Watched(path))
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    try:
        page = Opened(browser, address)
        count = page.tab.locator("svg [data-row]").count()
        page.click("b1/3")
        page.tab.select_option("#diagram-y", "y")
        page.tab.select_option("#portrait-x", "y")
        page.tab.locator("#diagram-in").click()
        looked = "JSON.stringify(diagrams[0].axes.view.x)"
        before = page.tab.evaluate(looked)
        computed(tmp_path, "fold", FOLD.replace("COUNT", "16"))
        page.wait(lambda: page.grown("svg [data-row]", count))
        assert page.selected() == "b1/3"
        assert page.tab.evaluate(looked) == before
        assert page.tab.input_value("#diagram-y") == page.tab.input_value("#portrait-x") == "y"
        # Shown whole again, it fits what has come.
        page.tab.locator("#diagram-all").click()
        assert page.tab.evaluate(looked) != before
        page.tab.close()
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
