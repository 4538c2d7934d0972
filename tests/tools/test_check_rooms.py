# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/check_rooms.py on small trees that are right and wrong."""
import subprocess
import sys

import pytest
from tools_of_source import TOOLS

ROOMS = "library mneme:\nbase:\nrobot:\nscene: robot\nlibrary mneme_ompl: mneme\nompl: scene\n"
RIGHT = """// what it does
#include "robot/tree.h"

#include "mneme/base.h"
#include "mneme/robot.h"

#include "robot/joints.h"

#include <Eigen/Core>
#include <fmt/format.h>

#include <vector>
#include <unistd.h>

int tree();
"""


@pytest.fixture()
def tree(tmp_path):
    files = {"src/rooms.txt": ROOMS, "src/robot/tree.cpp": RIGHT, "src/robot/tree.h": "", "src/robot/joints.h": "",
             "include/mneme/base.h": "", "include/mneme/robot.h": "", "apps/console.h": "",
             "tests/base/base_test.cpp": "", "tests/robot/tree_test.cpp": "", "tests/scene/scene_test.cpp": "",
             "tests/ompl/ompl_test.cpp": ""}

    def write(changes=None):
        for name, text in {**files, **(changes or {})}.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(text)
        return tmp_path
    return write


def check(root, *arguments):
    done = subprocess.run([sys.executable, TOOLS / "check_rooms.py", root, *arguments], capture_output=True, text=True)
    return done.returncode, done.stdout


def test_a_tree_in_order_passes(tree):
    assert check(tree()) == (0, "10 files respect 4 rooms\n")


@pytest.mark.parametrize("name, text, message", [
    ("src/robot/a.cpp", '#include "scene/b.h"\n', "src/robot/a.cpp:1: robot may not include scene/b.h (room scene)"),
    ("src/robot/a.cpp", '#include "mneme/scene.h"\n', "robot may not include mneme/scene.h"),
    ("src/attic/a.cpp", "", "room attic is not in src/rooms.txt"),
    ("apps/a.cpp", '#include "robot/tree.h"\n', "apps/a.cpp:1: apps may include public headers"),
    ("include/mneme/scene.h", '#include "robot/tree.h"\n', "include/mneme/scene.h:1: include may include public headers"),
    ("python/a.cpp", '#include "console.h"\n', "python/a.cpp:1: python may include public headers"),
    ("src/ompl/a.cpp", '#include "robot/tree.h"\n', "src/ompl/a.cpp:1: src/ompl may include public headers"),
    ("include/mneme/mneme.h", '#include "mneme/ompl.h"\n', "mneme/ompl.h is not of the library mneme"),
    ("src/robot/a.cpp", '#include <vector>\n\n#include "mneme/robot.h"\n', "a.cpp:3: mneme/robot.h"),
    ("src/robot/a.cpp", '#include <vector>\n#include <Eigen/Core>\n', "Eigen/Core (third party <...>) belongs above"),
    ("src/robot/a.cpp", '#include "mneme/robot.h"\n#include <vector>\n', "a blank line belongs above vector"),
    ("src/robot/a.cpp", '#include <array>\n\n#include <vector>\n', "no blank line belongs above vector"),
    ("src/robot/tree.cpp", '#include "robot/joints.h"\n#include "robot/tree.h"\n', "robot/tree.h (own header)"),
    ("tests/robot/a_test.cpp", '#include <vector>\n\n#include "robot/tree.h"\n', 'robot/tree.h (other "...")'),
])
def test_each_mistake_is_named(tree, name, text, message):
    code, output = check(tree({name: text}))
    assert code == 1
    assert message in output


def test_a_room_uses_its_own_library_and_those_that_it_links(tree):
    root = tree({"src/rooms.txt": "library mneme:\nbase:\nlibrary mneme_view: mneme\nrobot:\nlibrary mneme_ompl: mneme\nscene: robot\n"})
    done = subprocess.run([sys.executable, TOOLS / "check_rooms.py", root], capture_output=True, text=True)
    assert done.returncode == 1
    assert "scene of mneme_ompl uses ['robot'], whose libraries it does not link" in done.stderr


def test_a_namespace_has_one_type_of_a_name(tree):
    def header(space, kind):
        return f"namespace mneme::{space} {{\n\n{kind}\n\n}}  // namespace mneme::{space}\n"
    one = header("internal", "struct Ball {\n  int a;\n};")
    same = {"src/robot/a.h": one, "src/scene/b.h": header("internal", "class Ball final\n    : public Round {\n};")}
    assert check(tree(same)) == (1, "src/scene/b.h: type Ball is defined in src/robot/a.h, too\n")
    assert check(tree({"src/robot/a.h": one, "src/scene/b.h": header("ompl", "struct Ball {\n};")}))[0] == 0
    assert check(tree({"src/robot/a.h": one, "src/scene/b.h": header("internal", "struct Ball;")}))[0] == 0


def test_a_constant_of_a_header_has_a_name_of_its_own(tree):
    def constant(space, value):
        return f"namespace mneme::{space} {{\n\ninline constexpr double kReach = {value};\n\n}}  // namespace mneme::{space}\n"
    header = {"src/robot/a.h": constant("internal", 15)}
    message = (1, "src/scene/b.cpp: constant kReach is defined in src/robot/a.h, too\n")
    for text in (constant("other", "0.25"), "constexpr int kReach{3};\n", "constexpr float kReach[] = {1, 2};\n"):
        assert check(tree({**header, "src/scene/b.cpp": text})) == message
    for text in ("struct A {\n  static constexpr int kReach = 3;\n};\n", "constexpr int kReachOfArm = 3;\n"):
        assert check(tree({**header, "src/scene/b.cpp": text}))[0] == 0
    apart = {"src/robot/a.cpp": "constexpr int kTries = 3;\n", "src/scene/b.cpp": "constexpr int kTries = 4;\n"}
    (tree() / "src/robot/a.h").unlink()
    assert check(tree(apart))[0] == 0


def test_a_private_header_is_shown_or_stays_in_its_room(tree):
    use = {"src/scene/a.cpp": '#include "robot/tree.h"\n'}
    assert check(tree(use)) == (1, "src/scene/a.cpp:1: robot/tree.h is private; src/rooms.txt says what robot shows\n")
    shown = {"src/rooms.txt": ROOMS.replace("robot:", "robot: | tree.h", 1)}
    assert check(tree({**use, **shown}))[0] == 0
    assert check(tree(shown), "--shown") == (0, "robot: 1\nin all: 1\n")
    assert check(tree({**shown, "src/scene/a.cpp": '#include "scene/a.h"\n'})) == (
        1, "src/rooms.txt: robot shows tree.h, which no other room includes\n")


def test_apps_include_their_own_headers_and_public_ones(tree):
    assert check(tree({"apps/a.cpp": '#include "mneme/robot.h"\n\n#include "console.h"\n'}))[0] == 0


def test_a_room_without_a_test_program_is_named(tree):
    root = tree()
    (root / "tests/scene/scene_test.cpp").unlink()
    assert check(root) == (1, "tests/scene: room scene has no test program (tests/scene/*_test.cpp)\n")


def test_fix_brings_includes_into_order_and_keeps_their_comments(tree):
    wrong = ('// what it does\n#include <vector>\n#include <fmt/format.h>\n// why this one\n#include "robot/joints.h"\n'
             '#include "mneme/base.h"\n\n\n#include "robot/tree.h"\n\nint tree();\n')
    root = tree({"src/robot/tree.cpp": wrong})
    assert check(root, "--fix")[0] == 0
    assert (root / "src/robot/tree.cpp").read_text() == (
        '// what it does\n#include "robot/tree.h"\n\n#include "mneme/base.h"\n\n// why this one\n'
        '#include "robot/joints.h"\n\n#include <fmt/format.h>\n\n#include <vector>\n\nint tree();\n')
    assert check(root)[0] == 0


@pytest.mark.parametrize("text", [
    '#include <vector>\n\n#define HWY_TARGET_INCLUDE "a.cpp"\n#include <hwy/foreach_target.h>\n\n#include "robot/tree.h"\n',
    '#include <vector>\n\n#ifdef X\n#include <string>\n#include "robot/tree.h"\n#endif\n',
])
def test_kernels_and_conditional_includes_stay_as_they_are(tree, text):
    root = tree({"src/robot/a.cpp": text})
    assert check(root, "--fix")[0] == 0
    assert (root / "src/robot/a.cpp").read_text() == text
