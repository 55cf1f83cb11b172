"""The flat form of a database: FLAT.md's own reader, and the package's."""
import pathlib
import re
import subprocess
import sys

import numpy
import pytest

import palpate

PAGE = pathlib.Path(__file__).parents[2] / "formats" / "flat" / "FLAT.md"


def test_the_reader_of_the_page_reads_what_the_library_wrote(uneven, tmp_path):
    uneven.save(tmp_path / "body.palpate")
    lines, = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.S)
    (tmp_path / "reader.py").write_text(lines)
    said = subprocess.run([sys.executable, "reader.py", "body.palpate"], cwd=tmp_path, check=True,
                          capture_output=True, text=True).stdout
    uneven.save(tmp_path / "body.h5")
    tool = uneven.tool("ball")
    largest = sorted(float(tool.curve(node)["force_n"].max()) for node in range(len(uneven.vertices)))
    name, forces = said.split(" ", 1)
    assert name == "ball"
    assert sorted(float(x) for x in re.findall(r"[\d.]+(?:e-?\d+)?", forces.replace("np.float64", ""))) == largest


@pytest.mark.parametrize("name", ["body.h5", "body.palpate"])
def test_bytes_are_opened_as_the_file_is(uneven, tmp_path, name):
    uneven.save(tmp_path / name)
    of_file = palpate.open(tmp_path / name)
    of_bytes = palpate.open((tmp_path / name).read_bytes())
    assert numpy.array_equal(of_bytes.vertices, uneven.vertices)
    at = uneven.vertices + [0.0, 0.0, 0.003]
    assert numpy.array_equal(of_bytes.force(at), uneven.force(at))
    assert numpy.array_equal(of_file.force(at), uneven.force(at))


def test_bytes_that_are_no_database():
    with pytest.raises(palpate.FormatError, match="bytes in memory: is not an HDF5 file"):
        palpate.open(b"solid cube")
