"""What ``iva identify`` writes: a study file, tables, and a page with pictures."""

from __future__ import annotations

import base64
from html import escape
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from iva import _iva
from iva.identification.fits import Fit
from iva.own_files import replacing
from iva.parameters import choices, given

if TYPE_CHECKING:
    import polars as pl

STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:48rem;margin:2rem auto;padding:0 1rem}"
    "table{border-collapse:collapse}th,td{padding:.15rem .7rem;text-align:right;"
    "border-bottom:1px solid #ddd}th:first-child,td:first-child{text-align:left}"
    "div{overflow-x:auto}img{max-width:100%}"
)


def written(fit: Fit, out: Path, record: str) -> None:
    """Write all files of a fit into a folder.

    Raises
    ------
    iva.IvaError
        If a file cannot be written.
    """
    pictures = drawn(fit)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as fault:
        raise _iva.IvaError(f"{out} cannot be written: {fault.strerror}") from fault
    texts = {"model.toml": study(fit, record), "report.html": page(fit, record, pictures)}
    files = {name: text.encode() for name, text in texts.items()}
    files |= {f"{name}.png": picture for name, picture in pictures.items()}
    for name in ("parameters", "impacts"):
        files[f"{name}.csv"] = getattr(fit, name).write_csv().encode()
    for name, content in files.items():
        with replacing(out / name) as made:
            made.write_bytes(content)
    with replacing(out / "draws.parquet") as made:
        fit.draws.write_parquet(made)


def study(fit: Fit, record: str) -> str:
    """Return a study file of the scene that was found."""
    lines = [f"# Identified from {one_line(record)}.", "version = 1", "", "[absorber]"]
    if fit.absorber is None:
        lines.append('kind = "none"')
    else:
        lines += [f'{name} = "{word}"' for name, word in choices(fit.absorber)]
        lines += [f"{name} = {value!r}" for name, value in given(fit.absorber).items()]
    for part in (fit.primary, fit.start):
        lines += ["", f"[{part._part}]"]
        lines += [f"{name} = {value!r}" for name, value in given(part).items()]
    lines += ["", "[run]", f"duration = {fit.duration!r}", ""]
    return "\n".join(lines)


def one_line(text: str) -> str:
    """Return a text on one line."""
    return " ".join(text.split())


def drawn(fit: Fit) -> dict[str, bytes]:
    """Return the pictures as PNG by name; none without matplotlib."""
    if find_spec("matplotlib") is None:
        return {}
    import matplotlib.pyplot as plt

    from iva import plots
    from iva.plots.styles import figure_of

    made: dict[str, bytes] = {}
    for view in plots.fits.VIEWS[: 3 if fit.impacts.height else 2]:
        axes = plots.fit(fit, view)
        buffer = BytesIO()
        figure_of(axes).savefig(buffer, format="png", dpi=150)
        plt.close(figure_of(axes))
        made[view] = buffer.getvalue()
    return made


def page(fit: Fit, record: str, pictures: dict[str, bytes]) -> str:
    """Return the report: one page with its pictures in it."""
    verdict = (
        "The model explains the record."
        if fit.adequate
        else f"The model does not explain the record: {'; '.join(fit.reasons)}."
    )
    parts = [f"<h1>{escape(record)}</h1>", f"<p><strong>{escape(verdict)}</strong></p>"]
    parts.append("<h2>Parameters</h2><p>Medians with 90 % intervals.</p>")
    parts.append(table(fit.parameters))
    if fit.combinations:
        parts.append("<h2>What the record does not tell apart</h2>")
        parts += [f"<p>{escape(words)}</p>" for words in fit.combinations]
    if fit.notes:
        parts.append("<h2>Notes</h2>")
        parts += [f"<p>{escape(words)}</p>" for words in fit.notes]
    for name, picture in pictures.items():
        text = base64.b64encode(picture).decode("ascii")
        parts.append(f'<p><img alt="{name}" src="data:image/png;base64,{text}"></p>')
    if fit.impacts.height:
        parts += ["<h2>Impacts</h2>", table(fit.impacts)]
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width">'
        f"<title>{escape(record)}</title><style>{STYLE}</style>{''.join(parts)}</html>\n"
    )


def table(frame: pl.DataFrame) -> str:
    """Return a frame as a table in HTML."""

    def cell(value: object) -> str:
        return f"{value:.5g}" if isinstance(value, float) else escape(str(value))

    head = "".join(f"<th>{escape(name.replace('_', ' '))}</th>" for name in frame.columns)
    rows = "".join(
        f"<tr>{''.join(f'<td>{cell(value)}</td>' for value in row)}</tr>" for row in frame.rows()
    )
    return f"<div><table><tr>{head}</tr>{rows}</table></div>"
