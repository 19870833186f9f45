"""Where a study of the walker begins: near its printed gait, with feet that may overlap."""

from __future__ import annotations

from contwalk.system import Study

from .model import Model
from .parameters import make_presets

# The printed gait at the inclination 0.08, to its printed digits.
STATE = {
    "q1": 0.0,
    "q3": 0.0,
    "q2": 0.66037,
    "q4": -0.27728,
    "q5": 0.014256,
    "q6": 0.049098,
    "q7": 0.022721,
    "q8": 0.79218,
    "q9": 0.047757,
    "q10": -0.0071645,
    "p5": -0.06593,
    "p6": 0.074855,
    "p7": 0.08406,
    "p8": 0.074581,
    "u1": -0.018026,
    "u2": 0.0016363,
    "u3": 0.12288,
    "u4": 0.00036005,
    "u5": 0.056527,
    "u6": 0.018713,
    "u7": -3.9031,
    "u8": 5.2527,
    "u9": 0.19532,
    "u10": -0.015636,
}


def make_study(model: Model) -> Study | None:
    """Of the walker as it is by default; other model choices have other gaits."""
    if model != Model():
        return None
    start = {"state": STATE, "mode": "swing1_toe21_toe22_knee2", "until": 0}
    values = {**make_presets(model)["overlap"], "alpha": 0.08}
    return Study("alpha", (0.078, 0.0815), {"simulate": start}, values)
