#!/usr/bin/env python3
"""A body's hydroelastic modulus for Drake, with what one number misses: drake_hydroelastic.py THICKNESS-M [DATABASE]

Drake's compliant half space has the pressure p = modulus * d / slab_thickness. Without pydrake the properties go to a
stand-in. The modulus belongs to the tool's radius; a ball of another one meets other forces (PressureLaw).
"""
import sys

import numpy

import palpate

try:
    from pydrake.geometry import AddCompliantHydroelasticPropertiesForHalfSpace, ProximityProperties
except ImportError:
    ProximityProperties = dict

    def AddCompliantHydroelasticPropertiesForHalfSpace(slab_thickness, hydroelastic_modulus, properties):
        properties.update(slab_thickness=slab_thickness, hydroelastic_modulus=hydroelastic_modulus)


def properties_of(law, thickness_m, depth_max_m=None):
    """Proximity properties of a half space that stands for the body under law's ball, and the fit they are of."""
    fit = law.hydroelastic_modulus(thickness_m, depth_max_m)
    properties = ProximityProperties()
    AddCompliantHydroelasticPropertiesForHalfSpace(thickness_m, fit["modulus_pa"], properties)
    return properties, fit


def main():
    thickness_m = float(sys.argv[1])
    if len(sys.argv) > 2:
        db = palpate.open(sys.argv[2])
    else:
        import haptic_loop
        db = haptic_loop.sheet()
    tool = db.tool(db.tools[0])
    law = tool.pressure_law(int(numpy.nanargmax(tool.stiffness(0.0005))))
    for share in (0.5, 1.0):
        properties, fit = properties_of(law, thickness_m, share * law.depth_max_m)
        print(f"modulus {fit['modulus_pa']:.4g} Pa up to {1e3 * share * law.depth_max_m:.2f} mm under a ball of "
              f"{1e3 * law.radius_m:g} mm: pressure misses {fit['misfit_relative']:.0%}, force at the end is off "
              f"{fit['force_error_relative']:+.0%}")
    laws = tool.pressure_laws(33)
    print(f"over the body from {thickness_m * numpy.nanmin(laws['slope_pa_per_m']):.4g} to "
          f"{thickness_m * numpy.nanmax(laws['slope_pa_per_m']):.4g} Pa")


if __name__ == "__main__":
    main()
