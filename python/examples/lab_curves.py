#!/usr/bin/env python3
"""From a laboratory's files to a database: lab_curves.py DATABASE RADIUS-M FILE...

Every press of every file under a ball of that radius is fitted; the first that is fit for use becomes the database.
"""
import sys

import numpy

import palpate


def main():
    output, radius_m, files = sys.argv[1], float(sys.argv[2]), sys.argv[3:]
    curves = [curve for file in files for curve in palpate.load(file)]
    fits = []
    for curve in curves:
        try:
            fits.append(palpate.fit(curve, tool="sphere", radius_m=radius_m))
        except palpate.Error as error:
            print(f"{curve.metadata['file']}: {error}")
    table = palpate.table(fits)  # pandas.DataFrame(table) is a table
    for contact, modulus, rms, flags in zip(*(table[name] for name in (
            "contact_point_m", "youngs_modulus_pa", "rms_n", "flags"))):
        print(f"contact at {1e3 * contact:.3f} mm, E = {modulus:.4g} Pa, residual {rms:.2g} N  {flags}")
    usable = [fit for fit, modulus in zip(fits, table["youngs_modulus_pa"]) if numpy.isfinite(modulus)]
    if not usable:
        sys.exit("no press tells a modulus")
    usable[0].database().save(output)
    depth = 0.5 * usable[0].to_dict()["depth_max_m"]
    print(f"{output}: {palpate.open(output).stiffness(depth)[0]:.4g} N/m at {1e3 * depth:.2f} mm")


if __name__ == "__main__":
    main()
