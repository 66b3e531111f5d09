"""Every public entry that takes numbers, with arguments that are good: what the tables of bad input start from.

`ENTRIES` maps a name to the callable and its good arguments; replacing one of them by something bad has to end in one
sentence with the name of the argument, its value and what was wanted.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

import dem
import excitation as ex
import rocking
from rocking import closed_forms, detection, fragility_fit, instruments, maps, steady_states
from rocking.pulse_overturning import one_impact_band

BLOCK = rocking.Block(0.2, 0.8)
METHOD1 = rocking.Method1(BLOCK)
SCENE = dem.single_block(0.2, 0.8, 0.25, 597.0)
SINE = np.sin(0.3 * np.arange(200))
RECORD = ex.Record(0.01, SINE, source="made")
OTHER = ex.Record(0.01, SINE[::-1].copy(), source="other")
TIMES = 0.01 * np.arange(200)
CONTACT = dem.Contact(0.7, damping_ratio=0.3)
STEADY = {"frequency": 2.0, "amplitude": 1.0, "duration": 5.0}


@cache
def trajectory() -> Any:
    """A short free run."""
    return rocking.solve(METHOD1, theta=0.1, t_end=0.2, save_at=[0.0, 0.1, 0.2])


def later(make: Callable[..., Any]) -> Callable[..., Any]:
    """A function of a trajectory, which is made when it is called."""
    return lambda **given: make(trajectory(), **given)


ENTRIES: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "rocking.Block": (rocking.Block, {"b": 0.2, "h": 0.8, "d": 0.25, "density": 597.0}),
    "rocking.Method1": (
        rocking.Method1,
        {"block": BLOCK, "restitution": 0.9, "form": "nonlinear", "onset": "west", "g": 9.8, "rest_speed": 1e-6},
    ),
    "rocking.Method2": (
        rocking.Method2,
        {
            "block": BLOCK, "friction": 0.5, "kinetic_friction": 0.4, "normal_restitution": 0.0,
            "tangential_restitution": 0.0, "impact_law": "frictional", "g": 9.8, "rest_speed": 1e-6,
            "chatter_time": 1e-5,
        },
    ),
    "rocking.solve": (
        lambda **given: rocking.solve(**given),
        {
            "system": METHOD1, "motion": ex.SteadySinusoid(**STEADY), "t_end": 0.1, "t_start": 0.0, "theta": 0.0,
            "omega": 0.0, "solver": "numba", "rtol": 1e-9, "atol": 1e-12, "save_at": [0.0, 0.1], "max_events": 10,
            "effects": (),
        },
    ),
    "rocking.solve_batch": (
        rocking.solve_batch,
        {
            "systems": METHOD1, "motions": ex.SteadySinusoid(**STEADY), "t_end": 0.1, "t_start": 0.0,
            "theta": [0.0, 0.01], "omega": [0.0, 0.0], "solver": "numba", "rtol": 1e-9, "atol": 1e-12,
            "max_events": 10, "effects": (),
        },
    ),
    "closed_forms.west_acceleration": (closed_forms.west_acceleration, {"b": 0.2, "h": 0.8, "a_z": 0.0, "g": 9.8}),
    "closed_forms.quarter_period": (closed_forms.quarter_period, {"theta0": 0.1, "alpha": 0.25, "p": 4.0}),
    "closed_forms.free_peak": (closed_forms.free_peak, {"theta0": 0.1, "alpha": 0.25, "e": 0.9, "n": 2}),
    "closed_forms.free_impact_time": (
        closed_forms.free_impact_time,
        {"theta0": 0.1, "alpha": 0.25, "p": 4.0, "e": 0.9, "n": 2},
    ),
    "closed_forms.zeno_time": (closed_forms.zeno_time, {"omega": 0.1, "alpha": 0.25, "p": 4.0, "e": 0.9}),
    "closed_forms.rectangular_pulse": (closed_forms.rectangular_pulse, {"duration": 0.5, "p": 4.0}),
    "closed_forms.half_sine_pulse": (closed_forms.half_sine_pulse, {"ratio": 2.0}),
    "closed_forms.full_sine_pulse": (closed_forms.full_sine_pulse, {"ratio": 2.0}),
    "closed_forms.full_cosine_pulse": (closed_forms.full_cosine_pulse, {"ratio": 2.0}),
    "closed_forms.ishiyama_velocity": (closed_forms.ishiyama_velocity, {"block": BLOCK, "g": 9.8}),
    "maps.block_of": (maps.block_of, {"p": 4.0, "alpha": 0.25, "g": 9.8}),
    "maps.overturning_map": (
        lambda **given: maps.overturning_map(
            lambda frequency: (METHOD1, ex.SteadySinusoid(frequency, 1.0, 5.0)), {"frequency": given["frequency"]},
            t_end=given["t_end"],
        ),
        {"frequency": [1.0, 2.0], "t_end": 0.1},
    ),
    "maps.rocking_spectrum": (
        maps.rocking_spectrum,
        {
            "motion": ex.SteadySinusoid(**STEADY), "period": [1.0, 2.0], "alpha": [0.2, 0.3], "t_end": 0.1,
            "restitution": 0.9, "g": 9.8,
        },
    ),
    "fragility_fit.fraction": (
        fragility_fit.fraction,
        {"exceeded": [1, 2], "total": [5, 5], "confidence": 0.95, "interval": "wilson"},
    ),
    "fragility_fit.fit_lognormal": (
        fragility_fit.fit_lognormal,
        {"im": [1.0, 2.0, 3.0, 4.0, 2.5, 1.5], "exceeded": [0, 1, 0, 1, 1, 0]},
    ),
    "steady_states.stable_range": (steady_states.stable_range, {"ratio": 5.0, "e": 0.9, "n": 1}),
    "steady_states.steady_states": (steady_states.steady_states, {"ratio": 5.0, "amplitude": 4.0, "e": 0.9, "n": 1}),
    "pulse_overturning.one_impact_band": (one_impact_band, {"ratio": 6.0, "e": 0.9, "pulse": "sine"}),
    "detection.detect_onset": (
        detection.detect_onset,
        {
            "t": TIMES, "a_z": 9.8 + 0.001 * SINE, "quiet": (0.0, 0.5), "window": 0.01, "false_alarm": 0.01,
            "count": 3, "apart": 0.05, "within": 1.5, "resolution": 0.001,
        },
    ),
    "detection.detect_overturning": (
        detection.detect_overturning,
        {"t": TIMES, "a_z": 9.8 + 0.001 * SINE, "quiet": (0.0, 0.5), "g": 9.8, "window": 0.02, "evidence": 0.3},
    ),
    "instruments.marker": (later(instruments.marker), {"position": (0.0, 0.4)}),
    "instruments.accelerometer": (
        later(instruments.accelerometer),
        {"position": (0.0, 0.4), "direction": (0.0, 1.0)},
    ),
    "dem.rectangle": (dem.rectangle, {"b": 0.2, "h": 0.8}),
    "dem.polygon": (dem.polygon, {"vertices": [[0, 0], [1, 0], [1, 1], [0, 1]]}),
    "dem.convex": (dem.convex, {"vertices": [[0, 0], [1, 0], [1, 1], [0, 1]]}),
    "dem.single_block": (dem.single_block, {"b": 0.2, "h": 0.8, "d": 0.25, "density": 597.0}),
    "dem.single_polygon": (
        dem.single_polygon,
        {"vertices": [[0, 0], [1, 0], [1, 1], [0, 1]], "d": 0.25, "density": 597.0},
    ),
    "dem.block": (
        dem.block,
        {"b": 0.2, "h": 0.8, "depth": 0.25, "density": 597.0, "x": 0.0, "z": 0.4, "tilt": 0.0},
    ),
    "dem.body": (dem.body, {"vertices": [[0, 0], [1, 0], [1, 1], [0, 1]], "depth": 0.2, "density": 600.0}),
    "dem.wall": (dem.wall, {"vertices": [[0, 0], [1, 0], [1, 1], [0, 1]]}),
    "dem.bodies_of": (
        dem.bodies_of,
        {"outlines": [[[0, 0], [1, 0], [1, 1], [0, 1]]], "depth": 0.2, "density": 600.0},
    ),
    "dem.single": (dem.single, {"b": 0.2, "h": 0.8, "d": 0.25, "density": 597.0}),
    "dem.column": (
        dem.column,
        {"count": 2, "b": 0.2, "h": 0.4, "d": 0.25, "density": 597.0, "wall_gap": 0.01},
    ),
    "dem.bookshelf": (dem.bookshelf, {"books": 3, "b": 0.8, "h": 0.35, "depth": 0.25, "board": 0.02}),
    "dem.running_bond": (
        dem.running_bond,
        {"courses": 2, "across": 2, "b": 0.2, "h": 0.1, "d": 0.1, "density": 1800.0, "joint": 0.001},
    ),
    "dem.arch": (
        dem.arch,
        {"voussoirs": 5, "thickness": 0.2, "radius": 1.0, "embrace": 3.0, "d": 0.2, "density": 2000.0},
    ),
    "dem.drum_column": (
        dem.drum_column,
        {"drums": 3, "diameter": 0.6, "taper": 0.9, "h": 3.0, "density": 2600.0},
    ),
    "dem.rubble": (dem.rubble, {"count": 3, "size": 0.2, "density": 2400.0, "seed": 0}),
    "dem.Contact": (dem.Contact, {"mu": 0.7, "damping_ratio": 0.3, "kn": 1e7, "ks": 1e7}),
    "dem.ContactJudgement": (
        dem.ContactJudgement,
        {"skin": 1e-3, "update_after": 1e-3, "reach": 0.0, "end_slack": 1e-9, "facing": 0.1},
    ),
    "dem.Criteria": (
        dem.Criteria,
        {"stop": "fall", "tilt": 1.5, "drop": 0.1, "gap": 1e-3, "rotation": 5e-3, "margin": 0.1},
    ),
    "dem.Drop": (dem.Drop, {"scene": SCENE, "height": 0.01, "kn": 1e7, "g": 9.8}),
    "dem.simulate": (
        dem.simulate,
        {
            "scene": SCENE, "t_end": 0.001, "mu": 0.5, "damping_ratio": 0.1, "dt": 1e-5, "kn": 1e7, "ks": 1e7,
            "onset": "overlap", "coulomb": "total", "x0": 0.0, "gap0": 0.0, "theta0": 0.0, "vx0": 0.0, "vz0": 0.0,
            "omega0": 0.0, "g": 9.8, "save_every": 10,
        },
    ),
    "dem.simulate_assembly": (
        dem.simulate_assembly,
        {
            "assembly": dem.single(0.2, 0.8, 0.25, 597.0), "t_end": 0.001, "contact": CONTACT, "dt": 1e-5,
            "onset": "located", "coulomb": "total", "g": 9.8, "pitch_about": (0.0, 0.0), "save_every": 10,
            "watch_every": 10, "workers": 1, "keep": ["block"],
        },
    ),
    "dem.let_go": (
        dem.let_go,
        {"scene": SCENE, "tilt": 0.01, "t_end": 0.01, "damping": 100.0, "kn": 1e7, "ks": 1e7, "dt": 1e-5, "g": 9.8,
         "interval": 1e-3},
    ),
    "dem.critical_step": (dem.critical_step, {"scene": SCENE, "kn": 1e7, "ks": 1e7, "damping": 10.0}),
    "dem.eq7_step": (dem.eq7_step, {"mass": 10.0, "stiffness": 1e7}),
    "dem.stiffness_from_wave_speed": (
        dem.stiffness_from_wave_speed,
        {"mass": 10.0, "speed": 1000.0, "spacing": 0.1},
    ),
    "dem.wave_speed_from_stiffness": (
        dem.wave_speed_from_stiffness,
        {"mass": 10.0, "stiffness": 1e7, "spacing": 0.1},
    ),
    "excitation.RampedSinusoid": (
        ex.RampedSinusoid,
        {
            "frequency": 2.0, "duration": 5.0, "final_amplitude": 4.0, "phase": 0.0, "imperfection": 0.0, "seed": 0,
            "imperfection_period": 1.0, "hold": 0.0, "taper": 0.0,
        },
    ),
    "excitation.SteadySinusoid": (
        ex.SteadySinusoid,
        STEADY | {"phase": 0.0, "taper_in": 0.1, "taper_out": 0.1},
    ),
    "excitation.SinusoidalPitch": (
        ex.SinusoidalPitch,
        {"frequency": 2.0, "amplitude": 1e-3, "duration": 5.0, "phase": 0.0, "taper_in": 0.1, "taper_out": 0.1},
    ),
    "excitation.ProportionalPitch": (
        ex.ProportionalPitch,
        {"motion": ex.OneCosinePulse(1.0, 1.0), "per_displacement": 1e-4, "per_acceleration": 0.0},
    ),
    "excitation.Chirp": (
        ex.Chirp,
        {
            "start_frequency": 1.0, "end_frequency": 5.0, "amplitude": 1.0, "duration": 5.0, "sweep": "linear",
            "phase": 0.0, "taper_in": 0.1, "taper_out": 0.1,
        },
    ),
    **{
        f"excitation.{kind.__name__}": (kind, {"amplitude": 1.0, "period": 1.0, "start": 0.0})
        for kind in (ex.HalfSinePulse, ex.OneSinePulse, ex.OneCosinePulse)
    },
    **{
        f"excitation.{kind.__name__}": (kind, {"amplitude": 1.0, "period": 1.0, "centre": 0.0})
        for kind in (ex.SymmetricRickerPulse, ex.AntisymmetricRickerPulse)
    },
    "excitation.RectangularPulse": (ex.RectangularPulse, {"amplitude": 1.0, "duration": 1.0, "start": 0.0}),
    **{
        f"excitation.{kind.__name__}": (
            kind,
            {"velocity": 1.0, "frequency": 1.0, "gamma": 2.0, "nu": 0.0, "centre": 1.0},
        )
        for kind in (ex.GaborPulse, ex.MavroeidisPapageorgiouPulse)
    },
    "excitation.SampledMotion": (ex.SampledMotion, {"time_step": 0.01, "a_x": SINE, "start": 0.0}),
    "excitation.PiecewiseLinear": (ex.PiecewiseLinear, {"time_step": 0.01, "a_x": SINE, "start": 0.0}),
    "excitation.KanaiTajimi": (
        ex.KanaiTajimi,
        {
            "rms": 1.0, "duration": 20.0, "rise": 2.0, "strong_end": 12.0, "decay": 0.3, "ground_frequency": 2.5,
            "ground_damping": 0.6, "filter_frequency": 0.25, "filter_damping": 0.6,
        },
    ),
    "excitation.PointSource": (
        ex.PointSource,
        {
            "magnitude": 6.0, "distance": 2e4, "stress_drop": 1e7, "density": 2800.0, "shear_velocity": 3500.0,
            "quality": 180.0, "quality_exponent": 0.45, "kappa": 0.04,
        },
    ),
    "excitation.Record": (ex.Record, {"time_step": 0.01, "acceleration": SINE, "azimuth_deg": 90.0}),
    "excitation.Table": (
        ex.Table,
        {
            "frequencies": (1.0, 5.0), "gain": (1.0, 0.9), "phase": (0.0, 0.1), "second_harmonic": 0.01,
            "cross_axis": 0.01, "displacement_corner": 0.1, "envelope_period": 10.0, "noise": 0.0, "seed": 0,
        },
    ),
    "excitation.band_passed": (
        lambda **given: ex.band_passed(RECORD, **given),
        {"low": 0.5, "high": 20.0, "order": 4, "taper": 0.05},
    ),
    "excitation.baseline_corrected": (
        lambda **given: ex.baseline_corrected(RECORD, **given),
        {"order": 1, "method": "velocity"},
    ),
    "excitation.resampled": (lambda **given: ex.resampled(RECORD, **given), {"time_step": 0.02}),
    "excitation.response_spectrum": (
        lambda **given: ex.response_spectrum(RECORD, **given),
        {"periods": [0.5, 1.0], "damping": 0.05},
    ),
    "excitation.rotd": (
        lambda **given: ex.rotd(RECORD, OTHER, **given),
        {"periods": [0.5], "percentiles": [50.0], "damping": 0.05, "angles": 20},
    ),
    "excitation.rotd_peaks": (
        lambda **given: ex.rotd_peaks(RECORD, OTHER, **given),
        {"percentiles": [50.0], "angles": 20},
    ),
    "excitation.scaled": (lambda **given: ex.scaled(RECORD, **given), {"factor": 2.0}),
    "excitation.scaled_to": (lambda **given: ex.scaled_to(RECORD, **given), {"pga": 2.0}),
    "excitation.similar": (lambda **given: ex.similar(RECORD, **given), {"length_scale": 2.0}),
    "excitation.tapered": (lambda **given: ex.tapered(RECORD, **given), {"length": 0.1}),
    "excitation.time_scaled": (lambda **given: ex.time_scaled(RECORD, **given), {"factor": 2.0}),
    "excitation.trimmed": (lambda **given: ex.trimmed(RECORD, **given), {"start": 0.1, "end": 1.0}),
    "excitation.matched": (
        lambda **given: ex.matched(RECORD, **given),
        {"periods": [0.5, 1.0], "pseudo_acceleration": [2.0, 1.0], "damping": 0.05, "tolerance": 0.5, "max_rounds": 2},
    ),
}  # fmt: skip
