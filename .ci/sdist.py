"""Build the source distribution, see that what it promises is in it, install from it, and run that.

Usage: sdist.py MATURIN

What is installed is built as a user's is, by the back end that pyproject.toml names and with the
kept versions, but its crates are not optimised: so they are built in a fraction of the time, and
how fast they run is not the question here. Dependencies are those that the wheel was built with, if
it was. All of it is built from nothing by the workflow in .github/workflows/wheels.yml.
"""

import os
import platform
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "target" / "sdist"
# Kept files and folders that must be in it whole, besides what `license-files` names. Of the crates
# the build shows that all is there.
WHOLE = (
    ".cargo/config.toml",
    "CHANGELOG.md",
    "Cargo.lock",
    "README.md",
    "docs",
    "pyproject.toml",
    "python",
    "studies",
)
SMOKE = """
import iva
from pathlib import Path
assert Path(iva.__file__).is_relative_to({folder!r}), iva.__file__
run = iva.simulate(
    iva.Siva(mass_ratio=0.15, relative_clearance=0.6, restitution=0.5),
    iva.Primary(damping_ratio=0.01),
    start=iva.Start(displacement=1.0),
    periods=6,
    verify=True,
)
print(run)
assert len(run.impacts) > 3
"""


def run(*command: object, **extra: str) -> None:
    """Run a command of which a failure is the end."""
    subprocess.run([str(part) for part in command], check=True, env={**os.environ, **extra})


def packed(archive: Path) -> dict[str, bytes]:
    """Return the files of the source distribution, without the folder that holds them all."""
    with tarfile.open(archive) as tar:
        return {
            member.name.partition("/")[2]: tar.extractfile(member).read()
            for member in tar
            if member.isfile()
        }


def promised() -> set[str]:
    """Return the files that must be in it."""
    command = ["git", "ls-files", "-z", *WHOLE]
    kept = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, encoding="utf-8")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return {*kept.stdout.rstrip("\0").split("\0"), *project["license-files"], "PKG-INFO"}


def unpack(files: dict[str, bytes], folder: Path) -> None:
    """Make a folder hold these files and no others; one that is as it was keeps its time.

    Cargo builds again what is newer than its last build, so that nothing is built twice.
    """
    for path in sorted(folder.rglob("*"), reverse=True):
        if path.is_file() and path.relative_to(folder).as_posix() not in files:
            path.unlink()
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.is_file() or path.read_bytes() != content:
            path.write_bytes(content)


def versions(lock: str) -> set[tuple[str, str]]:
    """Return the packages that a lock file keeps."""
    return {(package["name"], package["version"]) for package in tomllib.loads(lock)["package"]}


def main() -> None:
    """Build, check, install, try."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for old in FOLDER.glob("*.tar.gz"):
        old.unlink()
    run(Path(sys.argv[1]).absolute(), "sdist", "--out", FOLDER)
    (archive,) = FOLDER.glob("*.tar.gz")
    files = packed(archive)
    if missing := promised() - set(files):
        sys.exit(f"{archive.name} lacks {', '.join(sorted(missing))}")

    source = FOLDER / "source"
    unpack(files, source)
    place = FOLDER / "environment"
    run(sys.executable, "-m", "venv", "--clear", "--without-pip", place)
    programs = place / ("Scripts" if os.name == "nt" else "bin")
    python = programs / "python"
    pip = (sys.executable, "-m", "pip", "--python", python, "--disable-pip-version-check")
    needs = tomllib.loads(files["pyproject.toml"].decode())["build-system"]["requires"]
    run(*pip, "install", "--quiet", *needs)
    lock = tomllib.loads((source / "Cargo.lock").read_text())
    own = [package["name"] for package in lock["package"] if "source" not in package]
    plain = " ".join(f"--config profile.release.package.{name}.opt-level=0" for name in own)
    # The library of the wheel has the same name: without this Cargo could take one for the other.
    target = {"CARGO_TARGET_DIR": str(ROOT / "target")}
    # Its own file of flags lies below that of the project: from both, Cargo would have other flags.
    config = tomllib.loads(files[".cargo/config.toml"].decode())["target"]
    if platform.machine() in ("x86_64", "AMD64"):
        target["RUSTFLAGS"] = " ".join(config['cfg(target_arch = "x86_64")']["rustflags"])
    run("cargo", "clean", "--quiet", "--release", "--package", "iva-py", **target)
    wheels = set((ROOT / "target" / "wheels").glob("*.whl"))
    run(
        *(*pip, "install", "--quiet", "--no-build-isolation", source),
        **target,
        MATURIN_PEP517_ARGS=plain,
        PATH=f"{programs}{os.pathsep}{os.environ['PATH']}",
    )
    # The wheel without optimisation must not be taken for the one that `make wheel` has built.
    for wheel in set((ROOT / "target" / "wheels").glob("*.whl")) - wheels:
        wheel.unlink()
    # Cargo takes the tests, which are left out, off the list of kept versions; it must change none.
    if other := versions((source / "Cargo.lock").read_text()) - versions(
        (ROOT / "Cargo.lock").read_text()
    ):
        sys.exit(f"built with versions that Cargo.lock does not keep: {sorted(other)}")
    run(programs / "iva", "--version")
    run(python, "-I", "-c", SMOKE.format(folder=str(place)))


if __name__ == "__main__":
    main()
