"""Free masses on structures with several modes, to 30 digits: matrix exponentials with mpmath.

Usage: modal.py > modal.json, or modal.py --all for two more scenes, which take minutes with gmpy2

A structure M x'' + C x' + K x = b_f F cos(Omega t + phase), or on a base with the acceleration a_g
= F cos(Omega t + phase) and -M r a_g on the right, carries masses at points u_p = b_p x. In flight
x1'' = 0, or -a_g on a base; with masses stuck to their points M' = M + sum mu b b^T. A motion is
the matrix exponential by the eigenvectors of the first-order system plus the particular solution.
Contacts and releases are approached in steps that a bound on the second derivative of the gap, or
on the rate of the pressure, proves free of them. An impact is Newton's law and momentum; which of
the stuck masses are carried is found by trying all sets, of which exactly one must fit. Chatter is
followed down to 1e-45.

Every number of a scene is a decimal. `condition` is the largest change of an instant, and of the
velocities of an impact, per relative change of all numbers but the duration, in three random draws
of 1e-25.
"""

from __future__ import annotations

import itertools
import json
import random
import sys
from typing import Any

import mpmath as mp

mp.mp.dps = 150
DIGITS = 32
FLOOR = mp.mpf("1e-45")

Scene = dict[str, Any]


def numbers(value: Any, change: Any) -> Any:
    """Turn the decimals of a scene into numbers, changed by a function."""
    if isinstance(value, str):
        return change(mp.mpf(value))
    if isinstance(value, list):
        return [numbers(it, change) for it in value]
    if isinstance(value, dict):
        return {
            key: it if key in {"id", "kind", "point"} else numbers(it, change)
            for key, it in value.items()
        }
    return value


class Flow:
    """The motion of the structure with a set of masses stuck to it."""

    def __init__(self, scene: Scene, stuck: frozenset[int]) -> None:
        n = len(scene["mass"])
        mass, k, c = (mp.matrix(scene[name]) for name in ("mass", "stiffness", "damping"))
        total = mass.copy()
        dragged = mp.zeros(n, 1)
        for i in stuck:
            b = shape(scene, i)
            mu = scene["absorbers"][i]["mass_ratio"]
            total += mu * b * b.T
            dragged += mu * b
        self.inverse = total**-1
        a = mp.zeros(2 * n)
        for i in range(n):
            a[i, n + i] = 1
        for (_name, sign), at in zip((("k", k), ("c", c)), (0, n), strict=True):
            block = self.inverse * sign
            for i in range(n):
                for j in range(n):
                    a[n + i, at + j] = -block[i, j]
        values, vectors = mp.eig(a)
        self.n, self.values, self.vectors = n, values, vectors
        self.back = vectors**-1
        force = scene["force"]
        self.drive = None
        if force is not None:
            omega = force["frequency"]
            if force["kind"] == "base":
                load = -(mass * mp.matrix(force["influence"]) + dragged)
            else:
                load = mp.matrix(scene["points"][force["point"]])
            right = mp.zeros(2 * n, 1)
            block = self.inverse * load
            for i in range(n):
                right[n + i] = force["amplitude"] * mp.expj(force["phase"]) * block[i]
            self.drive = (omega, mp.lu_solve(mp.mpc(0, omega) * mp.eye(2 * n) - a, right))

    def steady(self, t: Any, order: int = 0) -> Any:
        """Return the particular solution, or a derivative of it."""
        if self.drive is None:
            return mp.zeros(2 * self.n, 1)
        omega, z = self.drive
        return (z * (mp.expj(omega * t) * mp.mpc(0, omega) ** order)).apply(mp.re)

    def start(self, z: Any, t: Any) -> Any:
        """Return the coefficients of the eigenvectors."""
        return self.back * (z - self.steady(t))

    def at(self, start: Any, t: Any, h: Any, order: int = 0) -> Any:
        """Return x and x', or a derivative of both, a time h after the start at t."""
        parts = mp.matrix(
            [c * mp.exp(rate * h) * rate**order for c, rate in zip(start, self.values, strict=True)]
        )
        return (self.vectors * parts).apply(mp.re) + self.steady(t + h, order)

    def most(self, start: Any, b: Any, order: int) -> Any:
        """Return a bound on a derivative of b x at all later times."""
        bound = mp.mpf(0)
        for j, rate in enumerate(self.values):
            shape = sum(b[i] * self.vectors[i, j] for i in range(self.n))
            bound += abs(shape * start[j] * rate**order)
        if self.drive is not None:
            omega, z = self.drive
            bound += abs(sum(b[i] * z[i] for i in range(self.n))) * omega**order
        return bound * mp.mpf("1.0001")


def shape(scene: Scene, k: int) -> Any:
    """Return b of the point of an absorber."""
    return mp.matrix(scene["points"][scene["absorbers"][k]["point"]])


class Run:
    """One run of a scene."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.n = len(scene["mass"])
        self.count = len(scene["absorbers"])
        self.flows: dict[frozenset[int], Flow] = {}
        start = scene["start"]
        self.t = mp.mpf(0)
        self.z = mp.matrix([*start["displacements"], *start["velocities"]])
        self.gaps = [list(gap) for gap in start["gaps"]]
        self.stuck: dict[int, int] = {}
        self.shapes = [shape(scene, k) for k in range(self.count)]
        self.free_inverse = mp.matrix(scene["mass"]) ** -1
        self.events: list[dict[str, Any]] = []

    def flow(self) -> Flow:
        """Return the motion with the masses that are stuck now."""
        key = frozenset(self.stuck)
        if key not in self.flows:
            self.flows[key] = Flow(self.scene, key)
        return self.flows[key]

    def base(self, t: Any, order: int = 0) -> Any:
        """Return a_g, or an integral of it from the start for a negative order."""
        force = self.scene["force"]
        if force is None or force["kind"] != "base":
            return mp.mpf(0)
        omega, phase, amplitude = force["frequency"], force["phase"], force["amplitude"]
        return mp.re(amplitude * mp.expj(omega * t + phase) * mp.mpc(0, omega) ** order)

    def felt(self, _k: int, order: int) -> Any:
        """Return a bound on a derivative of a_g."""
        force = self.scene["force"]
        if force is None or force["kind"] != "base":
            return mp.mpf(0)
        return abs(force["amplitude"]) * force["frequency"] ** order

    def seen(self, k: int, z: Any) -> tuple[Any, Any]:
        """Return displacement and velocity of the structure at an absorber."""
        b = self.shapes[k]
        u = sum(b[i] * z[i] for i in range(self.n))
        return u, sum(b[i] * z[self.n + i] for i in range(self.n))

    def advance_to(self, h: Any, start: Any) -> None:
        """Move all by a time h."""
        flow = self.flow()
        z = flow.at(start, self.t, h)
        for k in range(self.count):
            if k not in self.stuck:
                self.gaps[k] = list(self.gap_at(k, h, z))
        self.z, self.t = z, self.t + h

    def gap_at(self, k: int, h: Any, z: Any) -> tuple[Any, Any]:
        """Return y and w a time h later, the structure being at z then."""
        (u, v), (later, speed) = self.seen(k, self.z), self.seen(k, z)
        y, w = self.gaps[k]
        # x1'' = -a_g: its integrals from t to t + h.
        once = self.base(self.t + h, -1) - self.base(self.t, -1)
        twice = self.base(self.t + h, -2) - self.base(self.t, -2) - self.base(self.t, -1) * h
        return u + y + (v + w) * h - twice - later, v + w - once - speed

    def pressure(self, k: int, h: Any, start: Any, order: int = 0) -> Any:
        """Return -s A at the wall of a stuck absorber, or a derivative of it."""
        flow = self.flow()
        z = flow.at(start, self.t, h, 1 + order)
        _, a = self.seen(k, z)
        return -self.stuck[k] * (a + self.base(self.t + h, order))

    def next_event(self, start: Any, until: Any, but: int = -1) -> tuple[Any, int, int] | None:
        """Return the time to the first event, its absorber, and its wall (0 for a release)."""
        flow, h = self.flow(), mp.mpf(0)
        bends = [flow.most(start, b, 2) + self.felt(k, 0) for k, b in enumerate(self.shapes)]
        rates = [flow.most(start, b, 3) + self.felt(k, 1) for k, b in enumerate(self.shapes)]
        first = True
        while True:
            z = flow.at(start, self.t, h)
            step, near = until - h, None
            for k in range(self.count):
                if k == but:
                    continue
                if k in self.stuck:
                    p = self.pressure(k, h, start)
                    safe = p / rates[k]
                    if p < mp.mpf("1e-9") and self.pressure(k, h, start, 1) < 0:
                        near = (k, 0)
                    step = min(step, safe)
                    continue
                y, w = self.gap_at(k, h, z)
                place = self.scene["absorbers"][k]
                for s in (1, -1):
                    d, rate = place["clearance"] - s * (y - place["offset"]), -s * w
                    root = mp.sqrt(rate * rate + 2 * bends[k] * max(d, mp.mpf(0)))
                    safe = (rate + root) / bends[k]
                    # A contact soon: the gap closes, and nothing else can happen before.
                    closing = rate < 0 and d * bends[k] < mp.mpf("1e-6") * rate * rate
                    if closing and not (first and d <= 0):
                        near = (k, s)
                    step = min(step, safe)
            if near is not None:
                return self.solved(start, h, near)
            first = False
            if h + step >= until:
                return None
            assert step > mp.mpf("1e-100"), (self.t, step)
            h += step

    def solved(self, start: Any, h: Any, near: tuple[int, int]) -> tuple[Any, int, int]:
        """Solve for the instant of an event close ahead by Newton's method."""
        k, s = near
        flow = self.flow()
        for _ in range(60):
            if s == 0:
                step = -self.pressure(k, h, start) / self.pressure(k, h, start, 1)
            else:
                y, w = self.gap_at(k, h, flow.at(start, self.t, h))
                place = self.scene["absorbers"][k]
                step = (s * place["clearance"] + place["offset"] - y) / w
            h += step
            if abs(step) < mp.mpf("1e-145"):
                break
        return h, k, s

    def mobility(self, k: int, other: int) -> Any:
        """Return the velocity at one absorber per impulse at another."""
        return (self.shapes[k].T * self.free_inverse * self.shapes[other])[0]

    def impact(self, k: int, s: int) -> dict[str, Any]:
        """Apply the impact of an absorber at a wall."""
        place = self.scene["absorbers"][k]
        w = self.gaps[k][1]
        fits = []
        stuck = sorted(self.stuck)
        for size in range(len(stuck) + 1):
            for held in itertools.combinations(stuck, size):
                who = [k, *held]
                a = mp.matrix(len(who))
                right = mp.zeros(len(who), 1)
                for i, one in enumerate(who):
                    for j, other in enumerate(who):
                        a[i, j] = self.mobility(one, other)
                    a[i, i] += 1 / self.scene["absorbers"][one]["mass_ratio"]
                right[0] = (1 + place["restitution"]) * w
                p = mp.lu_solve(a, right)
                moved = {
                    other: sum(self.mobility(other, one) * p[j] for j, one in enumerate(who))
                    for other in range(self.count)
                }
                pushed = all(self.stuck[one] * p[i + 1] >= 0 for i, one in enumerate(held))
                left = all(
                    self.stuck[other] * moved[other] > 0 for other in stuck if other not in held
                )
                if pushed and left:
                    fits.append((held, who, p, moved))
        assert len(fits) == 1, f"{len(fits)} sets of carried masses"
        held, who, p, moved = fits[0]
        _, before = self.seen(k, self.z)
        for one, impulse in zip(who, p, strict=True):
            gained = self.free_inverse * self.shapes[one] * impulse
            for i in range(self.n):
                self.z[self.n + i] += gained[i]
        _, after = self.seen(k, self.z)
        for other in range(self.count):
            if other == k:
                self.gaps[other][1] = -place["restitution"] * w
            elif other in held:
                self.gaps[other][1] = mp.mpf(0)
            else:
                self.gaps[other][1] -= moved[other]
        event = self.note("impact", k, s)
        event["velocities"] = [before, after, w, self.gaps[k][1]]
        for other in stuck:
            if other not in held:
                self.note("release", other, self.stuck.pop(other))
        return event

    def note(self, kind: str, absorber: int, wall: int) -> dict[str, Any]:
        """Add an event at the current instant."""
        event = {"kind": kind, "absorber": absorber, "wall": wall, "time": self.t}
        self.events.append(event)
        return event

    def presses(self, k: int, s: int) -> bool:
        """Tell whether the wall presses on a mass that touches it."""
        flow = self.flow()
        _, a = self.seen(k, flow.at(flow.start(self.z, self.t), self.t, mp.mpf(0), 1))
        return s * (a + self.base(self.t)) < 0

    def run(self) -> None:
        """Run the scene to its end."""
        end = self.scene["duration"]
        while True:
            start = self.flow().start(self.z, self.t)
            found = self.next_event(start, end - self.t)
            if found is None:
                self.advance_to(end - self.t, start)
                return
            h, k, s = found
            self.advance_to(h, start)
            place = self.scene["absorbers"][k]
            if s == 0:
                self.note("release", k, self.stuck.pop(k))
                # On its way: the pressure falls through 0, and the gap opens.
                self.gaps[k] = [self.gaps[k][0], mp.mpf(0)]
                self.nudge(k)
                continue
            self.gaps[k][0] = s * place["clearance"] + place["offset"]
            self.impact(k, s)
            rebound = abs(self.gaps[k][1])
            if rebound < FLOOR and self.presses(k, s):
                self.settle(k, s)

    def settle(self, k: int, s: int) -> None:
        """Stick a mass to its wall."""
        self.gaps[k][1] = mp.mpf(0)
        self.stuck[k] = s
        self.note("stick", k, s)

    def nudge(self, k: int) -> None:
        """Move on from a release; the gap opens as J t^3/6 - B t^4/24 at least, with J > 0."""
        flow, h = self.flow(), mp.mpf("1e-3")
        start = flow.start(self.z, self.t)
        _, jerk = self.seen(k, flow.at(start, self.t, mp.mpf(0), 2))
        jerk = abs(jerk + self.base(self.t, 1))
        assert 4 * jerk > h * (flow.most(start, self.shapes[k], 4) + self.felt(k, 2))
        assert self.next_event(start, h, k) is None
        self.advance_to(h, start)


def changed(rng: random.Random, size: Any) -> Any:
    """Return a function that changes each number at random."""
    return lambda value: value * (1 + size * mp.mpf(rng.uniform(-1, 1)))


def solved(scene: Scene) -> Run:
    """Return the run of a scene."""
    run = Run(scene)
    run.run()
    return run


def text(value: Any) -> str:
    """Return a number as a decimal."""
    return mp.nstr(value, DIGITS, min_fixed=-5, max_fixed=5)


def result(scene: Scene) -> Scene:
    """Return a scene with its events."""
    exact = solved(numbers(scene, lambda value: value))
    rng = random.Random(scene["id"])
    size = mp.mpf("1e-25")
    draws = []
    for _ in range(3):
        other = numbers(scene, changed(rng, size))
        other["duration"] = mp.mpf(scene["duration"])
        draws.append(solved(other))
    events = []
    clearances = [mp.mpf(it["clearance"]) for it in scene["absorbers"]]
    for i, event in enumerate(exact.events):
        same = [draw.events[i] for draw in draws]
        assert all(
            it["kind"] == event["kind"] and it["absorber"] == event["absorber"] for it in same
        )
        values = [event["time"], *event.get("velocities", [])]
        changes = [[it["time"], *it.get("velocities", [])] for it in same]
        condition = max(
            abs(a - b) / size for draw in changes for a, b in zip(draw, values, strict=True)
        )
        if event["kind"] == "impact":
            k = event["absorber"]
            if abs(event["velocities"][2]) <= mp.mpf("1e-6") * clearances[k]:
                continue
        row = {key: event[key] for key in ("kind", "absorber", "wall")}
        row["time"] = text(event["time"])
        if event["kind"] == "impact":
            row["velocities"] = [text(it) for it in event["velocities"]]
        row["condition"] = float(mp.nstr(condition, 6))
        events.append(row)
    ends = [[*run.z, *itertools.chain(*run.gaps)] for run in (exact, *draws)]
    condition = max(
        abs(a - b) / size for draw in ends[1:] for a, b in zip(draw, ends[0], strict=True)
    )
    n = exact.n
    end = {
        "displacements": [text(it) for it in ends[0][:n]],
        "velocities": [text(it) for it in ends[0][n : 2 * n]],
        "gaps": [[text(it) for it in gap] for gap in exact.gaps],
        "condition": float(mp.nstr(condition, 6)),
    }
    return {**scene, "events": events, "end": end}


def absorber(point: str, *given: str) -> dict[str, str]:
    """Return a mass at a point, from its mass ratio, restitution, clearance and offset."""
    mass_ratio, restitution, clearance, offset = given
    return {
        "point": point,
        "mass_ratio": mass_ratio,
        "restitution": restitution,
        "clearance": clearance,
        "offset": offset,
    }


FRAME = {
    "mass": [["1", "0"], ["0", "0.8"]],
    "stiffness": [["3.2", "-1.4"], ["-1.4", "1.4"]],
    "damping": [["0.05", "-0.01"], ["-0.01", "0.02"]],
    "points": {"first": ["1", "0"], "second": ["0", "1"]},
}
# Its mass matrix couples both floors: an impulse at one is felt at once at the other.
COUPLED = {**FRAME, "mass": [["1", "0.25"], ["0.25", "0.8"]]}
MODES = {
    "mass": [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]],
    "stiffness": [["1", "0", "0"], ["0", "6.25", "0"], ["0", "0", "18.49"]],
    "damping": [["0.02", "0", "0"], ["0", "0.075", "0"], ["0", "0", "0.172"]],
    "points": {
        "tip": ["1", "-0.9", "0.7"],
        "middle": ["0.5", "0.8", "-0.6"],
        "node": ["0.7", "0", "0.5"],
    },
}

SCENES: list[Scene] = [
    {
        "id": "coupled frame",
        **COUPLED,
        "absorbers": [
            absorber("second", "0.2", "0.3", "0.25", "0"),
            absorber("first", "0.15", "0.6", "0.9", "0"),
        ],
        "force": None,
        "start": {
            "displacements": ["0.4", "1.2"],
            "velocities": ["0.3", "0"],
            "gaps": [["0", "0"], ["0.3", "-0.2"]],
        },
        "duration": "20",
    },
    {
        "id": "modes under a force",
        **MODES,
        "absorbers": [
            absorber("tip", "0.08", "0.5", "0.4", "0"),
            absorber("middle", "0.06", "0.7", "0.6", "0.1"),
            absorber("node", "0.1", "0.45", "0.5", "0"),
        ],
        "force": {
            "kind": "force",
            "amplitude": "0.35",
            "frequency": "0.9",
            "phase": "0.4",
            "point": "middle",
        },
        "start": {
            "displacements": ["0.8", "0.1", "-0.05"],
            "velocities": ["0", "0.2", "0"],
            "gaps": [["0", "0.1"], ["0.2", "0"], ["-0.1", "0"]],
        },
        "duration": "24",
    },
]

# In frames of lumped masses an impulse at one floor is not felt at once at the other. Under the
# moving base one mass is released while the other stays stuck.
MORE: list[Scene] = [
    {
        "id": "frame",
        **FRAME,
        "absorbers": [
            absorber("second", "0.12", "0.35", "0.2", "0"),
            absorber("first", "0.1", "0.45", "0.22", "0.05"),
        ],
        "force": None,
        "start": {
            "displacements": ["0.6", "1.1"],
            "velocities": ["0", "-0.2"],
            "gaps": [["0.1", "0"], ["-0.05", "0.1"]],
        },
        "duration": "22",
    },
    {
        "id": "frame on a base",
        **FRAME,
        "absorbers": [
            absorber("second", "0.15", "0.35", "0.35", "0"),
            absorber("first", "0.1", "0.45", "0.5", "0"),
        ],
        "force": {
            "kind": "base",
            "amplitude": "0.3",
            "frequency": "0.8",
            "phase": "0.3",
            "influence": ["1", "1"],
        },
        "start": {
            "displacements": ["0", "0.2"],
            "velocities": ["0", "0"],
            "gaps": [["0", "0"], ["0.1", "0"]],
        },
        "duration": "12",
    },
]

if __name__ == "__main__":
    wanted = SCENES + MORE if "--all" in sys.argv[1:] else SCENES
    print(json.dumps([result(scene) for scene in wanted], indent=1))
