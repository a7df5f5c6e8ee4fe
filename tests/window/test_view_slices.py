"""Slices that are zoomed, moved and stepped through, and what else hands do at panels: groups that are dragged and
renamed, density that is painted, points of the curve without a mouse on it, pictures with a scale bar."""
import json
import unittest

from seen import Seen, in_short


class Slices(Seen):
    def scan(self, preferences=None):
        session = self.write_ball()
        self.open_scan(session, preferences=preferences)
        return session

    def in_slice(self):
        """A place in the slice across z, which is at the upper right."""
        x, y = self.middle()
        return x + 140, y - 130

    def wheel(self, button, *modifiers):
        keys = [part for modifier in modifiers for part in ("keydown", modifier)]
        released = [part for modifier in modifiers for part in ("keyup", modifier)]
        self.do(*keys, "click", button, *released)

    def click_does(self, wanted, text, window=None):
        self.assertIn(wanted, self.what_follows(lambda: self.click_on(text, window), wanted))

    def kept(self, session):
        before = session.read_text()
        self.press("Ctrl+S")
        self.until(lambda: session.read_text() != before, "saved session")
        return json.loads(session.read_text())

    def test_slices_are_zoomed_moved_stepped_through_and_fitted(self):
        session = self.scan()
        self.press("F6")
        self.see("z ")
        self.do("mousemove", *self.in_slice())
        self.assertEqual(set(self.what_follows(lambda: self.wheel(4), "push_probe")), {"push_probe"})
        for _ in range(6):
            self.assertIn("zoom", self.what_follows(lambda: self.wheel(4, "ctrl"), "zoom"))
        x, y = self.in_slice()
        moved = self.what_follows(lambda: self.do("mousedown", 2, "mousemove", x + 20, y + 9, "mouseup", 2),
                                  "drag_in_map")
        self.assertNotIn("move_view", moved)
        kept = self.kept(session)["view"]["slices"]
        self.assertAlmostEqual(kept["zoom"], 1.12 ** 6, places=3)
        self.assertEqual(len(kept["center"]), 3)
        z = json.loads(session.read_text())["probe"]["voxel"][2]
        self.what_follows(lambda: self.press("Alt+Down"), "push_probe")
        self.what_follows(lambda: self.press("Right"), "push_probe")
        self.assertAlmostEqual(abs(self.kept(session)["probe"]["voxel"][2] - z), 1.0, places=6)
        self.what_follows(lambda: self.press("Home"), "fit_view")
        self.assertEqual(self.kept(session)["view"]["slices"]["zoom"], 1.0)
        self.finish()

    def test_a_group_is_renamed_and_dragged_below_another(self):
        session = self.scan()
        x, y = self.middle_of(self.see_at_rest("2  group 2", "Side panel"))
        self.do("mousemove", x, y, "click", 1, "click", 1)
        self.see("Belongs to no group")
        self.do("key", "ctrl+a", "type", "vein")
        self.do("key", "Return")
        self.see("2  vein")
        x, y = self.middle_of(self.see("2  vein", "Side panel"))
        to_x, to_y = self.middle_of(self.see("1  group 1", "Side panel"))
        self.do("mousemove", x, y, "mousedown", 1, pause_s=0.2)
        for step in range(1, 9):
            self.do("mousemove", x + (to_x - x) * step // 8, y + (to_y - y) * step // 8, pause_s=0.05)
        self.what_follows(lambda: self.do("mouseup", 1), "set groups.2.parent")
        group = self.kept(session)["groups"]["2"]
        self.assertEqual((group["name"], group["parent"]), ("vein", 1))
        # Which the menu of the right button takes back.
        self.click_on("2  vein", "Side panel", button=3)
        self.click_does("set groups.2.parent", "Belongs to no group")
        self.do("key", "Escape", pause_s=0.3)
        self.assertEqual(self.kept(session)["groups"]["2"].get("parent", 0), 0)
        self.finish()

    def test_points_of_the_curve_are_chosen_added_and_removed_without_the_mouse_on_it(self):
        session = self.scan()
        count = len(self.kept_points(session))
        self.click_does("set transfer_function.points", "+", "Side panel")
        self.assertEqual(len(self.kept(session)["transfer_function"]["points"]), count + 1)
        self.click_on("<", "Side panel")
        self.click_does("set transfer_function.points", "-", "Side panel")
        left = self.kept(session)["transfer_function"]["points"]
        self.assertEqual(len(left), count)
        self.assertNotEqual(left[0]["intensity"], 100)   # the first is what was removed
        self.finish()

    def test_a_window_comes_back_where_it_was_left(self):
        self.scan({"hints_seen": 3, "keys": {"messages": {"keys": "Ctrl+M"}}})
        self.press("Ctrl+M")
        x, y = self.middle_of(self.see_at_rest("Messages", "Messages"))
        self.do("mousemove", x, y, pause_s=0.2)
        self.do("mousedown", 1, pause_s=0.2)
        for step in range(1, 7):
            self.do("mousemove", x - 4 * step, y + 6 * step, pause_s=0.05)
        self.what_follows(lambda: self.do("mouseup", 1), "prefer")
        kept = json.loads((self.configuration / "preferences.json").read_text())["layout"]["windows"]["messages"]
        self.press("Ctrl+M")
        self.see_no_more("Messages", "Messages")
        self.press("Ctrl+M")
        at = self.middle_of(self.see_at_rest("Messages", "Messages"))
        self.assertLess(abs(at[0] - (x - 24)) + abs(at[1] - (y + 36)), 8, kept)
        self.finish()

    @staticmethod
    def kept_points(session):
        return json.loads(session.read_text())["transfer_function"]["points"]

    def test_a_picture_has_a_scale_bar_where_that_is_wanted(self):
        session = self.scan()
        pictures = []
        for _ in range(2):
            name = session.parent / f"{session.stem}-view-{len(pictures) + 1}.png"
            self.press("F12")
            self.until(name.exists, "picture")
            pictures.append(name.read_bytes())
            self.click_on("File")
            self.click_does("set interaction.screenshot_marks", "Scale bar, axes, groups in screenshots")
        self.assertTrue(pictures[0] != pictures[1], [in_short(action) for action in self.done()])
        self.finish()


if __name__ == "__main__":
    unittest.main()
