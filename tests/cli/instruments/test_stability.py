"""tests/STABILITY.md: its cases and bounds are those that the tests check, and every file with bounds is in it."""
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CASES = os.environ["SHVR_STABILITY_CASES"]
TOOL = ROOT / "tools/make_stability_page"


def rows_of(page, columns):
    """(test, quantity): the other cells, from all tables; fails at a row of another number of cells."""
    rows = {}
    for line in page.splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if not cells or cells[0] == "test" or cells[0].startswith("---"):
            continue
        if len(cells) != columns or (cells[0], cells[1]) in rows:
            raise AssertionError(f"{line}: expected a new case in {columns} cells")
        rows[cells[0], cells[1]] = cells[2:]
    return rows


class Stability(unittest.TestCase):
    def setUp(self):
        self.committed = (ROOT / "tests/STABILITY.md").read_text()

    def test_no_case_is_without_a_bound_and_an_input(self):
        page = rows_of(self.committed, 4)
        self.assertGreater(len(page), 120)
        for row, (bound, inputs) in page.items():
            self.assertGreaterEqual(float(bound), 0.0, row)
            self.assertGreater(int(inputs), 0, row)

    def test_every_file_with_bounds_is_in_the_page(self):
        sections = TOOL.read_text()
        for kind in ("unit", "gpu"):
            for file in (ROOT / "tests" / kind).rglob("*_test.cpp"):
                if "check_below(" in file.read_text():
                    self.assertIn(f'"{file.relative_to(ROOT)}"', sections)

    def test_the_pages_are_what_the_tests_check_and_measure(self):
        # Both pages in full, by the command that writes them, from what the tests of this run have just written.
        with tempfile.TemporaryDirectory(prefix="shvr-stability-") as folder:
            page = Path(folder) / "STABILITY.md"
            result = subprocess.run([TOOL, "-o", page, "--cases", CASES], capture_output=True, text=True, timeout=60,
                                    check=False)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            measured_page = Path(CASES) / "STABILITY.md"
            self.assertEqual(result.stdout, f"{page} and {measured_page} are written\n")
            # No case is lost and none is new: a change of cases or bounds comes with a new page.
            written, committed = rows_of(page.read_text(), 4), rows_of(self.committed, 4)
            if os.environ.get("SHVR_SLOW") == "1":  # the page is that of the everyday run; a slow one tries more inputs
                self.assertEqual([(row, values[0]) for row, values in written.items()],
                                 [(row, values[0]) for row, values in committed.items()])
            else:
                self.assertEqual(page.read_text().splitlines(), self.committed.splitlines())
        measured = rows_of(measured_page.read_text(), 6)
        self.assertEqual(list(measured), list(rows_of(self.committed, 4)))
        for row, (bound, _, error, worst) in measured.items():
            self.assertLessEqual(float(error), float(bound), row)
            self.assertTrue(worst, row)
            self.assertNotIn("0x", worst, row)  # an address says nothing, and differs from run to run

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
