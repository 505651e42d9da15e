"""Lyapunov exponents: of chaos, and of a torus."""

from __future__ import annotations

import math

from iva import dynamics
from report import Report, read, scene


def exponents(report: Report) -> None:
    """Compare exponents with those of ten runs of a million periods each."""
    for name, record in read("exponents.json").items():
        siva, primary, force = scene(record)
        if name == "Q1":
            # A torus around an unstable orbit: its largest exponent is 0.
            x, v, y, w = record["centre_strobe"]
            start = (x + 0.1, v, y, w)
            found = dynamics.lyapunov(
                siva, primary, force=force, start=start, discard=2000, seeds=2
            )
            report.head(f"{name}: a torus")
            report.line("largest exponent", abs(found.exponents[0]), 1e-4)
            report.count("taken for another motion", int(found.sign != 0))
        else:
            found = dynamics.lyapunov(siva, primary, force=force, seed=3)
            error = math.hypot(found.standard_errors[0], record["standard_error"][0])
            off = abs(found.exponents[0] - record["spectrum"][0])
            report.head(f"{name}: chaos, largest exponent {found.exponents[0]:.5f}")
            report.line("its error, in combined standard errors", off / error, 4.0)
        assert found.sum_error is not None
        report.line("sum of the exponents less its exact value", abs(found.sum_error), 1e-12)
