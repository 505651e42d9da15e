"""The command ``iva``: that of the native binary, and what is done in Python.

In Python are ``iva optimise``, ``iva identify``, ``iva explore`` and ``iva reproduce``.
"""

from __future__ import annotations

import signal
import sys
from types import FrameType

from iva import _iva

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeAlias

    Command: TypeAlias = Callable[[list[str]], int]


def main() -> int:
    """Run the command with the arguments of the process; return its exit code."""
    if sys.argv[1:2] == ["reproduce"]:  # it draws: nothing of it is imported for the others
        return _reproduce(sys.argv[2:])
    if sys.argv[1:2] == ["optimise"]:
        return _optimise(sys.argv[2:])
    if sys.argv[1:2] == ["identify"]:
        return _identify(sys.argv[2:])
    if sys.argv[1:2] == ["explore"]:
        from iva.explorer.command import main as explore

        return explore(sys.argv[2:])
    # Python's own handler would wait for the end of the command before it acts.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _iva.main(["iva", *sys.argv[1:]])


def _reproduce(arguments: list[str]) -> int:
    def command() -> Command:
        from iva.paper.command import main as reproduce

        return reproduce

    return _with_imports(command, arguments)


def _optimise(arguments: list[str]) -> int:
    def command() -> Command:
        import scipy.optimize
        import scipy.stats  # noqa: F401

        from iva.optimisation.command import main as optimise

        return optimise

    return _with_imports(command, arguments)


def _identify(arguments: list[str]) -> int:
    def command() -> Command:
        from iva.identification.needs import sampler

        sampler()
        from iva.identification.command import main as identify

        return identify

    return _with_imports(command, arguments)


def _with_imports(command: Callable[[], Command], arguments: list[str]) -> int:
    """Import a command of large packages, and run it."""
    interrupts: list[int] = []

    def note(number: int, _frame: FrameType | None) -> None:
        interrupts.append(number)

    # An exception inside the first lines of an extension written in C++ ends the process: Ctrl-C
    # waits for the imports.
    before = signal.signal(signal.SIGINT, note)
    try:
        run = command()
    except ImportError as missing:  # matplotlib or SciPy
        print(f"error: {missing}", file=sys.stderr)
        return 1
    finally:
        signal.signal(signal.SIGINT, before)
    if interrupts:
        print("error: interrupted; nothing was written", file=sys.stderr)
        return 130
    return run(arguments)


if __name__ == "__main__":
    sys.exit(main())
