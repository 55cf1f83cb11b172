"""Pressure over a tool's face, and tables of contacts, of a body that was built."""
import json
import subprocess

import numpy
import pytest

import palpate


def test_taxels_sum_to_the_force(built):
    tool = built.tool("ball")
    node = int(numpy.flatnonzero(numpy.diff(tool.sample_begin) > 0)[3])
    depth = 0.6 * tool.curve(node)["depth_m"][-1]
    radius = built.tool("ball").pressure_law(node).radius_m
    at = built.vertices[node] + (radius - depth) * built.normals[node]
    taxels = built.pressure(at, (30, 40, radius / 20), tool="ball")
    area = (radius / 20) ** 2
    assert taxels["pressure_pa"].shape == (30, 40)
    assert taxels["beside_n"] == 0.0
    assert taxels["pressure_pa"].sum() * area == pytest.approx(taxels["force_n"], rel=1e-9)
    # The field's force there, along the normal.
    normal_n = built.force(at, tool="ball") @ built.normals[node]
    assert taxels["force_n"] == pytest.approx(normal_n, rel=0.01)
    assert 0.5 * numpy.sqrt(radius * depth) < taxels["radius_m"] < 1.5 * numpy.sqrt(radius * depth)
    assert 0.0 < taxels["error_relative"] < 0.2


def test_far_away_there_is_no_pressure(built):
    taxels = built.pressure([0.0, 0.0, 1.0], (4, 4, 0.001), tool="ball")
    assert taxels["force_n"] == 0.0 and not taxels["pressure_pa"].any()


def test_wrong_grids_are_refused(built):
    for grid in ((4, 4), (0, 4, 0.001), (4, 4, -1.0), (4, 4, float("nan")), (2000, 4, 0.001)):
        with pytest.raises(palpate.InputError):
            built.pressure([0.0, 0.0, 0.02], grid, tool="ball")
    with pytest.raises(palpate.InputError):
        built.pressure([0.0, 0.0], (4, 4, 0.001), tool="ball")


def test_without_tables_it_says_so(flat):
    assert flat.tool("ball").contact == {}
    with pytest.raises(palpate.InputError, match="no pressures"):
        flat.pressure([0.0, 0.0, 0.005], (4, 4, 0.001), tool="ball")


def test_tables_have_a_row_per_node(built):
    contact = built.tool("ball").contact
    assert contact["pressure/moment_m2"].shape == (len(built.vertices), 12)
    assert contact["pressure/exponent"].shape == (len(built.vertices), 4)
