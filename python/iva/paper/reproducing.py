"""Run the studies behind figures, and write what they give."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import polars as pl
from matplotlib import rc_context
from matplotlib.figure import Figure

from iva.faults import fault
from iva.paper import page
from iva.paper.assumptions import Assumptions
from iva.paper.figures import ITEMS, Item
from iva.paper.made import Made
from iva.paper.verdicts import Finding
from iva.parameters import shown
from iva.simulation import truth
from iva.spelling import hint, spell_checked

#: Told what is begun: how many are done, of how many, and the name of the next.
Told = Callable[[int, int, str], object]


@dataclass(frozen=True)
class Report:
    """What :func:`reproduce` found.

    Parameters
    ----------
    assumptions : Assumptions
        What was taken for the parameters that the paper does not give.
    items : mapping of str to Made
        The studies by name: ``fig3`` to ``fig22``, ``table1``; each has `parameters`, `tables`,
        `findings` and ``draw()``, which makes a matplotlib figure.
    drawn : tuple of str
        The names of those whose figures were asked for.
    """

    assumptions: Assumptions
    items: Mapping[str, Made]
    drawn: tuple[str, ...]

    @property
    def findings(self) -> list[Finding]:
        """The findings of all items, in their order, each once."""
        return page.distinct(self.items)

    @property
    def claims(self) -> pl.DataFrame:
        """Claims with ``claim``, ``figure``, ``paper``, ``model``, ``verdict`` and ``measures``."""
        found = self.findings
        return pl.DataFrame(
            {
                "claim": [finding.claim for finding in found],
                "figure": [finding.figure for finding in found],
                "paper": [finding.paper for finding in found],
                "model": [finding.model for finding in found],
                "verdict": [finding.verdict.value for finding in found],
                "measures": [finding.measures for finding in found],
            },
            schema=dict.fromkeys(
                ("claim", "figure", "paper", "model", "verdict", "measures"), pl.String
            ),
        )

    def __repr__(self) -> str:
        """Say what there is, and count the verdicts."""
        counts = ", ".join(f"{n} × {verdict}" for verdict, n in page.counted(self.findings))
        return (
            f"Report: {' '.join(self.items)}; {page.number_of(self.findings)}: {counts or 'none'}"
        )

    def _repr_html_(self) -> str:
        """Show the table of claims in a notebook."""
        return page.claims_table(self.findings)


@spell_checked
def reproduce(
    *what: str,
    out: str | os.PathLike[str] | None = None,
    assumptions: Assumptions | None = None,
    overwrite: bool = False,
    told: Told | None = None,
) -> Report:
    """Run the studies behind figures of the paper, and judge what it says.

    Parameters
    ----------
    *what : str
        ``fig3`` to ``fig22``, ``table1``, ``claims`` (all studies, nothing drawn) or ``all``, which
        is what is done without any.
    out : path, optional
        Folder to write to: for each study ``figNN.png``, ``figNN.svg`` and its tables as
        ``figNN-….parquet``; ``claims.parquet`` and ``report.html``, a page that needs no other
        file. Without it nothing is written.
    assumptions : Assumptions, optional
        What to take for the parameters that the paper does not give.
    overwrite : bool, default False
        Write into a folder that holds something.
    told : callable, optional
        Called with (done, total, name) before each study.

    Returns
    -------
    Report

    Raises
    ------
    TypeError
        If an argument is of the wrong type.
    ValueError
        If a name is unknown, or `out` holds something.
    iva.IvaError
        If a file cannot be written; those written before are kept.

    Examples
    --------
    >>> report = iva.paper.reproduce("fig18")
    >>> report.claims["claim"].to_list()
    ['C1']
    """
    if assumptions is None:
        assumptions = Assumptions()
    elif not isinstance(assumptions, Assumptions):
        raise TypeError(f"assumptions = {shown(assumptions)}: give an iva.paper.Assumptions")
    chosen, drawn = choice(what)
    folder = None if out is None else prepared(out, overwrite)
    items: dict[str, Made] = {}
    pictures: dict[str, bytes] = {}
    for number, item in enumerate(chosen):
        if told is not None:
            told(number, len(chosen), item.name)
        made = item.study(assumptions)
        items[item.name] = made
        if folder is not None:
            write_tables(folder, item.name, made)
            if item.name in drawn:
                pictures[item.name] = write_figure(folder, item.name, made.draw())
    report = Report(assumptions, items, drawn)
    if folder is not None:
        with writing(folder):
            report.claims.write_parquet(folder / "claims.parquet")
            text = page.written(report.assumptions, items, pictures)
            (folder / "report.html").write_text(text, encoding="utf-8")
    return report


def choice(what: Sequence[str]) -> tuple[list[Item], tuple[str, ...]]:
    """Return what is to be run, in the order of the paper, and the names of what is to be drawn.

    Raises
    ------
    TypeError, ValueError
        If something is no text, or unknown.
    """
    known = [item.name for item in ITEMS]
    for name in what:
        if not isinstance(name, str):
            raise TypeError(f"what = {shown(name)}: give names such as 'fig7'")
    given, what = what, [re.sub(r"^fig0+(?=\d)", "fig", name) for name in what]
    for name, as_given in zip(what, given, strict=True):
        if name not in (*known, "claims", "all"):
            words = ["table1", "claims", "all"]
            # Of figures only one that is written otherwise: fig30 is no slip for fig3.
            words += [figure for figure in known if figure == name.lower()]
            raise ValueError(
                f"what = {as_given!r}: give fig3 to fig22, table1, claims or all (Figs 1 and 2 are "
                f"drawings){hint(name, words)}"
            )
    everything = not what or "all" in what
    run = known if everything or "claims" in what else list(what)
    drawn = known if everything else [name for name in known if name in what]
    return [item for item in ITEMS if item.name in run], tuple(drawn)


def prepared(out: str | os.PathLike[str], overwrite: bool) -> Path:
    """Return a folder that can be written to.

    Raises
    ------
    TypeError, ValueError
        If it is no folder, or holds something that was not to be overwritten.
    iva.IvaError
        If it cannot be made or written to.
    """
    if not isinstance(out, (str, os.PathLike)):
        raise TypeError(f"out = {shown(out)}: give the path of a folder")
    if not str(out) or "\0" in str(out):
        raise ValueError(f"out = {shown(out)}: give the path of a folder")
    truth("overwrite", overwrite)
    # Absolute, for polars would read a ~ of its own.
    folder = Path(out).absolute()
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"out = {str(out)!r}: this is a file, give a folder")
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
        if not overwrite and any(folder.iterdir()):
            raise ValueError(
                f"out = {str(out)!r}: it holds something; choose another folder, or overwrite"
            )
        probe = folder / ".iva-probe"
        probe.touch()
        probe.unlink()
    return folder


class writing:  # noqa: N801 (reads as what it is: with writing(folder))
    """Turn faults of files into an error that names the folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __enter__(self) -> None:
        """Begin."""

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> None:
        """Say what could not be written, and why."""
        if isinstance(error, (OSError, pl.exceptions.PolarsError)):
            reason = getattr(error, "strerror", None) or str(error)
            raise fault(f"cannot write to {self.folder}: {reason}") from error


def write_tables(folder: Path, name: str, made: Made) -> None:
    """Write the tables of a study."""
    with writing(folder):
        for table, frame in made.tables.items():
            frame.write_parquet(folder / f"{page.stem(name)}-{table}.parquet")


def write_figure(folder: Path, name: str, figure: Figure) -> bytes:
    """Write a figure as PNG and SVG; return the PNG. Both are the same for the same figure."""
    with writing(folder), rc_context({"svg.hashsalt": name, "svg.fonttype": "none"}):
        figure.savefig(folder / f"{page.stem(name)}.svg", metadata={"Date": None})
        png = folder / f"{page.stem(name)}.png"
        figure.savefig(png, dpi=200, metadata={"Software": None})
        return png.read_bytes()
