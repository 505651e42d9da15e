"""What iva.identify promises, beside what it does: ``make check-identify``.

Three records made elsewhere (tests/data/identification), whose truth their JSON files have; then
fresh records with restitution that scatters by 5 %, made by tests/python/planted_decays.py.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from time import perf_counter

import numpy as np
import polars as pl

import iva

TESTS = Path(__file__).parents[1]
sys.path.insert(0, str(TESTS / "python"))
from planted_decays import Chain, Truth, drawn, flights, law_of, record  # noqa: E402

DATA = TESTS / "data" / "identification"
#: The record that everybody gets, as an example.
SHIPPED = {"public_1_acceleration": TESTS.parent / "studies" / "decay.csv"}
#: Largest relative errors that are asked for.
ASKED = {
    "public_1_acceleration": {
        "frequency_hz": 1e-3,
        "damping_ratio": 0.1,
        "mass_ratio": 0.03,
        "restitution": 0.03,
        "gap_mm": 0.03,
    },
    "public_3_pendulum_laser": {"frequency_ratio": 0.01, "gap_mm": 0.01},
}
ASKED["public_2_offset_bias"] = ASKED["public_1_acceleration"]
#: Numbers whose intervals are counted, and the factor from the truth's unit.
COUNTED = {
    "frequency_hz": 1.0,
    "damping_ratio": 1.0,
    "mass_ratio": 1.0,
    "restitution": 1.0,
    "gap": 1e3,
    "displacement": 1e3,
}
ROWS = {"gap": "gap_mm", "displacement": "displacement_mm"}


def row(fit: iva.Fit, name: str) -> dict[str, float]:
    """Return value, low and high of a number."""
    return fit.parameters.filter(pl.col("parameter") == name).row(0, named=True)


def public(name: str, asked: dict[str, float]) -> bool:
    """Print what is found of a record beside its truth; return whether all is within bounds."""
    told = json.loads((DATA / f"{name}.json").read_text())
    begun = perf_counter()
    read = iva.Measured.read(SHIPPED.get(name, DATA / f"{name}.csv"))
    kind = iva.Piva() if told["kind"] == "piva" else iva.Siva()
    given = told["given_to_the_user"]
    start = {}
    if "release_s" in given:
        start["time"] = given["release_s"]
    if "gap_displacement_mm" in given:
        start["gap_displacement"] = given["gap_displacement_mm"] / 1000
    fit = iva.identify(read, kind, iva.Primary(), start=iva.Start(**start))
    print(f"{name}: {perf_counter() - begun:.1f} s, {fit.impacts.height} impacts used")
    well = True
    for key, bound in asked.items():
        found, truth = row(fit, key), told["truth"][key]
        error = found["value"] / truth - 1
        inside = found["low"] <= truth <= found["high"]
        well &= abs(error) <= bound and inside
        print(
            f"  {key:16} {found['value']:.6g} ({found['low']:.6g} … {found['high']:.6g}), true "
            f"{truth:g}: {100 * error:+.3f} %, {100 * bound:g} % asked, "
            f"{'inside' if inside else 'OUTSIDE'}"
        )
    if not fit.adequate:
        print(f"  not adequate: {'; '.join(fit.reasons)}")
    return well and fit.adequate


#: Chains of fresh records, by what is printed.
CHAINS: dict[str, dict[str, object]] = {
    "linear phase": {},
    "zero phase, corner 0.35": {"filter": "zero phase", "cutoff": 0.35},
    "causal, corner 0.35": {"filter": "causal", "cutoff": 0.35},
    "no filter, contacts of 1 ms": {"filter": "none", "contact": 1e-3},
    "velocity": {"quantity": "velocity", "noise": 1e-3, "bit": 1e-4},
}


def coverage(count: int, title: str, changed: dict[str, object]) -> bool:
    """Print how many intervals hold the truth in fresh records; return whether as many as asked.

    Beside them the mean error in standard deviations, of which a fit without bias has none.
    """
    inside = dict.fromkeys(COUNTED, 0)
    off: dict[str, list[float]] = {name: [] for name in COUNTED}
    refused, unfit, longest = 0, 0, 0.0
    for seed in range(1000, 1000 + count):
        truth, chain = drawn(seed, scatter=0.05, **changed)
        begun = perf_counter()
        try:
            fit = iva.identify(record(truth, chain), iva.Siva(), iva.Primary())
        except ValueError as said:
            refused += 1
            print(f"  seed {seed}: {said}")
            continue
        longest = max(longest, perf_counter() - begun)
        unfit += not fit.adequate
        for name, factor in COUNTED.items():
            found, true = row(fit, ROWS.get(name, name)), getattr(truth, name) * factor
            inside[name] += found["low"] <= true <= found["high"]
            off[name].append(3.29 * (found["value"] - true) / (found["high"] - found["low"]))
    seen = count - refused
    told = ", ".join(
        f"{name} {held} ({np.mean(off[name]) if seen else np.nan:+.2f})"
        for name, held in inside.items()
    )
    share = 100 * sum(inside.values()) / max(len(inside) * seen, 1)
    print(
        f"{count} fresh records, {title}, scatter 5 %: of {seen} identified the 90 % intervals "
        f"hold (mean error in deviations) {told}\n"
        f"  in all {share:.1f} %, 84 … 95 asked; called inadequate: {unfit}; refused: {refused}; "
        f"the longest took {longest:.0f} s"
    )
    return 84 <= share <= 95


def one_impact() -> bool:
    """Print what is said of a record with one impact."""
    truth = Truth(release=0.25, gap_displacement=0.2e-3, gap=31e-3)
    free = flights(truth, 3.0, law_of(truth, np.random.default_rng(4)))
    seconds = truth.release + free[1]["time"] - 0.02
    fit = iva.identify(record(truth, Chain(seed=4, seconds=seconds)), iva.Siva(), iva.Primary())
    print(f"one impact: {'; '.join(fit.combinations)}")
    return len(fit.combinations) == 2


def falling() -> bool:
    """Print what is said of restitution that falls with speed."""
    truth = Truth(release=0.25, restitution=0.72, falling=0.25, scatter=0.03)
    fit = iva.identify(record(truth, Chain(seed=24)), iva.Siva(), iva.Primary())
    print(f"restitution that falls with speed: {'; '.join(fit.reasons) or 'NOT SEEN'}")
    return not fit.adequate


def main() -> int:
    """Print all; return 0 if all is well."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--records", type=int, default=100, help="fresh records")
    count = parser.parse_args().records
    well = [public(name, asked) for name, asked in sorted(ASKED.items())]
    well += [one_impact(), falling()]
    if count:
        well += [coverage(count, title, changed) for title, changed in CHAINS.items()]
    return 0 if all(well) else 1


if __name__ == "__main__":
    sys.exit(main())
