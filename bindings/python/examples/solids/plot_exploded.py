"""
Cut and exploded views
======================

Three ways to see the inside of an assembly: transparent parts, a removed quarter, and parts moved apart.
"""

import matplotlib.pyplot as plt

import rayweave as rw

housing = rw.cylinder(20, 30) - rw.cylinder(16, 26).translate([0, 0, 4])
ball = rw.sphere(4).translate([0, 0, 4])
balls = rw.place(ball, [[11, 0, 0], [-11, 0, 0], [0, 11, 0], [0, -11, 0]])
model = rw.Model(
    [
        rw.Region("housing", housing, colour="steelblue"),
        rw.Region("shaft", rw.cylinder(6, 50).translate([0, 0, 16]), colour="silver"),
        rw.Region("balls", balls, colour="goldenrod"),
        rw.Region("lid", rw.tube(20, 7, 4).translate([0, 0, 17.5]), colour="indianred"),
    ]
)

figure, axes = plt.subplots(1, 3, figsize=(10, 4), layout="constrained")
options = {"opacity": {"housing": 0.3, "lid": 0.3}}, {"cut": "x>50%,y<50%"}, {"explode": "z:0.4"}
for axis, option in zip(axes, options, strict=True):
    axis.imshow(rw.render(model, size=(320, 400), **option))
    axis.set_title("\n".join(f"{name}={value!r}" for name, value in option.items()), fontsize=8)
    axis.axis("off")

# the balls touch neither the shaft nor the wall
assert not rw.check(model, cells=48).of("overlap")
