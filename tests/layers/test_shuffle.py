"""Pictures and paint are the same bits in whatever order a device runs what no barrier orders, by a layer
(tests/layers/shuffle.cpp); and another layer leaves barriers out, so that it is seen to matter."""
import unittest

from harness import IS_SLOW, run
from test_noise import FEATURES, Scans, drawings

SEEDS = [None, "1", *(["2"] if IS_SLOW else [])]   # backwards, and at random


class Shuffled(Scans):
    def shuffled(self, seed, *arguments, layers="VK_LAYER_SHVR_shuffle", **environment):
        """How many commands ran before one that came earlier."""
        log = self.folder / "shuffle.log"
        log.unlink(missing_ok=True)
        if seed:
            environment["SHVR_SHUFFLE"] = seed
        result = run(*arguments, environment={"VK_INSTANCE_LAYERS": layers, "SHVR_SHUFFLE_LOG": str(log),
                                              **environment})
        self.assertEqual(result.returncode, 0, f"{arguments}\n{result.stdout}\n{result.stderr}")
        return int(log.read_text().split()[1])

    def test_paint_has_its_bits(self):
        paint, mask = self.paint(), self.folder / "paint.mask"
        self.check(*paint)
        expected = mask.read_bytes()
        self.assertGreater(len(expected) - expected.count(0), 1000)
        for seed in SEEDS:
            with self.subTest(seed=seed):
                mask.unlink()
                self.assertGreater(self.shuffled(seed, *paint), 5 if seed else 12)
                self.assertEqual(mask.read_bytes(), expected)

    def test_pictures_have_their_bits(self):
        self.check(*self.paint())
        here, there = self.folder / "here.pfm", self.folder / "there.pfm"
        moved = 0
        for feature, paging in drawings("always"):
            drawn = self.scan(f"{feature}.json", **FEATURES[feature])
            with self.subTest(feature=feature, paging=paging):
                arguments = ["--set", f"render.paging={paging}"]
                self.check("render", drawn, "-o", here, *arguments)
                moved += self.shuffled(None, "render", drawn, "-o", there, *arguments)
                self.assertEqual(there.read_bytes(), here.read_bytes())
        self.assertGreater(moved, 3 * len(list(drawings("always"))))

    def test_without_one_of_the_barriers_there_are_other_bits(self):
        self.check(*self.paint())
        drawn = self.scan("occluded.json", **FEATURES["occluded"])
        here, there = self.folder / "here.pfm", self.folder / "there.pfm"
        log = self.folder / "barriers.log"
        both = "VK_LAYER_SHVR_barriers:VK_LAYER_SHVR_shuffle"
        self.shuffled(None, "render", drawn, "-o", here, layers=both, SHVR_BARRIERS_LOG=str(log))
        barriers = int(log.read_text().split()[1])
        self.assertGreater(barriers, 10)
        others = 0
        for number in range(1, barriers + 1, max(1, barriers // 16)):
            self.shuffled(None, "render", drawn, "-o", there, layers=both, SHVR_DROP_BARRIER=str(number),
                          SHVR_VALIDATION="")
            others += there.read_bytes() != here.read_bytes()
        self.assertGreaterEqual(others, 3)


if __name__ == "__main__":
    unittest.main()
