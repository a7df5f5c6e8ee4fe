"""tools/bench/vector_widths.py at a small size: each width runs its own code, and draws the same bits."""
import os
import re
import subprocess
import unittest
from pathlib import Path

from harness import ENVIRONMENT, SHVR, CliTest

TOOL = Path(__file__).resolve().parents[3] / "tools/bench/vector_widths.py"


class VectorWidths(CliTest):
    def run_tool(self, *arguments):
        return subprocess.run([TOOL, *arguments], capture_output=True, text=True, check=False, cwd=self.folder,
                              env={**os.environ, **ENVIRONMENT, "SHVR": str(Path(SHVR).resolve())})

    def test_widths_are_compared_in_a_table(self):
        ran = self.run_tool("--widths", "128", "--side", "24", "--rounds", "1", "--frames", "1", "--scenes", "tubes opaque")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        lines = ran.stdout.splitlines()
        self.assertIn("llvmpipe", lines[0])
        self.assertEqual(lines[2], "| scene | default, CPU ms | 128 bits | bits |")
        self.assertRegex(lines[4], r"^\| tubes, opaque \| -?\d+ \| -?[\d.]+ \| equal \|$")
        refused = self.run_tool("--scenes", "fog")
        self.assertEqual(refused.returncode, 2)
        self.assertRegex(re.sub(r"\s+", " ", refused.stderr), "--scenes: found 'fog', expected of fog unshaded, fog shaded")


if __name__ == "__main__":
    unittest.main()
