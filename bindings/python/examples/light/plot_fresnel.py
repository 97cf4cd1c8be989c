"""
Fresnel's equations and Brewster's angle
========================================

The reflectance of glass for light polarised across and along the plane of incidence, from traced rays.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave import optics

n = 1.5
glass = optics.lens(np.inf, np.inf, 1, aperture=40, material=n)
angles = np.linspace(0, 85, 35)
incidence = np.radians(angles)
directions = np.stack([0 * incidence, np.sin(incidence), np.cos(incidence)], axis=1)
origins = -10 * directions

figure, axis = plt.subplots(figsize=(6, 3.6), layout="constrained")
transmission = np.arcsin(np.sin(incidence) / n)
cos_i, cos_t = np.cos(incidence), np.cos(transmission)
exact = {"s": ((cos_i - n * cos_t) / (cos_i + n * cos_t)) ** 2, "p": ((cos_t - n * cos_i) / (cos_t + n * cos_i)) ** 2}
for name, q in (("s", 1), ("p", -1)):
    # Stokes parameters, and the direction of positive q: x, which is across the plane of incidence yz
    stokes = np.tile([1.0, q, 0, 0, 1, 0, 0], (len(angles), 1))
    system = optics.System([glass])
    trace = system.trace_rays(origins, directions, stokes=stokes, branches="both", generation_limit=2, polarised=True)
    back = (trace["generation"] == 1) & (trace["z_tilt"] < 0)
    found = np.zeros(len(angles))
    found[trace["id"][back]] = trace["intensity"][back]
    axis.plot(angles, found, "o", ms=4, label=f"{name}, traced")
    axis.plot(angles, exact[name], color="gray", lw=1)
    assert np.allclose(found, exact[name], atol=1e-12)

brewster = np.degrees(np.arctan(n))
print(f"Brewster's angle {brewster:.3f} degrees")
axis.axvline(brewster, ls=":", color="gray")
axis.set(xlabel="angle of incidence in degrees", ylabel="reflectance")
axis.legend()
