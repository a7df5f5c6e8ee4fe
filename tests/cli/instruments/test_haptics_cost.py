"""Instruction ceilings of a tick, counted by valgrind: they depend on the compiler, not on who else uses the machine."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(os.environ.get("SHVR_UNIT_TESTS", Path(os.environ.get("SHVR", "build/dev/shvr")).parent / "shvr_unit_tests"))
ONE_CASE = os.environ.get("HAPTICS_CASE")  # for tools/break_haptics
TICKS = 20  # ticks per case in tests/unit/haptics/cost_test.cpp
# Case: the most instructions of a tick with a new region, a third above what g++ 12 -O2 takes.
CEILINGS = {"cost: 64^3 voxels and a ball of 12": 930_000, "cost: 64^3 voxels and a ball of 24": 830_000, "cost: 128^3 voxels and a ball of 48": 4_800_000}


def instructions(case):
    with tempfile.TemporaryDirectory() as folder:
        result = subprocess.run(
            ["valgrind", "--tool=callgrind", "--collect-atstart=no", "--toggle-collect=shvr::step(*",
             f"--callgrind-out-file={folder}/out", str(PROGRAM), f"--test-case={case}"],
            capture_output=True, text=True, timeout=300)
    collected = re.search(r"Collected : (\d+)", result.stderr)
    if result.returncode != 0 or not collected:
        raise AssertionError(f"{case}: {result.stdout[-500:]} {result.stderr[-500:]}")
    return int(collected[1]) // TICKS


class Cost(unittest.TestCase):
    def test_a_tick_takes_no_more_instructions_than_it_did(self):
        for case, ceiling in CEILINGS.items():
            if ONE_CASE and case != ONE_CASE:
                continue
            with self.subTest(case=case):
                counted = instructions(case)
                print(f"{case}: {counted} instructions a tick, at most {ceiling}")
                self.assertGreater(counted, 1000)  # it was counted at all
                self.assertLessEqual(counted, ceiling)


if __name__ == "__main__":
    if not shutil.which("valgrind") or not PROGRAM.exists():
        sys.exit(77)
    if re.search(r"lib[at]san", subprocess.run(["ldd", PROGRAM], capture_output=True, text=True).stdout):
        sys.exit(77)  # valgrind cannot run what a sanitizer watches
    unittest.main()
