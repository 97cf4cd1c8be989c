"""
Root-rays
=========

A root-ray is the side on which a trajectory starts and the times at which it changes sides. The operators combine root-rays
exactly: equal times toggle together.
"""

import rayweave as rw
from rayweave import RootRay

a = RootRay("outside", [1, 4, 6, 9])
b = RootRay("inside", [3, 6, 8])
results = {"a | b": a | b, "a & b": a & b, "a - b": a - b, "a ^ b": a ^ b, "~a": ~a}
drawing = rw.timeline({"a": a, "b": b}, results, title="root-rays", window=(0, 10))

for name, result in results.items():
    print(f"{name}: {result}")
# de Morgan
assert ~(a | b) == ~a & ~b
