"""Every step of the user manual, page by page, as a reader would carry it out (assets/manual/README.md)."""
import subprocess
import sys
import unittest
from pathlib import Path

from harness import ENVIRONMENT, SHVR, CliTest

TOOL = Path("tools/package/make_manual").resolve()
PAGES = sorted(path.stem for path in Path("assets/manual").glob("*.md") if path.stem != "README")


class Pages(CliTest):
    def test_every_page(self):
        self.assertIn("first-scan", PAGES)
        for page in PAGES:
            with self.subTest(page=page):
                result = subprocess.run([sys.executable, TOOL, SHVR, "--check", "--page", page], env=ENVIRONMENT,
                                        capture_output=True, text=True, check=False)
                self.assertEqual(result.returncode, 0, result.stderr)


if __name__ == "__main__":
    unittest.main()
