#!/usr/bin/env python3
"""wheel.py PACKAGE VERSION FOLDER: a wheel of the built package PACKAGE, by Debian's python3-wheel, into FOLDER.

For the Python that runs this, and for systems with the shared libraries that the module was linked with (Debian 12:
those of libpalpate and of palpate-fit). Needs no network.
"""
import pathlib
import shutil
import subprocess
import sys
import sysconfig
import tempfile

METADATA = """Metadata-Version: 2.1
Name: palpate
Version: {version}
Summary: Force-deflection responses of soft bodies: arrays, fits, passive rendering
License: Apache-2.0
Requires-Python: =={python}.*
Requires-Dist: numpy
"""
WHEEL = """Wheel-Version: 1.0
Generator: palpate
Root-Is-Purelib: false
Tag: {tag}
"""


def main():
    package, version, folder = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
    major, minor = sys.version_info[:2]
    tag = f"cp{major}{minor}-cp{major}{minor}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    with tempfile.TemporaryDirectory() as scratch:
        tree = pathlib.Path(scratch) / "palpate"
        shutil.copytree(package, tree / "palpate", ignore=shutil.ignore_patterns("__pycache__"))
        info = tree / f"palpate-{version}.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(METADATA.format(version=version, python=f"{major}.{minor}"))
        (info / "WHEEL").write_text(WHEEL.format(tag=tag))
        shutil.copy(pathlib.Path(__file__).parent.parent / "LICENSE.Apache-2.0", info)
        folder.mkdir(parents=True, exist_ok=True)
        subprocess.run([sys.executable, "-m", "wheel", "pack", tree, "-d", folder], check=True)


if __name__ == "__main__":
    main()
