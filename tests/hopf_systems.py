"""Random systems with a Hopf point at lam = 1 and all orders of states that follow the cycle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from small_systems import small_system

from contwalk.system import System

# How a state is driven: to first, second, third order of the amplitude; by what follows with the square.
DRIVES = ("u", "u * v", "1 - np.cos(u)", "u**3", "w**2", "u * w")


@dataclass(frozen=True)
class HopfSystem:
    """A system, its equilibrium at lam = 0.8, and its equations as they stand."""

    system: System
    start: np.ndarray
    equations: str


def hopf_system(seed: int) -> HopfSystem:
    """2 to 5 states: a pair that oscillates, others that follow it; cubic or trigonometric, in several units.

    y_i = x_i / unit - place - way (lam - 1) are the deviations from an equilibrium that may move. Feedback
    from the states that follow makes some of the Hopf points sub-, others supercritical.
    """
    rng = np.random.default_rng(seed)
    n, cubic = int(rng.integers(2, 6)), rng.choice([-1.0, 1.0]) * rng.uniform(0.3, 2.0)
    rate = 10.0 ** rng.uniform(-2.0, 2.0) if rng.random() < 0.5 else 1.0
    # Powers of two and quarters, and only the last state moves: the others are exactly zero at rest.
    units = np.where(rng.random(n) < 0.4, 2.0 ** rng.integers(-13, 14, n), 1.0)
    places = np.where(rng.random(n) < 0.4, 0.25 * rng.integers(-8, 9, n), 0.0)
    ways = np.where((rng.random(n) < 0.5) & (np.arange(n) > 1) & (np.arange(n) == n - 1), 0.5, 0.0)
    lines = [f"y{i} = x[{i}] / {units[i]} - {places[i]} - {ways[i]} * (p.lam - 1.0)" for i in range(n)]
    bends = (
        ["y0 * (y0**2 + y1**2)", "y1 * (y0**2 + y1**2)"],
        ["y0**3", "y1**3"],
        ["6.0 * (y0 - np.sin(y0))", "6.0 * (y1 - np.sin(y1))"],
    )[int(rng.integers(0, 3))]
    for k, turned in enumerate(("- y1", "+ y0")):
        more = f"{rng.uniform(-0.3, 0.3)} * y0 * y1"
        if n > 2 and rng.random() < 0.5:
            more += f" + {rng.uniform(-0.5, 0.5)} * y{k} * y{rng.integers(2, n)}"
        growth = f"(p.lam - 1.0) * y{k} {turned} + {cubic} * ({bends[k]}) + {more}"
        lines.append(f"dx[{k}] = {rate * units[k]} * ({growth})")
    for i in range(2, n):
        own = rng.uniform(-3.0, -0.1) if rng.random() < 0.85 else 0.5
        names = {"u": f"y{rng.integers(0, 2)}", "v": f"y{rng.integers(0, 2)}", "w": f"y{rng.integers(0, i)}"}
        drive = " ".join(names.get(word, word) for word in _words(DRIVES[int(rng.integers(0, len(DRIVES)))]))
        lines.append(
            f"dx[{i}] = {rate * units[i]} * ({own} * y{i} + {10.0 ** rng.uniform(-3.0, 1.0)} * ({drive}))"
        )
    names_: dict[str, object] = {"np": np}
    body = "\n".join(f"    {line}" for line in lines)
    exec(f"def field(t, x, p, dx):\n{body}\n", names_)
    system = small_system(names_["field"], [f"x{i}" for i in range(n)], {"lam": 0.8})
    return HopfSystem(system, units * (places - 0.2 * ways), body)


def _words(drive: str) -> list[str]:
    """A drive cut at its variables."""
    for name in "uvw":
        drive = drive.replace(name, f" {name} ")
    return [word for word in drive.split(" ") if word]
