"""What the base does: prescribed motions that a solver can evaluate at any time, and the records they are made from.

A motion is an immutable object.  Calling it with times gives accelerations; its `kernel` and `parameters` are the
same formula in the form that a compiling solver takes (see `excitation.motion.Motion`).  A record is an acceleration
history with where it is from (`excitation.record.Record`); `read` finds them in files, functions process them, and
`record.motion()` makes a motion of one.  `python -m excitation FILE` shows what a file holds.

The first five minutes, in SI units:

>>> import excitation as ex
>>> ramp = ex.RampedSinusoid(frequency=2.0, duration=10.0, final_amplitude=4.0)  # Hz, s, m/s^2
>>> a_x, a_z = ramp([2.125, 5.125])  # at these times; ramp.pitch([...]) gives the pitch and its acceleration
>>> a_x.round(3).tolist()
[0.85, 2.05]
>>> tilting = ex.Combined(ramp, pitching=ex.SinusoidalPitch(frequency=2.0, amplitude=1e-3, duration=10.0, growing=True))
>>> ex.from_xarray(tilting.to_xarray([0.0, 0.1, 0.2])) == tilting  # a dataset with units, and back
True

A record is made here, or read: the format is found by what stands in the file.

>>> ex.write("made.AT2", ex.KanaiTajimi(rms=1.0, duration=20.0).record(time_step=0.01, seed=1), "peer")
>>> (record,) = ex.read("made.AT2")
>>> record
Record(made.AT2, 2001 samples at 0.01 s, PGA 3.37 m/s^2)
>>> strong = ex.scaled_to(ex.band_passed(ex.baseline_corrected(record), 0.1, 25.0), pga=2.0)
>>> round(ex.intensity(strong).pga, 12), strong.metadata["processing"].split("; ")[-1][:9]
(2.0, 'scaled by')
>>> spectrum = ex.response_spectrum(strong, periods=[0.2, 0.5, 1.0])  # spectrum.pseudo_acceleration [m/s^2]
>>> strong.motion()  # what a solver takes; ex.Table().shake(...) is what a real table makes of it
SampledMotion('made.AT2', 2001 samples at 0.01 s from 0 s)
"""

from excitation import _early as _early  # first: it stands guard while the others are loaded
from excitation.baseline import baseline_corrected
from excitation.chirp import Chirp
from excitation.combined import Combined
from excitation.datasets import from_xarray
from excitation.filters import band_passed, tapered
from excitation.formats import formats, read, write
from excitation.intensities import Intensity, intensity
from excitation.kanai_tajimi import KanaiTajimi
from excitation.motion import Motion
from excitation.pitch_proportional import ProportionalPitch
from excitation.pitch_sinusoid import SinusoidalPitch
from excitation.point_source import PointSource
from excitation.pulse import CentredPulse, FinitePulse
from excitation.pulse_antisymmetric_ricker import AntisymmetricRickerPulse
from excitation.pulse_gabor import GaborPulse
from excitation.pulse_half_sine import HalfSinePulse
from excitation.pulse_mavroeidis_papageorgiou import MavroeidisPapageorgiouPulse
from excitation.pulse_one_cosine import OneCosinePulse
from excitation.pulse_one_sine import OneSinePulse
from excitation.pulse_rectangular import RectangularPulse
from excitation.pulse_symmetric_ricker import SymmetricRickerPulse
from excitation.ramped_sinusoid import RampedSinusoid
from excitation.record import Record, RecordFileError
from excitation.resampling import resampled, similar, time_scaled, trimmed
from excitation.rotation import rotd, rotd_peaks, turned
from excitation.sampled import PiecewiseLinear, SampledMotion
from excitation.scaling import scaled, scaled_to
from excitation.spectra import ResponseSpectrum, response_spectrum
from excitation.spectrum_matching import Match, matched
from excitation.steady_sinusoid import SteadySinusoid
from excitation.table import Table

__all__ = [
    "AntisymmetricRickerPulse",
    "CentredPulse",
    "Chirp",
    "Combined",
    "FinitePulse",
    "GaborPulse",
    "HalfSinePulse",
    "Intensity",
    "KanaiTajimi",
    "Match",
    "MavroeidisPapageorgiouPulse",
    "Motion",
    "OneCosinePulse",
    "OneSinePulse",
    "PiecewiseLinear",
    "PointSource",
    "ProportionalPitch",
    "RampedSinusoid",
    "Record",
    "RecordFileError",
    "RectangularPulse",
    "ResponseSpectrum",
    "SampledMotion",
    "SinusoidalPitch",
    "SteadySinusoid",
    "SymmetricRickerPulse",
    "Table",
    "band_passed",
    "baseline_corrected",
    "formats",
    "formulas",
    "from_xarray",
    "intensity",
    "matched",
    "read",
    "resampled",
    "response_spectrum",
    "rotd",
    "rotd_peaks",
    "scaled",
    "scaled_to",
    "similar",
    "tapered",
    "time_scaled",
    "trimmed",
    "turned",
    "write",
]


def formulas() -> dict[str, type[Motion]]:
    """The motions that are closed formulas, by name: what a dataset can be traced back to."""
    found = (
        AntisymmetricRickerPulse, Chirp, Combined, GaborPulse, HalfSinePulse, MavroeidisPapageorgiouPulse,
        OneCosinePulse, OneSinePulse, ProportionalPitch, RampedSinusoid, RectangularPulse, SinusoidalPitch,
        SteadySinusoid, SymmetricRickerPulse,
    )  # fmt: skip
    return {kind.__name__: kind for kind in found}
