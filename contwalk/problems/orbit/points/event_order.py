"""Changes of the order of events (OC): two happen at once, or a segment comes to last no time."""

from __future__ import annotations

from contwalk.problems.orbit.points.limit import OrbitLimit


class EventOrder(OrbitLimit):
    """Two events happen at once."""

    label, reason = "OC", "order_change"
    # Two that coincide are two sides of one change of order.
    shared = True
