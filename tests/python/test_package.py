"""The package itself: its names, and what is loaded when."""

from __future__ import annotations

import importlib.metadata
import pickle
import subprocess
import sys

import pytest

import iva


def loaded(program: str) -> set[str]:
    """Return the modules that a program adds to those of an idle Python."""
    show = "import sys; before = set(sys.modules)\n{}\nprint(*set(sys.modules) - before)"
    command = [sys.executable, "-c", show.format(program)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return set(done.stdout.splitlines()[-1].split())


def test_every_name_can_be_imported_and_listed() -> None:
    names: dict[str, object] = {}
    exec("from iva import *", names)
    del names["__builtins__"]
    assert sorted(names) == sorted(iva.__all__)
    assert set(iva.__all__) <= set(dir(iva))
    for name, value in names.items():
        assert value is getattr(iva, name)
        assert vars(iva)[name] is value, "a name is looked up once"


def test_names_that_are_not_there() -> None:
    with pytest.raises(AttributeError, match="no attribute 'sweeep'; did you mean `sweep`"):
        getattr(iva, "sweeep")  # noqa: B009
    assert not hasattr(iva, "__wrapped__")


def test_faults_travel_between_processes() -> None:
    fault = pickle.loads(pickle.dumps(iva.IvaError("a part is missing")))
    assert type(fault) is iva.IvaError
    assert fault.args == ("a part is missing",)


def test_the_package_loads_nothing_before_it_is_used() -> None:
    assert loaded("import iva") == {"iva", "iva.processor"}
    assert loaded("import iva; dir(iva)") == {"iva", "iva.processor"}


def test_the_command_loads_what_it_needs() -> None:
    program = "import iva.__main__, sys; sys.argv = ['iva', '--version']; iva.__main__.main()"
    ours = {name for name in loaded(program) if name.partition(".")[0] == "iva"}
    assert ours == {"iva", "iva.__main__", "iva._iva", "iva.processor"}
    assert not {"typing", "dataclasses", "inspect", "pathlib"} & loaded(program)


def test_a_run_loads_no_more_than_it_needs() -> None:
    heavy = {"importlib.metadata", "pathlib", "platform", "polars", "typing"}
    assert not heavy & loaded("import iva; iva.simulate")


def test_the_licences_of_what_the_wheel_links_come_with_it() -> None:
    installed = importlib.metadata.distribution("iva-dynamics")
    named = {path.name: path for path in installed.files or () if "licenses" in path.parts}
    assert set(named) == {"LICENSE-APACHE", "LICENSE-MIT", "THIRD-PARTY-NOTICES.txt"}
    assert all(".dist-info/licenses/" in path.as_posix() for path in named.values())
    notices = named["THIRD-PARTY-NOTICES.txt"].read_text(encoding="utf-8")
    for package in ("arrow-array", "parquet", "pyo3", "zstd-sys"):
        assert f"\n{package} " in notices
    assert "Rust standard library" in notices
