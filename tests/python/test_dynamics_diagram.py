"""Bifurcation diagrams: attractors of the references, hysteresis, units, what is refused."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import iva
from iva import dynamics

REFERENCE = Path(__file__).parents[1] / "reference"
SIVA = iva.Siva(mass_ratio=0.2, restitution=0.7)
PRIMARY = iva.Primary(damping_ratio=0.05)
FORCE = iva.Harmonic(amplitude=1.0, frequency=1.0)
#: Attractors of family A by clearance: impacts:periods.
ATTRACTORS = {
    float(one["scene"]["clearance"]): one
    for one in json.loads((REFERENCE / "attractors.json").read_text())
}


@pytest.fixture(scope="module")
def found() -> dynamics.Diagram:
    clearances = {"clearance": sorted(ATTRACTORS)}
    return dynamics.diagram(SIVA, PRIMARY, force=FORCE, over=clearances, discard=400, keep=40)


def periods_of(strobes: pl.DataFrame) -> int | None:
    """Return the number of strobes after which the last one repeats, up to 20."""
    x = strobes["displacement"].to_list()
    return next((n for n in range(1, 21) if abs(x[-1 - n] - x[-1]) < 1e-6), None)


def test_strobes_are_those_of_the_attractors_of_the_references(found: dynamics.Diagram) -> None:
    for clearance, record in ATTRACTORS.items():
        names = set(record["periodic_attractors"])
        for way in ("up", "down"):
            part = found.table.filter(value=clearance, direction=way)
            periods = periods_of(part)
            if names:
                [name] = names
                impacts, of = (int(number) for number in name.split(":"))
                assert periods == of, (clearance, way)
                assert part["impacts"].tail(of).sum() == impacts
            else:
                assert periods is None, (clearance, way)


def test_what_a_diagram_says_of_itself(found: dynamics.Diagram) -> None:
    table = found.table
    assert table.columns == [
        *("value", "direction", "cycle", "displacement", "velocity"),
        *("gap_displacement", "gap_velocity", "impacts"),
    ]
    assert table.height == 2 * 40 * len(ATTRACTORS)
    assert {one.outcome for one in found.outcomes} == {"finished"}
    assert [one.value for one in found.outcomes] == 2 * sorted(ATTRACTORS)
    assert repr(found).startswith("Diagram: 12 values of clearance from 1.2 to 6, up and down")
    again = pickle.loads(pickle.dumps(found))
    assert again == found
    assert again.table.equals(table)


def test_where_the_two_ways_differ_there_are_two_attractors() -> None:
    """At Ω = .7 and d = 2.7 a pair of 2:1 and a pair of 3:1 coexist (basins.json)."""
    siva = iva.Siva(mass_ratio=0.1, restitution=0.5)
    force = iva.Harmonic(amplitude=1.0, frequency=0.7)
    over: dict[str, Any] = {"clearance": [1.0 + 0.05 * k for k in range(57)]}
    primary, start = iva.Primary(damping_ratio=0.02), iva.Start(gap_velocity=1.0)
    found = dynamics.diagram(siva, primary, force=force, over=over, start=start, keep=4)
    at = found.table.filter((pl.col("value") - 2.7).abs() < 1e-9)
    impacts = {
        way: at.filter(direction=way)["impacts"].unique().to_list() for way in ("up", "down")
    }
    assert impacts == {"up": [3], "down": [2]}


def test_units_scale_and_strobes_are_states_of_a_run() -> None:
    mass, frequency = 3.0, 7.0
    siva = iva.Siva(mass=0.2 * mass, restitution=0.7, clearance=4.5)
    primary = iva.Primary(mass=mass, natural_frequency=frequency, damping_ratio=0.05)
    force = iva.Harmonic(force=mass * frequency**2, frequency=frequency)
    start = iva.Start(gap_velocity=0.1 * frequency)
    parts: dict[str, Any] = {"force": force, "start": start}
    found = dynamics.diagram(
        siva, primary, over={"clearance": [4.5]}, direction="up", discard=0, keep=5, **parts
    )
    run = iva.simulate(siva, primary, cycles=5, **parts)
    strobes = dynamics.section(run)[1:]
    for name in ("displacement", "velocity", "gap_displacement", "gap_velocity"):
        pairs = zip(found.table[name], strobes[name], strict=True)
        assert all(abs(one - other) < 1e-9 for one, other in pairs), name


def test_a_pendulum_has_a_diagram() -> None:
    piva = iva.Piva(mass_ratio=0.1, restitution=0.6, length=2.0, clearance=0.5, frequency_ratio=1.0)
    force = iva.Harmonic(amplitude=0.1, frequency=1.0)
    given: dict[str, Any] = {"force": force, "start": iva.Start(gap_velocity=0.2)}
    found = dynamics.diagram(
        piva, PRIMARY, over={"clearance": [0.5]}, direction="up", discard=0, keep=5, **given
    )
    strobes = dynamics.section(iva.simulate(piva, PRIMARY, cycles=5, **given))[1:]
    pairs = zip(found.table["gap_velocity"], strobes["gap_velocity"], strict=True)
    assert all(abs(one - other) < 1e-9 for one, other in pairs)


def test_bad_input_is_one_sentence() -> None:
    def failing(match: str, **given: Any) -> None:
        settings: dict[str, Any] = {"over": {"clearance": [1.0, 2.0]}, "force": FORCE, **given}
        with pytest.raises((ValueError, TypeError), match=match):
            dynamics.diagram(SIVA, PRIMARY, **settings)

    failing("increasing", over={"clearance": [2.0, 1.0]})
    failing("increasing", over={"clearance": [1.0, float("nan")]})
    failing("at least one", over={"clearance": []})
    failing("give one with its values", over={"clearance": [1.0], "restitution": [0.5]})
    failing("outside the range|allowed|greater", over={"clearance": [-1.0, 2.0]})
    failing("of the absorber, the primary system or the force", over={"displacement": [1.0]})
    failing("give 'both', 'up' or 'down'", direction="sideways")
    failing("keep", keep=0)
    failing("gap", start=(0.0, 0.0, 1.5, 0.0))
    failing("force", force=None)
    failing("over", over=[1.0, 2.0])


def test_pictures_have_units(found: dynamics.Diagram) -> None:
    axes = iva.plots.diagram(found)
    assert axes.get_xlabel() == "clearance d (unit of length)"
    assert axes.get_ylabel() == "x at the strobes (unit of length)"
    legend = axes.get_legend()
    assert legend is not None
    assert {text.get_text() for text in legend.get_texts()} == {"upwards", "downwards"}
    up, down = (np.asarray(axes.lines[k].get_ydata()) for k in (1, 0))
    assert up.size == down.size == 40 * len(ATTRACTORS)
    with pytest.raises(ValueError, match="give displacement"):
        iva.plots.diagram(found, "amplitude")
    with pytest.raises(TypeError, match="diagram"):
        iva.plots.diagram("found")  # type: ignore[arg-type]


def test_sections_are_states_of_the_run() -> None:
    """The orbit A1 of the references: symmetric, one impact on each wall."""
    siva = iva.Siva(mass_ratio=0.2, restitution=0.7, clearance=4.5)
    start = iva.Start(gap_velocity=0.1)
    run = iva.simulate(siva, PRIMARY, force=FORCE, start=start, cycles=400)
    last = {at: dynamics.section(run, at, discard=350).row(-1) for at in ("strobe", "peak")}
    record = json.loads((REFERENCE / "orbits.json").read_text())[0]
    state = record["state_at_time_0"]
    assert last["strobe"][1] == pytest.approx(float(state["displacement"]), abs=1e-6)
    assert abs(last["peak"][1]) == pytest.approx(float(record["amplitude"]), abs=1e-4)
    plus, minus = (dynamics.section(run, at, discard=350) for at in ("wall+", "wall-"))
    assert plus["gap_displacement"].unique().to_list() == [4.5]
    assert minus["gap_displacement"].unique().to_list() == [-4.5]
    assert plus["gap_velocity"][-1] == pytest.approx(-minus["gap_velocity"][-1], abs=1e-6)
    for hit, time in zip(plus["velocity"], plus["time"], strict=True):
        assert run.at([time - 1e-9])["velocity"].item() == pytest.approx(hit, abs=1e-6)
    axes = iva.plots.section(run, "wall+", x="velocity", y="gap_velocity")
    assert axes.get_ylabel() == "gap velocity w (unit of length · ωₙ)"
    short = iva.simulate(siva, PRIMARY, force=FORCE, start=start, cycles=3, tables=("impacts",))
    with pytest.raises(ValueError, match="stroboscope"):
        dynamics.section(short)
    with pytest.raises(ValueError, match="give strobe"):
        dynamics.section(short, "wall")  # type: ignore[arg-type]
    bare = iva.simulate(None, PRIMARY, force=FORCE, start=start_of_structure(), cycles=3)
    with pytest.raises(ValueError, match="no absorber"):
        dynamics.section(bare)


def start_of_structure() -> iva.Start:
    """Return a start of a structure without absorber."""
    return iva.Start(displacement=1.0)
