# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""The module as a whole: names, stubs, documents."""
import ast
import inspect
import os
import pathlib
import re

import pytest

import mneme

PACKAGE = pathlib.Path(mneme.__file__).parent


def stub_definitions():
    tree = ast.parse((PACKAGE / "__init__.pyi").read_text())
    return {node.name: node for node in tree.body
            if isinstance(node, (ast.ClassDef, ast.FunctionDef))}


def keywords(function):
    pairs = zip(function.args.kwonlyargs, function.args.kw_defaults)
    return {argument.arg: ast.unparse(default) if default else None for argument, default in pairs}


def test_the_package_is_typed_and_has_a_version():
    assert (PACKAGE / "py.typed").exists()
    assert re.fullmatch(r"\d+\.\d+\.\d+", mneme.__version__)
    assert mneme.default_isa() in mneme.available_isas()


def test_stubs_name_what_the_module_exports():
    assert set(stub_definitions()) == set(mneme.__all__) - {"__version__"}


def test_stubs_of_classes_name_their_public_members():
    for name, node in stub_definitions().items():
        if not isinstance(node, ast.ClassDef) or name == "Error":
            continue
        declared = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
        declared |= {item.target.id for item in node.body if isinstance(item, ast.AnnAssign)}
        present = {member for member in vars(getattr(mneme, name)) if not member.startswith("_")}
        if name == "Benchmark":
            present.add("rows")
        assert present == {member for member in declared if not member.startswith("_")}, name


def documented_settings(doc):
    """Settings and defaults of a docstring, which come from the declarations in C++."""
    pattern = r"^(\w+): (?:bool|int|float|str) = ([^,\n]+)"
    return dict(re.findall(pattern, doc, re.MULTILINE))


def test_stubs_have_the_declared_settings_with_their_defaults():
    functions = {name: (getattr(mneme, name), node) for name, node in stub_definitions().items()
                 if name in ("plan", "learn", "learn_from_paths", "decompose")}
    load = next(item for item in stub_definitions()["Robot"].body
                if getattr(item, "name", "") == "load")
    functions["Robot.load"] = (mneme.Robot.load, load)
    for name, (function, node) in functions.items():
        declared = documented_settings(function.__doc__)
        assert declared, name
        stub = keywords(node)
        for setting, default in declared.items():
            assert setting in stub, (name, setting)
            assert ast.literal_eval(stub[setting]) == ast.literal_eval(default), (name, setting)
        named = set(re.findall(r"(\w+): ", function.__doc__.split("\n", 1)[0]))
        assert set(stub) <= set(declared) | named, name


def test_everything_public_has_a_docstring():
    for name in mneme.__all__:
        value = getattr(mneme, name)
        if callable(value):
            assert inspect.getdoc(value), name


def test_bytes_that_are_not_utf8_are_escaped_in_errors(tmp_path):
    (tmp_path / "bad.yaml").write_bytes(b"circles: {a: [0, 0, \xff]}\n")
    with pytest.raises(mneme.Error) as raised:
        mneme.Scene.load(tmp_path / "bad.yaml")
    assert "bad.yaml" in str(raised.value)
    with pytest.raises(mneme.Error, match=r"\\xff"):
        mneme.Robot.load(os.fsdecode(b"robot\xff"))


def test_an_error_says_its_code():
    assert issubclass(mneme.Error, Exception)
    assert mneme.Error("x").code == "invalid"


@pytest.mark.parametrize("load", [mneme.Robot.load, mneme.Problem.load, mneme.Scene.load, mneme.Task.load,
                                  mneme.Cell.load, mneme.Database.open, mneme.Database.verify,
                                  mneme.list_problems, mneme.find_scene])
def test_file_names_that_are_not_utf8_are_named_in_errors(load, tmp_path):
    path = os.fsencode(tmp_path) + b"/\xff.yaml"
    for name in (path, os.fsdecode(path)):
        with pytest.raises(mneme.Error, match=r"\\xff\.yaml"):
            load(name)


def test_files_whose_names_are_not_utf8_are_read(tmp_path):
    path = os.fsencode(tmp_path) + b"/\xff.yaml"
    with open(path, "w") as file:
        file.write("circles: {a: [1, 2, 3]}")
    assert len(mneme.Scene.load(path).warnings) == 0
    assert len(mneme.Scene.load(os.fsdecode(path)).warnings) == 0


@pytest.mark.parametrize("number", [10**400, -10**400, 10**5000], ids=["high", "low", "long"])
def test_numbers_beyond_all_ranges_are_refused_in_short_messages(number, problem):
    for keyword in ("timeout", "seed", "threads"):
        with pytest.raises(mneme.Error, match="is out of range") as caught:
            mneme.plan(problem, **{keyword: number})
        assert len(str(caught.value)) < 300
    with pytest.raises(TypeError, match="expected an array of real numbers"):
        mneme.Scene().add_sphere("a", [number, 0, 0], 1)


def test_control_c_within_a_conversion_is_not_another_error(problem):
    class Interrupted:
        def interrupt(self, *_):
            raise KeyboardInterrupt
        __index__ = __float__ = __array__ = __len__ = interrupt

    for call in (lambda: mneme.plan(problem, seed=Interrupted()), lambda: mneme.plan(problem, timeout=Interrupted()),
                 lambda: problem.robot.link_poses(Interrupted())):
        with pytest.raises(KeyboardInterrupt):
            call()


def test_unknown_keywords_are_refused_by_any_name(problem):
    with pytest.raises(TypeError, match="unexpected keyword argument"):
        mneme.plan(problem, **{"x\udcff": 1})
