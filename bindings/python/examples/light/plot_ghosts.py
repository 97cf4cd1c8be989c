"""
Ghosts of a lens
================

All paths of light through a doublet, sorted by power. A path with two reflections is a ghost image; stars mark reflections.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave import optics

pair = optics.cemented([61.0, -44.0, -129.0], [6.0, 2.5], ["N-BK7", "SF5"], aperture=25, name="L")
screen = optics.detector(40, name="screen").translate([0, 0, 96])
system = optics.System([*pair, screen])
light = optics.beam(18, 10_000, wavelength_nm=587.6).translate([0, 0, -20])
trace = system.trace(light, branches="both", threshold=1e-8)

paths = [path for path in trace.paths() if path.text.endswith("screen")]
for path in paths[:6]:
    print(f"{path.power:.2e}  {path.text}")
print(trace.balance)
assert abs(trace.balance.error) < 1e-9 and paths[0].text.count("*") == 0

irradiance, x, y = trace.irradiance("screen", 40, size=(30, 30))
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6), layout="constrained")
shown = left.pcolormesh(x, y, np.log10(np.maximum(irradiance, 1e-9)), cmap="magma")
figure.colorbar(shown, ax=left, label="log10 of irradiance")
left.set(aspect="equal", title="image and ghosts on the screen")
right.barh([path.text for path in paths[:8]][::-1], [path.power for path in paths[:8]][::-1])
right.set(xscale="log", xlabel="power")
right.tick_params(axis="y", labelsize=7)
