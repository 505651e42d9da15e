"""The command ``iva``: the program of the native binary, ``iva explore`` and ``iva reproduce``."""

import signal
import sys
from types import FrameType

from iva import _iva


def main() -> int:
    """Run the command with the arguments of the process; return its exit code."""
    if sys.argv[1:2] == ["reproduce"]:  # it draws: nothing of it is imported for the others
        return _reproduce(sys.argv[2:])
    if sys.argv[1:2] == ["explore"]:
        from iva.explorer.command import main as explore

        return explore(sys.argv[2:])
    # Python's own handler would wait for the end of the command before it acts.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _iva.main(["iva", *sys.argv[1:]])


def _reproduce(arguments: list[str]) -> int:
    interrupts: list[int] = []

    def note(number: int, _frame: FrameType | None) -> None:
        interrupts.append(number)

    # An exception inside the first lines of an extension written in C++ ends the process: Ctrl-C
    # waits for the imports.
    before = signal.signal(signal.SIGINT, note)
    try:
        from iva.paper.command import main as reproduce
    except ImportError as missing:  # matplotlib or SciPy
        print(f"error: {missing}", file=sys.stderr)
        return 1
    finally:
        signal.signal(signal.SIGINT, before)
    if interrupts:
        print("error: interrupted; nothing was written", file=sys.stderr)
        return 130
    return reproduce(arguments)


if __name__ == "__main__":
    sys.exit(main())
