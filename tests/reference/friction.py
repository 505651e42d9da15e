"""Free masses with Coulomb friction in their gap, with 80 digits.

Usage: friction.py > friction.json

The motion between two events is a power series of 48 terms over steps of 1/4, whose first dropped
term is below 1e-75. An event is a zero of a polynomial (the gap velocity, the distance to the wall
ahead, what friction can still carry), looked for in steps that a bound on its second derivative
proves free of zeros: from a value p that changes at the rate p', there is none before
p + p' t - B t^2/2 = 0. A zero at the start is divided out. A chatter is followed one by one down to
rebounds of 1e-17; what is left lasts (1/P + 1/sqrt(P Q)) u/(1 - e sqrt(Q/P)) but for terms of u^2,
P and Q the accelerations towards the wall on the way out and back. Needs mpmath.
"""

from __future__ import annotations

import json
import random
import sys
from collections.abc import Callable
from typing import Any

from mpmath import cos, factorial, mp, mpf, pi, sqrt

mp.dps = 80
TERMS = 48
STEP = mpf(1) / 4
KEPT = 30
CHANGE = mpf("1e-20")
NEGLIGIBLE = mpf("1e-66")
# Impacts of a chatter that ends in stick are kept above this approach speed.
FLOOR = mpf("1e-6")
NUMBERS = ["mu", "e", "gamma", "zeta", "R", "G", "F", "Omega", "x", "v", "y", "w"]

SCENES: dict[str, dict[str, Any]] = {
    "decay": {
        "mu": "0.1", "e": "0.7", "gamma": "0.4", "zeta": "0.01", "R": "0.03", "G": "0",
        "F": "0", "Omega": "1", "x": "1", "v": "0", "y": "0", "w": "0", "tau_end": "40",
    },
    "driven": {
        "mu": "0.08", "e": "0.6", "gamma": "0.9", "zeta": "0.03", "R": "0.25", "G": "0",
        "F": "0.05", "Omega": "0.93", "x": "0.2", "v": "0.1", "y": "0.1", "w": "0.7",
        "tau_end": "40",
    },
    "incline": {
        "mu": "0.15", "e": "0.5", "gamma": "0.3", "zeta": "0.02", "R": "0.06", "G": "0.2",
        "F": "0.04", "Omega": "1.1", "x": "0.5", "v": "0", "y": "0", "w": "0.4", "tau_end": "40",
    },
    "chatter": {
        "mu": "0.12", "e": "0.6", "gamma": "0.05", "zeta": "0.02", "R": "0.02", "G": "0",
        "F": "0", "Omega": "1", "x": "1", "v": "0", "y": "0.02", "w": "-0.1", "tau_end": "7",
    },
}  # fmt: skip


def value(row: list[Any], t: Any, order: int = 0) -> Any:
    """Return a derivative of a polynomial at t."""
    total = mpf(0)
    for n in range(len(row) - 1, order - 1, -1):
        factor = mpf(1)
        for k in range(order):
            factor *= n - k
        total = total * t + factor * row[n]
    return total


def first_zero(row: list[Any], length: Any, known: int = 0) -> Any:
    """Return the first zero of a polynomial positive at first, of which `known` zeros are at 0."""
    row = row[known:]
    bound = sum(abs(row[n]) * n * (n - 1) * length ** (n - 2) for n in range(2, len(row)))
    t = mpf(0)
    while t < length:
        now, rate = value(row, t), value(row, t, 1)
        if now <= 0:
            return t
        root = sqrt(rate**2 + 2 * bound * now)
        step = (rate + root) / bound if rate >= 0 else 2 * now / (root - rate)
        if step < NEGLIGIBLE:
            return t
        t += step
    return None


class Scene:
    """A mass on its structure at an instant."""

    def __init__(self, scene: dict[str, Any], changed: Callable[[Any], Any], lowest: Any) -> None:
        self.n = {key: changed(mpf(scene[key])) for key in NUMBERS}
        self.x, self.v, self.y, self.w = (self.n[key] for key in "xvyw")
        self.t, self.end, self.lowest = mpf(0), mpf(scene["tau_end"]), lowest
        self.events: list[dict[str, Any]] = []

    def tell(self, kind: str, side: int, t: Any = None, v: Any = None, w: Any = None) -> None:
        """List an event."""
        t = self.t if t is None else t
        v = self.v if v is None else v
        row = {"kind": kind, "side": side, "tau": t, "v_main": v, "gap": self.y}
        self.events.append(row | {"approach": mpf(0) if w is None else w})

    def rows(self, s: int, rides: bool) -> tuple[list[Any], list[Any]]:
        """Return the series of x and y, sliding in the direction s or riding."""
        n = self.n
        mass, load = (1 + n["mu"], mpf(0)) if rides else (mpf(1), n["G"] + s * n["R"])
        x = [self.x, self.v]
        angle = n["Omega"] * self.t
        for k in range(TERMS):
            force = n["mu"] * load if k == 0 else mpf(0)
            if n["F"] != 0:
                force += n["F"] * n["Omega"] ** k * cos(angle + k * pi / 2) / factorial(k)
            pulled = force - 2 * n["zeta"] * (k + 1) * x[k + 1] - x[k]
            x.append(pulled / (mass * (k + 1) * (k + 2)))
        y = [self.y, self.w] + [-it for it in x[2:]]
        if not rides:
            y[2] -= load / 2
        return x, y

    def acceleration(self, s: int) -> Any:
        """Return the gap acceleration of a slide in the direction s."""
        return 2 * self.rows(s, rides=False)[1][2]

    def move(self, x: list[Any], y: list[Any] | None, h: Any) -> None:
        """Go on by h."""
        self.x, self.v, self.t = value(x, h), value(x, h, 1), self.t + h
        if y is not None:
            self.y, self.w = value(y, h), value(y, h, 1)

    def run(self) -> None:
        """Find all events."""
        mode, known = self.decide(), 1
        if self.w != 0:
            mode, known = ("slide", 1 if self.w > 0 else -1), 0
        while self.t < self.end:
            length = min(STEP, self.end - self.t)
            kind, s = mode
            x, y = self.rows(s, rides=kind != "slide")
            if kind == "slide":
                mode, known = self.slide(x, y, s, length, known)
            else:
                mode, known = self.rest(x, kind, s, length)
        self.events.sort(key=lambda it: it["tau"])

    def decide(self) -> tuple[str, int]:
        """Return how a mass at rest in its gap goes on."""
        for s in (1, -1):
            if s * self.acceleration(s) > 0:
                return "slide", s
        return "held", 0

    def slide(
        self, x: list[Any], y: list[Any], s: int, length: Any, known: int
    ) -> tuple[tuple[str, int], int]:
        """Slide to the next event."""
        speed = [s * (n + 1) * y[n + 1] for n in range(len(y) - 1)]
        stop = first_zero(speed, length, known)
        left = [self.n["gamma"] - s * y[0]] + [-s * it for it in y[1:]]
        wall = first_zero(left, length if stop is None else stop)
        if wall is not None:
            self.move(x, y, wall)
            self.y = s * self.n["gamma"]
            return self.impact(s)
        self.move(x, y, length if stop is None else stop)
        if stop is None:
            return ("slide", s), 0
        self.w = mpf(0)
        mode = self.decide()
        self.tell("held" if mode[0] == "held" else "turned", s)
        return mode, 1

    def impact(self, s: int) -> tuple[tuple[str, int], int]:
        """Strike the wall s."""
        n = self.n
        self.tell("impact", s, w=self.w)
        self.v += n["mu"] * (1 + n["e"]) / (1 + n["mu"]) * self.w
        self.w *= -n["e"]
        speed = -s * self.w
        # Towards the wall, on the way out and back.
        out, back = s * self.acceleration(-s), s * self.acceleration(s)
        if speed > self.lowest or back <= 0:
            return ("slide", -s), 0
        rest = (1 / out + 1 / sqrt(out * back)) * speed / (1 - n["e"] * sqrt(back / out))
        self.v += n["mu"] / (1 + n["mu"]) * self.w
        self.w = mpf(0)
        self.events = [it for it in self.events if self.stays(it, s)]
        x, _ = self.rows(0, rides=True)
        self.tell("stick", s, t=self.t + rest, v=value(x, rest, 1))
        return ("wall", s), 0

    def stays(self, event: dict[str, Any], side: int) -> bool:
        """Return whether an event stays in the list after a chatter on a wall."""
        chatters = ("impact", "turned")
        rest = [it for it in self.events if it["side"] != side and it["kind"] == "impact"]
        rest += [it for it in self.events if it["kind"] not in chatters]
        # Of a chatter the impacts are listed, its turns are not.
        begun = [
            it["tau"]
            for it in self.events
            if it["kind"] == "impact" and it["tau"] > max([r["tau"] for r in rest], default=-1)
        ]
        if not begun or event["tau"] < begun[0]:
            return True
        return event["kind"] == "impact" and abs(event["approach"]) > FLOOR

    def rest(self, x: list[Any], kind: str, s: int, length: Any) -> tuple[tuple[str, int], int]:
        """Ride to the next event."""
        bend = [(n + 1) * (n + 2) * x[n + 2] for n in range(len(x) - 2)]
        bend[0] += self.n["G"]
        found = []
        for off in (-s,) if kind == "wall" else (1, -1):
            carried = [off * it for it in bend]
            carried[0] += self.n["R"]
            zero = first_zero(carried, length)
            if zero is not None:
                found.append((zero, off))
        if not found:
            self.move(x, None, length)
            return (kind, s), 0
        zero, off = min(found)
        self.move(x, None, zero)
        self.tell("release" if kind == "wall" else "slips", s if kind == "wall" else off)
        return ("slide", off), 2


def listed(scene: dict[str, Any]) -> dict[str, Any]:
    """Return a scene with its events and the condition of each."""
    exact = Scene(scene, lambda number: number, mpf("1e-17"))
    exact.run()
    draws = []
    for seed in range(3):
        draw = random.Random(seed).uniform
        by = lambda it, draw=draw: it * (1 + draw(-1, 1) * CHANGE)  # noqa: E731
        drawn = Scene(scene, by, mpf("1e-12"))
        drawn.run()
        draws.append(drawn.events)
    rows: list[dict[str, Any]] = []
    for index, event in enumerate(exact.events):
        row = {key: mp.nstr(event[key], KEPT) for key in ("tau", "v_main", "gap", "approach")}
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
