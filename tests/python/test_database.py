import pathlib

import h5py
import numpy
import pytest

import palpate

# Attribute of Tool, dataset of the file.
DATASETS = ["direction", "direction_spread_rad", "touch_offset_m", "error_relative", "friction",
            "presliding_m", "stiffness_max_n_per_m", "origin", "flags"]


def test_arrays_hold_what_the_file_holds(uneven, tmp_path):
    file = tmp_path / "body.h5"
    uneven.save(file)
    opened = palpate.open(file)
    with h5py.File(file) as h5:
        order = h5["body/source_node"][:]
        assert numpy.array_equal(opened.vertices[order], h5["body/position_m"][:])
        assert numpy.array_equal(opened.normals[order], h5["body/normal"][:])
        tool = opened.tool("ball")
        for name in DATASETS:
            assert numpy.array_equal(getattr(tool, name)[order], h5["tools/ball"][name][:]), name
        begin = h5["tools/ball/sample_begin"][:]
        for row, node in enumerate(order):
            for name, values in tool.curve(int(node)).items():
                stored = h5["tools/ball"][name][begin[row]:begin[row + 1]]
                assert numpy.array_equal(values, stored), (name, node)


def test_saved_twice_gives_the_same_bytes(uneven, tmp_path):
    uneven.save(tmp_path / "a.h5")
    palpate.open(tmp_path / "a.h5").save(tmp_path / "b.h5")
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "b.h5").read_bytes()


def test_arrays_are_views_that_nobody_can_write_to_and_outlive_the_database(flat):
    tool = flat.tool()
    depth = tool.depth_m
    assert numpy.shares_memory(depth, tool.depth_m)
    with pytest.raises(ValueError):
        depth[0] = 1.0
    kept = depth.copy()
    del flat, tool
    assert numpy.array_equal(depth, kept)


def test_files_that_are_not_databases(tmp_path):
    with pytest.raises(palpate.InputError, match="nothing.h5"):
        palpate.open(tmp_path / "nothing.h5")
    (tmp_path / "text.h5").write_text("not HDF5")
    with pytest.raises(palpate.FormatError):
        palpate.open(str(tmp_path / "text.h5"))
    with pytest.raises(TypeError):
        palpate.open(3)


def test_truncated_files_are_refused(flat, tmp_path):
    file = pathlib.Path(tmp_path / "body.h5")
    flat.save(file)
    file.write_bytes(file.read_bytes()[:-200])
    with pytest.raises(palpate.FormatError):
        palpate.open(file)


def test_an_unknown_tool_is_told_the_ones_there_are(flat):
    with pytest.raises(palpate.InputError, match="ball"):
        flat.tool("needle")


@pytest.mark.parametrize("change", [
    {"vertices": [[0, 0]]}, {"vertices": [["a", "b", "c"]]}, {"vertices": None},
    {"triangles": [[0, 1, 99]]}, {"triangles": [[0, 1, -1]]}, {"triangles": [[0.0, 1.0, 2.0]]},
    {"curves": []}, {"curves": [1, 2, 3]}, {"curves": [([0, 1], [0, 1, 2])] * 3},
    {"curves": [([0, 1], [0, numpy.nan])] * 3}, {"curves": [([0, 1, 0.5], [0, 1, 2])] * 3},
    {"radius_m": -1.0}, {"radius_m": numpy.nan}])
def test_wrong_parts_of_a_database_are_refused(change):
    parts = {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]],
             "curves": [([0, 0.1], [0, 1.0])] * 3, "radius_m": 0.1}
    palpate.from_curves(**parts)
    with pytest.raises(palpate.Error):
        palpate.from_curves(**{**parts, **change})


def test_optional_parts_are_empty_where_nobody_filled_them(flat):
    tool = flat.tool()
    assert tool.accuracy["budget_relative"] == 0.0
    assert tool.displacement["node"].size == 0
    assert tool.relaxation["g_1"].size == 0
    assert tool.viscoelasticity["tau_s"].size == 0
    assert tool.puncture["material"] == []
    assert tool.puncture["rupture"].size == 0
    assert flat.measurement["depth_m"].size == 0


def test_memory_is_steady(uneven, tmp_path, grown_kilobytes):
    file = tmp_path / "body.h5"
    depth = numpy.linspace(0.0, 0.004, 9)

    def call():
        uneven.save(file)
        opened = palpate.open(file)
        palpate.from_curves(opened.vertices, opened.triangles, [(depth, 200.0 * depth)] * len(opened.vertices),
                            radius_m=0.005)
    assert grown_kilobytes(call, 400) < 400  # a leak of a kilobyte a call would show
