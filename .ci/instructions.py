"""Count the instructions of fixed scenes and compare them with the numbers kept beside this file.

Usage: instructions.py [--update]

Fails where a scene takes 5 % more than its number. Valgrind has no AVX-512, so that this sees the
code for AVX2. Numbers belong to a compiler and a valgrind: with others the counts are printed, and
nothing fails. --update keeps the counts of now.

The program is built without vectorisation of straight-line code, which makes use of an instruction
that valgrind 3.19 does not know.
"""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

KEPT = Path(__file__).with_name("instructions.json")
TARGET = Path("target/counted")
PROGRAM = TARGET / "release" / "counted"
ALLOWED = 1.05


def printed(*command: str) -> str:
    """Return what a command prints."""
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def with_valgrind() -> None:
    """Install valgrind where it is missing."""
    if shutil.which("valgrind"):
        return
    if not shutil.which("apt-get"):
        sys.exit("valgrind is missing, and so is apt-get to install it: install valgrind first")
    become = [] if not shutil.which("sudo") else ["sudo"]
    subprocess.run([*become, "apt-get", "update", "-qq"], check=True)
    subprocess.run([*become, "apt-get", "install", "-y", "-qq", "valgrind"], check=True)


def count(scene: str) -> int:
    """Return the instructions that a scene takes, start of the program included."""
    tool = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    run = subprocess.run([*tool, PROGRAM, scene], capture_output=True, text=True)
    if run.returncode:
        sys.exit(f"valgrind failed on scene {scene}:\n{run.stderr}")
    return int(re.search(r"Collected : (\d+)", run.stderr)[1])


def has_avx2() -> bool:
    """Return whether this machine has what the kept numbers were counted with."""
    info = Path("/proc/cpuinfo")
    return info.exists() and {"avx2", "fma"} <= set(info.read_text().split())


def main() -> int:
    """Count, print, compare."""
    if sys.platform != "linux":
        print("instructions not counted: valgrind needs Linux, this is", sys.platform)
        return 0
    with_valgrind()
    build = ["cargo", "build", "--locked", "--release", "-p", "iva-benches", "--bin", "counted"]
    flags = {**os.environ, "RUSTFLAGS": "-C target-cpu=x86-64-v3 -C no-vectorize-slp"}
    subprocess.run([*build, "--target-dir", TARGET], check=True, env=flags)
    tools = {"rustc": printed("rustc", "--version"), "valgrind": printed("valgrind", "--version")}
    start, *scenes = printed(str(PROGRAM)).split()
    empty = count(start)
    counts = {scene: count(scene) - empty for scene in scenes}
    if "--update" in sys.argv[1:]:
        KEPT.write_text(json.dumps({**tools, "instructions": counts}, indent=2) + "\n")
        return 0
    kept = json.loads(KEPT.read_text())
    ratios = {scene: counts[scene] / kept["instructions"][scene] for scene in scenes}
    for scene, ratio in ratios.items():
        print(f"{scene:18} {counts[scene]:>12,} instructions, {ratio:6.3f} of the number kept")
    foreign = {name: value for name, value in tools.items() if kept[name] != value}
    if foreign or not has_avx2():
        print("not compared:", ", ".join(foreign.values()) or "no AVX2 and FMA", "here")
        return 0
    grown = [scene for scene, ratio in ratios.items() if ratio > ALLOWED]
    if grown:
        print(f"more than {ALLOWED - 1:.0%} more instructions:", ", ".join(grown))
    return 1 if grown else 0


if __name__ == "__main__":
    sys.exit(main())
