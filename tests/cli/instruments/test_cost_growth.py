"""tools/cost_growth: work on sparse volumes of constant content does not grow with their side."""
import subprocess
import unittest

from harness import ENVIRONMENT, SHVR, TIMEOUT_S, CliTest


class CostGrowth(CliTest):
    def test_exponents_are_within_their_bounds(self):
        result = subprocess.run(["tools/cost_growth", "--check", "--shvr", SHVR], capture_output=True, text=True,
                                timeout=TIMEOUT_S, env=ENVIRONMENT)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        rows = {line.split(" | ")[0][2:]: line.split(" | ")[5] for line in result.stdout.splitlines()[2:]}
        self.assertEqual(list(rows), ["info", "render", "label", "label to .zarr", "stroke and save", "open", "metrics",
                                      "import", "stroke in project", "export of project"])
        self.assertEqual(set(rows.values()), {"0.15"})


if __name__ == "__main__":
    unittest.main()
