"""Figs 6 to 9: impacts and damping of the free mass over its clearance."""

from __future__ import annotations

from functools import cache, partial
from itertools import pairwise

import numpy as np
import polars as pl

import iva
from iva.paper import drawing, scenes
from iva.paper.assumptions import Assumptions
from iva.paper.made import Made
from iva.paper.measures import (
    MEASURES,
    TO_5,
    Curve,
    best,
    by_measure,
    mean_over,
    percent,
    shown,
    smoothed,
    within,
    worse,
)
from iva.paper.verdicts import Finding, View

CLEARANCES = [round(0.1 + 0.01 * i, 2) for i in range(111)]
MASS_RATIOS = [0.05, 0.1, 0.15, 0.2]
RESTITUTIONS = [round(0.1 * i, 1) for i in range(1, 10)]
AT = np.array(CLEARANCES)


@cache
def over_mass(a: Assumptions) -> iva.Table:
    """Return the decays of Figs 6 and 7."""
    over = {"mass_ratio": MASS_RATIOS, "relative_clearance": CLEARANCES}
    return scenes.decays(scenes.siva(a), scenes.primary(a), over, ["impacts", "envelope"])


@cache
def over_restitution(a: Assumptions) -> iva.Table:
    """Return the decays of Figs 8 and 9."""
    over = {"restitution": RESTITUTIONS, "relative_clearance": CLEARANCES}
    return scenes.decays(scenes.siva(a), scenes.primary(a), over, ["impacts", "envelope"], 120.0)


#: Periods after which impacts are counted too: |x| is small by then, the mass still rattles.
SPAN = 20.0


def counted(table: iva.Table) -> pl.DataFrame:
    """Return the summary with the numbers of impacts until 5 % (or the end), and in 20 periods."""
    times = table.summary.select("point", "settling_time_5")
    impacts = table.impacts.join(times, on="point")
    settled = pl.col("settling_time_5")
    counts = impacts.group_by("point").agg(
        impacts_until_5=(settled.is_null() | (pl.col("time") <= settled)).sum().cast(pl.Int64),
        impacts_in_20=(pl.col("time") <= 2.0 * np.pi * SPAN).sum().cast(pl.Int64),
    )
    return table.summary.join(counts, on="point", how="left", maintain_order="left").with_columns(
        pl.col("impacts_until_5", "impacts_in_20").fill_null(0)
    )


#: The columns of these numbers, and what they are called.
COUNTS = {"impacts_until_5": "until 5 %", "impacts_in_20": "in 20 periods"}


def rows(values: Curve, count: int) -> Curve:
    """Return one row a curve."""
    return values.reshape(count, len(CLEARANCES))


def fig6(a: Assumptions) -> Made:
    """Count impacts over the clearance, for several masses."""
    summary = counted(over_mass(a))
    return Made(
        f"e = {a.restitution:g}, ζ = {a.damping_ratio:g}, μ = 0.05 to 0.2, γ = 0.1 to 1.2; impacts "
        "until |x| stays below 5 %",
        {"summary": summary},
        [falls_with_clearance(summary)],
        partial(drawing.impact_curves, summary, "mass_ratio", "μ"),
    )


def falls_with_clearance(summary: pl.DataFrame) -> Finding:
    """S3: most impacts at γ = 0.1, fewest at 1."""
    views = []
    shares = []
    for column, name in COUNTS.items():
        counts = rows(summary[column].to_numpy().astype(float), len(MASS_RATIOS))[:, AT <= 1.0]
        for mu, curve in zip(MASS_RATIOS, counts, strict=True):
            ends = bool(curve[0] == curve.max() and curve[-1] <= np.quantile(curve, 0.1))
            value = f"{curve[0]:.0f} → {curve[-1]:.0f}"
            views.append(View(f"{name}, μ = {mu}", ends, value))
        if column == "impacts_until_5":
            shares = [float(np.mean(np.diff(curve) <= 0)) for curve in counts]
    return Finding(
        "S3",
        "Fig. 6",
        "The number of impacts falls with the clearance: most at γ = 0.1, fewest at 1.",
        views,
        "A view holds when the number at 0.1 is the largest and that at 1 among the lowest tenth "
        f"(γ up to 1). Until 5 %, {percent(min(shares))} to {percent(max(shares))} of the steps "
        "of 0.01 do not rise. Where chatter ends in stick the number is one of the floor below "
        "which rebounds are summed.",
    )


def fig7(a: Assumptions) -> Made:
    """Damping over the clearance, for several masses, by every measure."""
    table = over_mass(a)
    masses = over_many_masses(a)
    return Made(
        f"e = {a.restitution:g}, ζ = {a.damping_ratio:g}, μ = 0.05 to 0.2, γ = 0.1 to 1.2",
        {"summary": table.summary, "mass_ratios": masses},
        [
            peaks_between(table),
            mass_matters_little(table.summary),
            small_mass_is_weak(a),
            number_is_not_the_key(counted(table)),
            tenth_is_enough(masses, a.dampings),
        ],
        partial(drawing.damping_panels, table.summary, "relative_clearance", "mass_ratio", "μ"),
    )


def peaks_between(table: iva.Table) -> Finding:
    """S4: the damping peaks at γ from 0.4 to 0.6."""
    views = []
    at = AT[AT <= 1.05]
    for label, damping in by_measure(table, (8, 9)).items():
        for mu, curve in zip(MASS_RATIOS, rows(damping, len(MASS_RATIOS)), strict=True):
            peak = best(at, smoothed(curve)[AT <= 1.05])
            holds = within(peak, 0.35, 0.65)
            views.append(View(f"{label}, μ = {mu}", holds, f"γ = {shown(peak, 2)}"))
    return Finding(
        "S4",
        "Fig. 7",
        "The damping ratio is largest at a clearance γ of 0.4 to 0.6.",
        views,
        f"In {sum(view.holds is True for view in views)} of {len(views)} views. A view holds when "
        "the peak of the running mean over 0.05 lies in 0.35 to 0.65 (γ up to 1.05). Late "
        "measures are jagged: another mean or grid moves their peaks.",
    )


def mass_matters_little(summary: pl.DataFrame) -> Finding:
    """S5: beyond γ = 1 the mass has little effect."""
    views = []
    for measure in MEASURES:
        curves = rows(measure.of(summary), len(MASS_RATIOS))[:, AT >= 1.0]
        # Where it does not settle a mean says nothing.
        means = np.where((curves > 0.0).all(axis=1), mean_over(curves), np.nan)
        known = not np.isnan(means).any()
        value = " ".join(shown(mean, 3) for mean in means)
        views.append(
            View(measure.label, bool(means.max() <= 1.5 * means.min()) if known else None, value)
        )
    return Finding(
        "S5",
        "Fig. 7",
        "Beyond γ of about 1 the mass ratio has little effect.",
        views,
        "Values: means over γ = 1 to 1.2 at μ = 0.05, 0.1, 0.15, 0.2. 'Little' is taken as a "
        "factor of 1.5 between the largest and the smallest.",
    )


def small_mass_is_weak(a: Assumptions) -> Finding:
    """S6: μ = 0.05 damps less than 0.1."""
    over = {"mass_ratio": [0.05, 0.1], "relative_clearance": [0.48, 0.49, 0.5, 0.51, 0.52]}
    summary = scenes.decays(scenes.siva(a), scenes.primary(a), over).summary
    views = []
    for measure in MEASURES:
        small, large = mean_over(measure.of(summary).reshape(2, 5))
        value = f"{shown(small, 3)} / {shown(large, 3)}"
        views.append(View(measure.label, worse(small, large), value))
    return Finding(
        "S6",
        "4.1, with Fig. 7",
        "A small mass ratio such as 0.05 makes the absorber less effective.",
        views,
        "Compared with μ = 0.1, means over γ = 0.48 to 0.52.",
    )


def number_is_not_the_key(summary: pl.DataFrame) -> Finding:
    """S10: more impacts, slower decay."""
    at = summary.filter(pl.col("mass_ratio") == 0.1)
    small, middle = (at.filter((pl.col("relative_clearance") - g).abs() < 1e-9) for g in (0.1, 0.6))
    rates = [float(TO_5.of(part)[0]) for part in (small, middle)]
    times = [part["settling_time_5"].item() or np.inf for part in (small, middle)]
    views = []
    for column, name in COUNTS.items():
        counts = [int(part[column].item()) for part in (small, middle)]
        slower = worse(*rates)
        holds = None if slower is None else slower and counts[0] > counts[1]
        views.append(View(f"{name}, γ = 0.1 and 0.6", holds, f"{counts[0]} / {counts[1]} impacts"))
    return Finding(
        "S10",
        "4.1, conclusions",
        "The number of impacts is not what decides.",
        views,
        "A view holds when γ = 0.1 has more impacts than 0.6 and yet settles later (μ = 0.1). "
        f"|x| stays below 5 % from {shown(times[0], 0)}/ωn and {shown(times[1], 0)}/ωn on.",
    )


@cache
def over_many_masses(a: Assumptions) -> pl.DataFrame:
    """Return decays over the mass ratio at the recommended clearances, for three dampings."""
    over = {
        "damping_ratio": a.dampings,
        "relative_clearance": [0.4, 0.45, 0.5, 0.55, 0.6],
        "mass_ratio": [round(0.01 * i, 2) for i in range(1, 41)],
    }
    return scenes.decays(scenes.siva(a), scenes.primary(a), over).summary


def tenth_is_enough(summary: pl.DataFrame, dampings: tuple[float, ...]) -> Finding:
    """S11: a mass ratio of about 0.1 is best, or enough."""
    masses = summary["mass_ratio"].unique().sort().to_numpy()
    views = []
    for measure in MEASURES:
        of_dampings = measure.of(summary).reshape(len(dampings), -1, len(masses))
        for damping, curves in zip(dampings, of_dampings, strict=True):
            peaks = [best(masses, smoothed(curve)) for curve in curves]
            near = sum(within(peak, 0.07, 0.14) is True for peak in peaks)
            value = ", ".join(shown(peak, 2) for peak in peaks)
            holds = None if np.isnan(peaks).all() else near >= 3
            views.append(View(f"best: {measure.label}, ζ = {damping:g}", holds, value))
            means = mean_over(curves.T)
            top = means.max() if np.isfinite(means).all() else np.nan
            share = means[(masses > 0.085) & (masses < 0.115)].mean() / top if top > 0.0 else np.nan
            enough = within(share, 0.75, np.inf)
            views.append(View(f"enough: {measure.label}, ζ = {damping:g}", enough, percent(share)))
    return Finding(
        "S11",
        "abstract, conclusions",
        "A mass ratio of about 0.1 is to be recommended.",
        views,
        "Best: the best μ up to 0.4 at γ = 0.4, 0.45, 0.5, 0.55, 0.6 (running mean over 0.05); "
        "holds when three of them lie in 0.07 to 0.14: in "
        f"{sum(view.holds is True for view in views if view.name.startswith('best'))} of "
        f"{len(views) // 2}. Enough: damping at μ = 0.1 over the largest, mean over γ; holds from "
        "three quarters on: in "
        f"{sum(view.holds is True for view in views if view.name.startswith('enough'))}.",
    )


def fig8(a: Assumptions) -> Made:
    """Count impacts over the clearance, for several restitutions."""
    summary = counted(over_restitution(a))
    drawn = summary.filter(pl.col("restitution").is_in([0.1, 0.3, 0.5, 0.7, 0.9]))
    return Made(
        f"μ = {a.mass_ratio:g}, ζ = {a.damping_ratio:g}, e = 0.1 to 0.9, γ = 0.1 to 1.2. The "
        "captions of Figs 8 and 9 are exchanged against the text; here the text counts",
        {"summary": summary},
        [rises_with_restitution(a)],
        partial(drawing.impact_curves, drawn, "restitution", "e"),
    )


@cache
def along_restitution(a: Assumptions) -> iva.Table:
    """Return decays over a fine grid of e at γ = 0.5."""
    over = {"restitution": [round(0.02 * i, 2) for i in range(2, 49)]}
    absorber = scenes.siva(a, relative_clearance=0.5)
    return scenes.decays(absorber, scenes.primary(a), over, ["impacts", "envelope"], 120.0)


def rises_with_restitution(a: Assumptions) -> Finding:
    """S7: more impacts with a larger e."""
    summary = counted(along_restitution(a))
    steps = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]
    views = []
    for column, name in COUNTS.items():
        counts = {
            e: int(summary.filter((pl.col("restitution") - e).abs() < 1e-9)[column].item())
            for e in steps
        }
        for low in (0.1, 0.4):
            series = [counts[e] for e in steps if e >= low]
            rises = all(one < following for one, following in pairwise(series))
            views.append(View(f"{name}, e from {low} to 0.9", rises, " ".join(map(str, series))))
    return Finding(
        "S7",
        "4.1, Fig. 8 of the text",
        "The number of impacts rises with the coefficient of restitution.",
        views,
        f"At γ = 0.5 and μ = {a.mass_ratio:g}, in steps of 0.1. Where e is small chatter, with "
        "its many small rebounds, can raise the number again.",
    )


def fig9(a: Assumptions) -> Made:
    """Damping over the clearance, for several restitutions, by every measure."""
    summary = over_restitution(a).summary
    drawn = summary.filter(pl.col("restitution").is_in([0.1, 0.3, 0.5, 0.7, 0.9]))
    return Made(
        f"μ = {a.mass_ratio:g}, ζ = {a.damping_ratio:g}, e = 0.1 to 0.9, γ = 0.1 to 1.2",
        {"summary": summary},
        [best_at_half(a)],
        partial(drawing.damping_panels, drawn, "relative_clearance", "restitution", "e"),
    )


def best_at_half(a: Assumptions) -> Finding:
    """S8: the damping is largest at e of about 0.5."""
    table = along_restitution(a)
    at = table.summary["restitution"].to_numpy()
    views = []
    for label, curve in by_measure(table, (8, 9)).items():
        peak = best(at, smoothed(curve))
        views.append(View(label, within(peak, 0.4, 0.6), f"e = {shown(peak, 2)}"))
    return Finding(
        "S8",
        "4.1, Fig. 9 of the text",
        "The damping ratio is largest at e of about 0.5.",
        views,
        f"At γ = 0.5 and μ = {a.mass_ratio:g}, e from 0.04 to 0.96; a view holds when the best e "
        "(running mean over 0.1) lies in 0.4 to 0.6.",
    )
