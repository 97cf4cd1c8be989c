"""
A model file with parameters
============================

A model can be a text in TOML. Numbers may be expressions in parameters, and a program or a command line can change the
parameters without editing the text.
"""

import matplotlib.pyplot as plt

import rayweave as rw

FLANGE = """
rayweave = 1
unit = "mm"

[parameters]
bolts = 6
circle = 30
bolt = 6

[solid.disc]
cylinder = { radius = 40, height = 8 }
[solid.bore]
cylinder = { radius = 15 }
[solid.hole]
cylinder = { radius = "bolt / 2" }
[solid.holes]
place = { solid = "hole", ring = "bolts", radius = "circle" }
[solid.flange]
expr = "disc - bore - holes"

[[region]]
solid = "flange"
medium = "steel"
colour = "steelblue"
[medium.steel]
density = 7.85
"""

figure, axes = plt.subplots(1, 3, figsize=(10, 3), layout="constrained")
for axis, changes in zip(axes, ({}, {"bolts": 12}, {"bolts": 4, "bolt": 12, "circle": 27}), strict=True):
    model = rw.loads(FLANGE, changes)
    mass = rw.measure(model).mass[0]
    axis.imshow(rw.render(model, size=(320, 220)))
    axis.set_title(f"{changes or 'as written'}\n{mass:.1f} g", fontsize=9)
    axis.axis("off")
