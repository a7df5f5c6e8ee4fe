"""Figures and movies by their dialogs: files, the clipboard, and their messages."""
import json
import os
import shutil
import struct
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from seen import Seen  # noqa: E402

FIGURE, MOVIE = "Figure", "Movie"


def size_of(png):
    return struct.unpack(">II", png.read_bytes()[16:24])


def pixels_in(png):
    """The compressed pixels: the same for equal pictures."""
    content, at, found = png.read_bytes(), 8, b""
    while at < len(content):
        length, kind = struct.unpack(">I4s", content[at:at + 8])
        found += content[at + 8:at + 8 + length] if kind == b"IDAT" else b""
        at += length + 12
    return found


class Figure(Seen):
    def open_ball(self, environment=None):
        session = self.write_ball(volume={"procedural": "sphere", "size": [32, 32, 32]})
        self.open_scan(session, preferences={"hints_seen": 3}, environment=environment)

    def show(self, entry, window):
        self.click_on("File", "##MainMenuBar")
        self.click_on(entry, "##Menu_00")
        self.see("Cancel", window)

    def programs(self, **scripts):
        """An environment in which only those programs, and no others, are found."""
        folder = self.folder / "programs"
        folder.mkdir(exist_ok=True)
        for name, script in scripts.items():
            (folder / name.replace("_", "-")).write_text("#!/bin/sh\n" + script)
            (folder / name.replace("_", "-")).chmod(0o755)
        return {"PATH": folder, "WAYLAND_DISPLAY": ""}

    def test_a_figure_is_named_sized_and_confirmed_by_enter(self):
        self.open_ball()
        self.show("Figure...", FIGURE)
        self.see("Draws 1004 x ", FIGURE)
        self.do("key", "ctrl+a", "type", "--delay", 30, "leaf.png", pause_s=0)
        self.see("leaf.png", FIGURE)
        self.click_on("Legend", FIGURE)
        self.see("The legend is left out", FIGURE)
        self.press("Return")
        self.see_no_more("", FIGURE)
        self.until(lambda: any("leaf.png (1004 x " in seen["text"] for seen in self.seen(window="Status")), "message")
        action = next(line for line in self.done() if line["op"] == "figure")
        self.assertTrue(action["scale_bar"] and action["legend"])
        self.assertEqual(action["dots_per_inch"], 300)
        report = self.finish()
        said = next(line for line in report["messages"] if "leaf.png" in line)
        self.assertTrue(said.startswith(f"Figure: {self.folder / 'leaf.png'} (1004 x "), said)
        self.assertTrue(said.endswith("; the legend is left out: no group is painted or traced, and visible"), said)
        again = self.folder / "again.png"
        self.check("render", self.folder / "leaf.png", "-o", again)   # from the session and the elements in it
        self.assertEqual(list(size_of(again)), action["pixels"])
        self.assertEqual(pixels_in(again), pixels_in(self.folder / "leaf.png"))

    def test_a_size_that_no_picture_has_is_refused_in_the_dialog(self):
        self.open_ball()
        self.press("Ctrl+Shift+P")
        self.see("", "Find anything")
        self.do("type", "--delay", 30, "figure...", pause_s=0)
        self.see("Figure...", "Find anything")
        self.press("Return")
        self.see("Draws 1004 x ", FIGURE)
        self.type_into("Size", "900000", FIGURE)
        self.see("the size is 900000 x ", FIGURE)
        self.press("Return")
        self.see_frames()
        self.see("Cancel", FIGURE)
        self.press("Escape")
        self.see_no_more("", FIGURE)
        self.finish()
        self.assertEqual(list(self.folder.glob("*figure*")), [])

    def test_lines_pasted_into_a_title_stay_words(self):
        if not shutil.which("xclip"):
            self.skipTest("xclip is not installed")
        subprocess.run(["xclip", "-selection", "clipboard"], input="Bellis\nperennis", text=True, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                       env={**os.environ, "DISPLAY": self.display.name})
        self.open_ball()
        self.show("Figure...", FIGURE)
        self.type_into("Title", "", FIGURE)
        self.press("Ctrl+V")
        self.see("Bellis perennis", FIGURE)
        self.press("Escape")
        self.see_no_more("", FIGURE)
        self.finish()

    def test_a_picture_is_copied_through_the_program_of_the_display(self):
        copied, words = self.folder / "copied.png", self.folder / "words"
        self.open_ball(self.programs(xclip=f'/bin/cat > {copied}\necho "$@" > {words}\n'))
        self.show("Figure...", FIGURE)
        self.click_on("Copy picture", FIGURE)
        self.see("Copied the picture to the clipboard (1004 x ", "Status")
        self.finish()
        self.assertEqual(size_of(copied)[0], 1004)
        self.assertEqual(words.read_text(), "-selection clipboard -target image/png -in\n")

    def test_without_programs_the_dialogs_name_their_packages(self):
        self.open_ball(self.programs())
        self.show("Figure...", FIGURE)
        self.see("Copy picture needs xclip", FIGURE)
        self.press("Escape")
        self.see_no_more("", FIGURE)
        self.show("Movie...", MOVIE)
        self.see("WebM and MP4 need the package ffmpeg", MOVIE)
        self.see("Frames as PNG", MOVIE)
        self.press("Escape")
        self.see_no_more("", MOVIE)
        self.finish()

    def test_a_movie_turns_and_can_be_cancelled(self):
        self.open_ball()
        self.show("Movie...", MOVIE)
        self.see("Draws 120 frames of 1280 x 720 pixels to ", MOVIE)
        self.press("Return")
        self.see_no_more("", MOVIE)
        self.see("Movie: frame ", "Status")
        self.click_on("Cancel", "Jobs")
        self.see("Cancelled: the movie", "Status")
        self.see_no_more("", "Jobs")
        self.assertEqual(list(self.folder.glob("*movie*")), [])
        self.show("Movie...", MOVIE)
        self.click_on("WebM", MOVIE)
        self.click_on("Frames as PNG", "##Combo_")
        self.see("Frames as PNG", MOVIE)
        self.type_into("Length", "0.1", MOVIE)
        self.see("Draws 3 frames of ", MOVIE)
        self.type_into("Size", "64", MOVIE)
        self.see("Draws 3 frames of 64 x 720 ", MOVIE)
        self.press("Return")
        self.see("Movie: ", "Status")
        folder = next(line for line in self.done() if line["op"] == "movie" and line["frames"] == 3)["path"]
        self.until(lambda: any(seen["text"].startswith(f"Movie: {folder} (3 frames") for seen in self.seen()), "a movie")
        self.finish()
        frames = sorted(os.listdir(folder))
        self.assertEqual(frames, ["frame-0001.png", "frame-0002.png", "frame-0003.png"])
        self.assertEqual({size_of(self.folder / folder / name) for name in frames}, {(64, 720)})

    def test_a_movie_goes_through_what_was_shown(self):
        session = self.write_ball(volume={"procedural": "sphere", "size": [32, 32, 32]})
        self.open_scan(session, preferences={"hints_seen": 3, "keys": {"oblique_cut": {"keys": "T"}}})
        self.do("mousemove", *self.middle(), pause_s=0)
        self.check_key("Ctrl+Shift+D", "keep_camera")
        self.see("This view is kept as view 1, with its look", "Status")
        self.check_key("T", "oblique_cut")
        self.show("Movie...", MOVIE)
        self.see("view 1", MOVIE)
        self.click_on("Add what is shown", MOVIE)
        self.see("view 2", MOVIE)
        self.see("changes cut", MOVIE)
        self.click_on("WebM", MOVIE)
        self.click_on("Frames as PNG", "##Combo_")
        self.type_into("Length", "0.1", MOVIE)
        self.type_into("Size", "64", MOVIE)
        self.see("Draws 3 frames of 64 x 720 ", MOVIE)
        self.press("Return")
        self.until(lambda: any(" (3 frames, 64 x 720 pixels)" in seen["text"] for seen in self.seen()), "a movie")
        action = next(line for line in self.done() if line["op"] == "movie")
        self.assertEqual(action["views"], "view 1\nview 2")
        self.finish()
        self.assertEqual(list(json.loads(session.read_text())["key_looks"]), ["view 1", "view 2"])
        frames = [path.read_bytes() for path in sorted(Path(action["path"]).iterdir())]
        self.assertEqual(len(set(frames)), 3)

    def test_closing_waits_for_a_movie_with_ways_out(self):
        self.open_ball()
        self.show("Movie...", MOVIE)
        self.press("Return")
        self.see("Movie: frame ", "Status")
        self.press("ctrl+q")
        self.see("The window closes once ", "Closing")
        self.click_on("Stay open", "Closing")
        self.see_no_more("", "Closing")
        self.press("ctrl+q")
        self.click_on("Cancel it and close", "Closing")
        self.program.communicate(timeout=60)
        self.assertEqual(self.program.returncode, 0)
        self.assertEqual(list(self.folder.glob("*movie*")), [])

    def test_a_movie_goes_through_views_into_a_file(self):
        if subprocess.run(["which", "ffmpeg"], capture_output=True).returncode:
            self.skipTest("ffmpeg is not installed")
        self.open_ball()
        self.show("Movie...", MOVIE)
        self.click_on("turns the volume", MOVIE)
        self.click_on("goes from view to view", "##Combo_")
        self.see("one view that does not turn stands still", MOVIE)
        for view in ("front", "top"):
            self.click_on("Add a view", MOVIE)
            self.click_on(view, "##Combo_")
            self.see(view, MOVIE)
        self.type_into("Length", "0.1", MOVIE)
        self.type_into("Size", "64", MOVIE)
        self.see("Draws 3 frames of 64 x 720 ", MOVIE)
        self.press("Return")
        self.until(lambda: any(" (3 frames, 64 x 720 pixels)" in seen["text"] for seen in self.seen()), "a movie")
        action = next(line for line in self.done() if line["op"] == "movie")
        self.assertEqual(action["views"], "front\ntop")
        self.finish()
        probe = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries",
                                "stream=nb_read_frames,width,height", "-of", "csv=p=0", action["path"]],
                               capture_output=True, text=True)
        self.assertEqual(probe.stdout.strip(), "64,720,3")


if __name__ == "__main__":
    unittest.main()
