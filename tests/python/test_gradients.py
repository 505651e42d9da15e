"""Gradients of runs: derivatives by parameters, in the user's units."""

import math
import pickle
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import polars as pl
import pytest

import iva


def in_si(**changed: float) -> dict[str, float]:
    given = {
        "mass": 12.0,
        "stiffness": 4.7e4,
        "damping": 15.0,
        "absorber_mass": 0.9,
        "restitution": 0.62,
        "clearance_mm": 4.0,
        "displacement_mm": 9.0,
        "velocity": 0.05,
    }
    return given | changed


def simulated(given: dict[str, float], gradients: tuple[str, ...] = ()) -> iva.Run:
    return iva.simulate(
        iva.Siva(
            mass=given["absorber_mass"],
            restitution=given["restitution"],
            clearance_mm=given["clearance_mm"],
        ),
        iva.Primary(mass=given["mass"], stiffness=given["stiffness"], damping=given["damping"]),
        start=iva.Start(displacement_mm=given["displacement_mm"], velocity=given["velocity"]),
        duration=0.6,
        gradients=gradients,
    )


NAMES = {
    "primary.mass": "mass",
    "stiffness": "stiffness",
    "damping": "damping",
    "absorber.mass": "absorber_mass",
    "restitution": "restitution",
    "clearance_mm": "clearance_mm",
    "displacement_mm": "displacement_mm",
    "start.velocity": "velocity",
}


@pytest.mark.parametrize("key", NAMES)
def test_derivatives_in_si_units_are_those_of_differences(key: str) -> None:
    """Central differences of runs in doubles: a step of 1e-6 leaves some 1e-8 of the derivative."""
    given, name = in_si(), NAMES[key]
    gradient = simulated(given, (key,)).gradients[key]
    step = 1e-6 * given[name]
    low, high = (simulated(given | {name: given[name] + sign * step}) for sign in (-1, 1))
    for table, columns in {
        "impacts": ("time", "displacement", "velocity_after", "energy_loss", "approach_velocity"),
        "summary": ("energy_impacts", "damping_ratio_1", "damping_ratio_fit", "residual_amplitude"),
        "envelope": ("time", "displacement"),
    }.items():
        for column in columns:
            values = getattr(gradient, table)[column].to_list()
            before, after = (getattr(run, table)[column].to_list() for run in (low, high))
            assert len(values) == len(before) == len(after) > 0
            differences = [(b - a) / (2 * step) for a, b in zip(before, after, strict=True)]
            largest = max(abs(difference) for difference in differences)
            assert values == pytest.approx(differences, rel=1e-5, abs=1e-5 * largest), column


def test_the_first_impact_has_a_closed_form() -> None:
    # Without damping it is at arccos(1 - γ): derivative 1/sqrt(1 - (1 - γ)²).
    run = iva.simulate(
        iva.Siva(mass_ratio=0.1, relative_clearance=0.3, restitution=0.5),
        iva.Primary(),
        start=iva.Start(displacement=2.0),
        periods=1,
        gradients=("relative_clearance", "displacement", "restitution", "mass_ratio"),
    )
    slopes = {name: gradient.impacts["time"][0] for name, gradient in run.gradients.items()}
    assert slopes["relative_clearance"] == pytest.approx(1 / math.sqrt(1 - 0.7**2), rel=1e-14)
    # The clearance is a multiple of the displacement: time does not depend on the size of both.
    assert slopes["displacement"] == pytest.approx(0.0, abs=1e-15)
    assert slopes["restitution"] == slopes["mass_ratio"] == 0.0


def test_parameters_of_forces_and_defaults_can_be_chosen() -> None:
    def forced(frequency: float, gradients: tuple[str, ...] = ()) -> iva.Run:
        return iva.simulate(
            iva.Siva(mass_ratio=0.1, clearance=1.0, restitution=0.7),
            iva.Primary(damping_ratio=0.03),
            start=iva.Start(displacement=0.5),
            force=iva.Harmonic(amplitude=0.2, relative_frequency=frequency, phase=0.3),
            cycles=4,
            gradients=gradients,
        )

    run = forced(0.97, ("force.relative_frequency", "start.velocity"))
    step = 1e-6
    low, high = forced(0.97 - step), forced(0.97 + step)
    assert high.impacts.height == run.impacts.height > 3
    differences = (high.impacts["time"] - low.impacts["time"]) / (2 * step)
    slopes = run.gradients["force.relative_frequency"].impacts["time"]
    assert slopes.to_list() == pytest.approx(differences.to_list(), rel=1e-6, abs=1e-6)
    # The velocity at the start is 0 by default.
    assert run.gradients["start.velocity"].impacts["time"].abs().max() > 0.1  # type: ignore[operator]
    # The amplitude and its derivative come from the same peak.
    amplitude = (high.summary["amplitude_max"] - low.summary["amplitude_max"]).item() / (2 * step)
    slope = run.gradients["force.relative_frequency"].summary["amplitude_max"].item()
    assert slope == pytest.approx(amplitude, rel=1e-5)


def test_impacts_close_to_a_grazing_are_flagged() -> None:
    # At γ = 2 the absorber just reaches the far wall: x falls from 1 to -1.
    def flags(clearance: float) -> pl.Series:
        run = iva.simulate(
            iva.Siva(mass_ratio=0.1, relative_clearance=clearance, restitution=0.5),
            iva.Primary(),
            start=iva.Start(displacement=1.0),
            periods=1.2,
            gradients=("relative_clearance",),
        )
        return run.gradients["relative_clearance"].impacts["near_grazing"]

    assert flags(1.9999)[0]
    assert not flags(1.9)[0]


def test_units_are_those_of_a_quotient() -> None:
    gradient = simulated(in_si(), ("clearance_mm", "restitution")).gradients
    assert gradient["clearance_mm"].units["impacts"]["time"] == "(s) per (mm)"
    assert gradient["restitution"].units["impacts"]["time"] == "s"


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("nonsense", "gradients = `nonsense`: no such field"),
        ("clearance", "clearance_mm is given in its place"),
        ("max_impacts", "the motion does not depend on it"),
        ("force.frequency", "it is not given"),
        ("gap_velocity", None),
        ("mass", "ambiguous|primary.mass"),
    ],
)
def test_what_cannot_be_differentiated_is_said(key: str, words: str | None) -> None:
    if words is None:
        assert simulated(in_si(), (key,)).gradients[key].impacts.height > 0
        return
    with pytest.raises(ValueError, match=words):
        simulated(in_si(), (key,))


def refused(call: Callable[[], object], words: str) -> None:
    with pytest.raises((KeyError, TypeError, AttributeError), match=words):
        call()


def test_gradients_are_a_mapping_that_travels() -> None:
    run = simulated(in_si(), ("restitution",))
    assert list(run.gradients) == ["restitution"]
    assert pickle.loads(pickle.dumps(run)).gradients["restitution"] == run.gradients["restitution"]
    assert repr(run.gradients["restitution"]).startswith("Gradient by restitution: summary")
    refused(lambda: run.gradients["mass"], "gradients=")
    refused(lambda: simulated(in_si(), (1,)), "give names")  # type: ignore[arg-type]
    assert len(simulated(in_si()).gradients) == 0


def test_what_a_level_motion_does_not_depend_on_is_refused() -> None:
    """With any inclination the absorber starts elsewhere: at 0 there is no derivative."""
    for name in ("inclination", "inclination_deg", "gravity"):
        with pytest.raises(ValueError, match="the line of motion is level; give one that rises"):
            simulated(in_si(), gradients=(name,))


FRAME = iva.Structure(
    frequencies=[2.0, 5.0], damping_ratios=[0.02], points={"a": [0.6, 0.4]}, base=[1.0, 1.0]
)
MASS = iva.Siva(mass=0.2, clearance_mm=300.0, restitution=0.5)
PENDULUM = iva.Piva(mass_ratio=0.1, clearance=0.5, restitution=0.5, length=3.0, frequency_ratio=0.3)
LIGHT = iva.Siva(mass_ratio=0.1, clearance=0.5, restitution=0.5)


@pytest.mark.parametrize(
    ("key", "run"),
    [
        (
            "start.velocity",
            lambda value, more: iva.simulate(
                MASS, FRAME, start=iva.Start(displacement=0.5, velocity=value), duration=8.0, **more
            ),
        ),
        (
            "start.displacement",
            lambda value, more: iva.simulate(
                MASS, FRAME, start=iva.Start(displacement=value, velocity=1.0), duration=8.0, **more
            ),
        ),
        (
            "force.velocity",
            lambda value, more: iva.simulate(
                [LIGHT, PENDULUM],
                iva.Primary(damping_ratio=0.01),
                start=iva.Start(displacement=1.0),
                force=iva.Impulse(velocity=value, time=3.0),
                duration=8.0,
                **more,
            ),
        ),
        (
            "absorber.0.pivot_damping_ratio",
            lambda value, more: iva.simulate(
                [replace(PENDULUM, pivot_damping_ratio=value), LIGHT],
                iva.Primary(damping_ratio=0.01),
                start=iva.Start(displacement=1.0),
                duration=8.0,
                **more,
            ),
        ),
    ],
)
def test_what_is_0_is_differentiated_too(
    key: str, run: Callable[[float, dict[str, Any]], iva.Run]
) -> None:
    """One-sided differences of second order: not every parameter may be less than 0."""
    step = 1e-5
    none, one, two = (run(times * step, {}) for times in (0.0, 1.0, 2.0))
    gradient = run(0.0, {"gradients": (key,)}).gradients[key]

    def slope(of: Callable[[iva.Run], float]) -> float:
        return (4.0 * of(one) - 3.0 * of(none) - of(two)) / (2.0 * step)

    def final(it: iva.Run) -> float:
        return float(it.summary["energy_final"][0])

    assert gradient.summary["energy_final"][0] == pytest.approx(slope(final), rel=1e-4)
    for k in range(4):

        def time(it: iva.Run, k: int = k) -> float:
            return float(it.impacts["time"][k])

        assert gradient.impacts["time"][k] == pytest.approx(slope(time), rel=1e-4, abs=1e-7)


def test_where_a_number_jumps_at_the_value_there_is_no_derivative() -> None:
    """Undamped, x = x₀ cos t + v₀ sin t: near x₀ = 0 peaks of √(x₀² + v₀²) at π/2 − x₀/v₀ + kπ.

    What refers to the amplitude at the start has another reference as soon as x₀ is not 0.
    """
    run = iva.simulate(
        None,
        iva.Primary(),
        start=iva.Start(displacement=0.0, velocity=2.0),
        periods=4.2,
        tables=("summary", "envelope"),
        gradients=("start.displacement",),
    )
    assert run.summary["residual_amplitude"][0] == pytest.approx(1.0, rel=1e-12)
    slopes = run.gradients["start.displacement"]
    assert slopes.summary["residual_amplitude"][0] is None
    assert slopes.summary["energy_final"][0] == pytest.approx(0.0, abs=1e-12)
    assert slopes.envelope.height == run.envelope.height == 8
    assert slopes.envelope["time"].to_list() == pytest.approx([-0.5] * 8, rel=1e-12)
    assert slopes.envelope["displacement"].to_list() == pytest.approx([0.0] * 8, abs=1e-12)


def test_a_corner_at_the_value_has_no_derivative() -> None:
    """Differences in doubles from both sides of a start at rest are not alike."""

    def let_go(velocity: float, gradients: tuple[str, ...] = ()) -> iva.Run:
        start = iva.Start(displacement=1.0, velocity=velocity)
        primary = iva.Primary(damping_ratio=0.02)
        return iva.simulate(None, primary, start=start, periods=8, gradients=gradients)

    low, at, high = (let_go(by).summary["damping_ratio_fit"][0] for by in (-1e-6, 0.0, 1e-6))
    assert abs((high - at) - (at - low)) > 1e-5 * 1e-6
    slopes = let_go(0.0, ("start.velocity",)).gradients["start.velocity"].summary
    assert slopes["damping_ratio_fit"][0] is None
    assert slopes["energy_final"][0] is not None


@pytest.mark.parametrize(
    ("key", "more"),
    [
        ("friction", {"absorber": replace(LIGHT, friction=0.0, gravity=1.0)}),
        ("gap_damping_ratio", {"absorber": replace(LIGHT, gap_damping_ratio=0.0)}),
        ("force.time", {"force": iva.Impulse(velocity=0.4, time=0.0)}),
    ],
)
def test_what_makes_another_scene_at_0_is_refused_there(key: str, more: dict[str, Any]) -> None:
    scene: dict[str, Any] = {"absorber": LIGHT, "start": iva.Start(displacement=1.0)} | more
    with pytest.raises(ValueError, match="at 0 it has no derivative"):
        iva.simulate(scene.pop("absorber"), iva.Primary(), periods=2, gradients=(key,), **scene)


def test_gravity_matters_where_a_mass_rubs() -> None:
    def rubbed(gravity: float, **more: Any) -> iva.Run:
        mass = replace(LIGHT, friction=0.1, gravity=gravity)
        start = iva.Start(displacement=1.0)
        return iva.simulate(mass, iva.Primary(damping_ratio=0.02), start=start, periods=2, **more)

    found = rubbed(1.0, gradients=("gravity",)).gradients["gravity"].summary["energy_friction"][0]
    high, low = (rubbed(1.0 + by).summary["energy_friction"][0] for by in (1e-6, -1e-6))
    assert found == pytest.approx((high - low) / 2e-6, rel=1e-5)


def test_a_late_sensitivity_leaves_what_is_decided_before() -> None:
    # The damping ratio over three cycles is the same in a run that ends before it becomes
    # sensitive, and its derivative a quotient of such runs.
    def run(gap: float, duration: float, **more: Any) -> iva.Run:
        siva = iva.Siva(mass=0.25, gap_mm=gap, restitution=0.7)
        primary = iva.Primary(mass=3.0, stiffness=12e3, damping=0.5)
        start = iva.Start(displacement_mm=4.0)
        return iva.simulate(siva, primary, start=start, duration=duration, **more)

    long, short = (run(3.0, end, gradients=("gap_mm",)) for end in (8.0, 2.0))
    summary, before = (one.gradients["gap_mm"].summary for one in (long, short))
    assert 4.0 < summary["sensitive_from"].item() < 6.0
    assert before["sensitive_from"].item() is None
    for name in ("damping_ratio_1", "damping_ratio_3", "damping_ratio_10"):
        assert summary[name].item() == before[name].item()
    step = 1e-6
    low, high = (run(3.0 + way, 0.5).summary["damping_ratio_3"].item() for way in (-step, step))
    quotient = (high - low) / (2 * step)
    assert summary["damping_ratio_3"].item() == pytest.approx(quotient, rel=1e-6)
    assert summary["residual_amplitude"].item() is None


def test_a_fit_that_is_over_does_not_depend_on_what_follows() -> None:
    # It ends with the first peak below 5 % of the start, and is the same in a run that ends soon
    # after that, before the motion becomes sensitive.
    def run(gap: float, duration: float, damping: float = 12.0, **more: Any) -> iva.Run:
        siva = iva.Siva(mass=0.25, gap_mm=gap, restitution=0.7)
        primary = iva.Primary(mass=3.0, stiffness=12e3, damping=damping)
        start = iva.Start(displacement_mm=4.0)
        return iva.simulate(siva, primary, start=start, duration=duration, **more)

    long, short = (run(0.1, end, gradients=("gap_mm",)) for end in (8.0, 3.0))
    summary, before = (one.gradients["gap_mm"].summary for one in (long, short))
    peaks = run(0.1, 8.0, tables=("envelope",)).envelope
    end = peaks.filter(pl.col("amplitude") < 0.05 * 4e-3)["time"][0]
    assert end < 3.0 < summary["sensitive_from"].item() < 8.0
    assert before["sensitive_from"].item() is None
    assert summary["damping_ratio_fit"].item() == before["damping_ratio_fit"].item() is not None
    step = 1e-8
    low, high = (run(0.1 + way, 3.0).summary["damping_ratio_fit"].item() for way in (-step, step))
    quotient = (high - low) / (2 * step)
    assert summary["damping_ratio_fit"].item() == pytest.approx(quotient, rel=1e-3)
    # Where a peak of the fit comes later, its derivative is not known.
    late = run(0.3, 8.0, damping=6.0, gradients=("gap_mm",)).gradients["gap_mm"].summary
    peaks = run(0.3, 8.0, damping=6.0, tables=("envelope",)).envelope
    end = peaks.filter(pl.col("amplitude") < 0.05 * 4e-3)["time"][0]
    assert late["sensitive_from"].item() < end
    assert late["damping_ratio_fit"].item() is None


def test_a_fit_of_a_start_from_rest_refers_to_its_first_peak() -> None:
    # With x(0) = 0 it ends at 5 % of the first peak, which later runs do not change.
    def run(gap: float, duration: float) -> iva.Run:
        siva = iva.Siva(mass=0.25, gap_mm=gap, restitution=0.7)
        primary = iva.Primary(mass=3.0, stiffness=12e3, damping=12.0)
        start = iva.Start(velocity=0.25)
        return iva.simulate(siva, primary, start=start, duration=duration, gradients=("gap_mm",))

    long, short = (run(0.1, end).gradients["gap_mm"].summary for end in (8.0, 3.0))
    assert long["sensitive_from"].item() < 8.0
    assert short["sensitive_from"].item() is None
    assert long["damping_ratio_fit"].item() == short["damping_ratio_fit"].item() is not None
