"""tests/STABILITY.md: what it says is what the tests check, and every file with bounds is in it."""
import re
import subprocess
import unittest
from pathlib import Path

from harness import SHVR

ROOT = Path(__file__).resolve().parents[3]
TOOL = ROOT / "tools/make_stability_page"
# Rounding differs from processor to processor; a committed error is not far from today's.
FAR = 4.0


def rows_of(page):
    """(test, measured): [bound, error, inputs, worst input], of all tables."""
    rows = {}
    for line in page.splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 6 and cells[0] != "test" and not cells[0].startswith("---"):
            rows[cells[0], cells[1]] = cells[2:]
    return rows


class Stability(unittest.TestCase):
    def setUp(self):
        self.page = rows_of((ROOT / "tests/STABILITY.md").read_text())

    def test_no_case_is_without_a_bound_and_an_input(self):
        self.assertGreater(len(self.page), 120)
        for row, (bound, error, inputs, worst) in self.page.items():
            self.assertGreaterEqual(float(bound), 0.0, row)
            self.assertLessEqual(float(error), float(bound), row)
            self.assertGreater(int(inputs), 0, row)
            self.assertTrue(worst, row)

    def test_every_file_with_bounds_is_in_the_page(self):
        sections = TOOL.read_text()
        for kind in ("unit", "gpu"):
            for file in (ROOT / "tests" / kind).rglob("*_test.cpp"):
                if "check_below(" in file.read_text():
                    self.assertIn(f'"{file.relative_to(ROOT)}"', sections)

    def test_the_page_is_what_the_tests_measure(self):
        files = ["tests/unit/look/transfer_function_test.cpp", "tests/unit/device/occlusion_test.cpp",
                 "tests/unit/look/camera_test.cpp", "tests/gpu/raycast/raycast_integral_test.cpp"]
        result = subprocess.run([TOOL, "--stdout", Path(SHVR).resolve().parent, *files], capture_output=True, text=True,
                                timeout=300, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)
        measured = rows_of(result.stdout)
        self.assertGreater(len(measured), 30)
        for row, (bound, error, inputs, _) in measured.items():
            self.assertIn(row, self.page)
            committed = self.page[row]
            self.assertEqual((bound, inputs), (committed[0], committed[2]), row)
            self.assertLessEqual(float(error), max(FAR * float(committed[1]), 1e-12), row)
        # No case is lost: tests of these files that are in the page were measured.
        def names(file):
            return set(re.findall(r'TEST_CASE(?:_FIXTURE)?\((?:\w+, )?"([^"]+)"', (ROOT / file).read_text()))
        here = set.union(*map(names, files)) - names("tests/unit/reference/reference_test.cpp")
        self.assertLessEqual({row for row in self.page if row[0] in here}, set(measured))

    def test_a_file_that_no_section_names_is_refused(self):
        result = subprocess.run([TOOL, "--stdout", "build", "tests/unit/look/nothing_test.cpp"], capture_output=True,
                                text=True, timeout=60, check=False)
        self.assertEqual(result.returncode, 1)
        self.assertIn("SECTIONS does not name tests/unit/look/nothing_test.cpp", result.stderr)


if __name__ == "__main__":
    unittest.main()
