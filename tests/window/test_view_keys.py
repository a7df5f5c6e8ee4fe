"""Keys of both sets, pressed on a real keyboard: each does what KEYS.md says of it. That table is the program's
(tests/unit/ui/keys_table_test.cpp), and what an action then changes is the workbench's own table
(tests/gpu/workbench/actions_test.cpp). Here each kind of chord is pressed; test_view_keys_slow.py presses all of
them."""
import re
import unittest

from seen import Seen, shortcut_rows

# Shortcuts pressed every day, in this order: each set's cover all its modifiers and all kinds of keys.
EVERY_DAY = {
    "today": ["volume", "guide", "keep_view", "kept_view_1", "group_7", "larger_brush", "move_left", "tool_paint",
              "paint", "probe_left", "deselect", "regroup_0", "stereo", "palette"],
    "thesis": ["arrow", "near_x_in", "near_x_out", "redo", "smaller_brush", "next_guidance", "eraser", "full_screen",
               "probe_up", "more_blending", "regroup_0", "next_mode"],
}

# Shortcuts, by id, that must be pressed first to give a shortcut something to act on.
FIRST = {
    "redo": ["undo"], "pivot_at_pointer": ["single_view"], "step_back": ["tool_paint"],
    "single_view": ["slices"], "tool_turn": ["tool_paint"],
    "group_1": ["group_2"], "less_blending": ["more_blending"], "stronger": ["weaker"], "select_nearest": ["deselect"],
    "select_segment": ["select_nearest"], "drag_node": ["select_nearest"], "look_at_selection": ["add_node"],
    "undo": ["add_node"], "deselect": ["add_node"], "delete_selected": ["add_node"],
    "link_nearest": ["deselect", "add_node"],
    "larger_selected": ["add_node"], "smaller_selected": ["add_node"], "larger_nodes": ["add_node"],
    "smaller_nodes": ["add_node"], "next_node": ["add_node"], "previous_node": ["add_node"],
    **{f"regroup_{group}": ["add_node"] for group in range(1, 10)},
}
# The resulting action where the table cannot know it: in the table's state the shortcut has nothing left to set.
MAKES = {"step_back": "set probe.tool", "single_view": "set view.arrangement", "tool_turn": "set probe.tool",
         "group_1": "set probe.group", "less_blending": "set blend.size",
         "stronger": "set probe.touch.strength", "threshold_here": "set probe.paint_threshold"}
# Shortcuts that need a path that is begun.
OF_A_PATH = {"end_measure", "take_back_point"}
# Shortcuts that only ever answer with a sentence.
REFUSED = {"regroup_0": "roup 0 is the eraser"}
# Shortcuts that open a window which takes keys or hides what follows: pressed again, or closed by Escape.
TWICE = {"help", "preferences", "full_screen", "guide", "volume", "meshes"}
ESCAPED = {"palette": "Find anything", "open": "Open a volume", "focus_panels": "", "focus_menu": "",
           "save_as": "Continue under", "load_annotation": "Load annotation", "import_scan": "Import as project",
           "export_work": "Export annotation"}   # window of each


def kind_of(chord):
    """Modifiers, and what kind of key it is."""
    *modifiers, key = re.split(r"\+(?=.)", chord)
    kinds = (("letter", r"[A-Z]"), ("digit", r"[0-9]"), ("function", r"F[0-9]+"), ("arrow", "Left|Right|Up|Down"),
             ("named", r"\w{2,}"), ("sign", "."))
    return tuple(modifiers), next(kind for kind, pattern in kinds if re.fullmatch(pattern, key))


class KeySet(Seen):
    """One column of the table, in one window."""

    def check_set(self, column, key_set, chosen=None):
        """`chosen`: ids of the shortcuts to press; none: all."""
        session = self.write_ball(volume={"procedural": "sphere", "size": [32, 32, 32]},
                                  light={"occlusion": {"strength": 0.3, "automatic": False}},
                                  interaction={"screenshot_scale": 1},
                                  probe={"radius_voxels": 3, "group": 3, "paint_threshold": 120, "measure": "path"})
        self.open_scan(session, preferences={"key_set": key_set, "hints_seen": 3})
        x, y = self.middle()
        self.do("mousemove", x - 5, y, "mousemove", x, y, pause_s=0)
        self.table = {row["id"]: row for row in shortcut_rows()}
        wrong, pressed = [], []
        for row in [self.table[name] for name in chosen] if chosen else self.table.values():
            for chord in self.chords(row, column):
                pressed.append(chord)
                found = self.check_row(row, chord, column)
                if found is not None:
                    wrong.append(f"{row['id']}: {chord} made {found}; expected {self.makes(row)}")
        report = self.finish()
        last = [action for action in self.done() if action["op"] != "end_step"][-1]   # it may end a step of settings
        self.assertEqual(last, {"op": "quit", "saves": True})
        self.assertEqual(wrong, [], report["messages"][-30:])
        for sentence in REFUSED.values():
            self.assertIn(sentence, "\n".join(report["messages"]))
        self.check_kinds(column, [*pressed, "Ctrl+Q"])

    @staticmethod
    def chords(row, column):
        """Its keys; the stylus has none (tests/gpu/workbench/save_test.cpp presses its buttons)."""
        return [chord for chord in row[column].split() if not chord.startswith("Stylus")]

    def check_kinds(self, column, pressed):
        """No modifiers and no kind of key is in that column that was not pressed."""
        every = {kind_of(chord) for row in self.table.values() for chord in self.chords(row, column)}
        tried = {kind_of(chord) for chord in pressed}
        for part in (0, 1):
            self.assertEqual({kind[part] for kind in every}, {kind[part] for kind in tried})

    def makes(self, row):
        return MAKES.get(row["id"], row["action"])

    def run_shortcut(self, name, column):
        row = self.table[name]
        if name == "add_node":   # where the volume is seen
            self.check_key("Shift+Home", "reset_view")
            self.check_key("L", "probe_onto")
        self.assertTrue(row[column], f"{name} has no key in this set, and prepares others")
        self.press_first(row[column].split()[0], self.makes(row))

    def check_row(self, row, chord, column):
        """None, or what the chord made instead."""
        name = row["id"]
        if name == "quit":   # the last thing
            return None
        if name == "kept_view_1":   # there are nine views to be looked from
            for _ in range(9):
                self.run_shortcut("keep_view", column)
        if name == "copy_measurements":
            self.begin_path()
            self.check_key("Enter", "end_measure")
            self.press("Alt+1")
        if name in OF_A_PATH:
            self.begin_path()
        if name == "mend_cut":
            self.cut_a_line(column)
        for first in FIRST.get(name, []):
            self.run_shortcut(first, column)
        if name in REFUSED:
            self.press(chord)
            return None
        found = self.what_follows(lambda: self.press(chord), self.makes(row))
        if name in OF_A_PATH:
            self.press("Alt+1")
        if name in TWICE:
            self.check_key(chord, self.makes(row))
        if name in ESCAPED:
            shown = ESCAPED[name]
            if shown:
                self.see("", shown)
            self.see_frames()   # what is shown has the keys from the second frame on
            self.press("Escape")
            if shown:
                self.see_no_more("", shown)
        return None if self.makes(row) in found else found

    def begin_path(self):
        """Two points of a path, with the tool for measuring."""
        x, y = self.middle()
        self.press("Alt+6")
        for at in (x - 20, x + 20):
            self.what_follows(lambda: self.do("mousemove", at, y, "sleep", 0.1, "click", 1, pause_s=0), "measure_at")
        self.do("mousemove", x, y, pause_s=0)

    def cut_a_line(self, column):
        """Three nodes in a row, of which the middle one is deleted."""
        x, y = self.middle()
        for at in (x - 20, x, x + 20):
            self.do("mousemove", at, y, pause_s=0)
            self.run_shortcut("add_node", column)   # in turn, at other places
        self.do("mousemove", x, y, pause_s=0)
        self.run_shortcut("deselect", column)
        self.run_shortcut("select_nearest", column)
        self.run_shortcut("delete_selected", column)


class Keys(KeySet):
    def test_each_kind_of_key_of_today_does_what_the_table_says(self):
        self.check_set("today", "modern", EVERY_DAY["today"])

    def test_each_kind_of_key_of_the_thesis_does_what_the_table_says(self):
        self.check_set("thesis", "thesis", EVERY_DAY["thesis"])


if __name__ == "__main__":
    unittest.main()
