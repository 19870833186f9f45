"""The field's labels of special points, and what they mean."""

from __future__ import annotations

from collections import ChainMap

# What the engine itself tells of a branch: where it ends, and what the user asked for.
END, MARK = "EP", "UZ"
# What the problem of a curve in two parameters is called; under which name it tells where it was looked for.
LOCUS, RANGES = "locus", "ranges"

MEANINGS = {
    "EP": "end point",
    "UZ": "marked value",
    "LP": "fold",
    "BP": "branch point",
    "HB": "Hopf point",
    "PD": "period doubling",
    "NS": "Neimark-Sacker point",
    "GR": "grazing",
    "OC": "event-order change",
    "AZ": "admissibility limit",
    "BE": "boundary equilibrium",
}

# What a row, a line or a region is called whose stability is not known.
UNDECIDED = "stability not known"

# Those of equilibria at which the number of unstable directions, or of solutions, changes.
BORDERS = ("LP", "HB", "BP")
# Those at which branches of the same kind of solutions cross.
CROSSINGS = frozenset({"BP"})

# Special points of curves in two parameters.
OF_LOCI = {
    "CP": "cusp",
    "BT": "Bogdanov-Takens point",
    "GH": "generalized Hopf point",
    "ZH": "zero-Hopf point",
    "HH": "double Hopf point",
    "CPC": "cusp of cycles",
    "GPD": "generalized period doubling",
    "CH": "Chenciner point",
    "R1": "resonance 1:1",
    "R2": "resonance 1:2",
    "R3": "resonance 1:3",
    "R4": "resonance 1:4",
    "LPPD": "fold and period doubling",
    "LPNS": "fold and torus",
    "PDNS": "period doubling and torus",
    "NSNS": "two tori",
    "GRLP": "grazing at a fold",
    "GRPD": "grazing at a period doubling",
    "GRNS": "grazing at a torus",
    "GRGR": "two grazings",
    "GRD": "grazing with no second rate",
}
EVERY_MEANING = ChainMap(OF_LOCI, MEANINGS)  # in the order of the second, then of the first

# What is done at limits, and the points whose branches are followed, where nothing is said of that.
AT_LIMITS = {"GR": "stop", "OC": "switch", "AZ": "ignore", "BE": "stop"}
FOLLOWED = frozenset({"BP"})
