"""tools/study/baselines.py: algorithms that annotate a phantom, and their skeletons as traces."""
import csv
import importlib.util
import os
import subprocess
import sys
import unittest
from pathlib import Path

from harness import SHVR, CliTest

SCRIPT = Path("tools/study/baselines.py").resolve()
DEBIANS = "/usr/bin/python3"


def script():
    spec = importlib.util.spec_from_file_location("baselines", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Voxels:
    """What graph_of needs of an array: the set voxels, and a radius everywhere."""

    def __init__(self, voxels):
        self.voxels = sorted(voxels)

    def nonzero(self):
        return tuple(zip(*self.voxels)) if self.voxels else ((), (), ())

    def __getitem__(self, voxel):
        return 2.0


def graph(voxels):
    return script().graph_of(Voxels(voxels), Voxels(voxels))


def has_packages():
    found = subprocess.run([DEBIANS, "-c", "import numpy, scipy, skimage"], capture_output=True, check=False)
    return found.returncode == 0


class Baselines(CliTest):
    def degrees(self, nodes, edges):
        count = [0] * len(nodes)
        for a, b in edges:
            count[a] += 1
            count[b] += 1
        return count

    # Kind (Study): a skeleton that is a line, a cross with a bump, a ring, a single voxel
    def test_skeletons_become_graphs(self):
        line = [(5, 5, x) for x in range(21)]
        nodes, edges = graph(line)
        self.assertEqual(sorted(self.degrees(nodes, edges)), [1, 1] + [2] * (len(nodes) - 2))
        self.assertEqual((nodes[0], nodes[-1]), ((0.5, 5.5, 5.5, 2.0), (20.5, 5.5, 5.5, 2.0)))

        cross = {(5, 20, x) for x in range(41)} | {(5, y, 20) for y in range(41)}
        bump = {(5, 20 + i, 5) for i in range(1, 4)}  # a branch of three voxels is no branch
        nodes, edges = graph(cross | bump)
        degrees = self.degrees(nodes, edges)
        self.assertEqual(degrees.count(4), 1)
        self.assertEqual(degrees.count(1), 4)
        self.assertEqual(len(edges), len(nodes) - 1)  # a tree

        side = 20
        ring = {(0, 0, i) for i in range(side)} | {(0, side, i) for i in range(1, side + 1)}
        ring |= {(0, i, 0) for i in range(1, side + 1)} | {(0, i, side) for i in range(side)}
        tail = {(0, 0, side + i) for i in range(1, 20)}
        nodes, edges = graph(ring | tail)
        self.assertEqual(len(edges), len(nodes))  # one loop
        self.assertEqual(graph([(1, 1, 1)]), ([], []))
        self.assertEqual(graph([]), ([], []))

    def run_script(self, *arguments, python=DEBIANS, **environment):
        return subprocess.run([python, SCRIPT, "-o", self.folder / "b.csv", "--shvr", Path(SHVR).resolve(), *arguments],
                              env={**os.environ, **environment}, capture_output=True, text=True, check=False)

    def rows(self):
        with (self.folder / "b.csv").open(newline="") as file:
            return list(csv.DictReader(file))

    # Kind (Study): annotations whose scores are known, without any package
    def test_annotations_are_scored_against_both_truths(self):
        baselines = script()
        phantom = self.check_json("phantom", "section", "--size", 48, "--seed", 2, "-o", self.folder / "phantom")
        partial = baselines.scores(SHVR, phantom, phantom["truth_partial_mask"], phantom["truth_trace"])
        self.assertEqual((partial["dice_partial"], partial["segments_found"], partial["segments_total"],
                          partial["topological_errors"]), (1.0, 26, 26, 0))
        self.assertLess(partial["centreline_rms"], 1e-6)
        full = baselines.scores(SHVR, phantom, phantom["truth_mask"], None)
        self.assertEqual(full["dice_full"], 1.0)
        # The partial truth is a part of the full one: either scores the other alike.
        self.assertEqual(full["dice_partial"], partial["dice_full"])
        self.assertNotIn("segments_found", full)
        # A skeleton's graph, written as a trace, has its nodes and no segment of the truth.
        nodes, edges = graph([(5, 5, x) for x in range(21)])
        baselines.write_trace(nodes, edges, (48, 48, 48), self.folder / "line.graphml")
        line = baselines.scores(SHVR, phantom, phantom["truth_mask"], self.folder / "line.graphml")
        self.assertEqual((line["nodes"], line["internodes"], line["segments_found"]), (len(nodes), len(edges), 0))

    @unittest.skipUnless(has_packages(), "python3-scipy or python3-skimage is not installed")
    def test_methods_are_scored_on_the_same_phantoms(self):
        ran = self.run_script("--size", "48", "--seeds", "2", "--methods", "threshold_largest,sato_skeleton")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        threshold, sato = self.rows()
        self.assertEqual([(row["method"], row["noise"], row["seed"], row["skipped"]) for row in (threshold, sato)],
                         [("threshold_largest", "10.0", "2", ""), ("sato_skeleton", "10.0", "2", "")])
        self.assertGreater(float(threshold["dice_partial"]), 0.05)
        self.assertEqual(threshold["nodes"], "")
        self.assertGreater(float(sato["dice_full"]), float(sato["dice_partial"]))
        self.assertEqual(sato["segments_total"], "26")
        self.assertGreater(int(sato["nodes"]), 26)
        self.assertGreater(float(sato["centreline_rms"]), 0)

    # Kind (Study): an interpreter without the packages
    def test_missing_packages_are_named_instead_of_results(self):
        lacks_any = subprocess.run([sys.executable, "-S", "-E", "-c", "import skimage"], capture_output=True, check=False)
        if lacks_any.returncode == 0:
            self.skipTest("this interpreter has python3-skimage without its site packages")
        # SHVR_BASELINES_PYTHON: the interpreter has been chosen.
        ran = subprocess.run([sys.executable, "-S", "-E", SCRIPT, "-o", self.folder / "b.csv", "--methods", "flood"],
                             env={**os.environ, "SHVR_BASELINES_PYTHON": "chosen"}, capture_output=True, text=True,
                             check=False)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        (row,) = self.rows()
        self.assertEqual((row["method"], row["dice_partial"]), ("flood", ""))
        self.assertIn("python3-skimage", row["skipped"])
        self.assertIn("not installed", row["skipped"])

    def test_wrong_methods_are_refused_before_any_work(self):
        ran = self.run_script("--methods", "magic")
        self.assertEqual(ran.returncode, 2)
        self.assertIn("magic is not one of threshold_largest", ran.stderr)
        self.assertFalse((self.folder / "b.csv").exists())


if __name__ == "__main__":
    unittest.main()
