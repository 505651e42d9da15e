"""The parts of an optimisation: criteria, choices, cases, the plateau, the plan.

Numbers to compare with are closed forms of order statistics, sorted lists, or planted.
"""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st

import iva
from iva.optimisation.cases import Draw, uncertain_of
from iva.optimisation.choices import choice_of
from iva.optimisation.criteria import Mean, Quantile, TailMean, WorstOf, criterion_of
from iva.optimisation.evaluation import Candidate, Evaluation
from iva.optimisation.logbook import Logbook
from iva.optimisation.optimising import problem_of
from iva.optimisation.plan import plan_of
from iva.optimisation.plateau import told_apart
from iva.optimisation.race import raced
from iva.optimisation.search import weighing_of
from iva.optimisation.stages import unbeaten
from iva.optimisation.studies import asked_of, of_study
from iva.sampling import LogNormal, Normal, Uniform
from iva.scenes import scene

STRUCTURE = iva.Primary(mass=3.0, stiffness=12_000.0, damping=2.0)
VALUES = st.lists(st.one_of(st.integers(-9, 9).map(float), st.just(math.inf)), min_size=1)


def evaluation_of(runs: int = 10_000, **changed: Any) -> Evaluation:
    """Return the evaluation of gap and mass of a free mass, of which nothing was run."""
    unset = ("maximise", "off", "quantile", "worst_of", "cvar", "within", "worst_over")
    asked = dict.fromkeys(unset) | {
        "choose": {"gap_mm": (2, 14), "absorber.mass": (0.05, 0.6)},
        "over": {"restitution": Normal(0.6, 0.05)},
        "minimise": "settling_time_5",
        "mean": False,
        "seed": 0,
    }
    spec = scene(iva.Siva(), STRUCTURE, iva.Start(displacement_mm=4), None, {"duration": 18.0})
    return Evaluation(problem_of([spec], asked | changed), runs, Logbook(None, ""), 1, None)


def planted(evaluation: Evaluation, gap: float, *bad: Any) -> Candidate:
    """Return a candidate with planted values of its measures."""
    made = evaluation.candidate(0, np.array([gap, 0.5]))
    made.bad = np.array(bad, dtype=float)
    return made


@given(VALUES, st.floats(0.01, 0.99))
def test_a_quantile_is_the_smallest_value_that_enough_stay_below(
    values: list[float], share: float
) -> None:
    found = float(Quantile(share).of(np.array(values)))
    enough = [v for v in values if sum(w <= v for w in values) >= share * len(values) * (1 - 1e-15)]
    assert found == min(enough)


@given(VALUES, st.floats(0.01, 0.99))
def test_the_mean_of_the_worst(values: list[float], share: float) -> None:
    worst = max(round((1 - share) * len(values)), 1)
    assert TailMean(share).of(np.array(values)) == pytest.approx(np.mean(sorted(values)[-worst:]))


def test_the_worst_of_a_number_is_passed_in_one_of_two_lots() -> None:
    # Of n uniform numbers all lie below q with probability qⁿ.
    criterion = criterion_of(None, False, 50, None)
    assert isinstance(criterion, WorstOf)
    assert criterion.share**50 == pytest.approx(0.5)
    assert criterion.words == "worst of 50"


@pytest.mark.parametrize(
    ("criterion", "truth"),
    [(Quantile(0.9), 0.9), (Quantile(0.5), 0.5), (Mean(), 0.5), (TailMean(0.8), 0.9)],
)
def test_intervals_hold_nine_times_of_ten(criterion: Any, truth: float) -> None:
    # Of uniform numbers the share that a quantile stays above is itself. 4 standard errors.
    rng = np.random.default_rng(5)
    inside = 0
    for _ in range(1000):
        low, high = criterion.interval(rng.random(200))
        inside += low <= truth <= high
    assert 0.9 - 4 * 0.0095 < inside / 1000 < 0.9 + 4 * 0.0095 + 0.02


def test_too_few_cases_bound_nothing() -> None:
    assert Quantile(0.9).interval(np.array([1.0, 2.0, 3.0])) == (2.0, math.inf)
    assert Mean().interval(np.array([1.0, math.inf])) == (math.inf, math.inf)
    assert Mean().interval(np.array([1.0])) == (-math.inf, math.inf)


def test_choices_share_out_their_coordinates() -> None:
    units = np.linspace(0, 1, 1001)
    assert choice_of("x", (2, 14)).at(units) == pytest.approx(2 + 12 * units)
    sizes = choice_of("x", [3.0, 1.0, 2.0, 2.0])
    counts = np.unique(sizes.at(units), return_counts=True)
    assert counts[0].tolist() == [1.0, 2.0, 3.0]
    assert counts[1] == pytest.approx(1001 / 3, abs=2)
    stepped = choice_of("x", {"low": 0.05, "high": 0.6, "step": 0.025})
    assert len(stepped.sizes) == 23
    for choice in (sizes, stepped):
        for size in choice.sizes:
            assert float(choice.at(np.array(choice.unit(size)))) == size


def test_longer_draws_begin_with_shorter_ones() -> None:
    uncertain = uncertain_of({"restitution": Normal(0.6, 0.05)}, None, [])
    for method in ("sobol", "random"):
        short = Draw(uncertain, method, 7).cases(0, 100)["over restitution"]
        long = Draw(uncertain, method, 7)
        assert long.cases(0, 5000)["over restitution"][:100].tolist() == short.tolist()
        assert long.cases(50, 60)["over restitution"].tolist() == short[50:60].tolist()


def test_medians_halve_the_cases() -> None:
    over = {
        "restitution": Normal(0.6, 0.3, low=0.0, high=1.0),
        "displacement_mm": Uniform(3, 5),
        "damping_ratio": LogNormal(0.01, 0.5, high=0.02),
        "mass_ratio": [0.1, 0.2, 0.4],
    }
    uncertain = uncertain_of(over, None, [])
    drawn = uncertain.values(Draw(uncertain, "sobol", 1).cases(0, 4096))
    for key in list(over)[:3]:
        assert np.mean(drawn[key] < uncertain.medians[key]) == pytest.approx(0.5, abs=0.01)
    assert uncertain.medians["mass_ratio"] == 0.2


def test_offsets_are_added_or_relative() -> None:
    off = {"gap_mm": Uniform(-0.25, 0.25), "absorber.mass": "10%"}
    uncertain = uncertain_of(None, off, ["gap_mm", "absorber.mass"])
    cases = Draw(uncertain, "sobol", 1).cases(0, 1024)
    for key, chosen, reach in (("gap_mm", 5.0, 0.25), ("absorber.mass", 0.2, 0.02)):
        values = uncertain.offset(key, np.array([chosen, 2 * chosen]), cases)
        assert values[0].min() == pytest.approx(chosen - reach, rel=1e-2)
        assert values[0].max() == pytest.approx(chosen + reach, rel=1e-2)
        by = reach if key == "gap_mm" else 2 * reach
        assert values[1].max() == pytest.approx(2 * chosen + by, rel=1e-2)


def test_what_is_as_good_is_told_from_what_is_worse() -> None:
    # Pairs under the same cases: the first differs by nothing but noise, the second by 3 %.
    evaluation = evaluation_of()
    rng = np.random.default_rng(1)
    common = 1 + 0.3 * rng.random(400)
    best = planted(evaluation, 0.1, common)
    same = planted(evaluation, 0.2, common + 0.001 * rng.standard_normal(400))
    worse = planted(evaluation, 0.3, common * 1.03)
    better = planted(evaluation, 0.4, common * 0.9)
    lost = planted(evaluation, 0.5, np.where(np.arange(400) < 60, np.inf, common))
    assert told_apart(evaluation, best, [same, worse, better, lost], 0) == [
        False,
        True,
        False,
        True,
    ]


def test_what_fails_in_one_case_of_eight_is_not_as_good() -> None:
    # By the 90 % quantile: 15 of 120 cases fail, and the others are better. A quarter of the
    # resamples have fewer than 13 of the 15, and in these it beats the best.
    evaluation = evaluation_of()
    common = 1 + 0.3 * np.random.default_rng(1).random(120)
    best = planted(evaluation, 0.1, common)
    fails = planted(evaluation, 0.2, np.where(np.arange(120) % 8 == 0, 12.2, 0.9 * common))
    assert told_apart(evaluation, best, [fails], 0) == [True]


def test_a_range_and_a_list_are_not_mistaken_for_each_other() -> None:
    with pytest.raises(ValueError, match=r"over\['restitution'\] = \(0\.5, 0\.7\): for a range"):
        uncertain_of({"restitution": (0.5, 0.7)}, None, [])
    assert uncertain_of({"restitution": [0.5, 0.7]}, None, []).medians["restitution"] == 0.6


def test_what_passes_a_bound_is_not_as_good() -> None:
    evaluation = evaluation_of(within={"impulse_max": 1.0})
    best = planted(evaluation, 0.1, [2.0] * 50, [0.9] * 50)
    passing = planted(evaluation, 0.2, [1.0] * 50, [1.1] * 50)
    assert told_apart(evaluation, best, [passing], 0) == [True]


@given(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5), st.booleans()), max_size=12))
def test_a_front_is_what_no_other_beats(rows: list[tuple[int, int, bool]]) -> None:
    evaluation = evaluation_of(
        minimise=["settling_time_5", "impulse_max"], within={"amplitude_max": 1.0}
    )
    some = [
        planted(evaluation, at / 20, [float(a)], [float(b)], [0.5 if kept else 2.0])
        for at, (a, b, kept) in enumerate(rows)
    ]
    keeping = [(a, b) for a, b, kept in rows if kept]
    best = sorted(
        (a, b)
        for a, b in keeping
        if not any(c <= a and d <= b and (c, d) != (a, b) for c, d in keeping)
    )
    assert [tuple(one.bad[:2, 0]) for one in unbeaten(evaluation, some)] == best


def test_a_race_keeps_what_more_cases_favour() -> None:
    # Lucky under the first cases, and ordinary under the others.
    evaluation = evaluation_of(runs=60_000)
    draws = [Draw(evaluation.problem.uncertain[0], "sobol", 0)]
    plan = plan_of(60_000, 2, 1, 1, certain=False)
    good = evaluation.candidate(0, np.array([(5.25 - 2) / 12, (0.25 - 0.05) / 0.55]))
    lucky = evaluation.candidate(0, np.array([0.99, 0.01]))
    evaluation.extend([good, lucky], draws, plan.searched)
    lucky.bad = np.full_like(lucky.bad, 1e-3)
    weighed = weighing_of(evaluation, [good, lucky], np.ones(1))
    left = raced(evaluation, draws, [lucky, good], [weighed], plan)
    assert {one.cases for one in left} == {plan.last}
    assert evaluation.numbers(good)[0] < evaluation.numbers(lucky)[0]


def test_the_plan_spends_what_may_be_spent() -> None:
    for cases, fields, variants, goals in itertools.product(
        (500, 5000, 60_000, 10**6), (1, 2, 6), (1, 2), (1, 2)
    ):
        plan = plan_of(cases, fields, variants, goals, certain=False)
        spent = variants * (
            plan.explored * plan.first
            + plan.kept * (plan.searched - plan.first)
            + plan.generations * plan.kept * plan.searched
        )
        spent += plan.raced * (plan.round - plan.searched) + plan.finalists * plan.last
        if cases >= 60_000:
            assert spent < 0.9 * cases
        assert plan.first <= plan.searched <= plan.round <= plan.last


def test_fresh_cases_are_others_than_those_of_the_search() -> None:
    over = {"restitution": Normal(0.6, 0.05), "displacement_mm": Uniform(3, 5)}
    found = iva.optimise(
        iva.Siva(mass=0.25),
        STRUCTURE,
        choose={"gap_mm": (3, 8)},
        over=over,
        minimise="settling_time_5",
        duration=18.0,
        runs=2000,
        seed=4,
    )
    count = found.fresh["cases"].item()
    uncertain = uncertain_of(over, None, ["gap_mm"])
    values = uncertain.values(Draw(uncertain, "random", 2 * 4 + 1).cases(0, count))
    points = pl.DataFrame(values).with_columns(gap_mm=found.best["gap_mm"])
    swept = iva.sweep(iva.Siva(mass=0.25), STRUCTURE, over=points, start=iva.Start(), duration=18.0)
    times = np.sort(swept.summary["settling_time_5"].fill_null(np.inf).to_numpy())
    assert found.fresh["value"].item() == times[math.ceil(0.9 * count) - 1]


def test_a_section_of_a_study_is_the_same_as_the_call(tmp_path: Path) -> None:
    path = tmp_path / "design.toml"
    path.write_text(
        """version = 1
[primary]
mass = 3.0
stiffness = 12_000.0
damping = 2.0
[absorber]
kind = "siva"
[force]
velocity = 0.2
[run]
duration = 18.0
[optimise]
minimise = "settling_time_5"
seed = 3
[optimise.choose]
gap_mm = { low = 2.0, high = 14.0, step = 0.5 }
absorber.mass = { sizes = [0.1, 0.2, 0.3] }
[optimise.off]
gap_mm = "5%"
[optimise.over]
restitution = { distribution = "normal", mean = 0.6, deviation = 0.05 }
displacement_mm = { low = 3.0, high = 5.0 }
[optimise.within]
stroke_mm = 20
""",
        encoding="utf-8",
    )
    spec, asked = of_study(path)
    assert spec["forces"] == [{"velocity": 0.2}]
    assert asked == {
        "minimise": "settling_time_5",
        "seed": 3,
        "choose": {
            "gap_mm": {"low": 2.0, "high": 14.0, "step": 0.5},
            "absorber.mass": {"sizes": [0.1, 0.2, 0.3]},
        },
        "off": {"gap_mm": "5%"},
        "over": {"restitution": Normal(0.6, 0.05), "displacement_mm": Uniform(3.0, 5.0)},
        "within": {"stroke_mm": 20},
    }
    same = scene(iva.Siva(), STRUCTURE, iva.Start(), iva.Impulse(velocity=0.2), {"duration": 18.0})
    given = {name: value for name, value in spec.items() if name != "forces"}
    assert given == {name: value for name, value in same.items() if name != "forces"}


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ({"minimize": "impacts"}, "minimize: no such key; did you mean `minimise`"),
        ({"over": 3}, "over = 3: give a table"),
        ({"over": {"restitution": {"distribution": "gauss"}}}, "give one of uniform, normal"),
        ({"over": {"restitution": {"distribution": "normal", "mean": 3}}}, "over.restitution: "),
        (3, "optimise = 3: give a section"),
    ],
)
def test_a_wrong_section_gets_one_sentence(section: Any, said: str) -> None:
    with pytest.raises((TypeError, ValueError), match=said):
        asked_of(section)


def test_the_command(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    from iva.optimisation.command import main

    study = tmp_path / "d.toml"
    text = (
        'version = 1\n[absorber]\nkind = "siva"\nmass_ratio = 0.1\n[start]\ndisplacement = 1.0\n'
        '[run]\nperiods = 20\n[optimise]\nmaximise = "damping_ratio_3"\nruns = 600\n'
        "[optimise.choose]\nrelative_clearance = { low = 0.2, high = 1.2 }\n"
        "[optimise.over]\nrestitution = { low = 0.5, high = 0.7 }\n"
    )
    study.write_text(text, encoding="utf-8")
    out = tmp_path / "out"
    assert main([str(study), "--out", str(out), "--quiet"]) == 0
    assert "Optimum by the 90 % quantile of" in capfd.readouterr().out
    assert (out / "design.png").exists()
    assert main([str(study), "--out", str(out), "--quiet"]) == 2
    assert "give --resume or --overwrite" in capfd.readouterr().err
    assert main([str(study), "--out", str(out), "--quiet", "--resume"]) == 0
    study.write_text(text.replace("maximise", "maximize"), encoding="utf-8")
    assert main([str(study)]) == 2
    assert "did you mean `maximise`" in capfd.readouterr().err
    study.write_text(text + "[sweep]\nmass_ratio = [0.1]\n", encoding="utf-8")
    assert main([str(study)]) == 2
    assert "[sweep] beside [optimise]" in capfd.readouterr().err
    study.write_text(text.partition("[optimise]")[0], encoding="utf-8")
    assert main([str(study)]) == 2
    assert "the section [optimise] is missing" in capfd.readouterr().err
    assert main([str(tmp_path / "none.toml")]) == 2
