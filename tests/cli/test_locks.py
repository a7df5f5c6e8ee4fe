"""shvr annotate with locked groups, and strokes held to unpainted voxels: voxel for voxel against plain Python."""
import json
import random
import unittest

from harness import PROGRESS, CliTest, Volume


def paint(brush, region, group, threshold, radius, path, **more):
    return {"op": "paint", "brush": brush, "region": region, "group": group, "threshold": threshold, "radius": radius,
            "connectivity": 6, "path": path, **more}


def fill(group, *at, radius=0.4, **more):
    """One voxel, or a box of them."""
    return paint("fill", "box", group, 50, radius, [[c + 0.5 for c in at]], **more)


class Locks(CliTest):
    GROUPS = {"1": {"name": "aorta"}, "2": {"locked": True, "name": "vein"}, "3": {"parent": 2, "name": "leaf trace"}}

    def prepare(self, volume, **keys):
        self.volume = volume
        self.session = self.write_session(volume={"path": volume.write(self.folder).name}, **keys)
        self.mask = self.folder / "paint.mask"

    def annotate(self, operations, *arguments):
        return self.check_json("annotate", self.session, "--script", self.write_script("script.jsonl", operations),
                               *arguments)

    def said(self, operations, *arguments):
        result = self.check("annotate", self.session, "--script", self.write_script("script.jsonl", operations),
                            *arguments)
        return [line.split("script.jsonl", 1)[1] for line in result.stderr.splitlines()
                if "script.jsonl" in line and not PROGRESS.search(line)]

    def test_every_brush_against_python(self):
        for brush in ("fill", "flood", "speckle"):
            for seed in (1, 2):
                self.check_brush(brush, seed)

    def check_brush(self, brush, seed):
        with self.subTest(brush=brush, seed=seed):
            self.setUp()
            self.prepare(Volume.noise((21, 17, 13), seed=seed))
            numbers = random.Random(seed)

            def operation():
                path = [[numbers.uniform(-2, side + 2) for side in self.volume.size] for _ in range(2)]
                only = {"only_unpainted": True} if numbers.random() < 0.3 else {}
                return paint(brush, numbers.choice(["ball", "box"]), numbers.randint(1 if only else 0, 4),
                             numbers.choice([80, 150]), numbers.uniform(3, 8), path, **only)

            before = [operation() for _ in range(6)]
            self.annotate(before + [{"op": "save"}])
            mask = bytearray(self.mask.read_bytes())
            locked = set(numbers.sample(range(1, 5), 2))
            after = [operation() for _ in range(12)]
            changed, kept_locked, kept_painted, taken = 0, 0, 0, {}
            for one in after:
                group = one["group"]
                for voxel in self.volume.select(one):
                    index = self.volume.index(voxel)
                    was = mask[index]
                    if was == group:
                        continue
                    if was in locked or group in locked:
                        kept_locked += 1
                    elif one.get("only_unpainted") and was:
                        kept_painted += 1
                    else:
                        changed += 1
                        mask[index] = group
                        if was:
                            taken[str(was)] = taken.get(str(was), 0) + 1
            result = self.annotate(after + [{"op": "save"}],
                                   *[part for group in locked for part in ("--set", f"groups.{group}.locked=true")])
            self.assertEqual(self.mask.read_bytes(), bytes(mask))
            self.assertGreater(kept_locked, 0)
            self.assertEqual([result[key] for key in ("voxels_changed", "voxels_kept_locked", "voxels_kept_painted",
                                                      "voxels_taken_from")],
                             [changed, kept_locked, kept_painted, taken])

    def test_a_locked_group_neither_loses_nor_gains_and_its_children_are_locked(self):
        self.prepare(Volume((8, 8, 8), [100] * 512))
        self.annotate([fill(group, group, 1, 1) for group in (1, 2, 3)] + [{"op": "save"}])
        before = self.mask.read_bytes()
        strokes = [fill(2, 6, 6, 6), fill(3, 6, 6, 6), fill(0, 2, 1, 1), fill(1, 3, 1, 1)]
        locks = ("--set", "groups=" + json.dumps(self.GROUPS))
        result = self.annotate(strokes + [{"op": "save"}], *locks)
        self.assertEqual(self.mask.read_bytes(), before)
        self.assertEqual((result["voxels_changed"], result["voxels_kept_locked"]), (0, 4))
        # Undo and redo are no brushes.
        self.annotate([{"op": "undo", "count": 3}, {"op": "expect", "voxels_in_group": {"1": 0, "2": 0, "3": 0}},
                       {"op": "redo", "count": 3}, {"op": "expect", "voxels_in_group": {"1": 1, "2": 1, "3": 1}}], *locks)
        result = self.annotate(strokes + [{"op": "save"}], *locks, "--set", "groups.2.locked=false")
        self.assertEqual((result["voxels_changed"], result["voxels_kept_locked"]), (4, 0))
        self.assertEqual(result["voxels_taken_from"], {"2": 2, "3": 1})

    def test_a_stroke_says_what_it_took_and_what_stayed(self):
        self.prepare(Volume((8, 8, 8), [100] * 512), groups={"1": {"name": "aorta"}, "2": {"name": "vein"}})
        self.assertEqual(
            self.said([fill(1, 2, 2, 2, radius=1.4), fill(2, 5, 2, 2), fill(4, 2, 2, 2, radius=1.4),
                       fill(5, 3, 2, 2, radius=1.4, only_unpainted=True), fill(0, 5, 2, 2)], "--verbose"),
            [":1: Painted 27 voxels in group 1 (aorta)", ":2: Painted 1 voxel in group 2 (vein)",
             ":3: Painted 27 voxels in group 4, all taken from group 1 (aorta)",
             ":4: Painted 9 voxels in group 5; 18 voxels are painted already and stayed",
             ":5: Erased 1 voxel of group 2 (vein)",
             ": 5 commands, 65 voxels changed, 5 steps not saved"])
        self.assertEqual(
            self.said([fill(1, 3, 2, 2, radius=1.4)], "--verbose", "--set", "groups.5.locked=true", "--set",
                      "groups.4.name=leaf trace"),
            [":1: Painted 18 voxels in group 1 (aorta), all taken from group 4 (leaf trace); 9 voxels of group 5 are "
             "locked and stayed",
             ": 1 command, 18 voxels changed, 9 kept by locks, 6 steps not saved"])

    def test_a_stroke_into_a_locked_group_is_told_without_being_asked(self):
        self.prepare(Volume((8, 8, 8), [100] * 512), groups=self.GROUPS)
        self.assertEqual(self.said([fill(3, 2, 2, 2)]),
                         [":1: Nothing was painted: group 3 (leaf trace) is locked; unlock it to paint in it",
                          ": 1 command, 0 voxels changed, 1 kept by locks, 0 steps not saved"])
        self.assertEqual(self.said([fill(3, 2, 2, 2)], "--quiet"), [])

    def test_what_is_previewed_is_what_a_stroke_would_paint(self):
        volume = Volume((24, 24, 24), [100] * 24 ** 3)
        self.prepare(volume, probe={"voxel": [12, 12, 12], "brush": "fill", "group": 4, "radius_voxels": 6,
                                    "paint_threshold": 50, "preview": True},
                     transfer_function={"points": [{"intensity": 200, "opacity": 0}, {"intensity": 255, "opacity": 1}]},
                     render={"size": [96, 64]})
        self.annotate([fill(1, 8, 12, 12, radius=4.6), {"op": "save"}])

        def picture(name, *settings):
            self.check("render", self.session, "-o", self.folder / name,
                       *[part for setting in settings for part in ("--set", setting)])
            return (self.folder / name).read_bytes()

        all_of_it = picture("a.png")
        locked = picture("b.png", "groups.1.locked=true")
        held = picture("c.png", "probe.only_unpainted=true")
        nothing = picture("d.png", "groups.4.locked=true")
        none = picture("e.png", "probe.paint_threshold=101")
        self.assertEqual(locked, held)  # the same voxels stay
        self.assertEqual(nothing, none)
        self.assertEqual(len({all_of_it, locked, nothing}), 3)


if __name__ == "__main__":
    unittest.main()
