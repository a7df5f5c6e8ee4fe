"""shvr annotate: scripts, against brushes in plain Python, voxel for voxel."""
import json
import random
import signal
import subprocess
import time
import unittest

from harness import ENVIRONMENT, IS_SLOW, SHVR, CliTest, Volume

KEYS = ["commands", "voxels_changed", "voxels_taken_from", "voxels_kept_locked", "voxels_kept_painted", "nodes", "internodes", "journal_bytes"]


def paint(brush, region, group, threshold, radius, path, connectivity=6):
    return {"op": "paint", "brush": brush, "region": region, "group": group, "threshold": threshold,
            "radius": radius, "connectivity": connectivity, "path": path}


class Annotate(CliTest):
    SIZE = (20, 17, 13)

    def prepare(self, volume):
        self.volume = volume
        self.session = self.write_session(volume={"path": volume.write(self.folder).name})
        self.mask = self.folder / "paint.mask"

    def annotate(self, operations, *arguments, status=0):
        script = self.write_script("script.jsonl", operations)
        if status:
            return self.check("annotate", self.session, "--script", script, *arguments, status=status)
        return self.check_json("annotate", self.session, "--script", script, *arguments)

    def apply(self, mask, operation):
        """Paints in Python; returns how many voxels changed."""
        changed = 0
        for voxel in self.volume.select(operation):
            index = self.volume.index(voxel)
            changed += mask[index] != operation["group"]
            mask[index] = operation["group"]
        return changed

    def random_operation(self, numbers, brush):
        size = self.volume.size
        path = [[numbers.uniform(-2, s + 2) for s in size] for _ in range(numbers.choice([1, 1, 1, 3]))]
        values = sorted(self.volume.values)
        # Near the percolation threshold components are most tangled.
        share = numbers.choice([0.5, 0.69, 0.8, 0.9])
        return paint(brush, numbers.choice(["ball", "box"]), numbers.randint(1, 5),
                     values[int(share * len(values))], numbers.uniform(2, 8), path, numbers.choice([6, 26]))

    def check_brush(self, brush, volume, seed):
        self.prepare(volume)
        numbers = random.Random(seed)
        operations, expected, changed, counts = [], bytearray(len(volume.values)), 0, []
        for _ in range(12):
            operation = self.random_operation(numbers, brush)
            changed += self.apply(expected, operation)
            operations += [operation, {"op": "expect", "voxels_in_group": {
                str(group): expected.count(group) for group in range(1, 6)}}]
            counts.append(len(expected) - expected.count(0))
        self.assertGreater(counts[-1], 0, f"seed {seed} paints nothing")
        result = self.annotate(operations + [{"op": "save"}])
        self.assertEqual(result["voxels_changed"], changed)
        self.assertEqual(self.mask.read_bytes(), bytes(expected), f"seed {seed}")

    def test_fill(self):
        self.check_brush("fill", Volume.noise(self.SIZE, seed=1), seed=1)

    def test_flood(self):
        self.check_brush("flood", Volume.noise(self.SIZE, seed=2), seed=2)

    def test_speckle(self):
        self.check_brush("speckle", Volume.noise(self.SIZE, seed=3), seed=3)

    def test_flood_with_spacing_and_16_bits(self):
        volume = Volume.noise(self.SIZE, seed=4, high=40000, spacing=(0.5, 0.8, 1.3), voxel_type="uint16")
        self.check_brush("flood", volume, seed=4)

    def test_speckle_with_signed_values(self):
        numbers = random.Random(5)
        values = [numbers.randint(-900, 900) for _ in range(20 * 17 * 13)]
        self.check_brush("speckle", Volume(self.SIZE, values, voxel_type="int16"), seed=5)

    def test_flood_across_bricks(self):
        self.check_brush("flood", Volume.noise((40, 37, 35), seed=6), seed=6)

    def test_undo_and_redo_go_through_every_state(self):
        self.prepare(Volume.noise(self.SIZE, seed=7))
        numbers = random.Random(7)
        mask, states, operations = bytearray(len(self.volume.values)), [], []

        def expect(state):
            return {"op": "expect", "voxels_in_group": {str(group): state.count(group) for group in range(0, 6)}}

        while len(states) < 6:
            operation = self.random_operation(numbers, "flood")
            if self.apply(mask, operation):  # no change, no command
                operations.append(operation)
                states.append(bytes(mask))
        empty = bytes(len(mask))
        operations += [{"op": "undo", "count": 1}, expect(states[-2]), {"op": "undo", "count": 3}, expect(states[1]),
                       {"op": "redo", "count": 2}, expect(states[3]), {"op": "undo", "count": 4}, expect(empty),
                       {"op": "redo", "count": 5}, {"op": "save"}, expect(states[4])]
        self.annotate(operations)
        self.assertEqual(self.mask.read_bytes(), states[4])

    def test_painting_after_an_undo_drops_what_was_undone(self):
        self.prepare(Volume((8, 8, 8), [100] * 512))
        one = paint("fill", "box", 1, 50, 1.6, [[2, 2, 2]])
        two = paint("fill", "box", 2, 50, 1.6, [[6, 6, 6]])
        self.annotate([one, {"op": "undo", "count": 1}, two, {"op": "redo", "count": 1}], status=1)
        self.annotate([one, {"op": "undo", "count": 1}, two, {"op": "save"}])
        expected = bytearray(512)
        self.apply(expected, two)
        self.assertEqual(self.mask.read_bytes(), bytes(expected))

    def test_a_saved_mask_is_gone_on_with(self):
        self.prepare(Volume((8, 8, 8), [100] * 512))
        one = paint("fill", "ball", 1, 50, 2.2, [[2, 2, 2]])
        two = paint("fill", "ball", 0, 50, 1.2, [[2, 3, 2]])  # erases
        expected = bytearray(512)
        self.apply(expected, one)
        self.annotate([one, {"op": "save"}])
        first = bytes(expected)
        self.apply(expected, two)
        self.annotate([{"op": "expect", "voxels_in_group": {"1": first.count(1)}}, two, {"op": "save"}])
        self.assertEqual(self.mask.read_bytes(), bytes(expected))
        self.annotate([{"op": "expect", "voxels_in_group": {"1": 0}}], "--fresh")

    def test_a_seed_below_the_threshold_paints_nothing(self):
        self.prepare(Volume((8, 8, 8), [100 if i % 2 else 10 for i in range(512)]))
        outside = paint("flood", "ball", 1, 50, 4.0, [[-1.5, 4.5, 4.5]])
        below = paint("flood", "ball", 1, 50, 4.0, [[2.5, 4.5, 4.5]])
        at = paint("flood", "ball", 1, 100, 0.9, [[3.5, 4.5, 4.5]])  # "at or above" holds for equality
        result = self.annotate([outside, below, {"op": "expect", "voxels_in_group": {"1": 0}}, at,
                                {"op": "expect", "voxels_in_group": {"1": 1}}])
        self.assertEqual(result["voxels_changed"], 1)

    def test_the_painted_group_is_seen(self):
        self.prepare(Volume((16, 16, 16), [150] * 4096))
        self.annotate([paint("fill", "box", 1, 50, 6.0, [[8, 8, 8]]), {"op": "save"}])
        with_paint, hidden, without = (self.folder / name for name in ("a.png", "b.png", "c.png"))
        self.check("render", self.session, "-o", with_paint)
        self.check("render", self.session, "-o", hidden, "--set", 'groups.1={"visible":false}')
        (self.folder / "session.journal").unlink()
        self.mask.unlink()
        self.check("render", self.session, "-o", without)
        self.assertEqual(len({path.read_bytes() for path in (with_paint, hidden, without)}), 3)

    def test_keys(self):
        self.prepare(Volume((4, 4, 4), [1] * 64))
        result = self.annotate([{"op": "expect", "nodes": 0, "internodes": 0}])
        self.assert_keys(result, KEYS)
        self.assertEqual((result["commands"], result["voxels_changed"]), (1, 0))

    def test_a_failing_expectation_is_a_gate(self):
        self.prepare(Volume((4, 4, 4), [1] * 64))
        result = self.annotate([{"op": "expect", "voxels_in_group": {"1": 7}}], status=3)
        for word in ("script.jsonl:1", "group 1", "0 voxels", "7"):
            self.assertIn(word, result.stderr)
        self.annotate([{"op": "expect", "nodes": 1}], status=3)

    def test_undoing_too_much_is_refused_with_the_line(self):
        self.prepare(Volume((4, 4, 4), [1] * 64))
        self.assertIn("script.jsonl:1", self.annotate([{"op": "undo", "count": 1}], status=1).stderr)

    def test_a_wrong_script_is_refused_before_anything_runs(self):
        self.prepare(Volume((8, 8, 8), [100] * 512))
        good = [paint("fill", "ball", 1, 50, 2.2, [[2, 2, 2]]), {"op": "save"}]
        for wrong, word in [({"op": "pant"}, "pant"), ({"op": "undo", "cuont": 1}, "cuont"),
                            (paint("fill", "cube", 1, 50, 2, [[2, 2, 2]]), "cube"),
                            (paint("fill", "ball", 256, 50, 2, [[2, 2, 2]]), "256"),
                            (paint("flood", "ball", 1, 50, 2, [[2, 2, 2]], connectivity=18), "18"),
                            (paint("fill", "ball", 1, 50, 2, []), "path")]:
            with self.subTest(word=word):
                stderr = self.annotate(good + [wrong], status=1).stderr
                self.assertIn("script.jsonl:3", stderr)
                self.assertIn(word, stderr)
                self.assertFalse(self.mask.exists())

    def test_a_mask_of_another_volume_is_refused(self):
        self.prepare(Volume((4, 4, 4), [1] * 64))
        self.mask.write_bytes(bytes(63))
        stderr = self.annotate([{"op": "save"}], status=1).stderr
        self.assertIn("63", stderr)
        self.assertIn("64", stderr)
        self.assertEqual(self.mask.read_bytes(), bytes(63))

    def test_a_mask_of_another_image_of_the_same_size_is_refused(self):
        strokes = [paint("fill", "ball", 7, 0, 2, [[4, 4, 4]]), {"op": "save"}]
        self.prepare(Volume.noise((9, 8, 7), seed=1))
        self.annotate(strokes)
        painted, record = self.mask.read_bytes(), self.folder / "paint.mask.json"
        image = json.loads(record.read_text())["image"]
        self.assertRegex(image, "^xxh3-128:[0-9a-f]{32}$")
        self.annotate(strokes)  # the same image
        # The same voxels in another file.
        self.check("import", self.folder / "volume.nhdr", self.folder / "project", "--quiet")
        same = self.write_session(volume={"path": str(self.folder / "project")})
        self.check("annotate", same, "--script", self.write_script("script.jsonl", strokes), "--quiet")
        self.assertEqual(json.loads(record.read_text())["image"], image)
        # One voxel differs.
        other = Volume.noise((9, 8, 7), seed=1)
        other.values[100] ^= 1
        self.prepare(other)
        stderr = self.annotate([{"op": "save"}], status=1).stderr
        self.assertIn(f"session.journal: is of an image with the hash {image}; expected xxh3-128:", stderr)
        (self.folder / "session.journal").unlink()
        stderr = self.annotate([{"op": "save"}], status=1).stderr
        self.assertIn(f'paint.mask.json: key image is "{image}"; expected "xxh3-128:', stderr)
        self.assertIn("the mask was painted on other voxels", stderr)
        self.assertEqual(stderr.count("shvr: "), 1, stderr)
        self.assertEqual(self.mask.read_bytes(), painted)
        # Removing the record allows it anyway; masks of older programs have none.
        record.unlink()
        self.annotate([{"op": "save"}])
        self.assertNotEqual(json.loads(record.read_text())["image"], image)
        for wrong, says in (("[" * 10_000, "JSON nests deeper than 64 levels"), ('{"shvr_mask": 2}', "key shvr_mask is 2; expected 1"),
                            ('{"shvr_mask": 1}', "key image is missing"), ("\0", "is not JSON: ")):
            record.write_text(wrong)
            self.assertIn(f"paint.mask.json: {says}", self.annotate([{"op": "save"}], status=1).stderr)


class Journal(CliTest):
    """Work is kept without a save; tests/durability shows what it survives."""

    def setUp(self):
        super().setUp()
        name = Volume.noise((9, 8, 7), seed=1).write(self.folder).name
        self.session = self.write_session(volume={"path": name})
        self.journal = self.folder / "session.journal"

    def annotate(self, operations, *arguments):
        script = self.write_script("script.jsonl", operations)
        return self.check_json("annotate", self.session, "--script", script, *arguments)

    def test_what_was_not_saved_is_there_for_every_command(self):
        self.assertEqual(self.annotate([])["journal_bytes"], 0)
        self.assertFalse(self.journal.exists())
        stroke = paint("fill", "ball", 7, 0, 2, [[4, 4, 4]])
        voxels = self.annotate([stroke])["voxels_changed"]
        self.assertGreater(voxels, 0)
        self.assertFalse((self.folder / "paint.mask").exists())
        kept = self.journal.read_bytes()
        # Another run continues, and undoes commands of an earlier one.
        result = self.annotate([{"op": "expect", "voxels_in_group": {"7": voxels}}, {"op": "undo"},
                                {"op": "expect", "voxels_in_group": {"7": 0}}, {"op": "redo"}])
        self.assertEqual(result["journal_bytes"], self.journal.stat().st_size)
        self.assertTrue(self.journal.read_bytes().startswith(kept))
        # Read-only commands show the work, report it, and leave it unchanged.
        kept = self.journal.read_bytes()
        export = self.check("export", self.session, "--mask", self.folder / "out.mask")
        self.assertIn("session.journal: holds 3 steps that were not saved", export.stderr)
        self.assertEqual((self.folder / "out.mask").read_bytes().count(7), voxels)
        self.check("render", self.session, "-o", self.folder / "a.png", "--size", "16x16")
        self.assertEqual(self.journal.read_bytes(), kept)

    def test_starting_afresh_keeps_the_journal_under_another_name(self):
        self.annotate([paint("fill", "ball", 7, 0, 2, [[4, 4, 4]])])
        kept = self.journal.read_bytes()
        self.annotate([{"op": "expect", "voxels_in_group": {"7": 0}}, paint("fill", "ball", 3, 0, 1, [[4, 4, 4]])],
                      "--fresh")
        self.assertEqual((self.folder / "session.journal.old").read_bytes(), kept)

    def test_what_is_no_journal_is_refused(self):
        self.journal.write_text("What is this?")
        script = self.write_script("script.jsonl", [])
        self.check_refused("annotate", self.session, "--script", script,
                           says=["session.journal: does not begin with SHVRJRNL"])

    def test_a_folder_that_takes_no_journal_takes_no_paint(self):
        self.journal.symlink_to(self.folder / "nowhere" / "session.journal")
        script = self.write_script("script.jsonl", [paint("fill", "ball", 7, 0, 2, [[4, 4, 4]]), {"op": "save"}])
        self.check_refused("annotate", self.session, "--script", script,
                           says=["session.journal: cannot be written: No such file or directory"])
        self.assertFalse((self.folder / "paint.mask").exists())


class Killed(CliTest):
    """A process that dies while it saves leaves the last saved mask or the next one, never a part."""

    SIDE = 64

    def kill_while_saving(self, kill, seed):
        session = self.write_session(
            volume={"procedural": "constant", "size": [self.SIDE] * 3})
        mask = self.folder / "paint.mask"
        operations = []
        for i in range(400):  # far more than it can finish
            operations += [paint("fill", "box", i % 250 + 1, 1, self.SIDE, [[self.SIDE / 2] * 3]), {"op": "save"}]
        script = self.write_script("script.jsonl", operations)
        numbers = random.Random(seed)
        states = set()
        for _ in range(6 if IS_SLOW else 2):
            mask.unlink(missing_ok=True)
            process = subprocess.Popen([SHVR, "annotate", session, "--script", script, "--quiet", "--fresh"],
                                       env=ENVIRONMENT)
            try:
                deadline = time.monotonic() + 60
                while not mask.exists() and process.poll() is None and time.monotonic() < deadline:
                    time.sleep(0.002)
                time.sleep(numbers.uniform(0, 0.3))
                self.assertIsNone(process.poll(), "the script ended before it could be interrupted")
                process.send_signal(kill)
                self.assertNotEqual(process.wait(30), 0)
            finally:
                process.kill()
                process.wait()
            content = mask.read_bytes()
            self.assertEqual(len(content), self.SIDE ** 3)
            self.assertEqual(len(set(content)), 1, "a mixture of two saves")
            states.add(content[0])
        self.assertNotIn(0, states)

    def test_killed(self):
        self.kill_while_saving(signal.SIGKILL, seed=1)

    def test_interrupted(self):
        self.kill_while_saving(signal.SIGINT, seed=2)


if __name__ == "__main__":
    unittest.main()
