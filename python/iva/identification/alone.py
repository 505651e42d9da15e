"""The identification of a structure without an absorber."""

from __future__ import annotations

import numpy as np

from iva.identification.adequacy import cut_off, lines_of, unexplained
from iva.identification.beginnings import onset
from iva.identification.fits import Found
from iva.identification.modes import Decay, columns, decay_of, rates
from iva.identification.priors import Exactly
from iva.identification.records import TREND, Recording
from iva.identification.responses import Values
from iva.identification.stages import FOUND, Tell
from iva.identification.stated import Stated

#: Draws.
DRAWS = 2000
#: Samples of an acceleration after the release that a filter may have smeared.
SMEARED = 40
#: Least length of a record after the release in periods.
PERIODS = 4.0
#: Deviations, and share of the damping, from which damping depends on the amplitude.
CLEAR = 5.0
SHARE = 0.1
#: Least number of periods whose amplitudes tell that.
ENOUGH = 8
#: Phase in rad within which a structure that was let go is at rest, and what is left of its speed.
NEAR = 0.3
AT_REST = 1e-6
#: Logarithm of a density below that in the middle, from which a distribution is contradicted.
FAR = 18.0
#: What may be known of a structure alone.
KNOWN = {"frequency_hz", "damping_ratio", "displacement", "release"}


def identified(
    recording: Recording,
    clock: float,
    floor: float,
    known: Stated,
    seed: int,
    tell: Tell,
) -> Found:
    """Return what a record says of a structure without an absorber.

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
        Of the draws.
    tell : callable
        Told how many stages have ended.

    Raises
    ------
    ValueError
        If nothing oscillates, the record is too short, or what is known is of an absorber or
        contradicts the record.
    """
    for name in {*known.priors, *known.taken} - KNOWN:
        raise ValueError(f"{name}: it is of an absorber, and there is none; leave it out")
    rate, given = recording.sampling_hz, known.exactly("release")
    begin = onset(recording.values, rate, recording.order) if given is None else given - clock
    released = begin is not None
    begin = 0.0 if begin is None else begin
    smeared = SMEARED if recording.order == 2 else 2
    first = max(int(np.ceil(begin * rate)) + smeared * released, 0)
    made = decay_of(recording, min(first, recording.time.size - 99), floor, fixed_of(known))
    if not made.omegas.size:
        raise ValueError("record: nothing in it oscillates; give a decay of the structure")
    hertz = float(made.omegas[0]) / 2 / np.pi
    periods = float(recording.time[-1] - recording.time[first]) * hertz
    if periods < PERIODS:
        raise ValueError(
            f"record: it has {periods:.2g} periods of the structure; give at least {PERIODS:g}"
        )
    tell(FOUND)
    noise = max(made.noise, floor)
    slopes, covariance = linearised(recording, made, noise, fixed_of(known))
    random = np.random.default_rng(seed)
    pick = np.array([0, 1, 2, 3])
    root = np.linalg.cholesky(covariance[np.ix_(pick, pick)] + 1e-300 * np.eye(4))
    moved = random.standard_normal((DRAWS, 4)) @ root.T
    draws = numbers_of(recording, made, moved, begin, released and given is None)
    draws["release"] += clock
    speed = 2 * np.pi * hertz * np.abs(draws["displacement"])
    if given is not None or np.all(np.abs(draws["velocity"]) < AT_REST * speed):
        del draws["velocity"]
    draws = believed(draws, known, seed)
    reasons = amplitude_law(recording, made)
    every = np.ones(made.rest.size, bool)
    if unexplained(recording.values[first:], made.rest, every, floor):
        reasons.append(
            f"{made.noise / float(np.std(recording.values[first:])):.0%} of the record is neither "
            "a decaying oscillation nor noise, such as impacts or a second event"
        )
    reasons += cut_off(recording.values)
    weights = np.full(made.rest.size, 1 / noise)
    reasons += lines_of(made.rest, weights, rate, hertz)
    others = " and ".join(f"{omega / 2 / np.pi:.4g} Hz" for omega in made.omegas[1:])
    own = np.sqrt(np.maximum(np.einsum("ij,ij->i", slopes @ covariance, slopes), 0.0))
    before = np.full(first, np.nan)
    return Found(
        draws=draws,
        each=np.zeros((DRAWS, 4, 0)),
        walls=np.zeros(0),
        prediction=np.concatenate([before, recording.values[first:] - made.rest]),
        own=np.concatenate([before, own]),
        sigma=np.full(recording.time.size, noise),
        mask=np.arange(recording.time.size) >= first,
        noise=noise,
        combinations=(),
        reasons=tuple(reasons),
        notes=(f"oscillations at {others} were fitted along",) if others else (),
    )


def fixed_of(known: Stated) -> tuple[float | None, float | None]:
    """Return frequency in rad/s and damping ratio where they are known exactly."""
    hertz = known.exactly("frequency_hz")
    return None if hertz is None else 2 * np.pi * hertz, known.exactly("damping_ratio")


def linearised(
    recording: Recording, made: Decay, noise: float, fixed: tuple[float | None, float | None]
) -> tuple[Values, Values]:
    """Return the derivatives of the record by all its numbers (n, p), and their covariance (p, p).

    The first four are ω, ζ, and the cosine and sine share of the structure.
    """
    time = recording.time[made.first :] - recording.time[made.first]
    trends = np.delete(recording.trends[made.first :], np.arange(recording.powers, TREND), axis=1)
    waves = columns(time, made.omegas, made.dampings)
    many = made.omegas.size
    parts = []
    for mode in range(many):
        wave = made.shares[mode] * (waves[:, mode] - 1j * waves[:, many + mode])
        omega, damping = made.omegas[mode], made.dampings[mode]
        bent = -1 - 1j * damping / np.sqrt(1 - damping**2)
        by_omega = wave * time * rates(made.omegas, made.dampings)[mode] / omega
        by_damping = wave * time * omega * bent
        parts += [by_omega.real, by_damping.real, waves[:, mode], waves[:, many + mode]]
    slopes = np.column_stack([*parts, trends])
    for place, value in enumerate(fixed):
        if value is not None:
            slopes[:, place] = 0.0
    scale = np.linalg.norm(slopes, axis=0)
    scale[scale == 0.0] = 1.0
    inverse = np.linalg.pinv((slopes / scale).T @ (slopes / scale), hermitian=True, rcond=1e-13)
    variance = noise**2 * colour(made, recording.sampling_hz)
    return slopes, variance * inverse / np.outer(scale, scale)


def colour(made: Decay, sampling_hz: float) -> float:
    """Return the power of what is left over near the structure's line over that elsewhere, ≥ 1."""
    power = np.abs(np.fft.rfft(made.rest * np.hanning(made.rest.size))) ** 2
    hertz = np.fft.rfftfreq(made.rest.size, 1 / sampling_hz)
    ratio = hertz / (made.omegas[0] / 2 / np.pi)
    near = (ratio > 0.5) & (ratio < 1.5)
    if not near.any() or not power.sum() > 0:
        return 1.0
    return max(float(np.mean(power[near]) / np.mean(power)), 1.0)


def numbers_of(
    recording: Recording, made: Decay, moved: Values, begin: float, rest: bool
) -> dict[str, Values]:
    """Return frequency, damping ratio, displacement (m), velocity (m/s), and their instant.

    Parameters
    ----------
    recording : Recording
        The record.
    made : Decay
        What it is made of.
    moved : ndarray, shape (n, 4)
        Changes of ω, ζ, cosine and sine share.
    begin : float
        The instant from the first sample in s.
    rest : bool
        Whether that is taken at which the structure is at rest, if one is near.
    """
    omega, damping = made.omegas[0] + moved[:, 0], made.dampings[0] + moved[:, 1]
    share = made.shares[0] + moved[:, 2] + 1j * moved[:, 3]
    rate = rates(omega, damping)
    place = share / rate**recording.order * np.exp(rate * (begin - recording.time[made.first]))
    later = np.zeros(omega.size)
    if rest:
        # Re(λ c exp(λ τ)) = 0, the root next to τ = 0.
        phase = np.angle(rate * place) - np.pi / 2
        later = -(phase - np.pi * np.round(phase / np.pi)) / rate.imag
        later = later if np.all(np.abs(later * rate.imag) < NEAR) else np.zeros(omega.size)
    place = place * np.exp(rate * later)
    return {
        "frequency_hz": omega / 2 / np.pi,
        "damping_ratio": damping,
        "displacement": place.real,
        "velocity": (rate * place).real,
        "release": begin + later,
    }


def believed(draws: dict[str, Values], known: Stated, seed: int) -> dict[str, Values]:
    """Return draws that the distributions of what is known have weighed.

    Raises
    ------
    ValueError
        If hardly any is left.
    """
    weights = np.zeros(DRAWS)
    for name, prior in known.priors.items():
        if isinstance(prior, Exactly):
            continue
        each = np.array([prior.log_density(float(value)) for value in draws[name]])
        if not np.max(each) > prior.log_density(prior.at(0.5)) - FAR:
            raise ValueError(f"known: its {name} contradicts the record; give a wider distribution")
        weights += each
    if not np.any(weights):
        return draws
    weights = np.exp(weights - np.max(weights))
    if np.sum(weights) ** 2 < 5 * np.sum(weights**2):
        raise ValueError("known: it contradicts the record; give wider distributions")
    random = np.random.default_rng(seed + 1)
    rows = random.choice(DRAWS, DRAWS, p=weights / weights.sum())
    return {name: values[rows] for name, values in draws.items()}


def amplitude_law(recording: Recording, made: Decay) -> list[str]:
    """Return whether damping depends on the amplitude, in words; empty if it does not.

    The amplitude A of each period follows from what is left without the other oscillations. Its
    logarithm is a straight line in time if damping is viscous; a curve in it tells.
    """
    time = recording.time[made.first :] - recording.time[made.first]
    omega, damping = float(made.omegas[0]), float(made.dampings[0])
    if damping <= 0:
        return ["the record is not a decay: its motion does not get smaller"]
    turning = np.exp(1j * omega * time)
    own = (made.shares[0] * np.exp(rates(made.omegas, made.dampings)[0] * time)).real + made.rest
    each = max(round(2 * np.pi / omega * recording.sampling_hz), 2)
    count = own.size // each
    if count < ENOUGH:
        return []
    turned = (own * turning.conj())[: count * each].reshape(count, each).mean(axis=1)
    amplitude = 2 * np.abs(turned)
    # What neighbours have in common is motion: second differences leave noise, √6 times.
    error = 2 * float(np.median(np.abs(np.diff(turned, 2)))) / np.sqrt(6)
    error = max(error, 1e-6 * float(amplitude[0]))
    use = np.cumprod(amplitude > 8 * error).astype(bool)
    if use.sum() < ENOUGH:
        return []
    amplitude = amplitude[use]
    at = (np.arange(use.sum()) + 0.5) * each / recording.sampling_hz
    middle = at - at.mean()
    design = np.column_stack([np.ones(at.size), middle, middle**2 / 2])
    weight = amplitude / error
    inverse = np.linalg.inv((design * weight[:, None] ** 2).T @ design)
    line = inverse @ ((design * weight[:, None] ** 2).T @ np.log(amplitude))
    rest = (np.log(amplitude) - design @ line) * weight
    _, slope, bend = map(float, line)
    blur = np.sqrt(inverse[2, 2] * max(1.0, float(np.mean(rest**2))))
    begin, end = (-(slope + bend * middle[place]) / omega for place in (0, -1))
    if abs(bend) < CLEAR * blur or abs(end - begin) < SHARE * damping:
        return []
    sizes = 1e3 * amplitude[[0, -1]] / omega**recording.order
    told = (
        f"the damping ratio is about {begin:.2g} at {sizes[0]:.2g} mm and {end:.2g} at "
        f"{sizes[1]:.2g} mm"
    )
    if end > begin:
        return [f"damping depends on amplitude: {told}; dry friction rises so as motion dies"]
    return [f"damping depends on amplitude: {told}; an absorber or air drag falls so"]


__all__ = ["identified"]
