"""What is kept between two runs of the window: its size and place, looks, and pictures of projects on
the start page."""
import json
import os
import sys
import unittest
import zlib
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import window  # noqa: E402
from seen import Seen  # noqa: E402


class Kept(Seen):
    @staticmethod
    def with_size(arguments):
        """As it begins by itself, unless a size is given."""
        return arguments

    def preferences(self):
        return json.loads((self.configuration / "preferences.json").read_text())

    def geometry(self):
        """Position and size of the window on the screen, of which there is no other."""
        lines = self.display.do("search", "--onlyvisible", "--name", "SHVR", "getwindowgeometry", "--shell")
        found = dict(line.split("=") for line in lines.split() if "=" in line)
        return [int(found[name]) for name in ("X", "Y", "WIDTH", "HEIGHT")]

    def test_the_window_begins_with_the_size_and_at_the_place_that_it_had(self):
        self.view(preferences={"hints_seen": 3})
        self.see("Open the example")
        number = self.window_named("SHVR")
        self.do("windowsize", "--sync", number, 700, 500, "windowmove", "--sync", number, 120, 60, pause_s=0)
        self.until(lambda: self.geometry() == [120, 60, 700, 500], "moved window")
        self.finish()
        self.assertEqual(self.preferences()["layout"]["windows"]["main"], {"at": [120, 60], "size": [700, 500]})
        self.view()
        self.see("Open the example")
        self.until(lambda: self.geometry() == [120, 60, 700, 500], f"window where it was, not {self.geometry()}")
        self.finish()
        # A place on a screen that is gone: the window comes where it can be reached. A given size is not kept.
        kept = self.preferences()
        kept["layout"]["windows"]["main"]["at"] = [9000, 9000]
        (self.configuration / "preferences.json").write_text(json.dumps(kept))
        self.view("--size", "640x480")
        self.see("Open the example")
        self.assertEqual(self.geometry()[2:], [640, 480])
        self.finish()
        self.assertEqual(self.preferences(), kept)
        self.view()
        self.see("Open the example")
        x, y, width, height = self.geometry()
        self.assertEqual([width, height], [700, 500])
        self.assertLess(x, 1000)
        self.finish()

    def test_the_chooser_begins_in_the_working_folder_and_later_in_that_of_the_last_scan(self):
        here = self.folder / "here"
        here.mkdir()
        session = self.write_ball()
        program = mock.patch("window.SHVR", os.path.abspath(window.SHVR))   # from another folder, too
        program.start()
        self.addCleanup(program.stop)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(here)
        self.view(preferences={"hints_seen": 3})
        self.see("Open the example")
        self.press("Ctrl+O")
        self.see(str(here), "Open a volume")
        self.press("Escape")
        self.see_no_more("", "Open a volume")
        self.finish()
        self.view(preferences={"hints_seen": 3, "recent": [{"path": str(session)}]})
        self.press("Ctrl+O")
        self.see(str(self.folder), "Open a volume")
        self.press("Escape")
        self.see_no_more("", "Open a volume")
        self.finish()

    def test_a_look_is_saved_and_applied_to_the_next_scan(self):
        first = self.write_ball(groups={"3": {"name": "vein", "color": "#2080c0"}}, light={"ambient": 0.55})
        first = first.rename(self.folder / "first.json")
        self.open_scan(first, preferences={"hints_seen": 3})
        self.click_on("View", "##MainMenuBar")
        self.click_on("Looks", "##Menu_00")
        self.click_on("Save the look...", "##Menu_01")
        self.see("name of the look", "Save the look")
        self.do("type", "--delay", 40, "a/b", pause_s=0)
        self.see('"a/b" is no name for a look, since it has a /', "Save the look")
        self.do("key", "ctrl+a", "type", "--delay", 40, "mine ", pause_s=0)   # the blank is left out
        self.see("It can then be applied to any scan", "Save the look")
        self.press("Return")
        look = self.configuration / "looks" / "mine.json"
        self.wait_for_file(look)
        self.see("Groups, light and transfer function are saved as the look mine", "Status")
        self.finish()
        second = self.write_ball(volume={"procedural": "fog", "size": [32, 32, 32]})
        self.open_scan(second)
        # From the palette, and undone; then by the menu.
        self.press("Ctrl+Shift+P")
        self.see("", "Find anything")
        self.do("type", "--delay", 40, "look mine", pause_s=0)
        self.see("Look mine", "Find anything")
        self.press("Return")
        self.see("Applied the look mine; undo takes it back", "Status")
        self.check_key("Ctrl+Z", "undo")
        self.click_on("View", "##MainMenuBar")
        self.click_on("Looks", "##Menu_00")
        self.click_on("mine", "##Menu_01")
        self.see("3  vein", "Side panel")
        self.check_key("Ctrl+S", "save")
        self.see("Saved ", "Status")
        self.finish()
        kept = json.loads(second.read_text())
        self.assertEqual(kept["groups"]["3"]["name"], "vein")
        self.assertEqual(kept["light"]["ambient"], 0.55)
        self.assertEqual(len(kept["transfer_function"]["points"]), 3)
        # Its file is taken by a script, too, and refused in one sentence where it is broken.
        script = self.write_script("s.jsonl", [{"op": "load", "what": "look", "path": str(look)}])
        self.check("annotate", second, "--script", script)
        look.write_text(look.read_text().replace('"shvr_look":1', '"shvr_look":7'))
        self.check_refused("annotate", second, "--script", script, says=["mine.json", "shvr_look is 7", "expected"])

    def test_the_start_page_shows_a_picture_of_what_was_open(self):
        session = self.write_ball()
        self.open_scan(session, preferences={"hints_seen": 3})
        pictures = self.configuration / "pictures"
        self.until(lambda: list(pictures.glob("*.png")), "picture of the project")
        self.finish()
        picture, = pictures.glob("*.png")
        self.assertEqual(picture.read_bytes()[16:24], (192).to_bytes(4, "big") + (120).to_bytes(4, "big"))
        begin = picture.read_bytes().index(b"IDAT") + 4
        rows = zlib.decompressobj().decompress(picture.read_bytes()[begin:])
        self.assertGreater(len(set(rows)), 50, "shades of the ball")
        self.view()
        self.see("Recent", "Start")
        self.see("Looks at 3-D scans", "Start")
        self.until(lambda: not self.seen("no picture yet", "Start"), "picture of the project on the start page")
        self.click_on(session.name, "Start")
        self.see("Opened ", "Status")
        self.finish()
        picture.unlink()
        self.view()
        self.see("no picture yet", "Start")
        self.finish()


if __name__ == "__main__":
    unittest.main()
