"""--spacing and --unit: given for files that state none, corrected for files that do, in every command, and kept."""
import json
import struct
import unittest

import placed_files as files
from harness import CliTest, Volume
from placed_files import Place

PLACE = Place([[0.5, 0, 0], [0, 0.75, 0], [0, 0, 1.25]], (10, 20, 30))
GIVEN = ["--spacing", "2,3,4.5", "--unit", "um"]


class Spacing(CliTest):
    def bare_tiff(self):
        """Without spacing, as most microscopes' files."""
        path = files.write_tiff(self.folder / "bare.tif", (1, 1, 1))
        data = path.read_bytes()
        at = data.index(b"ImageJ=")
        path.write_bytes(data[:at] + b"ImageJ=1.53t\nimages=8\nslices=8\n\0".ljust(data.index(b"\0", at) - at + 1, b"\0") +
                         data[data.index(b"\0", at) + 1:])
        return path

    def info(self, *arguments):
        info = self.check_json("info", *arguments)
        warnings = [warning for warning in info["warnings"] if "transfer function" not in warning]
        return info["spacing"], info["unit"], info["spacing_from"], info["unit_from"], warnings

    def test_info_says_where_spacing_and_unit_come_from(self):
        tiff = self.bare_tiff()
        self.assertEqual(self.info(tiff), ([1, 1, 1], "voxel", "assumed", "assumed", ["no spacing stated; 1 voxel assumed"]))
        self.assertEqual(self.info(tiff, *GIVEN), ([2, 3, 4.5], "um", "given", "given", []))
        nrrd = files.write_nrrd(self.folder / "a.nrrd", PLACE)
        self.assertEqual(self.info(nrrd), ([0.5, 0.75, 1.25], "mm", "file", "file", []))
        both = "a spacing of 2 x 3 x 4.5 µm is given; the file says 0.5 x 0.75 x 1.25 mm"
        self.assertEqual(self.info(nrrd, *GIVEN), ([2, 3, 4.5], "um", "given", "given", [both]))
        self.assertEqual(self.info(nrrd, "--spacing", "2,3,4"),
                         ([2, 3, 4], "mm", "given", "file",
                          ["a spacing of 2 x 3 x 4 mm is given; the file says 0.5 x 0.75 x 1.25 mm"]))
        self.assertEqual(self.info(nrrd, "--unit", "micron"),
                         ([0.5, 0.75, 1.25], "um", "file", "given",
                          ["a spacing of 0.5 x 0.75 x 1.25 µm is given; the file says 0.5 x 0.75 x 1.25 mm"]))
        # The same in another unit is no correction.
        self.assertEqual(self.info(nrrd, "--spacing", "500,750,1250", "--unit", "um")[4], [])
        header = Volume((4, 4, 4), [0] * 64, spacing=(0.5, 0.5, 2)).write(self.folder)  # without a unit
        self.assertEqual(self.info(header)[2:4], ("file", "assumed"))
        self.assertEqual(self.info(header, "--unit", "um"), ([0.5, 0.5, 2], "um", "file", "given", [
            "a spacing of 0.5 x 0.5 x 2 µm is given; the file says 0.5 x 0.5 x 2 without a unit"]))
        self.assertIn("(given)", self.check("info", tiff, *GIVEN).stdout)
        self.assertIn("(assumed)", self.check("info", tiff).stdout)

    def test_an_origin_is_converted_with_the_unit_and_stays_otherwise(self):
        nrrd = files.write_nrrd(self.folder / "a.nrrd", PLACE)
        self.assertEqual(self.check_json("info", nrrd, *GIVEN)["origin"], [10000, 20000, 30000])
        self.assertEqual(self.check_json("info", nrrd, "--spacing", "1,1,1")["origin"], [10, 20, 30])
        self.assertEqual(self.check_json("info", nrrd, "--unit", "um")["origin"], [10, 20, 30])

    def test_bad_values_are_refused_in_a_sentence(self):
        tiff = self.bare_tiff()
        for command in (["info", tiff], ["render", tiff, "-o", self.folder / "a.png"], ["label", tiff, "--threshold", 1],
                        ["import", tiff, self.folder / "project"], ["export", tiff], ["profile", tiff, "--frames", 1],
                        ["annotate", tiff, "--script", tiff]):
            for text in ("0,1,1", "1,-1,1", "nan,1,1", "1,1,inf", "1,1", "1,1,1,1", "a,b,c", ",,", "", "1e-13,1,1"):
                with self.subTest(command=command[0], text=text):
                    self.check_refused(*command, f"--spacing={text}", "--unit", "um", status=2,
                                       says=["--spacing is", "0.8"] if text else ["--spacing is empty"])
            for text in (" ", "u\tm"):
                self.check_refused(*command, "--spacing", "1,1,1", f"--unit={text}", status=2, says=["--unit is", "as in um"])
        for command in (["info", tiff], ["label", tiff, "--threshold", 1], ["import", tiff, self.folder / "project"]):
            self.check_refused(*command, "--spacing", "1,1,1", says=["bare.tif", "states no unit", "--unit um"])
            self.check_refused(*command, "--unit", "um", says=["bare.tif", "states no spacing", "--spacing 0.8,0.8,1.2"])
        raw = files.write_raw(self.folder / "a.raw")
        for command in (["info", raw], ["import", raw, self.folder / "project"]):
            self.check_refused(*command, "--raw", "12x10x8:uint8", "--spacing", "1,1,1", status=2, says=["--unit um"])
        self.assertFalse((self.folder / "project").exists())

    def test_every_command_takes_them(self):
        tiff = self.bare_tiff()
        self.check("render", tiff, *GIVEN, "-o", self.folder / "a.png", "--size", "16x12")
        self.check("render", tiff, "-o", self.folder / "b.png", "--size", "16x12")
        self.assertNotEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())
        self.check("profile", tiff, *GIVEN, "--frames", 1, "--set", "render.size=[16,12]")
        self.check("label", tiff, *GIVEN, "--threshold", 200, "-o", self.folder / "labels.nrrd")
        self.assertEqual(self.info(self.folder / "labels.nrrd")[:2], ([2, 3, 4.5], "um"))
        report = self.check_json("import", tiff, self.folder / "project", *GIVEN)
        self.assertEqual((report["spacing"], report["unit"], report["spacing_from"]), ([2, 3, 4.5], "um", "given"))
        self.assertEqual(self.info(self.folder / "project"), ([2, 3, 4.5], "um", "given", "given", []))
        # A project's own spacing can be corrected, too; levels and statistics stay.
        corrected = self.check_json("info", self.folder / "project", "--spacing", "1,1,1")
        self.assertEqual((corrected["spacing"], corrected["levels"]), ([1, 1, 1], 1))
        session = self.write_session(volume={"path": "bare.tif"}, annotation={"mask": "paint.mask",
                                                                              "trace": "paint.graphml"})
        script = self.write_script("script.jsonl", [{"op": "node", "at": [2, 2, 2], "radius": 1},
                                                    {"op": "node", "at": [4, 2, 2], "radius": 1}, {"op": "save"}])
        self.check("annotate", session, *GIVEN, "--script", script)
        result = self.check_json("export", session, *GIVEN, "--mask", self.folder / "m.nrrd")
        self.assertEqual((result["unit"], result["length_um_by_group"]), ("um", {"1": 4}))
        self.assertEqual(self.info(self.folder / "m.nrrd")[:2], ([2, 3, 4.5], "um"))
        scores = self.check_json("evaluate", "--truth-mask", self.folder / "m.nrrd", "--mask", self.folder / "m.nrrd",
                                 "--volume", tiff, *GIVEN)
        self.assertEqual(scores["dice_by_group"] if "dice_by_group" in scores else {}, {})

    def test_a_session_keeps_them(self):
        self.bare_tiff()
        session = self.write_session(volume={"path": "bare.tif", "spacing": [2, 3, 4.5], "unit": "um"})
        self.assertEqual(self.info(session)[:4], ([2, 3, 4.5], "um", "given", "given"))
        for volume, says in (({"spacing": [1, 0, 1], "unit": "um"}, "volume.spacing.1 is 0"),
                             ({"spacing": [1, 1, 1]}, "states no unit"), ({"unit": "um"}, "states no spacing"),
                             ({"spacing": [1, 1, 1], "unit": "u\nm"}, "volume.unit")):
            session = self.write_session(volume={"path": "bare.tif", **volume})
            self.check_refused("info", session, says=[says])

    def test_given_files_keep_their_levels(self):
        self.check("import", Volume.noise((80, 70, 66), seed=1).write(self.folder), self.folder / "project", *GIVEN, "--quiet")
        plain = self.check_json("info", self.folder / "project")
        given = self.check_json("info", self.folder / "project", "--spacing", "9,9,9")
        self.assertEqual(plain["levels"], 3)
        for key in ("levels", "size", "min", "max", "mean", "histogram"):
            self.assertEqual(given[key], plain[key])


class SmallSlips(CliTest):
    """TIFFs with slips that other readers forgive, read with a warning."""

    VALUES = bytes(range(16, 144))

    def tiff(self, name, tags, tail=bytes(4), data=VALUES):
        at = 8 + len(data)
        end = at + 2 + 12 * len(tags) + len(tail)
        fields, extra = b"", b""
        for tag, kind, values in sorted(tags):
            packed = struct.pack(f"<{len(values)}{'?BBHI'[kind]}", *values)
            if len(packed) > 4:
                packed, extra = struct.pack("<I", end + len(extra)), extra + packed
            fields += struct.pack("<HHI", tag, kind, len(values)) + packed.ljust(4, b"\0")
        path = self.folder / name
        path.write_bytes(b"II*\0" + struct.pack("<I", at) + data + struct.pack("<H", len(tags)) + fields + tail + extra)
        return path

    def tags(self, **changed):
        tags = {"256": (3, [16]), "257": (3, [8]), "258": (3, [8]), "259": (3, [1]), "262": (3, [1]), "273": (4, [8]),
                "278": (3, [8]), "279": (4, [128])}
        tags.update({key[1:]: value for key, value in changed.items()})
        return [(int(tag), *value) for tag, value in tags.items()]

    def voxels_of(self, path, *arguments):
        """Behind their own export, and what info warns of."""
        self.check("import", path, self.folder / "project", *arguments, "--overwrite", "--quiet")
        info = self.check_json("info", path, *arguments)
        return info, self.check_json("info", self.folder / "project")["mean"]

    def check_values(self, path, expected, says, *arguments):
        info, mean = self.voxels_of(path, *arguments)
        self.assertEqual((info["min"], info["max"]), (min(expected), max(expected)))
        self.assertAlmostEqual(mean, sum(expected) / len(expected), places=9)
        self.assertTrue(not says or any(says in warning for warning in info["warnings"]), info["warnings"])
        return info

    def test_a_directory_without_its_last_four_bytes(self):
        self.check_values(self.tiff("a.tif", self.tags(), tail=b""), self.VALUES, "was cut before the offset of a next one")
        # More than that is missing here.
        path = self.tiff("b.tif", self.tags(), tail=b"")
        path.write_bytes(path.read_bytes()[:-1])
        self.check_refused("info", path, says=["it is truncated"])

    def test_more_bytes_of_strips_than_pixels(self):
        old = {"_258": (3, [1]), "_256": (3, [128])}  # 1 bit a pixel
        bits = [byte >> bit & 1 for byte in self.VALUES for bit in range(7, -1, -1)]
        says = "states more bytes in StripByteCounts than the file holds"
        self.check_values(self.tiff("a.tif", self.tags(**old, _279=(4, [4000]))), bits, says)
        # Strips whose counts reach into the next.
        self.check_values(self.tiff("b.tif", self.tags(**old, _278=(3, [4]), _273=(4, [8, 72]), _279=(4, [70, 64]))), bits, "")
        # Pixels that are not there are refused still.
        self.check_refused("info", self.tiff("c.tif", self.tags(_257=(3, [80]), _278=(3, [80]), _279=(4, [4000]))),
                           says=["c.tif", "1280 bytes"])

    def test_a_grey_palette_is_grey(self):
        ramp = [257 * i for i in range(256)]
        says = "its palette is grey: the palette's greys are taken"
        palette = {"_262": (3, [3])}
        for name, grey in (("inverted", [65535 - g for g in ramp]), ("part", ramp[:200] + [0] * 56),
                           ("gamma", [257 * round(255 * (i / 255) ** 2.2) for i in range(256)])):
            path = self.tiff(f"{name}.tif", self.tags(**palette, _320=(3, grey * 3)))
            expected = [grey[value] // 257 for value in self.VALUES]
            self.check_values(path, expected, says)
            self.check_values(path, self.VALUES, "", "--channel", "index")
            self.check_values(path, expected, "", "--channel", "grey")
        self.check_values(self.tiff("ramp.tif", self.tags(**palette, _320=(3, ramp * 3))), self.VALUES, "")
        # Bytes where 16 bits belong.
        info = self.check_values(self.tiff("bytes.tif", self.tags(**palette, _320=(3, list(range(256)) * 3))), self.VALUES, "")
        self.assertEqual([w for w in info["warnings"] if "palette" in w], [])
        coloured = self.tiff("coloured.tif", self.tags(**palette, _320=(3, ramp * 2 + ramp[::-1])))
        self.check_refused("info", coloured, says=["--channel index, red, green or blue"])


class Reverse(CliTest):
    def test_one_rule_for_all_types_and_parts(self):
        values = [7 + (i * 37) % 90 for i in range(6 * 5 * 4)]
        total = min(values) + max(values)
        for voxel_type in ("uint8", "int8", "uint16", "int16", "float"):
            header = Volume((6, 5, 4), values, voxel_type=voxel_type).write(self.folder)
            for options, kept in (([], values), (["--crop", "0,0,0,6,5,1"], values[:30])):
                self.check("import", header, self.folder / "project", "--reverse", *options, "--overwrite", "--quiet")
                info = self.check_json("info", self.folder / "project")
                self.assertEqual((info["min"], info["max"]), (total - max(kept), total - min(kept)), voxel_type)
                self.assertAlmostEqual(info["mean"], total - sum(kept) / len(kept), places=5)

    def test_help_says_the_rule_and_the_border(self):
        words = " ".join(self.check("import", "--help").stdout.split())
        self.assertIn("smallest plus largest value, minus the voxel", words)
        self.assertIn("the outermost voxels are repeated beyond the border", words)


if __name__ == "__main__":
    unittest.main()
