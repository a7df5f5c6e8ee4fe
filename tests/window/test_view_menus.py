"""Every entry of every menu, clicked with a real mouse: those of shortcuts do what ui/workbench/bindings/KEYS.md says,
the others what is written here. An entry that is in neither table fails."""
import json
import unittest

from seen import Seen, in_short, shortcut_rows
from test_view_keys import FIRST, MAKES

# Entries without a shortcut: the action that they make, or the words of the dialog that they show (in quotes).
OTHERS = {
    "Save as...": "'Go on under another name'", "Copy the session": "copy_session", "Revert to the last save": "revert",
    "Open with options...": "'Look at a file'", "Correct the spacing...": "'Now 32 x 32 x 32'",
    "Import as project...": "'Import as project'", "Export...": "'Export annotation'",
    "Label connected parts...": "'Label connected parts'", "Compare with the truth...": "'Compare with the truth'",
    "Shading": "set light.shaded", "Show everything": "reset_cuts", "Open the example": "open_example",
    "Go there": "look_from", "Rename": None, "Remove": "forget_camera",
    "Fill": "set probe.brush", "Flood fill": "set probe.brush", "Speckle fill": "set probe.brush",
}
# Menus within menus: all of their entries make the same action, or they are looked up as the others are (None).
SUBMENUS = {
    "Open recent": "open", "Look from": "look_from", "Kept views": None, "view 1": None, "Panels": None,
    "Turn the view": None, "Move the view": None, "Distance blending": None, "Cutting planes": None, "Clip planes": None,
    "Group of what is selected": "group",
}
PANELS = ["Transfer function", "Colour groups", "Brush and probe", "Tracing", "Tracing list", "Light and depth",
          "Ambient occlusion", "Cutting planes", "Render quality", "What is shown", "Views", "History"]
# They say what a menu is about, or are fields to drag.
NO_ENTRIES = ("What is drawn, in voxels", "from ", "to ")
LAST = ["Open recent", "Open the example", "Quit"]   # another scan is open afterwards, or none


class Menus(Seen):
    def titles(self):
        return [seen["text"] for seen in self.seen(window="##MainMenuBar")]

    def entries(self, depth):
        """The words at the left of the menu that is open, from the top."""
        texts = self.seen(window=f"##Menu_{depth:02}")
        left = min(seen["box"][0] for seen in texts)
        rows = {round(seen["box"][1]): seen["text"] for seen in texts if seen["box"][0] < left + 4}
        return [text for _, text in sorted(rows.items()) if not text.startswith(NO_ENTRIES)]

    def open_menu(self, *path):
        """Clicks from title to submenu; returns the entries of the last."""
        def opens(name, window, opened):
            """A click on the title of a menu that is about to close leaves it closed."""
            for _ in range(3):
                self.click_on(name, window)
                if self.soon(lambda: self.seen(window=opened)):
                    return
            self.fail(f"{name} does not open")
        opens(path[0], "##MainMenuBar", "##Menu_00")
        for depth, name in enumerate(path[1:]):
            opens(name, f"##Menu_{depth:02}", f"##Menu_{depth + 1:02}")
        self.settle()
        return self.entries(len(path) - 1)

    def settle(self):
        """Menus take a frame to find their size."""
        before = None
        def is_still():
            nonlocal before
            now = self.seen()
            is_same, before = now == before, now
            return is_same
        self.until(is_still, "still screen")

    def close_menus(self):
        """Each Escape leaves one of them, or what is framed in it."""
        for _ in range(12):
            if not self.seen(window="##Menu_") and not self.seen(window="Open a volume"):
                return
            before = self.frame()["frame"]
            self.press("Escape")
            self.until(lambda: self.frame()["frame"] > before, "a frame after Escape")
        self.fail("a menu stays open")

    def expected(self, path, entry):
        """What an entry makes; fails where nobody says so."""
        if path[-1] in SUBMENUS and SUBMENUS[path[-1]]:
            return SUBMENUS[path[-1]]
        if path[-1] == "Panels" and entry in PANELS:
            return "prefer"
        if path[-1] == "Paint" and entry[0].isdigit():
            return "set probe.group"
        for row in self.table:
            if row["does"] == entry:
                self.met.add(row["id"])
                return MAKES.get(row["id"], row["action"])
        if entry not in OTHERS:
            self.wrong.append(f"{' > '.join(path)} > {entry}: is in no table")
        return OTHERS.get(entry)

    def prepare(self, entry):
        """Some do nothing until something else was done."""
        name = next((row["id"] for row in self.table if row["does"] == entry), None)
        x, y = self.middle()
        if name == "copy_measurements":
            self.press("Alt+6")
            for at in (x - 20, x + 20):
                self.what_follows(lambda: self.do("mousemove", at, y, "sleep", 0.1, "click", 1, pause_s=0), "measure_at")
            self.press("Alt+1")
        if name == "mend_cut":
            self.cut_a_line()
        for first in FIRST.get(name, []):
            self.do("mousemove", x, y, pause_s=0.1)
            if first == "add_node":
                self.press("Shift+Home")
                self.what_follows(lambda: self.press("L"), "probe_onto", 2)
            row = next(row for row in self.table if row["id"] == first)
            self.what_follows(lambda: self.press(row["today"].split()[0]), MAKES.get(first, row["action"]), 2)
        if entry == "Fill":   # whatever it was before
            self.what_follows(lambda: self.press("End"), "set probe.brush", 2)

    def cut_a_line(self):
        x, y = self.middle()
        for at in (x - 20, x, x + 20):
            self.do("mousemove", at, y, pause_s=0.2)
            self.what_follows(lambda: self.press("L"), "probe_onto", 2)
            self.what_follows(lambda: self.press("N"), "node", 2)
        self.do("mousemove", x, y, pause_s=0.2)
        for key, action in (("/", "deselect"), (".", "select"), ("Delete", "delete")):
            self.what_follows(lambda: self.press(key), action, 2)

    def check_entry(self, path, entry):
        expected = self.expected(path, entry)
        if expected is None:
            return
        self.prepare(entry)
        self.open_menu(*path)
        window = f"##Menu_{len(path) - 1:02}"
        if expected.startswith("'"):
            self.click_on(entry, window)
            if not self.soon(lambda: self.seen(expected.strip("'"))) and self.seen(entry, window):
                self.click_on(entry, window)   # the menu was just opening
            self.see(expected.strip("'"))
            self.see("Cancel")
            self.settle()
            self.press("Escape")
            self.see_no_more("Cancel")
        else:
            found = self.what_follows(lambda: self.click_on(entry, window), expected, patience_s=3)
            if not found and self.seen(entry, window):   # the menu was just opening
                found = self.what_follows(lambda: self.click_on(entry, window), expected, patience_s=3)
            # What is chosen already changes nothing.
            if expected == "ask_open":
                self.see("", "Open a volume")
            if expected not in found and not (found == ["set "] and expected.startswith("set probe.")):
                self.wrong.append(f"{' > '.join(path)} > {entry}: made {found}; expected {expected}")
        for text in ("Keys and mouse", "Preferences", "Messages", "GPU passes", "Find anything"):
            if self.seen(text, text):
                self.press("Escape")
        self.close_menus()

    def check_menu(self, *path):
        entries = self.open_menu(*path)
        self.close_menus()
        for entry in entries:
            if entry in LAST or entry == path[-1]:   # a field with the name
                continue
            if entry in SUBMENUS and not (path[-1] == "Panels"):
                self.check_menu(*path, entry)
            else:
                self.check_entry(path, entry)

    def test_each_entry_does_what_the_tables_say(self):
        self.table, self.met, self.wrong = shortcut_rows(), set(), []
        session = self.write_ball(volume={"procedural": "sphere", "size": [32, 32, 32]},
                                  light={"occlusion": {"strength": 0.3, "automatic": False}},
                                  interaction={"screenshot_scale": 1},
                                  probe={"radius_voxels": 3, "group": 3, "paint_threshold": 120})
        self.open_scan(session, preferences={"hints_seen": 3})
        self.do("mousemove", *self.middle())
        self.what_follows(lambda: self.press("Ctrl+D"), "keep_camera")   # "view 1"
        titles = self.titles()
        self.assertEqual(titles, ["File", "Edit", "View", "Paint", "Trace", "Probe", "Tools", "Help"])
        for title in titles:
            self.check_menu(title)
        # What has no key is in a menu.
        without = [row["id"] for row in self.table if not row["today"] and row["id"] not in self.met]
        self.assertEqual(without, [])
        self.assertEqual(self.wrong, [])
        self.check_entry(("File",), "Open the example")
        self.see("vessels", None)
        self.open_menu("File")
        self.click_on("Quit", "##Menu_00")
        output, errors = self.program.communicate(timeout=60)
        self.assertEqual(self.program.returncode, 0, errors)
        self.assertEqual(in_short(self.done()[-1]), "quit")
        self.assertIn("messages", json.loads(output))


if __name__ == "__main__":
    unittest.main()
