"""``iva explore``: the explorer from the command line."""

from __future__ import annotations

import webbrowser
from collections.abc import Sequence
from pathlib import Path
from tempfile import mkdtemp

from iva._iva import IvaError, visible
from iva.commands import BAD_INPUT, DONE, FAULT, INTERRUPTED, Parser, failed
from iva.explorer import Explorer
from iva.explorer.scenes import DEFAULT, of_study


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
        help="study file whose scene the page begins with; without it, a free mass that settles",
    )
    made.add_argument(
        "--point",
        metavar="N",
        type=int,
        default=0,
        help="of a study with [sweep], take this point: its number in the tables; 0 by default",
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
    explorer = Explorer(of_study(Path(asked.study), asked.point) if asked.study else DEFAULT)
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
    """Run the command; return its exit code: 0 done, 1 fault, 2 bad input, 130 interrupted."""
    try:
        print(visible(made(arguments)))
    except SystemExit as end:  # --help
        return int(end.code or 0)
    except (ValueError, TypeError) as wrong:
        return failed(BAD_INPUT, str(wrong).replace("path = ", "--out ", 1))
    except (OSError, IvaError) as fault:
        return failed(FAULT, str(fault))
    except KeyboardInterrupt:
        return failed(INTERRUPTED, "interrupted; nothing was written")
    return DONE
