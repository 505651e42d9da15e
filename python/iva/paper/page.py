"""The report as one page of HTML that needs no other file."""

from __future__ import annotations

from base64 import b64encode
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from html import escape

from iva import _iva
from iva.paper.assumptions import Assumptions, listed
from iva.paper.figures import ITEMS
from iva.paper.made import Made
from iva.paper.verdicts import Finding, Verdict

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    import polars as pl

PAPER = (
    "Numerical Modelling and Experimental Investigation of a Single and a Compound Pendulum Impact "
    "Dynamic Vibration Absorbers"
)

#: A sign besides the colour, for who sees none.
SIGNS = {
    Verdict.HOLDS: ("✓", "holds"),
    Verdict.UNDER_A_MEASURE: ("◐", "partly"),
    Verdict.DOES_NOT_HOLD: ("✗", "not"),
    Verdict.UNDECIDED: ("?", "open"),
}

STYLE = """
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem;
       color: #1b1b1b; background: #fff; }
h1 { line-height: 1.2; } h2 { margin-top: 3rem; border-bottom: 1px solid #ccc; }
img { max-width: 100%; height: auto; display: block; margin: 1rem 0; }
table { border-collapse: collapse; width: 100%; margin: 1rem 0; }
th, td { text-align: left; vertical-align: top; padding: .35rem .6rem;
         border-bottom: 1px solid #ddd; }
th { font-weight: 600; } .number { text-align: right; font-variant-numeric: tabular-nums; }
.verdict { white-space: nowrap; font-weight: 600; padding: .1rem .5rem; border-radius: .3rem; }
.holds { background: #d5efe3; } .partly { background: #fdf0c4; }
.not { background: #f8d9c9; } .open { background: #e6e6e6; }
.wide { overflow-x: auto; }
.note { color: #555; } details { margin: .4rem 0; } summary { cursor: pointer; color: #0059a3; }
td small { color: #555; } td.said { width: 55%; } a { color: #0059a3; }
@media print { details { display: none; } h2 { break-before: auto; } }
"""


def written(
    assumptions: Assumptions, items: Mapping[str, Made], pictures: Mapping[str, bytes]
) -> str:
    """Return the page of some studies, with the pictures in it."""
    findings = distinct(items)
    titles = {item.name: item.title for item in ITEMS}
    there: set[str] = set()
    sections = "".join(
        section(name, titles[name], made, pictures.get(name), there) for name, made in items.items()
    )
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>The paper, reproduced</title><style>{STYLE}</style></head><body>"
        f"<h1>The paper, reproduced</h1>{introduction(findings, assumptions)}"
        f"<h2 id='claims'>The claims</h2>{claims_table(findings)}"
        f"<h2 id='assumptions'>What is assumed</h2>{assumed(assumptions)}"
        f"{sections}"
        f"<p class='note'>Made by iva-dynamics {escape(_iva.VERSION)}: "
        "<code>iva reproduce</code>. Every run is event by event: no impact is missed, none added; "
        "infinite chatter is summed.</p></body></html>\n"
    )


def distinct(items: Mapping[str, Made]) -> list[Finding]:
    """Return the findings in the order of the items; one that two figures carry is there once."""
    by_claim = {found.claim: found for made in items.values() for found in made.findings}
    return list(by_claim.values())


def introduction(findings: Sequence[Finding], assumptions: Assumptions) -> str:
    """Say what this is, and how verdicts are made."""
    counts = ", ".join(f"{number} × {escape(name)}" for name, number in counted(findings))
    law = (
        "the misprints of its Eqs. 4 to 6 and 15 to 17 mended"
        if assumptions.impact_law == "consistent"
        else "the misprints of its Eqs. 4 to 6 mended and the law of impact as printed"
    )
    return (
        f"<p>Source: <cite>{PAPER}</cite>. Each figure was computed anew from the model of the "
        f"paper, with {law}, and each claim put to it.</p>"
        "<p>The paper speaks of a damping ratio and a settling time without saying how they are "
        "measured, and does not give all parameters. So a claim is judged in several views: by "
        "every measure that the words may mean and, where it matters, for several values. It "
        "<em>holds</em> if it does in all views that the model has a number for, <em>holds under "
        "a stated measure</em> if in some, <em>does not hold</em> if in none, and <em>cannot be "
        "decided</em> if there is no such view.</p>"
        f"<p><strong>{number_of(findings)}</strong>: {counts or 'none'}.</p>"
    )


def counted(findings: Iterable[Finding]) -> list[tuple[str, int]]:
    """Return how many claims have each verdict, best first."""
    counts = Counter(finding.verdict for finding in findings)
    return [(verdict.value, counts[verdict]) for verdict in Verdict if counts[verdict]]


def number_of(findings: Sequence[Finding]) -> str:
    """Return how many claims there are, in words."""
    return "1 claim" if len(findings) == 1 else f"{len(findings)} claims"


def badge(verdict: Verdict) -> str:
    """Return a verdict with its sign and colour."""
    sign, kind = SIGNS[verdict]
    return f"<span class='verdict {kind}'>{sign} {escape(verdict.value)}</span>"


def claims_table(findings: Iterable[Finding]) -> str:
    """Return the table of claims."""
    rows = "".join(
        f"<tr><th><a href='#{finding.claim}'>{finding.claim}</a></th>"
        f"<td class='said'>{escape(finding.paper)} <small>{escape(finding.figure)}</small></td>"
        f"<td>{badge(finding.verdict)} <small>{finding.share}</small>"
        + (f"<br><small>{escape(finding.measures)}</small>" if finding.measures else "")
        + "</td></tr>"
        for finding in sorted(findings, key=lambda finding: rank(finding.claim))
    )
    return (
        "<table><thead><tr><th></th><th>The paper says</th><th>Verdict, in how many "
        f"views</th></tr></thead><tbody>{rows}</tbody></table>"
    )


def rank(claim: str) -> tuple[int, int]:
    """Return the place of a claim in the table: free mass, pendulum, comparison, rig, Table 1."""
    return "SPCET".index(claim[0]), int(claim[1:])


def assumed(assumptions: Assumptions) -> str:
    """Return the table of assumptions."""
    rows = "".join(
        f"<tr><th><code>{name}</code></th><td class='number'>{escape(str(value))}</td>"
        f"<td>{escape(meaning)}</td></tr>"
        for name, value, meaning in listed(assumptions)
    )
    return (
        "<p>The paper gives neither the damping of the structure, nor lengths and frequencies, "
        "nor how the absorber starts: here centred in its gap, at rest relative to the "
        "structure. The structure is let go from x₀. M = ωn = x₀ = 1; d is half of the play. To "
        "change a value: <code>iva reproduce all --damping-ratio "
        f"0.02</code>.</p><table><tbody>{rows}</tbody></table>"
    )


def stem(name: str) -> str:
    """Return how the files of an item begin: ``fig03``, so that they sort."""
    return f"fig{int(name[3:]):02}" if name.startswith("fig") else name


def section(name: str, title: str, made: Made, picture: bytes | None, there: set[str]) -> str:
    """Return a figure with its parameters, findings and views; `there` are claims told before."""
    heading = name.replace("fig", "Fig. ").replace("table", "Table ")
    image = ""
    if picture is not None:
        data = b64encode(picture).decode("ascii")
        image = f"<img alt='{escape(f'{heading}: {title}')}' src='data:image/png;base64,{data}'>"
    files = ", ".join(f"<code>{stem(name)}-{table}.parquet</code>" for table in made.tables)
    return (
        f"<h2 id='{name}'>{heading}. {escape(title)}</h2>"
        f"<p><strong>Parameters:</strong> {escape(made.parameters)}.</p>{image}"
        + "".join(
            f"<h3>{escape(heading)}</h3>{rows(frame)}" for heading, frame in made.shown.items()
        )
        + f"<p class='note'>Data: {files}.</p>"
        + "".join(finding(found, there) for found in made.findings)
    )


def rows(frame: pl.DataFrame) -> str:
    """Return a small table; numbers to the right, an empty cell for null."""
    head = "".join(
        f"<th{' class=number' if kind.is_float() else ''}>{escape(name)}</th>"
        for name, kind in frame.schema.items()
    )
    body = "".join(
        "<tr>"
        + "".join(
            f"<td class='number'>{value:g}</td>"
            if isinstance(value, float)
            else f"<td>{escape('' if value is None else str(value))}</td>"
            for value in row
        )
        + "</tr>"
        for row in frame.rows()
    )
    made = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    return f"<div class='wide'>{made}</div>"


def finding(found: Finding, there: set[str]) -> str:
    """Return what the paper says, what the model says, the verdict, and all views."""
    if found.claim in there:
        link = f"<a href='#{found.claim}'>{found.claim}</a>"
        return f"<p>{link} {badge(found.verdict)} {escape(found.paper)}</p>"
    there.add(found.claim)
    views = "".join(
        f"<tr><td>{escape(view.name)}</td><td class='number'>{escape(view.value)}</td>"
        f"<td>{ {True: 'holds', False: 'does not', None: 'no number'}[view.holds] }</td></tr>"
        for view in found.views
    )
    measures = f" <small>({escape(found.measures)})</small>" if found.measures else ""
    return (
        f"<h3 id='{found.claim}'>{found.claim} {badge(found.verdict)}</h3>"
        f"<p><strong>The paper</strong> ({escape(found.figure)}): {escape(found.paper)}<br>"
        f"<strong>The model</strong>: {escape(found.model)}{measures}</p>"
        f"<details><summary>{len(found.views)} views</summary><table><tbody>{views}</tbody></table>"
        "</details>"
    )
