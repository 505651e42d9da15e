"""What is printed of a run: units, what is missing, frequencies, what is carried along."""

from __future__ import annotations

import math
from typing import Any

import pytest

import iva

METRIC = iva.Primary(mass=3.0, stiffness=12_000.0, damping=2.0)
BLOCK = iva.Siva(mass=0.3, restitution=0.6, gap_mm=5.0)
RELEASE = iva.Start(displacement_mm=4.0)
SIVA = iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.4)
FRAME = iva.Structure(
    points=["first", "top"],
    mass=[[2000.0, 0.0], [0.0, 1000.0]],
    stiffness=[[300e3, -100e3], [-100e3, 100e3]],
    absorber_at="top",
    start_velocities=[0.1, 0.3],
)


def lines(run: iva.Run) -> list[str]:
    """Return what is printed of a run, line by line."""
    return [line.strip() for line in repr(run).splitlines()]


def decay(**changed: Any) -> iva.Run:
    """Return a decay of a structure with a block in it, in SI units."""
    given: dict[str, Any] = {"absorber": BLOCK, "primary": METRIC, "start": RELEASE, "duration": 3}
    return iva.simulate(**given | changed)


def test_times_have_their_unit() -> None:
    for primary, unit in (
        (iva.Primary(damping_ratio=0.01), "/ωn"),
        (iva.Primary(damping_ratio=0.01, frequency_hz=2.0), " s"),
    ):
        run = iva.simulate(SIVA, primary, start=iva.Start(displacement=1.0), periods=60)
        time = run.summary["settling_time_5"].item()
        assert f"settling_time_5 {time:.4g}{unit}, damping_ratio_3 0." in lines(run)[1]


def test_with_and_without_absorber_have_one_scale() -> None:
    # At resonance the bare structure swings by F/(c ω) = 4/(2 √(12000/3)) m = 31.62 mm.
    force = iva.Harmonic(force=4.0, relative_frequency=1.0)
    driven: dict[str, Any] = {"primary": METRIC, "force": force, "cycles": 800, "discard": 700}
    with_block = iva.simulate(
        iva.Siva(mass=0.3, restitution=0.6, gap=0.005), start=iva.Start(), **driven
    )
    amplitude = 1000 * with_block.summary["amplitude_max"].item()
    assert f"amplitude_max {amplitude:.4g} mm, without absorber 31.62 mm, red" in repr(with_block)
    bare = iva.simulate(None, start=iva.Start(), **driven)
    assert lines(bare)[1] == "amplitude_max 31.62 mm"


def test_what_is_missing_is_told_in_words() -> None:
    short = lines(decay(duration=0.05))[1]
    assert short == (
        "settling_time_5: no settling within the run, "
        "damping_ratio_3: fewer than 3 cycles in the run, "
        "residual_amplitude: the run is shorter than a period, or nothing moves"
    )
    settling = decay(duration=0.05, measures=["settling_time_5"])
    assert lines(settling)[:2] == [
        "Run: finished",
        "settling_time_5: no settling within the run",
    ]
    assert lines(decay(measures=["impacts"]))[1] == repr(BLOCK), "it was not asked for"
    early = lines(decay(max_impacts=2))
    assert early[0].startswith("Run: impact_limit; 2 impacts")
    missing = "settling_time_5, damping_ratio_3, residual_amplitude"
    assert early[1] == f"the run ended early: no {missing}"


@pytest.mark.parametrize(
    ("primary", "told"),
    [
        # 10 rad/s are 10/(2π) Hz, and √(12000/3) rad/s = 63.25 rad/s.
        (iva.Primary(natural_frequency=10.0), "10 rad/s = 1.592 Hz"),
        (iva.Primary(frequency_hz=10.0), "62.83 rad/s = 10 Hz"),
        (METRIC, "63.25 rad/s = 10.07 Hz"),
    ],
)
def test_a_frequency_is_told_in_both_units(primary: iva.Primary, told: str) -> None:
    assert repr(primary).endswith(f"; {told}")
    run = iva.simulate(None, primary, start=iva.Start(displacement=1e-3), periods=2)
    [line] = [one for one in lines(run) if one.startswith("Primary(")]
    assert line.endswith(f")  # {told}")
    assert told in run._repr_html_()


def test_frequencies_of_forces_and_structures_are_told_in_both_units() -> None:
    force = iva.Harmonic(amplitude=1.0, frequency=10.0)
    relative = iva.Harmonic(amplitude=1.0, relative_frequency=0.5)
    primary = iva.Primary(natural_frequency=20.0)
    run = iva.simulate(None, primary, start=iva.Start(), force=[force, relative], periods=2)
    assert [one.partition("# ")[2] for one in lines(run)[3:6]] == [
        "20 rad/s = 3.183 Hz",
        "10 rad/s = 1.592 Hz",
        "10 rad/s = 1.592 Hz",
    ]
    # Of two storeys in the class: ω² = 50 and 200 s⁻².
    frame = iva.simulate(None, FRAME, start=iva.Start(), duration=1.0)
    first, second = math.sqrt(50.0), math.sqrt(200.0)
    assert FRAME.modes()["frequency"].to_list() == pytest.approx([first, second], rel=1e-12)
    assert f"# {first:.4g} rad/s = {first / (2 * math.pi):.4g} Hz" in repr(frame)


def test_without_a_unit_of_time_there_are_no_hertz() -> None:
    run = iva.simulate(SIVA, iva.Primary(), start=iva.Start(displacement=1.0), periods=2)
    assert "Hz" not in repr(run)


def test_what_start_velocities_carry_along_is_told() -> None:
    block = iva.Siva(mass=50.0, restitution=0.6, gap_mm=40.0)
    run = iva.simulate(block, FRAME, start=iva.Start(), duration=1.0)
    carried = "start_velocities carry the absorber along: it starts with the velocity of its point"
    assert carried in lines(run)
    assert carried in run._repr_html_()
    first = run.at([0.0]).row(0, named=True)
    assert (first["velocity"], first["gap_velocity"]) == (pytest.approx(0.3), 0.0)
    two = iva.simulate([block, block], FRAME, start=iva.Start(), duration=1.0)
    assert "carry the absorbers along: each starts with the velocity of its point" in repr(two)
    for start, absorber in ((iva.Start(gap_velocity=-0.3), block), (iva.Start(), None)):
        assert "along" not in repr(iva.simulate(absorber, FRAME, start=start, duration=1.0))


def test_what_a_start_velocity_carries_along_is_told() -> None:
    def told(start: iva.Start) -> bool:
        run = iva.simulate(SIVA, iva.Primary(), start=start, periods=2)
        return "start.velocity carries the absorber along: it starts with that of" in repr(run)

    assert told(iva.Start(velocity=1.0))
    assert not told(iva.Start(velocity=1.0, gap_velocity=0.0))
    assert not told(iva.Start(impulse_velocity=1.0))
