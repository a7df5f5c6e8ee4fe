"""Density offsets in scripts: against the rule in plain Python, voxel for voxel; files, undo, pictures."""
import math
import random
import struct
import unittest

from harness import CliTest, Volume, stroke


def density(brush, threshold, radius, path, **keys):
    return {"op": "density", "brush": brush, "region": "ball", "threshold": threshold, "radius": radius, "path": path,
            **keys}


class Density(CliTest):
    SIZE = (20, 17, 13)
    LOWEST = 60  # lowest intensity of the transfer function in `write_session`

    def prepare(self, volume, **annotation):
        self.volume = volume
        self.base = list(volume.values)
        self.offsets = [0] * len(volume.values)
        self.mask = bytearray(len(volume.values))
        self.session = self.write_session(volume={"path": volume.write(self.folder).name},
                                          annotation={"mask": "paint.mask", "density": "raised.offset", **annotation})

    def annotate(self, operations, *arguments, status=0):
        script = self.write_script("script.jsonl", operations)
        if status:
            return self.check("annotate", self.session, "--script", script, *arguments, status=status)
        return self.check_json("annotate", self.session, "--script", script, *arguments)

    def apply(self, operation):
        """The rule, position by position; returns how many offsets and groups changed."""
        group, radius, before = operation.get("group"), operation["radius"], list(self.offsets)
        most = operation.get("offset", "automatic")
        if most == "automatic":
            most = max(0, self.LOWEST - operation["threshold"])
        if group == 0:
            most = 0
        lowest, highest = {"uint8": (0, 255), "int16": (-32768, 32767)}[self.volume.type]
        self.volume.values = [min(max(v + o, lowest), highest) for v, o in zip(self.base, self.offsets)]
        changed = 0
        for position in stroke(operation["path"]):
            for voxel in self.volume.select({**operation, "path": [position]}):
                index, here = self.volume.index(voxel), most
                if operation.get("falloff") == "distance":
                    away = math.dist([(v + 0.5) * s for v, s in zip(voxel, self.volume.spacing)],
                                     [p * s for p, s in zip(position, self.volume.spacing)])
                    here = most * max(0.0, 1 - away / (radius * self.volume.spacing[0]))
                    here = int(math.copysign(math.floor(abs(here) + 0.5), here))
                old = self.offsets[index]
                self.offsets[index] = max(here, min(old, most)) if most >= 0 else min(here, max(old, most))
                if group is not None:
                    changed += self.mask[index] != group
                    self.mask[index] = group
        return changed + sum(a != b for a, b in zip(before, self.offsets))

    def check_strokes(self, volume, letter, seed):
        self.prepare(volume)
        numbers, operations, changed = random.Random(seed), [], 0
        for _ in range(14):
            path = [[numbers.uniform(-1, s + 1) for s in volume.size] for _ in range(numbers.choice([1, 1, 2]))]
            operation = density(numbers.choice(["fill", "flood", "speckle"]), numbers.choice(sorted(self.base)),
                                numbers.uniform(2, 8), path, region=numbers.choice(["ball", "box"]),
                                falloff=numbers.choice(["flat", "distance"]))
            kind = numbers.randrange(4)
            if kind < 2:
                operation["offset"] = numbers.randint(-80, 250)
            if kind == 2:
                operation["group"] = numbers.randint(0, 3)
            changed += self.apply(operation)
            operations += [operation, {"op": "expect", "voxels_with_offset": sum(o != 0 for o in self.offsets)}]
        self.assertGreater(sum(o != 0 for o in self.offsets), 50)
        raw = (self.folder / "volume.raw").read_bytes()
        result = self.annotate(operations + [{"op": "save"}])
        self.assertEqual(result["voxels_changed"], changed)
        count = len(self.offsets)
        saved = (self.folder / "raised.offset").read_bytes()
        self.assertEqual(list(struct.unpack(f"<{count}{letter}", saved)), self.offsets)
        self.assertEqual((self.folder / "paint.mask").read_bytes(), bytes(self.mask))
        self.assertEqual((self.folder / "volume.raw").read_bytes(), raw)  # never written

    def test_strokes(self):
        self.check_strokes(Volume.noise(self.SIZE, seed=1), "h", seed=1)

    def test_strokes_with_spacing_and_16_bits(self):
        numbers = random.Random(5)
        values = [numbers.randint(-900, 900) for _ in range(20 * 17 * 13)]
        self.check_strokes(Volume(self.SIZE, values, (0.5, 0.8, 1.3), "int16"), "i", seed=3)

    def test_undo_takes_offsets_and_groups_back(self):
        self.prepare(Volume((16, 16, 16), [50] * 4096))
        both = density("fill", 0, 3, [[8, 8, 8]], offset=40, group=3)
        raised = len(self.volume.select({**both, "path": [[8, 8, 8]]}))
        expect = {"op": "expect", "voxels_with_offset": raised, "voxels_in_group": {"3": raised}}
        none = {"op": "expect", "voxels_with_offset": 0, "voxels_in_group": {"3": 0}}
        # Only raised voxels are at or above 90.
        fill = {"op": "paint", "brush": "fill", "group": 3, "threshold": 90, "radius": 7, "path": [[8, 8, 8]]}
        self.annotate([both, expect, {"op": "undo"}, none, fill, none, {"op": "redo"}, expect,
                       density("fill", 0, 7, [[8, 8, 8]], group=0), none, {"op": "undo"}, expect, {"op": "undo"},
                       none, density("fill", 0, 3, [[8, 8, 8]], offset=40), fill, expect])

    def test_saved_offsets_are_gone_on_with_and_seen(self):
        self.prepare(Volume((16, 16, 16), [50] * 4096))
        self.annotate([{"op": "save"}])
        self.assertFalse((self.folder / "raised.offset").exists())  # there are none
        pictures = [self.folder / f"{name}.png" for name in ("before", "after", "fresh")]
        self.check("render", self.session, "-o", pictures[0])
        self.annotate([density("fill", 50, 3, [[8, 8, 8]], offset=100), {"op": "save"}])
        saved = (self.folder / "raised.offset").read_bytes()
        self.check("render", self.session, "-o", pictures[1])
        self.annotate([density("fill", 150, 9, [[8, 8, 8]], group=0), {"op": "save"}])
        self.assertEqual((self.folder / "raised.offset").read_bytes(), bytes(len(saved)))
        self.check("render", self.session, "-o", pictures[2])
        before, after, fresh = (path.read_bytes() for path in pictures)
        self.assertNotEqual(before, after)
        self.assertEqual(before, fresh)

    def test_offsets_without_a_file_to_go_to_are_refused(self):
        self.prepare(Volume((4, 4, 4), [1] * 64))
        session = self.write_session(volume={"path": "volume.nhdr"}, annotation={"trace": "paint.graphml"})
        script = self.write_script("script.jsonl", [density("fill", 0, 2, [[2, 2, 2]], offset=5), {"op": "save"}])
        self.check_refused("annotate", session, "--script", script, "--quiet",
                           says=["script.jsonl:2 saves", "annotation.density"])
        self.assertFalse((self.folder / "paint.mask").exists())

    def test_offsets_of_another_volume_are_refused(self):
        self.prepare(Volume((4, 4, 4), [1] * 64))
        (self.folder / "raised.offset").write_bytes(bytes(127))
        self.check_refused("render", self.session, "-o", self.folder / "a.png", says=["raised.offset", "127", "128"])

    def test_a_failing_expectation_is_a_gate(self):
        self.prepare(Volume((4, 4, 4), [1] * 64))
        stderr = self.annotate([{"op": "expect", "voxels_with_offset": 7}], status=3).stderr
        self.assertIn("0 voxels have an offset; expected 7", stderr)


if __name__ == "__main__":
    unittest.main()
