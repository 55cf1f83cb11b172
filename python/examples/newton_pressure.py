#!/usr/bin/env python3
"""A measured body's pressure law as a hydroelastic simulator takes it: newton_pressure.py [DATABASE]

Newton asks for pressure_func(signed_depth, shape, data), below 0 inside the shape, that never rises with signed_depth.
Its kernels interpolate a table as pressure() does, under warp.func. Newton is not needed: a stand-in sums the pressure
over the contact patch of a rigid ball on a flat, compliant shape.
"""
import sys

import numpy

import palpate


def table_of(law, n=129):
    """What the kernel is given: the spacing of depths [m], the pressures there [Pa], the slope outside [Pa/m]."""
    depth, pressure = law.table(n)
    return {"step": depth[1], "pressure": pressure, "outside": law.hydroelastic_modulus(1.0)["slope_pa_per_m"]}


def pressure(signed_depth, data):
    """p [Pa]: linear between the table's depths, level beyond it, falling on outside of the shape."""
    at = -signed_depth / data["step"]
    inside = numpy.interp(at, numpy.arange(len(data["pressure"])), data["pressure"])
    return numpy.where(at > 0.0, inside, -data["outside"] * signed_depth)


def force_of_patch(radius_m, depth_m, data, cells=400):
    """The stand-in's contact: a ball's surface over the plane z = 0, in rings."""
    edge = numpy.linspace(0.0, numpy.sqrt(2.0 * radius_m * depth_m), cells + 1)
    r = 0.5 * (edge[1:] + edge[:-1])
    return numpy.sum(pressure(r ** 2 / (2.0 * radius_m) - depth_m, data) * numpy.pi * numpy.diff(edge ** 2))


def main():
    if len(sys.argv) > 1:
        db = palpate.open(sys.argv[1])
    else:
        import haptic_loop
        db = haptic_loop.sheet()
    tool = db.tool(db.tools[0])
    node = int(numpy.nanargmax(tool.stiffness(0.0005)))
    law = tool.pressure_law(node)
    data = table_of(law)
    for share in (0.25, 0.5, 1.0):
        depth = share * law.depth_max_m
        stored, patch = law.force(depth), force_of_patch(law.radius_m, depth, data)
        print(f"{1e3 * depth:.2f} mm: stored {stored:.4g} N, over the patch {patch:.4g} N, off {patch / stored - 1:+.2%}")


if __name__ == "__main__":
    main()
