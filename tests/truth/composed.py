"""Errors and gradients of scenes of many terms, beside runs of twice the precision.

``make check-errors``: random scenes of one to three absorbers with springs, dashpots, friction,
slopes, offsets and unlike walls, and pendulums, on one to three modes, free and driven. Each
estimate of the error of an instant stands beside its error, each derivative beside a difference of
two runs less their errors. Scenes are those of numbered seeds.
"""

from __future__ import annotations

import argparse
import sys
import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import polars as pl

import iva

#: An error counts as covered up to so many estimates.
TIMES = 3.0
#: Share of the errors that must be.
COVERED = 0.99
#: Step of a difference, relative; of two steps the derivative is that of Richardson.
STEP = 2.0**-28
#: What may be off of the largest derivative up to a row, and the least that counts as one.
ALLOWED, LEAST = 1e-9, 1e-2
#: Rows of a table beyond this condition have lost their digits in doubles and count in no test.
LARGEST = 1e6


def mass(rng: np.random.Generator, *, sloped: bool) -> iva.Siva:
    """Return a free mass with some terms."""
    names = {"mass_ratio": (0.02, 0.15), "clearance": (0.2, 1.0), "restitution": (0.3, 0.9)}
    terms: dict[str, Any] = {name: rng.uniform(*range_) for name, range_ in names.items()}
    chosen = rng.random(6) < 0.25
    if chosen[0]:
        terms["spring_ratio"] = rng.uniform(0.3, 2.5)
    if chosen[1]:
        terms["gap_damping_ratio"] = rng.uniform(0.01, 0.3)
    if chosen[2]:
        terms |= {"friction": rng.uniform(0.01, 0.1), "gravity": 1.0}
    if chosen[3]:
        terms["gap_offset"] = rng.uniform(-0.1, 0.1)
    if chosen[4] and sloped:
        terms |= {"inclination_deg": rng.uniform(2, 20), "gravity": 1.0}
    if chosen[5]:
        terms["restitution_minus"] = rng.uniform(0.3, 0.9)
    return iva.Siva(**terms)


def pendulum(rng: np.random.Generator) -> iva.Piva:
    """Return a pendulum."""
    length = rng.uniform(0.8, 2)
    return iva.Piva(
        mass_ratio=rng.uniform(0.02, 0.1),
        clearance=rng.uniform(0.2, 0.5) * length,
        restitution=rng.uniform(0.3, 0.9),
        frequency_ratio=rng.uniform(0.4, 1.2),
        length=length,
        pivot_damping_ratio=rng.uniform(0, 0.05),
    )


def composed(seed: int) -> dict[str, Any]:
    """Return the arguments of a run."""
    rng = np.random.default_rng(seed)
    modes = int(rng.choice([1, 1, 2, 3]))
    count = int(rng.choice([1, 2, 2, 3]))
    sloped = modes == 1
    swings = rng.random(count) < 0.2
    members = [pendulum(rng) if it else mass(rng, sloped=sloped) for it in swings]
    start: dict[str, Any] = {}
    primary: Any = iva.Primary(damping_ratio=rng.uniform(0.005, 0.05))
    if modes == 1:
        start = {"displacement": rng.uniform(0.5, 2), "velocity": rng.uniform(-0.5, 0.5)}
    else:
        shapes = rng.uniform(-1, 1, (2, modes))
        shapes[:, 0] = rng.uniform(0.6, 1, 2)
        primary = iva.Structure(
            frequencies=np.cumsum([1.0, *rng.uniform(0.6, 1.7, modes - 1)]).tolist(),
            damping_ratios=rng.uniform(0.005, 0.05, modes).tolist(),
            points={"top": shapes[0].tolist(), "side": shapes[1].tolist()},
            absorber_at=[str(it) for it in rng.choice(["top", "side"], count)],
            force_at="top",
            seen_at="top",
            start_displacements=rng.uniform(-1, 1, modes).tolist(),
            start_velocities=rng.uniform(-1, 1, modes).tolist(),
        )
        members = [in_kilograms(one) for one in members]
    speeds = rng.uniform(-0.3, 0.3, count).tolist()
    start["gap_velocity"] = speeds if count > 1 else speeds[0]
    driven = rng.random() < 0.5
    size = {"amplitude" if modes == 1 else "force": rng.uniform(0.1, 0.6)}
    force = iva.Harmonic(**size, frequency=rng.uniform(0.6, 1.6), phase=rng.uniform(0, 6))
    return {
        "absorber": members if count > 1 else members[0],
        "primary": primary,
        "start": iva.Start(**start),
        "force": force if driven else None,
        "duration": rng.uniform(8, 25),
    }


def in_kilograms(one: Any) -> Any:
    """Return an absorber with a mass in place of the share of it."""
    changed: dict[str, Any] = {"mass": one.mass_ratio, "mass_ratio": None}
    if getattr(one, "gap_damping_ratio", None) is not None:
        changed |= {"gap_damping": 2 * one.gap_damping_ratio * one.mass_ratio}
        changed["gap_damping_ratio"] = None
    if getattr(one, "spring_ratio", None) is not None:
        changed |= {"spring": one.spring_ratio**2 * one.mass_ratio, "spring_ratio": None}
    return replace(one, **changed)


def run(scene: dict[str, Any], **more: Any) -> iva.Run:
    """Return the run of a scene with its errors."""
    absorber, primary = scene["absorber"], scene["primary"]
    rest = {key: scene[key] for key in ("start", "force", "duration")}
    return iva.simulate(absorber, primary, **rest, verify=True, errors=True, **more)


def covered(seeds: range) -> bool:
    """Print how many errors of instants are within their estimates; return whether enough are."""
    total = within = lost = 0
    worst: list[tuple[float, int]] = []
    for seed in seeds:
        made = run(composed(seed))
        errors = made.verification.impacts["time"].abs()
        told = made.impacts["time_error"]
        both = pl.DataFrame({"error": errors, "told": told}).drop_nulls()
        lost += len(told) - len(both)
        ratios = (both["error"] / both["told"]).fill_nan(0.0)
        total += len(ratios)
        within += int((ratios <= TIMES).sum())
        if len(ratios):
            worst.append((float(ratios.max()), seed))  # type: ignore[arg-type]
    worst.sort(reverse=True)
    share = within / total
    print(f"{len(seeds)} scenes, {total} impacts: {share:.4%} within {TIMES:g} estimates")
    print(f"  without an error or an estimate: {lost}")
    largest = (f"{it:.2g} (seed {seed})" for it, seed in worst[:8])
    print("  largest shares of an estimate:", *largest)
    return share >= COVERED


def changeable(scene: dict[str, Any]) -> list[str]:
    """Return keys of numbers by which a run has derivatives."""
    members = scene["absorber"] if isinstance(scene["absorber"], list) else [scene["absorber"]]
    size = "mass" if isinstance(scene["primary"], iva.Structure) else "mass_ratio"
    return [f"absorber.{k}.{name}" for k in range(len(members)) for name in ("clearance", size)] + [
        f"absorber.{k}.restitution" for k in range(len(members))
    ]


def changed(scene: dict[str, Any], key: str, share: float) -> tuple[dict[str, Any], float]:
    """Return a scene with a number that is larger by this share, and that number."""
    _, index, name = key.split(".")
    members = scene["absorber"] if isinstance(scene["absorber"], list) else [scene["absorber"]]
    members = list(members)
    value = getattr(members[int(index)], name) * (1.0 + share)
    members[int(index)] = replace(members[int(index)], **{name: value})
    return {**scene, "absorber": members if len(members) > 1 else members[0]}, value


def exact(made: iva.Run, column: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the numbers of a column of impacts and their errors."""
    return made.impacts[column].to_numpy(), made.verification.impacts[column].to_numpy()


def difference(scene: dict[str, Any], key: str, column: str, rows: int) -> np.ndarray | None:
    """Return the derivative of a column by Richardson's rule from runs less their errors."""
    slopes = []
    for step in (STEP, STEP / 2):
        (high, top), (low, bottom) = (changed(scene, key, sign * step) for sign in (1, -1))
        above, below = (exact(run(one), column) for one in (high, low))
        if min(len(above[0]), len(below[0])) < rows:
            return None
        values = (above[0][:rows] - below[0][:rows]) - (above[1][:rows] - below[1][:rows])
        slopes.append(values / (top - bottom))
    derivative: np.ndarray = (4 * slopes[1] - slopes[0]) / 3
    return derivative


def derived(seeds: range) -> bool:
    """Print how far derivatives of instants and speeds are from differences, and the worst."""
    worst: list[tuple[float, str]] = []
    rows_seen = skipped = 0
    for seed in seeds:
        scene = composed(seed)
        keys = changeable(scene)
        key = keys[seed % len(keys)]
        made = run(scene, gradients=(key,))
        # Rows that have lost more digits than a derivative in doubles can keep.
        told = made.impacts["time_error"].fill_null(1.0).to_numpy()
        lost = np.flatnonzero(told > LARGEST * 2.0**-53)
        rows = int(lost[0]) if len(lost) else len(told)
        for column in ("time", "velocity_after"):
            truth = difference(scene, key, column, rows)
            if truth is None or not rows:
                # Beside the run there are fewer impacts: one begins or vanishes within the step.
                skipped += truth is None
                continue
            found = made.gradients[key].impacts[column].to_numpy()[:rows]
            size = np.maximum.accumulate(np.maximum(np.abs(truth), LEAST))
            off = np.abs(found - truth) / size
            kept = np.isfinite(off)
            rows_seen += int(kept.sum())
            if kept.any():
                worst.append((float(off[kept].max()), f"{key} of seed {seed}, {column}"))
    worst.sort(reverse=True)
    print(f"{len(seeds)} scenes, {rows_seen} derivatives, {skipped} columns without; farthest off:")
    for off, where in worst[:8]:
        print(f"  {off:.1e}  {where}")
    return worst[0][0] <= ALLOWED


def main() -> int:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=2000)
    parser.add_argument("--derived", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    seeds = range(given.first, given.first + given.scenes)
    right = [covered(seeds), derived(range(given.first, given.first + given.derived))]
    return 0 if all(right) else 1


if __name__ == "__main__":
    sys.exit(main())
