"""Panels on what the workbench knows, by real keys: the palette, and keys that are changed."""
import json
import os
import shutil
import unittest
from pathlib import Path
from unittest import mock

from harness import SHVR
from seen import Seen

DAB = {"op": "paint", "brush": "fill", "region": "ball", "path": [[32, 32, 32]], "radius": 5, "threshold": 0, "group": 3}
PALETTE = "Find anything"


class Panels(Seen):
    def next_frames(self, count=2):
        """Those that begin from now on."""
        before = self.frame()["frame"]
        self.until(lambda: self.program.poll() is not None or self.frame()["frame"] >= before + count, "a frame")

    def press_and_look(self, key):
        self.press(key)
        self.next_frames()

    def type_in_palette(self, text, *keys):
        self.press("Ctrl+Shift+P")
        self.see("", PALETTE)
        self.next_frames()   # it has the keys from the second one on
        self.do("type", "--delay", 40, text, pause_s=0)
        self.see(text, PALETTE)
        for key in keys:
            self.press_and_look(key)
        self.press("Return")
        self.see_no_more("", PALETTE)
        self.next_frames()

    def test_the_palette_runs_what_is_typed_and_keys_are_changed(self):
        session = self.write_ball()
        self.check("annotate", session, "--script",
                   self.write_script("s.jsonl", [DAB, {**DAB, "group": 4}, {**DAB, "group": 5}, {"op": "save"}]))
        self.open_scan(session)
        self.do("mousemove", *self.middle())
        self.type_in_palette("light.ambient=0.4")
        self.type_in_palette("undo count=2")
        self.type_in_palette("look_from camera=nowhere")  # refused when it is applied
        self.type_in_palette("keys mouse")                # by its name: the help window
        self.type_in_palette("await_key shortcut=shell")
        self.what_follows(lambda: self.press("Ctrl+J"), "bind_keys")   # its new key
        self.next_frames()
        self.what_follows(lambda: self.press("Ctrl+J"), "set probe.shell")   # which works
        self.type_in_palette("await_key shortcut=preview")
        self.press_and_look("Escape")                     # stays as it is
        self.type_in_palette("await_key shortcut=overview")
        self.what_follows(lambda: self.press("Delete"), "bind_keys")   # has no key any more
        self.type_in_palette("redo", "Down", "Up")
        report = self.finish()
        lines = self.done()
        self.assertIn({"op": "set", "values": {"light": {"ambient": 0.4}}}, lines)
        self.assertIn({"op": "undo", "count": 2}, lines)
        self.assertNotIn("nowhere", self.log.read_text())
        self.assertIn("nowhere", "\n".join(report["messages"]))
        self.assertIn({"op": "show_help", "on": True}, lines)
        self.assertIn({"op": "bind_keys", "shortcut": "shell", "keys": "Ctrl+J"}, lines)
        self.assertIn({"op": "set", "values": {"probe": {"shell": True}}}, lines)
        preferences = json.loads((self.configuration / "preferences.json").read_text())
        kept = {name: entry.get("keys", "") for name, entry in preferences["keys"].items()}
        self.assertEqual(kept, {"overview": "", "shell": "Ctrl+J"})
        # The light is a step, so two are undone: it and the third dab.
        self.assertEqual((report["undoable"], report["redoable"]), (3, 1), report["messages"])

    def look_in_palette(self, text):
        self.press("Ctrl+Shift+P")
        self.see("", PALETTE)
        self.next_frames()
        self.do("type", "--delay", 40, text, pause_s=0)
        self.see(text, PALETTE)

    def test_no_key_typed_into_the_palette_reaches_the_scene(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        self.do("mousemove", *self.middle())
        before = len(self.done())
        self.look_in_palette("zzz")
        self.press_and_look("Return")      # finds nothing, and keeps the keyboard
        self.do("type", "--delay", 40, "n1", pause_s=0)
        self.see("zzzn1", PALETTE)
        self.press_and_look("Right")
        self.press_and_look("Escape")
        self.see_no_more("", PALETTE)
        self.look_in_palette("ambient")
        self.do("mousemove", *self.middle(), "mousemove_relative", 0, 160, "sleep", 0.1, "mousedown", 1, "sleep", 0.1,
                "mouseup", 1, pause_s=0)   # a click elsewhere ends it
        self.see_no_more("", PALETTE)
        by_mouse = {"show_palette", "select_at", "probe_to", "probe_onto", "probe_along", "resize"}
        self.assertLessEqual({line["op"] for line in self.done(before)}, by_mouse)
        self.finish()

    def test_the_palette_sets_a_value_behind_words_and_opens_panels(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        self.do("mousemove", *self.middle())
        self.type_in_palette("ambient 0.4")                      # the first that has the word and takes the value
        self.until(lambda: {"op": "set", "values": {"light": {"ambient": 0.4}}} in self.done(), "ambient light")
        self.look_in_palette("soft shade in hollows")            # a panel, by what it is for
        self.check_follows(lambda: self.press("Return"), "prefer")
        self.assertEqual(self.done()[-1]["values"]["layout"]["panels"], {"occlusion": {"folded": False, "place": "side"}})
        self.finish()

    def test_a_key_for_an_entry_is_told_by_name_and_a_taken_one_is_asked_for_twice(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        self.do("mousemove", *self.middle())
        self.look_in_palette("Ambient Light 0.4")
        self.press_and_look("Insert")
        self.see_no_more("", PALETTE)
        self.see("Press the key for 'Ambient light: 0.4'", "Status")
        self.what_follows(lambda: self.press("Ctrl+S"), "bind_keys")
        self.see("The key Ctrl + S stands for 'Save'", "Status")
        self.what_follows(lambda: self.press("Ctrl+S"), "bind_keys")
        self.see("The key Ctrl + S stands for 'Ambient light: 0.4'", "Status")
        before = len(self.done())
        self.check_follows(lambda: self.press("Ctrl+S"), "set light.ambient")
        self.assertNotIn("save", {line["op"] for line in self.done(before)})
        self.press_and_look("F1")
        self.see("Entries of Find anything", "Keys and mouse")
        self.see("Ambient light: 0.4", "Keys and mouse")
        self.press_and_look("Escape")
        self.finish()

    def test_an_operation_on_groups_is_found_by_its_title(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        self.do("mousemove", *self.middle())
        self.type_in_palette("fill holes")
        self.see("fills what a group encloses on all", "Operations on groups")
        self.assertIn({"op": "show_dialog", "dialog": "operation", "operation": "fill_holes"}, self.done())
        self.press("Escape")
        self.look_in_palette("ambient abc")
        self.see("Ambient light: expected a number from 0 to 10", PALETTE)
        self.press("Escape")
        self.finish()

    def install(self):
        """A tree like an installed one, with a first page of the manual; returns the program in it and the page."""
        program = self.folder / "tree" / "bin" / "shvr"
        page = self.folder / "tree" / "share" / "doc" / "shvr" / "manual" / "index.html"
        for file in (program, page):
            file.parent.mkdir(parents=True)
        try:
            os.link(SHVR, program)
        except OSError:   # another disk
            shutil.copy(SHVR, program)
        page.write_text("<title>SHVR</title>")
        return program, page

    def open_manual(self, says):
        before = self.frame()["frame"]
        self.click_on("Help", "##MainMenuBar")
        self.check_follows(lambda: self.click_on("User manual", "##Menu_00"), "show_manual")
        self.see(says)
        self.assertGreater(self.frame()["frame"], before)

    # Kind (Installation): no program to open a page with, and no page
    def test_the_menu_opens_the_manual_in_the_browser_or_says_where_it_is(self):
        program, page = self.install()
        opener, opened = self.folder / "path" / "xdg-open", self.folder / "opened"
        opener.parent.mkdir()
        opener.write_text(f'#!/bin/sh\nprintf "%s" "$*" > "{opened}.new" && /bin/mv "{opened}.new" "{opened}"\n')
        opener.chmod(0o755)
        setsid = opener.with_name("setsid")
        setsid.symlink_to(shutil.which("setsid"))
        with mock.patch("window.SHVR", str(program)):
            self.open_scan(self.write_ball(), preferences={"hints_seen": 3},
                           environment={"PATH": opener.parent, "SHVR_ASSETS": Path("assets").resolve()})
        self.open_manual("The user manual: ")
        self.wait_for_file(opened)
        self.assertEqual(opened.read_text(), str(page))
        opener.unlink()
        self.open_manual("xdg-open, of the package xdg-utils, cannot be started")
        page.unlink()
        self.open_manual("The user manual is not installed")
        said = "\n".join(self.finish()["messages"])
        self.assertIn(f"open this page in a browser: {page}", said)
        self.assertIn(f"expected it at {page}", said)


if __name__ == "__main__":
    unittest.main()
