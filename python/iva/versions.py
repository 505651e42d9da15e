"""What runs here, for reports of faults."""

from __future__ import annotations

import os

from iva import _iva


def show_versions() -> None:
    """Print the versions of iva and of what it works with, the platform, and the threads.

    Examples
    --------
    >>> show_versions()  # doctest: +ELLIPSIS
    iva       ...
    python    ...
    polars    ...
    numpy     ...
    tqdm      ...
    platform  ...
    threads   ...
    """
    import platform

    rows = {
        "iva": f"{_iva.VERSION} (table layout {_iva.SCHEMA_VERSION})",
        "python": f"{platform.python_version()} ({platform.python_implementation()})",
        **{name: installed(name) for name in ("polars", "numpy", "tqdm")},
        "platform": platform.platform(),
        "threads": f"{threads()} unless a sweep is told otherwise",
    }
    for name, value in rows.items():
        print(f"{name:9} {value}")


def installed(package: str) -> str:
    """Return the version of a package without importing it."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def threads() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
