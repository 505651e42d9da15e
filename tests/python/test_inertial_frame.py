"""Runs under force and base motion against an integration in the inertial frame by SciPy.

The expected numbers come from the mechanics alone. The coordinates are absolute, q = (X, X₁) of a
free mass and q = (X, θ) of a pendulum whose pivot moves, and a moving base only pulls the spring
and the damper: no inertial force appears anywhere. With M(q) the mass matrix over the primary mass
and n = ∂y/∂q of the gap displacement y, a contact or an impulse is a force along n or X,

    impact   u⁺ = u − (1+e) (n·u) M⁻¹n / (n·M⁻¹n)         impulse   u⁺ = u + M⁻¹(P/M, 0)
    stuck    M u̇ = Q + λn with n·u̇ = 0, as long as λ points into the gap.

The scenes were chosen so that rounding (1e-16 to 1e-12 in SciPy) does not grow beyond 1e-9.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import DOP853
from scipy.optimize import brentq

import iva

Array = NDArray[np.float64]
Force = iva.Harmonic | iva.Impulse | iva.Recorded
TOLERANCE = 1e-8


@dataclass(frozen=True)
class Model:
    """Masses, forces and energies over the primary mass, in the units of the scene."""

    mass: float
    omega: float
    zeta: float
    mu: float
    e: float
    d: float
    length: float = 0.0  # 0: a free mass
    kappa: float = 1.0
    contact: float = 0.0
    gravity: float = 0.0
    pivot: float = 0.0  # 2 ζp ωp
    small: bool = False

    def sine(self, angle: Any) -> Any:
        return angle if self.small else np.sin(angle)

    def cosine(self, angle: Any) -> Any:
        return 1.0 + 0.0 * angle if self.small else np.cos(angle)

    def inertia(self, q: Array) -> Array:
        if not self.length:
            return np.diag([1.0, self.mu])
        coupling = self.mu * self.length * self.cosine(q[1])
        return np.array(
            [[1.0 + self.mu, coupling], [coupling, self.mu * self.kappa * self.length**2]]
        )

    def load(self, z: Array) -> Array:
        """Return the generalised forces of spring, damper, gravity and the moving pivot."""
        x, v, angle, rate = z[0] - z[4], z[2] - z[5], z[1], z[3]
        spring = -2.0 * self.zeta * self.omega * v - self.omega**2 * x
        if not self.length:
            return np.array([spring, 0.0])
        if not self.small:
            spring += self.mu * self.length * rate**2 * math.sin(angle)
        weight = self.gravity * self.length * self.sine(angle)
        return np.array(
            [spring, -self.mu * (weight + self.kappa * self.length**2 * self.pivot * rate)]
        )

    def gap(self, z: Array) -> Any:
        return self.contact * self.sine(z[1]) if self.length else z[1] - z[0]

    def gap_rate(self, z: Array) -> Any:
        if not self.length:
            return z[3] - z[2]
        return self.contact * self.cosine(z[1]) * z[3]

    def normal(self, z: Array) -> Array:
        if not self.length:
            return np.array([-1.0, 1.0])
        return np.array([0.0, self.contact * self.cosine(z[1])])

    def absorber_velocity(self, z: Array) -> Any:
        """Return the horizontal velocity of its centre of mass, relative to the base."""
        swing = z[3] if not self.length else z[2] + self.length * self.cosine(z[1]) * z[3]
        return swing - z[5]

    def kinetic(self, z: Array, base: float = 0.0) -> float:
        u = z[2:4] - ([base, 0.0] if self.length else [base, base])
        return 0.5 * float(u @ self.inertia(z) @ u)

    def energy(self, z: Array) -> float:
        rise = 0.5 * z[1] ** 2 if self.small else 1.0 - math.cos(z[1])
        potential = 0.5 * self.omega**2 * (z[0] - z[4]) ** 2
        return self.kinetic(z, z[5]) + potential + self.mu * self.gravity * self.length * rise


def model(absorber: iva.Siva | iva.Piva, primary: iva.Primary, start: iva.Start) -> Model:
    """Return the numbers of a scene in its own units; lengths are m in SI units."""
    mass = primary.mass or 1.0
    hertz, stiffness = primary.frequency_hz, primary.stiffness
    omega = primary.natural_frequency or 1.0
    omega = 2.0 * math.pi * hertz if hertz else math.sqrt(stiffness / mass) if stiffness else omega
    damping = primary.damping
    values: dict[str, Any] = {
        "mass": mass,
        "omega": omega,
        "zeta": damping / (2.0 * mass * omega) if damping else primary.damping_ratio or 0.0,
        "mu": absorber.mass / mass if absorber.mass else absorber.mass_ratio,
        "e": absorber.restitution,
        "d": absorber.gap_mm / 2000.0 if absorber.gap_mm else absorber.clearance,
    }
    if isinstance(absorber, iva.Siva):
        return Model(**values)
    length, kappa = absorber.length, absorber.inertia_ratio or 1.0
    assert length is not None
    ratio = absorber.frequency_ratio
    gravity = kappa * length * (ratio * omega) ** 2 if ratio else 9.80665
    pivot = 2.0 * (absorber.pivot_damping_ratio or 0.0) * math.sqrt(gravity / (kappa * length))
    return Model(
        **values,
        length=length,
        kappa=kappa,
        contact=absorber.contact_distance or length,
        gravity=gravity,
        pivot=pivot,
        small=absorber.angles == "small",
    )


def accelerations(
    forces: list[Force], of: Model, middle: float
) -> Callable[[float], tuple[float, float]]:
    """Return f/M and a_g as functions of time, on the piece between breaks with this middle."""

    def at(time: float) -> tuple[float, float]:
        push, base = 0.0, 0.0
        for force in forces:
            if isinstance(force, iva.Harmonic):
                hertz, relative = force.frequency_hz, force.relative_frequency
                turns = 2.0 * math.pi * hertz if hertz else (relative or 0.0) * of.omega
                wave = math.cos((force.frequency or turns) * time + (force.phase or 0.0))
                push += ((force.amplitude or 0.0) + (force.force or 0.0) / of.mass) * wave
                base += (force.base_acceleration or 0.0) * wave
            elif isinstance(force, iva.Recorded):
                knots, values = np.asarray(force.times), np.asarray(force.values)
                if not knots[0] < middle < knots[-1]:
                    continue
                k = int(np.searchsorted(knots, middle))
                part = (time - knots[k - 1]) / (knots[k] - knots[k - 1])
                value = force.scale * float(values[k - 1] + part * (values[k] - values[k - 1]))
                push += {"force": value, "force_newtons": value / of.mass}.get(force.kind, 0.0)
                base += value if force.kind == "base_acceleration" else 0.0
        return push, base

    return at


@dataclass
class Reference:
    """Integrate z = (q, u, s, ṡ, work), s the displacement of the base in the inertial frame."""

    of: Model
    forces: list[Force]
    z: Array
    wall: int = 0  # ±1 while stuck
    impacts: list[dict[str, Any]] = field(default_factory=list)
    episodes: list[dict[str, Any]] = field(default_factory=list)
    states: list[dict[str, float]] = field(default_factory=list)

    def motion(self, drive: Callable[[float], tuple[float, float]], time: float, z: Array) -> Array:
        """Return ż, and behind it the contact force over the primary mass."""
        push, base = drive(time)
        inertia, normal = self.of.inertia(z), self.of.normal(z)
        rates = np.linalg.solve(inertia, self.of.load(z) + [push, 0.0])
        contact = 0.0
        if self.wall:
            reply = np.linalg.solve(inertia, normal)
            contact = -float(normal @ rates) / float(normal @ reply)
            rates = rates + contact * reply
        v = z[2] - z[5]
        power = push * v - base * (v + self.of.mu * self.of.absorber_velocity(z))
        return np.array([z[2], z[3], *rates, z[5], base, power, contact])

    def first(self, steps: Callable[[Array], Array], begin: float, end: float) -> float | None:
        """Return the first event in a step: a contact, or the release while stuck."""
        # Between the zeros of its rate the gap is monotone: no contact can hide.
        if self.wall:
            marks, level = [begin, end], 0.0
        else:
            grid = np.linspace(begin, end, 9)
            rate = self.of.gap_rate(steps(grid))
            turns = [
                brentq(lambda t: self.of.gap_rate(steps(t)), a, b, xtol=1e-15, rtol=1e-15)
                for a, b, at_a, at_b in zip(grid, grid[1:], rate, rate[1:], strict=False)
                if at_a * at_b < 0.0
            ]
            marks, level = sorted([*grid, *turns]), self.of.d
        return None
