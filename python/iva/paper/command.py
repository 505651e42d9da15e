"""``iva reproduce``: the paper from the command line."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import fields
from io import TextIOWrapper
from time import perf_counter

from iva import commands
from iva._iva import IvaError, visible
from iva.commands import BAD_INPUT, DONE, FAULT, INTERRUPTED, Parser
from iva.paper.assumptions import MEANINGS, Assumptions
from iva.paper.page import SIGNS, counted, number_of
from iva.paper.reproducing import Report, reproduce


def parser() -> Parser:
    """Return the parser."""
    made = Parser(
        prog="iva reproduce",
        description="Run the studies behind the figures and Table 1 of the paper, draw them, and "
        "say which of its claims hold.",
        epilog="Example: iva reproduce fig7 fig15 --damping-ratio 0.02 --out results/my-paper",
    )
    made.add_argument(
        "what",
        nargs="*",
        metavar="WHAT",
        help="fig3 … fig22, table1, claims (all verdicts, nothing drawn) or all; all by default",
    )
    made.add_argument(
        "--out",
        default="results/paper",
        metavar="DIR",
        help="folder for report.html, figures (PNG, SVG) and data (Parquet); results/paper by "
        "default",
    )
    made.add_argument(
        "--overwrite", action="store_true", help="write into a folder that holds something"
    )
    made.add_argument("--quiet", action="store_true", help="say nothing but errors")
    assumed = made.add_argument_group("what the paper does not give (M = ωn = x₀ = 1)")
    for field in fields(Assumptions):
        number = isinstance(field.default, float)
        assumed.add_argument(
            "--" + field.name.replace("_", "-"),
            type=float if number else str,
            choices=None if number else ("consistent", "printed"),
            default=field.default,
            metavar="NUMBER" if number else "LAW",
            help=f"{MEANINGS[field.name]}; {field.default} by default",
        )
    return made


def main(arguments: Sequence[str]) -> int:
    """Run the command; return its exit code: 0 done, 1 fault, 2 bad input, 130 interrupted."""
    begun = perf_counter()
    # Symbols that a terminal cannot show become question marks.
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
    try:
        given = parser().parse_args(arguments)
        named = {field.name: getattr(given, field.name) for field in fields(Assumptions)}
        report = reproduce(
            *given.what,
            out=given.out,
            assumptions=Assumptions(**named),
            overwrite=given.overwrite,
            told=None if given.quiet else tell,
        )
    except SystemExit as end:  # --help
        return int(end.code or 0)
    except (TypeError, ValueError) as error:
        return failed(BAD_INPUT, as_options(str(error)))
    except IvaError as error:
        return failed(FAULT, str(error))
    except KeyboardInterrupt:
        return failed(INTERRUPTED, "interrupted; what was written is kept")
    if not given.quiet:
        clear()
        try:
            print(visible(summary(report, given.out, perf_counter() - begun)))
            sys.stdout.flush()
        except BrokenPipeError:
            return DONE
        except OSError as error:
            return failed(FAULT, f"cannot print: {error.strerror or error}")
    return DONE


def as_options(text: str) -> str:
    """Return a sentence on an argument in the words of the command line."""
    text = text.removeprefix("argument ").replace("or overwrite", "or give --overwrite")
    for name in ("what", "out", *MEANINGS):
        if text.startswith(f"{name} = "):
            option = "WHAT" if name == "what" else "--" + name.replace("_", "-")
            return text.replace(name, option, 1)
    return text


def tell(done: int, total: int, name: str) -> None:
    """Show on a terminal what is being run."""
    if sys.stderr.isatty():
        print(f"\r{name:<8}{done + 1} of {total}", end="", file=sys.stderr, flush=True)


def clear() -> None:
    """Clear the line of the terminal."""
    if sys.stderr.isatty():
        print("\r" + 40 * " " + "\r", end="", file=sys.stderr, flush=True)


def failed(code: int, text: str) -> int:
    """Say what is wrong; return the code."""
    clear()
    return commands.failed(code, text)


def summary(report: Report, out: str, seconds: float) -> str:
    """Return the verdicts, a line each, and where to read on."""
    lines = [
        f"  {SIGNS[finding.verdict][0]} "
        f"{finding.claim:<4}{finding.verdict.value:<29}{finding.figure}"
        for finding in report.findings
    ]
    counts = ", ".join(f"{number} × {verdict}" for verdict, number in counted(report.findings))
    studies = "1 study" if len(report.items) == 1 else f"{len(report.items)} studies"
    ends = [f"{number_of(report.findings)}: {counts}"] if report.findings else []
    return "\n".join(
        [
            *lines,
            *ends,
            f"{studies}, {len(report.drawn)} drawn, in {seconds:.0f} s: {out}/report.html",
        ]
    )
