"""The field's labels of special points, and what they mean."""

from __future__ import annotations

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
}
