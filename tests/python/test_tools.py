import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import types

import numpy
import pytest

import palpate
from conftest import block
from palpate._mesh import write_obj

SCENE = {
    "material": [{"region": "body", "law": "linear", "youngs_modulus_pa": 5000.0, "poissons_ratio": 0.45}],
    "support": [{"box_m": [[-1, -1, -1], [1, 1, 0.001]]}],
    "tool": [{"name": "ball", "shape": "sphere", "radius_m": 0.01}],
    "reach": {"box_m": [[0.009, 0.009, 0.019], [0.031, 0.031, 1]], "depth_max_m": 0.003},
    "accuracy": {"force_relative": 0.5, "verify": 0, "depths": 3}}
LONG = {**SCENE, "reach": {**SCENE["reach"], "box_m": [[-1, -1, 0.019], [1, 1, 1]]}, "accuracy": {"force_relative": 0.03}}


def test_a_scene_gives_what_the_tool_gives(tmp_path):
    vertices, triangles = block()
    said = []
    db = palpate.build({"body": {"mesh": (vertices, triangles)}, **SCENE}, progress=said.append,
                       output=tmp_path / "own.h5")
    assert any(line.startswith("indentation") for line in said) and db.report["failed"] == 0
    (tmp_path / "block.obj").write_text("".join("v {!r} {!r} {!r}\n".format(*p) for p in vertices.tolist())
                                        + "".join("f {} {} {}\n".format(*t) for t in (triangles + 1).tolist()))
    scene = tmp_path / "scene.toml"
    scene.write_text("""
        [body]
        mesh = "block.obj"
        length_unit = "m"
        [[material]]
        region = "body"
        law = "linear"
        youngs_modulus_pa = 5000.0
        poissons_ratio = 0.45
        [[support]]
        box_m = [[-1, -1, -1], [1, 1, 0.001]]
        [[tool]]
        name = "ball"
        shape = "sphere"
        radius_m = 0.01
        [reach]
        box_m = [[0.009, 0.009, 0.019], [0.031, 0.031, 1]]
        depth_max_m = 0.003
        [accuracy]
        force_relative = 0.5
        verify = 0
        depths = 3
        """)
    subprocess.run([palpate.find_tool("palpate-precompute"), "build", scene, "-o", tmp_path / "tool.h5"], check=True,
                   capture_output=True)
    for other in (palpate.open(tmp_path / "tool.h5"), palpate.build(scene), palpate.open(tmp_path / "own.h5")):
        assert numpy.array_equal(other.vertices, vertices)
        for name in ("force_n", "depth_m", "direction", "error_relative", "sample_begin"):
            assert numpy.array_equal(getattr(other.tool(), name), getattr(db.tool(), name)), name


BODY = """
[body]
mesh = "{mesh}"
length_unit = "m"
[[support]]
plane = {{ point_m = [0, 0, 1e-4], normal = [0, 0, 1] }}
[reach]
box_m = [[0.019, 0.019, 0.019], [0.021, 0.021, 1]]
depth_max_m = 0.002
[accuracy]
force_relative = 0.5
verify = 0
depths = 3
"""
SOFT = """
[[material]]
region = "body"
law = "{law}"
youngs_modulus_pa = 5000.0
poissons_ratio = 0.4
"""
BALL = """
[[tool]]
name = "ball"
shape = "sphere"
radius_m = 0.01
"""
SCENES = {
    "neo-hookean": SOFT.format(law="neo-hookean") + BALL,
    "relaxing": SOFT.format(law="linear") + "relaxation = { g = [0.3, 0.2], tau_s = [0.1, 1.0] }" + BALL,
    "yielding": SOFT.format(law="linear") + "plastic = { yield_depth_m = 0.0005, share = 0.4 }" + BALL,
    "ogden": '[[material]]\nregion = "body"\nlaw = "ogden"\nmu_pa = [1500.0]\nalpha = [2.5]\npoissons_ratio = 0.4' + BALL,
    "punch": SOFT.format(law="linear")
             + '[[tool]]\nname = "punch"\nshape = "flat-punch"\nradius_m = 0.006\nedge_radius_m = 0.002',
    "cone": SOFT.format(law="linear")
            + '[[tool]]\nname = "cone"\nshape = "cone"\nhalf_angle_deg = 60\ntip_radius_m = 0.005\nfriction = 0.2\npresliding_m = 1e-4',
    "capsule": SOFT.format(law="linear")
               + '[[tool]]\nname = "rod"\nshape = "capsule"\nradius_m = 0.01\nlength_m = 0.01\naxis = [1, 0, 1]',
    "drawn": SOFT.format(law="linear") + BALL.replace("0.01", "0.04") + "[drawing]\ndisplacement = true"}


def arrays_in(part):
    """Every array of a tool, and what its dicts hold."""
    found = {}
    for name in dir(part):
        value = getattr(part, name)
        found.update({f"{name}/{k}": v for k, v in value.items()} if isinstance(value, dict) else {name: value})
    return {name: value for name, value in found.items() if isinstance(value, (numpy.ndarray, float, int, str, list))
            and not name.startswith("__")}


@pytest.mark.parametrize("name", SCENES)
def test_databases_of_dicts_are_those_of_files(name, tmp_path):
    import tomllib
    write_obj(tmp_path / "block.obj", *block())
    text = BODY.format(mesh=tmp_path / "block.obj") + SCENES[name]
    (tmp_path / "scene.toml").write_text(text)
    subprocess.run([palpate.find_tool("palpate-precompute"), "build", tmp_path / "scene.toml", "-o", tmp_path / "tool.h5"],
                   check=True, capture_output=True)
    by_tool = palpate.open(tmp_path / "tool.h5").tool()
    by_dict = palpate.build(tomllib.loads(text)).tool()
    wanted, got = arrays_in(by_tool), arrays_in(by_dict)
    assert wanted.keys() == got.keys() and len(wanted) > 40 and by_tool.force_n.max() > 0.0
    for key, value in wanted.items():
        assert numpy.array_equal(got[key], value, equal_nan=isinstance(value, (numpy.ndarray, float))
                                 and numpy.asarray(value).dtype.kind == "f"), key


@pytest.mark.parametrize("change, says", [
    ({"reach": {"depth_max_m": -1.0}}, "depth_max_m"), ({"tool": []}, "tool"), ({"colour": {"red": 1}}, "colour"),
    ({"body": {"mesh": "nothing.obj", "length_unit": "m"}}, "nothing.obj"), ({"body": 3}, "body")])
def test_wrong_scenes_are_refused_as_by_the_tool(change, says):
    with pytest.raises((palpate.InputError, palpate.FormatError), match=says):
        palpate.build({"body": {"mesh": block()}, **SCENE, **change})


def test_wrong_arguments_of_precompute_are_refused():
    rest = {"youngs_modulus_pa": 5000.0, "support": SCENE["support"], "depth_max_m": 0.003}
    for arguments, kind in [({}, palpate.InputError), ({"radius_m": 1.0, "tool": []}, palpate.InputError),
                            ({"radius_m": -1.0}, palpate.InputError), ({"radius_m": 0.01, "colour": 1}, TypeError)]:
        with pytest.raises(kind):
            palpate.precompute(*block(), **rest, **arguments)


class Interrupted(Exception):
    pass


def children(folder):
    """Tools that work on a scene in the folder."""
    found = []
    for process in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            arguments = process.read_bytes().decode(errors="replace").split("\0")
        except OSError:  # it has ended
            continue
        if arguments[0].endswith("palpate-precompute") and any(str(folder) in part for part in arguments[1:]):
            found.append(" ".join(arguments))
    return found


def test_an_exception_of_the_progress_ends_the_tool(monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))

    def stop(line):
        raise Interrupted(line)
    with pytest.raises(Interrupted):
        palpate.build({"body": {"mesh": block()}, **LONG}, progress=stop)
    assert not children(tmp_path) and not list(tmp_path.iterdir())


def test_the_tool_may_clean_up_before_it_ends(monkeypatch, tmp_path):
    def stop(line):
        raise Interrupted(line)
    own = tmp_path / "palpate-precompute"
    own.write_text(f"#!/bin/sh\ntrap 'echo cleaned > {tmp_path}/left; exit 130' INT\necho at work >&2\n"
                   "while true; do sleep 0.05; done\n")
    own.chmod(0o755)
    monkeypatch.setenv("PALPATE_TOOLS", str(tmp_path))
    with pytest.raises(Interrupted, match="at work"):
        palpate.build({"body": {"mesh": block()}, **SCENE}, progress=stop)
    assert (tmp_path / "left").read_text() == "cleaned\n"


def test_ctrl_c_ends_the_tool_and_leaves_nothing_behind(tmp_path):
    env = {**os.environ, "TMPDIR": str(tmp_path)}
    program = ("import palpate, test_tools, sys\n"
               "try:\n"
               "    palpate.build({'body': {'mesh': test_tools.block()}, **test_tools.LONG}, "
               "progress=lambda line: print(line, flush=True))\n"
               "except KeyboardInterrupt:\n"
               "    sys.exit(7)\n")
    with subprocess.Popen([sys.executable, "-c", program], env=env, stdout=subprocess.PIPE, text=True,
                          cwd=os.path.dirname(__file__)) as process:
        assert process.stdout.readline()  # at work
        process.send_signal(signal.SIGINT)
        assert process.wait(30) == 7
    assert not children(tmp_path) and not list(tmp_path.iterdir())


def test_threads_wait_for_tools_of_their_own():
    done = []
    threads = [threading.Thread(target=lambda: done.append(palpate.check(*block())["accepted"])) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert done == [True] * 4


def test_a_missing_tool_is_told_with_where_it_was_looked_for(monkeypatch, tmp_path):
    monkeypatch.setenv("PALPATE_TOOLS", str(tmp_path))
    with pytest.raises(palpate.ToolsMissing, match=str(tmp_path)):
        palpate.check(*block())
    monkeypatch.delenv("PALPATE_TOOLS")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(palpate.ToolsMissing, match=r"palpate-nothing .*palpate/bin.*PATH .*PALPATE_TOOLS") as caught:
        palpate.find_tool("palpate-nothing")
    assert "\n" not in str(caught.value)
    own = tmp_path / "palpate-nothing"
    own.write_text("#!/bin/sh\n")
    own.chmod(0o755)
    assert palpate.find_tool("palpate-nothing") == str(own)


def test_a_tool_that_dies_is_an_error(monkeypatch, tmp_path):
    monkeypatch.setenv("PALPATE_TOOLS", str(tmp_path))
    own = tmp_path / "palpate-precompute"
    for script, says in [("kill -9 $$", "ended with -9"), ("echo 'palpate-precompute: error: no luck' >&2; exit 4", "no luck"),
                         ("exit 0", "nothing")]:
        own.write_text(f"#!/bin/sh\n{script}\n")
        own.chmod(0o755)
        with pytest.raises(palpate.Error, match=says):
            palpate.build({"body": {"mesh": block()}, **SCENE}) if "exit 0" not in script else palpate.check(*block())


def test_surfaces_are_checked_mended_and_remeshed():
    vertices, triangles = block()
    report = palpate.check(vertices, triangles)
    assert report["accepted"] and report["volume_m3"] == pytest.approx(0.04 * 0.04 * 0.02)
    open_one = palpate.check(vertices, triangles[1:])
    assert not open_one["accepted"] and open_one["verdict"]
    with pytest.raises(palpate.InputError, match="^repair \"safe\" failed.*mode wrap makes a body of it$"):
        palpate.repair(vertices, triangles[1:])
    mended, faces, _ = palpate.repair(vertices, triangles[1:], mode="wrap")
    assert palpate.check(mended, faces)["accepted"]
    twice = numpy.vstack([triangles, triangles[:1]])
    assert not palpate.check(vertices, twice)["accepted"]
    assert numpy.array_equal(palpate.repair(vertices, twice)[0], vertices)
    even, faces, report = palpate.remesh(vertices, triangles, edge_m=0.006)
    assert palpate.check(even, faces)["accepted"] and report["edge_mean_m"] == pytest.approx(0.006, rel=0.2)
    with pytest.raises(palpate.InputError):
        palpate.repair(vertices, triangles[:5])
    with pytest.raises(palpate.InputError):
        palpate.remesh(vertices, triangles, edge_m=-1.0)


def test_meshes_of_others_are_taken_by_their_arrays():
    vertices, triangles = block()
    padded = numpy.column_stack([numpy.full(len(triangles), 3), triangles])
    wanted = palpate.check(vertices, triangles)
    for mesh in (types.SimpleNamespace(points=vertices, cells_dict={"triangle": triangles}),
                 types.SimpleNamespace(vertices=vertices, faces=triangles),
                 types.SimpleNamespace(points=vertices, regular_faces=triangles),
                 types.SimpleNamespace(points=vertices, faces=padded.ravel()), (vertices, triangles)):
        assert palpate.check(mesh) == wanted
    for wrong in (3, vertices, types.SimpleNamespace(points=vertices), (vertices, triangles.astype(float)),
                  (vertices, triangles + 1), (vertices[:, :2], triangles), (vertices * numpy.nan, triangles),
                  (vertices, padded), ([["a"] * 3], [[0, 0, 0]]),
                  types.SimpleNamespace(points=vertices, faces=numpy.arange(7))):
        with pytest.raises(palpate.InputError):
            palpate.check(wrong)
    with pytest.raises(palpate.InputError, match=r"nodes from 1 to 50, must lie in \[0, 49\]"):
        palpate.check(vertices, triangles + 1)


def test_coordinates_keep_all_of_their_digits(tmp_path):
    vertices, triangles = block()
    vertices = vertices * (1.0 + numpy.random.default_rng(1).uniform(0, 1, vertices.shape)) + 1e-17
    write_obj(tmp_path / "odd.obj", vertices, triangles)
    again, faces = palpate.read_mesh(tmp_path / "odd.obj", "m")
    assert numpy.array_equal(again, vertices) and numpy.array_equal(faces, triangles)
    with pytest.raises(palpate.InputError):
        palpate.read_mesh(tmp_path / "nothing.obj", "m")
    with pytest.raises(palpate.InputError):
        palpate.read_mesh(tmp_path / "odd.obj", "parsec")


def test_dicts_become_toml_that_says_the_same():
    import tomllib

    from palpate._toml import toml
    document = {"a": {"text": 'quoted "ä" \\ \n😀', "number": 1e-5, "whole": 3, "yes": True, "gone": None,
                      "rows": numpy.eye(2), "part": {"b c": [1, 2.5]}, "file": pathlib.Path("x/y"),
                      "of numpy": numpy.float64(0.1)},
                "list": [{"x": 1}, {"x": 2}]}
    read = tomllib.loads(toml(document))
    assert read["a"] == {"text": 'quoted "ä" \\ \n😀', "number": 1e-5, "whole": 3, "yes": True,
                         "rows": [[1.0, 0.0], [0.0, 1.0]], "part": {"b c": [1, 2.5]}, "file": "x/y", "of numpy": 0.1}
    assert read["list"] == [{"x": 1}, {"x": 2}]
    for wrong in ({"a": {"x": object()}}, {"a": 3}, {"a": {"x": 1 + 2j}}):
        with pytest.raises(TypeError):
            toml(wrong)
