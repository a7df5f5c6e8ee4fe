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
