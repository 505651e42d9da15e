"""The command ``iva``: the same program as the native binary, and ``iva reproduce``."""

import signal
import sys

from iva import _iva


def main() -> int:
    """Run the command with the arguments of the process; return its exit code."""
    if sys.argv[1:2] == ["reproduce"]:  # it draws: nothing of it is imported for the others
        try:
            from iva.paper.command import main as reproduce

            return reproduce(sys.argv[2:])
        except ImportError as missing:  # matplotlib or SciPy
            print(f"error: {missing}", file=sys.stderr)
            return 1
        except KeyboardInterrupt:  # while all that is imported
            print("error: interrupted; nothing was written", file=sys.stderr)
            return 130
    # Python's own handler would wait for the end of the command before it acts.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _iva.main(["iva", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
