"""What the package says of itself."""
import ast
import inspect
import pathlib

import pytest

import palpate

STUB = pathlib.Path(palpate.__file__).with_name("__init__.pyi")


def names_in(body):
    return {part.name if hasattr(part, "name") else part.target.id for part in body
            if isinstance(part, (ast.FunctionDef, ast.ClassDef))
            or (isinstance(part, ast.AnnAssign) and getattr(part.annotation, "id", "") != "TypeAlias")}


def test_stubs_name_what_there_is():
    tree = ast.parse(STUB.read_text())
    assert names_in(tree.body) == set(palpate.__all__)
    for part in tree.body:
        if isinstance(part, ast.ClassDef) and not issubclass(getattr(palpate, part.name), Exception):
            there = {name for name in vars(getattr(palpate, part.name)) if not name.startswith("_")}
            stated = {name for name in names_in(part.body) if not name.startswith("_")}
            of_instances = {"report", "depth_m", "force_n", "time_s", "metadata", "database"}
            assert there <= stated and stated - there <= of_instances, part.name
    assert STUB.with_name("py.typed").exists()


@pytest.mark.parametrize("name", [name for name in palpate.__all__ if name != "__version__"])
def test_everything_says_what_it_is(name):
    there = getattr(palpate, name)
    if inspect.isclass(there) and issubclass(there, Exception):
        assert issubclass(there, palpate.Error) and there.__module__ == "palpate"
        return
    assert inspect.getdoc(there), name
    if inspect.isclass(there):
        for member, value in vars(there).items():
            if callable(value) and not member.startswith("_") and member != "to_dict":
                assert inspect.getdoc(value), f"{name}.{member}"


def test_arguments_of_stubs_are_those_of_functions():
    for part in ast.parse(STUB.read_text()).body:
        if not isinstance(part, ast.FunctionDef):
            continue
        try:
            there = inspect.signature(getattr(palpate, part.name)).parameters
        except ValueError:
            continue  # compiled
        stated = [a.arg for a in part.args.args + part.args.kwonlyargs]
        assert [name for name, p in there.items() if p.kind != p.VAR_KEYWORD] == [
            name for name in stated if name in there], part.name


def test_no_room_for_another_version():
    assert palpate.__version__.count(".") == 2
