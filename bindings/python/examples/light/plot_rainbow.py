"""
The rainbow
===========

Light that is reflected once inside a drop of water leaves most densely near 42 degrees from the incoming light. Descartes
computed this angle from the law of refraction in 1637.
"""

import matplotlib.pyplot as plt
import numpy as np

from rayweave import optics

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
for n, colour in ((1.3311, "red"), (1.3429, "blueviolet")):
    drop = optics.ball_lens(2.0, material=n)
    light = optics.beam(1.999, 40_000).translate([0, 0, -5])
    trace = optics.System([drop]).trace(light, branches="both", threshold=1e-7, generation_limit=4)
    # two refractions and one reflection within: the third event is the exit
    back = (trace["generation"] == 3) & np.isnan(trace["z1"])
    angle = 180 - np.degrees(np.arccos(trace["z_tilt"][back]))
    right.hist(angle, bins=np.linspace(30, 45, 151), weights=trace["intensity"][back], histtype="step", color=colour, label=f"n = {n}")
    sine = np.sqrt((4 - n**2) / 3)
    exact = np.degrees(4 * np.arcsin(sine / n) - 2 * np.arcsin(sine))
    right.axvline(exact, color=colour, ls=":")
    print(f"n = {n}: largest angle {angle.max():.3f}, after Descartes {exact:.3f} degrees")
    assert abs(angle.max() - exact) < 0.02

fan = optics.line_of_rays(0.06, 15, wavelength_nm=650).translate([0, 0.5, -4])
shown = optics.System([optics.ball_lens(2.0, material=1.3311)]).trace(fan, branches="both", threshold=1e-2, generation_limit=4)
shown.show(ax=left, escape=3, rays=15)
right.set(xlabel="angle from the direction back to the sun, degrees", ylabel="power")
right.legend()
