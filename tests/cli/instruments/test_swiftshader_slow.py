"""Goldens on a second driver: SwiftShader, whose library lies in Debian's package chromium-common. It draws fourteen
times slower than lavapipe, so this is a check of correctness only. SHVR_SWIFTSHADER names its ICD file elsewhere."""
import json
import os
import subprocess
import sys
import unittest
from pathlib import Path

from harness import ENVIRONMENT, SHVR, CliTest

ICD = Path(os.environ.get("SHVR_SWIFTSHADER", "/usr/lib/chromium/vk_swiftshader_icd.json"))
GOLDENS = Path("tests/golden")
NO_TEST = 77   # for ctest: skipped


class SwiftShader(CliTest):
    def golden(self, *arguments, status=0):
        """The results of a run for which SwiftShader is the only driver."""
        environment = {key: value for key, value in ENVIRONMENT.items() if key != "SHVR_DEVICE"}
        environment.update({"VK_ICD_FILENAMES": str(ICD), "VK_DRIVER_FILES": str(ICD), "SHVR_VALIDATION": ""})
        result = subprocess.run([SHVR, "golden", "run", *arguments, "--folder", GOLDENS, "-o", self.folder / "drawn",
                                 "--quiet"], text=True, capture_output=True, env=environment)
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        return json.loads((self.folder / "drawn" / "results.json").read_text())["goldens"]

    # Kind (Drivers): the goldens on a second driver
    def test_all_goldens_are_within_their_bounds(self):
        results = self.golden("--device", "swiftshader")
        self.assertEqual(len(results), len(list(GOLDENS.glob("*.blessed.json"))))
        wrong = {each["name"]: each["reason"] or each["status"] for each in results if each["status"] != "passed"}
        self.assertEqual(wrong, {})
        for each in results:
            self.assertIn("SwiftShader", each["drawn_by"]["device"])

    # Kind (Drivers): no lavapipe where the user names no device
    def test_that_lavapipe_is_missing_is_said_in_words_of_the_user(self):
        said = self.golden("anaglyph", status=3)[0]["reason"]
        self.assertIn("found 0: SwiftShader", said)
        self.assertIn("goldens are drawn on lavapipe (llvmpipe)", said)
        self.assertIn("unless --device names another device", said)


if __name__ == "__main__":
    if not ICD.exists():
        print(f"skipped: there is no {ICD}, of Debian's package chromium-common")
        sys.exit(NO_TEST)
    unittest.main()
