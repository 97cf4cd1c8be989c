"""
Union, intersection, difference
===============================

The three operators on a box and a sphere, and the shape that they make together.
"""

import matplotlib.pyplot as plt

import rayweave as rw

box, ball, rod = rw.box(2), rw.sphere(1.35), rw.cylinder(0.6, 4)
rods = rod | rod.rotate_x(90) | rod.rotate_y(90)
solids = {
    "box | ball": box | ball,
    "box & ball": box & ball,
    "box - ball": box - ball,
    "(box & ball) - rods": (box & ball) - rods,
}

figure, axes = plt.subplots(1, 4, figsize=(10, 2.8), layout="constrained")
for axis, (text, solid) in zip(axes, solids.items(), strict=True):
    axis.imshow(rw.render(solid, size=(240, 200)))
    axis.set_title(f"{text}\nvolume {solid.volume:.3f}", fontsize=9)
    axis.axis("off")

# inclusion and exclusion
total = solids["box | ball"].volume + solids["box & ball"].volume
assert abs(total - (box.volume + ball.volume)) < 5e-3 * total
