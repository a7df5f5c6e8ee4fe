"""tests/STABILITY.md: what it says is what the tests check, and every file with bounds is in it."""
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CASES = os.environ["SHVR_STABILITY_CASES"]
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
            self.assertNotIn("0x", worst, row)  # an address says nothing, and differs from run to run

    def test_every_file_with_bounds_is_in_the_page(self):
        sections = TOOL.read_text()
        for kind in ("unit", "gpu"):
            for file in (ROOT / "tests" / kind).rglob("*_test.cpp"):
                if "check_below(" in file.read_text():
                    self.assertIn(f'"{file.relative_to(ROOT)}"', sections)

    def test_the_page_is_what_the_tests_measure(self):
        # All of it, by the command that writes it, but for the place, from what those tests have just written.
        with tempfile.TemporaryDirectory(prefix="shvr-stability-") as folder:
            page = Path(folder) / "STABILITY.md"
            result = subprocess.run([TOOL, "-o", page, "--cases", CASES], capture_output=True, text=True, timeout=60,
                                    check=False)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            self.assertEqual(result.stdout, f"{page} is written\n")
            text = page.read_text()
        committed = (ROOT / "tests/STABILITY.md").read_text()
        self.assertEqual([line for line in text.splitlines() if not line.startswith("| ")],
                         [line for line in committed.splitlines() if not line.startswith("| ")])
        measured = rows_of(text)
        # No case is lost, and none is new: whoever adds one writes the page again.
        self.assertEqual(list(measured), list(self.page))
        for row, (bound, error, inputs, _) in measured.items():
            self.assertEqual((bound, inputs), (self.page[row][0], self.page[row][2]), row)
            self.assertLessEqual(float(error), max(FAR * float(self.page[row][1]), 1e-12), row)

    def test_a_page_of_some_files_alone_is_not_written(self):
        result = subprocess.run([TOOL, "build", "tests/unit/look/camera_test.cpp"], capture_output=True, text=True,
                                timeout=60, check=False)
        self.assertEqual(result.returncode, 1)

    def test_a_file_that_no_section_names_is_refused(self):
        result = subprocess.run([TOOL, "--stdout", "build", "tests/unit/look/nothing_test.cpp"], capture_output=True,
                                text=True, timeout=60, check=False)
        self.assertEqual(result.returncode, 1)
        self.assertIn("SECTIONS does not name tests/unit/look/nothing_test.cpp", result.stderr)


if __name__ == "__main__":
    unittest.main()
