"""
Ray fans of a doublet
=====================

Transverse ray aberrations of an achromat at three wavelengths, over the pupil, on the axis and at the edge of the field.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave.optics import Prescription, Surface

doublet = Prescription(
    [Surface(61.47, 6.0, "N-BK7"), Surface(-44.64, 2.5, "N-SF5"), Surface(-129.94, 95.9)],
    entrance_pupil_diameter=25.0,
    fields=[0, 1.0],
    wavelengths_nm=[486.1, 587.6, 656.3],
    primary=1,
)
fans = doublet.fans()

figure, axes = plt.subplots(1, 2, figsize=(8, 3.2), sharey=True, layout="constrained")
for field, axis in enumerate(axes):
    for wavelength, colour in zip(doublet.wavelengths_nm, ("blue", "gold", "red"), strict=True):
        pupil, error = fans.fan(field, wavelength, "y")
        axis.plot(pupil, error * 1e3, color=colour, label=f"{wavelength} nm")
    axis.set(title=f"field {doublet.fields[field][1]} degrees", xlabel="pupil along y")
axes[0].set_ylabel("aberration in um")
axes[0].legend(fontsize=8)

# on the axis the fan is odd
pupil, error = fans.fan(0, 587.6, "y")
assert np.allclose(error, -error[::-1], atol=1e-9)
