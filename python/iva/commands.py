"""What the commands in Python share: exit codes, and how faults are told."""

from __future__ import annotations

import argparse
import sys

from iva._iva import visible

DONE, FAULT, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130


class Parser(argparse.ArgumentParser):
    """A parser whose faults read like those of the other commands."""

    def error(self, message: str) -> None:  # type: ignore[override]
        """Raise what is wrong instead of ending the process."""
        raise ValueError(message)


def failed(code: int, text: str) -> int:
    """Say what is wrong; return the code."""
    print(f"error: {visible(text)}", file=sys.stderr)
    return code
