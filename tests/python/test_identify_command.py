"""``iva identify``: what it reads, writes and refuses.

The record is studies/decay.csv; its truth is in public_1_acceleration.json of
tests/data/identification.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import polars as pl
import pytest

import iva
from iva.identification.known import of_sections
from iva.sampling import Normal

pytest.importorskip("dynesty")
from iva.identification.command import main

TESTS = Path(__file__).parents[1]
RECORD = TESTS.parent / "studies" / "decay.csv"
TRUTH = TESTS / "data" / "identification" / "public_1_acceleration.json"


def test_a_record_becomes_a_study_and_a_report(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    known = tmp_path / "known.toml"
    known.write_text(
        'version = 1\n[absorber]\nkind = "siva"\n[start]\ntime = 0.0\n[known]\n'
        'mass_ratio = { distribution = "normal", mean = 0.094, deviation = 0.002 }\n',
        encoding="utf-8",
    )
    asked = [str(RECORD), "--end", "2.5", "--study", str(known), "--out", str(out)]
    assert main(asked) == 0
    said = capfd.readouterr().out
    assert "release_s 0 (0 … 0), given" in said
    truth = json.loads(TRUTH.read_text())["truth"]
    found = pl.read_csv(out / "parameters.csv")
    values = dict(found.select("parameter", "value").iter_rows())
    for name in ("frequency_hz", "mass_ratio", "restitution", "gap_mm"):
        assert values[name] == pytest.approx(truth[name], rel=0.03)
    assert pl.read_csv(out / "impacts.csv").height > 10
    assert pl.read_parquet(out / "draws.parquet")["gap_mm"].median() == values["gap_mm"]
    report = (out / "report.html").read_text(encoding="utf-8")
    assert report.count("data:image/png;base64,") == 3
    assert "The model explains the record." in report
    study = (out / "model.toml").read_text(encoding="utf-8")
    assert f"mass_ratio = {values['mass_ratio']!r}" in study
    from iva import _iva

    assert _iva.main(["iva", "check", str(out / "model.toml")]) == 0
    assert main(asked) == 2
    assert "it exists; give --overwrite or another folder" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["none.csv"], 1, "none.csv"),
        ([str(RECORD), "--unit", "furlong"], 2, "furlong"),
        ([str(RECORD), "--column", "a7"], 2, "a7"),
        ([str(RECORD), "--kind", "svia"], 2, "did you mean `siva`"),
        ([str(RECORD), "--end", "0.05"], 2, "record: "),
        ([str(RECORD), "--study", "none.toml"], 1, "none.toml cannot be read"),
        (["--unheard-of"], 2, "error: "),
        (["--help"], 0, ""),
    ],
)
def test_bad_input_gets_one_sentence(
    arguments: list[str],
    code: int,
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == code
    assert said in capfd.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_structure_alone_becomes_a_study_without_an_absorber(tmp_path: Path) -> None:
    # x = 5 mm exp(−0.3 t) cos(30 t): the damping ratio is 0.3 / √(30² + 0.3²).
    time = [step / 200 for step in range(1200)]
    rows = [f"{t},{5 * math.exp(-0.3 * t) * math.cos(30 * t)}" for t in time]
    record, out = tmp_path / "bare.csv", tmp_path / "out"
    record.write_text("time_s,displacement_mm\n" + "\n".join(rows) + "\n", encoding="utf-8")
    assert main([str(record), "--kind", "none", "--out", str(out)]) == 0
    found = dict(pl.read_csv(out / "parameters.csv").select("parameter", "value").iter_rows())
    assert found["damping_ratio"] == pytest.approx(0.3 / math.hypot(30, 0.3), rel=1e-4)
    assert 'kind = "none"' in (out / "model.toml").read_text(encoding="utf-8")
    assert "Impacts" not in (out / "report.html").read_text(encoding="utf-8")
    from iva import _iva

    assert _iva.main(["iva", "check", str(out / "model.toml")]) == 0


def test_what_is_known_of_a_pendulum() -> None:
    known = of_sections(
        {
            "version": 1,
            "absorber": {"kind": "piva", "frequency_ratio": 0.4},
            "primary": {"frequency_hz": 2.0},
            "known": {"restitution": {"distribution": "normal", "mean": 0.6, "deviation": 0.1}},
        }
    )
    assert known.absorber == iva.Piva(frequency_ratio=0.4)
    assert known.primary == iva.Primary(frequency_hz=2.0)
    assert known.distributions == {"restitution": Normal(0.6, 0.1)}
    with pytest.raises(ValueError, match=r"^\[knwon\]: it is not read here; did you mean `known`"):
        of_sections({"knwon": {}})
    with pytest.raises(ValueError, match=r"^known.restitution = 0.6: give a distribution"):
        of_sections({"known": {"restitution": 0.6}})
    with pytest.raises(ValueError, match=r"absorber.kind = 'nes': give siva, piva or none"):
        of_sections({"absorber": {"kind": "nes"}})
