"""Entries of every menu, chosen with the mouse: each does what the table of shortcuts says of it (KEYS.md), or the
table below where it has no shortcut. What an action then changes is the workbench's own table
(tests/gpu/workbench/actions_test.cpp). The entries are read from the screen, so that none can be added without being
known here. In each menu one entry of each kind is chosen; test_view_menus_slow.py chooses all."""
import unittest

from seen import Seen, in_short, shortcut_rows
from test_view_keys import FIRST, MAKES
from window import PATIENCE_S

# Before an entry is chosen, where other shortcuts alone do not do it.
PREPARED = {"copy_measurements": "measure", "clear_measurements": "measure", "mend_cut": "cut_a_line",
            "select_segment": "line", "flip_oblique_cut": "cut_obliquely",
            "remove_oblique_cut": "cut_obliquely"}   # by methods of MenuWalk
# Menus within menus, and what entries without a shortcut make: an action, or a dialog that is shown.
INNER = {"Open recent", "Look from", "Kept views", "Panels", "Turn the view", "Move the view", "Distance blending",
         "Cutting planes", "Clip planes", "Touch", "Looks", "Group of the selection", "view 1", "Remove"}
EXPECTED = {
    "Go there": "look_from", "Remove this view": "forget_camera",
}
BY_MENU = {"Look from": "look_from", "Panels": "prefer", "Group of the selection": "group"}   # from every entry
# Entries that say something else than their action, since of their kind there is one for each group or brush.
IN_PAINT = {"set probe.group", "set probe.brush"}
NO_ENTRIES = {"Looks": ["None is saved yet", "Remove"], "view 1": ["view 1", "Rename"],
              "Cutting planes": ["Visible range", "from ", "to ", "x", "y", "z"]}
# They need a pointer over the picture, or stay grey for what they say when pointed at.
WITH_THE_POINTER = {"pivot_at_pointer", "end_measure", "take_back_point"}
AT_LAST = {"quit", "quit_unsaved", "open_example"}
# Their entries are buttons, which leave the menu open.
STAYS_OPEN = {"Turn the view", "Move the view", "Distance blending", "Clip planes"}
AGAIN = {"full_screen", "side_panels", "tool_bar", "volume", "meshes", "guide", "let_go"}
ESCAPED = {"help", "preferences", "messages", "palette", "passes", "open", "focus_panels", "focus_menu", "save_as",
           "open_with_options", "correct_spacing", "import_scan", "export_work", "label_parts", "compare",
           "load_annotation", "operate", "figure", "movie", "keep_look", "threshold_group"}


class MenuWalk(Seen):
    maxDiff = None

    def open_window(self):
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
        self.names = {row["does"] for row in self.rows} | INNER | set(EXPECTED)
        self.do("mousemove", *self.middle(), pause_s=0)
        self.check_key("Ctrl+D", "keep_camera")   # view 1

    def check_menu(self, title, chooses_all):
        """Goes through a menu and those within it, and chooses one entry of each kind, or all."""
        self.wrong, self.chosen, self.tried, self.count = [], [], [], 0
        self.chooses_all = chooses_all
        self.walk([title])
        self.assertEqual(self.wrong, [])
        self.assertEqual(self.tried, self.chosen)
        self.assertGreaterEqual(self.count, dict(MENUS)[title], f"entries of {title} are missing")

    def open_menu(self, path):
        self.close_menus()
        self.click_on(path[0], "##MainMenuBar")
        for depth, title in enumerate(path[1:]):
            # Pointed at, not clicked: where there is little room it opens under the pointer.
            x, y = self.middle_of(self.see(title, f"##Menu_{depth:02}"))
            self.do("mousemove", x - 2, y, "mousemove", x, y, pause_s=0)
            self.until(lambda: self.seen(window=f"##Menu_{depth + 1:02}"), f"menu {path[:depth + 2]}")
        return self.until(lambda: self.seen(window=f"##Menu_{len(path) - 1:02}"), f"menu {path}")

    def close_menus(self):
        if self.seen(window="##Menu_"):
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
        entries = self.entries(path)
        inner = [entry for entry in entries if entry in INNER and path[-1] not in BY_MENU]   # of kept views, too
        kinds = {entry: self.kind_of(path, entry) for entry in entries if entry not in inner}
        self.wrong += [f"{path}: '{entry}' is not known" for entry, kind in kinds.items() if kind == "unknown"]
        there = [entry for entry, kind in kinds.items() if kind not in ("", "unknown")]
        self.count += len(there)
        # The first entry of each kind, if there is one then one that needs nothing before it.
        in_order = sorted(there, key=lambda entry: self.needs_others(path, entry))
        first = {kinds[entry]: entry for entry in reversed(in_order)}
        for entry in entries:
            if entry in inner:
                self.walk([*path, entry])
            elif entry in (there if self.chooses_all else first.values()):
                self.chosen.append([*path, entry])
                self.check_entry(path, entry)

    def row_of(self, entry):
        return next((row for row in self.rows if row["does"] == entry), None)

    def kind_of(self, path, entry):
        """Entries of one kind in one menu are made by the same lines of the program. Empty: it is not chosen here."""
        row = self.row_of(entry)
        if path[-1] == "Open recent" or row and row["id"] in AT_LAST | WITH_THE_POINTER:
            return ""
        if row:
            return "setting" if row["action"].startswith("set ") else "command"
        if entry in EXPECTED:
            return entry
        if path[-1] in BY_MENU:
            return "listed"
        if path == ["Paint"]:
            return "group" if entry[0].isdigit() else "brush"
        return "unknown"

    def needs_others(self, path, entry):
        row = self.row_of(entry)
        return bool(row) and any(row["id"] in those for those in (FIRST, MAKES, AGAIN, ESCAPED, PREPARED))

    def wanted_of(self, path, entry):
        """The actions of which one must follow."""
        row = self.row_of(entry)
        if row:
            return {MAKES.get(row["id"], row["action"])}
        if path[-1] in BY_MENU:
            return {BY_MENU[path[-1]]}
        return {EXPECTED[entry]} if entry in EXPECTED else IN_PAINT

    def check_entry(self, path, entry):
        row = self.row_of(entry)
        name = row["id"] if row else ""
        if name in PREPARED:
            getattr(self, PREPARED[name])()
        for first in FIRST.get(name, ["add_node"] if path[-1] in BY_MENU and path[0] == "Trace" else []):
            self.prepare(first)
        wanted = self.wanted_of(path, entry)
        self.check_choice(path, entry, wanted)
        self.tried.append([*path, entry])
        if name in AGAIN:
            self.see_frames()
            if name == "tool_bar" or not row["today"]:
                self.check_choice(path, entry, wanted)
            else:
                self.check_key(row["today"].split()[0], row["action"])
        if name in ESCAPED:
            self.see_frames()   # what is shown has the keys from the second frame on
            self.press("Escape")
            self.see_frames()

    def check_choice(self, path, entry, wanted):
        before = len(self.done())
        self.choose(path, entry)
        if not self.soon(lambda: wanted & self.made(before), PATIENCE_S):
            made = sorted(self.made(before))
            self.wrong.append(f"{' > '.join([*path, entry])} made {made}; expected {sorted(wanted)}")

    def made(self, before):
        return {in_short(action) for action in self.done(before)}

    def choose(self, path, entry):
        self.open_menu(path)
        self.click_on(entry, f"##Menu_{len(path) - 1:02}")
        if path[-1] not in STAYS_OPEN:
            self.see_no_more("", "##Menu_")

    def prepare(self, name):
        self.close_menus()
        self.do("mousemove", *self.middle(), pause_s=0)
        if name == "add_node":
            self.check_key("Shift+Home", "reset_view")
        self.press_shortcut(name)

    def press_shortcut(self, name):
        """Where the pointer is."""
        row = next(row for row in self.rows if row["id"] == name)
        if name == "add_node":
            self.check_key("L", "probe_onto")
        self.press_first(row["today"].split()[0], MAKES.get(name, row["action"]))

    def measure(self):
        x, y = self.middle()
        self.close_menus()
        self.press_first("F10", "set view.arrangement")   # one pane, with the ball in its middle
        self.do("mousemove", x, y, pause_s=0)
        self.check_key("Shift+Home", "reset_view")
        self.see_frames()
        self.press_first("Alt+6", "set probe.tool")
        for at in (x - 20, x + 20):
            self.check_follows(lambda: self.do("mousemove", at, y, "sleep", 0.1, "click", 1, pause_s=0), "measure_at")
        self.check_key("Alt+1", "set probe.tool")

    def line(self):
        """Three linked nodes in a row, where no others are; returns the middle one's place."""
        x, y = self.middle()
        self.close_menus()
        for at in (x - 20, x, x + 20):
            self.do("mousemove", at, y + 40, pause_s=0)
            self.press_shortcut("add_node")
        return x, y + 40

    def cut_obliquely(self):
        self.check_follows(lambda: self.choose(["View", "Cutting planes"], "Oblique cutting plane, facing the view"),
                           "oblique_cut")

    def cut_a_line(self):
        """Three nodes in a row, of which the middle one is deleted."""
        self.do("mousemove", *self.line(), pause_s=0)
        for name in ("deselect", "select_nearest", "delete_selected"):
            self.press_shortcut(name)


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


# And how many entries each has at least, in those within it, too.
MENUS = (("File", 12), ("Edit", 3), ("View", 48), ("Paint", 12), ("Trace", 20), ("Probe", 18), ("Tools", 6),
         ("Help", 4))


class Menus(MenuWalk):
    def test_each_kind_of_entry_of_each_menu_does_what_the_table_says(self):
        self.open_window()
        for title, _ in MENUS:
            with self.subTest(title):
                self.check_menu(title, chooses_all=False)
        self.finish()


if __name__ == "__main__":
    unittest.main()
