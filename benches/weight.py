"""What the project weighs: seconds to build, megabytes to ship.

Usage: weight.py [--demo] [--change] [--ci]

Without options: the sizes of library and wheel that were built last. --demo: `make demo` in a fresh
clone of what is committed. --change: a line changed in `segment/roots.rs` of that clone, then
`make wheel`. --ci: `.ci/run` in a fresh clone. Times are wall and CPU seconds; only those of one
machine, measured with nothing beside them, can be compared.
"""

import argparse
import resource
import subprocess
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CLONE = ROOT / "target" / "weighed"
CHANGED = "crates/iva-core/src/segment/roots.rs"


def timed(what: str, *command: str) -> None:
    """Run a command in the clone and print what it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    began = time.perf_counter()
    done = subprocess.run(command, cwd=CLONE, capture_output=True, text=True)
    wall = time.perf_counter() - began
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    failed = f", FAILED with exit code {done.returncode}" if done.returncode else ""
    print(f"{what:44} {wall:8.0f} s {cpu:8.0f} CPU s{failed}", flush=True)
    if done.returncode:
        print(done.stdout[-2000:], done.stderr[-2000:], sep="\n")


def fresh() -> None:
    """Clone what is committed anew."""
    subprocess.run(["rm", "-rf", CLONE], check=True)
    subprocess.run(["git", "clone", "--quiet", ROOT, CLONE], check=True)


def change_a_line() -> None:
    """Change a line that all flights are compiled with."""
    path = CLONE / CHANGED
    text = path.read_text(encoding="utf-8")
    marked = text.replace("guess.unwrap_or_else", "(guess).unwrap_or_else", 1)
    assert marked != text, f"{CHANGED} has no such line any more"
    path.write_text(marked, encoding="utf-8")


def sizes(place: Path) -> None:
    """Print the sizes of what a place has built."""
    libraries = ("lib_iva.so", "lib_iva.dylib", "_iva.dll")
    built = [place / "target" / "release" / name for name in libraries]
    wheels = sorted((place / "target" / "wheels").glob("iva_dynamics-*.whl"))
    for what, paths in {"shared library": built, "wheel": wheels}.items():
        for path in paths:
            if path.exists():
                print(f"{what:44} {path.stat().st_size / 1e6:8.1f} MB")


def main() -> None:
    """Measure what is asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    for name in ("demo", "change", "ci"):
        parser.add_argument(f"--{name}", action="store_true")
    asked = parser.parse_args()
    if asked.demo or asked.change or asked.ci:
        fresh()
    if asked.demo or asked.change:
        timed("make demo in a fresh clone", "make", "demo")
        sizes(CLONE)
    else:
        sizes(ROOT)
    if asked.change:
        change_a_line()
        timed(f"a line of {Path(CHANGED).name} changed, make wheel", "make", "wheel")
        subprocess.run(["git", "checkout", "--quiet", "."], cwd=CLONE, check=True)
    if asked.ci:
        if asked.demo or asked.change:
            fresh()
        timed(".ci/run in a fresh clone", "bash", ".ci/run")


if __name__ == "__main__":
    main()
