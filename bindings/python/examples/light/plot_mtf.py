"""
Modulation transfer of a triplet
================================

The geometric MTF of a Cooke triplet from its rays, for three fields, with the diffraction limit of a perfect lens.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave.optics import Prescription, Surface

triplet = Prescription(
    [
        Surface(22.01359, 3.25896, "N-SK16"),
        Surface(-435.76044, 6.00755),
        Surface(-22.21328, 0.99997, "F2"),
        Surface(20.29192, 4.75041),
        Surface(79.68360, 2.95208, "N-SK16"),
        Surface(-18.39533, 42.20778),
    ],
    stop=4,
    entrance_pupil_diameter=10.0,
    fields=[0, 14, 20],
    wavelengths_nm=[486.1, 587.6, 656.3],
    primary=1,
)
frequencies = np.linspace(0, 100, 51)
mtf = triplet.geometric_mtf(frequencies).to_pandas()

figure, axis = plt.subplots(figsize=(6, 3.8), layout="constrained")
for k, (field, rows) in enumerate(mtf.groupby("field")):
    degrees = triplet.fields[int(field)][1]
    axis.plot(rows["frequency"], rows["tangential"], color=f"C{k}", label=f"{degrees:g} degrees, tangential")
    axis.plot(rows["frequency"], rows["sagittal"], "--", color=f"C{k}", label=f"{degrees:g} degrees, sagittal")
axis.plot(rows["frequency"], rows["limit"], ":", color="gray", label="diffraction limit")
axis.set(xlabel="cycles per mm", ylabel="MTF", ylim=(0, 1.02))
axis.legend(fontsize=7)

# the limit of a circular pupil: 2 / pi (arccos x - x sqrt(1 - x^2)), x = frequency * wavelength * f-number;
# the mean over the wavelengths
x = np.outer([486.1e-6, 587.6e-6, 656.3e-6], frequencies) * triplet.first_order().f_number
assert np.allclose(rows["limit"], (2 / np.pi * (np.arccos(x) - x * np.sqrt(1 - x**2))).mean(axis=0), atol=2e-3)
