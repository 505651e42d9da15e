"""Build the simulator of the explorer as WebAssembly, into the Python package.

Beside it goes the digest of the sources that it was built from; `--check` compares it with the
sources as they are, which needs no compiler.

A toolchain with the target wasm32-unknown-unknown builds it as it is. Without one, a compiler of
the Debian package sources does, unpacked below target/wasm: nothing is installed. It has no library
for the target, which is compiled along; so the first build takes some ten minutes.
"""

import hashlib
import lzma
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CRATE = ROOT / "crates" / "iva-wasm"
TARGET = "wasm32-unknown-unknown"
FOLDER = ROOT / "target" / "wasm"
WEB = ROOT / "python" / "iva" / "explorer" / "web"
MODULE, DIGEST = WEB / "simulator.wasm.lzma", WEB / "simulator.sources"
#: The crates that it is made of.
CRATES = ("iva-core", "iva-sweep", "iva-wasm")
COMPILER = "rustc-web rust-web-src libstd-rust-web-dev libstd-rust-web-1.96 libllvm22 lld-22"
#: Addresses in as few bytes as they need.
FLAGS = "-Clink-arg=--compress-relocations"
#: How the module is packed: what a byte is likely to be depends on that before it.
PACKING = {"id": lzma.FILTER_LZMA1, "preset": 9 | lzma.PRESET_EXTREME, "lc": 4, "pb": 0}


def unpacked() -> tuple[dict[str, str], list[str]]:
    """Return the environment and the options with which Debian's compiler builds the module."""
    root = FOLDER / "debian"
    if not (root / "usr" / "bin" / "rustc").exists():
        packages = FOLDER / "packages"
        packages.mkdir(parents=True, exist_ok=True)
        subprocess.run(["apt-get", "download", *COMPILER.split()], cwd=packages, check=True)
        for package in sorted(packages.glob("*.deb")):
            subprocess.run(["dpkg-deb", "-x", package, root], check=True)
        shutil.rmtree(packages)
    libraries = root / "usr" / "lib" / "x86_64-linux-gnu"
    compiler = FOLDER / "rustc"
    compiler.write_text(
        f'#!/bin/sh\nLD_LIBRARY_PATH="{libraries}" exec "{root}/usr/bin/rustc" "$@"\n'
    )
    compiler.chmod(0o755)
    linker = "CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER"
    environment = {
        "RUSTC": str(compiler),
        # It lets this compiler take options that are not settled yet: to compile the library, and
        # to leave out the words of panics.
        "RUSTC_BOOTSTRAP": "1",
        "RUSTFLAGS": f"{FLAGS} -Zunstable-options -Cpanic=immediate-abort",
        "LD_LIBRARY_PATH": str(libraries),
        linker: str(root / "usr" / "bin" / "wasm-ld-22"),
    }
    return environment, ["-Z", "build-std=std,panic_abort"]


def has_target() -> bool:
    """Return whether the usual compiler has the library of the target."""
    command = ["rustc", "--print", "target-libdir", "--target", TARGET]
    asked = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    return asked.returncode == 0 and Path(asked.stdout.strip()).is_dir()


def build() -> None:
    """Build the module."""
    environment, options = ({"RUSTFLAGS": FLAGS}, []) if has_target() else unpacked()
    environment["CARGO_TARGET_DIR"] = str(FOLDER / "target")
    made_from = digest()
    command = ["cargo", "build", "--locked", "--release", "--target", TARGET, *options]
    subprocess.run(command, cwd=CRATE, env=os.environ | environment, check=True)
    built = (FOLDER / "target" / TARGET / "release" / "iva_wasm.wasm").read_bytes()
    MODULE.write_bytes(lzma.compress(built, lzma.FORMAT_ALONE, filters=[PACKING]))
    DIGEST.write_text(f"{made_from}\n", encoding="ascii")
    size = MODULE.stat().st_size
    print(f"{MODULE.relative_to(ROOT)}: {size / 1e3:.0f} kB, {len(built) / 1e3:.0f} unpacked")


def digest() -> str:
    """Return the digest of all sources; tests and lines of comments are none of them."""
    files = [CRATE / "Cargo.lock"]
    for crate in CRATES:
        folder = ROOT / "crates" / crate
        sources = (folder / "src").rglob("*.rs")
        files += [
            folder / "Cargo.toml",
            *(it for it in sources if "tests" not in {it.stem, it.parent.name}),
        ]
    total = hashlib.sha256()
    for file in sorted(files):
        lines = file.read_bytes().splitlines()
        content = b"\n".join(it for it in lines if not it.lstrip().startswith(b"//"))
        total.update(f"{file.relative_to(ROOT).as_posix()} {len(content)}\n".encode() + content)
    return total.hexdigest()


def check() -> int:
    """Say if the module was built from other sources than there are; return an exit code."""
    kept = DIGEST.read_text(encoding="ascii").strip() if DIGEST.exists() else "none"
    if kept == digest():
        return 0
    print(
        f"{MODULE.relative_to(ROOT)} was built from other sources: run make explorer",
        file=sys.stderr,
    )
    return 1


if __name__ == "__main__":
    if "--check" in sys.argv[1:]:
        sys.exit(check())
    build()
