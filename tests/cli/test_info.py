"""shvr info: what a file holds."""
import unittest

from harness import CliTest, Volume, run

KEYS = ["format", "size", "type", "spacing", "unit", "frame", "directions", "origin", "min", "max", "mean", "measured_level", "voxels", "levels", "warnings",
        "histogram", "window"]


class Info(CliTest):
    def test_every_number_of_a_small_volume(self):
        volume = Volume.noise((20, 17, 13), seed=1, high=1000, spacing=(0.5, 0.25, 2.0), voxel_type="uint16")
        header = volume.write(self.folder)
        info = self.check_json("info", header)
        self.assert_keys(info, KEYS)
        self.assertEqual(info["size"], [20, 17, 13])
        self.assertEqual(info["type"], "uint16")
        self.assertEqual(info["spacing"], [0.5, 0.25, 2.0])
        self.assertEqual(info["voxels"], 20 * 17 * 13)
        self.assertEqual(info["bytes"], 2 * 20 * 17 * 13)
        self.assertEqual(info["min"], min(volume.values))
        self.assertEqual(info["max"], max(volume.values))
        self.assertAlmostEqual(info["mean"], sum(volume.values) / len(volume.values), places=9)
        self.assertEqual(info["levels"], 1)
        self.assertEqual(len(info["histogram"]), 256)
        self.assertEqual(sum(info["histogram"]), info["voxels"])

    def test_byte_order_and_sign_do_not_matter(self):
        values = [i - 500 for i in range(5 * 4 * 3)]
        infos = []
        for endian in ("little", "big"):
            header = Volume((5, 4, 3), values, voxel_type="int16").write(self.folder, endian, endian)
            infos.append(self.check_json("info", header))
        for info in infos:
            self.assertEqual((info["type"], info["min"], info["max"]), ("int16", -500, -441))
        self.assertEqual(infos[0]["histogram"], infos[1]["histogram"])

    def test_where_the_volume_lies_is_stated(self):
        (self.folder / "a.nrrd").write_bytes(
            b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nspace: LPS\nspace directions: (0,0.5,0) (-2,0,0) "
            b"(0,0,3)\nspace origin: (1,2,3.5)\nencoding: raw\n\nab")
        info = self.check_json("info", self.folder / "a.nrrd")
        self.assertEqual((info["frame"], info["directions"], info["origin"], info["spacing"]),
                         ("LPS", [[0, 1, 0], [-1, 0, 0], [0, 0, 1]], [1, 2, 3.5], [0.5, 2, 3]))

    def test_numbered_slices_open_by_their_folder(self):
        slices = self.folder / "slices"
        slices.mkdir()
        for z in range(12):
            (slices / f"slice.{z + 1}").write_bytes(bytes([z] * 20))
        info = self.check_json("info", slices, "--raw", "5x4x12:uint8")
        self.assertEqual((info["size"], info["min"], info["max"]), ([5, 4, 12], 0, 11))

    def test_control_characters_of_a_name_reach_no_terminal(self):
        header = Volume((4, 4, 4), [1] * 64).write(self.folder)
        for name in ("red\x1b[31m.nhdr", "bell\x07.nhdr", "two\nlines.nhdr", "c1\u009b31m.nhdr"):
            with self.subTest(name=name):
                odd = header.rename(self.folder / name)
                result = run("info", odd)
                header = odd.rename(header)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertFalse([c for c in result.stdout + result.stderr
                                  if c != "\n" and (ord(c) < 32 or 127 <= ord(c) < 160)])
                line = result.stdout.splitlines()[0]
                self.assertTrue(line.startswith("name ") and line.endswith(".nhdr"), line)
        self.assertEqual(self.check_json("info", header)["name"], header.name)

    # Kind (Masks): a mask given as a scan
    def test_a_mask_or_offsets_given_as_a_scan_are_told(self):
        project = self.folder / "project"
        self.check("import", Volume((8, 8, 8), [100] * 512).write(self.folder), project)
        self.check("annotate", project, "--script", self.write_script("s.jsonl", [
            {"op": "paint", "brush": "fill", "region": "ball", "group": 3, "threshold": 0, "radius": 2,
             "path": [[4, 4, 4]]},
            {"op": "density", "brush": "fill", "threshold": 0, "offset": 5, "radius": 2, "path": [[4, 4, 4]]},
            {"op": "save"}]))
        files = [self.folder / name for name in ("mask.nrrd", "mask.zarr", "mask.tif", "offsets.nrrd", "offsets.tif")]
        self.check("export", project, "--mask", files[0])
        self.check("export", project, "--mask", files[1], "--offset", files[3])
        self.check("export", project, "--mask", files[2], "--offset", files[4])
        for path, says in zip(files, ("holds groups of a mask", "holds labels", "holds groups of a mask",
                                      "holds density offsets", "holds density offsets")):
            with self.subTest(file=path.name):
                self.assertTrue([line for line in self.check_json("info", path)["warnings"] if says in line])
                for command in (["render", path, "-o", self.folder / "a.png", "--size", "8x8"],
                                ["label", path, "--threshold", "1"], ["import", path, self.folder / f"{path.name}.project"]):
                    self.assertIn(says, self.check(*command).stderr)
        # As annotation they are read without a word.
        for path in (files[0], files[2]):
            self.assertEqual(self.check("evaluate", "--truth-mask", path, "--mask", path).stderr, "")
        # A scan that holds the same two values and comes in the same formats is none.
        for name in ("scan.nrrd", "scan.tif"):
            self.check("phantom", "sphere", "--size", "8", "-o", self.folder / "sphere")
            self.check("label", self.folder / "sphere" / "sphere.nhdr", "--threshold", "100", "-o", self.folder / name)
            self.assertFalse([line for line in self.check_json("info", self.folder / name)["warnings"] if "holds" in line])

    def test_a_project_of_labels_says_so_once(self):
        project = self.folder / "project"
        self.check("import", Volume((8, 8, 8), [100] * 512).write(self.folder), project)
        self.check("annotate", project, "--script", self.write_script("s.jsonl", [
            {"op": "paint", "brush": "fill", "group": 3, "threshold": 0, "radius": 2, "path": [[4, 4, 4]]},
            {"op": "save"}]))
        for name in ("mask.zarr", "mask.nrrd", "mask.tif"):
            with self.subTest(file=name):
                again = self.folder / f"{name}.project"
                self.check("export", project, "--mask", self.folder / name)
                self.check("import", self.folder / name, again, "--labels")
                warnings = self.check_json("info", again)["warnings"]
                self.assertEqual(len([line for line in warnings if "pictures blend neighbours" in line]), 1, warnings)

    def test_a_session_and_a_project_are_told_by_their_volume(self):
        header = Volume.noise((8, 8, 8), seed=2).write(self.folder)
        session = self.write_session(volume={"path": header.name})
        info = self.check_json("info", session)
        self.assertEqual(info["size"], [8, 8, 8])
        self.assertEqual(info["mask"], str(self.folder / "paint.mask"))

        project = self.folder / "project"
        (project / "shvr").mkdir(parents=True)
        header = Volume.noise((9, 8, 7), seed=2).write(project)
        session.rename(project / "shvr" / "session.json")
        (project / "shvr" / "session.json").write_text(
            '{"shvr_session": 1, "volume": {"path": "../volume.nhdr"}}')
        self.assertEqual(self.check_json("info", project)["size"], [9, 8, 7])

    def test_settings_describe_bare_voxels(self):
        (self.folder / "bare.raw").write_bytes(bytes(range(60)))
        info = self.check_json("info", self.folder / "bare.raw", "--set", "volume.raw=5x4x3:uint8")
        self.assertEqual((info["size"], info["min"], info["max"]), ([5, 4, 3], 0, 59))

    def test_not_finite_voxels_are_left_out_and_told(self):
        header = Volume((2, 2, 2), [1.0, 2.0, 3.0, float("nan"), float("inf"), 4.0, 5.0, 6.0],
                        voxel_type="float").write(self.folder)
        info = self.check_json("info", header)
        self.assertEqual((info["min"], info["max"], info["mean"]), (1.0, 6.0, 3.5))
        self.assertEqual(info["voxels_not_finite"], 2)
        self.assertTrue(any("NaN" in warning for warning in info["warnings"]))

    def test_an_outlier_is_told_and_leaves_the_window_to_the_others(self):
        values = [float(i % 100) for i in range(20 * 20 * 20)]
        values[77] = 1e30
        info = self.check_json("info", Volume((20, 20, 20), values, voxel_type="float").write(self.folder))
        self.assertGreater(info["max"], 9e29)
        self.assertEqual((info["window"]["lower"], round(info["window"]["upper"], 9)), (0.0, 99.0))
        self.assertTrue(any(warning.startswith("1 voxel lies far outside 0 to 99,") for warning in info["warnings"]))

    def test_settings_of_a_bare_volume_warn_of_nothing_else(self):
        header = Volume.noise((5, 4, 3), seed=1).write(self.folder)
        plain = self.check_json("info", header)
        for arguments in [("--channel", "1"), ("--set", "render.step_voxels=0.5")]:
            self.assertEqual(self.check_json("info", header, *arguments)["warnings"], plain["warnings"])

    def test_people_read_aligned_lines(self):
        header = Volume.noise((20, 17, 13), seed=1, spacing=(0.5, 0.5, 2.0)).write(self.folder)
        lines = self.check("info", header).stdout.splitlines()
        self.assertIn("size          20 x 17 x 13 voxels (4 420)", lines)
        self.assertTrue(all(len(line) > 14 and line[13] == " " and line[14] != " " for line in lines), lines)

    def test_it_needs_no_device(self):
        header = Volume.noise((4, 4, 4), seed=1).write(self.folder)
        result = run("info", header, environment={"VK_ICD_FILENAMES": "/nowhere", "VK_DRIVER_FILES": "/nowhere"})
        self.assertEqual(result.returncode, 0, result.stderr)


if __name__ == "__main__":
    unittest.main()
