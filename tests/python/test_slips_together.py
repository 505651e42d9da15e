"""Masses at one point with one coefficient of friction slip and stop at the same instants."""

from __future__ import annotations

import numpy as np
import pytest

import iva


def test_two_masses_that_rub_alike_move_as_one() -> None:
    """In gaps that they do not reach: as one with the mass of both."""
    primary = iva.Primary(damping_ratio=0.02)
    force = iva.Harmonic(amplitude=0.2, frequency=0.9)

    def run(*shares: float) -> iva.Run:
        blocks = [
            iva.Siva(mass_ratio=share, restitution=0.5, clearance=90.0, friction=0.1, gravity=1.0)
            for share in shares
        ]
        start = iva.Start(displacement=0.5)
        return iva.simulate(blocks, primary, start=start, force=force, duration=120.0)

    both, whole = run(0.03, 0.05), run(0.08)
    assert both.summary["outcome"].item() == whole.summary["outcome"].item() == "finished"
    times = np.linspace(1.0, 119.0, 200)
    seen = whole.at(times)["gap_displacement"].to_numpy()
    assert np.ptp(seen) > 0.1
    for absorber in (0, 1):
        rows = both.at(times)
        own = rows.filter(rows["absorber"] == absorber)["gap_displacement"].to_numpy()
        assert own == pytest.approx(seen, abs=1e-11)


def test_two_masses_slip_off_their_stops_at_one_instant() -> None:
    """On a structure with two modes, soon after another mass has met its stop."""
    rough = {"friction": 0.02, "gravity": 9.81}
    masses = [
        iva.Siva(
            mass=6.450838071564394,
            restitution=0.453427881988751,
            clearance=0.0197358614945564,
            **rough,
        ),
        iva.Siva(
            mass=5.501425838986249,
            restitution=0.5064284147098852,
            clearance=0.007349645903825132,
            gap_offset=0.0011024468855737697,
            **rough,
        ),
        iva.Siva(
            mass=2.3065069627226866,
            restitution=0.7199453446222068,
            clearance=0.016253854175405574,
        ),
    ]
    structure = iva.Structure(
        frequencies=[10.0, 27.0],
        damping_ratios=[0.03, 0.02],
        points={"top": [0.1, 0.07], "mid": [0.06, -0.08]},
        absorber_at=["mid", "mid", "top"],
        force_at="top",
        seen_at="top",
    )
    start = iva.Start(
        displacements=(0.01167874597158631, -0.017044059569441224),
        velocities=(-22.32981551897693, 0.7779458605127492),
        gap_displacement=(0.0197358614945564, 0.008452092789398902, 0.016253854057674436),
        gap_velocity=(0.0, 0.0, 0.1177315884754475),
        time=66.83385976751981,
    )
    force = iva.Harmonic(force=373.02335021327144, frequency=10.405663860766591)
    run = iva.simulate(masses, structure, start=start, force=force, duration=0.05)
    assert run.summary["outcome"].item() == "finished"
    at = run.at([66.88])["gap_velocity"]
    assert at[0] == pytest.approx(at[1], abs=1e-12)
    assert at[0] < 0.0
