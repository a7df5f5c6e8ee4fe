"""tools/bench/editor.py at a small size: SHVR's operations on groups give the results of scipy, scikit-image and VTK, and
cost the bricks that they are known to cost. The everyday run does a few of them; SHVR_SLOW=1 all."""
import json
import os
import re
import subprocess
import unittest
from pathlib import Path

from harness import IS_SLOW, SHVR, CliTest

ROOT = Path(__file__).resolve().parents[3]
TOOL = ROOT / "tools/bench/editor.py"
SIDE = 64
# Bricks read, written, and read of intensities: 8 bricks are the whole volume. Another count is another cost: accept a
# higher one only with a reason.
WORK = {"combine": (8, 8, 0), "threshold": (8, 8, 8), "grow": (16, 8, 0), "shrink": (16, 8, 0), "open": (16, 8, 0),
        "close": (16, 0, 0), "hollow": (16, 8, 0), "median": (72, 8, 0), "gaussian": (72, 8, 0), "fill_holes": (12, 4, 0),
        "islands": (16, 8, 0), "fill_between": (72, 8, 0), "grow_seeds": (24, 8, 8), "lasso": (8, 8, 0),
        "trace_from_mask": (8, 0, 0), "mask_from_trace": (8, 8, 0), "surfaces": (12, 0, 0)}
EVERY_DAY = ["islands", "fill_holes", "lasso", "mask_from_trace"]
HAS_PEERS = subprocess.run(["/usr/bin/python3", "-c", "import scipy, skimage, vtk"],
                           capture_output=True, check=False).returncode == 0


@unittest.skipUnless(HAS_PEERS, "python3-scipy, python3-skimage or python3-vtk9 is not installed")
class BenchEditor(CliTest):
    def run_tool(self, *names, environment=None):
        return subprocess.run(
            [TOOL, "--side", str(SIDE), "--rounds", "1", "--only", ",".join(names), "--folder", self.folder, "--results",
             self.folder / "editor.json", "--page", self.folder / "EDITOR.md"], capture_output=True, text=True,
            check=False, env={**os.environ, "SHVR": str(Path(SHVR).resolve()), **(environment or {})})

    def test_operations_agree_with_their_peers_and_cost_the_known_bricks(self):
        names = list(WORK) if IS_SLOW else EVERY_DAY
        # In two runs, the second of which keeps what the first measured.
        for part in (names[:1], names[1:]):
            ran = self.run_tool(*part)
            self.assertEqual(ran.returncode, 0, ran.stderr)
        results = json.loads((self.folder / "editor.json").read_text())
        self.assertEqual(sorted(results), sorted(names))
        for name, result in results.items():
            with self.subTest(name=name):
                counts = tuple(result["counters"].get(key, 0)
                               for key in ("bricks_read", "bricks_written", "bricks_of_intensities"))
                self.assertEqual(counts, WORK[name])
                for program in result["programs"].values():
                    self.assertGreater(program["seconds"], 0)
                    self.assertLess(program["peak_bytes"], 2 ** 30)
        page = (self.folder / "EDITOR.md").read_text()
        for name in names:
            self.assertRegex(page, rf"(?m)^\| {re.escape(name)} \| {SIDE} \| ")

    def test_another_result_is_refused(self):
        bench = self.folder / "bench"
        bench.write_text("#!/bin/sh\n"  # as a program that erases everything
                         f"head -c {SIDE ** 3} /dev/zero > \"$6\"\n"
                         "echo '{\"seconds\": 1, \"cpu_seconds\": 1, \"peak_bytes\": 1}'\n")
        bench.chmod(0o755)
        ran = self.run_tool("fill_holes", environment={"OPERATION_BENCH": str(bench)})
        self.assertEqual(ran.returncode, 1)
        self.assertIn("fill_holes: SHVR and scipy_label_holes do not agree: ", ran.stderr)
        self.assertFalse((self.folder / "editor.json").exists())

    def test_an_unknown_operation_is_refused_with_the_known_ones(self):
        ran = self.run_tool("dilate")
        self.assertEqual(ran.returncode, 1)
        self.assertIn("--only names dilate; expected some of: combine, threshold", ran.stderr)


if __name__ == "__main__":
    unittest.main()
