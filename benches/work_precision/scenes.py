"""The scenes of ``tests/reference`` and their equations, written for a general integrator.

The state is (x, ẋ, q, q̇), q the gap displacement y of a free mass and the angle θ of a pendulum:
both walls are then at a constant q = ±wall, and a state can be put exactly on one.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import Path

REFERENCE = Path(__file__).parents[2] / "tests" / "reference"

#: What a picture shows, by its file name.
GROUPS = {
    "free_mass": (
        "siva_gamma_0.6",
        "siva_e_0.9",
        "siva_e_1_conservative",
        "siva_overdamped",
    ),
    "pendulum": ("piva_gamma_1.4", "piva_gamma_1.0_short", "piva_large_angle"),
    "force": ("siva_forced_masri", "piva_forced"),
    "grazing": ("siva_graze_inside", "siva_graze_outside"),
    "chatter": (
        "siva_gamma_0.1_chatter",
        "siva_e_0_plastic",
        "siva_heavy_absorber",
        "piva_chatter",
    ),
}

State = tuple[float, float, float, float]
Derivative = Callable[[float, "State"], State]


@dataclass(frozen=True, slots=True)
class Expected:
    """An event of the reference; `condition` is None in the tail of a chatter."""

    kind: str
    time: Decimal
    wall: int
    approach: float
    condition: float


@dataclass(frozen=True)
class Scene:
    """A scene with M = ωn = 1; a free mass has ``length`` and ``frequency_ratio`` 0."""

    name: str
    mass_ratio: float
    clearance: float
    restitution: float
    damping_ratio: float
    frequency_ratio: float
    length: float
    amplitude: float
    frequency: float
    start: State
    end: float
    events: tuple[Expected, ...]
    final: tuple[Decimal, ...]

    @property
    def pendulum(self) -> bool:
        """Whether the absorber is a pendulum."""
        return self.length > 0

    @property
    def wall(self) -> float:
        """The q of the positive wall."""
        return math.asin(self.clearance / self.length) if self.pendulum else self.clearance

    @property
    def reach(self) -> float:
        """Gap velocity over q̇ at a wall."""
        return self.length * math.cos(self.wall) if self.pendulum else 1.0

    @property
    def gravity(self) -> float:
        """Acceleration of gravity g."""
        return self.frequency_ratio**2 * self.length

    def gap_state(self, state: State) -> State:
        """Return (x, ẋ, y, w) of (x, ẋ, q, q̇)."""
        x, v, q, rate = state
        if not self.pendulum:
            return x, v, q, rate
        return x, v, self.length * math.sin(q), self.length * math.cos(q) * rate

    def derivative(self) -> Derivative:
        """Return f(t, state) of the flight."""
        damping, amplitude, frequency = 2 * self.damping_ratio, self.amplitude, self.frequency
        mu, length, gravity = self.mass_ratio, self.length, self.gravity
        sin, cos = math.sin, math.cos

        def free_mass(t: float, state: State) -> State:
            x, v, _, rate = state
            a = amplitude * cos(frequency * t) - damping * v - x
            return v, a, rate, -a

        def pendulum(t: float, state: State) -> State:
            x, v, q, rate = state
            s, c = sin(q), cos(q)
            push = amplitude * cos(frequency * t) - damping * v - x
            a = (push + mu * s * (length * rate * rate + gravity * c)) / (1 + mu * s * s)
            return v, a, rate, -(a * c + gravity * s) / length

        return pendulum if self.pendulum else free_mass

    def riding(self) -> Callable[[float, tuple[float, float]], tuple[float, float]]:
        """Return f(t, (x, ẋ)) with the absorber on a wall."""
        damping, amplitude, frequency = 2 * self.damping_ratio, self.amplitude, self.frequency
        total, cos = 1 + self.mass_ratio, math.cos

        def both(t: float, state: tuple[float, float]) -> tuple[float, float]:
            x, v = state
            return v, (amplitude * cos(frequency * t) - damping * v - x) / total

        return both

    def pull(self, acceleration: float, wall: int) -> float:
        """Return the acceleration away from `wall`; the absorber rides while it is negative."""
        tilt = self.wall if self.pendulum else 0.0
        return wall * acceleration * math.cos(tilt) + self.gravity * math.sin(tilt)


def scenes() -> dict[str, Scene]:
    """Read all scenes of the groups, by name."""
    raw: dict[str, dict] = {}
    for path in sorted(REFERENCE.glob("*.json")):
        raw |= json.loads(path.read_text())
    return {name: _scene(name, raw[name]) for group in GROUPS.values() for name in group}


def _scene(name: str, raw: dict) -> Scene:
    given = {key: float(value) for key, value in raw["scene"].items() if key != "kind"}
    if given.get("y") or given.get("dy"):
        raise ValueError(f"{name}: a start off the centre is not foreseen")
    events = [
        Expected(
            kind=event["kind"],
            time=Decimal(event["tau"]),
            wall=int(event["side"]),
            approach=abs(float(event.get("approach", 0))),
            condition=float(event.get("condition") or 1),
        )
        for event in raw["events"]
    ]
    scene = Scene(
        name=name,
        mass_ratio=given["mu"],
        clearance=given["gamma"],
        restitution=given["e"],
        damping_ratio=given["zeta"],
        frequency_ratio=given.get("r", 0.0),
        length=given.get("lam", 0.0),
        amplitude=given.get("F", 0.0),
        frequency=given.get("Omega", 1.0),
        start=(given.get("x", 1.0), given.get("v", 0.0), 0.0, 0.0),
        end=float(raw["tau_end"]),
        events=tuple(events),
        final=tuple(Decimal(raw["final"][key]) for key in ("x", "v", "y", "dy")),
    )
    return replace(scene, final=_moved(scene, float(Decimal(scene.end) - Decimal(raw["tau_end"]))))


def _moved(scene: Scene, late: float) -> tuple[Decimal, ...]:
    """Return the final state at the double nearest to the end: what rounding the end moves."""
    x, v, y, w = map(float, scene.final)
    if abs(y) > 0.999999 * scene.clearance:
        return scene.final
    q = math.asin(y / scene.length) if scene.pendulum else y
    rate = w / (scene.length * math.cos(q)) if scene.pendulum else w
    _, a, _, turn = scene.derivative()(scene.end, (x, v, q, rate))
    b = scene.length * math.cos(q) * turn - y * rate * rate if scene.pendulum else turn
    steps = (Decimal(late * slope) for slope in (v, a, w, b))
    return tuple(value + step for value, step in zip(scene.final, steps, strict=True))
