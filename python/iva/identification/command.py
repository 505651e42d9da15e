"""``iva identify``: a model from a measured decay, from the command line."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from iva._iva import IvaError, visible
from iva.commands import BAD_INPUT, DONE, FAULT, INTERRUPTED, Parser, failed
from iva.identification.fits import Fit
from iva.identification.identifying import identify
from iva.identification.known import ALONE, KINDS, Known, of_kind, of_study
from iva.identification.reports import written
from iva.measured import Measured
from iva.spelling import hint


def parser() -> Parser:
    """Return the parser."""
    made = Parser(
        prog="iva identify",
        description="Identify a structure and its impact absorber from a measured free decay: "
        "parameters and impacts with 90 % intervals, what the record does not tell apart, and "
        "whether the model explains it.",
        epilog="Example: iva identify decay.csv --column a1 --unit g --out results/decay, then "
        "iva run results/decay/model.toml. Exit code 0 also for a model that is not adequate.",
    )
    made.add_argument("record", metavar="RECORD", help="text, .at2, .v2, .lvm, .mat, .uff, .wav …")
    made.add_argument("--column", metavar="NAME", help="column, by its name or its number from 0")
    made.add_argument("--time", metavar="NAME", help="column of the time, where none is known")
    made.add_argument("--unit", metavar="UNIT", help="its unit, where the file states none")
    made.add_argument(
        "--scale", metavar="X", type=float, help="factor on its numbers, needed for .wav"
    )
    made.add_argument(
        "--sampling-hz", metavar="HZ", type=float, help="rate, where no time is there"
    )
    made.add_argument("--begin", metavar="S", type=float, help="leave out what comes before")
    made.add_argument("--end", metavar="S", type=float, help="leave out what comes after")
    made.add_argument(
        "--kind",
        metavar="KIND",
        help="siva (a free mass, by default), piva (a pendulum) or none (the structure alone)",
    )
    made.add_argument(
        "--study",
        metavar="FILE",
        help="study file with what is known: numbers of [primary], [absorber] and [start] exactly, "
        "those of [known] as distributions",
    )
    made.add_argument(
        "--out",
        metavar="DIR",
        help="folder for model.toml, tables and report.html; results/<record> by default",
    )
    made.add_argument("--overwrite", action="store_true", help="replace what --out holds")
    made.add_argument("--seed", metavar="N", type=int, default=0, help="seed of the sampler")
    return made


def found(arguments: Sequence[str]) -> tuple[Fit, Path]:
    """Do what was asked; return what was found and where it was written."""
    asked = parser().parse_args(arguments)
    column, time = (name if name is None else numbered(name) for name in (asked.column, asked.time))
    record = Measured.read(
        asked.record,
        column,
        time=time,
        unit=asked.unit,
        scale=asked.scale,
        sampling_hz=asked.sampling_hz,
        begin=asked.begin,
        end=asked.end,
    )
    known = known_of(asked.study, asked.kind)
    out = Path("results", Path(asked.record).stem) if asked.out is None else Path(asked.out)
    if out.exists() and not asked.overwrite:
        raise ValueError(f"--out {out}: it exists; give --overwrite or another folder")
    fit = identify(
        record,
        known.absorber,
        known.primary,
        start=known.start,
        known=known.distributions,
        seed=asked.seed,
    )
    written(fit, out, Path(asked.record).name)
    return fit, out


def numbered(name: str) -> str | int:
    """Return a column as it was named, or its number."""
    return int(name) if name.isdecimal() else name


def known_of(study: str | None, kind: str | None) -> Known:
    """Return what is known beforehand.

    Raises
    ------
    ValueError
        If the kind is unknown or another than that of the study.
    """
    if kind is not None and kind not in KINDS:
        raise ValueError(f"--kind {kind}: give siva, piva or none{hint(kind, KINDS)}")
    if study is None:
        return of_kind(kind or "siva")
    known = of_study(Path(study))
    own = ALONE if known.absorber is None else known.absorber._kind
    if kind is not None and kind != own:
        raise ValueError(f"--kind {kind}: the study has a {own}; leave one out")
    return known


def main(arguments: Sequence[str]) -> int:
    """Run the command; return its exit code: 0 done, 1 fault, 2 bad input, 130 interrupted."""
    try:
        fit, out = found(arguments)
    except SystemExit as end:  # --help
        return int(end.code or 0)
    except (ValueError, TypeError) as wrong:
        return failed(BAD_INPUT, str(wrong))
    except (OSError, ImportError, IvaError) as fault:
        return failed(FAULT, str(fault))
    except KeyboardInterrupt:
        return failed(INTERRUPTED, "interrupted; nothing was written")
    print(visible(f"{fit!r}\n\n{out / 'report.html'}: open it in a browser"))
    return DONE
