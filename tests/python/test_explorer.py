"""The explorer: its page, its command, and its simulator, which gives the numbers of the wheel.

The simulator is run by Node.js, where there is one; its numbers are compared with those of
``iva.simulate`` to the bit.
"""

from __future__ import annotations

import dataclasses
import json
import lzma
import math
import re
import shutil
import subprocess
import sys
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

import iva
from iva.explorer import Explorer
from iva.explorer.command import main
from iva.explorer.document import page
from iva.explorer.scenes import DEFAULT, explored, of_study
from iva.explorer.scenes import parts as arguments

HERE = Path(__file__).parents[1] / "explorer"
STUDIES = Path(__file__).parents[2] / "studies"
NODE = shutil.which("node")

SIVA = iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.4)
START = iva.Start(displacement=1.0)
STEEL = iva.Primary(mass=2.0, frequency_hz=3.0, damping_ratio=0.004)
TOWER = iva.Structure(
    frequencies_hz=[3.0, 11.0],
    damping_ratios=[0.01, 0.01],
    points={"the top": [0.1, 0.08], "half way": [0.06, -0.09]},
    absorber_at=["the top", "half way"],
    force_at="the top",
)

SCENES: dict[str, dict[str, Any]] = {
    "free mass": {"absorber": SIVA, "primary": iva.Primary(damping_ratio=0.005), "start": START},
    "chatter and sticks": {
        "absorber": iva.Siva(mass_ratio=0.3, restitution=0.3, clearance=0.05),
        "primary": iva.Primary(damping_ratio=0.02),
        "start": START,
    },
    "millimetres": {
        "absorber": iva.Siva(mass=0.2, restitution=0.7, gap_mm=8.0),
        "primary": STEEL,
        "start": iva.Start(displacement_mm=6.0),
    },
    "upright": {
        "absorber": iva.Siva(mass_ratio=0.1, restitution=0.6, gap_mm=6.0, inclination_deg=90),
        "primary": STEEL,
        "start": iva.Start(displacement_mm=40.0),
    },
    "pendulum": {
        "absorber": iva.Piva(
            mass_ratio=0.1, restitution=0.6, clearance=0.3, frequency_ratio=0.4, length=10.0
        ),
        "primary": iva.Primary(damping_ratio=0.01),
        "start": START,
    },
    "small angles": {
        "absorber": iva.Piva(
            mass_ratio=0.1, restitution=0.6, clearance=0.3, frequency_ratio=0.4, angles="small"
        ),
        "primary": iva.Primary(damping_ratio=0.01),
        "start": START,
    },
    "force": {
        "absorber": SIVA,
        "primary": iva.Primary(damping_ratio=0.02),
        "start": iva.Start(),
        "force": iva.Harmonic(amplitude=0.1, frequency=0.95),
    },
    "base motion": {
        "absorber": SIVA,
        "primary": iva.Primary(damping_ratio=0.02),
        "start": iva.Start(),
        "force": iva.Harmonic(base_acceleration=0.1, frequency=1.1),
    },
    "friction, a spring and a dashpot": {
        "absorber": dataclasses.replace(
            SIVA, friction=0.02, gravity=1, spring_ratio=0.5, gap_damping_ratio=0.001
        ),
        "primary": iva.Primary(damping_ratio=0.01),
        "start": START,
    },
    "one wall, by a table": {
        "absorber": iva.Siva(
            mass=0.2,
            gap_mm=8.0,
            walls="plus",
            spring_ratio=0.9,
            restitution_table=[[0.001, 0.9], [0.1, 0.6]],
        ),
        "primary": STEEL,
        "start": iva.Start(displacement_mm=6.0),
    },
    "a mass and a pendulum": {
        "absorber": [
            SIVA,
            iva.Piva(
                mass_ratio=0.05, restitution=0.6, clearance=0.3, frequency_ratio=0.4, length=10.0
            ),
        ],
        "primary": iva.Primary(damping_ratio=0.01),
        "start": iva.Start(displacement=1.0, gap_displacement=[0.1, 0.0]),
    },
    "units": {
        "absorber": dataclasses.replace(SIVA, units=3, clearance_spread=0.2),
        "primary": iva.Primary(damping_ratio=0.01),
        "start": START,
    },
    "modes": {
        "absorber": [
            iva.Siva(mass=8.0, restitution=0.6, gap_mm=20.0, friction=0.01),
            iva.Siva(mass=4.0, restitution=0.5, gap_mm=15.0),
        ],
        "primary": TOWER,
        "start": iva.Start(displacement_mm=15.0),
        "force": iva.Impulse(impulse=20.0, time=0.3),
    },
    "a stop": {
        "absorber": iva.Stop(clearance=0.5, restitution=0.7),
        "primary": iva.Primary(damping_ratio=0.01),
        "start": iva.Start(velocity=1.0),
    },
    "two harmonics and a record": {
        "absorber": SIVA,
        "primary": iva.Primary(damping_ratio=0.02),
        "start": iva.Start(),
        "force": [
            iva.Harmonic(amplitude=0.1, frequency=0.95),
            iva.Recorded([0.0, 1.0, 2.5], [0.0, 0.4, 0.0], kind="base_acceleration"),
            iva.Harmonic(amplitude=0.05, frequency=1.3, phase=0.5),
        ],
    },
    "alone": {"absorber": None, "primary": iva.Primary(damping_ratio=0.02), "start": START},
}

#: What is estimated by products of matrices, which other machines round otherwise.
ESTIMATES = ("time_error", "condition", "digits")


def asked(parts: dict[str, Any]) -> dict[str, Any]:
    """Return the scene of some parts as the simulator takes it."""
    run = iva.simulate(**parts, periods=12)
    return {"scene": explored(run._spec)}


def answered(tmp_path: Path, asked: list[dict[str, Any]]) -> dict[str, Any]:
    """Return what the simulator of the explorer answers."""
    if NODE is None:
        pytest.skip("no Node.js to run it")
    home = files("iva.explorer") / "web"
    # The suffix tells Node.js that the file is a module.
    for name, text in {
        "engine.mjs": home.joinpath("engine.js").read_text(encoding="utf-8"),
        "run.mjs": (HERE / "run.mjs").read_text(encoding="utf-8"),
    }.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    module = tmp_path / "simulator.wasm"
    module.write_bytes(lzma.decompress(home.joinpath("simulator.wasm.lzma").read_bytes()))
    command = [NODE, str(tmp_path / "run.mjs"), str(module)]
    done = subprocess.run(
        command, input=json.dumps(asked), capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    answers: dict[str, Any] = json.loads(done.stdout)
    return answers


def test_it_gives_the_numbers_of_the_wheel_to_the_bit(tmp_path: Path) -> None:
    answers = answered(tmp_path, [asked(parts) for parts in SCENES.values()])["answers"]
    compared = 0
    for (name, parts), answer in zip(SCENES.items(), answers, strict=True):
        assert not answer.get("error"), f"{name}: {answer['error']}"
        run = iva.simulate(**parts, periods=12, errors=True)
        tables = {"impacts": run.impacts, "episodes": run.episodes, "envelope": run.envelope}
        for table, frame in {**tables, "trajectory": run.trajectory(20)}.items():
            for column in frame.columns:
                if column in answer[table]:
                    ours = [None if v is None else float(v) for v in frame[column].to_list()]
                    seen = answer[table][column]
                    same = pytest.approx(ours, rel=1e-6) if column in ESTIMATES else ours
                    assert seen == same, f"{name}: {table}.{column}"
                    compared += len(ours)
        for column, value in run.summary.row(0, named=True).items():
            if value is not None and column != "point":
                seen = answer["summary"][column]
                same = pytest.approx(value, rel=1e-6) if column in ESTIMATES else value
                assert seen == same, f"{name}: {column} is {seen}, not {value}"
        # Energies: at the start, and across impacts.
        total = answer["energies"]["total"]
        assert total[0] == run.summary["energy_initial"].item()
        rows = {time: index for index, time in enumerate(answer["trajectory"]["time"])}
        for time, loss in zip(run.impacts["time"], run.impacts["energy_loss"], strict=True):
            after = rows[time]
            assert total[after - 1] - total[after] == pytest.approx(loss, abs=1e-13 * max(total))
    assert compared > 10_000


def test_the_points_of_a_structure_move_as_a_run_sees_them(tmp_path: Path) -> None:
    [answer] = answered(tmp_path, [asked(SCENES["modes"])])["answers"]
    assert [it["point"] for it in answer["places"]] == ["the top", "half way"]
    assert [it["walls"] for it in answer["places"]] == [[-0.01, 0.01], [-0.0075, 0.0075]]
    free = {name: SCENES["modes"][name] for name in ("absorber", "start")}
    [answer] = answered(tmp_path, [asked({**free, "primary": TOWER})])["answers"]
    times = answer["samples"]["time"]
    for point in ("the top", "half way"):
        # A start is what the point does that is seen; this one is the same motion.
        size = 1.0 if point == "the top" else 0.6
        start = iva.Start(displacement_mm=15.0 * size)
        seen = dataclasses.replace(TOWER, seen_at=point)
        path = iva.simulate(free["absorber"], seen, start=start, periods=12).trajectory(20)
        moved = dict(zip(path["time"], path["displacement"], strict=True))
        ours = [moved[time] for time in times]
        assert ours == pytest.approx(answer["points"][point], abs=1e-9)
    assert len(times) > 200


def test_every_measure_of_a_list_is_on_the_map(tmp_path: Path) -> None:
    scene = asked(SCENES["a mass and a pendulum"])
    axes = ["absorber.1.clearance", [0.2, 0.3], "absorber.0.mass_ratio", [0.1]]
    run = iva.simulate(**SCENES["a mass and a pendulum"], periods=12)
    row = {k: v for k, v in run.summary.row(0, named=True).items() if isinstance(v, float)}
    wanted = [{**scene, "map": [*axes, measure]} for measure in row]
    answers = answered(tmp_path, wanted)["answers"]
    assert [it["map"][1] for it in answers] == list(row.values())


def test_a_map_is_a_sweep(tmp_path: Path) -> None:
    gaps, ratios = [0.2, 0.4, 0.6], [0.05, 0.1]
    scene = asked(SCENES["free mass"])
    axes = ["absorber.clearance", gaps, "absorber.mass_ratio", ratios, "settling_time_5"]
    [answer] = answered(tmp_path, [{**scene, "map": axes}])["answers"]
    swept = iva.sweep(
        SIVA,
        iva.Primary(damping_ratio=0.005),
        start=START,
        over={"mass_ratio": ratios, "clearance": gaps},
        periods=12,
        measures=["settling_time_5"],
    )
    ours = swept.summary["settling_time_5"].to_list()
    assert answer["map"] == ours
    assert len(ours) == 6


def test_a_value_that_cannot_be_is_told_as_by_the_wheel(tmp_path: Path) -> None:
    scene = json.loads(json.dumps(DEFAULT))
    scene["values"]["absorber.restitution"] = 1.5
    [answer] = answered(tmp_path, [{"scene": scene}])["answers"]
    with pytest.raises(ValueError, match=r"absorber\.restitution") as told:
        iva.Siva(mass_ratio=0.1, restitution=1.5, clearance=0.4)
    assert answer["error"]["sentence"] == str(told.value)


def test_the_page_is_one_file_without_a_network() -> None:
    html = iva.explore().html
    # Nine tenths are the simulator, with all kinds of scene.
    assert len(html) < 600_000
    assert not re.search(r"""(src|href)=["'](?!data:)|@import|url\((?!["']?data:)""", html)
    assert "%SCENE%" not in html
    assert json.dumps(DEFAULT["values"]["absorber.clearance"]) in html


def test_a_scene_cannot_end_its_element() -> None:
    scene = json.loads(json.dumps(DEFAULT))
    scene["choices"]["angles"] = "</script>"
    assert page(scene).count("</script>") == page(DEFAULT).count("</script>")


def test_explore_takes_runs_and_parts(tmp_path: Path) -> None:
    run = iva.simulate(SIVA, iva.Primary(), start=START, periods=5)
    of_run, of_parts = iva.explore(run), iva.explore(SIVA, iva.Primary(), start=START, periods=5)
    assert of_run.html == of_parts.html
    of_run.write(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == of_run.html
    with pytest.raises(TypeError, match=r"give iva\.explore the run alone"):
        iva.explore(run, iva.Primary())
    assert isinstance(iva.explore(), Explorer)


def test_a_list_of_one_absorber_is_that_absorber() -> None:
    of_list = iva.explore([SIVA], iva.Primary(), start=START, periods=5)
    assert of_list.html == iva.explore(SIVA, iva.Primary(), start=START, periods=5).html


def test_what_the_page_does_not_show_is_refused() -> None:
    run = iva.simulate(SIVA, iva.Primary(), start=START, periods=5, tolerance=1e-9)
    told = "run.tolerance = 1e-09: the explorer shows the exact motion; leave it out"
    with pytest.raises(ValueError, match=re.escape(told)):
        iva.explore(run)


def test_what_says_none_is_not_refused(tmp_path: Path) -> None:
    siva = dataclasses.replace(SIVA, units=1, friction=0, gravity=1, gap_damping_ratio=0)
    run = iva.simulate(siva, iva.Primary(), start=START, periods=5, tolerance=0)
    assert iva.simulate(**iva.explore(run).scene) == run
    [answer] = answered(tmp_path, [{"scene": explored(run._spec)}])["answers"]
    assert answer["summary"]["impacts"] == run.summary["impacts"].item()


@pytest.mark.parametrize("study", sorted(STUDIES.glob("*.toml")), ids=lambda path: path.stem)
def test_the_scene_of_a_study_runs(study: Path) -> None:
    run = iva.simulate(**arguments(of_study(study)), measures=["impacts"])
    assert run.summary["outcome"].item() == "finished"


def test_what_the_sliders_say_runs() -> None:
    for name, parts in SCENES.items():
        run = iva.simulate(**parts, periods=5)
        explorer = iva.explore(run)
        assert iva.simulate(**explorer.scene) == run, name


def test_a_notebook_shows_a_widget_or_a_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    explorer = iva.explore()
    widget = explorer.widget
    bundle = explorer._repr_mimebundle_()[0]
    assert "application/vnd.jupyter.widget-view+json" in bundle
    assert widget.scene == DEFAULT
    slid = json.loads(json.dumps(DEFAULT))
    slid["values"]["absorber.clearance"] = 0.9
    widget.scene = slid
    assert explorer.scene["absorber"] == iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.9)
    assert "0.9" in explorer.html

    monkeypatch.setitem(sys.modules, "iva.explorer.notebook", None)
    without = iva.explore()
    assert "<iframe srcdoc=" in without._repr_mimebundle_()["text/html"]
    with pytest.raises(ImportError, match=r"pip install 'iva-dynamics\[explore\]'"):
        _ = without.widget


def test_the_command_writes_a_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study, out = tmp_path / "study.toml", tmp_path / "page.html"
    study.write_text(
        "version = 1\n[primary]\ndamping_ratio = 0.01\n[absorber]\nkind = 'siva'\n"
        "mass_ratio = 0.2\nrestitution = 0.5\nclearance = 0.3\n[start]\ndisplacement = 1.0\n"
        "[run]\nperiods = 9\ntables = ['summary']\n[sweep]\nrestitution = [0.5, 0.7]\n"
    )
    assert main([str(study), "--out", str(out)]) == 0
    assert "open it in a browser" in capsys.readouterr().out
    assert of_study(study)["values"]["run.periods"] == 9
    assert of_study(study, 1)["values"]["absorber.restitution"] == 0.7
    assert main([str(study), "--point", "2", "--out", str(out), "--overwrite"]) == 2
    assert "--point 2: give a number from 0 to 1" in capsys.readouterr().err
    assert '"absorber.mass_ratio": 0.2' in out.read_text(encoding="utf-8")
    assert main([str(study), "--out", str(out)]) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert main([str(tmp_path / "none.toml"), "--out", str(out), "--overwrite"]) == 2
    assert main(["--colour"]) == 2
    assert math.isfinite(out.stat().st_size)
