"""
A Cooke triplet
===============

A lens prescription: layout, spots and transverse ray aberrations.
"""

import matplotlib.pyplot as plt

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

figure, axis = plt.subplots(figsize=(8, 3), layout="constrained")
triplet.show(ax=axis, rays=5)

# %%
# The spots of the three fields:
spots = triplet.spots()
print(spots.to_pandas()[["field_y", "y", "rms", "geometric"]])
assert spots["rms"].max() < 0.03
