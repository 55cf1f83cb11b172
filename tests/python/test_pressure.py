"""Pressure laws: exact for the ball that they came from, off by what is stated for others."""
import json
import subprocess

import numpy
import pytest

import palpate
from conftest import RADIUS_M, sheet

MODULUS_PA = 9000.0  # E* of the half space
DEPTH_M = 0.004


def hertz(radius_m, depth):
    return 4.0 / 3.0 * MODULUS_PA * numpy.sqrt(radius_m) * depth ** 1.5


@pytest.fixture
def half_space():
    vertices, triangles = sheet()
    depth = DEPTH_M * numpy.linspace(0.0, 1.0, 80) ** 2
    curves = [(depth, hertz(RADIUS_M, depth))] * (len(vertices) - 1) + [None]
    return palpate.from_curves(vertices, triangles, curves, radius_m=RADIUS_M, tool="ball")


def integral(law, depth, radius_m):
    """2 pi R int_0^d p ds by the midpoint rule."""
    s = (numpy.arange(20000) + 0.5) * depth / 20000
    return 2.0 * numpy.pi * radius_m * law(s).mean() * depth


def test_hertz_gives_the_closed_form(half_space):
    law = half_space.pressure_law(7)
    d = numpy.linspace(0.1, 1.0, 50) * DEPTH_M
    assert numpy.allclose(law(d), MODULUS_PA * numpy.sqrt(d / RADIUS_M) / numpy.pi, rtol=0.01)
    assert law.radius_m == RADIUS_M and law.depth_max_m == pytest.approx(DEPTH_M, rel=1e-12)


def test_over_the_ball_it_is_the_stored_force(half_space, uneven, built):
    for db in (half_space, uneven, built):
        tool = db.tool("ball")
        for node in numpy.flatnonzero(numpy.diff(tool.sample_begin) > 0)[::7]:
            law, curve = tool.pressure_law(int(node)), tool.curve(int(node))
            c = abs(db.normals[node] @ tool.direction[node])
            assert integral(law, law.depth_max_m, law.radius_m) == pytest.approx(c * curve["force_n"][-1], rel=1e-3)
            assert law.force(curve["depth_m"] / c) == pytest.approx(c * curve["force_n"], rel=1e-12)


def test_other_radii_err_as_stated(half_space):
    law = half_space.pressure_law(0)
    for ratio, error in ((1.0, 0.0), (2.0, 0.41), (0.5, -0.29)):
        radius_m = ratio * RADIUS_M
        felt = law.force(DEPTH_M, radius_m)
        assert integral(law, DEPTH_M, radius_m) == pytest.approx(felt, rel=1e-3)
        assert felt / hertz(radius_m, DEPTH_M) - 1.0 == pytest.approx(error, abs=0.005)


def test_tables_are_the_law(half_space):
    law = half_space.pressure_law(3)
    depth, pressure = law.table(65)
    assert depth[0] == 0.0 and depth[-1] == law.depth_max_m and numpy.array_equal(pressure, law(depth))
    force = 2.0 * numpy.pi * RADIUS_M * numpy.trapz(pressure, depth)
    assert force == pytest.approx(hertz(RADIUS_M, DEPTH_M), rel=0.01)
    laws = half_space.pressure_laws(65)
    assert laws["radius_m"] == RADIUS_M and laws["pressure_pa"].shape == (25, 65)
    assert numpy.array_equal(laws["pressure_pa"][3], law(laws["depth_m"]))
    assert numpy.isnan(laws["pressure_pa"][24]).all() and numpy.isnan(laws["slope_pa_per_m"][24])
    assert laws["depth_max_m"][3] == law.depth_max_m
    fit = law.hydroelastic_modulus(0.02)
    assert (laws["slope_pa_per_m"][3], laws["misfit_relative"][3]) == (fit["slope_pa_per_m"], fit["misfit_relative"])


def test_one_modulus_misses_a_fifth_of_hertz(half_space):
    """p = C sqrt(d): the best slope is 6/5 C / sqrt(D), the rms misfit 1/5, the force at D 9/10."""
    fit = half_space.pressure_law(0).hydroelastic_modulus(0.03)
    slope = 1.2 * MODULUS_PA / (numpy.pi * numpy.sqrt(RADIUS_M * DEPTH_M))
    assert fit["modulus_pa"] == pytest.approx(0.03 * slope, rel=2e-3)
    assert fit["misfit_relative"] == pytest.approx(0.2, abs=0.003)
    assert fit["force_error_relative"] == pytest.approx(-0.1, abs=0.002)


def test_a_place_between_nodes_mixes_their_laws(uneven):
    tool = uneven.tool()
    a, b, c = uneven.triangles[5]
    share = numpy.array([0.5, 0.3, 0.2])
    law = tool.pressure_law(share @ uneven.vertices[[a, b, c]] + [0, 0, 0.001])
    d = numpy.linspace(0.0, DEPTH_M, 9)
    wanted = sum(w * tool.pressure_law(int(node))(d) for w, node in zip(share, (a, b, c)))
    assert numpy.allclose(law(d), wanted, rtol=1e-9)


def test_depths_of_any_shape_and_library(half_space):
    from test_batches import Foreign
    law = half_space.pressure_law(0)
    assert law(0.001).shape == () and law([[0.001, -1.0]]).shape == (1, 2) and law(-1.0) == 0.0
    assert law(Foreign(numpy.array([0.001])))[0] == law(0.001)
    assert law(2 * DEPTH_M) == law(DEPTH_M * (1 + 1e-9)) and numpy.isnan(law(numpy.nan))
    assert law.force(numpy.empty(0)).shape == (0,)


def test_the_law_keeps_its_database():
    vertices, triangles = sheet()
    law = palpate.from_curves(vertices, triangles, [([0, 0.001, 0.002], [0, 0.1, 0.3])] * 25,
                              radius_m=0.01).pressure_law(0)
    assert law.force(0.002) == pytest.approx(0.3, rel=1e-12)


@pytest.mark.parametrize("call", [
    lambda db: db.pressure_law(24), lambda db: db.pressure_law(-1), lambda db: db.pressure_law(25),
    lambda db: db.pressure_law([0.0, 0.0]), lambda db: db.pressure_law([0.0, 0.0, numpy.nan]),
    lambda db: db.pressure_law("ball"), lambda db: db.pressure_law(0, "other"),
    lambda db: db.pressure_law(0)("deep"), lambda db: db.pressure_law(0).table(1), lambda db: db.pressure_laws(0),
    lambda db: db.pressure_law(0).force(0.001, 0.0), lambda db: db.pressure_law(0).force(0.001, numpy.nan),
    lambda db: db.pressure_law(0).hydroelastic_modulus(0.0),
    lambda db: db.pressure_law(0).hydroelastic_modulus(0.01, -1.0)])
def test_wrong_questions_are_refused(half_space, call):
    with pytest.raises(palpate.InputError):
        call(half_space)


def test_other_tools_have_no_law(built):
    for call in (lambda: built.pressure_law(0, "pads"), lambda: built.pressure_laws(9, "pads"),
                 lambda: built.pressure_law([0.0, 0.0, 0.0], "pads")):
        with pytest.raises(palpate.InputError, match="^tool \"pads\" is a set of spheres: .* of one sphere$"):
            call()


def test_the_export_has_the_same_numbers(half_space, tmp_path):
    half_space.save(tmp_path / "body.h5")
    tool = palpate.find_tool("palpate-db")
    for name in ("law.csv", "law.json"):
        subprocess.run([tool, "export", tmp_path / "body.h5", "--pressure-law", "-o", tmp_path / name], check=True)
    laws = json.loads((tmp_path / "law.json").read_text())
    depth, pressure = palpate.open(tmp_path / "body.h5").pressure_law(4).table(33)
    assert laws["tool"]["radius_m"] == RADIUS_M and laws["law"][24] is None
    assert laws["law"][4]["depth_m"] == depth.tolist() and laws["law"][4]["pressure_pa"] == pressure.tolist()
    rows = numpy.genfromtxt(tmp_path / "law.csv", delimiter=",", names=True)
    assert numpy.array_equal(rows["pressure_pa"][rows["node"] == 4], pressure)
    said = subprocess.run([tool, "export", tmp_path / "body.h5", "--pressure-law", "-o", tmp_path / "law.vtu"],
                          capture_output=True, text=True)
    assert said.returncode == 2 and "must be .csv or .json" in said.stderr
