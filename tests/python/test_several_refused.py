"""Several free masses: refusals are one sentence with the field and what is allowed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import iva

SIVA = iva.Siva(mass_ratio=0.1, clearance=0.5, restitution=0.5)
NARROW = iva.Siva(mass_ratio=0.05, clearance=0.2, restitution=0.8)
PIVA = iva.Piva(mass_ratio=0.1, clearance=0.5, restitution=0.5, frequency_ratio=0.4, length=5.0)
TWO = [SIVA, NARROW]


def simulate(absorbers: Any, **start: Any) -> iva.Run:
    given = iva.Start(**({"displacement": 1.0} | start))
    return iva.simulate(absorbers, iva.Primary(), start=given, periods=2)


def sweep(over: dict[str, Any], absorbers: Any = TWO, **start: Any) -> iva.Table:
    given = iva.Start(**({"displacement": 1.0} | start))
    return iva.sweep(absorbers, iva.Primary(), over=over, start=given, periods=2)


# what is called, its exception, pieces of the message
CALLS: dict[str, tuple[Callable[[], object], type[Exception], tuple[str, ...]]] = {
    "an empty list": (lambda: simulate([]), ValueError, ("absorber = []", "iva.Siva")),
    "an empty tuple": (lambda: simulate(()), ValueError, ("absorber = ()", "iva.Siva")),
    "too many": (lambda: simulate([SIVA] * 65), ValueError, ("absorber", "65", "1 to 64")),
    "none in it": (lambda: simulate([SIVA, None]), TypeError, ("absorber[1]", "None", "iva.Siva")),
    "only none": (lambda: simulate([None]), TypeError, ("absorber[0]", "None", "iva.Siva")),
    "a number in it": (
        lambda: simulate([0.5, SIVA]),
        TypeError,
        ("absorber[0]", "0.5", "iva.Siva"),
    ),
    "a list in it": (lambda: simulate([SIVA, TWO]), TypeError, ("absorber[1]", "iva.Siva")),
    "a text": (lambda: simulate("two"), TypeError, ("absorber", "'two'")),
    "a set": (lambda: simulate({SIVA, NARROW}), TypeError, ("absorber",)),
    "too few places": (
        lambda: simulate(TWO, gap_displacement=[0.1]),
        ValueError,
        ("start.gap_displacement = [0.1]", "a list of 2"),
    ),
    "too many places": (
        lambda: simulate(TWO, gap_displacement=[0.1, 0.1, 0.1]),
        ValueError,
        ("start.gap_displacement = [0.1, 0.1, 0.1]", "a list of 2"),
    ),
    "too many speeds": (
        lambda: simulate(TWO, gap_velocity=[0.1, 0.1, 0.1]),
        ValueError,
        ("start.gap_velocity = [0.1, 0.1, 0.1]", "a list of 2"),
    ),
    "no places": (
        lambda: simulate(TWO, gap_displacement=[]),
        ValueError,
        ("start.gap_displacement",),
    ),
    "places of units": (
        lambda: simulate(replace(SIVA, units=3), gap_displacement=[0.1, 0.1]),
        ValueError,
        ("start.gap_displacement = [0.1, 0.1]", "a list of 3, one for each unit"),
    ),
    "places of units in a list": (
        lambda: simulate([replace(SIVA, units=3), NARROW], gap_velocity=[0.1] * 3),
        ValueError,
        ("a list of 2, one for each absorber, or of 4, one for each unit",),
    ),
    "a unit outside of its gap": (
        lambda: simulate(replace(SIVA, units=2), gap_displacement=[0.1, 9.0]),
        ValueError,
        ("start.0.1.gap_displacement = 9", "in the gap"),
    ),
    "places of one": (
        lambda: simulate(SIVA, gap_displacement=[0.1, 0.2]),
        ValueError,
        ("start.gap_displacement = [0.1, 0.2]", "one absorber", "one number"),
    ),
    "places of none": (
        lambda: simulate(None, gap_displacement=[0.1, 0.2]),
        ValueError,
        ("start.gap_displacement", "no absorber"),
    ),
    "a text among places": (
        lambda: iva.Start(gap_displacement=[0.1, "0.2"]),  # type: ignore[list-item,arg-type,unused-ignore]
        TypeError,
        ("start.gap_displacement[1]", "'0.2'", "number"),
    ),
    "nothing among places": (
        lambda: iva.Start(gap_velocity=[None, 0.2]),  # type: ignore[list-item,arg-type,unused-ignore]
        TypeError,
        ("start.gap_velocity[0]", "None", "number"),
    ),
    "a text as places": (
        lambda: iva.Start(gap_displacement="0.2"),  # type: ignore[arg-type,unused-ignore]
        TypeError,
        ("start.gap_displacement", "'0.2'"),
    ),
    "a table of places": (
        lambda: iva.Start(gap_displacement=np.zeros((2, 2))),  # type: ignore[arg-type,unused-ignore]
        TypeError,
        ("start.gap_displacement",),
    ),
    "nan among places": (
        lambda: simulate(TWO, gap_displacement=[0.1, float("nan")]),
        ValueError,
        ("gap_displacement", "NaN"),
    ),
    "endless among speeds": (
        lambda: simulate(TWO, gap_velocity=[float("inf"), 0.0]),
        ValueError,
        ("gap_velocity", "inf"),
    ),
    "outside of the second gap": (
        lambda: simulate(TWO, gap_displacement=[0.4, 0.3]),
        ValueError,
        ("start.1.gap_displacement = 0.3", "-0.2 to 0.2"),
    ),
    "outside of the first gap": (
        lambda: simulate(TWO, gap_displacement=[-0.6, 0.1]),
        ValueError,
        ("start.0.gap_displacement = -0.6", "-0.5 to 0.5"),
    ),
    "one place outside of the second gap": (
        lambda: simulate(TWO, gap_displacement=0.3),
        ValueError,
        ("start.1.gap_displacement = 0.3", "-0.2 to 0.2"),
    ),
    "outside by its offset": (
        lambda: simulate(
            [SIVA, iva.Siva(mass_ratio=0.1, clearance=0.2, restitution=0, gap_offset=1)]
        ),
        ValueError,
        ("absorber.1.gap_offset = 1",),
    ),
    "nothing of the second": (
        lambda: simulate([SIVA, iva.Siva(mass_ratio=0.1, restitution=0.5)]),
        ValueError,
        ("absorber.1", "clearance", "missing"),
    ),
    "no restitution of the first": (
        lambda: simulate([iva.Siva(mass_ratio=0.1, clearance=0.5), SIVA]),
        ValueError,
        ("absorber.0.restitution", "missing"),
    ),
    "an angle": (lambda: simulate(TWO, angle=0.1), ValueError, ("start.angle",)),
    "an axis of a sixth": (
        lambda: sweep({"absorber.5.clearance": [0.1]}),
        ValueError,
        ("absorber.5.clearance",),
    ),
    "an axis of a third": (
        lambda: sweep({"absorber.2.clearance": [0.1]}),
        ValueError,
        ("absorber.2.clearance",),
    ),
    "an axis of a third start": (
        lambda: sweep({"start.2.gap_displacement": [0.1]}),
        ValueError,
        ("start.2.gap_displacement",),
    ),
    "an axis of one and of all": (
        lambda: sweep({"clearance": [0.1], "absorber.1.clearance": [0.3]}),
        ValueError,
        ("absorber.1.clearance", "sweep.clearance"),
    ),
    "gravity on a level line": (
        lambda: simulate([SIVA, replace(NARROW, gravity=0.2)]),
        ValueError,
        ("absorber.1.gravity = 0.2", "inclination"),
    ),
    "an axis that is no number": (
        lambda: sweep({"absorber.first.clearance": [0.1]}),
        ValueError,
        ("absorber.first.clearance",),
    ),
    "an axis below zero": (
        lambda: sweep({"absorber.-1.clearance": [0.1]}),
        ValueError,
        ("absorber.-1.clearance",),
    ),
    "an axis with a slip": (
        lambda: sweep({"absorber.1.clearence": [0.1]}),
        ValueError,
        ("absorber.1.clearence", "no such field"),
    ),
    "an axis of one absorber": (
        lambda: sweep({"absorber.1.clearance": [0.1]}, SIVA),
        ValueError,
        ("absorber.1.clearance",),
    ),
    "an axis without absorber": (
        lambda: sweep({"absorber.0.clearance": [0.1]}, None),
        ValueError,
        ("absorber.0.clearance",),
    ),
    "a value out of range": (
        lambda: sweep({"absorber.1.clearance": [0.4, -0.1]}),
        ValueError,
        ("absorber.1.clearance[1] = -0.1", "greater than 0"),
    ),
    "a restitution out of range": (
        lambda: sweep({"absorber.0.restitution": [1.5]}),
        ValueError,
        ("absorber.0.restitution[0] = 1.5", "0 to 1"),
    ),
    "two axes for one": (
        lambda: sweep({"absorber.1.clearance": [0.1], "absorber.1.gap": [0.3]}),
        ValueError,
        ("absorber.1.gap", "absorber.1.clearance"),
    ),
    "a start outside at a point": (
        lambda: sweep({"start.1.gap_displacement": [0.1, 0.3]}),
        ValueError,
        ("start.1.gap_displacement = 0.3", "-0.2 to 0.2", "point 1"),
    ),
}


@pytest.mark.parametrize("what", CALLS)
def test_one_sentence_says_what_is_wrong(what: str) -> None:
    call, kind, pieces = CALLS[what]
    with pytest.raises(kind) as caught:
        call()
    said = str(caught.value)
    for internal in ("\n", "_iva", str(Path(iva.__file__).parent), "Traceback"):
        assert internal not in said
    for piece in pieces:
        assert piece in said
    assert len(said) < 300


def test_a_list_of_one_is_that_one() -> None:
    assert simulate([PIVA]).impacts.equals(simulate(PIVA).impacts)


def test_what_a_list_leaves_as_it_was() -> None:
    """Eight are allowed, and the list itself is not kept: a change of it changes no run."""
    row: list[Any] = [SIVA] * 8
    run = simulate(row)
    assert run.absorbers.height == 8
    shown = repr(run)
    row.clear()
    assert repr(run) == shown
    assert set(run.trajectory(10)["absorber"]) == set(range(8))
