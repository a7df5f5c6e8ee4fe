"""Every entry of every menu, chosen with the mouse: each does what the table of shortcuts says of it
(ui/workbench/bindings/KEYS.md), or the table below where it has no shortcut. What an action then changes is the
workbench's own table (tests/gpu/workbench/actions_test.cpp). The entries are read from the screen, so that none can be
added without being tried."""
import unittest

from seen import Seen, in_short, shortcut_rows
from test_view_keys import FIRST, MAKES

# Menus within menus, and what entries without a shortcut make: an action, or a dialog that is shown.
INNER = {"Open recent", "Look from", "Kept views", "Panels", "Turn the view", "Move the view", "Distance blending",
         "Cutting planes", "Clip planes", "Touch", "Group of what is selected", "view 1", "Remove"}
DIALOGS = {"Save as...", "Open with options...", "Correct the spacing...", "Import as project...", "Export...",
           "Label connected parts...", "Compare with a reference...", "Take from a file..."}
EXPECTED = {
    "Copy the session": "copy_session", "Revert to the last save": "revert", "Shading": "set light.shaded",
    "Show everything": "reset_cuts", "Go there": "look_from", "Remove this view": "forget_camera",
}
BY_MENU = {"Look from": "look_from", "Panels": "prefer", "Group of what is selected": "group"}   # of all that is there
# Entries that say something else than their action, since of their kind there is one for each group or brush.
IN_PAINT = {"set probe.group", "set probe.brush"}
NO_ENTRIES = {"Cutting planes": ["What is drawn", "from ", "to ", "x", "y", "z"], "view 1": ["view 1", "Rename"]}
# They need a pointer over the picture, or stay grey for what they say when pointed at.
WITH_THE_POINTER = {"pivot_at_pointer"}
AT_LAST = {"quit", "quit_unsaved", "open_example"}
AGAIN = {"full_screen", "side_panels", "tool_bar", "volume", "meshes", "guide", "let_go"}
ESCAPED = {"help", "preferences", "messages", "palette", "passes", "open", "focus_panels", "focus_menu"}


class Menus(Seen):
    maxDiff = None

    def check_menu(self, title):
        session = self.write_ball(volume={"procedural": "sphere", "size": [32, 32, 32]},
                                  light={"occlusion": {"strength": 0.3, "automatic": False}},
                                  interaction={"screenshot_scale": 1},
                                  probe={"radius_voxels": 3, "group": 3, "paint_threshold": 120})
        # What others need first needs a key.
        keys = {"more_blending": "T"}
        self.open_scan(session, preferences={"hints_seen": 3, "recent": [{"path": str(session)}],
                                             "keys": {name: {"keys": chord} for name, chord in keys.items()}})
        self.rows = [{**row, "today": keys.get(row["id"], row["today"])} for row in shortcut_rows()]
        self.chords = {chord for row in self.rows for chord in row["today"].split()}
        self.names = {row["does"] for row in self.rows} | INNER | DIALOGS | set(EXPECTED) | {"Open the example"}
        self.do("mousemove", *self.middle())
        self.press("Ctrl+D")   # view 1
        self.wrong, self.tried = [], 0
        self.walk([title])
        self.finish()
        self.assertEqual(self.wrong, [])
        return self.tried

    def open_menu(self, path):
        self.close_menus()
        self.click_on(path[0], "##MainMenuBar")
        for depth, title in enumerate(path[1:]):
            # Pointed at, not clicked: where there is little room it opens under the pointer.
            x, y = self.middle_of(self.see(title, f"##Menu_{depth:02}"))
            self.do("mousemove", x - 2, y, "mousemove", x, y, pause_s=0)
            self.until(lambda: self.seen(window=f"##Menu_{depth + 1:02}"), f"menu {path[:depth + 2]}", 5)
        return self.until(lambda: self.seen(window=f"##Menu_{len(path) - 1:02}"), f"menu {path}")

    def close_menus(self):
        if self.soon(lambda: not self.seen(window="##Menu_"), 0.3):   # what was chosen closed it
            return
        self.press("Escape")   # all of them, wherever the pointer is
        self.see_no_more("", "##Menu_")

    def entries(self, path):
        passed_over = NO_ENTRIES.get(path[-1], [])
        texts = [seen["text"] for seen in self.open_menu(path)]
        return [self.entry_of(text) for text in texts if not self.is_chord(text) and text not in passed_over
                and not any(len(what) > 2 and text.startswith(what) for what in passed_over)]

    def is_chord(self, text):
        """"Ctrl + Y", or several of them."""
        parts = text.replace(" + ", "+").replace("Page ", "Page").split()
        return all(part in self.chords or part.rstrip(",") in self.chords for part in parts)

    def entry_of(self, text):
        """Where the words reach as far as the shortcut they are one text with it."""
        known = [name for name in self.names if text == name or text.startswith(name + "  ")]
        return max(known, key=len, default=text)

    def walk(self, path):
        for entry in self.entries(path):
            if entry in INNER and path[-1] not in BY_MENU:   # "Look from" lists kept views, too
                self.walk([*path, entry])
            else:
                self.check_entry(path, entry)

    def row_of(self, entry):
        return next((row for row in self.rows if row["does"] == entry), None)

    def check_entry(self, path, entry):
        row = self.row_of(entry)
        name = row["id"] if row else "open_example" if entry == "Open the example" else ""
        if name in AT_LAST or name in WITH_THE_POINTER or path[-1] == "Open recent":
            return
        self.tried += 1
        where, before = " > ".join([*path, entry]), len(self.done())
        if name == "copy_measurements" or name == "clear_measurements":
            self.measure()
        if name == "mend_cut":
            self.cut_a_line()
        if name == "select_segment":
            self.line()
        for first in FIRST.get(name, ["add_node"] if path[-1] in BY_MENU and path[0] == "Trace" else []):
            self.prepare(first)
        if entry in DIALOGS:
            self.choose(path, entry)
            self.see("Cancel")
            self.press("Escape")
            self.see_no_more("Cancel")
            return
        wanted = {BY_MENU[path[-1]]} if path[-1] in BY_MENU and not row else {EXPECTED[entry]} if entry in EXPECTED \
            else {MAKES.get(name, row["action"])} if row else IN_PAINT if path[0] == "Paint" else set()
        before = len(self.done())
        self.choose(path, entry)
        self.soon(lambda: wanted & self.made(before), 20)
        if not wanted & self.made(before):
            self.wrong.append(f"{where} made {sorted(self.made(before))}; expected {sorted(wanted)}")
        if name in AGAIN:
            self.do(pause_s=0.2)
            self.choose(path, entry) if name == "tool_bar" or not row["today"] else self.press(row["today"].split()[0])
            self.do(pause_s=0.3)
        if name in ESCAPED:
            self.do(pause_s=0.3)
            self.press("Escape")
            self.do(pause_s=0.3)

    def made(self, before):
        return {in_short(action) for action in self.done(before)}

    def choose(self, path, entry):
        self.open_menu(path)
        self.click_on(entry, f"##Menu_{len(path) - 1:02}")

    def prepare(self, name):
        row = next(row for row in self.rows if row["id"] == name)
        self.close_menus()
        self.do("mousemove", *self.middle(), pause_s=0.1)
        if name == "add_node":
            self.press("Shift+Home")
            self.what_follows(lambda: self.press("L"), "probe_onto", patience_s=2)
        self.what_follows(lambda: self.press(row["today"].split()[0]), MAKES.get(name, row["action"]), patience_s=2)

    def measure(self):
        x, y = self.middle()
        self.close_menus()
        self.press("F10")          # one pane, with the ball in its middle
        self.do("mousemove", x, y, pause_s=0.2)
        self.press("Shift+Home")
        self.do(pause_s=0.3)
        self.press("Alt+6")
        for at in (x - 20, x + 20):
            self.what_follows(lambda: self.do("mousemove", at, y, "sleep", 0.1, "click", 1, pause_s=0), "measure_at")
        self.press("Alt+1")

    def line(self):
        """Three linked nodes in a row, where no others are; returns the middle one's place."""
        x, y = self.middle()
        self.close_menus()
        for at in (x - 20, x, x + 20):
            self.do("mousemove", at, y + 40, pause_s=0.2)
            self.prepare_at("add_node")
        return x, y + 40

    def cut_a_line(self):
        """Three nodes in a row, of which the middle one is deleted."""
        self.do("mousemove", *self.line(), pause_s=0.2)
        for name in ("deselect", "select_nearest", "delete_selected"):
            self.prepare_at(name)

    def prepare_at(self, name):
        row = next(row for row in self.rows if row["id"] == name)
        if name == "add_node":
            self.what_follows(lambda: self.press("L"), "probe_onto", patience_s=2)
        self.what_follows(lambda: self.press(row["today"].split()[0]), row["action"], patience_s=2)


class Opening(Seen):
    def test_a_click_chooses_nothing_and_escape_closes_all(self):
        """In a window that is lower than its longest menu."""
        self.open_scan(self.write_ball(), "--size", "900x480", preferences={"hints_seen": 3})
        before = len(self.done())
        for title, _ in MENUS:
            self.click_on(title, "##MainMenuBar")
            bar = self.see(title, "##MainMenuBar")["box"]
            first = self.until(lambda: self.seen(window="##Menu_00"), f"menu {title}")[0]
            self.assertGreater(first["box"][1], bar[3], f"{title} covers the pointer")
            self.press("Escape")
            self.see_no_more("", "##Menu_")
        self.click_on("View", "##MainMenuBar")
        self.do("mousemove", *self.middle_of(self.see("Turn the view", "##Menu_00")), pause_s=0)
        self.see("Turn up", "##Menu_01")
        self.press("Escape")       # with the pointer where it would open again
        self.see_no_more("", "##Menu_")
        self.assertEqual(self.done(before), [])
        self.finish()


MENUS = (("File", 12), ("Edit", 3), ("View", 48), ("Paint", 12), ("Trace", 20), ("Probe", 18), ("Tools", 6), ("Help", 3))


def add_test(title, least):
    def test(self):
        self.assertGreaterEqual(self.check_menu(title), least, "entries are missing")
    setattr(Menus, f"test_{title.lower()}", test)


for menu, least in MENUS:
    add_test(menu, least)

if __name__ == "__main__":
    unittest.main()
