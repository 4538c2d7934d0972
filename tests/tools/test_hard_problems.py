# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/hard_problems.py makes the problems that it says, and refuses what it cannot use."""
import json
import pathlib
import stat
import subprocess
import sys
import tempfile
import unittest

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools" / "hard_problems.py"
URDF = """<robot name="arm"><joint name="a" type="revolute"><limit lower="-1" upper="2"/></joint>
<joint name="b" type="continuous"/><joint name="c" type="prismatic"><limit upper="0.5"/></joint></robot>"""
PROBLEMS = {"joints": ["a", "b", "c"], "problems": [
    {"index": i, "start": [0, 0, 0], "goal": [1, 1, 0], "obstacles": [{"name": "can"}, {"name": "shelf"}]} for i in range(50)]}


class HardProblems(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (self.folder / "arm.urdf").write_text(URDF, encoding="utf-8")
        (self.folder / "all.json").write_text(json.dumps(PROBLEMS), encoding="utf-8")

    def run_tool(self, *arguments):
        return subprocess.run([sys.executable, TOOL, *arguments, "-o", "out"], cwd=self.folder, capture_output=True, text=True,
                              check=False)

    def made(self, *arguments):
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads((self.folder / "out").read_text(encoding="utf-8"))["problems"]

    def refusal(self, *arguments):
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, 2)
        return done.stderr

    def test_starts_are_random_within_limits_and_the_seed_makes_them(self):
        problems = self.made("starts", "all.json", "arm.urdf")
        for lower, upper, values in zip((-1, -3.15, 0), (2, 3.15, 0.5), zip(*(problem["start"] for problem in problems))):
            self.assertTrue(all(lower <= value <= upper for value in values))
            self.assertEqual(len(set(values)), 50)
        self.assertEqual([problem["goal"] for problem in problems], [[1, 1, 0]] * 50)
        self.assertEqual(problems, self.made("starts", "all.json", "arm.urdf"))
        self.assertNotEqual(problems, self.made("starts", "all.json", "arm.urdf", "--seed", "2"))

    def test_what_is_carried_is_no_obstacle(self):
        for problem in self.made("carry", "all.json", "hand", "can"):
            self.assertEqual(problem["obstacles"], [{"name": "shelf"}])
            self.assertEqual([held["link"] for held in problem["attached"]], ["hand"])

    def test_scenes_without_a_goal_are_counted_and_left_out(self):
        mneme = self.folder / "mneme"
        mneme.write_text('#!/bin/sh\ncase "$*" in *full.yaml*) echo \'{"solutions": []}\' ;; '
                         '*) echo \'{"solutions": [{"q": [1, 2]}]}\' ;; esac\n', encoding="utf-8")
        mneme.chmod(mneme.stat().st_mode | stat.S_IXUSR)
        done = self.run_tool("reach", "./mneme", "arm.urdf", "arm.srdf", "open.yaml", "full.yaml")
        self.assertEqual((done.returncode, done.stdout), (0, "1 of 2 scenes have a goal\n"), done.stderr)
        self.assertEqual([path.name for path in (self.folder / "out").iterdir()], ["reach_open.yaml"])
        text = (self.folder / "out" / "reach_open.yaml").read_text(encoding="utf-8")
        self.assertIn("goal: [1, 2]", text)
        self.assertIn(str(self.folder.resolve() / "open.yaml"), text)

    def test_what_it_cannot_use_is_named(self):
        (self.folder / "other.json").write_text("[]", encoding="utf-8")
        (self.folder / "broken.json").write_text("{", encoding="utf-8")
        (self.folder / "bare.urdf").write_text("<robot/>", encoding="utf-8")
        self.assertIn("other.json: expected compact problems with 'joints' and 'problems'", self.refusal("carry", "other.json", "a", "b"))
        self.assertIn("broken.json: ", self.refusal("carry", "broken.json", "a", "b"))
        self.assertIn("missing.json", self.refusal("carry", "missing.json", "a", "b"))
        self.assertIn("joint 'a' is none of the URDF's; expected limits", self.refusal("starts", "all.json", "bare.urdf"))
        self.assertIn("starts: expected PROBLEMS.json URDF, got 1 arguments", self.refusal("starts", "all.json"))
        self.assertIn("scene.yaml: no such robot", self.refusal("reach", self.failing_mneme(), "a.urdf", "a.srdf", "scene.yaml"))

    def failing_mneme(self):
        path = self.folder / "failing"
        path.write_text("#!/bin/sh\necho 'no such robot' >&2\nexit 1\n", encoding="utf-8")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return "./failing"


if __name__ == "__main__":
    unittest.main()
