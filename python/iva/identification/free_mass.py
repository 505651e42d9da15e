"""The identification of a free mass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from iva.identification.adequacy import (
    contact_law,
    cut_off,
    law_of_restitution,
    lines_of,
    unexplained,
)
from iva.identification.combinations import in_words, null_directions
from iva.identification.expected import HEADS, pull_of
from iva.identification.explaining import Explained, with_chain
from iva.identification.fits import Found
from iva.identification.growing import settled
from iva.identification.posterior import Beliefs, Draws, about, best_scatter, from_priors, sampled
from iva.identification.priors import Bell, Exactly
from iva.identification.records import HEAD, OMEGA, RELEASE, SIZE, ZETA, Recording
from iva.identification.responses import Values
from iva.identification.stages import FOUND, INTERRUPTED, LOOKED, SAMPLED, Tell
from iva.identification.stated import Stated
from iva.identification.trails import Told, trailed
from iva.identification.verdicts import check
from iva.identification.walls import Absorber, Contacts, contacts, kept, mixed, residuals

NO_TRAIL = (
    "most impacts do not follow from those before as those of a free mass, so that nothing is "
    "known of the absorber"
)
#: Draws of the record's own numbers.
DRAWS = 500
#: Scatter and play with which each impact is looked at by itself.
UNTIED = {"scatter": 0.3, "play": 2e-3}


def identified(
    recording: Recording,
    clock: float,
    floor: float,
    known: Stated,
    seed: int,
    tell: Tell,
) -> Found:
    """Return what a record says of a free mass.

    Parameters
    ----------
    recording : Recording
        Its time begins with 0.
    clock : float
        Instant of the first sample on the clock of the record in s.
    floor : float
        Least standard deviation of the noise.
    known : Stated
        What is known beforehand.
    seed : int
        Of the sampler.
    tell : callable
        Told how many stages have ended.

    Raises
    ------
    ValueError
        If no impact is found, they do not follow each other as those of a free mass, or the record
        is a displacement.
    """
    if recording.order == 0:
        # Its kinks are too weak: jumps and instants of neighbours stand in for each other.
        raise ValueError(
            "record.quantity = 'displacement': of a free mass give an acceleration or a velocity"
        )
    chain, given = "", known.exactly("release")
    recording = replace(recording, blow=known.blow)
    recording = with_chain(recording, None if given is None else given - clock)
    if recording.shape is not None:
        # A filter that delays the motion delays the clock.
        clock -= recording.shape.chain.delay / recording.sampling_hz
        chain = recording.shape.chain.words(recording.sampling_hz)
    check(recording, None if given is None else given - clock, clock, floor)
    tell(LOOKED)
    told = trailed(recording, clock, floor, known)
    done = (recording, clock, floor, known, seed, told, chain)
    try:
        return concluded(*done, None if told.interrupted else tell)
    except KeyboardInterrupt:
        return concluded(*done, None)


def concluded(
    recording: Recording,
    clock: float,
    floor: float,
    known: Stated,
    seed: int,
    told: Told,
    chain: str,
    tell: Tell | None,
) -> Found:
    """Return what a trail of impacts says of a free mass.

    Without `tell` the identification was interrupted: the sampler, which takes long, is left out.
    """
    notes, reasons = list(told.notes), [] if told.follow else [NO_TRAIL]
    shown, best, beliefs = told.trail.shown, told.trail.grown, told.trail.beliefs
    inputs, covariance = shown.refined.inputs, shown.refined.covariance
    pull = pull_of(beliefs)
    gap_velocity = known.taken.get("gap_velocity", 0.0)
    used = contacts(inputs, covariance, best.hits, gap_velocity)
    middle, _ = best_scatter(used, best.absorber, pull)
    # The walls move the record's numbers a little: the conditions are linearised there.
    moved = inputs.vector()
    places = kept(inputs.times.size, best.hits)
    moved[places] += shift(used, middle, covariance[np.ix_(places, places)])
    used = contacts(inputs, covariance, best.hits, gap_velocity, moved)
    if tell is None:
        drawn = about(used, beliefs, middle, pull, seed)
        reasons.append(INTERRUPTED)
    else:
        tell(FOUND)
        # Of few impacts that most others do not follow little is learned, and it takes long.
        if told.follow:
            drawn = sampled(used, beliefs, middle, pull, seed)
        else:
            drawn = from_priors(beliefs, seed)
        tell(SAMPLED)
    head, each = together(
        used, drawn, inputs.vector()[places], covariance[np.ix_(places, places)], seed
    )
    release = head[:, RELEASE] + clock
    draws = {
        "frequency_hz": head[:, OMEGA] / (2 * np.pi),
        "damping_ratio": head[:, ZETA],
        "mass_ratio": 1 / drawn.numbers[:, 0],
        "restitution": drawn.numbers[:, 3],
        "gap": 2 * drawn.numbers[:, 1],
        "impulse_velocity" if known.blow else "displacement": head[:, SIZE],
        "gap_displacement": drawn.numbers[:, 2],
        "release": release,
        "restitution_scatter": drawn.numbers[:, 4],
    }
    each[:, 0] += clock
    keep = believed(draws, known, seed)
    draws = {name: values[keep] for name, values in draws.items()}
    each = each[keep]
    words: tuple[str, ...] = ()
    if drawn.possible:
        words = combinations_of(used, middle, pull, beliefs)
    elif told.follow:
        reasons.append(
            "the first impacts are those of no free mass, so that nothing is known of the absorber"
        )
    rest = shown.recording.values - shown.recording.model(inputs)
    reasons += unexplained(shown.recording.values, rest, shown.mask & quiet(shown), floor)
    reasons += cut_off(recording.values)
    if drawn.possible:
        reasons += judged(shown, used, middle, pull, drawn)
    if shown.modes_hz:
        listed = " and ".join(f"{hertz:.3g} Hz" for hertz in shown.modes_hz)
        notes.append(f"ringing at {listed} after each impact was fitted along")
    slopes = shown.recording.jacobian(inputs)
    own = np.einsum("ij,ij->i", slopes @ covariance, slopes)
    sigma = np.hypot(shown.noise, shown.roughness * shown.recording.reach(inputs))
    after = recording.time.size - shown.recording.time.size

    def filled(values: Values) -> Values:
        made: Values = np.pad(values, (0, after), constant_values=np.nan)
        return made

    return Found(
        draws=draws,
        each=each,
        walls=used.walls,
        prediction=filled(shown.recording.model(inputs)),
        own=filled(np.sqrt(np.maximum(own, 0.0))),
        sigma=filled(sigma),
        mask=np.pad(shown.mask, (0, after), constant_values=False),
        noise=shown.noise,
        combinations=words,
        reasons=tuple(reasons),
        notes=tuple(notes),
        chain=chain,
    )


def shift(found: Contacts, absorber: Absorber, covariance: Values) -> Values:
    """Return by how much the walls move the numbers of the record, shape (p,)."""
    rest, spread = residuals(found, absorber)
    mixture = slopes_of(found, absorber)
    moved: Values = -covariance @ mixture.T @ np.linalg.solve(spread, rest)
    return moved


def slopes_of(found: Contacts, absorber: Absorber) -> Values:
    """Return the derivatives of the conditions by the numbers of the record, shape (2 k, p)."""
    pair = np.stack(mixed(absorber.heaviness, absorber.restitution))
    made = np.tensordot(pair, found.slopes, axes=(1, 0))
    return made.reshape(-1, made.shape[-1])


def together(
    found: Contacts, drawn: Draws, numbers: Values, covariance: Values, seed: int
) -> tuple[Values, Values]:
    """Return draws of the record's numbers that go with draws of the absorber.

    A draw from the record alone is moved onto the conditions (Matheron's rule).

    Returns
    -------
    head : ndarray, shape (n, 5)
    each : ndarray, shape (n, 4, k)
        Instant, jump, approach speed and restitution of the impacts.
    """
    random = np.random.default_rng(seed + 1)
    hits = found.walls.size
    rows = random.permutation(len(drawn.numbers))[: min(DRAWS, len(drawn.numbers))]
    drawn.numbers[: rows.size] = drawn.numbers[rows]
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0))
    head, each = np.empty((rows.size, HEAD)), np.empty((rows.size, 4, hits))
    for row in range(rows.size):
        absorber = drawn.absorber(row)
        rest, spread = residuals(found, absorber)
        mixture = slopes_of(found, absorber)
        by_record = np.einsum("ij,jk,ik->i", mixture, covariance, mixture)
        own = np.maximum(np.diag(spread) - by_record, 0.0)
        step = root @ random.standard_normal(numbers.size)
        rest = rest + mixture @ step + np.sqrt(own) * random.standard_normal(2 * hits)
        made = numbers + step
        if drawn.possible:
            made -= covariance @ mixture.T @ np.linalg.solve(spread, rest)
        head[row] = made[:HEAD]
        times, jumps = made[HEAD : HEAD + hits], made[HEAD + hits :]
        change = np.tensordot(found.slopes, made - numbers, axes=(2, 0))
        _, _, lost, speed, _ = found.values + change
        approach = speed - absorber.heaviness * lost
        e = jumps * (1 + absorber.heaviness) / approach - 1
        e = e if drawn.possible else np.full(hits, absorber.restitution)
        each[row] = times, jumps, np.abs(approach), e
    return head, each


def believed(draws: dict[str, Values], known: Stated, seed: int) -> np.ndarray:
    """Return rows to keep, so that priors of the record's numbers that are not normal count."""
    rows = next(iter(draws.values())).size
    weights = np.ones(DRAWS if rows > DRAWS else rows)
    for name in HEADS:
        prior = known.priors.get(name)
        if prior is None or isinstance(prior, Exactly):
            continue
        values = draws[name][: weights.size]
        density = np.exp([max(prior.log_density(float(value)), -700.0) for value in values])
        if isinstance(prior, Bell) and not prior.by_logarithm:
            density = (density > 1e-300).astype(float)  # its shape has been counted already
        weights *= density
    if weights.sum() <= 0 or np.sum(weights) ** 2 / np.sum(weights**2) < 5:
        raise ValueError("known: it contradicts the record; give wider distributions")
    if np.all(weights == weights[0]):
        return np.arange(weights.size)
    random = np.random.default_rng(seed + 2)
    return random.choice(weights.size, weights.size, p=weights / weights.sum())


def combinations_of(
    found: Contacts, middle: Absorber, pull: tuple[Values, Values], beliefs: Beliefs
) -> tuple[str, ...]:
    """Return what the record leaves open, in words."""
    absorber, _, information = settled(found, middle, pull)
    scale = np.array(
        [absorber.heaviness, absorber.clearance, absorber.clearance, absorber.restitution]
    )
    # 1/μ grows where μ falls.
    scale[0] *= -1
    each = (beliefs.mass_ratio, beliefs.clearance, beliefs.place, beliefs.restitution)
    free = [index for index, one in enumerate(each) if not isinstance(one, Exactly)]
    if not free:
        return ()
    names = ("mass_ratio", "gap", "rest position", "restitution")
    scaled = (information * np.outer(scale, scale))[np.ix_(free, free)]
    directions = null_directions(scaled)
    chosen = tuple(names[index] for index in free)
    return tuple(in_words(directions[:, column], chosen) for column in range(directions.shape[1]))


def quiet(shown: Explained) -> NDArray[np.bool_]:
    """Return which samples are away from pulses, shape (n,)."""
    far: NDArray[np.bool_] = shown.recording.reach(shown.refined.inputs) < shown.noise
    return far


def judged(
    shown: Explained, found: Contacts, middle: Absorber, pull: tuple[Values, Values], drawn: Draws
) -> list[str]:
    """Return what the record has that the model has not."""
    recording, inputs = shown.recording, shown.refined.inputs
    rest = recording.values - recording.model(inputs)
    hertz = float(inputs.head[OMEGA] / 2 / np.pi)
    reasons = lines_of(rest, recording.weights, recording.sampling_hz, hertz)
    untied, _, _ = settled(found, replace(middle, **UNTIED), pull)
    rest, spread = residuals(found, untied)
    hits = found.walls.size
    _, _, lost, speed, _ = found.values
    # What the record's own noise leaves of each rebound, once the walls are heard.
    by_noise = spread[hits:, hits:] - np.diag(
        (untied.scatter * untied.restitution * (speed - untied.heaviness * lost)) ** 2
    )
    cross = spread[hits:, :hits]
    solved = np.linalg.solve(spread[:hits, :hits], np.column_stack([cross.T, rest[:hits]]))
    by_noise = by_noise - cross @ solved[:, :-1]
    rebounds = rest[hits:] - cross @ solved[:, -1]
    approach = speed - untied.heaviness * lost
    restitutions = untied.restitution + rebounds / approach
    variances = np.maximum(np.diag(by_noise), 0.0) / approach**2
    reasons += law_of_restitution(np.abs(approach), inputs.times[:hits], restitutions, variances)
    scatter, play = np.quantile(drawn.numbers[:, 4:6], 0.1, axis=0)
    return reasons + contact_law(float(scatter), float(play))


__all__ = ["believed", "identified"]
