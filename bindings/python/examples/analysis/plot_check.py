"""
Mistakes in a model
===================

`check` finds an overlap, a thin wall and a hole that misses its plate, each with a place. Findings that know one have a
section as a picture.
"""

import matplotlib.pyplot as plt

import rayweave as rw

plate = rw.box([60, 40, 8]) - rw.cylinder(5).translate([40, 0, 0]) - rw.box([20, 20, 7]).translate([-10, 0, 1])
bolt = rw.cylinder(5, 30).translate([24, 0, 10])
model = rw.Model(
    [rw.Region("plate", plate, medium="steel"), rw.Region("bolt", bolt, medium="brass")],
    {"steel": {}, "brass": {}},
)
report = rw.check(model, wall=2, cells=64, pictures=True)
for finding in report:
    print(f"{finding.kind:9} {finding.text}")
kinds = {finding.kind for finding in report}
assert {"overlap", "thin", "absorbed"} <= kinds

shown = [finding for finding in report if finding.section is not None][:2]
figure, axes = plt.subplots(1, len(shown), figsize=(5 * len(shown), 3.2), layout="constrained", squeeze=False)
for axis, finding in zip(axes[0], shown, strict=True):
    for k, name in enumerate(finding.section.names):
        for number, contour in enumerate(finding.section.contours(name)):
            axis.fill(*contour.T, alpha=0.6, color=f"C{k}", label=name if number == 0 else None)
    axis.set(aspect="equal", title=finding.kind)
    axis.legend(fontsize=8)
