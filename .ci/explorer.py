"""Build the simulator of the explorer as WebAssembly: target/wasm/simulator.wasm.

A toolchain with the target wasm32-unknown-unknown builds it as it is. Without one, a compiler of
the Debian package sources does, unpacked below target/wasm: nothing is installed. It has no library
for the target, which is compiled along; so the first build takes some ten minutes.
"""

import os
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CRATE = ROOT / "crates" / "iva-wasm"
TARGET = "wasm32-unknown-unknown"
FOLDER = ROOT / "target" / "wasm"
PACKAGES = (
    "rustc-web rust-web-src libstd-rust-web-dev libstd-rust-web-1.96 libllvm22 lld-22".split()
)


def unpacked() -> tuple[dict[str, str], list[str]]:
    """Return the environment and the options with which Debian's compiler builds the module."""
    root = FOLDER / "debian"
    if not (root / "usr" / "bin" / "rustc").exists():
        packages = FOLDER / "packages"
        packages.mkdir(parents=True, exist_ok=True)
        subprocess.run(["apt-get", "download", *PACKAGES], cwd=packages, check=True)
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
        # It lets this compiler take an option that is not settled yet: to compile the library.
        "RUSTC_BOOTSTRAP": "1",
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
    environment, options = ({}, []) if has_target() else unpacked()
    environment["CARGO_TARGET_DIR"] = str(FOLDER / "target")
    command = ["cargo", "build", "--locked", "--release", "--target", TARGET, *options]
    subprocess.run(command, cwd=CRATE, env=os.environ | environment, check=True)
    module = FOLDER / "simulator.wasm"
    shutil.copy(FOLDER / "target" / TARGET / "release" / "iva_wasm.wasm", module)
    print(f"{module.relative_to(ROOT)}: {module.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    build()
