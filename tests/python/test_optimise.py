"""iva.optimise: what it finds, what it says of it, and how it ends.

Numbers to compare with are closed forms (Masri and Caughey), a sweep over all designs, or planted.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import iva
from iva.sampling import Normal, Uniform

STRUCTURE = iva.Primary(mass=3.0, stiffness=12_000.0, damping=2.0)


def robust_design(**changed: Any) -> iva.Optimum:
    """Return the optimum of gap and mass of docs/design-a-damper.md, with few runs."""
    given: dict[str, Any] = {
        "choose": {"gap_mm": (2, 14), "absorber.mass": (0.05, 0.6)},
        "off": {"gap_mm": Uniform(-0.25, 0.25)},
        "over": {"restitution": Normal(0.6, 0.05), "displacement_mm": Uniform(3, 5)},
        "minimise": "settling_time_5",
        "duration": 18.0,
        "runs": 3000,
        "seed": 1,
    }
    return iva.optimise(iva.Siva(), STRUCTURE, **given | changed)


@pytest.fixture(scope="module")
def found() -> iva.Optimum:
    """Return one optimum for all who only look."""
    return robust_design()


@pytest.mark.parametrize(("restitution", "mass_ratio"), [(0.6, 0.1), (0.5, 0.1)])
def test_the_best_clearance_is_that_of_masri_and_caughey(
    restitution: float, mass_ratio: float
) -> None:
    # A golden section over the amplitude of the stable orbit in closed form.
    primary, force = iva.Primary(damping_ratio=0.02), iva.Harmonic(amplitude=0.1, frequency=1.0)
    siva = {"mass_ratio": mass_ratio, "restitution": restitution}

    def amplitude(clearance: float) -> float:
        made = iva.Siva(**siva, clearance=clearance)
        orbit = iva.theory.masri_caughey(made, primary, force).stable
        return np.inf if orbit is None else orbit.amplitude

    low, high = 1.05, 1.2 + 0.05 * (restitution == 0.6)
    share = (np.sqrt(5) - 1) / 2
    while high - low > 1e-9:
        first, second = high - share * (high - low), low + share * (high - low)
        low, high = (low, second) if amplitude(first) < amplitude(second) else (first, high)
    best = iva.optimise(
        iva.Siva(**siva),
        primary,
        choose={"clearance": (0.5, 1.6)},
        minimise="amplitude_max",
        force=force,
        cycles=600,
        discard=560,
        runs=600,
    )
    assert best.best["clearance"] == pytest.approx(low, abs=1e-6)
    assert best.fresh["value"].item() == pytest.approx(amplitude(low), rel=1e-12)


def test_the_same_seed_gives_the_same_bits(found: iva.Optimum) -> None:
    again = robust_design(threads=1)
    for name in ("fresh", "as_good", "front", "table"):
        assert getattr(found, name).equals(getattr(again, name))
    assert found.best == again.best
    assert robust_design(seed=2).best != found.best


def test_what_is_said_of_the_best_is_what_a_sweep_says(found: iva.Optimum) -> None:
    swept = iva.sweep(
        iva.Siva(mass=found.best["absorber.mass"]),
        STRUCTURE,
        over={
            "restitution": Normal(0.6, 0.05),
            "displacement_mm": Uniform(3, 5),
            "gap_mm": Uniform(found.best["gap_mm"] - 0.25, found.best["gap_mm"] + 0.25),
        },
        sampling=iva.sampling.Sobol(1 << 13),
        start=iva.Start(),
        duration=18.0,
    )
    times = swept.summary["settling_time_5"].fill_null(np.inf)
    row = found.fresh.row(0, named=True)
    assert row["low"] <= times.quantile(0.9) <= row["high"]
    again = found.of_cases(4000, seed=3).row(0, named=True)
    assert again["value"] == pytest.approx(times.quantile(0.9), rel=0.02)
    assert again["cases"] == 4000


def test_the_best_beats_what_a_sweep_of_nominal_scenes_chooses(found: iva.Optimum) -> None:
    # The best of nominal designs settles in 3 s where much is not known exactly.
    assert found.fresh["value"].item() < 1.6
    assert found.runs <= 3000
    assert found.is_complete


def test_a_design_out_of_bounds_is_never_the_best() -> None:
    free = robust_design()
    assert free.of_cases(500, seed=1)["value"].item() < 1.6
    bounded = robust_design(within={"impulse_max": 0.08, "stroke_mm": 20.0})
    rows = {row["measure"]: row for row in bounded.fresh.iter_rows(named=True)}
    assert rows["impulse_max"]["value"] <= 0.08 * 1.03
    assert rows["impulse_max"]["bound"] == 0.08
    # In millimetres what is in metres in the summary.
    assert 2.0 < rows["stroke_mm"]["value"] < 20.0
    assert rows["settling_time_5"]["value"] > free.fresh["value"].item()


def test_cases_without_a_value_are_the_worst() -> None:
    # A release from 0.1 mm never closes a gap of 2 mm or more: that case does not settle in time.
    def given(share: float) -> iva.Optimum:
        starts = [0.1] * round(100 * share) + [4.0] * round(100 * (1 - share))
        return iva.optimise(
            iva.Siva(mass=0.25),
            STRUCTURE,
            choose={"gap_mm": (3, 8), "restitution": (0.5, 0.7)},
            over={"displacement_mm": starts},
            minimise="settling_time_5",
            duration=6.0,
            runs=2000,
        )

    few, many = given(0.05), given(0.2)
    assert few.fresh["value"].item() < 3.0
    assert few.fresh["missing"].item() == pytest.approx(0.05, abs=0.04)
    assert many.fresh["value"].item() is None
    assert many.fresh["missing"].item() == pytest.approx(0.2, abs=0.06)
    assert "count as worst" in repr(many)


def test_cases_out_of_range_are_the_worst_and_few_end_nothing() -> None:
    found = robust_design(over={"restitution": Normal(0.9, 0.05), "displacement_mm": [4.0]})
    beyond = 1 - 0.97725  # of a normal distribution beyond two deviations
    assert found.fresh["missing"].item() == pytest.approx(beyond, abs=0.02)
    with pytest.raises(ValueError, match=r"^restitution = 1\.\d+: give a number from 0 to 1$"):
        robust_design(over={"restitution": Normal(1.05, 0.05), "displacement_mm": [4.0]})


@pytest.mark.parametrize("field", ["gap_displacement", "gap_offset"])
def test_cases_that_start_outside_the_gap_are_the_worst(field: str) -> None:
    # Half the play is 2 mm; of starts up to 2.5 mm from the middle a fifth lies outside.
    found = iva.optimise(
        iva.Siva(mass=0.25, restitution=0.6),
        STRUCTURE,
        choose={"gap_mm": (4.0, 4.001)},
        over={field: Uniform(-0.0025, 0.0025)},
        minimise="settling_time_5",
        start=iva.Start(displacement_mm=4.0),
        quantile=0.7,
        duration=6.0,
        runs=3000,
    )
    row = found.fresh.row(0, named=True)
    assert row["missing"] == pytest.approx(0.2, abs=0.04)
    # Seven tenths of all cases are seven eighths of those that can be run.
    swept = iva.sweep(
        iva.Siva(mass=0.25, restitution=0.6, gap_mm=4.0),
        STRUCTURE,
        over={field: np.linspace(-0.002, 0.002, 2001)},
        start=iva.Start(displacement_mm=4.0),
        duration=6.0,
    )
    assert row["low"] <= swept.summary["settling_time_5"].quantile(0.7 / 0.8) <= row["high"]


def test_a_case_counts_as_worst_if_one_of_its_runs_cannot_be() -> None:
    # A start 3 mm from the middle lies in gaps of more than 6 mm.
    found = iva.optimise(
        iva.Siva(mass=0.25, restitution=0.6),
        STRUCTURE,
        choose={"gap_mm": (2, 14)},
        minimise="gap_mm",
        within={"settling_time_5": 5.0},
        worst_over={"gap_displacement": [0.0, 0.003]},
        start=iva.Start(displacement_mm=4.0),
        duration=6.0,
        runs=600,
    )
    assert found.best["gap_mm"] == pytest.approx(6.0, abs=0.02)
    assert found.best["gap_mm"] >= 6.0


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        # The widest gap, of 14 mm, holds starts up to 7 mm from its middle.
        (
            {"start": iva.Start(gap_displacement=0.008)},
            r"^start\.gap_displacement = 0\.008: it must",
        ),
        ({"over": {"displacement_mm": [4.0]}}, r"^absorber\.restitution is missing"),
    ],
)
def test_what_no_design_can_be_run_with_ends_it(changed: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        robust_design(**changed)


def test_the_worst_over_a_band_and_two_starts() -> None:
    force = iva.Harmonic(force=5.0, frequency_hz=10.0)
    band = {"force.frequency_hz": [9.5, 10.0, 10.5], "displacement_mm": [0.0, 20.0]}
    scene: dict[str, Any] = {"force": force, "cycles": 60, "discard": 40}
    found = iva.optimise(
        iva.Siva(mass=0.25, restitution=0.6),
        STRUCTURE,
        choose={"gap_mm": (2, 14)},
        maximise="reduction",
        worst_over=band,
        runs=500,
        **scene,
    )
    start = iva.Start()
    absorber = iva.Siva(mass=0.25, restitution=0.6, gap_mm=found.best["gap_mm"])
    swept = iva.sweep(absorber, STRUCTURE, over=band, start=start, **scene)
    assert found.fresh["value"].item() == swept.summary["reduction"].min()
    assert found.runs <= 500


def test_a_front_is_beaten_by_nothing_that_was_tried() -> None:
    both = ["settling_time_5", "absorber.mass"]
    found = iva.optimise(
        iva.Siva(restitution=0.6),
        STRUCTURE,
        choose={"gap_mm": (2, 14), "absorber.mass": (0.05, 0.6)},
        minimise=both,
        start=iva.Start(displacement_mm=4),
        duration=18.0,
        runs=1500,
    )
    front = iva.pareto(found.table, both).select(both).unique(maintain_order=True)
    assert found.front.select(both).equals(front)
    assert found.front.height > 5
    axes = iva.plots.design(found)
    assert axes.get_ylabel().startswith("absorber mass")


def test_a_front_under_cases_has_designs_that_keep_their_rank() -> None:
    found = robust_design(minimise=["settling_time_5", "absorber.mass"], runs=8000)
    assert found.front.height > 3
    both = ["settling_time_5", "absorber.mass"]
    assert found.front.height == iva.pareto(found.front, both).height
    assert found.fresh.height == 2
    assert "front: " in repr(found)


def test_sizes_that_can_be_had() -> None:
    sizes = {"gap_mm": {"low": 2, "high": 14, "step": 0.5}, "absorber.mass": [0.1, 0.2, 0.3]}
    found = robust_design(choose=sizes)
    assert set(found.table["absorber.mass"]) <= {0.1, 0.2, 0.3}
    assert all(gap * 2 == round(gap * 2) for gap in found.table["gap_mm"])
    assert found.table.select("gap_mm", "absorber.mass").n_unique() == found.table.height


def test_one_of_two_absorbers() -> None:
    pair = [iva.Siva(mass=0.25), iva.Siva(mass=0.01)]
    found = iva.optimise(
        pair,
        STRUCTURE,
        choose={"gap_mm": (3, 8)},
        over={"restitution": [0.5, 0.6, 0.7]},
        minimise="settling_time_5",
        start=iva.Start(displacement_mm=4),
        duration=18.0,
        runs=2000,
    )
    assert found.best_absorber == 0
    assert set(found.table["absorber"]) == {0, 1}
    assert found.scene["absorber"] == iva.Siva(mass=0.25, restitution=0.6, **found.best)


def test_the_scene_of_the_best_has_medians(found: iva.Optimum) -> None:
    run = iva.simulate(**found.scene)
    assert run.absorber == iva.Siva(
        mass=found.best["absorber.mass"], gap_mm=found.best["gap_mm"], restitution=0.6
    )
    assert run.start.displacement_mm == 4.0


def test_an_optimum_can_be_pickled(found: iva.Optimum) -> None:
    again = pickle.loads(pickle.dumps(found))
    assert again.table.equals(found.table)
    assert again.of_cases(50, seed=1).equals(found.of_cases(50, seed=1))
    with pytest.raises(ValueError, match="count = 0: give a whole number from 1"):
        found.of_cases(0, seed=1)


def test_rows_of_a_frame_are_drawn_together() -> None:
    # Two kinds of stops, each with its own start: other pairs never occur.
    cases = pl.DataFrame({"restitution": [0.3, 0.7], "displacement_mm": [3.0, 5.0]})
    seen: set[tuple[float, float]] = set()
    from iva.optimisation.cases import Draw, uncertain_of

    uncertain = uncertain_of(cases, None, ["gap_mm"])
    for method in ("sobol", "random"):
        of = uncertain.values(Draw(uncertain, method, 3).cases(5, 105))
        seen |= set(zip(of["restitution"], of["displacement_mm"], strict=True))
        assert 0.3 < np.mean(of["restitution"] == 0.3) < 0.7
    assert seen == {(0.3, 3.0), (0.7, 5.0)}
    assert robust_design(over=cases, runs=1000).is_complete


def test_ctrl_c_gives_the_best_so_far(tmp_path: Path) -> None:
    def interrupting(least: int) -> Callable[[int, int], None]:
        def told(done: int, _total: int) -> None:
            if done >= least:
                raise KeyboardInterrupt

        return told

    stopped = robust_design(progress=interrupting(1500), out=tmp_path / "out")
    assert not stopped.is_complete
    assert stopped.fresh.is_empty()
    assert stopped.table.height > 0
    assert "stopped before the end" in repr(stopped)
    whole = robust_design(out=tmp_path / "out", resume=True)
    assert whole.is_complete
    assert whole.table.equals(robust_design().table)
    with pytest.raises(KeyboardInterrupt):
        robust_design(progress=interrupting(1))


def test_what_a_folder_holds_is_not_run_again(tmp_path: Path, found: iva.Optimum) -> None:
    out = tmp_path / "out"
    first = robust_design(out=out)
    batches = sorted((out / "runs").iterdir())
    assert len(batches) > 5
    kept = {path: path.stat().st_mtime_ns for path in batches}
    batches[2].write_bytes(b"damaged")
    batches[4].unlink()
    again = robust_design(out=out, resume=True)
    assert again.table.equals(first.table)
    assert again.fresh.equals(found.fresh)
    anew = {path for path in batches if path.stat().st_mtime_ns != kept[path]}
    assert anew == {batches[2], batches[4]}
    assert pl.read_parquet(out / "as_good.parquet").equals(first.as_good)
    with pytest.raises(ValueError, match=r"give resume=True or overwrite=True$"):
        robust_design(out=out)
    with pytest.raises(ValueError, match="asks something else"):
        robust_design(out=out, resume=True, seed=5)
    assert robust_design(out=out, overwrite=True, seed=5).is_complete
    (tmp_path / "else").mkdir()
    (tmp_path / "else" / "letter.txt").write_text("dear")
    with pytest.raises(ValueError, match="it holds something else; give a new folder"):
        robust_design(out=tmp_path / "else", overwrite=True)
    assert (tmp_path / "else" / "letter.txt").read_text() == "dear"


def test_a_folder_made_by_somebody_else_loses_nothing(tmp_path: Path) -> None:
    out, letter = tmp_path / "out", tmp_path / "letter.txt"
    letter.write_text("dear")
    robust_design(out=out, runs=500)
    (out / "runs" / "mine.txt").write_text("mine")
    for name in ("fresh.parquet", "table.parquet"):
        (out / name).unlink()
        (out / name).symlink_to(letter)
    assert robust_design(out=out, runs=500, overwrite=True).is_complete
    assert letter.read_text() == "dear"
    assert (out / "runs" / "mine.txt").read_text() == "mine"
    assert not (out / "fresh.parquet").is_symlink()
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "optimum.json").write_text("{}")
    with pytest.raises(ValueError, match="it holds something else"):
        robust_design(out=tmp_path / "other", overwrite=True)
    linked = tmp_path / "linked"
    linked.mkdir()
    (linked / "optimum.json").write_text('{"asked": ""}')
    (linked / "runs").symlink_to(tmp_path)
    with pytest.raises(ValueError, match="runs in it is a link"):
        robust_design(out=linked, overwrite=True)


SLIPS: list[tuple[dict[str, Any], str]] = [
    ({"choose": {}}, r"choose = \{\}: give at least one"),
    ({"choose": {"gap_mm": [2, 14]}}, r"choose\['gap_mm'\] = \[2, 14\]: give \(low, high\)"),
    ({"choose": {"gap_mm": (14, 2)}}, "give two finite numbers, the smaller first"),
    ({"choose": {"gapp": (2, 14)}, "off": None}, "^`gapp`: no such field; did you mean `gap`"),
    ({"choose": {"gap_mm": {"low": 2, "high": 9, "step": 0}}}, "step'] = 0.0: give a number great"),
    ({"choose": {"gap_mm": (-2, 14)}}, "^gap_mm = -2: give a number greater than 0"),
    ({"minimise": "settling_tme_5"}, "did you mean `settling_time_5`"),
    ({"minimise": None}, "minimise and maximise are missing"),
    ({"minimise": "reduction"}, "the larger it is the better; give it as `maximise`"),
    ({"minimise": ["impacts", "impacts"]}, "impacts is given twice"),
    ({"off": {"restitution": Uniform(0, 1)}}, r"off\['restitution'\]: it is not chosen"),
    ({"off": {"gap_mm": "5"}}, r"off\['gap_mm'\] = '5': give a percentage"),
    ({"over": {"gap_mm": Uniform(1, 2)}}, "it is chosen; give how far it may be off in `off`"),
    ({"over": {"gap": Uniform(1, 2)}}, "gap_mm sets the same quantity; give one of them"),
    ({"over": {"restitution": []}}, r"over\['restitution'\] = \[\]: give at least one value"),
    ({"quantile": 1.0}, "quantile = 1.0: give a number between 0 and 1"),
    ({"quantile": 0.9, "mean": True}, "quantile, mean, worst_of, cvar: give one of them"),
    ({"within": {"impulse_mx": 1.0}}, "did you mean `impulse_max`"),
    ({"worst_over": {"displacement": []}}, "give at least one value"),
    ({"runs": 10}, "runs = 10: give a whole number from 500"),
    ({"seed": -1}, "seed = -1: give a whole number"),
    ({"resume": True}, "resume = True: it is about a folder; give out"),
]


@pytest.mark.parametrize(("changed", "said"), SLIPS)
def test_bad_input_gets_one_sentence(changed: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        robust_design(**changed)


def test_wrong_types_get_one_sentence() -> None:
    slips: list[tuple[dict[str, Any], str]] = [
        ({"choose": 3}, "choose = 3: give a mapping"),
        ({"choose": {"gap_mm": 3}}, r"choose\['gap_mm'\] = 3: give \(low, high\)"),
        ({"over": 3}, "over = 3: give a mapping"),
        ({"over": {"restitution": 0.5}}, "give a distribution of iva.sampling, or a list"),
        ({"off": {"gap_mm": 0.1}}, "give a distribution of iva.sampling that is added"),
        ({"within": 3}, "within = 3: give a mapping"),
        ({"minimise": 3}, "minimise = 3: give a measure"),
        ({"mean": 1}, "mean = 1: give True or False"),
        ({"choise": 3}, "choise = 3: optimise has no such argument; did you mean `choose`"),
    ]
    for changed, said in slips:
        with pytest.raises(TypeError, match=said):
            robust_design(**changed)


def test_pictures(found: iva.Optimum) -> None:
    axes = iva.plots.design(found)
    assert axes.get_xlabel() == "total play 2d (mm)"
    one = iva.optimise(
        iva.Siva(mass=0.2, restitution=0.6),
        STRUCTURE,
        choose={"gap_mm": (2, 14)},
        minimise="settling_time_5",
        start=iva.Start(displacement_mm=4),
        duration=18.0,
        runs=500,
    )
    assert "settling time" in iva.plots.design(one).get_ylabel()
    with pytest.raises(ValueError, match="did you mean `gap_mm`"):
        iva.plots.design(found, x="gap_m")
    with pytest.raises(TypeError, match=r"give an iva\.Optimum, of iva\.optimise"):
        iva.plots.design(3)  # type: ignore[arg-type]


def test_an_end_of_the_choices_and_a_run_too_short_are_said() -> None:
    # A heavier mass takes more in each impact, and the lightest is the best by itself.
    scene = (iva.Siva(restitution=0.6, relative_clearance=0.5), iva.Primary(damping_ratio=0.01))
    choose = {"mass_ratio": (0.01, 0.03)}
    start = iva.Start(displacement=1.0)
    heavy = iva.optimise(
        *scene, choose=choose, maximise="damping_ratio_1", start=start, periods=5, runs=500
    )
    assert heavy.best["mass_ratio"] > 0.0298
    assert heavy.at_ends() == {"mass_ratio": "upper end"}
    assert "mass_ratio is at the upper end of its choices" in repr(heavy)
    light = iva.optimise(
        *scene, choose=choose, minimise="mass_ratio", start=start, periods=5, runs=500
    )
    assert light.at_ends() == {"mass_ratio": "lower end"}
    short = iva.optimise(
        *scene, choose=choose, minimise="settling_time_2", start=start, periods=2, runs=500
    )
    assert "a measure is missing in too many cases: make the run longer" in repr(short)
