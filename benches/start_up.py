"""How long the command takes to start, against an idle process and an idle Python.

Usage: start_up.py NATIVE_IVA CONSOLE_IVA PYTHON. Programs are run in turn, so that all meet the
same noise; the median of each is printed, and what the command adds.
"""

import statistics
import subprocess
import sys
import time
from collections.abc import Sequence

ROUNDS = 40


def milliseconds(command: Sequence[str]) -> float:
    """Run a command once and return the time it took."""
    begin = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return 1e3 * (time.perf_counter() - begin)


def main(native: str, console: str, python: str) -> None:
    """Measure and print."""
    commands = {
        "idle process": ["true"],
        "native iva --version": [native, "--version"],
        "idle Python": [python, "-c", "pass"],
        "console iva --version": [console, "--version"],
        "import iva": [python, "-c", "import iva"],
    }
    times: dict[str, list[float]] = {name: [] for name in commands}
    for _ in range(ROUNDS):
        for name, command in commands.items():
            times[name].append(milliseconds(command))
    medians = {name: statistics.median(each) for name, each in times.items()}
    for name, median in medians.items():
        base = medians["idle process" if "native" in name or "process" in name else "idle Python"]
        print(f"{name:22} {median:6.1f} ms   {median / base:5.2f} × idle, +{median - base:.1f} ms")


if __name__ == "__main__":
    main(*sys.argv[1:])
