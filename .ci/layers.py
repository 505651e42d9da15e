"""Check that imports run one way.

python/iva → iva-py → iva-study → iva-store → iva-sweep → iva-core, iva-verify beside iva-store on
iva-sweep, and iva-cli beside iva-py on iva-study; of iva-cli iva-py has nothing but the command.
Within iva-core the rooms stand in one order.
"""

import re
import subprocess
import sys
from pathlib import Path

# What must not be among the dependencies of a crate, at any depth.
FORBIDDEN_CRATES = {
    "iva-core": "iva-sweep iva-store iva-study iva-cli iva-py rayon arrow-array arrow-schema "
    "parquet pyo3 clap toml",
    "iva-sweep": "iva-verify iva-store iva-study iva-cli iva-py parquet pyo3 clap toml tempfile",
    "iva-verify": "iva-store iva-study iva-cli iva-py parquet pyo3 clap toml tempfile",
    "iva-store": "iva-verify iva-study iva-cli iva-py pyo3 clap indicatif ctrlc anstream "
    "annotate-snippets toml tempfile",
    "iva-study": "iva-cli iva-py pyo3 clap indicatif ctrlc anstream annotate-snippets tempfile",
    "iva-cli": "iva-py pyo3",
}

# What must not stand in the code of a folder or file: physics knows no files, threads or clock;
# the driver knows no absorber; folders and studies print nothing and name no option of a front;
# libraries do not end the process; one crate names pyo3.
FRONT = r"\be?print(ln)?!|\bpyo3\b|--(out|overwrite|resume)\b|\b(overwrite|resume)=True"
ABSORBERS = r"\b([sp]iva|[SP]iva|modal|Modal)\b"
FORBIDDEN_WORDS = [
    ("crates/iva-core/src", r"\bstd::(fs|io|thread|time|env|process|net)\b|\bprintln!"),
    # The loop and the measures name no absorber, and a structure knows none on it.
    ("crates/iva-core/src/engine", ABSORBERS),
    ("crates/iva-core/src/measures.rs", ABSORBERS),
    ("crates/iva-core/src/measures", ABSORBERS),
    ("crates/iva-core/src/host.rs", ABSORBERS),
    ("crates/iva-core/src/host", ABSORBERS),
    # The number of a process tells a fork; nothing else of processes is for sweeps.
    ("crates/iva-sweep/src", r"\bstd::(fs|io|env|net)\b|\bprocess::(?!id\b)|\bprintln!"),
    ("crates/iva-core/src", r"\bpyo3\b"),
    ("crates/iva-sweep/src", r"\bpyo3\b"),
    ("crates/iva-verify/src", r"\bpyo3\b|\bstd::(fs|io|env|net)\b|\bprintln!"),
    # What is compiled to twice the precision is compiled in one crate.
    ("crates/iva-sweep/src", r"::<Twofold>"),
    ("crates/iva-store/src", FRONT),
    ("crates/iva-study/src", FRONT),
    ("crates/iva-cli/src", r"\bpyo3\b"),
    ("crates/iva-py/src", r"\bstd::(fs|io)\b|\bparquet::|\biva_cli::(?!main_with_args\b)"),
    ("crates", r"\bprocess::exit\b|\bunimplemented!|\btodo!"),
    ("python/iva", r"\bimport (pyarrow|pandas)\b"),
]

# The rooms of the core: each imports from itself and from those before it.
ROOMS = "error number range force segment host absorber engine measures run orbit theory".split()


def code(path: Path) -> list[tuple[int, str]]:
    """Return the numbered lines of a file up to its tests, without comments."""
    lines = path.read_text(encoding="utf-8").partition("#[cfg(test)]")[0].splitlines()
    return [(number, line.partition("//")[0]) for number, line in enumerate(lines, 1)]


def upward(path: Path) -> list[str]:
    """Return one line for each import of a file of the core from a room after its own."""
    room = path.relative_to("crates/iva-core/src").parts[0].removesuffix(".rs")
    if room == "lib":
        return []
    later = "|".join(ROOMS[ROOMS.index(room) + 1 :] or ["-"])
    return [
        f"{path}:{number}: {room} imports from a later room: {line.strip()}"
        for number, line in code(path)
        if re.search(rf"\bcrate::({later})\b", line)
    ]


def faults() -> list[str]:
    """Return one line for each thing in the wrong place."""
    found = []
    for crate, names in FORBIDDEN_CRATES.items():
        command = ["cargo", "tree", "--locked", "-p", crate, "-e", "normal", "--prefix", "none"]
        tree = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        below = {line.split()[0] for line in tree.splitlines() if line}
        found += [f"{crate} must not depend on {name}" for name in names.split() if name in below]
    for path in sorted(Path("crates/iva-core/src").rglob("*.rs")):
        if path.name != "tests.rs":
            found += upward(path)
    for place, pattern in FORBIDDEN_WORDS:
        root = Path(place)
        files = (
            [root] if root.is_file() else sorted(root.rglob("*.rs")) + sorted(root.rglob("*.py"))
        )
        found += [
            f"{path}:{number}: {line.strip()}"
            for path in files
            if path.as_posix() != "crates/iva-cli/src/main.rs" and path.name != "tests.rs"
            for number, line in code(path)
            if re.search(pattern, line)
        ]
    return found


if __name__ == "__main__":
    complaints = faults()
    print(*complaints, sep="\n", end="\n" if complaints else "")
    sys.exit(1 if complaints else 0)
