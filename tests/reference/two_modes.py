"""A free mass on a structure with two modes: by SciPy's DOP853, then to 30 digits with mpmath.

Usage: two_modes.py > two_modes.json

The structure has mass-normalised modes q_i'' + 2 zeta_i omega_i q_i' + omega_i^2 q_i = 0, and
x = sum phi_i q_i where the absorber is. In flight the absorber moves uniformly. An impact with the
gap velocity w has the impulse P = (1 + e) w / (1/mu + sum phi_i^2) on the structure, so each q_i'
gains phi_i P and the absorber loses P/mu.

The integrator finds the impacts: an event is looked for on the dense output of short steps. Their
instants are then solved with 40 digits from the closed form of the flights between them, and must
agree within 1e-9. Prints instant, wall, x and approach speed of the first impacts.
"""

import json

import mpmath as mp
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

OMEGA = np.array([1.0, 2.7])
ZETA = np.array([0.02, 0.03])
PHI = np.array([1.0, 0.6])
MU, E, D = 0.1, 0.7, 0.4
COUNT = 20

mp.mp.dps = 40
OMEGAS, ZETAS, PHIS = ([mp.mpf(it) for it in its.split()] for its in ("1 2.7", "0.02 0.03", "1 0.6"))
MASS, RESTITUTION, CLEARANCE = map(mp.mpf, "0.1 0.7 0.4".split())


def rates(_t, z):
    q, v = z[0:2], z[2:4]
    return np.concatenate([v, -2.0 * ZETA * OMEGA * v - OMEGA**2 * q, [z[5], 0.0]])


def gap(z):
    return z[4] - PHI @ z[0:2]


def integrated():
    z, t, impacts = np.array([1.0, -0.3, 0.0, 0.0, 1.0 - 0.18, 0.0]), 0.0, []
    last = 0.0
    while len(impacts) < COUNT:
        run = solve_ivp(
            rates, (0.0, 0.02), z, "DOP853", rtol=2.3e-14, atol=1e-16, dense_output=True
        )
        times = np.linspace(0.0, 0.02, 21)
        for a, b in zip(times, times[1:]):
            low, high = (abs(gap(run.sol(h))) - D for h in (a, b))
            # Right after an impact the distance begins at 0, on either side of it.
            if high > 0.0 and (low < 0.0 or (a == 0.0 and t == last)):
                if low >= 0.0 and t == last:
                    low_time = 1e-9
                    if abs(gap(run.sol(low_time))) >= D:
                        continue
                    a = low_time
                h = brentq(lambda h: abs(gap(run.sol(h))) - D, a, b, xtol=1e-16, rtol=1e-15)
                z = solve_ivp(rates, (0.0, h), z, "DOP853", rtol=2.3e-14, atol=1e-16).y[:, -1]
                t += h
                v = PHI @ z[2:4]
                w = z[5] - v
                wall = 1 if gap(z) > 0.0 else -1
                impacts.append([t, wall, float(PHI @ z[0:2]), abs(w)])
                p = (1.0 + E) * w / (1.0 / MU + PHI @ PHI)
                z[2:4] += PHI * p
                z[5] -= p / MU
                last = t
                break
        else:
            z, t = run.y[:, -1], t + 0.02
    return impacts


def flown(modes, h):
    """Return q_i and q_i' after a time h of free motion."""
    later = []
    for (q, v), w, zeta in zip(modes, OMEGAS, ZETAS):
        rate, damped = zeta * w, w * mp.sqrt(1 - zeta**2)
        decay, c, s = mp.exp(-rate * h), mp.cos(damped * h), mp.sin(damped * h)
        x = decay * (q * c + (v + rate * q) / damped * s)
        later.append((x, decay * (v * c - (w**2 * q + rate * v) / damped * s)))
    return later


def seen(modes, k):
    return sum(phi * mode[k] for phi, mode in zip(PHIS, modes))


def polished(impacts):
    modes, place, speed, t = [(mp.mpf(1), mp.mpf(0)), (mp.mpf("-0.3"), mp.mpf(0))], None, 0, 0
    place = seen(modes, 0)
    for near, wall, *_ in impacts:
        after = lambda h: place + speed * h - seen(flown(modes, h), 0)
        h = mp.findroot(lambda h: wall * after(h) - CLEARANCE, near - t)
        assert abs(t + h - near) < 1e-9
        modes, place, t = flown(modes, h), place + speed * h, t + h
        w = speed - seen(modes, 1)
        yield [float(it) for it in (t, wall, seen(modes, 0), abs(w))]
        p = (1 + RESTITUTION) * w / (1 / MASS + sum(phi**2 for phi in PHIS))
        modes = [(q, v + phi * p) for (q, v), phi in zip(modes, PHIS)]
        speed -= p / MASS


print(json.dumps(list(polished(integrated())), indent=1))
