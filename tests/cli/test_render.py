"""shvr render: pictures."""
import json
import unittest

from harness import CliTest, Volume, read_png_header

KEYS = ["size", "complete", "passes", "counters", "bytes", "warnings"]


class Render(CliTest):
    def render(self, session, name, *arguments):
        picture = self.folder / name
        result = self.check_json("render", session, "-o", picture, *arguments)
        return picture, result

    def test_keys(self):
        picture, result = self.render(self.write_session(), "a.png")
        self.assert_keys(result, KEYS)
        self.assertEqual(result["size"], [24, 16])
        self.assertEqual(read_png_header(picture), (24, 16))
        self.assertIs(result["complete"], True)
        self.assert_keys(result["counters"], ["rays", "samples", "bricks_visited", "bricks_skipped"])
        self.assertGreater(result["counters"]["samples"], 0)
        self.assert_keys(result["bytes"], ["device", "host", "by_resource"])
        self.assertIn("raycast", [one["name"] for one in result["passes"]])
        for one in result["passes"]:
            self.assertGreaterEqual(one["gpu_ms"], 0)

    def test_the_same_session_gives_the_same_bytes(self):
        session = self.write_session()
        first, _ = self.render(session, "a.png")
        second, _ = self.render(session, "b.png")
        self.assertEqual(first.read_bytes(), second.read_bytes())

    def test_counting_work_does_not_change_the_picture(self):
        session = self.write_session()
        counted, _ = self.render(session, "a.png")
        self.check("render", session, "-o", self.folder / "b.png")
        self.assertEqual(counted.read_bytes(), (self.folder / "b.png").read_bytes())

    def test_settings_are_keys_of_the_session(self):
        session = self.write_session()
        coarse, coarse_result = self.render(session, "a.png")
        fine, fine_result = self.render(session, "b.png", "--set", "render.step_voxels=0.125",
                                        "--set", "render.size=[30,20]")
        self.assertEqual(read_png_header(fine), (30, 20))
        self.assertGreater(fine_result["counters"]["samples"], 2 * coarse_result["counters"]["samples"])
        document = json.loads(session.read_text())
        document["render"] = {"size": [30, 20], "step_voxels": 0.125}
        written, _ = self.render(self.write_json("other.json", document), "c.png")
        self.assertEqual(fine.read_bytes(), written.read_bytes())

    def test_size_is_a_shorthand(self):
        session = self.write_session()
        short, _ = self.render(session, "a.png", "--size", "31x17")
        long, _ = self.render(session, "b.png", "--set", "render.size=[31,17]")
        self.assertEqual(read_png_header(short), (31, 17))
        self.assertEqual(short.read_bytes(), long.read_bytes())

    def test_cameras_by_name_by_side_and_as_json(self):
        header = Volume.noise((24, 16, 8), seed=1).write(self.folder)
        eye = {"projection": "orthographic", "eye": [12, -60, 4], "target": [12, 8, 4], "up": [0, 0, 1], "height": 30}
        session = self.write_session(volume={"path": header.name}, cameras={"mine": eye}, camera="mine")
        pictures = {name: self.render(session, f"{i}.png", "--camera", name)[0].read_bytes()
                    for i, name in enumerate(["mine", "front", "top", json.dumps(eye)])}
        self.assertEqual(pictures["mine"], pictures[json.dumps(eye)])
        self.assertEqual(len(set(pictures.values())), 3)
        # Without --camera it is the session's own.
        self.assertEqual(self.render(session, "own.png")[0].read_bytes(), pictures["mine"])

    def test_a_transfer_function_from_a_file(self):
        points = {"points": [{"intensity": 100, "color": "#ff0000", "opacity": 1.0},
                             {"intensity": 255, "color": "#ff0000", "opacity": 1.0}]}
        session = self.write_session()
        plain, _ = self.render(session, "a.png")
        red, _ = self.render(session, "b.png", "--tf", self.write_json("red.json", points))
        same, _ = self.render(self.write_session("red_session.json", transfer_function=points), "c.png")
        self.assertNotEqual(plain.read_bytes(), red.read_bytes())
        self.assertEqual(red.read_bytes(), same.read_bytes())

    def test_a_bare_volume_is_drawn_and_its_automatic_look_told(self):
        header = Volume.noise((20, 17, 13), seed=3).write(self.folder)
        _, result = self.render(header, "a.png", "--size", "16x16")
        self.assertTrue(any("transfer function" in warning for warning in result["warnings"]), result["warnings"])

    def test_leaping_over_empty_space_does_not_change_the_picture(self):
        session = self.write_session(volume={"procedural": "speckles", "size": [70, 40, 36]})
        leaping, with_leaps = self.render(session, "a.png")
        plain, without = self.render(session, "b.png", "--set", "render.skip_empty_space=false")
        self.assertEqual(leaping.read_bytes(), plain.read_bytes())
        self.assertLess(with_leaps["counters"]["samples"], without["counters"]["samples"])

    def test_a_picture_is_written_whole_or_not_at_all(self):
        session = self.write_session()
        self.check_refused("render", session, "-o", self.folder / "none" / "a.png", says=["a.png"])
        self.assertEqual([path.name for path in self.folder.iterdir()], ["session.json"])

    def test_an_incomplete_picture_is_refused_unless_it_is_allowed(self):
        voxels = bytes((x * y * z) % 251 for z in range(40) for y in range(40) for x in range(40))
        (self.folder / "a.raw").write_bytes(voxels)
        project = self.folder / "a.zarr"
        self.check("import", self.folder / "a.raw", project, "--raw", "40x40x40:uint8")
        picture = self.folder / "a.png"
        render = ["render", project, "-o", picture, "--size", "64x48", "--set", "render.detail=0"]
        self.assertIs(self.check_json(*render)["complete"], True)
        picture.unlink()
        chunks = [path for path in (project / "0").rglob("*") if path.is_file() and not path.name.startswith(".")]
        self.assertTrue(chunks)
        for chunk in chunks:
            chunk.write_bytes(b"no chunk")
        self.check_refused(*render, says=["a.zarr", "incomplete", "--allow-incomplete"])
        self.assertFalse(picture.exists())
        self.assertIs(self.check_json(*render, "--allow-incomplete")["complete"], False)
        self.assertTrue(picture.exists())

    def test_rays_that_stop_short_make_the_picture_incomplete(self):
        session = self.write_session(volume={"procedural": "constant", "size": [4096, 1, 1]}, transfer_function={
            "points": [{"intensity": 0, "color": "#ffffff", "opacity": 1e-5},
                       {"intensity": 255, "color": "#ffffff", "opacity": 1e-5}]})
        picture = self.folder / "a.png"
        render = ["render", session, "-o", picture, "--size", "1x1", "--camera", "left", "--set", "render.step_voxels=0.0001"]
        self.check_refused(*render, says=["incomplete", "1 rays stop before their end", "render.step_voxels"])
        self.assertFalse(picture.exists())
        result = self.check_json(*render, "--allow-incomplete")
        self.assertIs(result["complete"], False)
        self.assertEqual(result["counters"]["rays_cut_short"], 1)

    def test_the_level_that_a_picture_shows_is_told(self):
        session = self.write_session(volume={"procedural": "sphere", "size": [2200, 2200, 2200]})
        picture = self.folder / "a.png"
        coarse = self.check_json("render", session, "-o", picture, "--set", "render.step_voxels=0.5")["detail"]
        self.assertEqual(coarse["setting"], 1)
        self.assertGreater(coarse["finest_level"], 4)
        self.assertEqual(coarse["voxels_per_side"], 2 ** coarse["finest_level"])
        self.assertEqual(coarse["step_voxels"], 0.5 * coarse["voxels_per_side"])
        session = self.write_session(volume={"procedural": "sphere", "size": [24, 24, 24]})
        fine = self.check_json("render", session, "-o", picture)["detail"]
        self.assertEqual((fine["finest_level"], fine["voxels_per_side"]), (0, 1))

    def test_a_budget_that_is_too_small_names_what_did_not_fit(self):
        session = self.write_session(volume={"procedural": "sphere", "size": [128, 128, 128]})
        self.check_refused("render", session, "-o", self.folder / "a.png", "--budget-device", "1", says=["device memory", "bricks"])


if __name__ == "__main__":
    unittest.main()
