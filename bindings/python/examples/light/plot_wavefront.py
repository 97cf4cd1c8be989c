"""
Wavefront and Zernike polynomials
=================================

The wavefront of a tilted field of an achromat over its pupil, and its first Zernike coefficients.
"""

import matplotlib.pyplot as plt

from rayweave.optics import Prescription, Surface

doublet = Prescription(
    [Surface(61.47, 6.0, "N-BK7"), Surface(-44.64, 2.5, "N-SF5"), Surface(-129.94, 95.9)],
    entrance_pupil_diameter=25.0,
    fields=[0, 2.0],
    wavelengths_nm=[587.6],
)
wavefront = doublet.wavefront(1)
fit = wavefront.zernike(15)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
shown = left.scatter(wavefront["pupil_x"], wavefront["pupil_y"], c=wavefront["waves"], s=14, cmap="RdBu")
figure.colorbar(shown, ax=left, label="waves")
left.set(aspect="equal", title=f"RMS {wavefront.rms:.3f} waves")
right.bar(fit["index"][1:], fit["coefficient"][1:])
right.set(xlabel="number after Noll", ylabel="coefficient in waves")

# the polynomials have unit mean square: squares of coefficients, from the fourth without piston and tilts, add up to the variance
total = (fit["coefficient"][3:] ** 2).sum() + fit.residual_rms**2
print(f"variance of the fit {total:.5f}, of the wavefront {wavefront.rms**2:.5f}")
assert abs(total - wavefront.rms**2) < 0.05 * total
