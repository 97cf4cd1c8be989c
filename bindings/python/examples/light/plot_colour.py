"""
Colour of a singlet and a doublet
=================================

The focus against the wavelength: a singlet disperses, an achromat brings two wavelengths to one focus.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave import optics
from rayweave.optics import Prescription, Surface

wavelengths = np.linspace(430, 700, 28)
common = {"entrance_pupil_diameter": 10.0, "wavelengths_nm": [486.1, 587.6, 656.3], "primary": 1}
lenses = {
    "singlet": Prescription([Surface(102.6, 5.0, "N-BK7"), Surface(-102.6, 98.4)], **common),
    "doublet": Prescription(
        [Surface(61.47, 6.0, "N-BK7"), Surface(-44.64, 2.5, "N-SF5"), Surface(-129.94, 95.9)], **common
    ),
}
figure, axis = plt.subplots(figsize=(6, 3.6), layout="constrained")
for name, lens in lenses.items():
    shift = lens.focal_shift(wavelengths)
    axis.plot(shift["wavelength_nm"], shift["focus"] - np.interp(587.6, wavelengths, shift["focus"]), label=name)
axis.set(xlabel="wavelength in nm", ylabel="shift of the focus in mm")
axis.legend()

# a thin singlet: the focal length over Abbe's number is the shift between the lines F and C
lines = lenses["singlet"].focal_shift([486.1, 656.3])["focus"]
thin = lenses["singlet"].first_order().focal_length / optics.glass("N-BK7").abbe_number()
print(f"focal shift between F and C {lines[1] - lines[0]:.3f} mm, f / V = {thin:.3f} mm")
assert abs(lines[1] - lines[0] - thin) < 0.05 * thin
