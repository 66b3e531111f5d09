"""
A record, from file to motion
=============================

Written and read as PEER's format, corrected, filtered and scaled; each step leaves its name in the metadata.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import excitation as ex

path = Path(tempfile.mkdtemp()) / "made.AT2"
made = ex.PointSource(magnitude=6.5, distance=20e3).record(time_step=0.01, seed=4)
ex.write(path, made, "peer")

(record,) = ex.read(path)
strong = ex.scaled_to(ex.band_passed(ex.baseline_corrected(record), 0.1, 25.0), pga=3.0)
print(strong.metadata["processing"])
print(ex.intensity(strong))

spectrum = ex.response_spectrum(strong)
figure = plt.figure(figsize=(8, 4.6))
axes = figure.subplot_mosaic([["a", "s"], ["v", "s"], ["d", "s"]])
for name, values, unit in (
    ("a", strong.acceleration, "m/s²"), ("v", strong.velocity, "m/s"), ("d", strong.displacement, "m")
):  # fmt: skip
    axes[name].plot(strong.times, values, lw=0.6)
    axes[name].set_ylabel(f"{name} [{unit}]")
axes["d"].set_xlabel("time [s]")
axes["s"].loglog(spectrum.periods, spectrum.pseudo_acceleration)
axes["s"].set(xlabel="period [s]", ylabel="pseudo-acceleration, 5 % [m/s²]")
figure.suptitle("A made record of magnitude 6.5 at 20 km")
figure.tight_layout()
plt.show()
