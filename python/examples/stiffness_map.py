#!/usr/bin/env python3
"""From a mesh to a map of stiffness: stiffness_map.py PICTURE [MESH LENGTH-UNIT]

Without a mesh a block with a dome is pressed. Needs the tools (palpate-precompute) and matplotlib.
"""
import sys

import matplotlib
import matplotlib.pyplot as plt
import numpy

import palpate

DEPTH_M = 0.001


def dome(rings=6, radius_m=0.03):
    """A hemisphere on a flat base: vertices (n, 3) [m], triangles (t, 3)."""
    sides = 12
    vertices, triangles = [[0, 0, radius_m]], []
    for i in range(1, rings + 1):
        height = numpy.cos(0.5 * numpy.pi * i / rings)
        for turn in numpy.arange(sides) * 2 * numpy.pi / sides:
            flat = numpy.sqrt(1 - height * height)
            vertices.append([radius_m * flat * numpy.cos(turn), radius_m * flat * numpy.sin(turn), radius_m * height])
    base = len(vertices)
    vertices.append([0, 0, 0])
    for k in range(sides):
        after = (k + 1) % sides
        triangles.append([0, 1 + k, 1 + after])
        for i in range(rings - 1):
            a, b, c, d = (1 + (i + j) * sides + n for j in (0, 1) for n in (k, after))
            triangles += [[a, c, d], [a, d, b]]
        last = 1 + (rings - 1) * sides
        triangles.append([base, last + after, last + k])
    return numpy.array(vertices), numpy.array(triangles)


def draw(db, stiffness, file):
    figure = plt.figure(figsize=(6, 5))
    axes = figure.add_subplot(projection="3d")
    of_faces = numpy.nanmean(stiffness[db.triangles], axis=1)
    known = numpy.isfinite(of_faces)
    surface = axes.plot_trisurf(*(1e3 * db.vertices.T), triangles=db.triangles[known])
    surface.set_array(of_faces[known])
    figure.colorbar(surface, label=f"stiffness [N/m] {1e3 * DEPTH_M:g} mm deep")
    axes.set(xlabel="x [mm]", ylabel="y [mm]", zlabel="z [mm]")
    figure.savefig(file)


def main():
    matplotlib.use("Agg")
    vertices, triangles = palpate.read_mesh(*sys.argv[2:4]) if len(sys.argv) > 3 else dome()
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    db = palpate.precompute(
        vertices, triangles, youngs_modulus_pa=6000.0, radius_m=0.008, depth_max_m=0.003,
        support={"plane": {"point_m": [0, 0, low + 1e-4], "normal": [0, 0, 1]}},
        reach_box_m=[[-1, -1, low + 0.5 * (high - low)], [1, 1, high + 1]],
        force_relative=0.2, accuracy={"verify": 0, "depths": 6}, progress=print)
    stiffness = db.stiffness(DEPTH_M)
    print(f"{numpy.isfinite(stiffness).sum()} of {len(stiffness)} vertices: {numpy.nanmin(stiffness):.3g} to "
          f"{numpy.nanmax(stiffness):.3g} N/m")
    draw(db, stiffness, sys.argv[1])


if __name__ == "__main__":
    main()
