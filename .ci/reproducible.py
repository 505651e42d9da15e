"""Build the wheel twice, in two folders, and see that both are the same bytes and tell no folder.

Usage: reproducible.py [--quick] MATURIN

The folders, and those of Cargo, have names of different lengths; both builds begin with nothing.
--quick leaves the optimiser out: that takes a fraction of the time and finds folders and times in
the wheel, but says nothing of what the optimiser does. Wheels that are released are built with the
same flags by .github/workflows/wheels.yml.
"""

import hashlib
import os
import platform
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PLACE = ROOT / "target" / "reproducible"
FOLDERS = ("first", "second-with-a-longer-name")


def copy(folder: Path) -> None:
    """Copy the files that git keeps, as they are now, into a folder."""
    command = ["git", "ls-files", "-z"]
    kept = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, encoding="utf-8")
    for name in filter(None, kept.stdout.split("\0")):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / name, folder / name)


def environment(folder: Path, quick: bool) -> dict[str, str]:
    """Return the variables of a build, with a folder of Cargo that has a name of its own."""
    cargo = folder / "cargo-home"
    cargo.mkdir()
    # What has been downloaded is shared.
    real = Path(os.environ.get("CARGO_HOME", Path.home() / ".cargo"))
    (real / "registry").mkdir(parents=True, exist_ok=True)
    for path in real.iterdir():
        (cargo / path.name).symlink_to(path)
    # Failures in packages name the file that they come from; paths of this project are relative.
    flags = [f"--remap-path-prefix={cargo}=/cargo"]
    if platform.machine() in ("x86_64", "AMD64"):  # as in .cargo/config.toml, which they replace
        flags.append("-Ctarget-cpu=x86-64-v3")
    variables = {key: value for key, value in os.environ.items() if "RUSTFLAGS" not in key}
    variables.pop("CARGO_TARGET_DIR", None)
    variables |= {"CARGO_HOME": str(cargo), "CARGO_ENCODED_RUSTFLAGS": "\x1f".join(flags)}
    if quick:
        variables["CARGO_PROFILE_RELEASE_OPT_LEVEL"] = "0"
    return variables


def build(name: str, maturin: Path, quick: bool) -> Path:
    """Return the wheel that is built in a folder."""
    folder = PLACE / name
    command = [maturin, "build", "--quiet", "--locked", "--out", PLACE / f"wheel-of-{name}"]
    subprocess.run(command, cwd=folder, env=environment(folder, quick), check=True)
    (wheel,) = (PLACE / f"wheel-of-{name}").glob("*.whl")
    return wheel


def contents(wheel: Path) -> dict[str, bytes]:
    """Return the files of a wheel."""
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def told(files: dict[str, bytes]) -> list[str]:
    """Return one line for each folder of this machine that a file tells."""
    homes = (os.environ.get("CARGO_HOME", Path.home() / ".cargo"), f"{Path.home()}{os.sep}")
    return [
        f"{name} tells the folder {folder}"
        for name, content in files.items()
        for folder in (ROOT, *homes)
        if os.fsencode(folder) in content
    ]


def main() -> int:
    """Build, compare, search."""
    *options, maturin = sys.argv[1:]
    shutil.rmtree(PLACE, ignore_errors=True)
    for name in FOLDERS:
        copy(PLACE / name)
    wheels = [build(name, Path(maturin).absolute(), "--quick" in options) for name in FOLDERS]
    for wheel in wheels:
        digest = hashlib.sha256(wheel.read_bytes()).hexdigest()
        print(digest, wheel.relative_to(PLACE), f"{wheel.stat().st_size} bytes", flush=True)
    one, two = map(contents, wheels)
    faults = [
        f"{name} is not the same in both"
        for name in sorted({*one, *two})
        if one.get(name) != two.get(name)
    ]
    if not faults and wheels[0].read_bytes() != wheels[1].read_bytes():
        faults = ["the files are the same, but their order, times or permissions are not"]
    faults += told(one)
    print(*faults or ["the same bytes, and no folder of this machine in them"], sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
