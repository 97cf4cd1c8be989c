"""
A model with media
==================

A ball and a tube in a tank of water: a picture, a plane section, and the path lengths along one line.
"""

import matplotlib.pyplot as plt
import numpy as np

import rayweave as rw

model = rw.Model(
    regions=[
        rw.Region("tank", rw.box([20, 20, 10]), medium="water", colour="deepskyblue"),
        rw.Region("ball", rw.sphere(3).translate([0, 0, -1]), medium="glass", colour="gold"),
        rw.Region("tube", rw.cylinder(1.5, 30).rotate_x(90), medium="steel", colour="slategray"),
    ],
    media={"water": 1.33, "glass": 1.52, "steel": {"density": 7.85}},
)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
left.imshow(rw.render(model, size=(480, 360), opacity={"tank": 0.3}))
left.axis("off")
cut = rw.section(model, "yz")
for colour, name in zip(("deepskyblue", "gold", "slategray"), cut.names, strict=True):
    for number, contour in enumerate(cut.contours(name)):
        right.fill(*contour.T, color=colour, label=name if number == 0 else None, alpha=0.6)
right.set(aspect="equal", xlabel="y", ylabel="z", title="section x = 0")
right.legend()

# %%
# The later region has priority: the tube needs no hole in the ball.
pieces = model.partition([-50, 0, 1], [1, 0, 0], t_min=0, t_max=100)
print(pieces)
assert np.isclose((pieces.t_end - pieces.t_start).sum(), 100)
