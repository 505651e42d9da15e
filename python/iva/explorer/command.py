"""``iva explore``: the explorer from the command line."""

from __future__ import annotations

import argparse
import sys
import webbrowser
from collections.abc import Sequence
from pathlib import Path
from tempfile import mkdtemp

from iva._iva import IvaError
from iva.explorer import Explorer
from iva.explorer.scenes import DEFAULT, of_study

DONE, FAULT, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130


class Parser(argparse.ArgumentParser):
    """A parser whose faults read like those of the other commands."""

    def error(self, message: str) -> None:  # type: ignore[override]
        """Raise what is wrong instead of ending the process."""
        raise ValueError(message)


def parser() -> Parser:
    """Return the parser."""
    made = Parser(
        prog="iva explore",
        description="Drag a scene in the browser: one page with the simulator in it, which needs "
        "no network and can be mailed.",
        epilog="Example: iva explore study.toml --out page.html",
    )
    made.add_argument(
        "study",
        nargs="?",
        metavar="STUDY",
        help="study file whose scene the page begins with, the first value of what is swept; "
        "without it, a free mass that settles",
    )
    made.add_argument(
        "--out",
        metavar="FILE",
        help="write the page to this file and open nothing; by default it opens in the browser",
    )
    made.add_argument("--overwrite", action="store_true", help="write over a file that is there")
    return made


def made(arguments: Sequence[str]) -> str:
    """Make the page that was asked for; return what to say."""
    asked = parser().parse_args(arguments)
    explorer = Explorer(of_study(Path(asked.study)) if asked.study else DEFAULT)
    if asked.out is None:
        path = Path(mkdtemp(prefix="iva-")) / "explorer.html"
        explorer.write(path)
        opened = webbrowser.open(path.as_uri())
        return f"{path}" + ("" if opened else ": no browser was found; open it in one")
    path = Path(asked.out)
    if path.exists() and not asked.overwrite:
        raise ValueError(f"--out {path}: it exists; give --overwrite or another name")
    explorer.write(path)
    return f"{path}: open it in a browser"


def main(arguments: Sequence[str]) -> int:
    """Run the command; return its exit code."""
    try:
        print(made(arguments))
    except (ValueError, TypeError) as wrong:
        print(f"error: {wrong}", file=sys.stderr)
        return BAD_INPUT
    except (OSError, IvaError) as fault:
        print(f"error: {fault}", file=sys.stderr)
        return FAULT
    except KeyboardInterrupt:
        return INTERRUPTED
    return DONE
