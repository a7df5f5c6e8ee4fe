"""shvr render: pictures."""
import json
import os
import signal
import subprocess
import time
import unittest
from pathlib import Path

from harness import ENVIRONMENT, IS_SLOW, SHVR, CliTest, Volume, read_png_header, run

STOP_IN_SAVE = Path(SHVR).resolve().parent / "stubs" / "libstop_in_save.so"
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

    def test_a_picture_with_its_session_is_made_again_bit_for_bit(self):
        session = self.write_session()
        plain, _ = self.render(session, "plain.png", "--size", "41x29", "--camera", "left", "--set", "light.ambient=0.3",
                               "--set", "probe.shown=true")
        kept, _ = self.render(session, "kept.png", "--size", "41x29", "--camera", "left", "--set", "light.ambient=0.3",
                              "--set", "probe.shown=true", "--with-session")
        self.assertGreater(len(kept.read_bytes()), len(plain.read_bytes()))
        again, _ = self.render(kept, "again.png")
        self.assertEqual(again.read_bytes(), plain.read_bytes())
        once_more, _ = self.render(kept, "once-more.png", "--with-session")
        self.assertEqual(once_more.read_bytes(), kept.read_bytes())
        # It goes along with its volume.
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir()
        for path in self.folder.iterdir():
            if path.is_file():
                (elsewhere / path.name).write_bytes(path.read_bytes())
        moved, _ = self.render(elsewhere / "kept.png", "moved.png")
        self.assertEqual(moved.read_bytes(), plain.read_bytes())

    def test_pictures_without_a_session_or_a_volume_are_refused(self):
        session = self.write_session()
        plain, _ = self.render(session, "plain.png")
        self.check_refused("render", plain, "-o", self.folder / "again.png",
                           says=["plain.png: is a picture without a session in it", "made with --with-session"])
        plain, _ = self.render(session, "plain.tif")
        self.check_refused("render", plain, "-o", self.folder / "again.png",
                           says=["plain.tif: has 3 channels", "rendered again if it was made with --with-session"])
        (self.folder / "scan.raw").write_bytes(bytes(range(64)))
        scan = self.write_session("scan.json", volume={"path": "scan.raw", "raw": "4x4x4:uint8:little:0"})
        kept, _ = self.render(scan, "kept.png", "--with-session")
        self.render(kept, "again.png")
        alone = self.folder / "alone"
        alone.mkdir()
        (alone / "kept.png").write_bytes(kept.read_bytes())
        self.check_refused("render", alone / "kept.png", "-o", self.folder / "again.png",
                           says=["kept.png: is a picture of", "scan.raw, which is not there"])

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

    def test_a_setting_that_was_removed_is_ignored_with_a_warning(self):
        session = self.write_session()
        plain, _ = self.render(session, "plain.png")
        with_it, result = self.render(session, "with.png", "--set", "render.adaptive_tolerance=0.2")
        self.assertEqual(with_it.read_bytes(), plain.read_bytes())
        said = ": render.adaptive_tolerance is ignored, as the option was removed"
        self.assertEqual([one for one in result["warnings"] if "adaptive" in one][0].split(" and ")[0], "--set" + said)
        old = json.loads(session.read_text())
        old.setdefault("render", {})["adaptive_tolerance"] = 0.2
        session.write_text(json.dumps(old))
        of_file = self.check("render", session, "-o", self.folder / "old.png")
        self.assertIn(f"warning: {session}{said}", of_file.stderr)
        self.assertEqual((self.folder / "old.png").read_bytes(), plain.read_bytes())

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
        self.check_refused(*render, says=["incomplete", "1 ray stops before its end", "render.step_voxels"])
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
        said = self.check_refused("render", session, "-o", self.folder / "a.png", "--budget-device", "1",
                                  says=["device memory", "picture", "--budget-device"])
        enough = said.split("--budget-device ")[1].split()[0]
        self.render(session, "a.png", "--budget-device", enough)

    def test_every_budget_draws_the_same_bytes(self):
        session = self.write_session(volume={"procedural": "tubes", "size": [128, 128, 128], "seed": 3})
        large, _ = self.render(session, "large.png", "--budget-device", "1024", "--size", "1024x1024")
        for mib in [16, 24, 64] if IS_SLOW else [16]:
            small, result = self.render(session, f"{mib}.png", "--budget-device", mib, "--size", "1024x1024")
            self.assertIs(result["complete"], True)
            self.assertLessEqual(result["bytes"]["peak_device"], mib << 20)
            self.assertEqual(small.read_bytes(), large.read_bytes(), mib)

    def test_sizes_are_whole_numbers_up_to_65536(self):
        session = self.write_session()
        for size in ["65537x1", "1x65537", "0x5", "5", "5x", "x5", "5x5x5", "4294967297x1", "-1x5", "5x5 ", "1e3x5"]:
            self.check_refused("render", session, "-o", self.folder / "a.png", f"--size={size}", status=2,
                               says=["--size", size, "65536"])
        self.render(session, "wide.png", "--size", "65536x1")
        self.assertEqual(read_png_header(self.folder / "wide.png"), (65536, 1))

    def peak_of(self, *arguments):
        """The object of --json, and the largest resident set in bytes."""
        with subprocess.Popen([SHVR, "render", *map(str, arguments), "--json"], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, env=ENVIRONMENT) as process:
            out, err = process.stdout.read(), process.stderr.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0, err)
        return json.loads(out), 1024 * usage.ru_maxrss

    def test_a_large_picture_takes_the_memory_of_a_band_of_rows_and_is_accounted(self):
        # Nearly empty, so that only its pixels take time; whole it would take 256 MiB of light and 64 of bytes.
        session = self.write_session(transfer_function={"points": [
            {"intensity": 250, "color": "#204080", "opacity": 0.0}, {"intensity": 255, "color": "#204080", "opacity": 1.0}]})
        for name in ["a.png", "a.pfm"]:
            picture = self.folder / name
            _, least = self.peak_of(session, "-o", picture, "--size", "16x16")
            result, resident = self.peak_of(session, "-o", picture, "--size", "16384x1024")
            self.assertLess(resident - least, 160 << 20)
            self.assertLess(result["bytes"]["peak_host"], 160 << 20)
            self.assertGreater(result["bytes"]["peak_host"], 32 << 20)
            if name == "a.pfm":
                self.assertEqual(picture.stat().st_size, len("PF\n16384 1024\n-1.0\n") + 16384 * 1024 * 12)
        self.assertEqual(read_png_header(self.folder / "a.png"), (16384, 1024))

    def test_a_stopped_picture_leaves_the_old_file_and_nothing_else(self):
        session = self.write_session(volume={"procedural": "tubes", "size": [64, 64, 64], "seed": 3})
        picture, _ = self.render(session, "a.png")
        before = picture.read_bytes()
        for number in [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGPIPE]:
            with subprocess.Popen([SHVR, "render", session, "-o", picture, "--size", "65536x65536"],
                                  stderr=subprocess.PIPE, text=True, env=ENVIRONMENT) as process:
                while not list(self.folder.glob(".shvr-*.tmp")):
                    self.assertIsNone(process.poll())
                    time.sleep(0.01)
                process.send_signal(number)
                said = process.stderr.read()
                # Who reads no more gets no sentence, and the signal as the status.
                self.assertEqual(process.wait(), -number if number == signal.SIGPIPE else 1, said)
            self.assertIn("" if number == signal.SIGPIPE else "a.png: stopped", said)
            self.assertEqual(picture.read_bytes(), before)
            self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["a.png", "session.json"])

    def test_a_signal_right_after_a_file_is_created_leaves_nothing(self):
        session = self.write_session(volume={"procedural": "tubes", "size": [16, 16, 16], "seed": 3})
        result = run("render", session, "-o", self.folder / "a.png", "--size", "16x16", environment={
            "LD_PRELOAD": str(STOP_IN_SAVE), "SHVR_STOP_AT_CREATE": "/.shvr-", "SHVR_STOP_SIGNAL": str(int(signal.SIGPIPE)),
            "XDG_CACHE_HOME": str(self.folder / "cache"), "ASAN_OPTIONS": "verify_asan_link_order=0"})
        self.assertEqual(result.returncode, -signal.SIGPIPE, result.stderr)
        left = [path for path in self.folder.rglob("*") if path.name.startswith(".shvr-") or path.name == "a.png"]
        self.assertEqual(left, [])


if __name__ == "__main__":
    unittest.main()
