"""
A radiograph
============

The thickness of steel along parallel rays, and the X-ray picture of a point source (a cone beam) on a flat detector.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

neck = rw.tube(16, 12.5, 30).translate([0, 0, 11])
holes = rw.place(rw.cylinder(3.3), [[32 * np.cos(a), 32 * np.sin(a), 0] for a in np.radians(np.arange(0, 360, 60))])
flange = (rw.cylinder(40, 8) | neck) - rw.cylinder(12.5) - holes
steel = rw.Model([rw.Region("flange", flange, medium="steel")], {"steel": {"attenuation": 0.05}})  # per mm

found = rw.thickness(steel, view="front", size=(240, 160))
figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
shown = axes[0].imshow(found["steel"], extent=found.extent)
figure.colorbar(shown, ax=axes[0], label="mm of steel")
axes[0].set(xlabel="x from the centre [mm]", ylabel="z from the centre [mm]", title="parallel rays")

# the source is 150 mm from the axis, the detector, 160 mm high, 150 mm behind it
source, distance, height = [0, -150, 60], 300, 160
cone = rw.Camera(position=source, target=[0, 0, 11], field_of_view=2 * np.degrees(np.arctan(height / 2 / distance)))
image = rw.thickness(steel, camera=cone, size=(240, 160))
shown = axes[1].imshow(image.line_integral, cmap="gray")
figure.colorbar(shown, ax=axes[1], label="line integral of the attenuation")
axes[1].set_title("cone beam")

# the longest way through the disc passes beside the bore
assert 60 < found["steel"].max() < 80
