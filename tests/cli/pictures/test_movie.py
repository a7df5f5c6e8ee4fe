"""shvr render --movie: frames, views, and movie files."""
import json
import os
import shutil
import signal
import subprocess
import time
import unittest

from harness import ENVIRONMENT, SHVR, TIMEOUT_S, CliTest, read_png_header, run

TOP = {"camera": "top", "cut": {"upper": [99, 99, 12]}, "groups": {"1": {"opacity": 0.5}},
       "transfer_function": {"points": [{"intensity": 90, "color": "#ff0000", "opacity": 0.1},
                                        {"intensity": 180, "color": "#ffff00", "opacity": 0.7}]}}

# Stands in for ffmpeg: keeps its arguments and the frames that it is given, and writes a "movie".
STAND_IN = """#!/bin/sh
printf '%s\\n' "$@" > "$STAND_IN_FOLDER/arguments"
cat > "$STAND_IN_FOLDER/frames"
printf 'movie' > /proc/self/fd/3
"""


class MovieTest(CliTest):
    def setUp(self):
        super().setUp()
        self.session = self.write_session(volume={"procedural": "tubes", "size": [24, 24, 24]},
                                          render={"size": [24, 18]}, cameras={"mine": {"side": "left", "zoom": 1.5}})

    def movie(self, name, *arguments, frames=4):
        folder = self.folder / name
        result = self.check_json("render", self.session, "--movie", folder, "--frames", frames, *arguments)
        return self.frames_of(folder), result

    def frames_of(self, folder):
        return [path.read_bytes() for path in sorted(folder.iterdir())]

    def picture(self, *arguments):
        path = self.folder / "picture.png"
        self.check("render", self.session, "-o", path, *arguments)
        return path.read_bytes()


class Frames(MovieTest):
    def test_a_turntable_makes_the_same_frames_in_every_run(self):
        first, result = self.movie("a")
        self.assertEqual([result[key] for key in ("frames", "size", "path", "turntable_degrees")],
                         [4, [24, 18], str(self.folder / "a"), 360])
        self.assertEqual(sorted(path.name for path in (self.folder / "a").iterdir()),
                         ["frame-0001.png", "frame-0002.png", "frame-0003.png", "frame-0004.png"])
        self.assertEqual(read_png_header(self.folder / "a" / "frame-0001.png"), (24, 18))
        self.assertEqual(len(set(first)), 4)
        self.assertEqual(self.movie("b", "--turntable", 360)[0], first)
        self.assertEqual(self.movie("b")[0], first)  # replaces them
        self.assertEqual(first[0], self.picture())
        self.assertEqual(first[1], self.picture("--camera", '{"side": "front", "turn_degrees": 90}'))

    def test_frames_of_views_equal_their_pictures(self):
        views = ",".join(["front", json.dumps(TOP), "mine"])
        frames, result = self.movie("a", "--keys", views, frames=5)
        self.assertEqual([view["frame"] for view in result["views"]], [1, 3, 5])
        self.assertEqual(frames[0], self.picture())
        as_set = [f"{key}={json.dumps(value)}" for key, value in TOP.items() if key != "camera"]
        self.assertEqual(frames[2], self.picture("--camera", "top", *(word for one in as_set for word in ("--set", one))))
        self.assertEqual(frames[4], self.picture("--camera", "mine"))
        self.assertEqual(len(set(frames)), 5)
        self.assertEqual(self.movie("b", "--keys", views, frames=5)[0], frames)

    def test_a_name_stands_for_the_look_that_was_kept_with_it(self):
        look = {key: TOP[key] for key in ("cut", "groups", "transfer_function")}
        self.session = self.write_session(
            volume={"procedural": "tubes", "size": [24, 24, 24]}, render={"size": [24, 18]},
            cameras={"mine": {"side": "left", "zoom": 1.5}}, key_looks={"mine": look})
        frames, _ = self.movie("a", "--keys", "front,mine", frames=3)
        as_set = [word for key, value in look.items() for word in ("--set", f"{key}={json.dumps(value)}")]
        self.assertEqual(frames[0], self.picture())
        self.assertEqual(frames[2], self.picture("--camera", "mine", *as_set))
        self.assertEqual(len(set(frames)), 3)
        again, _ = self.movie("b", "--keys", 'front,{"camera":"mine","light":{"ambient":0.9}}', frames=2)
        self.assertEqual(again[1], self.picture("--camera", "mine", *as_set, "--set", "light.ambient=0.9"))

    def test_each_look_changes_between_views(self):
        # Frames in the middle, from one camera: neither view, and other ones if only one look differs.
        middles = set()
        for name, section in [("camera", {"side": "front", "zoom": 0.8}), *list(TOP.items())[1:2], *list(TOP.items())[3:],
                              ("light", {"ambient": 0.9}), ("unpainted", {"opacity": 0.3}),
                              ("blend", {"size": 1, "color": "#0000ff"})]:
            frames, _ = self.movie(name, "--keys", "front," + json.dumps({name: section}), frames=3)
            self.assertEqual(len(set(frames)), 3, name)
            middles.add(frames[1])
        self.assertEqual(len(middles), 6)

    def test_groups_of_painted_voxels_and_of_the_trace_change(self):
        script = self.write_script("s.jsonl", [
            {"op": "paint", "brush": "fill", "group": 3, "threshold": 0, "radius": 6, "path": [[12, 12, 12]]},
            {"op": "node", "at": [4, 4, 12], "radius": 2, "group": 3}, {"op": "node", "at": [20, 4, 12]}, {"op": "save"}])
        self.check("annotate", self.session, "--script", script)
        blue = {"groups": {"3": {"color": "#0000ff", "opacity": 1}}}
        frames, _ = self.movie("a", "--keys", "front," + json.dumps(blue), frames=3)
        self.assertEqual(len(set(frames)), 3)
        self.assertEqual(frames[0], self.picture())
        self.assertEqual(frames[2], self.picture("--set", "groups=" + json.dumps(blue["groups"])))

    def test_views_from_files(self):
        other = self.write_session("other.json", volume={"procedural": "tubes", "size": [24, 24, 24]}, camera="right",
                                   light={"ambient": 0.9})
        self.check("render", other, "-o", self.folder / "kept.png", "--size", "24x18", "--with-session")
        kept = (self.folder / "kept.png")
        settings = self.write_json("top.json", TOP)
        frames, _ = self.movie("a", "--keys", f"{settings},{other},{kept}", frames=3)
        self.check("render", other, "-o", self.folder / "plain.png", "--size", "24x18")
        self.assertEqual(frames[1:], 2 * [(self.folder / "plain.png").read_bytes()])
        self.assertEqual(frames[0], self.movie("b", "--keys", json.dumps(TOP) + ",front", frames=2)[0][0])

    def test_a_frame_with_its_session_is_a_picture_that_can_be_made_again(self):
        plain, _ = self.movie("plain", "--keys", "front," + json.dumps(TOP), frames=3)
        self.movie("kept", "--keys", "front," + json.dumps(TOP), "--with-session", frames=3)
        self.check("render", self.folder / "kept" / "frame-0003.png", "-o", self.folder / "again.png")
        self.assertEqual((self.folder / "again.png").read_bytes(), plain[2])

    def test_a_turntable_turns_the_way_between_views(self):
        frames, _ = self.movie("a", "--keys", "front," + json.dumps({"light": {"ambient": 0.9}}), "--turntable", 180,
                               frames=2)
        self.assertEqual(frames, [self.picture(), self.picture("--camera", "right", "--set", "light.ambient=0.9")])

    def test_ctrl_c_names_the_finished_frames_and_leaves_no_part_of_one(self):
        folder = self.folder / "a"
        command = [SHVR, "render", self.session, "--movie", folder, "--frames", "100000"]
        with subprocess.Popen([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              env=ENVIRONMENT) as process:
            try:
                while not (folder / "frame-000002.png").exists() and process.poll() is None:
                    time.sleep(0.01)
                process.send_signal(signal.SIGINT)
                _, said = process.communicate(timeout=TIMEOUT_S)
            finally:
                process.kill()
        self.assertEqual(process.returncode, 1, said)
        names = sorted(path.name for path in folder.iterdir())
        self.assertEqual(names, [f"frame-{number + 1:06}.png" for number in range(len(names))])
        self.assertIn(f"{folder}: stopped after {len(names)} of 100000 frames; {folder}/frame-000001.png to {names[-1]} "
                      "are finished", said)


class Refused(MovieTest):
    def refused(self, *arguments, says, status=1):
        before = sorted(self.folder.rglob("*"))
        self.check_refused("render", self.session, "--movie", *arguments, says=says, status=status)
        self.assertEqual(sorted(self.folder.rglob("*")), before)

    def test_wrong_usage(self):
        folder = self.folder / "a"
        for options, says in [(["--frames", "0"], "--frames is 0"), (["--fps", "0"], "--fps is 0"),
                              (["--turntable", "nan"], "--turntable is nan"), (["--keys", "front"], "--keys names one view"),
                              (["--keys", "front,,top"], "empty view"),
                              (["--keys", "front,top,left", "--frames", "2"], "one frame for each of the 3 views"),
                              (["-o", "a.png"], "--output and --movie are given")]:
            self.refused(folder, *options, says=[says], status=2)
        self.refused(self.folder / "a.avi", says=["a.avi", ".webm or .mp4"], status=2)
        self.check_refused("render", self.session, says=["--output is missing", "--movie"], status=2)
        self.check_refused("render", self.session, "-o", self.folder / "a.png", "--keys", "front", says=["--movie"], status=2)

    def test_views_that_do_not_fit(self):
        folder = self.folder / "a"
        other = self.write_session("other.json", volume={"procedural": "fog", "size": [24, 24, 24]})
        flat = '{"projection":"orthographic","eye":[12,-60,4],"target":[12,8,4],"height":30}'
        for view, says in [("nowhere", 'camera is "nowhere"; expected one of mine, front'),
                           ('{"camera":"top","render":{}}', "key render is not what views"),
                           ('{"cut":{"upper":1}}', "cut.upper is 1"), ("none.png", "none.png: does not exist"),
                           ("none.json", "none.json"), (flat, "same projection"), (other, "other.json: is a view of")]:
            self.refused(folder, "--keys", f"front,{view}", says=[says])

    def test_folders_that_hold_something_else(self):
        self.refused(self.folder, says=["holds", "; expected a new or empty folder"])
        self.movie("a", frames=4)
        self.refused(self.folder / "a", "--frames", "3", says=["frame-0004.png", "no frame of a movie of 3 frames"])
        self.refused(self.folder / "a" / "frame-0001.png" / "b", says=["cannot be written"])

    def test_an_incomplete_frame_is_not_written_and_the_finished_ones_are_named(self):
        session = self.write_session(volume={"procedural": "constant", "size": [4096, 1, 1]}, render={"size": [1, 1]},
                                     transfer_function={"points": [
                                         {"intensity": 0, "color": "#ffffff", "opacity": 1e-5},
                                         {"intensity": 255, "color": "#ffffff", "opacity": 1e-5}]})
        self.check_refused("render", session, "--movie", self.folder / "a", "--keys", "front,left", "--frames", "2",
                           "--set", "render.step_voxels=0.0001", says=[
                               "frame 2 is incomplete", "1 ray stops", "frame-0001.png is finished"])
        self.assertEqual([path.name for path in (self.folder / "a").iterdir()], ["frame-0001.png"])


class MovieFiles(MovieTest):
    def setUp(self):
        super().setUp()
        self.programs = self.folder / "programs"
        self.programs.mkdir()

    def stand_in(self, text=STAND_IN):
        program = self.programs / "ffmpeg"
        program.write_text(text)
        program.chmod(0o755)

    def run_movie(self, *arguments, path=None, environment=None):
        programs = f"{self.programs}:{os.environ['PATH']}" if path is None else path
        return run("render", self.session, "--movie", *arguments,
                   environment={"PATH": programs, "STAND_IN_FOLDER": str(self.folder), **(environment or {})})

    def test_without_ffmpeg_a_sentence_names_the_package(self):
        result = self.run_movie(self.folder / "a.webm", path=str(self.programs))
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("a.webm: the program ffmpeg is not installed; expected it for movies in one file: install the "
                      "package ffmpeg, or give a folder", result.stderr)
        self.assertFalse((self.folder / "a.webm").exists())

    def test_ffmpeg_is_given_the_bytes_of_the_frames(self):
        self.stand_in()
        for name, kind in [("a.webm", "webm"), ("a.mp4", "mp4")]:
            result = self.run_movie(self.folder / name, "--frames", "3", "--fps", "12.5", "--set",
                                    'render.background="#20406080"')
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual((self.folder / name).read_text(), "movie")
            arguments = (self.folder / "arguments").read_text().splitlines()
            for option, value in [("-video_size", "24x18"), ("-framerate", "12.5"), ("-pixel_format", "rgba")]:
                self.assertEqual(arguments[arguments.index(option) + 1], value)
            self.assertEqual(arguments[-2:], [kind, "/proc/self/fd/3"])
        pixels = (self.folder / "frames").read_bytes()
        self.assertEqual(len(pixels), 3 * 24 * 18 * 4)
        self.assertEqual(pixels[:4], bytes((0x20, 0x40, 0x60, 255)))  # opaque
        self.assertEqual(set(pixels[3::4]), {255})

    def test_what_ffmpeg_says_is_told_and_nothing_is_left(self):
        before = sorted(path.name for path in self.folder.iterdir())
        (self.folder / "a.webm").write_text("old")
        for text in ("#!/bin/sh\necho first >&2\necho Unknown encoder >&2\nexit 1\n",
                     "#!/bin/sh\ncat > /dev/null\necho Unknown encoder >&2\nexit 1\n"):
            self.stand_in(text)
            result = self.run_movie(self.folder / "a.webm", "--frames", "40")
            self.assertEqual(result.returncode, 1)
            self.assertIn("a.webm: ffmpeg could not write it: Unknown encoder", result.stderr)
            self.assertEqual((self.folder / "a.webm").read_text(), "old")
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), sorted([*before, "a.webm"]))

    def test_ctrl_c_leaves_no_part_of_a_movie(self):
        self.stand_in()
        command = [SHVR, "render", self.session, "--movie", self.folder / "a.webm", "--frames", "100000"]
        with subprocess.Popen([*map(str, command)], stderr=subprocess.PIPE, text=True,
                              env={**ENVIRONMENT, "PATH": f"{self.programs}:{os.environ['PATH']}",
                                   "STAND_IN_FOLDER": str(self.folder)}) as process:
            try:
                frames = self.folder / "frames"
                while not (frames.exists() and frames.stat().st_size) and process.poll() is None:
                    time.sleep(0.01)
                process.send_signal(signal.SIGTERM)
                said = process.communicate(timeout=TIMEOUT_S)[1]
            finally:
                process.kill()
        self.assertEqual(process.returncode, 1, said)
        self.assertRegex(said, r"a\.webm: stopped after \d+ of 100000 frames; not written")
        self.assertEqual([path.name for path in self.folder.glob("*webm*")], [])
        self.assertEqual([path.name for path in self.folder.iterdir() if path.name.startswith(".")], [])

    def test_odd_sides_and_kept_sessions_are_refused(self):
        self.stand_in()
        self.assertIn("25 x 18 pixels; expected even numbers",
                      self.run_movie(self.folder / "a.mp4", "--size", "25x18").stderr)
        self.assertEqual(self.run_movie(self.folder / "a.mp4", "--with-session").returncode, 2)

    @unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is not installed")
    def test_movies_show_the_frames(self):
        frames = self.folder / "frames"
        self.check("render", self.session, "--movie", frames, "--frames", "3", "--size", "64x48")
        for name in ("a.webm", "a.mp4"):
            files = []
            for _ in range(2):
                self.check("render", self.session, "--movie", self.folder / name, "--frames", "3", "--size", "64x48")
                files.append((self.folder / name).read_bytes())
            self.assertEqual(*files)
            shown = self.folder / f"shown-{name}"
            shown.mkdir()
            subprocess.run(["ffmpeg", "-loglevel", "error", "-i", self.folder / name, "-vf",
                            "scale=in_color_matrix=bt709:in_range=tv", shown / "frame-%04d.png"], check=True)
            self.assertEqual(len(list(shown.iterdir())), 3)
            for path in sorted(shown.iterdir()):
                error = self.check_json("compare", frames / path.name, path)
                self.assertLess(error["rmse"], 12)


if __name__ == "__main__":
    unittest.main()
