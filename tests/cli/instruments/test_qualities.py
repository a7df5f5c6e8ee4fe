"""The render qualities lie on the measured front: tools/bench/front.csv, which shvr bench wrote."""
import csv
import math
import unittest
from pathlib import Path

from harness import CliTest

FRONT = Path(__file__).resolve().parents[3] / "tools/bench/front.csv"
QUALITIES = ["draft", "interactive", "good", "reference"]
SAME = 0.01  # a ray may end a sample later on another processor


def read(path):
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def over_scenes(rows):
    """{run: (samples, rmse)}: geometric means over all scenes, each of which has every run."""
    scenes = {row["scene"] for row in rows}
    means = {}
    for run in {row["run"] for row in rows}:
        mine = [row for row in rows if row["run"] == run]
        assert {row["scene"] for row in mine} == scenes and len(mine) == len(scenes), run
        means[run] = tuple(math.exp(sum(math.log(float(row[key])) for row in mine) / len(mine))
                           for key in ("samples", "rmse"))
    return means


def beaten(rows):
    """(quality, run) where the run takes fewer samples and errs less, over all scenes."""
    means = over_scenes(rows)
    return [(quality, run) for quality in QUALITIES for run, (samples, rmse) in means.items()
            if samples < means[quality][0] and rmse < means[quality][1]]


class Qualities(CliTest):
    def setUp(self):
        super().setUp()
        self.rows = read(FRONT)

    def test_no_setting_is_both_faster_and_more_exact_than_a_quality(self):
        self.assertGreaterEqual(len({row["scene"] for row in self.rows}), 6)
        self.assertGreaterEqual(len({row["family"] for row in self.rows}), 6)
        self.assertEqual(beaten(self.rows), [])

    def test_they_are_in_order(self):
        means = over_scenes(self.rows)
        self.assertEqual(sorted(QUALITIES, key=lambda name: means[name][0]), QUALITIES)
        self.assertEqual(sorted(QUALITIES, key=lambda name: -means[name][1]), QUALITIES)

    def test_a_quality_off_the_front_is_found(self):
        for row in self.rows:
            if row["run"] == "good":
                row["samples"], row["rmse"] = str(2 * int(row["samples"])), str(3 * float(row["rmse"]))
        self.assertIn(("good", "step 0.25"), beaten(self.rows))

    def test_the_file_is_what_the_bench_measures(self):
        # Scenes of which one holds each quality's weakness: narrow peaks, and nothing but haze.
        scenes = ["fog", "peaks"]
        output = self.folder / "bench"
        self.check("bench", "--quick", "--rounds", 1, "--scenes", ",".join(scenes), "-o", output)
        now = {(row["scene"], row["run"]): row for row in read(output / "front.csv")}
        kept = {(row["scene"], row["run"]): row for row in self.rows if row["scene"] in scenes}
        self.assertEqual(now.keys(), kept.keys())
        for key, row in now.items():
            self.assertEqual(row["settings"], kept[key]["settings"])
            for name in ("samples", "rmse"):
                self.assertAlmostEqual(float(row[name]) / float(kept[key][name]), 1.0, delta=SAME, msg=(key, name))


if __name__ == "__main__":
    unittest.main()
