"""The command ``iva``: the same program as the native binary, and ``iva reproduce``."""

import signal
import sys

from iva import _iva


def main() -> int:
    """Run the command with the arguments of the process; return its exit code."""
    if sys.argv[1:2] == ["reproduce"]:  # it draws: nothing of it is imported for the others
        try:
            from iva.paper.command import main as reproduce
        except ImportError as missing:  # matplotlib or SciPy
            print(f"error: {missing}", file=sys.stderr)
            return 1
        return reproduce(sys.argv[2:])
    # Python's own handler would wait for the end of the command before it acts.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _iva.main(["iva", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
