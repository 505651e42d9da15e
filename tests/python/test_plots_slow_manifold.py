"""A run over the slow manifold: the steady motion that it is made of lies on it."""

from __future__ import annotations

import numpy as np
import pytest

import iva

pytest.importorskip("matplotlib")

SIVA = iva.Siva(mass_ratio=0.001, restitution=0.6, clearance=1.0)


def drawn(axes: object, label: str) -> tuple[np.ndarray, np.ndarray]:
    """Return what has a label."""
    [line] = [one for one in axes.lines if one.get_label() == label]  # type: ignore[attr-defined]
    return np.asarray(line.get_xdata()), np.asarray(line.get_ydata())


def test_a_steady_motion_with_two_impacts_is_a_point_of_the_manifold() -> None:
    """To first order in μ (Gendelman 2012): 0.001 here. In SI units it is the same point."""
    manifold = iva.theory.slow_manifold(SIVA)
    primary = iva.Primary(damping_ratio=0.005)
    force = iva.Harmonic(amplitude=0.004, frequency=1.0)
    known = iva.theory.masri_caughey(SIVA, primary, force).stable
    assert known is not None
    run = iva.simulate(SIVA, primary, force=force, start=known.start, cycles=20)
    theta, xi = drawn(iva.plots.slow_manifold(run, discard=3), "run")
    assert theta.size == 36
    assert np.ptp(theta) < 1e-6
    for one, other in zip(theta, xi, strict=True):
        assert other == pytest.approx(manifold.amplitude(float(one)), rel=5e-3)
    mass, omega = 3.0, 7.0
    siva = iva.Siva(mass=0.001 * mass, restitution=0.6, clearance=1.0)
    heavy = iva.Primary(mass=mass, natural_frequency=omega, damping_ratio=0.005)
    shaker = iva.Harmonic(force=0.004 * mass * omega**2, frequency=omega)
    known = iva.theory.masri_caughey(siva, heavy, shaker).stable
    assert known is not None
    same = iva.simulate(siva, heavy, force=shaker, start=known.start, cycles=20)
    across, up = drawn(iva.plots.slow_manifold(same, discard=3), "run")
    assert across == pytest.approx(theta, rel=1e-6)
    assert up == pytest.approx(xi, rel=1e-6)


def test_the_curve_is_that_of_the_theory() -> None:
    manifold = iva.theory.slow_manifold(SIVA)
    primary, start = iva.Primary(damping_ratio=0.005), iva.Start(displacement=0.5)
    run = iva.simulate(SIVA, primary, start=start, periods=30)
    axes = iva.plots.slow_manifold(run)
    assert axes.get_ylabel() == "amplitude of the structure ξ"
    theta, xi = drawn(axes, "stable")
    there = ~np.isnan(xi)
    low, high = manifold.stable_theta
    assert low <= theta[there].min() <= theta[there].max() <= high
    rho = manifold.rho
    assert xi[there] == pytest.approx(np.hypot(theta[there] - 1.0, rho * theta[there]), rel=1e-12)


def test_a_run_without_impacts_shows_the_curve_alone() -> None:
    run = iva.simulate(SIVA, iva.Primary(), start=iva.Start(displacement=1e-3), periods=3)
    theta, _ = drawn(iva.plots.slow_manifold(run), "run")
    assert theta.size == 0


def test_what_cannot_be_shown_is_refused() -> None:
    primary, start = iva.Primary(), iva.Start(displacement=1.0)
    with pytest.raises(TypeError, match="run"):
        iva.plots.slow_manifold("run")  # type: ignore[arg-type]
    bare = iva.simulate(None, primary, start=start, periods=2)
    with pytest.raises(TypeError, match=r"give an iva\.Siva"):
        iva.plots.slow_manifold(bare)
    relative = iva.Siva(mass_ratio=0.1, restitution=0.6, relative_clearance=0.5)
    with pytest.raises(ValueError, match="clearance"):
        iva.plots.slow_manifold(iva.simulate(relative, primary, start=start, periods=2))
    few = iva.simulate(SIVA, primary, start=start, periods=2, tables=["impacts"])
    with pytest.raises(ValueError, match="envelope"):
        iva.plots.slow_manifold(few)
    whole = iva.simulate(SIVA, primary, start=start, periods=2)
    with pytest.raises(ValueError, match="discard"):
        iva.plots.slow_manifold(whole, discard=-1)
