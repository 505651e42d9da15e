"""What was hardly meant, as metres for millimetres: one warning, and none for what is meant so."""

from __future__ import annotations

import warnings
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import iva
from iva import _iva
from iva.sampling import LogNormal, Normal, Sobol, Uniform

METRIC = iva.Primary(mass=3.0, stiffness=12_000.0)


def siva(**gap: float) -> iva.Siva:
    return iva.Siva(mass_ratio=0.1, restitution=0.5, **gap)


def told(call: Any, *parts: Any, **arguments: Any) -> list[str]:
    """Return what a call warns of; each warning must point to this file."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        call(*parts, **arguments)
    for one in caught:
        assert one.category is UserWarning
        assert one.filename == __file__
    return [str(one.message) for one in caught]


def run(absorber: Any, start: dict[str, float], primary: Any = METRIC) -> list[str]:
    return told(iva.simulate, absorber, primary, start=iva.Start(**start), duration=0.1)


def swept(
    over: Any, start: dict[str, float] | None = None, sampling: Any = "grid", **gap: float
) -> list[str]:
    return told(
        iva.sweep,
        siva(**gap),
        METRIC,
        over=over,
        sampling=sampling,
        start=iva.Start(**(start or {"displacement": 0.004})),
        duration=0.1,
    )


def test_a_gap_in_metres() -> None:
    assert run(siva(gap=4.0), {"displacement": 0.004}) == [
        "absorber.gap = 4 m is 1000 times start.displacement = 0.004 m: lengths are in metres "
        "where the primary mass is given; where millimetres are meant, give gap_mm"
    ]
    (said,) = run(siva(clearance=3.0), {"displacement_mm": -4.0})
    assert said.startswith("absorber.clearance = 3 m is 750 times start.displacement_mm = -4 mm: ")
    assert said.endswith("give clearance_mm")
    pendulum = iva.Piva(mass=0.3, length=0.3, restitution=0.5, clearance=2.0)
    assert len(run(pendulum, {"displacement": 0.004})) == 1


def test_a_start_in_metres() -> None:
    (said,) = run(siva(clearance=0.003), {"displacement": 4.0})
    assert said.startswith("start.displacement = 4 m is 1333 times absorber.clearance = 0.003 m: ")
    assert said.endswith("give displacement_mm")
    (said,) = run(siva(gap_mm=6.0), {"displacement": 4.0})
    assert said.startswith("start.displacement = 4 m is 667 times absorber.gap_mm = 6 mm: ")


def test_a_start_from_which_no_structure_swings() -> None:
    # 4 m at 63.2 rad/s pass their rest with 253 m/s.
    assert run(None, {"displacement": 4.0}) == [
        "start.displacement = 4 m swings through its rest with 253 m/s: lengths are in metres "
        "where the primary mass is given; where millimetres are meant, give displacement_mm"
    ]
    assert len(run(siva(clearance=2.5), {"displacement": -4.0})) == 1, "both in the wrong unit"
    assert run(None, {"displacement": 4.0}, iva.Primary(mass=3e5, frequency_hz=0.3)) == []


def test_a_shock() -> None:
    # 0.1 m/s at 63.2 rad/s swing by 1.58 mm.
    (said,) = run(siva(clearance=3.0), {"impulse_velocity": 0.1})
    assert said.startswith(
        "absorber.clearance = 3 m is 1897 times the swing of start.impulse_velocity = 0.1 m/s: "
    )
    (said,) = run(siva(clearance=3.0), {"impulse": 0.3})
    assert "1897 times the swing of start.impulse = 0.3 N s: " in said
    for fast in ({"impulse_velocity": 200.0}, {"velocity": -200.0}, {"impulse": 600.0}):
        (said,) = run(siva(clearance=0.005), fast)
        assert "sets the structure off with 200 m/s: speeds are in m/s" in said
    (said,) = swept({"impulse_velocity": [0.1, 200.0, 300.0]}, {"displacement": 0.0}, gap_mm=5.0)
    assert said.startswith("sweep.impulse_velocity = 200 m/s sets the structure off with 200 m/s")


def test_metres_for_millimetres() -> None:
    assert run(siva(gap_mm=0.005), {"displacement_mm": 4.0}) == [
        "absorber.gap_mm = 0.005 mm is 800 times as small as start.displacement_mm = 4 mm: where "
        "metres are meant, give gap"
    ]


def test_contacts_that_are_no_impacts() -> None:
    # 63.2 rad/s have a period of 99.3 ms.
    assert run(siva(gap_mm=5.0, contact_time=0.02), {"displacement_mm": 4.0}) == [
        "a contact of the absorber lasts 20.13 % of a natural period: impacts take no time here, "
        "and contacts that last more than some 5 % change the motion"
    ]
    # With e = 1 half a period of a spring: π √(m/k) = 51.88 ms, m = 3 · 0.1/1.1 kg.
    soft = iva.Siva(mass_ratio=0.1, restitution=1.0, gap_mm=5.0, contact_stiffness=1_000.0)
    (said,) = run(soft, {"displacement_mm": 4.0})
    assert "lasts 52.22 % of" in said
    assert run(siva(gap_mm=5.0, contact_time=0.004), {"displacement_mm": 4.0}) == []
    natural = siva(clearance=1.0, contact_time=1.0)
    assert len(run(natural, {"displacement": 1.0}, iva.Primary(damping_ratio=0.01))) == 1
    pair = [siva(gap=0.004), siva(gap=0.004, contact_time=0.02)]
    (said,) = told(iva.simulate, pair, METRIC, start=iva.Start(displacement=0.004), duration=0.1)
    assert said.startswith("a contact of absorber 1 lasts 20.13 % of")


def test_impacts_that_follow_before_a_contact_would_have_ended(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    lasts = 0.004
    given = iva.Siva(mass_ratio=0.1, restitution=0.3, gap_mm=5.0, contact_time=lasts)
    made = iva.simulate(given, METRIC, start=iva.Start(displacement_mm=4.0), duration=2.0)
    times = made.impacts["time"].to_list()
    sooner = sum(later - time < lasts for time, later in pairwise(times))
    assert 0 < sooner < len(times) - 1
    said = f"a contact lasts 4.03 % of a natural period; {sooner} of {len(times)} impacts follow"
    assert f"  {said}" in str(made)
    study = tmp_path / "study.toml"
    quick = iva.simulate(given, METRIC, start=iva.Start(displacement_mm=4.0), duration=0.1)
    assert "no impact follows another one before" in str(quick)
    assert "contact lasts" not in str(
        iva.simulate(siva(gap_mm=5.0), METRIC, start=iva.Start(displacement_mm=4.0), duration=2.0)
    )
    study.write_text(
        "version = 1\n[primary]\nmass = 3.0\nstiffness = 12_000.0\n[absorber]\n"
        'kind = "siva"\nmass = 0.3\nrestitution = 0.3\ngap_mm = 5.0\ncontact_time = 0.004\n'
        "[start]\ndisplacement_mm = 4.0\n[run]\nduration = 2.0\n",
        encoding="utf-8",
    )
    assert _iva.main(["iva", "run", str(study), "--out", str(tmp_path / "out")]) == 0
    printed = " ".join(capfd.readouterr().out.split())
    assert f"{said[0].upper()}{said[1:]} another one" in printed


def test_a_damping_ratio_in_percent() -> None:
    damped = iva.Primary(mass=3.0, stiffness=12_000.0, damping_ratio=0.6)
    assert run(None, {"displacement_mm": 4.0}, damped) == [
        "primary.damping_ratio = 0.6 is 60 % of critical damping: where 0.6 % is meant, give 0.006"
    ]
    assert run(None, {"displacement": 4.0}, iva.Primary(damping_ratio=0.6)) == []


def test_each_absorber_of_a_list() -> None:
    pair = [siva(gap=0.004), siva(gap=4.0)]
    (said,) = told(iva.simulate, pair, METRIC, start=iva.Start(displacement=0.004), duration=0.1)
    assert said.startswith("absorber.1.gap = 4 m is 1000 times start.displacement = 0.004 m: ")


def test_the_command_says_the_same(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    study = tmp_path / "study.toml"
    study.write_text(
        "version = 1\n[primary]\nmass = 3.0\nstiffness = 12_000.0\n[absorber]\n"
        'kind = "siva"\nmass = 0.3\nrestitution = 0.5\n[start]\ndisplacement = 0.004\n'
        "[run]\nduration = 0.1\n[sweep]\ngap = [4.0, 5.0, 6.0]\n",
        encoding="utf-8",
    )
    (asked,) = swept({"gap": [4.0, 5.0, 6.0]})
    for command in ("check", "sweep"):
        out = [] if command == "check" else ["--out", str(tmp_path / "out")]
        assert _iva.main(["iva", command, str(study), *out]) == 0
        assert f"warning: {asked}" in capfd.readouterr().err.replace("\n", " ")
    quiet = ["--out", str(tmp_path / "quiet"), "--quiet"]
    assert _iva.main(["iva", "sweep", str(study), *quiet]) == 0
    assert capfd.readouterr().err == ""


# absorber, start
MEANT: list[tuple[iva.Siva | None, dict[str, float]]] = [
    (siva(gap=0.004), {"displacement": 0.004}),
    (siva(gap_mm=4.0), {"displacement_mm": 4.0}),
    (siva(clearance=0.4), {"displacement": 0.001}),
    (siva(clearance=0.003), {"displacement": 1.0}),
    (siva(clearance=0.003), {"displacement": 1e-6}),  # a gap of 3 µm nobody means
    (siva(gap_mm=4000.0), {"displacement": 0.004}),
    (siva(clearance=1e6), {"displacement": 0.004}),  # without stops
    (siva(clearance=0.3), {"velocity": 0.1}),
    (siva(clearance=3.0), {"displacement": 0.0}),
    (siva(relative_clearance=900.0), {"displacement": 0.004}),
    # On from another run, late in its decay.
    (siva(clearance=3.0), {"displacement": 0.001, "reference": 2.0, "time": 12.0}),
    (None, {"displacement": 0.5}),
    (None, {"displacement_mm": 4000.0}),
]


@pytest.mark.parametrize(("absorber", "start"), MEANT)
def test_lengths_that_are_meant(absorber: iva.Siva | None, start: dict[str, float]) -> None:
    assert run(absorber, start) == []


@pytest.mark.parametrize("primary", [iva.Primary(), iva.Primary(frequency_hz=3.0)])
def test_lengths_without_metres(primary: iva.Primary) -> None:
    assert run(siva(gap=4.0), {"displacement": 0.004}, primary) == []


def test_sweeps() -> None:
    mass = {"absorber.mass_ratio": [0.05, 0.1, 0.2]}
    assert len(swept(mass, gap=4.0)) == 1, "once, not once a point"
    assert swept(mass, gap=0.004) == []
    (said,) = swept({"absorber.gap": [3.0, 5.0, 4.0]}, clearance_mm=3.0)
    assert said.startswith(
        "sweep.gap = 4 m (the middle of the axis) is 1000 times start.displacement = 0.004 m: "
    )
    (said,) = swept({"displacement": [2.0, 4.0]}, gap_mm=4.0)
    assert said.startswith("sweep.displacement = 4 m (the middle of the axis) is 1000 times ")
    assert len(swept({"clearance": [2.0, 3.0], "displacement": [0.004, 0.005]}, None, "zip")) == 1


def test_sweeps_that_are_meant() -> None:
    assert swept({"clearance": [1e-4, 1e-3, 1e-2, 0.1, 1.0]}) == []
    # What is swept replaces what is given.
    for axis in ("gap_mm", "relative_clearance", "absorber.relative_clearance"):
        assert swept({axis: [2.0, 3.0]}, gap=4.0) == []
    assert swept({"displacement_mm": [3.0, 4.0]}, {"displacement": 4.0}, gap_mm=4.0) == []


@pytest.mark.parametrize("drawn", [Uniform(2.5, 3.5), Normal(3.0, 0.1), LogNormal(3.0, 0.1)])
def test_samples(drawn: Any) -> None:
    (said,) = swept({"clearance": drawn}, None, Sobol(4))
    assert said.startswith("sweep.clearance = 3 m (the middle of the axis) is 750 times start.")
    assert swept({"clearance_mm": drawn}, None, Sobol(4)) == []


def test_a_mass_that_is_swept() -> None:
    start = iva.Start(displacement=0.004)
    parts = (siva(gap=4.0), iva.Primary(natural_frequency=60.0))
    over = {"primary.mass": [2.0, 3.0]}
    assert len(told(iva.sweep, *parts, over=over, start=start, duration=0.1)) == 1
