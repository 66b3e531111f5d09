"""
Analysing fig16.nc in xarray
============================

``python -m studies.fig16`` writes a dataset; every picture is a view of it. Here a small one is made, with Methods
1 and 2 and three frequencies, and looked at without any more of this package. What it prints of the paper's
statements holds for these few points alone.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import xarray as xr

from studies import fig16

folder = Path(tempfile.mkdtemp())
fig16.main(
    ["--quick", "--methods", "method1", "method2", "--no-sensitivity", "--out", str(folder)]
)
ds = xr.load_dataset(folder / "fig16.nc")
print(ds)

# %%
# Variables carry units and what they are after; the file says how it was made.

print(ds.overturning_amplitude.attrs)
print(ds.attrs["command"])

# %%
# ``method`` is also a keyword of ``sel``, hence the braces. In units of what starts rocking, :math:`g\,b/h`,
# blocks of like slenderness and different size part ways as the frequency grows.

table = ds.overturning_amplitude.sel({"method": "method1"}).to_pandas()
print(table.round(2))

figure, axes = plt.subplots(1, 2, figsize=(8, 3.8), sharey=True)
for ax, method in zip(axes, ds.method.values, strict=True):
    ds.overturning_amplitude.sel({"method": method}).plot.line(x="frequency", marker="o", ax=ax)
    ax.set_title(method)
axes[1].set_ylabel("")
figure.tight_layout()
plt.show()
