"""``iva optimise``: a design that holds, from the command line."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from iva._iva import IvaError, visible
from iva.commands import BAD_INPUT, DONE, FAULT, INTERRUPTED, Parser, failed
from iva.optimisation.optimising import RUNS, problem_of, solved
from iva.optimisation.optimum import Optimum
from iva.optimisation.studies import of_study
from iva.own_files import replacing

#: The table of designs that fresh cases cannot tell from the best is printed so far.
SHOWN = 10


def parser() -> Parser:
    """Return the parser."""
    made = Parser(
        prog="iva optimise",
        description="Choose the numbers of a design so that it does well although much is not "
        "known exactly: what the section [optimise] of a study file asks.",
        epilog="Example: iva optimise design.toml --out results/design. Ctrl-C gives the best so "
        "far; with --out, --resume goes on.",
    )
    made.add_argument("study", metavar="STUDY", help="study file with a section [optimise]")
    made.add_argument(
        "--out",
        metavar="DIR",
        help="folder for the tables (fresh, as_good, front, table) and a picture",
    )
    made.add_argument("--resume", action="store_true", help="go on with what --out holds")
    made.add_argument("--overwrite", action="store_true", help="replace what --out holds")
    made.add_argument(
        "--runs",
        metavar="N",
        type=int,
        help=f"runs that may be spent; by default those of the study, else {RUNS}",
    )
    made.add_argument("--threads", metavar="N", type=int, help="worker threads; one a core")
    made.add_argument("--quiet", action="store_true", help="show no progress")
    return made


def found(arguments: Sequence[str]) -> Optimum:
    """Do what was asked; return what was found."""
    asked = parser().parse_args(arguments)
    spec, section = of_study(Path(asked.study))
    runs = section.pop("runs", RUNS) if asked.runs is None else asked.runs
    section.pop("runs", None)
    unset = ("minimise", "maximise", "over", "off", "quantile", "worst_of", "cvar", "within")
    full = dict.fromkeys((*unset, "worst_over"), None) | {"mean": False, "seed": 0} | section
    if "choose" not in full:
        raise ValueError(f"{asked.study}: [optimise]: choose is missing")
    result = solved(
        problem_of([spec], full),
        runs,
        asked.out,
        asked.resume,
        asked.overwrite,
        asked.threads,
        not asked.quiet,
    )
    if asked.out is not None:
        drawn(result, Path(asked.out) / "design.png")
    return result


def drawn(result: Optimum, path: Path) -> None:
    """Draw what was found, where there is matplotlib."""
    if find_spec("matplotlib") is None:
        return
    from iva import plots
    from iva.plots.styles import figure_of

    with plots.style():
        axes = plots.design(result)
        with replacing(path) as picture:
            figure_of(axes).savefig(picture, dpi=150)


def text(result: Optimum) -> str:
    """Return what to print: the best, and the first of those that are as good or on the front."""
    import polars as pl

    lines = [repr(result)]
    several = result.front if result.front.height else result.as_good
    if several.height > 1:
        dropped = [name for name in ("absorber", "within", "missing") if name in several.columns]
        with pl.Config(tbl_rows=SHOWN, tbl_hide_dataframe_shape=True, tbl_width_chars=80):
            lines.append(str(several.drop(dropped).head(SHOWN)))
    return "\n".join(lines)


def main(arguments: Sequence[str]) -> int:
    """Run the command; return its exit code: 0 done, 1 fault, 2 bad input, 130 interrupted."""
    try:
        result = found(arguments)
    except SystemExit as end:  # --help
        return int(end.code or 0)
    except (ValueError, TypeError) as wrong:
        sentence = str(wrong).replace("out = ", "--out ", 1)
        for word in ("resume", "overwrite"):
            sentence = sentence.replace(f"{word}=True", f"--{word}")
        return failed(BAD_INPUT, sentence)
    except (OSError, ImportError, IvaError) as fault:
        return failed(FAULT, str(fault))
    except KeyboardInterrupt:
        return failed(INTERRUPTED, "interrupted before any design was judged")
    print(visible(text(result)))
    return DONE if result.is_complete else INTERRUPTED
