"""Which attractors random starts end in, and how often."""

from __future__ import annotations

import math

from iva import dynamics
from report import NAMES, Report, read, scene


def attractors(report: Report) -> None:
    """Compare names, pairs and the share of aperiodic motions with the records."""
    records = read("attractors.json")
    report.head(f"{len(records)} scenes of 120 starts each")
    unlike, worst = 0, 0.0
    for name, record in records.items():
        siva, primary, force = scene(record)
        assert siva.clearance is not None
        halves = (2.0, 2.0, 0.95 * siva.clearance, 2.0 * siva.clearance)
        box = {one: (-half, half) for one, half in zip(NAMES, halves, strict=True)}
        starts = record["starts"]
        found = dynamics.attractors(siva, primary, force=force, starts=starts, seed=5, box=box)
        hits = {
            kind: sum(n for key, n in record["hits"].items() if key.partition("#")[0] == kind)
            for kind in (*record["periodic_attractors"], "aperiodic")
        }
        pairs = {one.name: one.pair for one in found.attractors}
        true = record["periodic_attractors"]
        if pairs != {one: true.count(one) == 2 for one in true} or found.left_out:
            unlike += 1
            report.fault(f"{name}: {', '.join(true) or 'aperiodic'} was not found, but {pairs}")
        for kind, count in hits.items():
            share = count / starts
            sigma = math.sqrt(max(2.0 * starts * share * (1.0 - share), 1.0))
            worst = max(worst, abs(found.counts().get(kind, 0) - count) / sigma)
    report.count("scenes with other attractors than the reference", unlike)
    report.line("counts of starts, in sigma", worst, 3.0)
