"""The line "load" of scripts: a mask, offsets, a trace and a transfer function are added as steps that can be undone."""
import json
import unittest

from harness import CliTest, Volume

SIZE = (6, 5, 4)
VOXELS = 6 * 5 * 4


class Load(CliTest):
    def setUp(self):
        super().setUp()
        name = Volume(SIZE, [100] * VOXELS).write(self.folder).name
        self.session = self.write_session(volume={"path": name}, annotation={
            "mask": "paint.mask", "density": "raised.offset", "trace": "veins.graphml"})
        self.groups = bytes(3 if i % 7 == 0 else 0 for i in range(VOXELS))
        (self.folder / "other.mask").write_bytes(self.groups)

    def annotate(self, *operations, status=0):
        script = self.write_script("script.jsonl", operations)
        if status:
            return self.check_refused("annotate", self.session, "--script", script, status=status)
        return self.check_json("annotate", self.session, "--script", script)

    def path(self, name):
        return str(self.folder / name)

    def test_a_mask_a_trace_and_offsets_are_loaded_and_undone(self):
        painted = self.groups.count(3)
        (self.folder / "other.swc").write_text("1 5 1 1 1 1 -1\n2 5 3 1 1 1 1\n")
        # Offsets and a trace as another project writes them.
        made = self.write_session("made.json", volume={"path": "volume.nhdr"}, annotation={
            "mask": "made.mask", "density": "made.offset"})
        self.check("annotate", made, "--script", self.write_script("made.jsonl", [
            {"op": "density", "brush": "fill", "region": "ball", "threshold": 50, "offset": 40, "radius": 1.2,
             "path": [[3, 3, 2]]}, {"op": "save"}]))
        self.annotate(
            {"op": "load", "what": "mask", "path": self.path("other.mask")},
            {"op": "expect", "voxels_in_group": {"3": painted}, "nodes": 0},
            {"op": "load", "what": "trace", "path": self.path("other.swc")},
            {"op": "expect", "nodes": 2, "internodes": 1, "voxels_in_group": {"3": painted}},
            {"op": "load", "path": self.path("other.swc")},  # by its contents; what is there already is not added twice
            {"op": "undo"},
            {"op": "expect", "voxels_with_offset": 0})
        raised = self.check_json("annotate", self.session, "--script", self.write_script("o.jsonl", [
            {"op": "load", "what": "offsets", "path": self.path("made.offset")}]))
        self.assertEqual(raised["commands"], 1)
        self.annotate({"op": "expect", "voxels_with_offset": 0}, status=3)
        self.annotate({"op": "undo"}, {"op": "expect", "voxels_with_offset": 0, "voxels_in_group": {"3": painted}},
                      {"op": "save"})
        self.assertEqual((self.folder / "paint.mask").read_bytes(), self.groups)

    # Kind (bad input and lost work): a script that loads settings, which scripts otherwise do not change
    def test_a_transfer_function_is_loaded_kept_and_undone(self):
        curve = {"points": [{"intensity": 1, "color": "#000000", "opacity": 0},
                            {"intensity": 90, "color": "#ff0000", "opacity": 1}]}
        (self.folder / "curve.json").write_text(json.dumps(curve))

        def drawn(*arguments):
            picture = self.folder / "picture.png"
            self.check("render", self.session, "-o", picture, "--size", "24x24", "--camera", "front", *arguments)
            return picture.read_bytes()
        before, red = drawn(), drawn("--set", "transfer_function=" + json.dumps(curve))
        self.assertNotEqual(before, red)
        self.annotate({"op": "load", "path": self.path("curve.json")}, {"op": "save"})
        self.assertEqual(drawn(), red)
        self.annotate({"op": "undo"})
        self.assertEqual(drawn(), before)

    def test_names_of_groups_come_with_a_mask_and_go_with_it(self):
        voxels = bytes(1 if i < 30 else 0 for i in range(VOXELS))
        header = (f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {SIZE[0]} {SIZE[1]} {SIZE[2]}\nspacings: 1 1 1\n"
                  "encoding: raw\nSegment0_LabelValue:=1\nSegment0_Name:=xylem\n\n")
        (self.folder / "cells.seg.nrrd").write_bytes(header.encode() + voxels)
        empty = {"op": "shrink", "group": 1, "distance": 1}  # 30 voxels, one slice

        def said(*operations):
            ran = self.check("annotate", self.session, "--verbose", "--script",
                             self.write_script("named.jsonl", operations))
            return ran.stdout + ran.stderr
        self.assertIn("30 voxels of group 1 (xylem) erased", said(
            {"op": "load", "path": self.path("cells.seg.nrrd")}, empty))
        self.assertIn("group 1 (xylem) erased", said({"op": "undo"}, empty, {"op": "save"}))  # another run has it, too
        self.assertRegex(said({"op": "undo", "count": 2}, {"op": "load", "path": self.path("other.mask")},
                              {"op": "shrink", "group": 3, "distance": 1}), r"voxels of group 3 erased")

    def test_an_unknown_operation_is_refused_with_all_that_there_are(self):
        said = self.annotate({"op": "lode", "path": "x"}, status=1)
        for name in ("paint", "threshold", "load"):
            self.assertIn(f'"{name}"', said)

    def test_what_cannot_be_loaded_is_refused_by_its_line_and_earlier_lines_stay(self):
        script = self.folder / "script.jsonl"
        first = {"op": "load", "what": "mask", "path": self.path("other.mask")}
        said = self.annotate(first, {"op": "load", "path": self.path("none.mask")}, status=1)
        self.assertIn(f'{script}:2: key path is "{self.folder}/none.mask"; expected a file that exists', said)
        said = self.annotate(first, {"op": "load", "what": "scan", "path": self.path("volume.nhdr")}, status=1)
        self.assertIn(f"{script}:2: key what is ", said)
        self.assertFalse((self.folder / "session.journal").exists(), "scripts are checked before anything is done")
        (self.folder / "short.mask").write_bytes(bytes(VOXELS - 1))
        said = self.annotate(first, {"op": "load", "what": "mask", "path": self.path("short.mask")}, status=1)
        self.assertIn(f"{script}:2: {self.folder / 'short.mask'}", said)
        self.assertIn("is kept", said)
        self.annotate({"op": "expect", "voxels_in_group": {"3": self.groups.count(3)}})
        said = self.annotate({"op": "load", "what": "mask", "file": "other.mask"}, status=1)
        self.assertIn("file", said)


if __name__ == "__main__":
    unittest.main()
