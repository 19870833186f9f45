"""The picture of the layers: packages as boxes, the layers of the contract as rows, imports as arrows.

Arrows are those of the code, without the ones that follow from others: where continuation imports problems,
and problems import the flow, an arrow from continuation to the flow would say nothing new. Folders of a
package that import each other in a circle (of files there is none) stand side by side, an arrow each way.
"""

from __future__ import annotations

import textwrap
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from xml.sax.saxutils import escape, quoteattr

from tools.house.imports import PACKAGE, ROOT, Graph, House, circles, reachable, reduced

PICTURE = ROOT / "docs" / "images" / "architecture.svg"

# Modules in no layer of the contract, which are what results are made of and called, are drawn in this box.
HOME = "branch"
ENTRY = "__main__"
# So many modules of a package, or fewer, are boxes of their own beside its folders.
FEW = 4
OWN = "own"

# Where the boxes of a layer stand, as the left and the right edge; a layer with another box is shared evenly.
WIDTH = 1200
COLUMNS = {
    "cli": (200, 600),
    "shortcuts": (640, 1180),
    "workflow": (200, 1180),
    "comparing": (20, 310),
    "studies": (330, 730),
    "verification": (770, 1180),
    "plugin_check": (20, 250),
    "diagram": (330, 730),
    "continuation": (330, 730),
    "plotting": (800, 985),
    "storage": (1005, 1180),
    "problems": (20, 780),
    "flow": (240, 700),
    "fields": (340, 690),
    "python_functions": (430, 720),
}
MARGIN, GAP, ROW, TITLE, SMALL, LETTER = 14, 26, 34, 22, 13, 5.9
BETWEEN_LAYERS = 40

STYLE = """
text { font-family: "DejaVu Sans", Verdana, sans-serif; font-size: 13px; fill: #1c2733; }
.name { font-weight: bold; }
.idea { font-size: 11px; fill: #4a5a6a; }
.outer { fill: #eef3f8; stroke: #6b7f94; }
.inner { fill: #ffffff; stroke: #9aabbc; }
.import { fill: none; stroke: #35618f; stroke-width: 1.4; marker-end: url(#head); }
"""


@dataclass
class Box:
    """A rectangle of the picture.

    Attributes
    ----------
    name : str
        Dotted, without the package's own name.
    title, idea : str
        What stands in it.
    rows : list of list of Box
        What it is made of, row by row.
    """

    name: str
    title: str
    idea: str = ""
    rows: list[list[Box]] = field(default_factory=list)
    x: float = 0.0
    y: float = 0.0
    width: float = 0.0
    height: float = 0.0

    def all(self) -> Iterator[Box]:
        """The box and what it is made of."""
        yield self
        for row in self.rows:
            for box in row:
                yield from box.all()


def outer_place(house: House) -> dict[str, str]:
    """The box of each module: its top package, or the module that it stands beside."""
    tops = {name: name.split(".")[1] for name in house.docs if name != PACKAGE}
    beside = _beside(house)
    return {name: HOME if top in beside else top for name, top in tops.items() if top != ENTRY}


def _beside(house: House) -> list[str]:
    """The modules of the package itself that are in no layer."""
    layered = {name for layer in house.layers for name in layer}
    loose = [name for name in house.modules(PACKAGE) if name not in layered]
    return sorted(name.rpartition(".")[2] for name in loose if name != f"{PACKAGE}.{ENTRY}")


def inner_place(house: House, package: str) -> dict[str, str]:
    """The inner box of each module of a package: its folder; of a few loose ones each its own."""
    whole = f"{PACKAGE}.{package}"
    folders = [name for name in house.packages if name.startswith(whole + ".")]
    if not folders:
        return {}
    loose = house.modules(whole)
    place = {name: house.folder(name) for name in house.docs if house.folder(name) in folders}
    place |= {name: name if len(loose) <= FEW else f"{whole}.{OWN}" for name in loose}
    return {name: box.removeprefix(PACKAGE + ".") for name, box in place.items()}


def arrows(house: House) -> list[tuple[str, str]]:
    """All arrows of the picture: between packages, then between the parts of each package."""
    found = reduced(house.between(outer_place(house)))
    for package in sorted(set(outer_place(house).values())):
        found |= reduced(house.between(inner_place(house, package)))
    return sorted(found)


def boxes(house: House) -> list[Box]:
    """The boxes of all packages, placed."""
    layers = [[name.rpartition(".")[2] for name in layer] for layer in house.layers]
    y, found = float(MARGIN), []
    for layer in layers:
        row = [_package(house, name) for name in layer]
        for box, (left, right) in zip(row, _columns(layer), strict=True):
            _place(box, left, y, right - left)
        y += max(box.height for box in row) + BETWEEN_LAYERS
        found += row
    return found


def _columns(layer: Sequence[str]) -> list[tuple[float, float]]:
    """Left and right edges, shares of the row where the layout does not know all of its boxes."""
    if all(name in COLUMNS for name in layer):
        return [COLUMNS[name] for name in layer]
    share = WIDTH / len(layer)
    return [(i * share + MARGIN, (i + 1) * share - MARGIN) for i in range(len(layer))]


def _package(house: House, name: str) -> Box:
    whole = f"{PACKAGE}.{name}"
    beside = _beside(house) if name == HOME else []
    idea = f"{house.docs[whole].rstrip('.')}" + (f"; with {', '.join(beside)}" if beside else "")
    graph = house.between(inner_place(house, name))
    return Box(name, name, idea, [[_part(house, part) for part in row] for row in _ranked(graph)])


def _part(house: House, name: str) -> Box:
    part = name.partition(".")[2]
    if part == OWN:
        return Box(name, "its own files")
    return Box(name, part.replace(".", "/") + ("/" if f"{PACKAGE}.{name}" in house.packages else ""))


def _ranked(graph: Graph) -> list[list[str]]:
    """Nodes in rows, each above all that it imports; circles in one row."""
    if not graph:
        return []
    group = circles(graph)
    below = {node: reachable(graph, node) - group[node] for node in graph}
    rank: dict[str, int] = {}
    for node in sorted(graph, key=lambda n: len(below[n])):
        same = [rank[o] for o in group[node] if o in rank]
        rank[node] = same[0] if same else 1 + max((rank[o] for o in below[node]), default=-1)
    rows: dict[int, list[str]] = defaultdict(list)
    for node in sorted(graph):
        rows[rank[node]].append(node)
    return [_hub_in_the_middle(rows[r], graph) for r in sorted(rows, reverse=True)]


def _hub_in_the_middle(row: list[str], graph: Graph) -> list[str]:
    """A row in which the node that most others of the row import stands among them."""
    hub = max(row, key=lambda node: sum(node in graph[other] for other in row))
    others = [node for node in row if node != hub]
    half = (len(others) + 1) // 2 if any(hub in graph[other] for other in others) else 0
    return [*others[:half], hub, *others[half:]] if half else row


def _place(box: Box, x: float, y: float, width: float) -> None:
    """Put a box and what it is made of in place; its height follows."""
    box.x, box.y, box.width = x, y, width
    top = y + TITLE + SMALL * len(_lines(box)) + 4
    for number, row in enumerate(box.rows):
        top += GAP if number else 6
        share = (width - 2 * MARGIN + GAP) / len(row)
        for i, part in enumerate(row):
            wide = min(share - GAP, 230.0)
            part.x, part.y = x + MARGIN + i * share + 0.5 * (share - GAP - wide), top
            part.width, part.height = wide, ROW
        top += ROW
    box.height = top + (MARGIN if box.rows else 6) - y


def drawn(house: House) -> str:
    """The picture as the text of an SVG file."""
    outer = boxes(house)
    known = {box.name: box for one in outer for box in one.all()}
    height = max(box.y + box.height for box in outer) + MARGIN
    size = f'width="{WIDTH}" height="{height:.0f}"'
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:.0f}" {size}>',
        "<title>The packages of contwalk, and which import which</title>",
        f"<style>{STYLE}</style>",
        '<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="6" markerHeight="6" '
        'orient="auto"><path d="M0,0 L8,4 L0,8 z" fill="#35618f"/></marker></defs>',
        f'<rect {size} fill="#ffffff"/>',
    ]
    for box in outer:
        lines += _rectangle(box, "outer")
        lines += [line for row in box.rows for part in row for line in _rectangle(part, "inner")]
    lines += _paths(arrows(house), known)
    return "\n".join([*lines, "</svg>", ""])


def _rectangle(box: Box, kind: str) -> list[str]:
    place = f'x="{box.x:.0f}" y="{box.y:.0f}" width="{box.width:.0f}" height="{box.height:.0f}"'
    middle, top = box.x + 0.5 * box.width, box.y + TITLE - 4
    if kind == "inner":
        return [
            f'<g class="box" data-name={quoteattr(box.name)}><rect class="inner" rx="4" {place}/>',
            f'<text x="{middle:.0f}" y="{box.y + 0.65 * ROW:.0f}" text-anchor="middle">',
            f"{escape(box.title)}</text>",
            "</g>",
        ]
    lines = [
        f'<g class="box" data-name={quoteattr(box.name)}><rect class="outer" rx="7" {place}/>',
        f'<text class="name" x="{middle:.0f}" y="{top:.0f}" text-anchor="middle">{escape(box.title)}</text>',
    ]
    for number, text in enumerate(_lines(box), start=1):
        y = top + SMALL * number + 3
        lines.append(
            f'<text class="idea" x="{middle:.0f}" y="{y:.0f}" text-anchor="middle">{escape(text)}</text>'
        )
    return [*lines, "</g>"]


def _lines(box: Box) -> list[str]:
    """What stands in a box below its title, in lines that it is wide enough for."""
    return textwrap.wrap(box.idea, int((box.width - MARGIN) / LETTER))


def _paths(found: Sequence[tuple[str, str]], known: Mapping[str, Box]) -> Iterator[str]:
    """The arrows, each from the edge of who imports to the edge of what is imported that faces it."""
    ports = _ports(found, known)
    for a, b in found:
        one, other = known[a], known[b]
        if one.y == other.y:
            way = _sideways(one, other)
        else:
            x0, x1, y0, y1 = ports[a, b, 0], ports[a, b, 1], one.y + one.height, other.y
            if y0 > y1:  # what is in no layer may be drawn higher than who imports it
                y0, y1 = one.y, other.y + other.height
            bend = max(-60.0, min(0.6 * (y1 - y0), 60.0))
            way = f"M{x0:.0f},{y0:.0f} C{x0:.0f},{y0 + bend:.0f} {x1:.0f},{y1 - bend:.0f} {x1:.0f},{y1:.0f}"
        yield f'<path class="import" data-from={quoteattr(a)} data-to={quoteattr(b)} d="{way}"/>'


def _sideways(one: Box, other: Box) -> str:
    """Between neighbours in a row: the two directions beside each other."""
    right = other.x > one.x
    y = one.y + (0.38 if right else 0.62) * one.height
    x0, x1 = (one.x + one.width, other.x) if right else (one.x, other.x + other.width)
    return f"M{x0:.0f},{y:.0f} L{x1:.0f},{y:.0f}"


def _ports(found: Sequence[tuple[str, str]], known: Mapping[str, Box]) -> dict[tuple[str, str, int], float]:
    """Where arrows leave and arrive, spread along the edges in the order of where they go."""
    at: dict[tuple[str, str, int], float] = {}
    for end in (0, 1):
        edges: dict[str, list[tuple[str, str]]] = defaultdict(list)
        for pair in found:
            if known[pair[0]].y != known[pair[1]].y:
                edges[pair[end]].append(pair)
        for name, pairs in edges.items():
            box = known[name]
            far = sorted(pairs, key=lambda pair: _middle(known[pair[1 - end]]))
            for i, pair in enumerate(far):
                at[*pair, end] = _near(box, known[pair[1 - end]], (i + 1) / (len(far) + 1))
    return at


def _middle(box: Box) -> float:
    return box.x + 0.5 * box.width


def _near(box: Box, other: Box, share: float) -> float:
    """A place on the edge of a box: straight above or below the other where it can be, else by its share."""
    low, high = max(box.x, other.x), min(box.x + box.width, other.x + other.width)
    if high - low < 20.0:  # the end of the edge that is nearer
        part = 0.15 * box.width
        low = box.x + box.width - part if other.x > box.x else box.x
        high = low + part
    return low + share * (high - low)
