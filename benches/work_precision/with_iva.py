"""iva itself, with the tables ``impacts`` and ``episodes`` and no measures.

Events are listed, which the fast tier of free masses does not do, so these have the setting 0
alone.
"""

from __future__ import annotations

import math
import statistics
import time
from typing import Any

import numpy as np

import iva
from work_precision.flights import STICK
from work_precision.results import FINISHED, Event, Motion
from work_precision.scenes import Scene

SETTINGS = ("0", "1e-12", "1e-9", "1e-6")
#: Points of the short sweep, seconds that the long one lasts at least, and how often each is run.
FEW, LONG, ROUNDS = 50, 0.03, 5


def settings(scene: Scene) -> tuple[str, ...]:
    """Return the settings that apply to a scene."""
    return SETTINGS if scene.pendulum else SETTINGS[:1]


def parts(scene: Scene, setting: str) -> dict[str, Any]:
    """Return the arguments of :func:`iva.simulate`."""
    x, v, _, _ = scene.start
    common: dict[str, Any] = {
        "mass_ratio": scene.mass_ratio,
        "restitution": scene.restitution,
        "clearance": scene.clearance,
    }
    absorber = (
        iva.Piva(**common, frequency_ratio=scene.frequency_ratio, length=scene.length)
        if scene.pendulum
        else iva.Siva(**common)
    )
    made: dict[str, Any] = {
        "absorber": absorber,
        "primary": iva.Primary(damping_ratio=scene.damping_ratio),
        "start": iva.Start(displacement=x, velocity=v),
        "duration": scene.end,
        "chatter_floor": STICK,
        "measures": (),
    }
    if scene.amplitude:
        made["force"] = iva.Harmonic(amplitude=scene.amplitude, frequency=scene.frequency)
    if scene.pendulum:
        made["tolerance"] = float(setting)
    return made


def solve(scene: Scene, setting: str, spacing: float | None = None) -> Motion:
    """Run a scene; setting: the tolerance."""
    arguments = parts(scene, setting)
    begin = time.perf_counter()
    run = iva.simulate(**arguments, tables=("impacts", "episodes"))
    seconds = time.perf_counter() - begin
    events = [
        Event("impact", t, int(wall), abs(approach))
        for t, wall, approach in run.impacts.select("time", "wall", "approach_velocity").rows()
    ]
    for wall, stick, release in run.episodes.select("wall", "stick_time", "release_time").rows():
        events.append(Event("stick", stick, int(wall), 0.0))
        if release is not None:
            events.append(Event("release", release, int(wall), 0.0))
    motion = Motion(sorted(events, key=lambda event: event.time), None, seconds)
    state = ("displacement", "velocity", "gap_displacement", "gap_velocity")
    motion.final = run.at([scene.end]).select(state).row(0)
    if run.summary["outcome"].item() != FINISHED:
        motion.outcome = run.summary["outcome"].item()
    if spacing is not None:
        samples = run.trajectory(math.ceil(2 * math.pi / spacing))
        motion.largest_gap = (
            float(np.abs(samples["gap_displacement"].to_numpy()).max()) / scene.clearance
        )
    return motion


def seconds_without_python(scene: Scene, setting: str) -> float:
    """Return what one run costs inside the compiled part.

    Sweeps of identical points on one thread: the difference of a long and a short one, medians of
    several.
    """
    arguments = parts(scene, setting)

    def sweep(points: int) -> float:
        begin = time.perf_counter()
        over = {"mass_ratio": [scene.mass_ratio] * points}
        iva.sweep(**arguments, over=over, tables=("impacts", "episodes"), threads=1)
        return time.perf_counter() - begin

    many = 10 * FEW
    while sweep(many) < LONG:
        many *= 2
    short, long = ([sweep(points) for _ in range(ROUNDS)] for points in (FEW, many))
    return (statistics.median(long) - statistics.median(short)) / (many - FEW)
