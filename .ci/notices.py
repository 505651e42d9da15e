"""Gather the licences of what the wheels link: THIRD-PARTY-NOTICES.txt, which every wheel carries.

Usage: notices.py [--update]

Fails where a package has a licence that is not in `ALLOWED`, or where the file is not what this
program would write. --update writes it.

Linked are the normal dependencies of iva-py, at any depth, for each system that has a wheel; what
only builds the wheel is not in it. Texts are those that lie in the packages, each text once; where
a package may be used under MIT, the texts of its other licences are left out.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

FILE = Path("THIRD-PARTY-NOTICES.txt")
# Those of the wheels in .github/workflows/wheels.yml.
TARGETS = (
    "x86_64-unknown-linux-gnu",
    "aarch64-unknown-linux-gnu",
    "aarch64-apple-darwin",
    "x86_64-apple-darwin",
    "x86_64-pc-windows-msvc",
)
ALLOWED = {
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MIT-0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
}
NAMES = re.compile(r"(un)?licen[cs]e|copying|copyright|notice", re.IGNORECASE)
CODE = {".c", ".h", ".py", ".rs"}
BESIDE_MIT = re.compile(r"apache|boost|bsd|copying|unlicense|zlib", re.IGNORECASE)
# zstd is offered under the GPL as well; it is used here under the other licence.
NOT_CHOSEN = {("zstd-sys", "zstd/COPYING")}
# The licence of a package that comes without a text. One that is not here fails.
WITHOUT_TEXT = {
    "block2": "MIT",
    "dispatch2": "MIT",
    "flatbuffers": "Apache-2.0",
    "objc2": "MIT",
    "objc2-encode": "MIT",
    "pulp-wasm-simd-flag": "MIT",
}
HEAD = """\
Third-party notices of iva-dynamics

iva-dynamics itself is licensed under MIT OR Apache-2.0. Its wheels contain compiled code of the
packages listed here, some of them on some systems only. The texts of their licences follow the
list.

Every wheel contains code of the Rust standard library as well, MIT OR Apache-2.0, Copyright (c) The
Rust Project Developers (see https://thanks.rust-lang.org), with tables of Unicode (Unicode-3.0,
Copyright (c) 1991-2024 Unicode, Inc.) and code of the packages cfg-if, gimli, hashbrown, libc,
rustc-demangle, windows-link and windows-sys, all MIT OR Apache-2.0. Its notices in full:
https://github.com/rust-lang/rust/blob/stable/COPYRIGHT
"""
RULE = "=" * 80


def cargo(*arguments: str) -> str:
    """Return what cargo prints; the versions are those of Cargo.lock."""
    command = ["cargo", *arguments, "--locked"]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, encoding="utf-8").stdout


def linked() -> list[dict]:
    """Return the packages that a wheel links, as `cargo metadata` describes them."""
    found = {}
    for target in TARGETS:
        tree = ["tree", "--package=iva-py", "--edges=normal,no-proc-macro", "--prefix=none"]
        rows = cargo(*tree, "--format={p}", "--target", target).splitlines()
        names = {tuple(row.split()[:2]) for row in rows if row}
        every = cargo("metadata", "--format-version", "1", "--filter-platform", target)
        for package in json.loads(every)["packages"]:
            key = package["name"], f"v{package['version']}"
            if key in names and package["source"]:
                found[key] = package
    return [found[key] for key in sorted(found)]


def is_allowed(expression: str) -> bool:
    """Return whether an SPDX expression leaves a choice that is allowed. AND binds before OR."""
    rest = (expression or "none").replace("/", " OR ")
    while inner := re.search(r"\(([^()]*)\)", rest):
        rest = rest.replace(inner[0], "MIT" if is_allowed(inner[1]) else "none")
    return any(
        all(name.strip() in ALLOWED for name in choice.split(" AND "))
        for choice in rest.split(" OR ")
    )


def texts(package: dict) -> list[str]:
    """Return the licences and notices that lie in a package."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*")
        if NAMES.match(path.name) and path.is_file() and path.suffix not in CODE
    )
    choices = re.split(r" OR |/", package["license"] or "")
    if "MIT" in choices and any("mit" in file.lower() for file in files):
        files = [file for file in files if "/" in file or not BESIDE_MIT.search(file)]
    found = [
        (folder / file).read_text(encoding="utf-8", errors="replace")
        for file in files
        if (package["name"], file) not in NOT_CHOSEN
    ]
    if found:
        return found
    licence = WITHOUT_TEXT.get(package["name"])
    if licence == "MIT":
        authors = ", ".join(package["authors"]) or f"the authors of {package['name']}"
        _, begin, rest = Path("LICENSE-MIT").read_text(encoding="utf-8").partition("Permission is")
        return [f"Copyright (c) {authors}\n\n{begin}{rest}"]
    if licence == "Apache-2.0":
        return [Path("LICENSE-APACHE").read_text(encoding="utf-8")]
    return []


def tidy(text: str) -> str:
    """Return a text without differences that nobody sees."""
    lines = [line.rstrip() for line in text.replace("\f", "").lstrip("\ufeff").splitlines()]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).strip("\n")


def written(packages: list[dict]) -> str:
    """Return the file: head, packages, texts."""
    rows = []
    holders: dict[str, tuple[str, list[str]]] = {}
    for package in packages:
        name = f"{package['name']} {package['version']}"
        home = package["repository"] or package["homepage"] or ""
        rows.append(f"{name}: {package['license']}; {home}".rstrip("; "))
        for text in texts(package):
            # The same words in other lines are the same text.
            _, names = holders.setdefault(" ".join(text.split()), (tidy(text), []))
            if name not in names:
                names.append(name)
    parts = [HEAD, "\n".join(rows) + "\n"]
    for text, names in holders.values():
        parts.append(f"{RULE}\nThis text belongs to {', '.join(names)}\n{RULE}\n\n{text}\n")
    return "\n".join(parts)


def main() -> int:
    """Compare, or write."""
    packages = linked()
    faults = []
    for package in packages:
        name = f"{package['name']} {package['version']}"
        if not is_allowed(package["license"]):
            faults.append(f"{name} has the licence {package['license']!r}, which is not allowed")
        elif not texts(package):
            faults.append(f"{name} comes without the text of its licence")
    if faults:
        print(*faults, sep="\n")
        return 1
    text = written(packages)
    if "--update" in sys.argv[1:]:
        FILE.write_text(text, encoding="utf-8", newline="\n")
    elif not FILE.exists() or FILE.read_text(encoding="utf-8") != text:
        print(f"{FILE} is not that of Cargo.lock: python .ci/notices.py --update")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
