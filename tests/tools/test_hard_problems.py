# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/hard_problems.py makes the problems that it says, and refuses what it cannot use."""
import json
import math
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


def area(numbers):
    """Of triangles, nine numbers each."""
    total = 0
    for i in range(0, len(numbers), 9):
        a, b, c = numbers[i:i + 3], numbers[i + 3:i + 6], numbers[i + 6:i + 9]
        u, v = [x - y for x, y in zip(b, a)], [x - y for x, y in zip(c, a)]
        total += 0.5 * math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    return total


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

    def solids(self, kind, *obstacles):
        text = json.dumps({"joints": ["a"], "problems": [{"start": [0], "goal": [1], "obstacles": list(obstacles)}]})
        (self.folder / "solids.json").write_text(text, encoding="utf-8")
        return self.made(kind, "solids.json")[0]["obstacles"]

    def test_meshes_have_the_surface_of_the_solids(self):
        turn = [math.cos(0.4), 0, 0, math.sin(0.4)]
        box, can = self.solids("meshes", {"name": "b", "type": "box", "p": [1, 2, 3], "q": turn, "size": [0.2, 0.4, 0.6]},
                               {"name": "c", "type": "cylinder", "p": [0, 0, 1], "q": [0, 1, 0, 0], "radius": 0.1, "length": 0.5})
        self.assertEqual((box["type"], box["name"]), ("mesh", "b"))
        self.assertAlmostEqual(area(box["triangles"]), 2 * (0.08 + 0.12 + 0.24), places=3)
        self.assertAlmostEqual(area(can["triangles"]), math.tau * 0.1 * 0.6, delta=0.01)
        self.assertAlmostEqual(max(box["triangles"][2::3]), 3.3)
        corner = [0.1 * math.cos(0.8) + 0.2 * math.sin(0.8), 0.1 * math.sin(0.8) - 0.2 * math.cos(0.8)]
        xy = {(round(x - 1, 3), round(y - 2, 3)) for x, y in zip(box["triangles"][::3], box["triangles"][1::3])}
        self.assertIn(tuple(round(value, 3) for value in corner), xy)

    def test_clouds_leave_no_hole_in_the_surface(self):
        scan, = self.solids("clouds", {"name": "c", "type": "cylinder", "p": [0, 0, 0], "q": [1, 0, 0, 0], "radius": 0.1, "length": 0.3},
                            {"name": "b", "type": "box", "p": [5, 0, 0], "q": [1, 0, 0, 0], "size": [0.1, 0.1, 0.1]})
        points = list(zip(*(scan["points"][i::3] for i in range(3))))
        for i in range(100):
            angle, height = 0.37 * i, 0.15 - 0.003 * i
            side = (0.1 * math.cos(angle), 0.1 * math.sin(angle), height)
            end = (0.001 * i * math.cos(angle), 0.001 * i * math.sin(angle), 0.15)
            self.assertLess(min(math.dist(side, point) for point in points), 0.0151)
            self.assertLess(min(math.dist(end, point) for point in points), 0.0151)
        self.assertTrue(any(x > 4.9 for x, _, _ in points))

    def test_clouds_of_many_points_are_as_large_as_their_solids(self):
        turn = [math.cos(0.4), 0, 0, math.sin(0.4)]
        text = json.dumps({"joints": ["a"], "problems": [{"obstacles": [
            {"name": "b", "type": "box", "p": [0, 0, 1], "q": turn, "size": [0.4, 0.3, 0.001]},
            {"name": "c", "type": "cylinder", "p": [0, 0, 0], "q": [1, 0, 0, 0], "radius": 0.1, "length": 0.3}]}]})
        (self.folder / "two.json").write_text(text, encoding="utf-8")
        board, can = self.made("segments", "two.json", "--points", "30000")[0]["obstacles"]
        self.assertEqual((board["name"], can["name"]), ("b", "c"))
        self.assertTrue(30000 <= (len(board["points"]) + len(can["points"])) / 3 < 36000)
        self.assertAlmostEqual(max(map(math.hypot, can["points"][::3], can["points"][1::3])) + can["radius"], 0.1, places=4)
        self.assertAlmostEqual(max(can["points"][2::3]) + can["radius"], 0.15, places=4)
        self.assertAlmostEqual(max(map(math.hypot, board["points"][::3], board["points"][1::3])), math.hypot(0.195, 0.145), places=4)
        (scan,) = self.made("clouds", "two.json", "--points", "30000")[0]["obstacles"]
        self.assertEqual(scan["points"], board["points"] + can["points"])

    def test_what_it_cannot_use_is_named(self):
        (self.folder / "other.json").write_text("[]", encoding="utf-8")
        (self.folder / "broken.json").write_text("{", encoding="utf-8")
        (self.folder / "bare.urdf").write_text("<robot/>", encoding="utf-8")
        self.assertIn("other.json: expected compact problems with 'joints' and 'problems'", self.refusal("carry", "other.json", "a", "b"))
        self.assertIn("broken.json: ", self.refusal("carry", "broken.json", "a", "b"))
        self.assertIn("missing.json", self.refusal("carry", "missing.json", "a", "b"))
        self.assertIn("joint 'a' is none of the URDF's; expected limits", self.refusal("starts", "all.json", "bare.urdf"))
        ball = {"joints": ["a"], "problems": [{"obstacles": [{"name": "ball", "type": "sphere"}]}]}
        (self.folder / "ball.json").write_text(json.dumps(ball), encoding="utf-8")
        self.assertIn("obstacle 'ball': expected a box or a cylinder, got a sphere", self.refusal("meshes", "ball.json"))
        self.assertIn("starts: expected PROBLEMS.json URDF, got 1 arguments", self.refusal("starts", "all.json"))
        self.assertIn("scene.yaml: no such robot", self.refusal("reach", self.failing_mneme(), "a.urdf", "a.srdf", "scene.yaml"))

    def failing_mneme(self):
        path = self.folder / "failing"
        path.write_text("#!/bin/sh\necho 'no such robot' >&2\nexit 1\n", encoding="utf-8")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return "./failing"


if __name__ == "__main__":
    unittest.main()
