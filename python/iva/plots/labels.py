"""What axes say: a name, a symbol and a unit for every column and every parameter."""

from __future__ import annotations

import re

#: Name of a column or of a swept parameter → words and symbol.
NAMES = {
    "point": ("point", ""),
    "impacts": ("number of impacts", ""),
    "effective_impacts": ("number of effective impacts", ""),
    "episodes": ("stays on a wall", ""),
    "undecided": ("undecided contacts", ""),
    "time_stuck": ("time stuck", "t"),
    "damping_ratio_1": ("damping ratio, 1 cycle,", "ζ₁"),
    "damping_ratio_3": ("damping ratio, 3 cycles,", "ζ₃"),
    "damping_ratio_10": ("damping ratio, 10 cycles,", "ζ₁₀"),
    "damping_ratio_fit": ("damping ratio, fitted,", "ζ"),
    "damping_ratio_energy": ("damping ratio, by energy,", "ζ"),
    "settling_time_10": ("10 % settling time", "t₁₀"),
    "settling_time_5": ("5 % settling time", "t₅"),
    "settling_time_2": ("2 % settling time", "t₂"),
    "residual_amplitude": ("residual amplitude over", "A₀"),
    "energy_initial": ("initial energy", "E"),
    "energy_impacts": ("energy lost in impacts", "E"),
    "energy_viscous": ("energy lost in the damper", "E"),
    "energy_pivot": ("energy lost in pivot or dashpot", "E"),
    "energy_friction": ("energy lost in friction", "E"),
    "stops": ("stops in the gap", ""),
    "time_held": ("time held in the gap", "t"),
    "energy_final": ("final energy", "E"),
    "energy_work": ("work of the force", "W"),
    "energy_residual": ("residual of the energies", "E"),
    "amplitude_max": ("amplitude", "max |x|"),
    "amplitude_rms": ("rms amplitude", "x"),
    "reduction": ("reduction of the amplitude", ""),
    "transmissibility": ("transmissibility", ""),
    "impacts_per_cycle": ("impacts per cycle", ""),
    "approach_speed_max": ("hardest approach", "max |w|"),
    "impulse_max": ("hardest impact", "J"),
    "peak_force_estimate": ("largest force, estimated,", "F"),
    "reduction_rms": ("reduction of the rms amplitude", ""),
    "acceleration_max": ("largest acceleration", "max |a|"),
    "gap_displacement_max": ("largest gap displacement", "max |y|"),
    "stroke": ("stroke", ""),
    "absorber_displacement_max": ("largest displacement of the absorber", "max |x₁|"),
    "time_near_wall": ("time close to a wall", ""),
    "condition": ("condition", ""),
    "digits": ("digits", ""),
    "mass_ratio": ("mass ratio", "μ = m/M"),
    "restitution": ("restitution", "e"),
    "relative_clearance": ("relative clearance", "γ = d/x₀"),
    "clearance": ("clearance", "d"),
    "clearance_mm": ("clearance", "d"),
    "gap": ("total play", "2d"),
    "gap_mm": ("total play", "2d"),
    "units": ("number of units", "n"),
    "clearance_spread": ("spread of the clearances", ""),
    "reference_speed": ("reference speed", "u₀"),
    "restitution_exponent": ("exponent of the restitution", "b"),
    "yield_speed": ("yield speed", "u₁"),
    "frequency_ratio": ("frequency ratio", "r = ωₚ/ωₙ"),
    "length": ("length", "L"),
    "gravity": ("gravity", "g"),
    "inclination": ("inclination", "α"),
    "inclination_deg": ("inclination", "α"),
    "inertia_ratio": ("inertia ratio", "κ"),
    "contact_distance": ("contact distance", "b"),
    "pivot_damping_ratio": ("pivot damping ratio", "ζₚ"),
    "spring_ratio": ("spring ratio", "σ = ωₛ/ωₙ"),
    "absorber.mass": ("absorber mass", "m"),
    "primary.mass": ("primary mass", "M"),
    "damping_ratio": ("damping ratio", "ζ"),
    "damping": ("damping", "c"),
    "stiffness": ("stiffness", "k"),
    "natural_frequency": ("natural frequency", "ωₙ"),
    "primary.frequency_hz": ("natural frequency", "fₙ"),
    "force.amplitude": ("force over mass", "F/M"),
    "force.force": ("force", "F"),
    "force.base_acceleration": ("base acceleration", "a"),
    "force.base_velocity": ("base velocity", "V"),
    "force.base_displacement": ("base displacement", "X"),
    "force.base_displacement_mm": ("base displacement", "X"),
    "force.frequency": ("force frequency", "Ω"),
    "force.relative_frequency": ("force frequency", "Ω/ωₙ"),
    "force.frequency_hz": ("force frequency", "Ω/2π"),
    "force.phase": ("phase of the force", "φ"),
    "force.velocity": ("impulse over mass", "P/M"),
    "force.impulse": ("impulse", "P"),
    "force.time": ("time of the impulse", "t"),
    "force.scale": ("scale of the record", ""),
    "displacement": ("start displacement", "x₀"),
    "displacement_mm": ("start displacement", "x₀"),
    "velocity": ("start velocity", "ẋ₀"),
    "impulse": ("impulse of the shock", "P"),
    "impulse_velocity": ("impulse over mass", "P/M"),
    "gap_displacement": ("start gap displacement", "y₀"),
    "gap_velocity": ("start gap velocity", "w₀"),
    "angle": ("start angle", "θ₀"),
    "angular_velocity": ("start angular velocity", "θ̇₀"),
    "chatter_floor": ("chatter floor", "w"),
}


def unit_text(unit: str) -> str:
    """Return the unit of a column as it is drawn.

    Examples
    --------
    >>> unit_text("length of displacement · ωn")
    'unit of length · ωₙ'
    """
    return unit.replace("length of displacement", "unit of length").replace("ωn", "ωₙ")


def labelled(words: str, symbol: str, unit: str) -> str:
    """Return words, symbol and unit; dimensionless quantities say so by their symbol.

    Examples
    --------
    >>> labelled("time", "t", "s"), labelled("time", "t", "1/ωn"), labelled("restitution", "e", "1")
    ('time t (s)', 'time ωₙt', 'restitution e')
    """
    if unit == "1/ωn" and symbol:
        return f"{words} ωₙ{symbol}"
    if unit == "ωn" and symbol:
        return f"{words} {symbol}/ωₙ"
    name = f"{words} {symbol}" if symbol else words
    return name if unit in ("", "1") else f"{name} ({unit_text(unit)})"


def of_column(name: str, unit: str) -> str:
    """Return the label of a column of the summary, or of :func:`iva.robust`.

    Examples
    --------
    >>> of_column("relative_clearance", "1"), of_column("force.0.frequency_hz", "Hz")
    ('relative clearance γ = d/x₀', 'force frequency Ω/2π (Hz)')
    >>> of_column("amplitude_max_q90", "m").rpartition(", ")[2]
    '90 % of the neighbours'
    """
    base, judged = judgement(name)
    words, symbol = named(base)
    return labelled(words, symbol, unit) + judged


def judgement(name: str) -> tuple[str, str]:
    """Return the measure that a column of :func:`iva.robust` is of, and what it is of that.

    Examples
    --------
    >>> judgement("settling_time_5_worst"), judgement("settling_time_5")
    (('settling_time_5', ', worst of the neighbours'), ('settling_time_5', ''))
    """
    found = re.fullmatch(r"(.+)_(?:worst|q([0-9.]+))", name)
    if found is None:
        return name, ""
    base, share = found.groups()
    return base, f", {share} % of the neighbours" if share else ", worst of the neighbours"


def symbol_of(name: str, unit: str) -> str:
    """Return what stands above the entries of a legend: the symbol alone, or the words.

    Examples
    --------
    >>> symbol_of("mass_ratio", "1"), symbol_of("gap_mm", "mm"), symbol_of("digits", "1")
    ('μ', '2d (mm)', 'digits')
    """
    return labelled(short(name), "", unit)


def valued(name: str, unit: str, value: float) -> str:
    """Return the entry of a legend: a parameter with its value.

    Examples
    --------
    >>> valued("displacement_mm", "mm", 10.0), valued("mass_ratio", "1", 0.05)
    ('x₀ = 10 mm', 'μ = 0.05')
    """
    return f"{short(name)} = {value:g}" + ("" if unit in ("", "1") else f" {unit_text(unit)}")


def short(name: str) -> str:
    """Return the symbol of a column, or its words if it has none."""
    words, symbol = named(name)
    return symbol.partition(" = ")[0] or words


def named(name: str) -> tuple[str, str]:
    """Return words and symbol of a column.

    Examples
    --------
    >>> named("absorber.1.clearance"), named("force.0.frequency")
    (('clearance 1', 'd[1]'), ('force frequency', 'Ω'))
    """
    # Of several: force.0.frequency, absorber.1.mass; the part may stand before a unique name.
    numbered = re.fullmatch(r"(force|absorber|start)\.(\d+)\.(.+)", name)
    plain = f"{numbered[1]}.{numbered[3]}" if numbered else name
    for key in (plain, plain.partition(".")[2]):
        if key in NAMES:
            words, symbol = NAMES[key]
            if numbered and numbered[1] != "force":
                # Its equation would need the number as well.
                return f"{words} {numbered[2]}", f"{symbol.partition(' = ')[0]}[{numbered[2]}]"
            return words, symbol
    return name.replace("_", " "), ""
