"""Document 001's skeleton as plans."""

from __future__ import annotations

REACH = """\
robot: skeleton
curves: {q1: pi/3 + sin(t)/2, q2: pi/4*sin(2*t)}
base: {x: 3*t/10, y: t**2/10, rpy: [0, 0, t/7]}
time: 5
sample: 1/50
values: {l0: 0.4, l1: 0.3, Tx: 0.1, Ty: 0.2}
"""
"""beta = q1, alpha = q2, and a root that moves; document 001 asks for any curves."""

ROOT = """\
robot: skeleton-root
curves: {q1: 3*t/10, q2: t**2/10, q3: pi/3 + sin(t)/2, q4: pi/4*sin(2*t)}
time: 5
values: {l0: 0.4, l1: 0.3}
"""
"""The same with the root's translation as joints (slides 28 and 29)."""
