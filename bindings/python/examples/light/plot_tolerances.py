"""
Tolerances
==========

The spot radius of 300 doublets with random errors of manufacture, and which error matters most.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave import optics
from rayweave.optics import Prescription, Surface

doublet = Prescription(
    [Surface(61.47, 6.0, "N-BK7"), Surface(-44.64, 2.5, "N-SF5"), Surface(-129.94, 95.9)],
    entrance_pupil_diameter=25.0,
    fields=[0, 1.0],
    wavelengths_nm=[486.1, 587.6, 656.3],
    primary=1,
)
errors = {
    "radius 1": 0.05,
    "thickness 1": ("normal", 0.02),
    "index 1": 5e-4,
    "index 2": 5e-4,
    "tilt x 2-3": 0.02,
    "decentre y 2-3": 0.02,
}
trials = optics.tolerance(doublet, errors, "spot", trials=300, refocus=True)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
trials.show(ax=left)
trials.sensitivities.show(ax=right)
print(f"nominal {trials.nominal * 1e3:.2f} um, 90 % of the lenses are better than {trials.quantile(0.9) * 1e3:.2f} um")
assert trials.nominal <= trials.quantile(0.9) and np.isfinite(trials["merit"]).all()
