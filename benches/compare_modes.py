"""Five free masses on a structure with 20 modes: iva, MuJoCo and Siconos.

Usage: compare_modes.py [--quick] [--python=PATH ...]

Modes of 1, 2, ... 20 rad/s with a damping ratio of 0.01 carry free masses at five points. The
tools step through the scene up to its first 15 impacts, with steps over two decades, and are judged
by the times of these impacts against iva's. Later impacts are left out: the motion forgets its
start, so that an error in an early impact soon makes other impacts. An error is the largest one of
the 15 times, over the time itself. A row without error misses one of these impacts, has one too
many, or has one at the other wall.

A step costs the same with or without impact. The cost of the whole scene is therefore that of the
first part, over its duration and times that of the scene. Times are CPU time.

MuJoCo has no coefficient of restitution: a stop is a spring with a damper, whose damping ratio is
chosen here so that a free mass would bounce with the restitution wanted. Where the steps fall in
an impact changes the bounce, and a soft stop delays it; the time constant of the stops goes by the
square root of the step, so that both errors shrink. Siconos steps by Moreau and Jean's scheme, with
Newton's law.

A peer that is not installed is left out. Each runs in a process of its own, under the first
interpreter given by ``--python`` that has it: Siconos of a Linux distribution needs that of the
distribution. Without the option all run under the one of this script.
"""

from __future__ import annotations

import json
import math
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass

import numpy as np

MODES = 20
DAMPING_RATIO = 0.01
MASS = 0.02
RESTITUTION = 0.6
CLEARANCES = (0.30, 0.35, 0.40, 0.45, 0.50)
START = [2.0, 1.0] + [0.0] * (MODES - 2)
DURATION = 40.0

#: Impacts whose times are compared.
JUDGED = 15
#: Peers run for so long beyond the last impact that is compared.
MARGIN = 0.3
CALLS = 7
#: Time constant of MuJoCo's stops over the square root of the step: 20 steps at one of 1e-3.
TIME_CONSTANT = 0.02 / math.sqrt(1e-3)

FREQUENCIES = np.arange(1.0, MODES + 1)
#: Mass-normalised shapes: a row for each absorber, a column for each mode.
SHAPES = 0.3 * np.sin(np.pi * np.outer(np.arange(1, len(CLEARANCES) + 1), FREQUENCIES) / 6)

#: Steps of each peer, from long to short.
STEPS = {
    "MuJoCo": (3e-3, 1e-3, 3e-4, 1e-4, 3e-5),
    "Siconos": (1e-2, 3e-3, 1e-3, 3e-4, 1e-4),
}


@dataclass(frozen=True)
class Impact:
    """When an absorber hits which of its walls, 1 or -1."""

    time: float
    absorber: int
    wall: int


def with_iva() -> tuple[list[Impact], list[float]]:
    """Return all impacts of the scene, and the CPU seconds of some calls."""
    import iva  # the interpreter of a peer need not have it

    structure = iva.Structure(
        frequencies=FREQUENCIES.tolist(),
        damping_ratios=[DAMPING_RATIO],
        points={f"p{number}": shape.tolist() for number, shape in enumerate(SHAPES, 1)},
        absorber_at=[f"p{number}" for number in range(1, len(CLEARANCES) + 1)],
        seen_at="p3",
        start_displacements=START,
    )
    absorbers = [
        iva.Siva(mass=MASS, restitution=RESTITUTION, clearance=clearance)
        for clearance in CLEARANCES
    ]
    impacts: list[Impact] = []
    spent = []
    for _ in range(CALLS):
        begin = time.process_time()
        run = iva.simulate(
            absorbers, structure, start=iva.Start(), duration=DURATION, tables=["impacts"]
        )
        spent.append(time.process_time() - begin)
        columns = run.impacts.select("time", "absorber", "wall")
        impacts = [Impact(*row) for row in columns.rows()]
    return impacts, spent


def damping_of_a_stop() -> float:
    """Return the damping ratio of a spring with damper off which a mass bounces as wanted.

    The stop never pulls: it lets go as soon as its force is back at 0. The speed then is
    exp(-2 z/s atan(s/z)) of that of the approach, with s = sqrt(1 - z^2).
    """
    low, high = 1e-6, 1 - 1e-6
    for _ in range(60):
        ratio = (low + high) / 2
        rest = math.sqrt(1 - ratio**2)
        if math.exp(-2 * ratio / rest * math.atan(rest / ratio)) > RESTITUTION:
            low = ratio
        else:
            high = ratio
    return (low + high) / 2


def model_of_mujoco(step: float) -> str:
    """Describe the scene: modes and masses are sliders, a gap is a tendon with limits."""
    bodies = [
        f'<body><joint name="q{mode}" type="slide" axis="1 0 0" stiffness="{frequency**2}"'
        f' damping="{2 * DAMPING_RATIO * frequency}"/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="1e-6 1e-6 1e-6"/></body>'
        for mode, frequency in enumerate(FREQUENCIES)
    ]
    tendons = []
    for number, (shape, clearance) in enumerate(zip(SHAPES, CLEARANCES, strict=True)):
        bodies.append(
            f'<body><joint name="z{number}" type="slide" axis="1 0 0"/>'
            f'<inertial pos="0 0 0" mass="{MASS}" diaginertia="1e-6 1e-6 1e-6"/></body>'
        )
        terms = "".join(
            f'<joint joint="q{mode}" coef="{-float(value)!r}"/>' for mode, value in enumerate(shape)
        )
        tendons.append(
            f'<fixed limited="true" range="{-clearance} {clearance}" solimplimit="0.9999 0.9999'
            f' 0.001" solreflimit="{TIME_CONSTANT * math.sqrt(step)} {damping_of_a_stop()}">{terms}'
            f'<joint joint="z{number}" coef="1"/></fixed>'
        )
    return (
        f'<mujoco><option timestep="{step}" gravity="0 0 0" integrator="RK4">'
        '<flag contact="disable"/></option>'
        f"<worldbody>{''.join(bodies)}</worldbody><tendon>{''.join(tendons)}</tendon></mujoco>"
    )


def with_mujoco(step: float, duration: float) -> tuple[list[Impact], float]:
    """Return the impacts up to a time, and the CPU seconds of the steps alone."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(model_of_mujoco(step))
    data = mujoco.MjData(model)
    data.qpos[:MODES] = START
    # The masses start in the middle of their gaps, and at rest in them.
    data.qpos[MODES:] = SHAPES @ START
    count = math.ceil(duration / step)
    lengths = np.empty((count, len(CLEARANCES)))
    spent = 0.0
    for number in range(count):
        begin = time.process_time()
        mujoco.mj_step(model, data)
        spent += time.process_time() - begin
        lengths[number] = data.qpos[MODES:] - SHAPES @ data.qpos[:MODES]
    impacts = []
    for absorber, clearance in enumerate(CLEARANCES):
        for wall in (1, -1):
            beyond = wall * lengths[:, absorber] - clearance
            for before in np.flatnonzero((beyond[:-1] < 0) & (beyond[1:] >= 0)):
                part = beyond[before] / (beyond[before] - beyond[before + 1])
                impacts.append(Impact(float(step * (before + 1 + part)), absorber, wall))
    return impacts, spent


def with_siconos(step: float, duration: float) -> tuple[list[Impact], float]:
    """Return the impacts up to a time, and the CPU seconds of the steps."""
    import siconos.kernel as sk

    size, count = MODES + len(CLEARANCES), len(CLEARANCES)
    mass = np.diag([1.0] * MODES + [MASS] * count)
    stiffness = np.diag([*FREQUENCIES**2, *[0.0] * count])
    damping = np.diag([*2 * DAMPING_RATIO * FREQUENCIES, *[0.0] * count])
    start = [*START, *(SHAPES @ START).tolist()]
    motion = sk.LagrangianLinearTIDS(start, [0.0] * size, mass)
    motion.setKPtr(stiffness)
    motion.setCPtr(damping)
    model = sk.NonSmoothDynamicalSystem(0, DURATION)
    model.insertDynamicalSystem(motion)
    law = sk.NewtonImpactNSL(RESTITUTION)
    stops = []
    for absorber, clearance in enumerate(CLEARANCES):
        towards = np.zeros((1, size))
        towards[0, :MODES], towards[0, MODES + absorber] = SHAPES[absorber], -1.0
        for wall in (1, -1):
            row, room = wall * towards, np.array([clearance])
            stop = sk.Interaction(law, sk.LagrangianLinearTIR(row, room))
            model.link(stop, motion)
            # Siconos keeps no reference to the arrays.
            stops.append((stop, absorber, wall, row, room))
    scheme, problem = sk.MoreauJeanOSI(0.5), sk.LCP()
    steps = sk.TimeStepping(model, sk.TimeDiscretisation(0, step), scheme, problem)
    steps.initialize()
    impacts: list[Impact] = []
    pushed: set[int] = set()
    begin = time.process_time()
    for number in range(1, math.ceil(duration / step) + 1):
        steps.computeOneStep()
        pushes = {index for index, stop in enumerate(stops) if stop[0].lambda_(1)[0] > 0}
        for index in pushes - pushed:
            impacts.append(Impact(number * step, stops[index][1], stops[index][2]))
        pushed = pushes
        steps.nextStep()
    return impacts, time.process_time() - begin


PEERS = {"MuJoCo": with_mujoco, "Siconos": with_siconos}
MODULES = {"MuJoCo": "mujoco", "Siconos": "siconos"}


def interpreter(peer: str) -> tuple[str, str] | None:
    """Return the first interpreter that has a peer, and the version of the peer."""
    given = [word.removeprefix("--python=") for word in sys.argv if word.startswith("--python=")]
    code = f"import {MODULES[peer]} as module;print(getattr(module, '__version__', '0'))"
    for path in given or [sys.executable]:
        found = subprocess.run([path, "-c", code], capture_output=True, text=True, check=False)
        if found.returncode == 0:
            return path, found.stdout.split("\n")[-2]
    return None


def apart(peer: str, path: str, step: float, duration: float) -> tuple[list[Impact], float]:
    """Run a peer in a process of its own."""
    command = [path, __file__, f"--peer={peer}", str(step), str(duration)]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    if found.returncode != 0:
        last = (found.stderr.strip() or "no message").split("\n")[-1]
        raise RuntimeError(f"{peer} failed at a step of {step:g}: {last}")
    impacts, spent = json.loads(found.stdout.strip().split("\n")[-1])
    return [Impact(*impact) for impact in impacts], spent


def error(impacts: list[Impact], truth: list[Impact]) -> float | None:
    """Return the largest relative error of the times judged, absorber by absorber."""
    worst = 0.0
    end = truth[JUDGED - 1].time
    for absorber in range(len(CLEARANCES)):
        own = sorted((hit.time, hit.wall) for hit in impacts if hit.absorber == absorber)
        true = [(hit.time, hit.wall) for hit in truth[:JUDGED] if hit.absorber == absorber]
        later = [hit.time for hit in truth[JUDGED:] if hit.absorber == absorber]
        # One too many is one before the end, or well before the next true one.
        if len(own) < len(true) or [hit[1] for hit in own[: len(true)]] != [hit[1] for hit in true]:
            return None
        extra = own[len(true) :]
        if extra and extra[0][0] < min(end, (end + min(later, default=end)) / 2):
            return None
        for (found, _), (exact, _) in zip(own, true, strict=False):
            worst = max(worst, abs(found - exact) / exact)
    return worst


def main() -> None:
    """Print the table."""
    truth, spent = with_iva()
    per_impact = statistics.median(spent) / len(truth)
    part = truth[JUDGED - 1].time + MARGIN
    print(f"{len(truth)} impacts in {DURATION:g}; the first {JUDGED} end at {part - MARGIN:.3f}.\n")
    print("| tool | step | µs per impact | over iva | largest relative error |")
    print("|---|--:|--:|--:|--:|")
    print(f"| iva | – | {1e6 * per_impact:.1f} | 1 | – |", flush=True)
    notes = []
    for peer, steps in STEPS.items():
        place = interpreter(peer)
        if place is None:
            notes.append(f"{peer} is not installed.")
            continue
        path, version = place
        notes.append(f"{peer} {version}." if version != "0" else f"{peer} tells no version.")
        for step in steps[:3] if "--quick" in sys.argv else steps:
            try:
                impacts, seconds = apart(peer, path, step, part)
            except RuntimeError as failure:
                notes.append(str(failure))
                continue
            cost = seconds / part * DURATION / len(truth)
            worst = error(impacts, truth)
            told = "–" if worst is None else f"{worst:.1e}"
            row = f"{1e6 * cost:.0f} | {cost / per_impact:.0f} | {told}"
            print(f"| {peer} | {step:g} | {row} |", flush=True)
    print()
    print("\n".join(notes))


def peer() -> None:
    """Run one peer, and print its impacts and its CPU seconds."""
    name, step, duration = sys.argv[1].removeprefix("--peer="), *map(float, sys.argv[2:4])
    impacts, seconds = PEERS[name](step, duration)
    print(json.dumps([[[hit.time, hit.absorber, hit.wall] for hit in impacts], seconds]))


if __name__ == "__main__":
    if sys.argv[1:] and sys.argv[1].startswith("--peer="):
        peer()
    else:
        main()
