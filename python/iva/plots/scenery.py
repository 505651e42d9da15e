"""The structure with its absorber, drawn to scale, to be moved from instant to instant."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle, Rectangle

from iva.design import Design, Pendulum
from iva.plots.arguments import Numbers
from iva.plots.styles import ABSORBER, WALLS

#: Of the structure, and of a wall that nothing has hit for a while.
BODY, DARK = "#D9D9D9", "#4D4D4D"
WINDINGS = 8


class Scenery(Protocol):
    """A scene that can be moved."""

    def move(self, x: float, y: float, angle: float) -> None:
        """Show displacement x, gap displacement y and the angle of a pendulum (else NaN)."""

    def light(self, wall: int, strength: float) -> None:
        """Light up a wall: 0 is dark, 1 is full."""


def scenery(axes: Axes, design: Design, largest: float, reach: float) -> Scenery:
    """Draw a scene at rest.

    Parameters
    ----------
    axes : matplotlib axes
        Where to draw; its own frame goes away.
    design : Design
        The scene, with an absorber.
    largest, reach : float
        Largest |x| and |y| of the motion, for which there must be room.
    """
    assert design.clearance is not None
    axes.set_aspect("equal")
    axes.set_axis_off()
    if design.pendulum is None:
        return MassInGap(axes, design.clearance, design.gap_offset, largest)
    return PendulumBetweenStops(axes, design.clearance, design.pendulum, largest, reach)


class Body:
    """The structure on its spring: what both absorbers have in common."""

    def __init__(self, axes: Axes, half_width: float, height: float, largest: float) -> None:
        length = 1.7 * largest + 0.4 * half_width
        self._anchor = -half_width - length
        self._half_width, self._swing = half_width, 0.25 * height
        thick = 0.06 * (length + half_width)
        foot = Rectangle((self._anchor - thick, -height), thick, 2.0 * height, hatch="/////")
        foot.set(facecolor="white", edgecolor=DARK, linewidth=0.6)
        axes.add_patch(foot)
        (self._spring,) = axes.plot([], [], color=DARK, linewidth=0.7)
        self._parts: list[tuple[Rectangle, float, float]] = []
        self._walls: dict[int, Rectangle] = {}
        self._axes = axes
        margin = 0.04 * (length + half_width)
        axes.set_xlim(self._anchor - thick - margin, half_width + largest + margin)

    def add(self, left: float, bottom: float, width: float, height: float) -> Rectangle:
        """Add a part that moves with the structure, given where it is at rest."""
        part = Rectangle((left, bottom), width, height, facecolor=BODY, edgecolor="none")
        self._axes.add_patch(part)
        self._parts.append((part, left, bottom))
        return part

    def add_wall(self, wall: int, left: float, bottom: float, width: float, height: float) -> None:
        """Add the part that the absorber meets."""
        self._walls[wall] = self.add(left, bottom, width, height)
        self.light(wall, 0.0)

    def light(self, wall: int, strength: float) -> None:
        """Light up a wall, if there is one."""
        if wall in self._walls:
            dark, lit = np.array(to_rgb(DARK)), np.array(to_rgb(WALLS[wall]))
            red, green, blue = (1.0 - strength) * dark + strength * lit
            self._walls[wall].set_facecolor((float(red), float(green), float(blue)))

    def shift(self, x: float) -> None:
        """Move the structure, and stretch its spring."""
        for part, left, bottom in self._parts:
            part.set_xy((left + x, bottom))
        self._spring.set_data(*zigzag(self._anchor, x - self._half_width, self._swing))


class MassInGap(Body):
    """A free mass between two walls of the structure."""

    def __init__(self, axes: Axes, clearance: float, middle: float, largest: float) -> None:
        # The size of the mass is no number of the scene; its play is.
        radius = max(0.3 * clearance, 0.08 * largest)
        inside, thick = clearance + radius, 0.35 * radius
        super().__init__(axes, inside + thick, 1.6 * radius, largest)
        self.add(-inside - thick, -1.35 * radius, 2.0 * (inside + thick), 0.35 * radius)
        for wall, left in ((-1, -inside - thick), (1, inside)):
            self.add_wall(wall, left, -radius, thick, 2.2 * radius)
        self._mass = Circle((0.0, 0.0), radius, facecolor=ABSORBER, edgecolor="none", zorder=3)
        axes.add_patch(self._mass)
        axes.set_ylim(-1.8 * radius, 1.8 * radius)
        # The structure is drawn around the middle of the gap.
        self._middle = middle

    def move(self, x: float, y: float, angle: float) -> None:  # noqa: ARG002 (of a pendulum)
        """Show an instant."""
        self.shift(x)
        self._mass.center = (x + y - self._middle, 0.0)


class PendulumBetweenStops(Body):
    """A pendulum that hangs from the structure between two stops."""

    def __init__(
        self, axes: Axes, clearance: float, pendulum: Pendulum, largest: float, reach: float
    ) -> None:
        widest = max(reach, clearance)
        arm = pendulum.contact_distance
        self._by_angle = not pendulum.small
        if arm is None or (pendulum.small and arm <= 1.05 * widest):
            # Of small angles without length only y is known.
            arm = 4.0 * widest
        self._arm, self._length = arm, arm * pendulum.lever
        longest = max(self._arm, self._length)
        radius = min(0.3 * clearance, 0.07 * longest)
        # What meets the stops is the bob itself, or a point of its rod.
        edge = radius if pendulum.lever == 1.0 else 0.0
        reachable = clearance < arm
        inside = clearance + edge if reachable else 0.3 * longest
        thick = max(0.5 * radius, 0.03 * longest)
        foot = 0.04 * longest + thick
        super().__init__(axes, inside + thick, foot, largest)
        self.add(-inside - thick, -0.5 * thick, 2.0 * (inside + thick), thick)
        lowest, highest = -longest - 1.5 * radius, 1.1 * foot
        if reachable:
            depth = arm * math.sqrt(1.0 - (clearance / arm) ** 2)
            size = max(2.4 * radius, 0.08 * arm)
            # A rod is met by the end of the stop: further down it swings out beyond it.
            end = -depth - (0.5 * size if edge else 0.0)
            for wall, left in ((-1, -inside - thick), (1, inside)):
                self.add(left, end, thick, -end)
                self.add_wall(wall, left, end, thick, size)
        else:
            highest = longest + 1.5 * radius
            left, right = axes.get_xlim()
            axes.set_xlim(min(left, -largest - longest), max(right, largest + longest))
        (self._rod,) = axes.plot([], [], color=DARK, linewidth=1.0, zorder=2.5)
        self._pivot = Circle((0.0, 0.0), 0.35 * thick, facecolor=DARK, edgecolor="none", zorder=3)
        self._bob = Circle((0.0, 0.0), radius, facecolor=ABSORBER, edgecolor="none", zorder=3)
        axes.add_patch(self._pivot)
        axes.add_patch(self._bob)
        axes.set_ylim(lowest, highest)

    def move(self, x: float, y: float, angle: float) -> None:
        """Show an instant."""
        self.shift(x)
        turned = angle if self._by_angle else math.asin(y / self._arm)
        across, down = math.sin(turned), math.cos(turned)
        longest = max(self._arm, self._length)
        self._rod.set_data([x, x + longest * across], [0.0, -longest * down])
        self._pivot.center = (x, 0.0)
        self._bob.center = (x + self._length * across, -self._length * down)


def zigzag(left: float, right: float, swing: float) -> tuple[Numbers, Numbers]:
    """Return the corners of a spring between two points at height 0."""
    across = np.linspace(left, right, 2 * WINDINGS + 4)
    up = np.zeros_like(across)
    up[2:-2:2], up[3:-2:2] = swing, -swing
    return across, up
