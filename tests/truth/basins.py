"""Basins of attraction, cell by cell."""

from __future__ import annotations

import math

import numpy as np

from iva import dynamics
from report import Report, read, scene


def basins(report: Report) -> None:
    """Compare labels and counts with those of the records.

    Where the reference itself says that rounding decides (its hard cells), only counts compare.
    """
    for name, record in read("basins.json").items():
        siva, primary, force = scene(record)
        axes = [np.linspace(*record["grid"][one]) for one in ("first_axis", "second_axis")]
        over = dict(zip(("displacement", "velocity"), axes, strict=True))
        found = dynamics.basins(siva, primary, force=force, over=over)
        # Of the labels of a record the second axis goes along a row.
        true = np.array([[int(label) for label in row] for row in record["labels"]]).T
        hard = np.isin(np.arange(true.size), record["hard_cells"]).reshape(true.T.shape).T
        strobes = np.array([one["strobe_state"] for one in record["attractors"]])
        order = [int(np.abs(strobes - one.state).max(axis=1).argmin()) for one in found.attractors]
        sure = found.labels >= 0
        wrong = sure & (np.array([*order, -2, -1])[found.labels] != true) & ~hard
        report.head(f"{name}: {true.size} cells, {hard.sum()} of them hard")
        report.count("attractors too few or too many", abs(len(set(order)) - len(strobes)))
        report.count("cells with another label than the reference", int(wrong.sum()))
        undecided = round(found.undecided * true.size)
        report.told("cells not sure", str(undecided))
        for mine, theirs in enumerate(order):
            off = abs(found.fractions.get(mine, 0.0) * true.size - record["counts"][theirs])
            # Each of the cells that are not sure may be in either basin.
            sigma = math.sqrt(max(undecided, 1))
            what = f"count of attractor {mine} less {record['counts'][theirs]}, in sigma"
            report.line(what, off / sigma, 3.0)
