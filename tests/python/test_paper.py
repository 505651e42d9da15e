"""The paper, reproduced: numbers, verdicts, the report, and what is refused.

Numbers without another source are those of another simulator of this model, event-driven like this
one but with an ODE solver, its impact times within 3e-9 of a tight solution; rounded as noted.
"""

from __future__ import annotations

import os
import pickle
import re
import signal
import subprocess
import sys
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from PIL import Image

import iva
from iva.paper import Assumptions, Finding, Report, Verdict, View, reproduce, scenes
from iva.paper.command import main
from iva.paper.figures import ITEMS
from iva.paper.measures import FIRST, THREE, TO_10, decrement
from patience import PATIENCE, started, until

DOCS = Path(__file__).parents[2] / "docs"
BASE = Assumptions()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder that ``iva reproduce all`` writes."""
    out = tmp_path_factory.mktemp("paper") / "made"
    assert main(["all", "--out", str(out), "--quiet"]) == 0
    return out


@pytest.fixture(scope="module")
def claims(folder: Path) -> dict[str, dict[str, str]]:
    """Return the rows of the table of claims by their names."""
    rows = pl.read_parquet(folder / "claims.parquet").rows(named=True)
    return {row["claim"]: row for row in rows}


def finding(*holds: bool | None) -> Finding:
    views = [View(f"view {number}", each, "1") for number, each in enumerate(holds)]
    return Finding("X1", "Fig. 0", "says", views, "model")


@pytest.mark.parametrize(
    ("holds", "verdict", "measures"),
    [
        ((True, True), Verdict.HOLDS, ""),
        ((True, None), Verdict.HOLDS, ""),
        ((False, True, None), Verdict.UNDER_A_MEASURE, "view 1"),
        ((False, None), Verdict.DOES_NOT_HOLD, ""),
        ((None, None), Verdict.UNDECIDED, ""),
        ((), Verdict.UNDECIDED, ""),
    ],
)
def test_the_rule(holds: tuple[bool | None, ...], verdict: Verdict, measures: str) -> None:
    found = finding(*holds)
    assert (found.verdict, found.measures) == (verdict, measures)


# ζ of the structure; settling times to 5 % at γ = 0.1, 0.6, 0.8 (μ = 0.15, e = 0.5).
SETTLING = {0.0: (178, 38, 53), 0.005: (130, 103, 55), 0.01: (103, 36, 44), 0.02: (79, 32, 49)}


@pytest.mark.parametrize(("zeta", "times"), SETTLING.items())
def test_settling_of_the_free_mass(zeta: float, times: tuple[int, ...]) -> None:
    table = scenes.decays(
        scenes.siva(BASE, mass_ratio=0.15),
        iva.Primary(damping_ratio=zeta),
        {"relative_clearance": [0.1, 0.6, 0.8]},
        periods=120.0,
    )
    assert table.summary["settling_time_5"].round().to_list() == list(times)


# γ, μ; damping ratio over 3 cycles (e = 0.5). That simulator takes its peaks cycle by cycle and
# means over neighbours, not between zero crossings: some per cent.
FREE_MASS = [(0.5, 0.05, 0.021), (0.5, 0.1, 0.031), (1.0, 0.05, 0.032)]


@pytest.mark.parametrize(("gamma", "mu", "three"), FREE_MASS)
def test_damping_of_the_free_mass(gamma: float, mu: float, three: float) -> None:
    absorber = iva.Siva(mass_ratio=mu, relative_clearance=gamma, restitution=0.5)
    summary = scenes.decay(absorber, scenes.primary(BASE)).summary
    assert THREE.of(summary)[0] == pytest.approx(three, rel=0.05)


# e; damping ratios of the pendulum at γ = 1.4, r = 0.4, μ = 0.1: first cycle, 3 cycles.
PENDULUM = {0.8: (0.044, 0.030), 0.5: (0.083, 0.088), 0.3: (0.076, 0.143)}


@pytest.mark.parametrize(("e", "expected"), PENDULUM.items())
def test_damping_of_the_pendulum(e: float, expected: tuple[float, ...]) -> None:
    summary = scenes.decay(scenes.piva(BASE, restitution=e), scenes.primary(BASE)).summary
    for measure, value in zip((FIRST, THREE), expected, strict=True):
        assert measure.of(summary)[0] == pytest.approx(value, rel=0.03), measure.label


def test_pendulum_at_two_lengths() -> None:
    long, short = (
        scenes.decay(scenes.piva(BASE, frequency_ratio=r), scenes.primary(BASE)).summary
        for r in (0.4, 0.8)
    )
    assert long["settling_time_10"].item() == pytest.approx(21.8, abs=0.06)
    assert short["settling_time_10"].item() is None
    assert THREE.of(short)[0] == pytest.approx(0.042, abs=6e-4)


def test_pendulum_with_the_gap_kept() -> None:
    expected = {1.0: 0.083, 1.4: 0.050, 2.0: 0.032}  # start displacement: first cycle
    for start, value in expected.items():
        absorber = scenes.piva(BASE, gravity=10.0 / start, relative_clearance=1.4 / start)
        summary = scenes.decay(absorber, scenes.primary(BASE)).summary
        assert FIRST.of(summary)[0] == pytest.approx(value, rel=0.03)


def test_decrement_over_any_cycles(table: iva.Table) -> None:
    assert np.allclose(decrement(table, 3), THREE.of(table.summary), rtol=1e-14, atol=0.0)
    assert np.isfinite(decrement(table, 3)).all()
    assert np.isnan(decrement(table, 40)).all()


def test_settling_as_a_damping_ratio() -> None:
    # Without absorber |x| falls like exp(−ζτ), up to half a period of its crossings.
    summary = scenes.bare(BASE, 0.02, 60.0).summary
    time = summary["settling_time_10"].item()
    assert TO_10.of(summary)[0] == pytest.approx(0.02, abs=0.02 * np.pi / time)


# What the claims were found to be. Another reader with another simulator found the same where words
# allow to compare ("partly" and "direction only" are not among the four); where not, it is said.
VERDICTS = {
    "S1": Verdict.UNDER_A_MEASURE,
    "S2": Verdict.HOLDS,
    "S3": Verdict.UNDER_A_MEASURE,  # there until 5 % alone, where it holds
    "S4": Verdict.UNDER_A_MEASURE,
    "S5": Verdict.UNDER_A_MEASURE,
    "S6": Verdict.HOLDS,
    "S7": Verdict.UNDER_A_MEASURE,
    "S8": Verdict.UNDER_A_MEASURE,
    "S9": Verdict.HOLDS,
    "S10": Verdict.HOLDS,
    "S11": Verdict.UNDER_A_MEASURE,
    "P1": Verdict.HOLDS,
    "P2": Verdict.UNDER_A_MEASURE,
    "P3": Verdict.HOLDS,
    "P4": Verdict.UNDER_A_MEASURE,
    "P5": Verdict.UNDER_A_MEASURE,
    "P6": Verdict.UNDER_A_MEASURE,  # there by decrements alone, where it does not
    "P7": Verdict.DOES_NOT_HOLD,  # half of it, "first half yes, second not"
    "P8": Verdict.DOES_NOT_HOLD,
    "C1": Verdict.UNDER_A_MEASURE,
    "E1": Verdict.UNDER_A_MEASURE,
    "E2": Verdict.UNDER_A_MEASURE,
    "E3": Verdict.DOES_NOT_HOLD,
    "E4": Verdict.UNDER_A_MEASURE,
    "E5": Verdict.UNDER_A_MEASURE,
    "E6": Verdict.DOES_NOT_HOLD,
    "E7": Verdict.UNDER_A_MEASURE,  # there with e = 0.5 alone, where it holds
    "E8": Verdict.UNDER_A_MEASURE,
    "T1": Verdict.UNDER_A_MEASURE,
}


@pytest.mark.parametrize(("claim", "verdict"), VERDICTS.items())
def test_verdicts(claims: dict[str, dict[str, str]], claim: str, verdict: Verdict) -> None:
    assert claims[claim]["verdict"] == verdict.value


def test_every_claim_is_judged_once(folder: Path) -> None:
    found = pl.read_parquet(folder / "claims.parquet")["claim"].to_list()
    assert sorted(found) == sorted(VERDICTS)


def test_optima_of_the_free_mass_need_a_long_memory(claims: dict[str, dict[str, str]]) -> None:
    measures = claims["S4"]["measures"]
    for label in ("decrement, 8 cycles, μ = 0.1", "decrement, 10 cycles, μ = 0.1"):
        assert label in measures
    assert "decrement, 1 cycle," not in measures


def test_the_law_as_printed_changes_the_best_clearance(claims: dict[str, dict[str, str]]) -> None:
    assert "decrement, 3 cycles" in claims["P4"]["measures"]
    printed = reproduce("fig15", assumptions=Assumptions(impact_law="printed"))
    assert "decrement, 3 cycles" not in printed.claims["measures"].item()


def test_table_1_is_no_damping_ratio(folder: Path) -> None:
    fits = pl.read_parquet(folder / "table1-fits.parquet")
    best = (
        fits.filter(pl.col("impact_law") == "consistent")
        .group_by("reading")
        .agg(pl.col("rms").min())
    )
    by_reading = dict(best.iter_rows())
    # Another fit of this model, by decrement: 0.017 to 0.020 from the two columns.
    assert by_reading["logarithmic decrement"] < 0.0215
    # No better than a constant: the eight numbers spread by 0.049.
    assert by_reading["damping ratio"] > 0.049
    assert fits.group_by("measure", "reading", "impact_law").len()["len"].unique().to_list() == [8]
    residual = fits["model"] - fits["experiment"]
    assert np.allclose(residual.to_numpy(), fits["residual"].to_numpy(), equal_nan=True)


class Page(HTMLParser):
    """What a page refers to, and whether its elements close."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.sources: list[str] = []
        self.open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note sources, and elements that must close."""
        self.sources += [value or "" for name, value in attrs if name in ("src", "href")]
        if tag not in ("meta", "img", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        """Close an element."""
        assert self.open.pop() == tag


def test_the_report_needs_no_other_file(folder: Path) -> None:
    text = (folder / "report.html").read_text(encoding="utf-8")
    page = Page(text)
    assert page.open == []
    pictures = [source for source in page.sources if source.startswith("data:image/png;base64,")]
    links = [source for source in page.sources if source.startswith("#")]
    # S2, S9, P2 and P3 are said of two figures each.
    assert (len(pictures), len(links)) == (len(ITEMS), len(VERDICTS) + 4)
    assert len(page.sources) == len(pictures) + len(links)
    assert "http" not in re.sub(r"src='data:[^']*'", "", text)
    for link in links:
        assert text.count(f"id='{link[1:]}'") == 1


def test_every_item_has_its_files(folder: Path) -> None:
    for item in ITEMS:
        stem = f"fig{int(item.name[3:]):02}" if item.name != "table1" else "table1"
        with Image.open(folder / f"{stem}.png") as image:
            assert min(image.size) > 300
        assert (folder / f"{stem}.svg").read_text(encoding="utf-8").startswith("<?xml")
        tables = list(folder.glob(f"{stem}-*.parquet"))
        assert tables
        assert all(pl.read_parquet(path).height > 0 for path in tables)


def test_the_same_again_is_the_same(folder: Path, tmp_path: Path) -> None:
    reproduce("fig5", "fig18", out=tmp_path / "again")
    for name in ("fig05.png", "fig18.svg", "fig18-decays.parquet"):
        assert (tmp_path / "again" / name).read_bytes() == (folder / name).read_bytes()


def test_report_of_one_figure() -> None:
    report = reproduce("fig18")
    assert isinstance(report, Report)
    assert list(report.items) == ["fig18"]
    assert report.claims.height == 1
    assert repr(report) == "Report: fig18; 1 claim: 1 × holds under a stated measure"
    assert "C1" in report._repr_html_()
    figure = report.items["fig18"].draw()
    assert [axes.get_title(loc="left") for axes in figure.axes] == [
        "SIVA, γ = 0.4",
        "PIVA, γ = 1.4",
    ]


def test_claims_draw_nothing_and_are_those_of_the_page(tmp_path: Path) -> None:
    out = tmp_path / "claims"
    report = reproduce("claims", out=out)
    assert report.claims.height == len(VERDICTS)
    page = (DOCS / "paper.md").read_text(encoding="utf-8")
    verdicts = [finding.verdict for finding in report.findings]
    holds, partly, does_not = (
        verdicts.count(verdict)
        for verdict in (Verdict.HOLDS, Verdict.UNDER_A_MEASURE, Verdict.DOES_NOT_HOLD)
    )
    assert (
        f"Of {len(verdicts)} claims {holds} hold, {partly} hold under a stated measure, "
        f"{does_not} do not hold."
    ) in page
    for found in report.findings:
        row = (found.claim, found.paper, found.figure, found.verdict.value, found.share)
        assert f"| {' | '.join(row)} |" in page
    assert not list(out.glob("*.png"))
    assert (out / "report.html").is_file()


def test_progress_is_told() -> None:
    said: list[tuple[int, int, str]] = []
    reproduce("fig13", "fig4", told=lambda *now: said.append(now))
    assert said == [(0, 2, "fig4"), (1, 2, "fig13")]


# At the ends of what is allowed: gaps that are never closed, structures that never settle. Table 1
# and Figs 19 to 21 take nearly all the time: each of both is in one of them.
EXTREMES: list[tuple[dict[str, Any], tuple[str, ...]]] = [
    ({"damping_ratio": 0.0, "restitution": 1.0}, ("fig19", "fig20", "fig21")),
    ({"gravity": 0.1, "relative_clearance": 5.0}, ("table1",)),
    ({"impact_law": "printed", "damping_ratio": 0.02}, ("fig19", "fig20", "fig21", "table1")),
]


@pytest.mark.parametrize(("changed", "without"), EXTREMES, ids=str)
def test_where_there_is_no_number_nothing_is_said(
    changed: dict[str, Any], without: tuple[str, ...]
) -> None:
    report = reproduce(
        *(item.name for item in ITEMS if item.name not in without),
        assumptions=Assumptions(**changed),
    )
    for finding in report.findings:
        said = " ".join([finding.model, *(f"{view.name} {view.value}" for view in finding.views)])
        assert not re.search(r"\b(nan|inf|None)\b", said), said
    by_claim = {finding.claim: finding for finding in report.findings}
    if changed.get("relative_clearance") == 5.0:  # no impact at all
        assert by_claim["P2"].verdict is Verdict.UNDECIDED
        assert by_claim["P3"].verdict is Verdict.UNDECIDED


def test_the_law_is_told() -> None:
    report = reproduce("fig12", assumptions=Assumptions(impact_law="printed"))
    assert "law of impact as printed" in report.items["fig12"].parameters
    assert "With the consistent law: holds (6 of 6 views)" in report.findings[0].model


def test_reports_can_be_pickled() -> None:
    report = reproduce("fig3", "fig18")
    again = pickle.loads(pickle.dumps(report))
    assert again.claims.equals(report.claims)


@pytest.mark.parametrize(
    ("name", "value", "error", "allowed"),
    [
        ("damping_ratio", -0.1, ValueError, "from 0 to 0.2"),
        ("restitution", float("nan"), ValueError, "from 0 to 1"),
        ("gravity", "much", TypeError, "a number"),
        ("mass_ratio", True, TypeError, "a number"),
        ("impact_law", "other", ValueError, "'consistent' or 'printed'"),
    ],
)
def test_bad_assumptions(name: str, value: object, error: type[Exception], allowed: str) -> None:
    with pytest.raises(error, match=re.escape(allowed)) as caught:
        Assumptions(**{name: value})  # type: ignore[arg-type]
    assert str(caught.value).startswith(f"{name} = ")


def said(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    """Return exit code and what is said on stderr, one sentence."""
    code = main(arguments)
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    return code, captured.err


def test_unknown_names(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    out = str(tmp_path / "new")
    code, text = said(capsys, "fig99", "--out", out)
    assert code == 2
    assert text.startswith("error: WHAT = 'fig99': give fig3 to fig22, table1, claims or all")
    assert "drawings" in said(capsys, "fig1", "--out", out)[1]
    assert "drawings" in said(capsys, "fig007x", "--out", out)[1]
    assert "did you mean `fig7`?" in said(capsys, "FIG7", "--out", out)[1]
    assert "did you mean `table1`?" in said(capsys, "table", "--out", out)[1]
    assert said(capsys, "fig3", "--damping-ratio", "lots")[0] == 2
    assert "--damping-ratio = 3.0" in said(capsys, "fig3", "--damping-ratio", "3")[1]
    assert not Path(out).exists()


def test_a_folder_that_holds_something(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine", encoding="utf-8")
    code, text = said(capsys, "fig5", "--out", str(tmp_path))
    assert code == 2
    assert "--overwrite" in text
    assert main(["fig5", "--out", str(tmp_path), "--overwrite", "--quiet"]) == 0
    assert (tmp_path / "mine.txt").read_text(encoding="utf-8") == "mine"


def test_a_folder_that_cannot_be_written(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    assert "this is a file" in said(capsys, "fig5", "--out", str(tmp_path / "file"))[1]
    code, text = said(capsys, "fig5", "--out", str(tmp_path / "file" / "below"))
    assert code == 1
    assert text.startswith(f"error: cannot write to {tmp_path / 'file' / 'below'}: ")


WITHOUT_MATPLOTLIB = """
import importlib.machinery, sys
find = importlib.machinery.PathFinder.find_spec
def hidden(name, *rest):
    return None if name.split(".")[0] == "matplotlib" else find(name, *rest)
importlib.machinery.PathFinder.find_spec = staticmethod(hidden)
from iva.__main__ import main
sys.argv = ["iva", "reproduce", "fig3"]
sys.exit(main())
"""


def test_without_matplotlib(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_MATPLOTLIB],
        capture_output=True,
        text=True,
        encoding="utf-8",
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(Path(iva.__file__).parents[1])},
        timeout=PATIENCE,
    )
    assert done.returncode == 1
    expected = "error: iva.paper needs matplotlib: pip install 'iva-dynamics[paper]'\n"
    assert done.stderr == expected


def command(*arguments: str, **more: Any) -> subprocess.CompletedProcess[str]:
    paths = {"PYTHONPATH": str(Path(iva.__file__).parents[1])}
    return subprocess.run(
        [sys.executable, "-m", "iva", "reproduce", *arguments],
        text=True,
        timeout=PATIENCE,
        env=os.environ | paths | more.pop("env", {}),
        **({"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | more),
    )


def test_terminals_without_symbols(tmp_path: Path) -> None:
    plain = {"PYTHONIOENCODING": "ascii"}
    done = command("fig18", "--out", str(tmp_path / "out"), env=plain)
    assert (done.returncode, done.stderr) == (0, "")
    assert "C1" in done.stdout
    assert command("--help", env=plain).returncode == 0


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux has a full device")
def test_output_that_cannot_be_printed(tmp_path: Path) -> None:
    with Path("/dev/full").open("w") as full:
        done = command("fig18", "--out", str(tmp_path / "out"), stdout=full)
    assert done.returncode == 1
    assert done.stderr == "error: cannot print: No space left on device\n"
    assert (tmp_path / "out" / "report.html").is_file()


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX limits")
def test_a_disk_that_is_full(tmp_path: Path) -> None:
    import resource

    def limit() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))

    done = command("fig5", "--out", str(tmp_path / "out"), preexec_fn=limit)
    assert done.returncode == 1
    assert done.stderr.startswith(f"error: cannot write to {tmp_path / 'out'}: ")
    assert "Traceback" not in done.stderr


def importing(job: subprocess.Popen[str], _out: Path) -> bool:
    """Tell whether a process is at its imports: it has those of matplotlib, which come late."""
    return "ft2font" in Path(f"/proc/{job.pid}/maps").read_text(encoding="utf-8")


def writing(_job: subprocess.Popen[str], out: Path) -> bool:
    """Tell whether a process has written something."""
    return out.is_dir() and any(out.glob("*.png"))


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
@pytest.mark.parametrize("moment", [importing, writing])
def test_ctrl_c(tmp_path: Path, moment: Callable[[subprocess.Popen[str], Path], bool]) -> None:
    paths = {"PYTHONPATH": str(Path(iva.__file__).parents[1])}
    out = tmp_path / "out"
    with started(
        [sys.executable, "-m", "iva", "reproduce", "--out", str(out)],
        stderr=subprocess.PIPE,
        env=os.environ | paths,
    ) as job:
        until(lambda: moment(job, out), job)
        job.send_signal(signal.SIGINT)
        text = job.communicate()[1]
    assert job.returncode == 130
    assert text.startswith("error: interrupted; ")
    assert "Traceback" not in text
