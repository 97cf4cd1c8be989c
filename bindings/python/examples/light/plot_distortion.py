"""
Distortion and field curvature
==============================

How far the image of a wide-angle lens departs from a scaled picture of a flat object.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave.optics import Prescription, Surface

# a landscape lens: a meniscus behind its stop
lens = Prescription(
    [Surface(np.inf, 8.0), Surface(-40.0, 3.0, "N-BK7"), Surface(-22.6, 97.379)],
    stop=1,
    entrance_pupil_diameter=6.0,
    fields=[0, 15, 30],
    wavelengths_nm=[587.6],
)
distortion, curvature = lens.distortion(count=31), lens.field_curvature(count=31)

figure, axes = plt.subplots(1, 3, figsize=(11, 3.4), layout="constrained")
lens.show(ax=axes[0], rays=3)
distortion.show(ax=axes[1])
curvature.show(ax=axes[2])

real, paraxial = distortion["real"], distortion["paraxial"]
assert np.allclose(distortion["relative"][1:], real[1:] / paraxial[1:] - 1)
# the paraxial height is f tan(angle)
f = lens.first_order().focal_length
print(f"paraxial height {abs(paraxial[-1]):.4f}, f tan(30 degrees) = {f * np.tan(np.radians(30)):.4f}")
assert np.isclose(abs(paraxial[-1]), f * np.tan(np.radians(30)), rtol=1e-4)
