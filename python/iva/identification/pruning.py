"""Impacts that are none, and what the pulses of the others say of their contacts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from iva.identification.chains import VARIANCE
from iva.identification.pulses import Shape
from iva.identification.records import RELEASE, Inputs, Recording
from iva.identification.refining import Refined

#: Deviations of a jump that is one.
SURE = 5.0
#: Standard deviation of the variances of contacts about their mean, in samples², at first and at
#: least.
WIDTHS, LEAST_WIDTHS = 0.02, 1e-4


def pruned(recording: Recording, refined: Refined) -> Inputs:
    """Return the numbers without impacts that are none.

    These have left the record, or have a jump that is not clear of zero; two at one place are one.
    """
    inputs = refined.inputs
    own = np.sqrt(np.diag(refined.covariance)[inputs.impacts][inputs.times.size :])
    times, jumps = inputs.times.copy(), inputs.jumps.copy()
    keep = (times > inputs.head[RELEASE]) & (times < recording.time[-1])
    clear = np.abs(jumps) > SURE * own
    for hit in np.argsort(np.abs(jumps)):
        near = np.abs(times - times[hit]) < 2.0 / recording.sampling_hz
        near &= keep & (np.abs(jumps) >= np.abs(jumps[hit]))
        near[hit] = False
        if keep[hit] and near.any():
            # Neither is clear of zero while they stand for each other.
            other = int(np.argmax(near))
            both = jumps[hit] + jumps[other]
            times[other] += (times[hit] - times[other]) * jumps[hit] / both
            jumps[other], keep[hit], clear[other] = both, False, True
    keep &= clear
    if np.all(keep) or not np.any(keep):
        return inputs
    widths = inputs.widths[keep] if inputs.widths.size else inputs.widths
    return replace(inputs, times=times[keep], jumps=jumps[keep], widths=widths)


def with_contact(recording: Recording, inputs: Inputs) -> tuple[Recording, Inputs]:
    """Return the record and its numbers with the contact that the widths of all pulses tell.

    Of a contact shorter than two samples, pulses without a filter tell no length: only their area,
    which is the jump in the motion, does.
    """
    shape = recording.shape
    if shape is None or shape.chain.kind != "none" or not inputs.times.size:
        return recording, inputs
    more = float(np.average(inputs.widths, weights=inputs.jumps**2))
    length = shape.chain.contact
    longer = np.sqrt(max(length**2 + more / VARIANCE, 0.25 * length**2))
    longer = float(np.clip(longer, 0.8 * length, 1.25 * length))
    more = VARIANCE * (longer**2 - length**2)
    chain = replace(shape.chain, contact=longer)
    inputs = replace(inputs, widths=inputs.widths - more)
    half = float(np.max(shape.splines)) if shape.half is None else shape.half
    return replace(recording, shape=Shape(chain, half)), inputs


def spread_of_widths(refined: Refined) -> float:
    """Return the standard deviation of the variances of contacts, the most likely one."""
    widths = refined.inputs.widths
    if not widths.size:
        return WIDTHS
    own = np.diag(refined.covariance)[-widths.size :]
    return max(float(np.sqrt(np.mean(widths**2 + own))), LEAST_WIDTHS)


__all__ = ["WIDTHS", "pruned", "spread_of_widths", "with_contact"]
