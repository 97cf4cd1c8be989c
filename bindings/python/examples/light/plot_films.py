"""
An antireflection film
======================

The reflectance of glass with a quarter-wave film of magnesium fluoride, against the wavelength, with the formula of a single
layer.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave import optics

n_film, n_glass = 1.38, 1.52
thickness = 550 / (4 * n_film)
film = optics.coated((n_film, thickness))

wavelengths = np.linspace(380, 780, 41)
window = optics.lens(np.inf, np.inf, 5, aperture=20, material=n_glass, name="window")


def reflectance(element: optics.Element) -> np.ndarray:
    """The reflectance of the front face by wavelength."""
    origins = np.tile([0.0, 0.0, -10.0], (len(wavelengths), 1))
    trace = optics.System([element]).trace_rays(origins, [0, 0, 1], wavelengths, branches="both", generation_limit=2)
    back = (trace["generation"] == 1) & (trace["z_tilt"] < 0)
    return trace["intensity"][back][np.argsort(trace["wavelength_nm"][back])]


coated, bare = reflectance(window.with_finish(film, "front")), reflectance(window)

# one layer between air and glass at normal incidence
r1, r2 = (1 - n_film) / (1 + n_film), (n_film - n_glass) / (n_film + n_glass)
phase = np.exp(4j * np.pi * n_film * thickness / wavelengths)
exact = np.abs((r1 + r2 * phase) / (1 + r1 * r2 * phase)) ** 2
print(f"reflectance at 550 nm: {np.interp(550, wavelengths, coated):.5f}, by formula {np.interp(550, wavelengths, exact):.5f}")
assert np.allclose(coated, exact) and np.allclose(bare, ((n_glass - 1) / (n_glass + 1)) ** 2)

figure, axis = plt.subplots(figsize=(6, 3.4), layout="constrained")
axis.plot(wavelengths, 100 * bare, label="bare glass")
axis.plot(wavelengths, 100 * coated, "o", ms=3, label="with the film")
axis.plot(wavelengths, 100 * exact, label="formula")
axis.set(xlabel="wavelength in nm", ylabel="reflectance in %", ylim=(0, None))
axis.legend()
