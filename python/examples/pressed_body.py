#!/usr/bin/env python3
"""Presses a body that stands turned in the world, and draws it as it gives way: pressed_body.py DATABASE [PICTURE]

The tool goes down on the highest vertex. The picture needs matplotlib.
"""
import sys

import numpy

import palpate

db = palpate.open(sys.argv[1])
tool = db.tool(db.tools[0])
renderer = palpate.Renderer(db, tool.name)
renderer.place([0.3, 0.0, 1.0], [numpy.sin(0.2), 0.0, 0.0, numpy.cos(0.2)])  # 0.4 rad about x
rest = renderer.vertices  # in the world, as all that follows
top = rest[rest[:, 2].argmax()]
for i in range(1001):  # one second: from 5 mm above to 3 mm inside
    depth = -0.005 + 0.008 * i / 1000
    force = renderer.step(top + [0.0, 0.0, tool.radius_m - depth], 0.001)
    if i % 10 == 0:
        renderer.slow_step()
contacts, moved = renderer.contact_table(), renderer.displaced()
print(f"force {numpy.linalg.norm(force):.4g} N at {contacts['point_m'][0].round(4)}, " +
      ("no displacement is stored" if moved is None else f"the surface moves by {1e3 * abs(moved).max():.3g} mm"))
if len(sys.argv) > 2:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    axes = plt.figure().add_subplot(projection="3d")
    axes.plot_trisurf(*(rest if moved is None else rest + moved).T, triangles=db.triangles)
    axes.quiver(*contacts["point_m"][0], *(0.1 * force), color="red")
    plt.savefig(sys.argv[2])
