"""The command ``iva``: the same program as the native binary."""

import signal
import sys

from iva import _iva


def main() -> int:
    """Run the command with the arguments of the process; return its exit code."""
    # Python's own handler would wait for the end of the command before it acts.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _iva.main(["iva", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
