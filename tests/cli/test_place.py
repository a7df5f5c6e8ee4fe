"""Where things are: an off-centre mark through every reader and writer, its position computed from each file alone."""
import json
import math
import re
import struct
import unittest

import placed_files as files
from harness import IS_SLOW, CliTest
from placed_files import Place
from test_label import read_by_zarr

SPACING = (0.5, 0.75, 1.25)


def along(*axes):
    """A place whose steps run along these axes of LPS: 1 is x, -2 against y."""
    steps = [[math.copysign(side, axis) if i == abs(axis) - 1 else 0 for i in range(3)] for axis, side in zip(axes, SPACING)]
    return Place(steps, (-101.5, 20.25, 1030.125))


LPS = along(-1, -2, 3)           # the patient of most scanners, as 3D Slicer writes RAS data
STRAIGHT = along(1, 2, 3)
PERMUTED = along(2, 3, 1)
LEFT = along(1, -2, 3)           # left-handed: voxels are read backwards along one axis
TURN = math.radians(30)
OBLIQUE = Place([[0.5 * math.cos(TURN), 0.5 * math.sin(TURN), 0], [-0.75 * math.sin(TURN), 0.75 * math.cos(TURN), 0],
                 [0, 0, 1.25]], (5, 6, 7))
NOWHERE = Place([[0.5, 0, 0], [0, 0.75, 0], [0, 0, 1.25]], (0, 0, 0))
# Even corners, so that halving keeps the mark whole; whatever axis is read backwards, it is in the box.
PREPARATIONS = {"whole": [], "crop": ["--crop", "2,2,2,10,8,6"], "half": ["--downscale", 2],
                "crop and half": ["--crop", "2,2,2,10,8,6", "--downscale", 2]}


class PlaceTest(CliTest):
    def inputs(self):
        """Every reader, with axes of every kind that its format can state: name, arguments, the mark's true position."""
        f = self.folder
        yield "nrrd lps", [files.write_nrrd(f / "lps.nrrd", LPS)], LPS
        yield "nrrd ras", [files.write_nrrd(f / "ras.nrrd", LPS, "right-anterior-superior")], LPS
        yield "nrrd las", [files.write_nrrd(f / "las.nrrd", PERMUTED, "left-anterior-superior")], PERMUTED
        yield "nrrd left", [files.write_nrrd(f / "left.nrrd", LEFT)], LEFT
        yield "nrrd no frame", [files.write_nrrd(f / "frameless.nrrd", PERMUTED, None)], PERMUTED
        yield "nrrd oblique", [files.write_nrrd(f / "oblique.nrrd", OBLIQUE)], OBLIQUE
        yield "mha", [files.write_mha(f / "a.mha", LPS)], LPS
        yield "mhd left", [files.write_mhd(f / "a.mhd", LEFT)], LEFT
        yield "nifti", [files.write_nifti(f / "a.nii", LPS)], LPS
        yield "nifti left", [files.write_nifti(f / "left.nii", along(-1, 2, 3))], along(-1, 2, 3)
        yield "dicom", [files.write_dicom(f / "series", STRAIGHT)], STRAIGHT
        yield "dicom left", [files.write_dicom(f / "prone", LEFT)], LEFT
        yield "tiff", [files.write_tiff(f / "a.tif", SPACING)], NOWHERE
        yield "raw", [files.write_raw(f / "a.raw"), "--raw", "12x10x8:uint8", "--spacing", "0.5,0.75,1.25", "--unit",
                      "mm"], NOWHERE
        moved = Place(NOWHERE.steps, (10, -20, 30.5))
        yield "ome-zarr", [files.write_ome_zarr(f / "a.zarr", list(SPACING), [10, -20, 30.5])], moved

    def assert_at(self, position, true, what, spacing=SPACING):
        away = max(abs(a - b) / s for a, b, s in zip(position, true, sorted(spacing)))
        self.assertLess(away, 1e-6, (what, position, true))

    def assert_mark(self, values, size, place, true, what, voxels=8, threshold=1):
        index, found = files.mark_in(values, size, threshold)
        self.assertEqual(found, voxels, what)
        self.assert_at(place.at(index), true, what)

    def assert_trace(self, trace, mesh, true, what):
        """One node in the mark, in every form; its position follows from the file's own words."""
        for path in trace:
            text = path.read_text()
            self.assertIn("positions are physical", text, what)
            turn = (-1, -1, 1) if re.search(r"frame(</?[^>]*>|\s|\"|>)*RAS", text) else (1, 1, 1)
            if path.suffix == ".swc":
                point = [float(a) for a in text.splitlines()[-1].split()[2:5]]
            elif path.suffix == ".txt":
                point = [float(a) for a in text.splitlines()[-1].split("-v ")[1].split(",")[:3]]
            elif path.suffix == ".graphml":
                point = [float(re.search(f'<data key="{axis}">([^<]+)', text)[1]) for axis in "xyz"]
            else:
                resolution = float(re.search("<resolution>([^<]+)", text)[1])
                point = [float(a) / resolution for a in re.search('point x="(.+)" y="(.+)" z="(.+)"', text).groups()]
            self.assert_at([a * t for a, t in zip(point, turn)], true, (what, path.suffix))
        for path in mesh:
            data = path.read_bytes()
            if path.suffix == ".obj":
                head = data
                points = [list(map(float, line.split()[1:])) for line in data.decode().splitlines() if line[:2] == "v "]
            else:
                head, body = data.split(b"end_header\n", 1)
                count = int(re.search(rb"element vertex (\d+)", head)[1])
                points = [struct.unpack_from("<3d", body, 24 * i) for i in range(count)]
            self.assertIn(b"positions are physical", head, what)
            turn = (-1, -1, 1) if b"SPACE=RAS" in head else (1, 1, 1)
            # The ball round the node is symmetric about it.
            middle = [(min(p[i] for p in points) + max(p[i] for p in points)) / 2 * turn[i] for i in range(3)]
            self.assert_at(middle, true, (what, path.suffix))

    def test_labels_of_every_file_lie_where_it_says(self):
        # Every day each reader meets one writer, in turn; the readers of NRRD, whose axes differ most, meet all.
        forms = ("nrrd", "tif", "zarr")
        for number, (name, arguments, place) in enumerate(self.inputs()):
            with self.subTest(name=name):
                true = place.at(files.MARK_INDEX)
                before = self.check_json("info", *arguments)
                for form in forms if IS_SLOW or name in ("nrrd left", "nrrd oblique") else [forms[number % 3]]:
                    path = self.folder / f"{name.replace(' ', '_')}_labels.{form}"
                    self.check("label", *arguments, "--threshold", 200, "-o", path, "--quiet")
                    if form == "nrrd":
                        self.assert_mark(*files.read_nrrd(path), true, (name, form))
                    elif form == "tif":
                        values, size, lines = files.read_tiff(path)
                        self.assert_mark(values, size, files.place_of_tiff(lines), true, (name, form))
                    # What we read of what we wrote.
                    info = self.check_json("info", path)
                    for key in ("size", "unit", "frame"):
                        self.assertEqual(info[key], before[key], (name, form, key))
                    # Oblique steps of an NRRD are products, rounded.
                    exact = (lambda numbers: numbers) if place is not OBLIQUE else \
                        (lambda numbers: [round(n, 12) for n in numbers])
                    for key in ("spacing", "origin"):
                        self.assertEqual(exact(info[key]), exact(before[key]), (name, form, key))
                    for direction, expected in zip(info["directions"], before["directions"]):
                        self.assertEqual(exact(direction), exact(expected), (name, form))

    def test_projects_and_their_exports_lie_on_the_file_they_were_made_of(self):
        # Every day each reader meets one preparation, in turn; axes that are read backwards or run aslant meet all.
        for number, (name, arguments, place) in enumerate(self.inputs()):
            is_whole = IS_SLOW or name in ("nrrd left", "nrrd oblique")
            for preparation in PREPARATIONS if is_whole else [list(PREPARATIONS)[number % len(PREPARATIONS)]]:
                with self.subTest(name=name, preparation=preparation):
                    self.check_project(name, arguments, place.at(files.MARK_INDEX), PREPARATIONS[preparation])

    def check_project(self, name, arguments, true, options):
        project = self.folder / "project"
        report = self.check_json("import", *arguments, project, *options, "--overwrite")
        size = report["size"]
        is_half = "--downscale" in options
        voxels = 1 if is_half else 8
        # The mark in the project's own order of voxels: readers may have turned an axis round.
        bare = self.folder / "bare.nrrd"
        self.check("label", project, "--threshold", 150, "-o", bare, "--quiet")
        values, _, place = files.read_nrrd(bare)
        self.assert_mark(values, size, place, true, name, voxels)
        index, _ = files.mark_in(values, size)
        whole, own = files.place_of_ome_zarr(project)
        self.assert_at(whole.at(index), true, name)
        # A mask of the mark, an offset in it and a node in its middle, as annotate would have saved them.
        (project / "shvr/paint.mask").write_bytes(bytes(files.GROUP * value for value in values))
        wide = report["type"] != "uint8"
        kind = "i" if wide else "h"
        (project / "shvr/paint.offset").write_bytes(struct.pack(f"<{len(values)}{kind}", *(5 * value for value in values)))
        node = ", ".join(repr((i + 0.5) * s) for i, s in zip(index, report["spacing"]))
        (project / "shvr/paint.txt").write_text(f"-v {node}, 1, 0.5\n")
        settings = ["--set", "annotation.mask=paint.mask", "--set", "annotation.trace=paint.txt", "--set",
                    "annotation.density=paint.offset", "--quiet"]
        out = {key: self.folder / key for key in ("m.nrrd", "m.tif", "m.zarr", "o.nrrd", "o.tif", "t.swc", "t.graphml",
                                                  "t.rsml", "t.txt", "b.obj", "b.ply")}
        for mask, offset, trace, mesh in (("m.nrrd", "o.nrrd", "t.swc", "b.obj"), ("m.tif", "o.tif", "t.graphml", "b.ply"),
                                          ("m.zarr", "o.nrrd", "t.rsml", "b.obj"), ("m.zarr", "o.nrrd", "t.txt", "b.ply")):
            self.check("export", project, *settings, "--mask", out[mask], "--offset", out[offset], "--trace", out[trace],
                       "--mesh", out[mesh])
        self.assert_mark(*files.read_nrrd(out["m.nrrd"]), true, name, voxels)
        self.assert_mark(*files.read_nrrd(out["o.nrrd"]), true, name, voxels)
        values_of_tiff, size_of_tiff, lines = files.read_tiff(out["m.tif"])
        self.assert_mark(values_of_tiff, size_of_tiff, files.place_of_tiff(lines), true, name, voxels)
        self.assertEqual(files.place_of_tiff(files.read_tiff(out["o.tif"])[2]).at(index),
                         files.place_of_tiff(lines).at(index))
        labels, labels_own = files.place_of_ome_zarr(out["m.zarr"])
        self.assert_at(labels.at(index), true, name)
        self.assertEqual((labels_own.steps, labels_own.origin), (own.steps, own.origin))
        self.assert_trace([out[key] for key in out if key[0] == "t"], [out["b.obj"], out["b.ply"]], true, name)
        for key in ("m.nrrd", "m.tif", "m.zarr"):
            self.assert_at(files.place_of_info(self.check_json("info", out[key])).at(index), true, (name, key))
        # All of it is read back by the project itself, and gives the same.
        again = ["--set", f"annotation.mask={out['m.nrrd']}", "--set", f"annotation.trace={out['t.graphml']}", "--set",
                 f"annotation.density={out['o.nrrd']}", "--quiet"]
        self.check("export", project, *again, "--mask", self.folder / "again.mask", "--trace", self.folder / "again.txt",
                   "--offset", self.folder / "again.offset", "--space", "volume")
        self.assertEqual((self.folder / "again.mask").read_bytes(), (project / "shvr/paint.mask").read_bytes())
        self.assertEqual((self.folder / "again.offset").read_bytes(), (project / "shvr/paint.offset").read_bytes())
        self.assertEqual((self.folder / "again.txt").read_text().splitlines()[-1],
                         f"-v {', '.join(str(float(n)).removesuffix('.0') for n in node.split(', '))}, 1, 0.5")

    def test_ome_zarr_alone_puts_a_part_on_its_whole_whatever_way_the_axes_run(self):
        """What a program sees that knows nothing of ours: scales and translations, of every level."""
        for place in (LPS, STRAIGHT, PERMUTED, OBLIQUE):
            source = files.write_nrrd(self.folder / "a.nrrd", place)
            own = {}
            for name, options in PREPARATIONS.items():
                self.check("import", source, self.folder / name, *options, "--overwrite", "--quiet")
                own[name] = files.place_of_ome_zarr(self.folder / name)[1]
            for name, middle in (("crop", (0.5, 4.5, 2.5)), ("half", (1, 3, 2)), ("crop and half", (0, 2, 1))):
                self.assert_at(own[name].at(middle), own["whole"].at(files.MARK_INDEX), name)
            report = self.check_json("info", self.folder / "whole")
            for level in range(1, report["levels"]):
                coarse = files.place_of_ome_zarr(self.folder / "whole", level)[1]
                covered = (2 ** level - 1) / 2
                self.assert_at(coarse.at((0, 0, 0)), own["whole"].at((covered,) * 3), level)

    def test_the_labels_of_a_project_hold_the_mark_where_python_zarr_reads_it(self):
        project = self.folder / "project"
        self.check("import", files.write_nrrd(self.folder / "a.nrrd", LPS), project, "--crop", "2,2,2,10,8,6", "--quiet")
        self.check("label", project, "--threshold", 150, "-o", project / "labels/mark", "--quiet")
        read_by_zarr(self, project / "labels/mark", self.folder / "bare")
        index, found = files.mark_in((self.folder / "bare").read_bytes(), (8, 6, 4))
        self.assertEqual(found, 8)
        labels, _ = files.place_of_ome_zarr(project / "labels/mark")
        self.assert_at(labels.at(index), LPS.at(files.MARK_INDEX), "labels")

    def test_a_translation_that_another_program_changed_is_believed(self):
        project = self.folder / "labels.zarr"
        self.check("label", files.write_nrrd(self.folder / "a.nrrd", LPS), "--threshold", 200, "-o", project, "--quiet")
        attributes = json.loads((project / ".zattrs").read_text())
        for dataset in attributes["multiscales"][0]["datasets"]:
            dataset["coordinateTransformations"][1]["translation"][2] += 4.0
        (project / ".zattrs").write_text(json.dumps(attributes))
        info = self.check_json("info", project)
        self.assertEqual(info["directions"], LPS.directions)
        self.assertEqual(info["origin"], [LPS.origin[0] - 4.0, *LPS.origin[1:]])
        attributes["shvr_placement"]["directions"][0] = [2, 0, 0]
        (project / ".zattrs").write_text(json.dumps(attributes))
        self.assertTrue(any("shvr_placement.directions" in w for w in self.check_json("info", project)["warnings"]))

    def test_masks_that_lie_elsewhere_are_refused_with_both_named(self):
        source = files.write_nrrd(self.folder / "a.nrrd", LPS)
        self.check("import", source, self.folder / "project", "--quiet")
        for name, place, says in (("turned", STRAIGHT, ["lies at -1 0 0", "expected nothing painted outside"]),
                                  ("moved", Place(LPS.steps, (0, 0, 0)), ["first voxel lies at", "expected"])):
            mask = files.write_nrrd(self.folder / f"{name}.nrrd", place)
            self.check_refused("export", self.folder / "project", "--set", f"annotation.mask={mask}", "--mask",
                               self.folder / "b.mask", says=[f"{name}.nrrd", *says])
        # The same place in words of another frame.
        mask = files.write_nrrd(self.folder / "ras.nrrd", LPS, "right-anterior-superior")
        self.check("export", self.folder / "project", "--set", f"annotation.mask={mask}", "--mask", self.folder / "b.mask")
        self.assertEqual((self.folder / "b.mask").read_bytes(), bytes(files.voxels()))


if __name__ == "__main__":
    unittest.main()
