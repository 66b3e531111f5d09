"""Cases for functions: every argument of every entry, with values that it must not take.

A case is (entry, argument, bad value, what the sentence has to contain besides the argument's name).  Most follow from
the kind of the argument; `KINDS` says which values are bad for a kind, `OWN` what an argument has beyond it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from entries import ENTRIES

NAN, INF = math.nan, math.inf
HUGE = 10**400
"""A whole number that no float can hold."""

SOMETHING = {"a": 1}

KINDS: dict[str, tuple[Any, ...]] = {
    "positive": (NAN, INF, 0.0, -1.0, "x", None, [1.0], HUGE),
    "optional positive": (NAN, INF, 0.0, -1.0, "x", [1.0], HUGE),
    "not negative": (NAN, INF, -1.0, "x", None, [1.0], HUGE),
    "finite": (NAN, INF, -INF, "x", None, [1.0], HUGE),
    "optional finite": (NAN, INF, "x", [1.0], HUGE),
    "not zero": (NAN, INF, 0.0, "x", None, HUGE),
    "share": (NAN, -0.1, 1.1, "x", None, [0.5]),
    "optional share": (NAN, -0.1, 1.1, "x", [0.5]),
    "open share": (NAN, 0.0, 1.0, "x", None),
    "whole": (NAN, 0, -1, 1.5, "x", None, [1]),
    "count": (NAN, 0, -1, "x", None, [1]),
    "word": (NAN, 1, "x", None, ["x"]),
    "object": (NAN, 1.0, "x", None, SOMETHING),
    "numbers": (NAN, "x", [NAN, 1.0], SOMETHING, [[1.0], [1.0, 2.0]]),
    "corners": (NAN, "x", None, [[0, 0], [1, 0]], [[0, 0], [1, 0], [NAN, 1]], [[0, 0], [1, 0], [2, 0]], HUGE),
    "point": (NAN, "xz", None, (1.0,), (1.0, NAN), (1.0, 2.0, 3.0)),
}

POSITIVE = """b h d density depth p rest_speed chatter_time kn ks g rtol atol diameter size radius mass stiffness
    speed spacing frequency duration final_amplitude rms ground_frequency ground_damping filter_frequency filter_damping
    displacement_corner envelope_period stress_drop shear_velocity interval board dt distance quality
    gap rotation tilt evidence resolution window apart within tolerance factor length_scale height time_step"""

BY_NAME: dict[str, str] = dict.fromkeys(POSITIVE.split(), "positive") | {
    "t_end": "positive", "t_start": "finite", "theta": "numbers", "omega": "numbers", "restitution": "optional share",
    "solver": "word", "form": "word", "onset": "word", "impact_law": "word", "coulomb": "word", "stop": "word",
    "pulse": "word", "method": "word", "sweep": "word", "block": "object", "system": "object", "systems": "object",
    "motion": "object", "scene": "object", "assembly": "object", "contact": "object", "save_at": "numbers",
    "max_events": "count", "vertices": "corners", "position": "point", "direction": "point", "alpha": "positive",
    "e": "share", "ratio": "positive", "count": "whole", "books": "whole", "courses": "whole", "across": "whole",
    "voussoirs": "whole", "drums": "whole", "workers": "whole", "save_every": "whole", "watch_every": "whole",
    "confidence": "open share", "false_alarm": "open share", "interval": "positive", "quiet": "point",
    "pitch_about": "point", "joint": "not negative", "wall_gap": "optional not negative", "taper": "share",
    "x": "finite", "z": "finite", "x0": "finite", "vx0": "finite", "vz0": "finite", "omega0": "finite",
    "phase": "finite", "start": "finite", "end": "finite", "amplitude": "positive", "hold": "not negative",
    "noise": "not negative", "periods": "numbers", "pseudo_acceleration": "numbers", "percentiles": "numbers",
    "a_x": "numbers", "acceleration": "numbers", "angles": "whole", "order": "whole", "low": "optional positive",
    "high": "optional positive", "damping": "share", "pga": "optional positive", "length": "not negative",
    "velocity": "not zero", "gamma": "positive", "nu": "finite", "period": "positive", "rise": "not negative",
    "decay": "not negative", "imperfection": "share", "frequencies": "numbers", "gain": "numbers", "seed": "",
    "t": "numbers", "a_z": "numbers", "im": "numbers", "exceeded": "numbers", "total": "numbers",
    "thickness": "positive", "embrace": "positive", "mu": "", "friction": "", "centre": "optional finite",
}  # fmt: skip
KINDS["optional whole"] = tuple(v for v in KINDS["whole"] if v is not None)
KINDS["optional not negative"] = tuple(v for v in KINDS["not negative"] if v is not None)

OWN: dict[tuple[str, str], str] = {
    # entry and argument -> another kind than its name says; "" leaves it to LISTED
    ("closed_forms.west_acceleration", "a_z"): "finite",
    ("closed_forms.quarter_period", "theta0"): "not negative",
    ("closed_forms.zeno_time", "omega"): "",
    ("rocking.solve", "theta"): "finite", ("rocking.solve", "omega"): "finite",
    ("rocking.solve", "motion"): "", ("rocking.solve_batch", "motions"): "",
    ("rocking.solve_batch", "systems"): "object", ("rocking.solve_batch", "t_end"): "positive",
    ("maps.rocking_spectrum", "motion"): "", ("maps.rocking_spectrum", "period"): "numbers",
    ("maps.rocking_spectrum", "alpha"): "numbers", ("maps.overturning_map", "frequency"): "numbers",
    ("fragility_fit.fraction", "interval"): "word", ("steady_states.steady_states", "amplitude"): "positive",
    ("dem.simulate", "onset"): "word", ("dem.simulate", "g"): "positive",
    ("dem.simulate", "save_every"): "optional whole",
    ("dem.simulate_assembly", "save_every"): "optional whole",
    ("dem.simulate_assembly", "watch_every"): "optional whole",
    ("dem.simulate_assembly", "g"): "not negative", ("dem.simulate_assembly", "dt"): "optional positive",
    ("dem.let_go", "tilt"): "finite", ("dem.block", "tilt"): "finite", ("dem.let_go", "dt"): "optional positive",
    ("dem.let_go", "damping"): "", ("dem.critical_step", "damping"): "not negative",
    ("dem.Drop", "height"): "", ("dem.Drop", "scene"): "",
    ("dem.bookshelf", "b"): "positive", ("dem.column", "d"): "", ("dem.single", "d"): "", ("dem.bookshelf", "depth"):
    "positive", ("dem.drum_column", "density"): "positive",
    ("excitation.SinusoidalPitch", "amplitude"): "not zero", ("excitation.Chirp", "amplitude"): "not zero",
    ("excitation.SteadySinusoid", "amplitude"): "not zero", ("excitation.SinusoidalPitch", "phase"): "finite",
    ("excitation.SinusoidalPitch", "taper_in"): "", ("excitation.Table", "phase"): "numbers",
    ("excitation.band_passed", "taper"): "not negative", ("excitation.band_passed", "order"): "whole",
    ("excitation.baseline_corrected", "order"): "", ("excitation.RampedSinusoid", "taper"): "not negative",
    ("excitation.rotd", "damping"): "", ("excitation.matched", "damping"): "",
    ("excitation.scaled", "factor"): "not zero", ("excitation.PointSource", "density"): "positive",
    ("dem.Criteria", "tilt"): "positive", ("dem.Contact", "damping_ratio"): "",
    ("dem.single_block", "d"): "positive", ("dem.single_polygon", "d"): "positive",
    **{(f"excitation.{kind}Pulse", name): "not zero"
       for kind in ("HalfSine", "OneSine", "OneCosine", "SymmetricRicker", "AntisymmetricRicker", "Rectangular")
       for name in ("amplitude",)},
}  # fmt: skip

LISTED: tuple[tuple[str, str, Any], ...] = (
    ("rocking.Method2", "friction", -0.1), ("rocking.Method2", "friction", NAN), ("rocking.Method2", "friction", "x"),
    ("rocking.Method2", "friction", None), ("rocking.Method2", "kinetic_friction", 1.4),
    ("rocking.Method2", "kinetic_friction", 0.6), ("rocking.Method2", "kinetic_friction", "x"),
    ("rocking.Method2", "normal_restitution", 1.1), ("rocking.Method2", "normal_restitution", None),
    ("rocking.Method2", "ratio_kept", 0.5), ("rocking.Method2", "ratio_kept", "x"),
    ("rocking.Method2", "tangential_restitution", -1.1), ("rocking.Method2", "tangential_restitution", [0.0]),
    ("rocking.solve", "motion", 3.0), ("rocking.solve", "motion", "ramp"), ("rocking.solve_batch", "motions", "ramp"),
    ("rocking.solve_batch", "motions", 3.0), ("rocking.solve", "theta", 2.0), ("rocking.solve_batch", "theta", [2.0]),
    ("rocking.solve_batch", "theta", [0.0, 0.1, 0.2]), ("closed_forms.zeno_time", "omega", -1.0),
    ("closed_forms.zeno_time", "omega", "x"), ("closed_forms.zeno_time", "e", 1.0),
    ("closed_forms.free_peak", "n", -1), ("closed_forms.free_peak", "n", 1.5), ("closed_forms.free_peak", "n", "x"),
    ("closed_forms.free_impact_time", "n", 0), ("closed_forms.free_impact_time", "n", 10**12),
    ("closed_forms.quarter_period", "theta0", 0.25), ("closed_forms.free_peak", "theta0", 0.3),
    ("steady_states.steady_states", "n", 2), ("steady_states.steady_states", "n", "x"),
    ("maps.block_of", "alpha", 2.0), ("maps.rocking_spectrum", "alpha", [0.2, 2.0]),
    ("maps.rocking_spectrum", "period", [0.0]), ("maps.rocking_spectrum", "motion", "x"),
    ("fragility_fit.fraction", "exceeded", [6, 1]), ("fragility_fit.fit_lognormal", "im", [1.0, -2.0]),
    ("detection.detect_onset", "quiet", (0.5, 0.0)), ("detection.detect_onset", "t", [0.0, 1.0, 1.5]),
    ("instruments.accelerometer", "direction", (0.0, 0.0)),
    ("dem.polygon", "vertices", [[0, 0], [1e300, 0], [1, 1]]),
    ("dem.column", "count", 10**12), ("dem.rubble", "count", 10**9), ("dem.rubble", "seed", -1),
    ("dem.rubble", "seed", "x"), ("dem.rubble", "seed", 1.5), ("dem.running_bond", "across", 10**15),
    ("dem.running_bond", "joint", 0.2), ("dem.arch", "voussoirs", 1), ("dem.arch", "voussoirs", 10**9),
    ("dem.arch", "thickness", 2.0), ("dem.arch", "embrace", 4.0), ("dem.drum_column", "taper", 0.0),
    ("dem.bookshelf", "books", 100), ("dem.Contact", "mu", -0.1), ("dem.Contact", "mu", "x"),
    ("dem.Contact", "mu", None), ("dem.Contact", "damping_ratio", -0.1), ("dem.ContactJudgement", "facing", "x"),
    ("dem.ContactJudgement", "facing", 0.5), ("dem.ContactJudgement", "skin", 0.0),
    ("dem.simulate", "mu", "x"), ("dem.simulate", "mu", -1.0), ("dem.simulate", "theta0", "x"),
    ("dem.simulate", "theta0", 1.6), ("dem.simulate", "t_end", 1e12), ("dem.simulate", "dt", 1e-300),
    ("dem.simulate", "save_every", True), ("dem.simulate_assembly", "keep", ["shelf"]),
    ("dem.simulate_assembly", "keep", [7]), ("dem.simulate_assembly", "keep", "block"),
    ("dem.simulate_assembly", "keep", 3), ("dem.simulate_assembly", "workers", 10**9),
    ("dem.simulate_assembly", "t_end", 1e12), ("dem.critical_step", "damping", -1.0),
    ("excitation.RampedSinusoid", "imperfection", 0.9), ("excitation.RampedSinusoid", "imperfection_period", 9.0),
    ("excitation.baseline_corrected", "order", 9), ("excitation.baseline_corrected", "order", 1.5),
    ("excitation.baseline_corrected", "order", None), ("excitation.band_passed", "low", 1e-300),
    ("excitation.band_passed", "low", 60.0), ("excitation.band_passed", "order", 13),
    ("excitation.trimmed", "start", 3.0), ("excitation.trimmed", "end", 100.0), ("excitation.tapered", "length", 1.5),
    ("excitation.response_spectrum", "periods", [1e-300]), ("excitation.response_spectrum", "damping", 1.0),
    ("excitation.rotd_peaks", "percentiles", [101.0]), ("excitation.rotd_peaks", "angles", 10**9),
    ("excitation.matched", "max_rounds", -1), ("excitation.matched", "max_rounds", 1.5),
    ("excitation.Table", "frequencies", (5.0, 1.0)), ("excitation.Table", "gain", (1.0, -1.0)),
    ("excitation.SampledMotion", "a_x", [1.0]), ("excitation.SampledMotion", "a_x", [1.0, INF]),
    ("excitation.Record", "acceleration", []), ("excitation.resampled", "time_step", 0.0123456789),
)  # fmt: skip


def cases() -> Iterator[tuple[str, str, Any]]:
    """(entry, argument, bad value)."""
    for entry, (_, good) in ENTRIES.items():
        for argument in good:
            kind = OWN.get((entry, argument), BY_NAME.get(argument, ""))
            if kind:
                yield from ((entry, argument, bad) for bad in KINDS[kind])
    yield from LISTED
