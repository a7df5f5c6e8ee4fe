"""The render qualities lie on the measured front: tools/bench/front.csv, which shvr bench wrote."""
import csv
import math
import unittest
from pathlib import Path

from harness import CliTest

FRONT = Path(__file__).resolve().parents[3] / "tools/bench/front.csv"
QUALITIES = ["draft", "interactive", "good", "reference"]
SAME = 0.01  # a ray may end a sample later on another processor
ROUNDING = 1e-6  # of sums, which differs between processors
# Work is what is read: a sample that is pre-integrated reads 22 texels where a plain one reads 13, so samples are none. A
# tap of a texture unit's filter is another unit, so "sampling hardware" is left out. "reference" reads texels once for
# half a voxel, and computes more for each: it is compared by errors alone.
WORK = "reads"
OTHER_WORK = {"sampling hardware", "reference"}
# One table for all scenes is not on the front of each. More than SAME better in both:
ALONE = {("peaks", "draft", "resolution 0.5"),        # step 1 misses narrow peaks, whatever the size of the picture
         ("peaks", "draft", "coarse 0.7, step 1"),
         ("peaks", "draft", "gradient inside voxels, step 1")}   # nor whatever its shading


def read(path):
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def is_better(run, than, quality, share=1.0):
    """Whether (work, rmse) are below `share` of those of the quality."""
    is_less_work = quality in OTHER_WORK or run[0] < share * than[0]
    return is_less_work and run[1] < share * than[1]


def over_scenes(rows):
    """{run: (work, rmse)}: geometric means over all scenes, each of which has every run."""
    scenes = {row["scene"] for row in rows}
    means = {}
    for run in {row["run"] for row in rows}:
        mine = [row for row in rows if row["run"] == run]
        assert {row["scene"] for row in mine} == scenes and len(mine) == len(scenes), run
        means[run] = tuple(math.exp(sum(math.log(float(row[key])) for row in mine) / len(mine))
                           for key in (WORK, "rmse"))
    return means


def beaten(rows):
    """(quality, run) where the run takes less work and errs less, over all scenes."""
    means = over_scenes(rows)
    return [(quality, run) for quality in QUALITIES for run, mean in means.items()
            if run not in OTHER_WORK and is_better(mean, means[quality], quality)]


def beaten_alone(rows):
    """{(scene, quality, run)}: the same in single scenes, where both are more than SAME better."""
    found = set()
    for scene in {row["scene"] for row in rows}:
        runs = {row["run"]: (float(row[WORK]), float(row["rmse"])) for row in rows if row["scene"] == scene}
        found |= {(scene, quality, run) for quality in QUALITIES for run, of_run in runs.items()
                  if run not in OTHER_WORK and is_better(of_run, runs[quality], quality, 1 - SAME)}
    return found


class Qualities(CliTest):
    def setUp(self):
        super().setUp()
        self.rows = read(FRONT)

    def test_no_setting_is_both_faster_and_more_exact_than_a_quality(self):
        self.assertGreaterEqual(len({row["scene"] for row in self.rows}), 6)
        self.assertGreaterEqual(len({row["family"] for row in self.rows}), 6)
        self.assertEqual(beaten(self.rows), [])

    def test_in_single_scenes_these_alone_are_better_and_no_other(self):
        self.assertEqual(beaten_alone(self.rows), ALONE)

    def test_they_are_in_order(self):
        means = over_scenes(self.rows)
        by_work = [name for name in QUALITIES if name not in OTHER_WORK]
        self.assertEqual(sorted(by_work, key=lambda name: means[name][0]), by_work)
        self.assertEqual(sorted(QUALITIES, key=lambda name: -means[name][1]), QUALITIES)

    def test_a_quality_off_the_front_is_found(self):
        # "good" as it was: pre-integrated, a quarter of a voxel.
        rows = {(row["scene"], row["run"]): row for row in self.rows}
        for scene in {row["scene"] for row in self.rows}:
            for key in (WORK, "rmse"):
                rows[scene, "good"][key] = rows[scene, "pre-integrated 0.25"][key]
        self.assertEqual(beaten(self.rows), [("good", "step 0.125")])
        self.assertIn(("tissue", "good", "step 0.25"), beaten_alone(self.rows))

    def test_the_file_is_what_the_bench_measures(self):
        # Scenes of which one holds each quality's weakness: narrow peaks, and nothing but haze.
        scenes = ["fog", "peaks"]
        output = self.folder / "bench"
        self.check("bench", "--quick", "--rounds", 1, "--scenes", ",".join(scenes), "--peer", "none", "-o", output)
        now = {(row["scene"], row["run"]): row for row in read(output / "front.csv")}
        kept = {(row["scene"], row["run"]): row for row in self.rows if row["scene"] in scenes}
        self.assertEqual(now.keys(), kept.keys())
        for key, row in now.items():
            self.assertEqual(row["settings"], kept[key]["settings"])
            for name in ("samples", "reads", "rmse"):
                is_now, was = float(row[name]), float(kept[key][name])
                if max(is_now, was) > ROUNDING:
                    self.assertAlmostEqual(is_now / was, 1.0, delta=SAME, msg=(key, name))


if __name__ == "__main__":
    unittest.main()
