"""Volumes of which some cannot be read: no result is made of the rest unless that is allowed, and then it is said."""
import json
import struct
import unittest
import zlib
from collections import Counter

from harness import CliTest, Volume, run

SIZE, CHUNK = (40, 36, 24), 16
LOST = (1, 0, 1)  # x, y, z of the chunk that is cut short


def voxels_of(chunk):
    return [(x, y, z) for z in range(SIZE[2]) for y in range(SIZE[1]) for x in range(SIZE[0])
            if (x // CHUNK, y // CHUNK, z // CHUNK) == chunk]


def write_aborted_ome_tiff(path, size, slices):
    """An OME-TIFF of 8 bits that describes `size` voxels, but ends after `slices`: a page each."""
    xml = (f'<?xml version="1.0"?><OME><Image><Pixels DimensionOrder="XYZCT" Type="uint8" SizeX="{size[0]}" '
           f'SizeY="{size[1]}" SizeZ="{size[2]}" SizeC="1" SizeT="1" PhysicalSizeX="2" PhysicalSizeY="2" '
           'PhysicalSizeZ="3"><TiffData/></Pixels></Image></OME>').encode() + b"\0"
    content, link = bytearray(b"II*\0" + bytes(4) + xml + bytes(len(xml) % 2)), 4
    for voxels in slices:
        at = len(content)
        content += voxels + bytes(len(voxels) % 2)
        tags = [(256, 4, 1, size[0]), (257, 4, 1, size[1]), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 1)]
        tags += [(270, 2, len(xml), 8)] if link == 4 else []
        tags += [(273, 4, 1, at), (277, 3, 1, 1), (278, 4, 1, size[1]), (279, 4, 1, len(voxels))]
        struct.pack_into("<I", content, link, len(content))
        content += struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", *tag) for tag in tags)
        link = len(content)
        content += bytes(4)
    path.write_bytes(content)
    return path


class AbortedTiff(CliTest):
    SIZE, THERE = (20, 16, 12), 7
    REASON = "lacks the page of slice 8, which its OME-XML names; expected a complete file"
    LOST = 20 * 16 * 5

    def setUp(self):
        super().setUp()
        width, height, _ = self.SIZE
        self.slices = [bytes(40 + (3 * x + 5 * y + 7 * z) % 160 for y in range(height) for x in range(width))
                       for z in range(self.THERE)]
        self.scan = write_aborted_ome_tiff(self.folder / "a.ome.tif", self.SIZE, self.slices)

    def check_said(self, arguments, allowed=("--allow-incomplete",)):
        """Refused with the reason and the option, and done with it; returns what is printed."""
        self.check_refused(*arguments, says=[self.REASON, "--allow-incomplete"])
        result = self.check(*arguments, *allowed, "--json")
        self.assertIn(f"{self.LOST} voxels cannot be read", result.stderr)
        report = json.loads(result.stdout)
        self.assertEqual((report["complete"], report["voxels_not_read"]), (False, self.LOST))
        return report

    # Kind (TIFF): an aborted OME-TIFF, from description to annotation
    def test_what_is_there_is_described_drawn_imported_and_annotated(self):
        info = self.check_said(["info", self.scan])
        self.assertEqual((info["min"], info["max"]), (min(min(s) for s in self.slices), max(max(s) for s in self.slices)))
        self.check_said(["render", self.scan, "-o", self.folder / "a.png", "--size", "24x20"])
        project = self.folder / "project"
        imported = self.check_said(["import", self.scan, project])
        self.assertTrue(any("have the lowest value" in warning for warning in imported["warnings"]))
        # The project is readable, and remembers what it lacks.
        info = self.check_json("info", project, "--exact")
        self.assertIs(info["complete"], True)
        self.assertTrue(any(f"{self.LOST} voxels cannot be read" in warning for warning in info["warnings"]))
        self.assertEqual(info["size"], list(self.SIZE))
        script = self.write_script("s.jsonl", [
            {"op": "paint", "brush": "fill", "region": "box", "group": 2, "threshold": 1, "radius": 8,
             "path": [[8.5, 8.5, 6.5]]}, {"op": "save"}])
        session = self.write_session(volume={"path": self.scan.name})
        self.check_refused("annotate", session, "--script", script,
                           says=[self.REASON, "shvr import --allow-incomplete makes a project of what can be read"])
        painted = self.check_json("annotate", project, "--script", script)
        # The box has 17 x 16 x 11 voxels, since slices are half as far apart again; the rest of it cannot be read.
        self.assertEqual(painted["voxels_changed"], 17 * 16 * (self.THERE - 1))

    def test_an_import_of_a_part_is_never_taken_for_one_of_all(self):
        project, part = self.folder / "p", self.folder / "p.part"
        self.check_refused("import", self.scan, project, says=["what is done is kept"])
        self.assertTrue(part.exists())
        self.assertIs(self.check_json("import", self.scan, project, "--allow-incomplete")["resumed"], False)
        self.assertFalse(part.exists())
        # The readable part alone is a whole volume.
        crop = self.check_json("import", self.scan, self.folder / "c", "--crop", f"0,0,0,20,16,{self.THERE}",
                               "--allow-incomplete")
        self.assertEqual((crop["complete"], crop["voxels_not_read"]), (True, 0))
        self.check_refused("import", self.scan, self.folder / "d", "--allow-incomplete", "--blur", "1", status=2,
                           says=["--allow-incomplete is given with --blur; expected no preparation but --crop"])
        self.assertFalse((self.folder / "d").exists())


class Incomplete(CliTest):
    def write_zarr(self, name, volume):
        """As another program writes it: zlib chunks, no statistics of ours."""
        image = self.folder / name
        array = image / "0"
        array.mkdir(parents=True)
        (image / ".zgroup").write_text('{"zarr_format": 2}')
        (image / ".zattrs").write_text(json.dumps({"multiscales": [{
            "version": "0.4", "axes": [{"name": axis, "type": "space", "unit": "micrometer"} for axis in "zyx"],
            "datasets": [{"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [1.0] * 3}]}]}]}))
        (array / ".zarray").write_text(json.dumps({
            "zarr_format": 2, "shape": SIZE[::-1], "chunks": [CHUNK] * 3, "fill_value": 0, "order": "C",
            "dtype": {"uint8": "|u1", "int16": "<i2", "float": "<f4"}[volume.type], "filters": None,
            "compressor": {"id": "zlib", "level": 1}, "dimension_separator": "."}))
        for z, y, x in [(z, y, x) for z in range(2) for y in range(3) for x in range(3)]:
            values = []
            for k in range(CHUNK ** 3):
                place = [CHUNK * x + k % CHUNK, CHUNK * y + k // CHUNK % CHUNK, CHUNK * z + k // CHUNK ** 2]
                inside = all(place[i] < SIZE[i] for i in range(3))
                values.append(volume.values[volume.index(place)] if inside else 0)
            packed = zlib.compress(struct.pack(f"<{len(values)}{Volume.TYPES[volume.type]}", *values))
            (array / f"{z}.{y}.{x}").write_bytes(packed[:-20] if (x, y, z) == LOST else packed)
        return image

    def setUp(self):
        super().setUp()
        self.volume = Volume.noise(SIZE, seed=5, high=255)
        self.image = self.write_zarr("a.zarr", self.volume)
        self.lost = len(voxels_of(LOST))

    def kept(self, volume):
        lost = {volume.index(voxel) for voxel in voxels_of(LOST)}
        return [value for index, value in enumerate(volume.values) if index not in lost]

    def check_refused_without_the_option(self, *arguments):
        self.check_refused(*arguments, says=["0/1.0.1", "--allow-incomplete"])

    def check_allowed(self, *arguments):
        result = self.check(*arguments, "--allow-incomplete", "--json")
        report = json.loads(result.stdout)
        said = f"{self.lost} voxels cannot be read ("
        self.assertIn(said, result.stderr)
        self.assertTrue(any(said in warning for warning in report["warnings"]), report["warnings"])
        self.assertEqual((report["complete"], report["voxels_not_read"]), (False, self.lost))
        return report

    def test_info_leaves_them_out_of_every_number(self):
        for kind, high in (("uint8", 255), ("int16", 3000), ("float", 9)):
            with self.subTest(kind=kind):
                volume = Volume.noise(SIZE, seed=6, high=high, voxel_type=kind)
                image = self.write_zarr(f"{kind}.zarr", volume)
                self.check_refused_without_the_option("info", image)
                info = self.check_allowed("info", image)
                kept = self.kept(volume)
                self.assertEqual((info["min"], info["max"]), (min(kept), max(kept)))
                self.assertAlmostEqual(info["mean"], sum(kept) / len(kept), places=9)
                self.assertEqual(sum(info["histogram"]), len(kept))
                self.assertEqual(info["voxels_not_finite"], 0)
        self.assertIs(self.check_json("info", self.volume.write(self.folder))["complete"], True)

    def test_label_takes_them_for_dark(self):
        self.check_refused_without_the_option("label", self.image, "--threshold", "200")
        output = self.folder / "labels.nrrd"
        label = self.check_allowed("label", self.image, "--threshold", "200", "-o", output)
        self.assertEqual(label["foreground_voxels"], sum(value >= 200 for value in self.kept(self.volume)))
        # The same result as for a volume that is dark there.
        values = list(self.volume.values)
        for voxel in voxels_of(LOST):
            values[self.volume.index(voxel)] = 0
        dark = Volume(SIZE, values).write(self.folder, "dark")
        expected = self.check_json("label", dark, "--threshold", "200", "-o", self.folder / "dark-labels.nrrd")
        self.assertEqual(label["components"], expected["components"])
        bytes_of = [(self.folder / name).read_bytes().split(b"\n\n", 1)[1] for name in ("labels.nrrd", "dark-labels.nrrd")]
        self.assertEqual(*bytes_of)

    def test_evaluate_takes_them_for_unpainted(self):
        truth = Volume(SIZE, [value % 3 for value in self.volume.values])
        mask = self.write_zarr("mask.zarr", truth)
        nrrd = truth.write(self.folder, "truth")
        evaluate = ["evaluate", "--truth-mask", mask, "--mask", mask]
        self.check_refused_without_the_option(*evaluate)
        result = self.check("evaluate", "--truth-mask", mask, "--mask", mask, "--allow-incomplete", "--json")
        report = json.loads(result.stdout)
        self.assertEqual((report["complete"], report["voxels_not_read"]), (False, 2 * self.lost))
        counts = Counter(self.kept(truth))
        self.assertEqual(report["voxels_by_group"]["truth"], {"1": counts[1], "2": counts[2]})
        self.assertEqual(report["dice"], 1)
        self.assertIs(self.check_json("evaluate", "--truth-mask", nrrd, "--mask", nrrd)["complete"], True)

    def test_no_picture_and_no_profile_is_made_in_silence(self):
        picture = self.folder / "a.png"
        self.check_refused_without_the_option("render", self.image, "-o", picture, "--size", "32x24")
        self.assertFalse(picture.exists())
        self.check_refused_without_the_option("profile", self.image, "--frames", "1")

    def test_pictures_and_profiles_show_the_rest_where_that_is_allowed(self):
        # The result for a volume with the lowest value of its type there.
        values = list(self.volume.values)
        for voxel in voxels_of(LOST):
            values[self.volume.index(voxel)] = 0
        dark = Volume(SIZE, values).write(self.folder, "dark")
        curve = self.folder / "curve.json"  # not one chosen by the statistics, which differ
        curve.write_text(json.dumps({"points": [{"intensity": 0, "opacity": 0}, {"intensity": 255, "opacity": 0.4}]}))
        for paging in ("automatic", "always"):
            settings = ["--size", "40x32", "--tf", curve, "--set", f"render.paging={paging}"]
            pictures = [self.folder / f"{paging}-{name}.png" for name in ("gap", "dark")]
            report = self.check_allowed("render", self.image, "-o", pictures[0], *settings)
            self.assertEqual(report["bricks"] is None, paging == "automatic")
            expected = self.check_json("render", dark, "-o", pictures[1], *settings)
            self.assertEqual((expected["complete"], expected["voxels_not_read"]), (True, 0))
            self.assertEqual(pictures[0].read_bytes(), pictures[1].read_bytes())
        self.check_allowed("profile", self.image, "--frames", "1", "--warmup", "0", "--size", "40x32")

    def test_annotation_is_exported_whatever_has_become_of_the_scan(self):
        header = self.volume.write(self.folder)
        session = self.write_session(volume={"path": header.name})
        script = self.write_script("s.jsonl", [
            {"op": "paint", "brush": "fill", "region": "box", "group": 3, "threshold": 0, "radius": 2.2,
             "path": [[8.5, 8.5, 8.5]]}, {"op": "save"}])
        self.check("annotate", session, "--script", script)
        document = json.loads(session.read_text())
        document["volume"] = {"path": "a.zarr"}
        session.write_text(json.dumps(document))
        result = run("export", session, "--mask", self.folder / "m.nrrd", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("cannot be read", result.stderr)
        self.assertEqual(json.loads(result.stdout)["voxels_by_group"], {"3": 125})


if __name__ == "__main__":
    unittest.main()
