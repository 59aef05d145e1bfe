"""Tests of verify.py: `python3 -m unittest` in this folder."""

import contextlib
import copy
import io
import json
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import cobra
import verify

HERE = Path(__file__).resolve().parent
CASES = sorted(HERE.glob("*.json"))


def said(*arguments):
    """What verify.py says of files, and how it ends."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = verify.main([str(argument) for argument in arguments])
    return code, out.getvalue(), err.getvalue()


def set_at(table, path, value):
    for key in path[:-1]:
        table = table[key]
    table[path[-1]] = value(table[path[-1]]) if callable(value) else value


def moved(joints):
    return [joints[0] + 0.01, *joints[1:]]


def flipped(joints):
    """The other posture of a wrist: the same pose of the tool where axes 4 and 6 share their centre."""
    return [*joints[:3], joints[3] + (180.0 if joints[3] < 0 else -180.0), -joints[4],
            joints[5] + (180.0 if joints[5] < 0 else -180.0)]


class Cases(unittest.TestCase):
    def setUp(self):
        self.case = json.loads((HERE / "kr500-raster.json").read_text())
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def written(self, table, name="case.json"):
        (self.folder / name).write_text(table if isinstance(table, str) else json.dumps(table))
        return self.folder / name

    def refused(self, table, *words, renewed=False):
        if renewed:
            table["digest"] = verify.digest(table)
        code, out, err = said(self.written(table))
        self.assertEqual((code, out, err.count("\n")), (1, "", 1), err)
        for word in ("case.json: ", *words):
            self.assertIn(word, err)

    def test_all_cases_hold(self):
        code, out, err = said(*CASES)
        self.assertEqual((code, err, out.count("holds")), (0, "", 16))

    def test_every_change_of_a_case_is_seen(self):
        problem = [
            (("robot", "rows", 1, "compliance_urad_per_nm"), lambda c: [c[0], c[1] * 1.001], "stated.value_mm"),
            (("robot", "rows", 2, "a_mm"), lambda a: a + 0.1, "off its point"),
            (("robot", "rows", 4, "max_deg"), 0.0, "is outside"),
            (("tool", "rotation", 0, 2), lambda v: v + 1e-3, "the tool axis"),
            (("constraints", "min_inverse_condition"), 0.9, "inverse condition"),
            (("redundancy", "max_spindle_turn_deg_per_mm"), 1e-3, "max_spindle_turn_deg_per_mm"),
            (("criterion", "force_uncertainty"), 0.11, "stated.value_mm"),
            (("criterion", "direction"), "wall", "stated.value_mm"),
            (("task", "points", 7, 1), lambda x: x + 1.0, "off its point"),
            (("cell", "xyz_mm", 0), [0, 1], "outside the cell"),
            (("task", "points", 9), lambda row: row[:-1], "task.points[9]"),
            (("robot", "rows", 0, "max_deg"), -1e3, "is outside"),
        ]
        for path, value, word in problem:
            changed = copy.deepcopy(self.case)
            set_at(changed, path, value)
            with self.subTest(path):
                self.refused(copy.deepcopy(changed), "digest")
                self.refused(changed, word, renewed=True)
        stated = [
            (("stated", "joints_deg", 5), moved, "stated.joints_deg[5]"),
            (("stated", "joints_deg", 5), flipped, "posture class"),
            (("stated", "joints_deg"), lambda rows: rows[:-1], "stated.joints_deg: has 59 points, the task 60"),
            (("stated", "placement", "yaw_deg"), lambda yaw: yaw + 0.01, "off its point"),
            (("stated", "placement", "xyz_mm", 2), 1e4, "stated.placement.xyz_mm: z"),
            (("stated", "value_mm"), lambda v: v * 1.00001, "stated.value_mm"),
            (("stated", "bound_mm"), 1.0, "stated.bound_mm"),
            (("stated", "bound_mm"), lambda v: v * 0.99, "stated.gap_percent"),
            (("stated", "gap_percent"), 0.5, "stated.gap_percent"),
        ]
        for path, value, word in stated:
            changed = copy.deepcopy(self.case)
            set_at(changed, path, value)
            with self.subTest(path):
                self.refused(changed, word)

    def test_what_is_no_case_is_refused(self):
        text = json.dumps(self.case)
        for wrong, word in [
            ("{", "cannot be read"), ("[]", "file: must be a table"), ("{}", "format: missing"),
            (text.replace('"name": "kr500-raster"', '"name": 1'), "name: must be text"),
            (text.replace('"format"', '"formt"', 1), "formt: unknown key"),
            (text.replace('"name"', '"name": "twice", "name"', 1), "name: given twice"),
            (text.replace('"yaw_deg": ', '"yaw_deg": NaN, "x": ', 1), "stated.placement"),
            (text.replace('"characteristic_length_mm": 682.0', '"characteristic_length_mm": 1e999'), "finite"),
            (text.replace('"characteristic_length_mm": 682.0', '"characteristic_length_mm": true'), "finite"),
            (text.replace("placement case 1", "placement case 2"), "format: must be placement case 1"),
        ]:
            with self.subTest(word):
                self.refused(wrong, word)
        self.assertEqual(said(self.folder / "none.json")[0], 1)
        self.assertEqual(said()[0], 2)
        self.assertEqual(said("--help")[0], 2)

    def test_answers(self):
        case = self.written(self.case)
        answer = {"format": "placement answer 1", "case": self.case["name"], "digest": self.case["digest"],
                  "placement": self.case["stated"]["placement"], "joints_deg": self.case["stated"]["joints_deg"]}
        code, out, _ = said(case, "--answer", self.written(answer, "mine.json"))
        self.assertEqual(code, 0)
        self.assertIn("the same as the stated plan", out)
        # Of a case whose bound is too high an answer says so.
        high = copy.deepcopy(self.case)
        value = high["stated"]["value_mm"]
        high["stated"] |= {"bound_mm": value * 0.9999, "gap_percent": 0.01}
        high = self.written(high, "high.json")
        with unittest.mock.patch.object(verify, "examine", side_effect=[value, value * 0.99]):
            code, out, _ = said(high, "--answer", self.written(answer, "mine.json"))
        self.assertEqual(code, 0)
        self.assertIn("BELOW THE BOUND", out)
        for changed, word in [({"digest": "0"}, "digest: belongs to another case"), ({"x": 1}, "x: unknown key"),
                              ({"joints_deg": answer["joints_deg"][:-1]}, "joints_deg: has 59 points, the task 60")]:
            code, _, err = said(case, "--answer", self.written(answer | changed, "mine.json"))
            self.assertEqual((code, err.count("\n")), (1, 1))
            self.assertIn("mine.json: " + word, err)

    def test_tasks_of_cobra_have_the_goals_of_the_path_and_the_base_in_reach_of_the_cell(self):
        task = cobra.cobra(self.case)
        self.assertEqual(len(task["goals"]), len(self.case["task"]["points"]))
        base = task["constraints"][2]["pose"]
        at = [v / 1e3 for v in self.case["stated"]["placement"]["xyz_mm"]]
        low, high = base["tolerance"][0]
        self.assertTrue(low <= (at[0] ** 2 + at[1] ** 2) ** 0.5 <= high)
        low, high = base["tolerance"][2]
        self.assertTrue(low <= -at[2] - base["nominal"][2][3] <= high)


if __name__ == "__main__":
    unittest.main()
