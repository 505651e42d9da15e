"""Free masses whose restitution depends on the approach speed, with 120 digits.

Usage: restitution.py > restitution.json

A flight is in closed form: the structure is a damped oscillator, the mass moves uniformly. A wall
is looked for in steps that a bound on x'' proves free of contacts: from a distance D that shrinks
with the rate -D', no wall is met before D + D' t - M t^2/2 = 0. Such steps come up to a contact
from below, in the end as fast as Newton's. A chatter is followed one by one: with a power law
down to rebounds of 1e-13, with a table to 1e-40. What is left of it lasts 2 S/A, with S = u/(1 -
e) or (u/g) (1/(1 - b) - b g/2 - b g^2/6), g = 1 - e, which is right to a share of g^3, some 1e-8
of 1e-10. Then the mass sticks with the common momentum, until x + 2 zeta x' = 0. Needs mpmath.
"""

from __future__ import annotations

import itertools
import json
import random
import sys
from collections.abc import Callable
from typing import Any

from mpmath import cos, exp, mp, mpf, sin, sqrt

mp.dps = 120
KEPT = 30
CHANGE = mpf("1e-20")
NEGLIGIBLE = mpf("1e-70")
# Impacts of a chatter that ends in stick are kept above this approach speed.
FLOOR = mpf("1e-6")
# Where chatters are cut off that only tell the condition of later events.
ROUGH = mpf("1e-11")

SCENES: dict[str, dict[str, Any]] = {
    "power": {
        "mu": "0.1", "gamma": "0.05", "zeta": "0.02", "tau_end": "3",
        "law": "power", "numbers": ["0.7"], "exponent": [1, 5],
    },
    "plastic": {
        "mu": "0.15", "gamma": "0.02", "zeta": "0.03", "tau_end": "8",
        "law": "plastic", "numbers": ["0.02"],
    },
    "table": {
        "mu": "0.12", "gamma": "0.05", "zeta": "0.01", "tau_end": "12",
        "law": "table", "numbers": ["0.01", "0.75", "0.1", "0.6", "0.3", "0.65", "1.5", "0.2"],
    },
}  # fmt: skip


class Structure:
    """The motion of m x'' + 2 zeta x' + x = 0 from a state."""

    def __init__(self, mass: Any, zeta: Any, x: Any, v: Any) -> None:
        self.decay = zeta / mass
        self.stiffness = 1 / mass
        self.omega = sqrt(self.stiffness - self.decay**2)
        self.cosine, self.sine = x, (v + self.decay * x) / self.omega
        # x^2/m + x'^2 never grows.
        self.size = sqrt(self.stiffness * x**2 + v**2)

    def at(self, t: Any) -> tuple[Any, Any]:
        """Return x and x' after a time."""
        c, s, faded = cos(self.omega * t), sin(self.omega * t), exp(-self.decay * t)
        x = faded * (self.cosine * c + self.sine * s)
        turned = faded * self.omega * (self.sine * c - self.cosine * s)
        return x, turned - self.decay * x

    def rates(self, x: Any, v: Any) -> list[Any]:
        """Return the derivatives of x of the second to the fourth order."""
        found = [x, v]
        for _ in range(3):
            found.append(-2 * self.decay * found[-1] - self.stiffness * found[-2])
        return found[2:]

    def bound(self, order: int) -> Any:
        """Return a bound on a derivative of x of this order, 2 or more, at all later times."""
        return self.size * (sqrt(self.stiffness) + 2 * self.decay) ** (order - 1)


def safe(value: Any, rate: Any, bound: Any) -> Any:
    """Return how long value + rate t - bound t^2/2 stays positive."""
    if value < 0:
        return mpf(0)
    root = sqrt(rate**2 + 2 * bound * value)
    return (rate + root) / bound if rate >= 0 else 2 * value / (root - rate)


def law(scene: dict[str, Any], numbers: list[Any]) -> Callable[[Any], Any]:
    """Return the restitution as a function of the approach speed."""
    if scene["law"] == "power":
        (a,), (p, q) = numbers, scene["exponent"]
        return lambda u: max(mpf(0), 1 - a * u ** (mpf(p) / q))
    if scene["law"] == "plastic":
        (limit,) = numbers

        def yielding(u: Any) -> Any:
            q = limit / u
            stored = q / (q + 2 * sqrt(mpf(6) / 5 - q**2 / 5))
            return sqrt(6 * sqrt(mpf(3)) / 5 * (1 - q**2 / 6)) * stored ** mpf("0.25")

        return lambda u: yielding(u) if u > limit else mpf(1)
    points = list(zip(numbers[::2], numbers[1::2], strict=True))

    def between(u: Any) -> Any:
        if u <= points[0][0]:
            return points[0][1]
        for (u0, e0), (u1, e1) in itertools.pairwise(points):
            if u < u1:
                return e0 + (e1 - e0) * (u - u0) / (u1 - u0)
        return points[-1][1]

    return between


def run(scene: dict[str, Any], changed: Callable[[Any], Any], lowest: Any) -> list[dict[str, Any]]:
    """Return the events of a scene, with each number of it passed through `changed`."""
    mu, d, zeta = (changed(mpf(scene[key])) for key in ("mu", "gamma", "zeta"))
    restitution = law(scene, [changed(mpf(number)) for number in scene["numbers"]])
    end = mpf(scene["tau_end"])
    x, v, y, w, t = changed(mpf(1)), mpf(0), mpf(0), mpf(0), mpf(0)
    side, share = 0, mu / (1 + mu)
    events: list[dict[str, Any]] = []
    while True:
        # From the last wall touched, or from y = 0.
        motion = Structure(mpf(1), zeta, x, v)
        bound = motion.bound(2)
        x1, w1 = x + y, v + w
        h = mpf(0)
        if side != 0 and w == 0:
            # Released: D = D' = D'' = 0, and D stays positive while t < 4 D'''/M4, and below d.
            grows = 2 * side * motion.rates(x, v)[1] / motion.bound(4)
            h = min(grows, (6 * d / motion.bound(3)) ** (mpf(1) / 3))
        while True:
            now = motion.at(h)
            gap, rate = x1 + w1 * h - now[0], w1 - now[1]
            if h == 0 and side != 0:
                gap = side * d
            steps = {s: safe(d - s * gap, -s * rate, bound) for s in (1, -1)}
            met = min(steps, key=lambda s: steps[s])
            if steps[met] < NEGLIGIBLE:
                break
            h += steps[met]
            if t + h > end:
                return events
        (x, v), t, side = now, t + h, met
        approach = side * rate
        e = restitution(approach)
        events.append(
            {"kind": "impact", "tau": t, "side": side, "v_main": v, "approach": rate},
        )
        v += share * (1 + e) * rate
        y, w = side * d, -e * rate
        pressure = -side * motion.rates(x, v)[0]
        speed = e * approach
        if speed > lowest or pressure <= 0 or scene["law"] == "plastic":
            continue
        g = 1 - restitution(speed) if speed > 0 else mpf(1)
        terms = mpf(1)
        if scene["law"] == "power":
            b = mpf(scene["exponent"][0]) / scene["exponent"][1]
            terms = 1 / (1 - b) - b * g / 2 - b * g**2 / 6
        v += share * w
        rest = 2 * speed / (pressure * g) * terms
        # Released where z = x + 2 zeta x' is 0, which obeys the same equation.
        carried = Structure(1 + mu, zeta, x, v)
        events = [it for it in events if stays(it, events, side)]
        stuck = {"kind": "stick", "tau": t + rest, "side": side, "v_main": carried.at(rest)[1]}
        events.append(stuck | {"approach": mpf(0)})
        z = Structure(1 + mu, zeta, x + 2 * zeta * v, v + 2 * zeta * carried.rates(x, v)[0])
        sign, h = side, mpf(0)
        while True:
            value, rate = z.at(h)
            step = safe(sign * value, sign * rate, z.bound(2))
            if step < NEGLIGIBLE:
                break
            h += step
            if t + h > end:
                return events
        (x, v), t, y, w = carried.at(h), t + h, side * d, mpf(0)
        events.append({"kind": "release", "tau": t, "side": side, "v_main": v, "approach": mpf(0)})


def stays(event: dict[str, Any], events: list[dict[str, Any]], side: int) -> bool:
    """Return whether an event stays in the list after a chatter on a wall."""
    others = [it["tau"] for it in events if it["side"] != side or it["kind"] != "impact"]
    before = event["tau"] <= max(others, default=mpf(-1))
    return before or abs(event["approach"]) > FLOOR


def listed(scene: dict[str, Any]) -> dict[str, Any]:
    """Return a scene with its events and the condition of each."""
    exact = run(scene, lambda number: number, mpf("1e-13" if scene["law"] == "power" else "1e-40"))
    draws = []
    for seed in range(3):
        draw = random.Random(seed).uniform
        draws.append(run(scene, lambda it, by=draw: it * (1 + by(-1, 1) * CHANGE), ROUGH))
    rows: list[dict[str, Any]] = []
    for index, event in enumerate(exact):
        row = {key: mp.nstr(event[key], KEPT) for key in ("tau", "v_main", "approach")}
        same = [drawn[index] for drawn in draws]
        if any(it["kind"] != event["kind"] for it in same):
            raise RuntimeError("events have come or gone")
        moved = float(max(abs(it["tau"] - event["tau"]) for it in same) / CHANGE)
        # That of a stick is the one of the impact before: a draw does not know it so well.
        moved = rows[-1]["condition"] if event["kind"] == "stick" else moved
        rows.append({"kind": event["kind"], "side": event["side"], **row, "condition": moved})
    return {"scene": scene, "events": rows}


if __name__ == "__main__":
    names = sys.argv[1:] or list(SCENES)
    print(json.dumps({name: listed(SCENES[name]) for name in names}, indent=1))
