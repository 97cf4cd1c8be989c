"""
What happens along one ray
==========================

The intervals of all shapes along one ray, how many of them contain each point, and the intervals of the result.
"""

import rayweave as rw

block = rw.box(4).named("block")
ball = rw.sphere(2.4).named("ball")
bore = rw.cylinder(0.8).named("bore")
part = (block & ball) - bore

drawing = rw.ray_timeline(part, [-4, 0.3, 0], [1, 0, 0.1], title="(block & ball) - bore")
print(part.explain([-4, 0.3, 0], [1, 0, 0.1]).crossings)
