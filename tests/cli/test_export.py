"""shvr export: files for other programs, read back by shvr or in plain Python."""
import csv
import json
import struct
import unittest

from harness import CliTest, Volume
from test_label import read_by_zarr

KEYS = ["written", "voxels_by_group", "nodes", "internodes", "length_um_by_group"]


def node(x, y, z, radius=2, group=1):
    return {"op": "node", "at": [x, y, z], "radius": radius, "group": group}


class Help(CliTest):
    # Kind (Traces): the origin of exported coordinates
    def test_the_origin_of_each_space_is_said(self):
        text = " ".join(self.check("export", "--help").stdout.split())
        self.assertIn("the origin at the centre of voxel 0", text)
        self.assertIn("the outer corner of voxel 0", text)


class Export(CliTest):
    SIZE = [24, 20, 40]
    SPACING = [0.5, 1.0, 2.0]

    def setUp(self):
        super().setUp()
        self.session = self.write_session(
            volume={"procedural": "constant", "size": self.SIZE, "spacing": self.SPACING, "unit": "mm"})
        script = self.write_script("script.jsonl", [
            {"op": "paint", "brush": "fill", "region": "box", "group": 3, "threshold": 0, "radius": 6,
             "path": [[5, 5, 33]]},
            node(2, 2, 2), node(8, 2, 2, 2, 4), node(8, 6, 2, 2, 4), {"op": "select", "node": 1}, node(8, 2, 4),
            {"op": "save"}])
        self.check("annotate", self.session, "--script", script)

    def export(self, *arguments, status=0):
        if status:
            return self.check_refused("export", self.session, *arguments, status=status)
        return self.check_json("export", self.session, *arguments)

    def test_keys_and_figures(self):
        result = self.export()
        self.assert_keys(result, KEYS)
        self.assertEqual(result["written"], [])
        self.assertEqual((result["nodes"], result["internodes"]), (4, 3))
        # 6 voxels of 0.5 mm; 4 of 1 mm and 2 of 2 mm.
        self.assertEqual(result["length_um_by_group"], {"1": 4000, "4": 7000})
        self.assertEqual(result["length_by_group"], {"1": 4, "4": 7})
        self.assertEqual(result["unit"], "mm")
        voxels = (self.folder / "paint.mask").read_bytes().count(3)
        self.assertGreater(voxels, 0)
        self.assertEqual(result["voxels_by_group"], {"3": voxels})

    def test_masks_are_the_saved_one_and_keep_spacing_and_unit(self):
        saved = (self.folder / "paint.mask").read_bytes()
        for name in ["a.mask", "a.nrrd", "a.tif", "a.zarr"]:
            with self.subTest(name=name):
                path = self.folder / name
                self.assertEqual(self.export("--mask", path)["written"], [str(path)])
                if name == "a.mask":
                    self.assertEqual(path.read_bytes(), saved)
                    continue
                info = self.check_json("info", path)
                self.assertEqual(info["size"], self.SIZE)
                self.assertEqual(info["type"], "uint8")
                self.assertEqual([round(s, 6) for s in info["spacing"]], self.SPACING)
                self.assertEqual(info["unit"], "mm")
                result = self.check_json("evaluate", "--truth-mask", path, "--mask", self.folder / "paint.mask",
                                         "--volume", self.session)
                self.assertEqual((result["dice"], result["dice_by_group"]), (1, {"3": 1}))
        self.assertTrue((self.folder / "a.nrrd").read_bytes().endswith(saved))

    def test_the_text_of_the_thesis(self):
        path = self.folder / "a.txt"
        links = "-l 0, 1, 4\n-l 1, 2, 4\n-l 1, 3, 1\n"

        def lines(*options):
            self.export("--trace", path, *options)
            comments, rest = path.read_text().split("-v ", 1)
            self.assertTrue(all(line.startswith("# ") for line in comments.splitlines()))
            return "-v " + rest
        # Half a voxel, 0.25 x 0.5 x 1 mm, lies between the outer corner of voxel 0 and its centre.
        self.assertEqual(lines(), "-v 0.75, 1.5, 3, 1, 1\n-v 3.75, 1.5, 3, 4, 1\n-v 3.75, 5.5, 3, 4, 1\n"
                                  "-v 3.75, 1.5, 7, 1, 1\n" + links)
        self.assertEqual(lines("--space", "volume"),
                         "-v 1, 2, 4, 1, 1\n-v 4, 2, 4, 4, 1\n-v 4, 6, 4, 4, 1\n-v 4, 2, 8, 1, 1\n" + links)

    def test_every_form_of_the_trace_that_is_read_gives_the_same_trace(self):
        self.export("--trace", self.folder / "first.txt")
        for name in ["a.txt", "a.swc", "a.graphml", "a.rsml"]:
            with self.subTest(name=name):
                self.export("--trace", self.folder / name)
                other = self.write_session(
                    "other.json", volume={"procedural": "constant", "size": self.SIZE, "spacing": self.SPACING,
                                          "unit": "mm"}, annotation={"trace": name})
                self.check("export", other, "--trace", self.folder / "second.txt")
                self.assertEqual((self.folder / "second.txt").read_text(), (self.folder / "first.txt").read_text())

    def test_a_loop_is_refused_by_trees_or_broken_when_asked(self):
        script = self.write_script("loop.jsonl", [{"op": "select", "node": 3}, {"op": "link", "near": [8, 6, 2]},
                                                  {"op": "save"}])
        self.check("annotate", self.session, "--script", script)
        for name in ["a.swc", "a.rsml"]:
            path = self.folder / name
            self.export("--trace", path, status=1)
            self.assertFalse(path.exists())
            result = self.export("--trace", path, "--break-loops")
            self.assertEqual(len(result["left_out"]), 1)
            self.assertIn("internode 3 between nodes 3 and 2", result["left_out"][0])
        self.assertIn("internode 3 between nodes 3 and 2", (self.folder / "a.swc").read_text())

    def test_tubes(self):
        self.export("--mesh", self.folder / "a.ply")
        self.export("--mesh", self.folder / "a.obj")
        data = (self.folder / "a.ply").read_bytes()
        header, body = data.split(b"end_header\n", 1)
        vertices = int(header.split(b"element vertex ")[1].split()[0])
        self.assertIn(b"unit mm", header)
        points = [struct.unpack_from("<3d", body, 24 * i) for i in range(vertices)]
        text = [tuple(map(float, line.split()[1:])) for line in (self.folder / "a.obj").read_text().splitlines()
                if line.startswith("v ")]
        self.assertEqual(len(text), vertices)
        self.assertTrue(all(p == q for p, q in zip(points, text)))
        # Radius 1 around nodes from (1, 2, 4) to (4, 6, 8), the centre of voxel 0 at (0.25, 0.5, 1).
        self.assertAlmostEqual(min(p[0] for p in points), -0.25, delta=0.2)
        self.assertAlmostEqual(max(p[2] for p in points), 8, delta=0.2)

    def test_measures(self):
        path = self.folder / "a.csv"
        self.export("--metrics", path)
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), ["item", "number", "group", "measure", "value", "unit"])
        self.assertTrue(all(row["unit"] for row in rows))
        values = {(row["item"], row["number"], row["group"], row["measure"]): float(row["value"]) for row in rows}
        self.assertEqual(values["mask", "", "3", "components"], 1)
        self.assertEqual(values["mask", "", "3", "loops"], 0)
        self.assertEqual(values["trace", "", "", "branches"], 1)
        self.assertEqual(values["trace", "", "4", "length"], 7)
        self.assertEqual(values["segment", "0", "4", "length"], 3)
        self.assertEqual(values["segment", "0", "4", "tortuosity"], 1)
        self.assertEqual([row["value"] for row in rows if row["measure"] == "angle"], ["90", "90", "90"])
        self.assertEqual({row["unit"] for row in rows if row["measure"] == "length"}, {"mm"})

    def test_patterns_of_a_flower_head(self):
        self.check("phantom", "capitulum", "--size", 24, "--stage", "c", "-o", self.folder)
        session = self.write_session("head.json", volume={"path": "capitulum.nhdr"},
                                     annotation={"trace": "capitulum-trace.graphml"})
        self.check("export", session, "--metrics", self.folder / "h.csv")
        with open(self.folder / "h.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertTrue(all(row["unit"] and None not in row.values() for row in rows))
        values = {row["measure"]: row["value"] for row in rows if row["item"] == "pattern"}
        self.assertEqual([values["stage_" + stage] for stage in "abcd"], ["0", "0", "1", "0"])
        self.assertEqual(float(values["axis_direction_z"]), 1)
        self.assertAlmostEqual(float(values["radiality"]), 1)
        self.assertEqual(values["connections_adaxial_floret_rho_least"], "")
        reasons = [row["measure"] for row in rows if row["item"] == "reason"]
        self.assertIn("connections_adaxial_floret_rho_least: there is no such connection", reasons)
        # Without florets there is no connection, and no other stage.
        self.check("export", session, "--metrics", self.folder / "h.csv", "--sections", "abaxial=1,adaxial=2")
        self.assertIn("pattern,,,florets,0,1", (self.folder / "h.csv").read_text())
        # A stated axis is used as it is.
        self.check("export", session, "--metrics", self.folder / "h.csv", "--axis", "11.5,11.5,0,0,0,2")
        self.assertIn("pattern,,,axis_x,11.5,", (self.folder / "h.csv").read_text())
        self.assertIn("axis_direction_error: the axis is stated", (self.folder / "h.csv").read_text())
        self.check_refused("export", session, "--metrics", self.folder / "h.csv", "--axis", "11.5,11.5", status=2,
                           says=["--axis is '11.5,11.5': found 2 numbers; expected six"])
        for sections, words in [("adaxial", "expected abaxial, adaxial or floret"), ("adaxial=300", "1 to 255")]:
            self.check_refused("export", session, "--metrics", self.folder / "h.csv", "--sections", sections,
                               status=2, says=[words])

    def test_a_project_is_exported(self):
        header = Volume((8, 8, 8), [100] * 512).write(self.folder)
        self.check("import", header, self.folder / "project")
        script = self.write_script("script.jsonl", [node(2, 2, 2), node(4, 2, 2), {"op": "save"}])
        self.check("annotate", self.folder / "project", "--script", script)
        result = self.check_json("export", self.folder / "project", "--trace", self.folder / "p.swc")
        self.assertEqual((result["nodes"], result["internodes"]), (2, 1))

    def test_masks_of_every_form_are_read_back(self):
        saved = (self.folder / "paint.mask").read_bytes()
        for name in ["a.nrrd", "a.tif", "a.zarr"]:
            with self.subTest(name=name):
                self.export("--mask", self.folder / name)
                other = self.write_session(f"other-{name}.json", annotation={"mask": name}, volume={
                    "procedural": "constant", "size": self.SIZE, "spacing": self.SPACING, "unit": "mm"})
                self.check("export", other, "--mask", self.folder / "b.mask")
                self.assertEqual((self.folder / "b.mask").read_bytes(), saved)
                # Further painting by annotate is saved in the same format.
                script = self.write_script("more.jsonl", [
                    {"op": "paint", "brush": "fill", "region": "box", "group": 7, "threshold": 0, "radius": 2,
                     "path": [[12, 12, 12]]}, {"op": "save"}])
                self.check("annotate", other, "--script", script)
                self.check("export", other, "--mask", self.folder / "b.mask")
                painted = (self.folder / "b.mask").read_bytes()
                self.assertEqual(painted.count(7), 16)
                self.assertEqual([a for a, b in zip(painted, saved) if a != b], [7] * 16)

    def test_masks_of_other_volumes_are_refused_with_both_named(self):
        for name in ["a.nrrd", "a.tif", "a.zarr"]:
            self.export("--mask", self.folder / name)
            for size, spacing, unit, says in [
                    ([24, 20, 41], self.SPACING, "mm", ["24 20 40", "24 20 41"]),
                    (self.SIZE, [0.5, 1, 2.5], "mm", ["0.5 x 1 x 2 mm", "0.5 x 1 x 2.5 mm"]),
                    (self.SIZE, self.SPACING, "um", ["0.5 x 1 x 2 mm", "0.5 x 1 x 2 µm"])]:
                with self.subTest(name=name, size=size, spacing=spacing, unit=unit):
                    other = self.write_session("other.json", annotation={"mask": name}, volume={
                        "procedural": "constant", "size": size, "spacing": spacing, "unit": unit})
                    self.check_refused("export", other, "--mask", self.folder / "b.mask", says=says)
            # The same voxel size in another unit.
            other = self.write_session("other.json", annotation={"mask": name}, volume={
                "procedural": "constant", "size": self.SIZE, "spacing": [500, 1000, 2000], "unit": "um"})
            self.check("export", other, "--mask", self.folder / "b.mask")
        wide = Volume(self.SIZE, [0] * (24 * 20 * 40 - 1) + [300], voxel_type="uint16").write(self.folder, "wide")
        other = self.write_session("other.json", annotation={"mask": wide.name}, volume={
            "procedural": "constant", "size": self.SIZE})
        self.check_refused("export", other, "--mask", self.folder / "b.mask", says=["300", "255"])

    def test_labels_are_read_by_python_zarr_with_colours_and_source(self):
        saved = (self.folder / "paint.mask").read_bytes()
        self.session = self.write_session(
            volume={"procedural": "constant", "size": self.SIZE, "spacing": self.SPACING, "unit": "mm"},
            groups={"3": {"name": "vessel", "color": "#ff8000", "opacity": 0.5}})
        self.export("--mask", self.folder / "a.zarr")
        found = read_by_zarr(self, self.folder / "a.zarr", self.folder / "bare")
        self.assertEqual((self.folder / "bare").read_bytes(), saved)
        self.assertEqual(found["type"], "uint8")
        self.assertEqual(found["units"], ["millimeter"] * 3)
        self.assertEqual(found["scales"][0], [[2, 1, 0.5], [0, 0, 0]])
        self.assertEqual(found["label"]["colors"], [{"label-value": 3, "rgba": [255, 128, 0, 128]}])
        self.assertEqual(found["label"]["properties"], [{"label-value": 3, "name": "vessel"}])

    def test_a_mask_that_is_saved_as_labels_keeps_the_looks_of_its_groups(self):
        volume = {"procedural": "constant", "size": self.SIZE, "spacing": self.SPACING, "unit": "mm"}
        groups = {"3": {"name": "vessel", "color": "#ff8000", "opacity": 0.2}, "5": {"name": "not painted"}}
        drawn = self.write_session("drawn.json", volume=volume, groups=groups, annotation={"mask": "own.zarr"})
        paint = {"op": "paint", "brush": "fill", "region": "box", "threshold": 0, "radius": 4}
        script = self.write_script("paint.jsonl", [{**paint, "group": 3, "path": [[5, 5, 5]]},
                                                   {**paint, "group": 12, "path": [[14, 14, 20]]}, {"op": "save"}])
        self.check("annotate", drawn, "--script", script)
        label = read_by_zarr(self, self.folder / "own.zarr", self.folder / "bare")["label"]
        self.assertEqual([color["label-value"] for color in label["colors"]], [3, 5, 12])
        self.assertEqual(label["colors"][0]["rgba"], [255, 128, 0, 51])
        self.assertEqual(label["colors"][2]["rgba"], [0x11, 0xa6, 0x99, 255])  # the second of the ten
        self.assertEqual(label["properties"], [{"label-value": 3, "name": "vessel"},
                                               {"label-value": 5, "name": "not painted"},
                                               {"label-value": 12, "name": "group 12"}])
        # A session without groups draws the same picture and reports the same looks.
        plain = self.write_session("plain.json", volume=volume, annotation={"mask": "own.zarr"})
        for session, name in [(drawn, "drawn"), (plain, "plain")]:
            self.check("render", session, "-o", self.folder / f"{name}.png")
            self.check("export", session, "--mask", self.folder / f"{name}.zarr")
        self.assertEqual((self.folder / "drawn.png").read_bytes(), (self.folder / "plain.png").read_bytes())
        self.assertEqual(json.loads((self.folder / "plain.zarr" / ".zattrs").read_text())["image-label"], label)
        # A group that the session itself defines takes precedence as a whole.
        own = self.write_session("own.json", volume=volume, groups={"3": {"name": "mine"}},
                                 annotation={"mask": "own.zarr"})
        self.check("export", own, "--mask", self.folder / "again.zarr")
        again = json.loads((self.folder / "again.zarr" / ".zattrs").read_text())["image-label"]
        self.assertEqual(again["colors"][0]["rgba"], [83, 91, 191, 255])
        self.assertEqual([entry["name"] for entry in again["properties"]], ["mine", "not painted", "group 12"])

    def test_a_project_takes_its_mask_as_labels_and_knows_it_again(self):
        for name, seed in [("project", 1), ("other", 2)]:
            header = Volume.noise((20, 12, 9), seed=seed).write(self.folder, name + "-volume")
            self.check("import", header, self.folder / name)
        script = self.write_script("script.jsonl", [
            {"op": "paint", "brush": "fill", "region": "box", "group": 2, "threshold": 100, "radius": 5,
             "path": [[8, 6, 4]]}, {"op": "save"}])
        project = self.folder / "project"
        self.check("annotate", project, "--script", script)
        result = self.check_json("export", project, "--labels")
        labels = project / "labels" / "mask"
        self.assertEqual(result["written"], [str(labels)])
        self.assertEqual(json.loads((project / "labels" / ".zattrs").read_text()), {"labels": ["paint", "mask"]})
        found = read_by_zarr(self, labels, self.folder / "bare")
        self.assertEqual((self.folder / "bare").read_bytes(), self.mask_of(project))
        self.assertEqual(found["label"]["source"], {"image": "../../"})
        self.assertTrue(found["shvr"]["image"].startswith("xxh3-128:"))
        # Read back by its own volume; refused by another one of its size.
        again = self.check_json("export", project, "--set", f'annotation.mask="{labels}"')
        self.assertEqual(again["voxels_by_group"], result["voxels_by_group"])
        self.check_refused("export", self.folder / "other", "--set", f'annotation.mask="{labels}"',
                           says=["painted on other voxels", found["shvr"]["image"]])
        self.check_refused("export", self.session, "--labels", says=["is no project folder"])

    def test_offsets_are_floats_for_other_programs(self):
        self.session = self.write_session(
            volume={"procedural": "constant", "size": self.SIZE, "spacing": self.SPACING, "unit": "mm"},
            annotation={"mask": "paint.mask", "density": "paint.offset"})
        script = self.write_script("density.jsonl", [
            {"op": "density", "brush": "fill", "region": "box", "threshold": 0, "radius": 2, "offset": -40,
             "path": [[12, 12, 12]]}, {"op": "save"}])
        self.check("annotate", self.session, "--script", script)
        saved = (self.folder / "paint.offset").read_bytes()
        offsets = struct.unpack(f"<{len(saved) // 2}h", saved)
        self.assertEqual(set(offsets), {0, -40})
        for name in ["a.offset", "a.nrrd", "a.tif"]:
            self.assertEqual(self.export("--offset", self.folder / name)["written"], [str(self.folder / name)])
        self.assertEqual((self.folder / "a.offset").read_bytes(), saved)
        self.assertTrue((self.folder / "a.nrrd").read_bytes().endswith(struct.pack(f"<{len(offsets)}f", *offsets)))
        for name in ["a.nrrd", "a.tif"]:
            # A session that names such a file reads it and saves in the same format.
            other = self.write_session("other.json", annotation={"mask": "other.mask", "density": name}, volume={
                "procedural": "constant", "size": self.SIZE, "spacing": self.SPACING, "unit": "mm"})
            self.check("export", other, "--offset", self.folder / "b.offset")
            self.assertEqual((self.folder / "b.offset").read_bytes(), saved)
            first = struct.unpack_from("<h", saved)
            script = self.write_script("more.jsonl", [
                {"op": "density", "brush": "fill", "region": "box", "threshold": -1e9, "radius": 0.6, "offset": 7,
                 "path": [[0.5, 0.5, 0.5]]}, {"op": "save"}])
            self.assertEqual(first, (0,))
            self.check("annotate", other, "--script", script)
            (self.folder / "other.journal").unlink()
            self.check("export", other, "--offset", self.folder / "b.offset")
            again = (self.folder / "b.offset").read_bytes()
            self.assertEqual((again[:2], again[2:]), (struct.pack("<h", 7), saved[2:]))
            for size, spacing, says in [([24, 20, 41], self.SPACING, ["24 20 40", "24 20 41"]),
                                        (self.SIZE, [0.5, 1, 2.5], ["0.5 x 1 x 2 mm", "0.5 x 1 x 2.5 mm"])]:
                wrong = self.write_session("wrong.json", annotation={"density": name}, volume={
                    "procedural": "constant", "size": size, "spacing": spacing, "unit": "mm"})
                self.check_refused("export", wrong, "--offset", self.folder / "c.offset", says=[name, *says])
            self.assertFalse((self.folder / "c.offset").exists())
            self.export("--offset", self.folder / name)
            info = self.check_json("info", self.folder / name)
            self.assertEqual((info["type"], info["size"], info["unit"]), ("float32", self.SIZE, "mm"))
            self.assertEqual((info["min"], info["max"]), (-40, 0))
            self.assertAlmostEqual(info["mean"], sum(offsets) / len(offsets), places=6)

    def test_wrong_usage_writes_nothing(self):
        for option, name in [("--mask", "a.png"), ("--offset", "a.mask"), ("--trace", "a.obj"), ("--mesh", "a.swc"), ("--metrics", "a.txt")]:
            with self.subTest(option=option):
                stderr = self.export("--trace", self.folder / "b.txt", option, self.folder / name, status=2) \
                    if option != "--trace" else self.export(option, self.folder / name, status=2)
                self.assertIn("ends in one of", stderr)
                self.assertFalse((self.folder / "b.txt").exists())
        (self.folder / "paint.graphml").unlink()
        self.assertEqual(self.export()["nodes"], 4)  # the journal has them
        (self.folder / "session.journal").unlink()
        stderr = self.export("--trace", self.folder / "b.txt", status=1)
        self.assertIn("paint.graphml", stderr)
        self.assertEqual(self.export()["nodes"], 0)


class Segmentation(CliTest):
    TAGS = "Segment0_Tags:=TerminologyEntry:Segmentation category^SCT^123037004|"
    SIZE = [8, 8, 8]

    def header(self, name):
        return (self.folder / name).read_bytes().split(b"\n\n")[0].decode().split("\n")

    # Kind (Masks): exports of work on a segmentation of 3D Slicer, by its own name and through label images
    def test_exports_keep_what_a_segmentation_states(self):
        header = ("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nspacings: 1 1 1\nencoding: raw\n"
                  f"Segment0_LabelValue:=1\nSegment0_Name:=xylem\n{self.TAGS}\nlab:=two roots\n\n")
        (self.folder / "cells.seg.nrrd").write_bytes(header.encode() + bytes(511) + b"\1")
        session = self.write_session(volume={"procedural": "constant", "size": self.SIZE},
                                     annotation={"mask": "cells.seg.nrrd"})
        script = self.write_script("script.jsonl", [
            {"op": "paint", "brush": "fill", "region": "box", "group": 3, "threshold": 0, "radius": 1,
             "path": [[4, 4, 4]]}, {"op": "save"}])
        for name in ["a.seg.nrrd", "labels.zarr"]:
            self.check("export", session, "--mask", self.folder / name)
        self.check("annotate", session, "--script", script)
        labels = self.write_session("labels.json", volume={"procedural": "constant", "size": self.SIZE},
                                    annotation={"mask": "labels.zarr"})
        self.check("annotate", labels, "--script", script)  # a save over the labels
        for name in ["b.seg.nrrd", "b.nrrd"]:
            self.check("export", labels, "--mask", self.folder / name)
        for name in ["cells.seg.nrrd", "a.seg.nrrd", "b.seg.nrrd", "b.nrrd"]:
            with self.subTest(name=name):
                self.assertLessEqual({self.TAGS, "Segment0_Name:=xylem", "lab:=two roots"}, set(self.header(name)))
                self.assertEqual("Segment1_LabelValue:=3" in self.header(name), name != "a.seg.nrrd")


if __name__ == "__main__":
    unittest.main()
