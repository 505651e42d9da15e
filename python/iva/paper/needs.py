"""What must be installed to draw and to fit."""

from importlib.util import find_spec


def require() -> None:
    """Check that matplotlib and SciPy are there.

    Raises
    ------
    ImportError
        If one of them is not.
    """
    missing = [name for name in ("matplotlib", "scipy") if find_spec(name) is None]
    if missing:
        needs = " and ".join(missing)
        raise ImportError(f"iva.paper needs {needs}: pip install 'iva-dynamics[paper]'")
