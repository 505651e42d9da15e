"""Where the energy is, and where it has gone."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
import numpy.typing as npt
import polars as pl
from matplotlib.axes import Axes

from iva.design import Design, design_of
from iva.forces import Impulse, listed
from iva.plots.arguments import Numbers, checked_run, values_of
from iva.plots.axis_units import name_axis
from iva.plots.labels import labelled
from iva.plots.legends import legend_above
from iva.plots.styles import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY_BLUE,
    VERMILLION,
    drawing_on,
)
from iva.simulation import Run
from iva.spelling import spell_checked

COLOURS = {
    "structure": SKY_BLUE,
    "absorber": ORANGE,
    "damper": "#B3B3B3",
    "impacts": VERMILLION,
    "pivot": PURPLE,
    "friction": GREEN,
    "dashpot": BLUE,
}

#: Samples in the shortest time scale of the motion: the losses are integrals over them.
SAMPLES = 200
MOST_SAMPLES = 10_000
#: How far the integrals may be off what the run itself says, relative to all energy.
TOLERANCE = 1e-4

Motion = dict[str, Numbers]
Marks = npt.NDArray[np.bool_]


@spell_checked
def energy(run: Run, *, ax: Axes | None = None) -> Axes:
    """Draw how the energy splits over time: what the masses have, and what each loss has taken.

    From below: structure (kinetic, and of its spring), absorber (kinetic, and in gravity, where it
    is a pendulum or its motion rises; of several absorbers all together), then what has been lost
    in the damper, in impacts (in steps), and in a pendulum's pivot, in friction or in a dashpot in
    the gap. In free decay everything is relative to the initial energy and fills the height up to
    1. Under forces energies are drawn in their unit, and the upper edge is the initial energy plus
    the work done so far. Without absorber there are structure and damper alone.

    Parameters
    ----------
    run : Run
        The run; it needs no tables.
    ax : matplotlib axes, optional
        Where to draw; axes of their own by default.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    TypeError
        If an argument is of the wrong class.
    ValueError
        If the run has no energy; if impacts of the law as printed have added energy, which no stack
        can show; or if the motion is too fast for its losses to be drawn.

    Notes
    -----
    Energies follow from the states and the parameters; without a mass of the structure they are per
    unit of it, which a share does not feel. If the base moves they are those of the motion relative
    to it. The losses of impacts are the steps of the energy, those of a chatter among them. Losses
    of damper and pivot are integrals over the motion by Simpson's rule, each held against what the
    run itself says (`energy_viscous`, `energy_pivot`).

    Examples
    --------
    >>> run = iva.simulate(
    ...     iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5),
    ...     iva.Primary(damping_ratio=0.01),
    ...     start=iva.Start(displacement=1.0),
    ...     periods=6,
    ... )
    >>> axes = energy(run)
    >>> [layer.get_label() for layer in axes.collections]
    ['structure', 'absorber', 'damper', 'impacts']
    """
    split = split_of(checked_run(run, several=True))
    units = run.units
    driven = bool(listed(run.force))
    scale = 1.0 if driven else split.total[0]
    if split.total.max() == 0.0:
        raise ValueError("nothing moves in this run: there is no energy to split")
    with drawing_on(ax) as axes:
        axes.stackplot(
            split.time,
            [layer / scale for layer in split.layers.values()],
            labels=list(split.layers),
            colors=[COLOURS[name] for name in split.layers],
            linewidth=0.0,
        )
        axes.plot(
            split.time,
            (split.layers["structure"] + split.layers.get("absorber", 0.0)) / scale,
            color=BLACK,
            linewidth=0.6,
            label="_in the system",
        )
        axes.set_xlim(split.time[0], split.time[-1])
        axes.set_ylim(0.0, split.total.max() / scale)
        name_axis(axes.xaxis, partial(labelled, "time", "t"), units["trajectory"]["time"])
        unit = units["summary"]["energy_initial"] if driven else "1"
        name_axis(axes.yaxis, partial(labelled, "energy", "E" if driven else "E/E(0)"), unit)
        legend_above(axes)
    return axes


@dataclass(frozen=True)
class Split:
    """Energies over time, each of shape (n,), in the unit of the run."""

    time: Numbers
    layers: dict[str, Numbers]

    @property
    def total(self) -> Numbers:
        """All of them together: the initial energy plus the work done."""
        return sum(self.layers.values(), start=np.zeros_like(self.time))


def split_of(run: Run) -> Split:
    """Return where the energy of a run is at every instant, and where it has gone.

    Raises
    ------
    ValueError
        If impacts have added energy, or an integral is off what the run itself says.
    """
    designs = [design_of(run, each) for each in range(max(1, design_of(run).absorbers))]
    design = designs[0]
    damped = any(each.gap_damping for each in designs)
    time, still, motions = finely(run, designs)
    structure, absorber = energies(designs, motions)
    system = structure + absorber
    steps = np.diff(time)
    layers = {"structure": structure, "absorber": absorber}
    inside = motions_at(run, time[:-1] + 0.5 * steps, len(designs))
    # Where the absorbers' own dampers are.
    own = "dashpot" if damped else "pivot"

    def damper(motions: list[Motion]) -> Numbers:
        return damper_power(design, motions[0])

    def own_dampers(motions: list[Motion]) -> Numbers:
        powers = (
            pivot_power(design, motion) + design.gap_damping * motion["gap_velocity"] ** 2
            for design, motion in zip(designs, motions, strict=True)
        )
        return sum(powers, start=np.zeros_like(motions[0]["velocity"]))

    for name, power in (("damper", damper), (own, own_dampers)):
        ends, middle = power(motions), power(inside)
        loss = steps / 6.0 * (ends[:-1] + 4.0 * middle + ends[1:])
        # There is no middle at the impact that ended a run early.
        layers[name] = cumulative(np.where(still, 0.0, loss))
    # Where time stands still only an impact can have taken energy.
    layers["impacts"] = cumulative(np.where(still, -np.diff(system), 0.0))
    row = run.summary.row(0, named=True)
    if len(designs) > 1 and struck_at_begin(run):
        # Instants of a list begin after the impacts at the begin.
        layers["impacts"] += row["energy_impacts"] - layers["impacts"][-1]
    each = zip(designs, motions, strict=True)
    rubbed = sum(
        (one.friction * np.abs(np.diff(way_of(one, motion))) for one, motion in each),
        start=np.zeros_like(steps),
    )
    layers["friction"] = cumulative(np.where(still, 0.0, np.nan_to_num(rubbed)))
    whole = float(Split(time, layers).total.max())
    if layers["impacts"].min() < -1e-9 * whole:
        raise ValueError("impacts add energy in this run: its energy cannot be split into losses")
    for name, column in (
        ("damper", "energy_viscous"),
        ("impacts", "energy_impacts"),
        (own, "energy_pivot"),
        ("friction", "energy_friction"),
    ):
        truth = row[column]
        if truth is not None and abs(layers[name][-1] - truth) > TOLERANCE * whole:
            raise ValueError(
                f"the loss in the {name} changes too fast to be drawn: {layers[name][-1]:.6g} "
                f"instead of {column} = {truth:.6g}"
            )
    names = ["structure", "absorber", "damper", "impacts"]
    if run.absorber is None:
        names = ["structure", "damper"]
    pendulums = [each.pendulum for each in designs if each.pendulum is not None]
    if any(pendulum.damping_ratio > 0.0 for pendulum in pendulums):
        names.append("pivot")
    if damped:
        names.append("dashpot")
    if layers["friction"][-1] > 0.0:
        names.append("friction")
    return Split(time, {name: layers[name] for name in names})


def way_of(design: Design, motion: Motion) -> Numbers:
    """Return the way of friction: in the gap, or of a pendulum along the arc of its stop."""
    pendulum = design.pendulum
    if pendulum is None or pendulum.small or pendulum.contact_distance is None:
        return motion["gap_displacement"]
    return pendulum.contact_distance * motion["angle"]


def cumulative(parts: Numbers) -> Numbers:
    """Return the running sum of what happens between instants, 0 at the first."""
    return np.concatenate([[0.0], np.cumsum(parts)])


def finely(run: Run, designs: list[Design]) -> tuple[Numbers, Marks, list[Motion]]:
    """Return enough instants, where time stands still between two, and the motion of each absorber.

    Both states of every impact and impulse are among them.
    """
    swings = [
        np.hypot(each.pendulum.frequency, each.pendulum.spring_frequency)
        for each in designs
        if each.pendulum is not None
    ]
    ratio = max(swings, default=0.0) / designs[0].natural_frequency
    fastest = max(1.0, 2.0 * designs[0].damping_ratio, ratio)
    rows = run.trajectory(int(min(SAMPLES * fastest, MOST_SAMPLES)))
    kicks = [force.time or 0.0 for force in listed(run.force) if isinstance(force, Impulse)]
    inside = [time for time in kicks if rows["time"][0] < time < rows["time"][-1]]
    if len(designs) > 1:
        # Each absorber has both states of its own impacts only.
        each = [values_of(one["time"]) for one in rows.partition_by("absorber")]
        hits = [at for times in each for at in times[1:][np.diff(times) == 0.0]]
        # What happens at the begin has no instant before it.
        events = [at for at in [*inside, *hits] if at > each[0][0]]
        time = np.unique(np.concatenate([*each, events, [before(at) for at in events]]))
        # An impulse does work.
        hits = [at for at in hits if at not in inside]
        still = np.isin(time[1:], hits) & np.isin(time[:-1], [before(at) for at in hits])
        return time, still, motions_at(run, time, len(designs))
    if inside:
        both = run.at([at for time in inside for at in (before(time), time)])
        rows = rows.vstack(both).sort("time", maintain_order=True)
    motion = {name: values_of(rows[name]) for name in rows.columns}
    return motion["time"], np.diff(motion["time"]) == 0.0, [motion]


def struck_at_begin(run: Run) -> bool:
    """Return whether an absorber of a list has an impact at the first instant of its run."""
    rows = run.trajectory(2)
    first = rows.filter(pl.col("time") == rows["time"][0])
    return bool(first["absorber"].is_duplicated().any())


def before(time: float) -> float:
    """Return an instant so long before an event that its state is not that after the event."""
    return time * (1.0 - 16.0 * float(np.finfo(float).eps))


def motions_at(run: Run, time: Numbers, count: int) -> list[Motion]:
    """Return the motion of each absorber at some instants; where time stands still any will do."""
    rows = run.at(time)
    each = rows.partition_by("absorber") if count > 1 else [rows]
    return [{name: values_of(one[name]) for name in one.columns} for one in each]


def energies(designs: list[Design], motions: list[Motion]) -> tuple[Numbers, Numbers]:
    """Return the energies of structure and absorbers."""
    design, motion = designs[0], motions[0]
    stiffness = design.mass * design.natural_frequency**2
    moving = design.mass * motion["velocity"] ** 2
    structure = 0.5 * (moving + stiffness * motion["displacement"] ** 2)
    each = (absorber_energy(*one) for one in zip(designs, motions, strict=True))
    return structure, sum(each, start=np.zeros_like(structure))


def absorber_energy(design: Design, motion: Motion) -> Numbers:
    """Return the energy of one absorber; 0 without."""
    velocity = motion["velocity"]
    if design.mass_ratio is None:
        return np.zeros_like(velocity)
    mass = design.mass_ratio * design.mass
    pendulum = design.pendulum
    if pendulum is None:
        assert design.clearance is not None
        height = motion["gap_displacement"] - (design.gap_offset - design.clearance)
        kinetic = 0.5 * (velocity + motion["gap_velocity"]) ** 2
        stretched = 0.5 * design.spring * motion["gap_displacement"] ** 2
        return mass * (kinetic + design.gravity_along * height) + stretched
    # Of a pendulum: L θ̇ of the centre of mass along its arc, and its part along the line.
    swing = arc_velocity(design, motion)
    _, across = design.beside(motion)
    kinetic = velocity**2 + 2.0 * velocity * across + pendulum.inertia_ratio * swing**2
    # g L (1 − cos θ), with g = κ L ωp²; of small angles g L θ²/2. Of a spring κ (ωs L θ)²/2.
    if pendulum.small:
        arc = pendulum.lever * motion["gap_displacement"]
        height = 0.5 * arc**2
    else:
        assert pendulum.length is not None
        arc = pendulum.length * motion["angle"]
        height = 2.0 * (pendulum.length * np.sin(0.5 * motion["angle"])) ** 2
    gravity = pendulum.inertia_ratio * pendulum.frequency**2 * height
    spring = 0.5 * pendulum.inertia_ratio * (pendulum.spring_frequency * arc) ** 2
    return mass * (0.5 * kinetic + gravity + spring)


def arc_velocity(design: Design, motion: Motion) -> Numbers:
    """Return L θ̇ of a pendulum."""
    pendulum = design.pendulum
    assert pendulum is not None
    if pendulum.small or pendulum.length is None:
        return pendulum.lever * motion["gap_velocity"]
    return pendulum.length * motion["angular_velocity"]


def damper_power(design: Design, motion: Motion) -> Numbers:
    """Return c ẋ²."""
    damping = 2.0 * design.damping_ratio * design.natural_frequency * design.mass
    return damping * motion["velocity"] ** 2


def pivot_power(design: Design, motion: Motion) -> Numbers:
    """Return 2 ζp ωp κ m (L θ̇)²; 0 for a free mass, and without absorber."""
    pendulum = design.pendulum
    if pendulum is None or design.mass_ratio is None:
        return np.zeros_like(motion["time"])
    rate = 2.0 * pendulum.damping_ratio * pendulum.frequency * pendulum.inertia_ratio
    return rate * design.mass_ratio * design.mass * arc_velocity(design, motion) ** 2
