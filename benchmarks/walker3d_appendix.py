"""Paper 8, appendix 6.2 and Table I: margins of the two 3D walkers beside the printed ones, as tables.

    python benchmarks/walker3d_appendix.py --overlap walker3d_overlap_margins.h5 \\
        --no-overlap walker3d_no_overlap_margins.h5

`contwalk margins` of runs/walker3d_overlap.yaml and runs/walker3d_no_overlap.yaml writes these files; several
of one walker, of other instants, may be given. `walker3d_appendix.csv` has the 420 printed numbers, without
their signs; p1 to p8 are called q11 to q18 in the appendix.

The printed column of the walker with overlapping feet, pushed down, is the mean of both walkers' margins (see
docs/studies/walker3d.md); `meant` undoes that.
"""

from __future__ import annotations

import argparse
import csv
import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np

from contwalk.storage.trajectory import read_margins

PRINTED = Path(__file__).with_suffix(".csv")
CONFIGURATIONS = range(5)
OVERLAP, NO_OVERLAP, UP, DOWN = "overlap", "no_overlap", "up", "down"

# Table I: states, and the mean, the deviation and the median of the ratios that are printed.
TABLE_1 = {
    "height": (("q2",), (7.7, 2.3, 5.4)),
    "orientation": (("q5", "q6"), (8.9, 1.1, 8.6)),
    "leg angles": (("q7", "q8", "q9", "q10"), (3.0, 1.5, 2.7)),
    "toe positions, lateral": (("p1", "p3", "p5", "p7"), (13.5, 1.5, 12.0)),
    "toe positions, sagittal": (("p2", "p4", "p6", "p8"), (9.0, 2.1, 11.9)),
    "velocity of the hip": (("u1", "u2", "u3"), (7.0, 1.2, 7.1)),
    "angular velocities of the hip line": (("u5", "u6"), (1.2, 1.3, 1.2)),
    "angular velocities of the legs": (("u7", "u8", "u9", "u10"), (2.4, 1.5, 2.2)),
}
ALL = ("all but u4", (4.5, 1.1, 4.6))

Key = tuple[str, int, str, str]  # walker, configuration, state, sign
Margins = dict[Key, float]


def printed_margins() -> Margins:
    """The appendix as it is printed."""
    found = {}
    with PRINTED.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            for walker in (OVERLAP, NO_OVERLAP):
                for sign in (UP, DOWN):
                    key = walker, int(row["configuration"]), row["state"], sign
                    found[key] = float(row[f"{walker}_{sign}"])
    return found


def meant(printed: Margins) -> Margins:
    """The appendix with the one column of which means are printed told from them."""

    def of(key: Key) -> float:
        walker, configuration, state, sign = key
        if (walker, sign) != (OVERLAP, DOWN):
            return printed[key]
        return 2.0 * printed[key] - printed[NO_OVERLAP, configuration, state, DOWN]

    return {key: of(key) for key in printed}


def computed_margins(walker: str, files: Iterable[str]) -> tuple[Margins, set[Key]]:
    """Borders of databases, and which rays have several."""
    found, several = {}, set()
    for file in files:
        for row in read_margins(file).rows:
            key = walker, round(5 * row["fraction"]), row["state"], UP if row["sign"] > 0 else DOWN
            found[key] = math.nan if row["border"] is None else row["border"]
            if row["several"]:
                several.add(key)
    return found, several


def ratios_of_ranges(margins: Margins, states: Sequence[str]) -> tuple[float, float, float]:
    """Mean, deviation and median over the configurations by the paper's formulas (3) and (4)."""
    means = []
    for configuration in CONFIGURATIONS:
        logarithms = []
        for state in states:
            if (OVERLAP, configuration, state, UP) not in margins:
                continue
            overlap, other = (
                margins[walker, configuration, state, UP] + margins[walker, configuration, state, DOWN]
                for walker in (OVERLAP, NO_OVERLAP)
            )
            logarithms.append(math.log(overlap / other))
        means.append(float(np.mean(logarithms)))
    return math.exp(np.mean(means)), math.exp(np.std(means, ddof=1)), math.exp(np.median(means))


def groups() -> Iterable[tuple[str, tuple[str, ...], tuple[float, float, float]]]:
    """Rows of Table I: name, states, printed numbers."""
    for name, (states, numbers) in TABLE_1.items():
        yield name, states, numbers
    yield ALL[0], tuple(state for states, _ in TABLE_1.values() for state in states), ALL[1]


def table_1(columns: dict[str, Margins]) -> Iterable[str]:
    """Table I as printed, and as it follows from margins."""
    yield "| | " + " | ".join(("printed", *columns)) + " |"
    yield "|---" * (len(columns) + 2) + "|"
    for name, states, numbers in groups():
        shown = [numbers, *(ratios_of_ranges(margins, states) for margins in columns.values())]
        yield f"| {name} | " + " | ".join(", ".join(f"{x:.1f}" for x in three) for three in shown) + " |"


def share(ratios: np.ndarray, near: Callable[[np.ndarray], np.ndarray]) -> str:
    return f"{100.0 * float(np.mean(near(ratios))):.0f} %"


def summary(name: str, computed: Margins, reference: Margins, keys: Sequence[Key]) -> str:
    """Median of the ratios and shares that are near; one digit is a unit of the last printed place."""
    keys = [key for key in keys if math.isfinite(computed.get(key, math.nan))]
    ratios = np.array([computed[key] / reference[key] for key in keys])
    digit = np.array([abs(computed[key] - reference[key]) <= 1.0e-4 for key in keys])
    cells = [
        name,
        str(len(keys)),
        f"{np.median(ratios):.3f}",
        f"{100.0 * float(np.mean((np.abs(ratios - 1.0) <= 0.05) | digit)):.0f} %",
        share(ratios, lambda r: np.abs(r - 1.0) <= 0.1),
        share(ratios, lambda r: (r >= 0.5) & (r <= 2.0)),
    ]
    return "| " + " | ".join(cells) + " |"


def whole_table(walker: str, computed: Margins, several: set[Key], reference: Margins) -> Iterable[str]:
    """All numbers of a walker; a star marks a ray with several borders."""
    printed, corrected = printed_margins(), walker == OVERLAP
    heads = ["state", "configuration", "up, printed", "up", "down, printed", *["meant"] * corrected, "down"]
    yield "| " + " | ".join(heads) + " |"
    yield "|---" * len(heads) + "|"
    states = list(dict.fromkeys(key[2] for key in printed))
    for state in states:
        for configuration in CONFIGURATIONS:
            up, down = ((walker, configuration, state, sign) for sign in (UP, DOWN))
            if up not in printed:
                continue
            shown = [f"{computed.get(k, math.nan):.3g}" + "*" * (k in several) for k in (up, down)]
            cells = [state, str(configuration), f"{printed[up]:.4f}", shown[0], f"{printed[down]:.4f}"]
            cells += [f"{reference[down]:.4f}"] * corrected + [shown[1]]
            yield "| " + " | ".join(cells) + " |"


def main() -> None:
    """Print the tables of the study's page."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--overlap", nargs="+", default=[], metavar="X_margins.h5")
    parser.add_argument("--no-overlap", nargs="+", default=[], metavar="X_margins.h5")
    given = parser.parse_args()
    printed = printed_margins()
    corrected = meant(printed)
    computed: Margins = {}
    several: set[Key] = set()
    for walker, files in ((OVERLAP, given.overlap), (NO_OVERLAP, given.no_overlap)):
        found, more = computed_margins(walker, files)
        computed |= found
        several |= more
    print(
        "| | numbers | median | within 5 % or a digit | within 10 % | within a factor of 2 |\n"
        + "|---" * 6
        + "|"
    )
    for walker in (OVERLAP, NO_OVERLAP):
        for sign in (UP, DOWN):
            keys = [key for key in printed if key[0] == walker and key[3] == sign and key in computed]
            if not keys:
                continue
            print(summary(f"{walker}, {sign}, as printed", computed, printed, keys))
            if (walker, sign) == (OVERLAP, DOWN):
                print(summary(f"{walker}, {sign}, as meant", computed, corrected, keys))
    columns = {"the printed appendix": printed, "the same, with what the means are of": corrected}
    if all(key in computed for key in printed):
        columns["computed here"] = computed
    print("\n" + "\n".join(table_1(columns)))
    for walker in (OVERLAP, NO_OVERLAP):
        print("\n" + "\n".join(whole_table(walker, computed, several, corrected)))


if __name__ == "__main__":
    main()
