"""Free masses and pendulums with several terms at once, against 56 scenes solved to 30 digits.

`tests/reference/composed.json` has the scenes and what happens in them; its README tells where they
come from. A scene combines springs, dashpots, friction, inclined lines, unlike stops, offset gaps,
several masses, pendulums, several modes and forces.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import iva

UNIT = 2.0**-53
#: Bound in rounding units, |error| / (2^-53 (condition + size)).
MOST = 2.0
#: One scene is damped critically.
pytestmark = pytest.mark.filterwarnings("ignore:primary.damping_ratio = 1:UserWarning")
SCENES: dict[str, Any] = json.loads(
    (Path(__file__).parents[1] / "reference" / "composed.json").read_text(encoding="utf-8")
)


def terms(member: dict[str, Any], omega: float) -> Iterator[tuple[str, Any]]:
    """Yield the arguments of `iva.Siva` or `iva.Piva` of a member, on a first mode of this ω."""
    same = {
        "mass": "m",
        "clearance": "d",
        "restitution": "e_plus",
        "gap_offset": "offset",
        "friction": "friction",
        "gravity": "gravity",
        "inclination": "alpha",
        "inclination_deg": "alpha_deg",
        "gap_damping": "c",
        "spring": "k_s",
        "length": "L",
        "inertia_ratio": "kappa",
        "contact_distance": "b",
    }
    for name, key in same.items():
        if key in member:
            yield name, float(member[key])
    if member.get("e_minus") != member.get("e_plus"):
        yield "restitution_minus", float(member["e_minus"])
    if "nu_p" in member:
        hanging = float(member["gravity"]) / (float(member.get("kappa", 1)) * float(member["L"]))
        yield "pivot_damping_ratio", float(member["nu_p"]) / (2 * math.sqrt(hanging))
    if "omega_s" in member:
        yield "spring_ratio", float(member["omega_s"]) / omega
    law = member.get("law", {})
    if law.get("kind") == "power":
        yield "restitution", float(law["e"])
        yield "reference_speed", float(law["u0"])
        yield "restitution_exponent", float(law["exponent_num"]) / float(law["exponent_den"])
    elif law.get("kind") == "plastic":
        yield "yield_speed", float(law["u1"])
    elif law.get("kind") == "table":
        yield "restitution_table", [[float(value) for value in pair] for pair in law["pairs"]]


def load(given: dict[str, Any]) -> Any:
    """Return a force, an impulse or a motion of the base."""
    if given["kind"] == "impulse":
        return iva.Impulse(impulse=float(given["P"]), time=float(given["t"]))
    if given["kind"] == "polygon":
        times, values = ([float(each) for each in given[key]] for key in ("t", "v"))
        kind: Any = "base_acceleration" if given["what"] == "base" else "force_newtons"
        return iva.Recorded(times, values, kind)
    name = "base_acceleration" if given["what"] == "base" else "force"
    amplitude: Any = {name: float(given["amplitude"])}
    return iva.Harmonic(
        **amplitude, frequency=float(given["Omega"]), phase=float(given.get("phase", 0))
    )


def needs_modes(scene: dict[str, Any]) -> bool:
    """Whether a scene is on a structure with several modes."""
    return len(scene["structure"]["modes"]) > 1


@cache
def simulated(name: str) -> iva.Run:
    """Return the run of a scene."""
    scene = SCENES[name]["scene"]
    members, modes = scene["members"], scene["structure"]["modes"]
    points = {key: [float(phi) for phi in of] for key, of in scene["structure"]["points"].items()}
    q, qd = ([float(value) for value in scene["start"][key]] for key in ("q", "qd"))
    begin: Any = {"gap_displacement": [float(each.get("y0", 0)) for each in members]}
    omegas, zetas, bases = (
        [float(mode[key]) for mode in modes] for key in ("omega", "zeta", "Gamma")
    )
    structure: Any
    if needs_modes(scene):
        pushed = [drive["point"] for drive in scene["drive"] if "point" in drive]
        at = [each["point"] for each in members]
        structure = iva.Structure(
            frequencies=omegas,
            damping_ratios=zetas,
            points=points,
            absorber_at=at if len(at) > 1 else at[0],
            force_at=pushed[0] if pushed else at[0],
            base=bases,
            start_displacements=q,
            start_velocities=qd,
        )
    else:
        ((phi,),) = points.values()
        assert bases[0] == pytest.approx(1 / phi)
        structure = iva.Primary(
            mass=1 / phi**2, natural_frequency=omegas[0], damping_ratio=zetas[0]
        )
        begin |= {"displacement": phi * q[0], "velocity": phi * qd[0]}
    if len(members) == 1:
        (begin["gap_displacement"],) = begin["gap_displacement"]
    kinds = {"free": iva.Siva, "pendulum": iva.Piva}
    absorbers: Any = [kinds[each["kind"]](**dict(terms(each, omegas[0]))) for each in members]
    return iva.simulate(
        absorbers if len(absorbers) > 1 else absorbers[0],
        structure,
        start=iva.Start(**begin),
        duration=float(scene["t_end"]),
        force=[load(each) for each in scene["drive"]] or None,
    )


every_scene = pytest.mark.parametrize("name", list(SCENES))
scenes_that_rub = pytest.mark.parametrize(
    "name",
    [
        name
        for name, entry in SCENES.items()
        if any("friction" in each for each in entry["scene"]["members"])
    ],
)


def happened(name: str, kind: str, member: int) -> list[dict[str, Any]]:
    """Return the events of a kind of a mass, in time."""
    events = SCENES[name]["events"]
    return [each for each in events if each["kind"] == kind and each["member"] == member]


def units(found: float, event: dict[str, Any], key: str, condition: str) -> float:
    """Return the error of a number in rounding units."""
    truth = event[key] if isinstance(event[key], str) else event[key][0]
    worth = float(event[condition]) + (float(event["t"]) if key == "t" else abs(float(truth)))
    return abs(found - float(truth)) / (UNIT * worth)


@every_scene
def test_impacts_are_those_of_the_reference(name: str) -> None:
    """All of them down to the floor of the list: number, wall, instant and approach velocity."""
    run, scene = simulated(name), SCENES[name]["scene"]
    several = len(scene["members"]) > 1
    for member in range(len(scene["members"])):
        rows = run.impacts.filter(absorber=member) if several else run.impacts
        rows = rows.filter(rows["approach_velocity"].abs() >= float(scene["floor"]))
        truth = happened(name, "impact", member)
        assert rows["wall"].to_list() == [each["wall"] for each in truth]
        for row, event in zip(rows.to_dicts(), truth, strict=True):
            assert units(row["time"], event, "t", "cond_time") < MOST
            assert units(row["approach_velocity"], event, "w", "cond_w") < MOST


@every_scene
def test_sticks_and_releases_are_those_of_the_reference(name: str) -> None:
    """Where they are: instant and wall."""
    run, scene = simulated(name), SCENES[name]["scene"]
    several = len(scene["members"]) > 1
    for member in range(len(scene["members"])):
        rows = run.episodes.filter(absorber=member) if several else run.episodes
        for kind, column in (("stick", "stick_time"), ("release", "release_time")):
            truth = happened(name, kind, member)
            found = rows.filter(rows[column].is_not_null())
            assert found["wall"].to_list() == [each["wall"] for each in truth]
            for time, event in zip(found[column], truth, strict=True):
                assert units(time, event, "t", "cond_time") < MOST


@every_scene
def test_energies_are_those_of_the_reference(name: str) -> None:
    """What there is at both ends, what is lost in between and what the drives do."""
    row, energies = simulated(name).summary.row(0, named=True), SCENES[name]["energies"]
    worked = sum(float(each) for each in energies["work"].values())
    expected = {
        "energy_initial": energies["initial"],
        "energy_final": energies["final"],
        "energy_viscous": energies["lost"]["structure"],
        "energy_pivot": sum(float(energies["lost"].get(key, 0)) for key in ("dashpot", "pivot")),
        "energy_friction": energies["lost"]["friction"],
        "energy_impacts": energies["lost"]["impact"],
        "energy_work": worked,
    }
    most = max(abs(float(each)) for each in expected.values())
    off = {key: abs(row[key] - float(value)) / most for key, value in expected.items()}
    assert max(off.values()) < 1e-12, off


@scenes_that_rub
def test_stops_and_holds_are_those_of_the_reference(name: str) -> None:
    """How often masses stop in their gaps, and for how long friction holds them."""
    entry, run = SCENES[name], simulated(name)
    end, held, condition = float(entry["scene"]["t_end"]), 0.0, 1.0
    since: dict[int, float] = {}
    for event in entry["events"]:
        time, member = float(event["t"]), event["member"]
        if event["kind"] == "hold":
            since[member] = time
        elif event["kind"] == "slip":
            # One that no hold comes before was held from the begin on.
            held += time - since.pop(member, 0.0)
        if event["kind"] in ("hold", "slip"):
            condition += float(event["cond_time"]) + time
    held += sum(end - time for time in since.values())
    stops = sum(event["kind"] in ("hold", "reverse") for event in entry["events"])
    row = run.summary.row(0, named=True)
    assert abs(row["time_held"] - held) < MOST * UNIT * condition
    # Of a chatter whose rest is summed not all turns are counted, nor are they in the reference.
    if not any(event["kind"] == "stick" for event in entry["events"]):
        assert row["stops"] == stops


def test_every_term_is_in_some_scene() -> None:
    """The file is all there: terms, and impacts of which more than one happen at once."""
    keys = {key for entry in SCENES.values() for each in entry["scene"]["members"] for key in each}
    assert keys >= {"c", "k_s", "friction", "alpha", "alpha_deg", "offset", "law", "y0", "L", "b"}
    hits = [each for entry in SCENES.values() for each in entry["events"] if "w" in each]
    assert (len(SCENES), len(hits)) == (56, 707)
    twins = np.array([float(each["t"]) for each in SCENES["twins"]["events"]])
    assert math.isclose(np.abs(np.diff(twins)[::2]).max(), 0.0)
