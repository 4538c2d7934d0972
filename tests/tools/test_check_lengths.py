# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/check_lengths.py: what it takes for a function, and what it refuses."""
import subprocess
import sys

import pytest
from tools_of_source import TOOLS

import check_lengths


@pytest.mark.parametrize("code, expected", [
    ("int f() { return 1; }", [(1, "f", 1)]),
    ("int f() {\n  return 1;\n}\n", [(1, "f", 3)]),
    ("namespace a::b {\nnamespace {\nvoid f(int x = 3)\n{\n}\n}\n}\n", [(4, "f", 2)]),
    ("class A : public B {\n public:\n  A() : b_{1}, c_(2) {\n  }\n  int b_ = {};\n};\n", [(3, "A", 2)]),
    ("struct A {\n  bool operator==(const A&) const {\n    return true;\n  }\n};\n", [(2, "operator", 3)]),
    ("template <typename T = int>\nstruct A {\n  void f() const {\n  }\n};\n", [(3, "f", 2)]),
    ("constexpr Row kRows[] = {\n  {\"{\", [](int x) { return x; }},\n};\n", []),
    ("enum class A { a, b };\nstd::array<int, 2> x{1, 2};\n", []),
    ("TEST_SUITE(\"unit\") {\nTEST_CASE(\"a { b\") {\n  f([&] {\n    g();\n  });\n}\n}\n", [(2, "TEST_CASE", 5)]),
    ("void f() {\n  const char* a = R\"(})\";  // }\n  char c = '}'; int n = 1'000; /* } */\n#define X }\n}\n", [(1, "f", 5)]),
    ("void f() {\n  auto g = [](int x) {\n    struct B { int c; };\n    return x;\n  };\n}\n", [(1, "f", 6)]),
    ("auto f(int x) -> std::vector<int> {\n}\nint g() {\n}\n", [(1, "f", 2), (3, "g", 2)]),
    ("extern \"C\" int f(const char* a) {\n  return 1;\n}\n", [(1, "f", 3)]),
])
def test_functions_are_found_with_their_lines(code, expected):
    assert [(line, name, lines) for line, name, lines in check_lengths.functions(code)] == expected


def check(root, *arguments):
    done = subprocess.run([sys.executable, TOOLS / "check_lengths.py", root, *arguments], capture_output=True, text=True)
    return done.returncode, done.stdout


@pytest.fixture()
def tree(tmp_path):
    for folder in check_lengths.FOLDERS:
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "a.cpp").write_text("int f() { return 1; }\n")

    def write(**files):
        for name, text in {"src/robot/tree.h": "int tree();\n", **files}.items():
            (tmp_path / name).parent.mkdir(exist_ok=True)
            (tmp_path / name).write_text(text)
        return tmp_path
    return write


def function_of(lines):
    return "void f() {\n" + "  g();\n" * (lines - 2) + "}\n"


def test_what_is_within_the_limits_passes(tree):
    root = tree(**{"src/robot/a.cpp": function_of(50), "tests/b.cpp": function_of(60), "src/robot/c.cpp": "\n" * 600})
    assert check(root)[0] == 0


@pytest.mark.parametrize("files, message", [
    ({"src/robot/a.cpp": function_of(51)}, "src/robot/a.cpp:1: f has 51 lines, the limit is 50"),
    ({"tests/b.cpp": function_of(61)}, "tests/b.cpp:1: f has 61 lines, the limit is 60"),
    ({"apps/c.cpp": "\n" * 601}, "apps/c.cpp: 601 lines, the limit is 600"),
    ({f"src/robot/{i}.cpp": "\n" * 580 for i in range(7)}, "src/robot: 4061 lines, the limit of a room is 3500"),
    ({"src/robot/a.cpp": '#include "scene/b.h"\n', "src/scene/b.h": '#include "mneme/robot.h"\n'},
     "rooms include each other in a circle: robot, scene"),
])
def test_what_is_beyond_a_limit_is_named(tree, files, message):
    code, output = check(tree(**files))
    assert code == 1
    assert message in output


def test_the_table_lists_private_headers_with_one_user(tree):
    root = tree(**{"src/robot/tree.cpp": '#include "robot/tree.h"\n', "src/robot/b.cpp": '#include "robot/tree.h"\n'})
    assert "src/robot/tree.h: used by src/robot/b.cpp" in check(root, "--table")[1]
    tree(**{"tests/tree_test.cpp": '#include "robot/tree.h"\n'})
    assert "src/robot/tree.h" not in check(root, "--table")[1]
