"""The explorer: a scene to be dragged, in one page that needs nothing but a browser.

The page holds the simulator itself, compiled to WebAssembly; what it draws are the numbers of this
package. :func:`explore` makes it from a run or a scene, ``iva explore`` from a study.
"""

from __future__ import annotations

from html import escape
from os import PathLike
from typing import Any, cast

from iva.explorer.document import page
from iva.explorer.scenes import DEFAULT, Explored, explored, parts
from iva.exports import aside
from iva.parameters import Absorber, Primary, Start
from iva.simulation import Run
from iva.spelling import spell_checked

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from collections.abc import Sequence

    from iva.explorer.notebook import Widget
    from iva.forces import Force
    from iva.structures import Structure

__all__ = ["Explorer", "explore"]

# Height of the page in a notebook, in pixels.
HEIGHT = 900


class Explorer:
    """A page with a scene to be dragged.

    A notebook shows it; :meth:`write` makes a file that opens in any browser, offline.
    """

    def __init__(self, scene: Explored) -> None:
        self._first = scene
        self._widget: Widget | None = None

    @property
    def scene(self) -> dict[str, Any]:
        """What the sliders say, as arguments: ``iva.simulate(**explorer.scene)`` runs it.

        The sliders of a notebook are heard if anywidget is installed (``pip install
        'iva-dynamics[explore]'``); else it is the scene that the page begins with.
        """
        return parts(self._now)

    @property
    def widget(self) -> Widget:
        """The page as a widget of anywidget, as marimo and layouts of notebooks take it.

        Raises
        ------
        ImportError
            If anywidget is not installed.
        """
        if self._widget is None:
            try:
                from iva.explorer.notebook import Widget
            except ImportError as missing:
                raise ImportError(
                    "iva.explore: a widget needs anywidget: pip install 'iva-dynamics[explore]'"
                ) from missing
            self._widget = Widget(self._first)
        return self._widget

    @property
    def html(self) -> str:
        """The page as a text."""
        return page(self._now)

    @property
    def _now(self) -> Explored:
        if self._widget is None:
            return self._first
        return cast("Explored", self._widget.scene)

    def write(self, path: str | PathLike[str]) -> None:
        """Write the page to a file, in place of one that is there.

        Raises
        ------
        ValueError
            If `path` is a folder, or in a folder that does not exist.
        iva.IvaError
            If it cannot be written; what `path` held before is then as it was.
        """
        with aside(path) as file:
            file.write_text(self.html, encoding="utf-8")

    def _repr_mimebundle_(self, **asked: Any) -> Any:
        """Return the widget; a page in a frame of its own where there is no anywidget."""
        try:
            return self.widget._repr_mimebundle_(**asked)
        except ImportError:
            inner = escape(self.html, quote=True)
            style = f"width: 100%; height: {HEIGHT}px; border: 0"
            frame = (
                f'<iframe srcdoc="{inner}" style="{style}" title="Explorer of a scene"></iframe>'
            )
            return {"text/plain": repr(self), "text/html": frame}

    def __repr__(self) -> str:
        """Return the kinds of absorbers, and how to make a file."""
        choices = self._now["choices"].items()
        kind = ", ".join(word for name, word in choices if name.endswith("kind"))
        return f"Explorer(kind={kind!r}); explorer.write('page.html') makes a file of it"


@spell_checked
def explore(
    scene: Run | Absorber | Sequence[Absorber] | None = None,
    primary: Primary | Structure | None = None,
    *,
    start: Start | None = None,
    force: Force | Sequence[Force] | None = None,
    periods: float | None = None,
    duration: float | None = None,
    cycles: float | None = None,
) -> Explorer:
    """Return a page with sliders and pictures of a scene, to be dragged in a browser.

    Parameters
    ----------
    scene : Run, Siva, Piva, a list of them, or None, optional
        A run, whose scene is taken; or the absorbers of a scene, with the parts that follow, as in
        :func:`iva.simulate`. Without any argument the page begins with a free mass that settles.
    primary : Primary or Structure, optional
        The primary system; needed unless `scene` is a run.
    start : Start, optional
        The state at time zero.
    force : Harmonic, Impulse, Recorded or a list of them, optional
        What drives it.
    periods, duration, cycles : float, optional
        Length of the run: one of them, as in :func:`iva.simulate`.

    Returns
    -------
    Explorer
        The page. A notebook shows it, ``write("page.html")`` makes a file, ``scene`` is what its
        sliders say.

    Raises
    ------
    TypeError
        If an argument is of the wrong type, or parts are given beside a run.
    ValueError
        If the scene has a tolerance: the page shows the exact motion.

    Examples
    --------
    >>> iva.explore(iva.Siva(mass_ratio=0.1, restitution=0.6, clearance=0.4), iva.Primary(),
    ...             start=iva.Start(displacement=1.0), periods=20)
    Explorer(kind='siva'); explorer.write('page.html') makes a file of it
    """
    run = {"periods": periods, "duration": duration, "cycles": cycles}
    given = [primary, start, force, *run.values()]
    if isinstance(scene, Run):
        if any(it is not None for it in given):
            raise TypeError("a run has its parts already: give iva.explore the run alone")
        return Explorer(explored(scene._spec))
    if scene is None and all(it is None for it in given):
        return Explorer(DEFAULT)
    from iva.scenes import scene as whole

    several = isinstance(scene, (list, tuple))
    made = whole(scene, primary, start or Start(), force, run, several=several)
    return Explorer(explored(made))
