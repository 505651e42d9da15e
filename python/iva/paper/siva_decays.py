"""Figs 3 to 5, 10 and 11: single decays with the free mass."""

from __future__ import annotations

from functools import cache

import numpy as np
import polars as pl

import iva
from iva.paper import drawing, scenes
from iva.paper.assumptions import Assumptions
from iva.paper.made import Made
from iva.paper.measures import SETTLING, mean_size, percent
from iva.paper.verdicts import Finding, View

#: The mass ratio of Figs 4 and 5; Fig. 3 does not say its own, and stands beside them.
MASS_RATIO = 0.15
CLEARANCES = (0.1, 0.6, 0.8)


def fig3(a: Assumptions) -> Made:
    """Decay at three clearances, and without absorber."""
    absorber = scenes.siva(a, mass_ratio=MASS_RATIO)
    runs = {
        f"γ = {gamma}": scenes.decay(with_clearance(absorber, gamma), scenes.primary(a))
        for gamma in CLEARANCES
    }
    without = scenes.bare(a)
    dampings = [0.5 * a.damping_ratio, a.damping_ratio, 2.0 * a.damping_ratio]
    table = scenes.decays(
        absorber,
        scenes.primary(a),
        {"damping_ratio": dampings, "relative_clearance": CLEARANCES},
        periods=120.0,
    ).summary
    return Made(
        f"μ = {MASS_RATIO}, e = {a.restitution:g}, ζ = {a.damping_ratio:g}, γ = 0.1, 0.6, 0.8",
        {"decays": drawing.motions(runs | {"without": without}), "settling": table},
        [settles_sooner(table, dampings)],
        lambda: drawing.decays(runs, without, until=60.0),
    )


def settles_sooner(table: pl.DataFrame, dampings: list[float]) -> Finding:
    """S1: γ = 0.6 settles sooner than 0.1 and 0.8."""
    views = []
    sooner = [0, 0]
    for measure in SETTLING:
        times = table[measure.column].fill_null(np.inf).to_numpy().reshape(len(dampings), 3)
        for damping, (small, middle, large) in zip(dampings, times, strict=True):
            sooner[0] += bool(middle < small)
            sooner[1] += bool(middle < large)
            holds = None if np.isinf(middle) else bool(middle < small and middle < large)
            value = " / ".join("–" if np.isinf(t) else f"{t:.0f}" for t in (small, middle, large))
            views.append(View(f"{measure.label}, ζ = {damping:g}", holds, value))
    return Finding(
        "S1",
        "Fig. 3",
        "The response dies out sooner with γ = 0.6 than with 0.1 and 0.8.",
        views,
        f"Of {len(views)} views 0.6 is sooner than 0.1 in {sooner[0]} and sooner than 0.8 in "
        f"{sooner[1]} (values: settling times at γ = 0.1 / 0.6 / 0.8): that depends on the "
        "damping of the structure, which is not given, and on the level.",
    )


@cache
def velocity_runs(a: Assumptions) -> tuple[iva.Run, iva.Run]:
    """Return the runs of Figs 4 and 5, ten periods each."""
    made = [
        scenes.decay(
            scenes.siva(a, mass_ratio=MASS_RATIO, restitution=0.5, relative_clearance=gamma),
            scenes.primary(a),
            periods=10.0,
        )
        for gamma in (0.1, 0.6)
    ]
    return made[0], made[1]


def fig4(a: Assumptions) -> Made:
    """Velocities in a small gap."""
    run = velocity_runs(a)[0]
    return Made(
        f"μ = {MASS_RATIO}, γ = 0.1, e = 0.5, ζ = {a.damping_ratio:g}",
        {"trajectory": run.trajectory(200), "impacts": run.impacts},
        [directions(a)],
        lambda: drawing.velocities(run),
    )


def fig5(a: Assumptions) -> Made:
    """Velocities in a middle gap."""
    run = velocity_runs(a)[1]
    return Made(
        f"μ = {MASS_RATIO}, γ = 0.6, e = 0.5, ζ = {a.damping_ratio:g}",
        {"trajectory": run.trajectory(200), "impacts": run.impacts},
        [],
        lambda: drawing.velocities(run),
    )


def directions(a: Assumptions) -> Finding:
    """S2: the masses move together at γ = 0.1, against each other at 0.6."""
    small, middle = velocity_runs(a)
    counts, against, speeds = [], [], []
    for run in (small, middle):
        impacts = run.impacts
        counts.append(impacts.height)
        against.append(mean_size(impacts["effective"].cast(pl.Float64)))
        speeds.append(mean_size(impacts["approach_velocity"]))
    views = [
        View("number of impacts", counts[0] > counts[1], f"{counts[0]} / {counts[1]}"),
        View(
            "impacts against each other",
            against[0] < 0.5 < against[1],
            f"{percent(against[0])} / {percent(against[1])}",
        ),
        View("mean approach speed", speeds[0] < speeds[1], f"{speeds[0]:.3f} / {speeds[1]:.3f}"),
    ]
    return Finding(
        "S2",
        "Figs 4 and 5",
        "At γ = 0.1 both masses move the same way, with small relative velocities and many "
        "impacts; at 0.6 they move against each other, faster.",
        views,
        f"In ten periods {counts[0]} listed impacts at a mean of {speeds[0]:.3f} x₀ωn against "
        f"{counts[1]} at {speeds[1]:.2f}. At γ = 0.1 chatter ends in stick: the rebounds are "
        f"infinitely many, and their number is one of the floor ({len(small.episodes)} episodes).",
    )


@cache
def phase_runs(a: Assumptions) -> tuple[iva.Run, iva.Run]:
    """Return the runs of Figs 10 and 11."""
    made = [
        scenes.decay(
            scenes.siva(a, mass_ratio=0.1, relative_clearance=0.5, restitution=e), scenes.primary(a)
        )
        for e in (0.5, 0.9)
    ]
    return made[0], made[1]


def fig10(a: Assumptions) -> Made:
    """Phase plane at e = 0.5."""
    run = phase_runs(a)[0]
    return Made(
        f"μ = 0.1, γ = 0.5, e = 0.5, ζ = {a.damping_ratio:g}",
        {"trajectory": run.trajectory(100), "impacts": run.impacts},
        [],
        lambda: drawing.phase(run),
    )


def fig11(a: Assumptions) -> Made:
    """Phase plane at e = 0.9, and what the two tell."""
    run = phase_runs(a)[1]
    return Made(
        f"μ = 0.1, γ = 0.5, e = 0.9, ζ = {a.damping_ratio:g}",
        {"trajectory": run.trajectory(100), "impacts": run.impacts},
        [fewer_and_harder(a)],
        lambda: drawing.phase(run),
    )


def fewer_and_harder(a: Assumptions) -> Finding:
    """S9: at e = 0.5 fewer impacts, each with more loss, than at 0.9."""
    counts, losses, times = [], [], []
    for run in phase_runs(a):
        settled = run.summary["settling_time_5"].item()
        until = run.impacts if settled is None else run.impacts.filter(pl.col("time") <= settled)
        counts.append(until.height)
        losses.append(mean_size(until["energy_loss"]))
        times.append(np.inf if settled is None else settled)
    views = [
        View("impacts until 5 %", counts[0] < counts[1], f"{counts[0]} / {counts[1]}"),
        View("mean loss an impact", losses[0] > losses[1], f"{losses[0]:.4f} / {losses[1]:.4f}"),
        View("settling to 5 %", bool(times[0] < times[1]), f"{times[0]:.0f} / {times[1]:.0f}"),
    ]
    return Finding(
        "S9",
        "Figs 10 and 11",
        "With e = 0.5 there are fewer impacts than with 0.9, each takes more energy, and together "
        "they take more.",
        views,
        f"Until |x| stays below 5 %: {counts[0]} impacts of {losses[0]:.4f} M x₀² ωn² on average "
        f"against {counts[1]} of {losses[1]:.4f}; {times[0]:.0f}/ωn against {times[1]:.0f}/ωn.",
    )


def with_clearance(absorber: iva.Siva, gamma: float) -> iva.Siva:
    """Return the free mass with another clearance."""
    return iva.Siva(
        mass_ratio=absorber.mass_ratio, restitution=absorber.restitution, relative_clearance=gamma
    )
