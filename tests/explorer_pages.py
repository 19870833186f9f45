"""What stands in a page that `contwalk explore` writes, read by Python's own zlib; a page in a browser."""

from __future__ import annotations

import base64
import json
import re
import time
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from contwalk.storage.trajectory import Margins
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import run

BLOCK = re.compile(r'<script type="application/octet-stream" data-block="([^"]*)">([^<]*)</script>')
# A round limit cycle of radius r**(1/2).
CYCLE = """\
contwalk: 1
system: {equations: "x' = r*x - y - x*(x^2 + y^2); y' = x + r*y - y*(x^2 + y^2); r = -0.1"}
start: {state: {x: 0.0, y: 0.0}}
continue: {parameter: r, range: [-0.1, 1]}
output: cycle.h5
"""


def computed(folder: Path, name: str, text: str) -> Path:
    """The database of a run file's text, computed anew."""
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    file = read_run_file(folder / f"{name}.yaml", (), str(folder / f"{name}.h5"))
    return run(file, force=True, figures=False).path


def blocks(page: str) -> dict[str, tuple[Any, bytes]]:
    """Header and bytes of each block by its name."""
    found = {}
    for name, text in BLOCK.findall(page):
        whole = zlib.decompress(base64.b64decode(text))
        length = int.from_bytes(whole[:4], "little")
        found[name] = json.loads(whole[4 : 4 + length]), whole[4 + length :]
    return found


def numbers(body: bytes) -> list[int]:
    """Whole numbers of seven bits a byte, the lowest first, zigzag."""
    found, value, shift = [], 0, 0
    for byte in body:
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            found.append(-(value + 1) // 2 if value & 1 else value // 2)
            value = shift = 0
    return found


class Opened:
    """A page, and what it has asked for and said."""

    def __init__(self, browser, path, size=(1280, 800), query="", **options):
        """`path` is a file, or the address of a server."""
        self.tab = browser.new_page(viewport={"width": size[0], "height": size[1]}, **options)
        self.requests, self.said = [], []
        self.tab.on("request", lambda request: self.requests.append(request.url))
        self.tab.on("console", lambda message: self.said.append(message.text))
        self.tab.on("pageerror", lambda error: self.said.append(str(error)))
        self.address = (path if isinstance(path, str) else path.as_uri()) + query
        self.tab.goto(self.address)

    def selected(self):
        return self.tab.evaluate("document.body.dataset.selected")

    def text(self, name):
        return self.tab.evaluate(f"document.getElementById('{name}').innerHTML")

    def click(self, name):
        kind = "row" if name.rpartition("/")[2].isdigit() else "point"
        self.tab.locator(f'svg [data-{kind}="{name}"]').first.dispatch_event("click")

    def moved(self, name, before):
        """What an element shows once it no longer shows `before`; a failure where it goes on showing that."""
        self.wait(lambda: self.text(name) != before)
        return self.text(name)

    def grown(self, selector, count):
        """Whether more elements than so many are there; a page that is being loaded anew has none yet."""
        from playwright.sync_api import Error

        try:
            return self.tab.locator(selector).count() > count
        except Error:
            return False

    def wait(self, holds, seconds=30.0):
        """Wait until something holds.

        The page is asked again and again from outside: a function of Playwright's own that polls inside the
        page is what the page's security policy forbids.
        """
        end = time.monotonic() + seconds
        while not holds():
            assert time.monotonic() < end, f"it does not hold after {seconds:g} s"
            self.tab.wait_for_timeout(20)

    def close(self):
        assert self.requests == [self.address]
        assert self.said == []
        self.tab.close()


def push(number, state, sign, border, **more):
    given = {"number": number, "instant": 0, "fraction": 0.0, "state": state, "sign": sign, "border": border}
    given |= {"vector": [1.0, 0.0], "several": False, "borders": [], "ends": "did_not_return"}
    return given | {"simulations": 7, "farthest": 4.0} | more


MARGINS = Margins(
    "impact_oscillator",
    ("q", "v"),
    (push(0, "v", 1.0, 0.5), push(1, "q", -1.0, None), push(2, "q", 1.0, 0.25, several=True)),
    ({"fraction": 0.0, "time": 0.0, "mode": "<free>", "state": [0.125, -0.5]},),
    {"units": {"q": "m", "v": "m/s"}, "parameters": {}, "provenance": {}},
    {"states": ("q", "v"), "places": np.array([[0.0, 1.0], [2.0, 3.0]]), "labels": ("b1/0", "")},
)
