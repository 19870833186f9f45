"""Names and numbers that a run file may hold, for all who read or write one."""

from __future__ import annotations

from contwalk.labels import END, MARK, MEANINGS

FOLLOWED = tuple(label for label in MEANINGS if label not in (END, MARK))
# Special points that curves are of, and those on curves at which other curves begin.
CURVES = ("LP", "HB", "BP", "PD", "NS", "GR", "OC", "AZ", "UZ")
BORN = (
    "BT",
    "GH",
    "ZH",
    "HH",
    "BP",
    "R1",
    "R2",
    "GPD",
    "LPPD",
    "LPNS",
    "PDNS",
    "NSNS",
    "GRLP",
    "GRPD",
    "GRNS",
    "GRGR",
)
DIAGRAM_FIGURES = (
    "bifurcation_diagram",
    "eigenvalues",
    "multipliers",
    "stability_map",
    "locus",
    "chart",
    "machine",
    "phase_portrait",
    "stick_figure",
)
MOTION_FIGURES = ("time_series", "phase_portrait", "stick_figure")
SAMPLE_FIGURES = ("histogram",)
# each command draws its own
FIGURES = tuple(dict.fromkeys((*DIAGRAM_FIGURES, *MOTION_FIGURES, *SAMPLE_FIGURES)))
LOWEST_ACCURACY = 1e-14  # below it, rounding in double precision decides, not the method
