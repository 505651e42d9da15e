"""See that the files name one version; of a tag also that they are ready for it.

Usage: release.py [TAG]

The version stands in Cargo.toml, in that of the explorer's simulator, in the lock files and in
CITATION.cff. With a tag, such as v1.2.3, CITATION.cff must have the date, and CHANGELOG.md a
section "## 1.2.3 (date)" with something in it.
"""

import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LOCKS = ("Cargo.lock", "crates/iva-wasm/Cargo.lock", "tests/fuzz/Cargo.lock")
# It is never released.
WITHOUT_VERSION = {"iva-fuzz"}


def citation(root: Path) -> dict[str, str]:
    """Return the lines of CITATION.cff that have one value."""
    text = (root / "CITATION.cff").read_text(encoding="utf-8")
    return {key: value.strip("\"'") for key, value in re.findall(r"^([\w-]+): (.+)$", text, re.M)}


def stated(root: Path) -> dict[str, str]:
    """Return where a version is stated, and which."""
    cargo = tomllib.loads((root / "Cargo.toml").read_text(encoding="utf-8"))
    wasm = tomllib.loads((root / "crates/iva-wasm/Cargo.toml").read_text(encoding="utf-8"))
    found = {
        "Cargo.toml": cargo["workspace"]["package"]["version"],
        "crates/iva-wasm/Cargo.toml": wasm["package"]["version"],
        "CITATION.cff": citation(root).get("version", "none"),
    }
    for lock in LOCKS:
        for package in tomllib.loads((root / lock).read_text(encoding="utf-8"))["package"]:
            if "source" not in package and package["name"] not in WITHOUT_VERSION:
                found[f"{package['name']} in {lock}"] = package["version"]
    return found


def section(root: Path, version: str) -> tuple[str, str]:
    """Return date and text of a version's section of CHANGELOG.md, both empty without one."""
    text = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    found = re.search(rf"^## {re.escape(version)} \((\S+)\)\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    return ("", "") if found is None else (found[1], found[2].strip())


def faults(root: Path, tag: str | None) -> list[str]:
    """Return one line for each thing that is not ready."""
    found = stated(root)
    version = found["Cargo.toml"]
    lines = [
        f"{place} has version {other}, Cargo.toml {version}"
        for place, other in found.items()
        if other != version
    ]
    if tag is None:
        return lines
    if tag != f"v{version}":
        lines.append(f"the tag is {tag}, but the version {version}: it must be v{version}")
    date, text = section(root, version)
    if not text:
        lines.append(f'CHANGELOG.md has no section "## {version} (date)" with something in it')
    released = citation(root).get("date-released", "none")
    if not re.fullmatch(r"\d{4}-\d\d-\d\d", released) or (text and released != date):
        lines.append(f"date-released of CITATION.cff is {released}, CHANGELOG.md says {date}")
    return lines


if __name__ == "__main__":
    complaints = faults(ROOT, sys.argv[1] if len(sys.argv) > 1 else None)
    print(*complaints or ["all files name one version"], sep="\n")
    sys.exit(1 if complaints else 0)
