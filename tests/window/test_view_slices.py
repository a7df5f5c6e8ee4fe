"""Slices that are zoomed, moved and stepped through, and what else hands do at panels: groups that are dragged and
renamed, density that is painted, points of the curve without a mouse on it, pictures with a scale bar."""
import json
import re
import unittest

from seen import Seen, in_short
from window import WINDOW


class Slices(Seen):
    def scan(self, preferences=None):
        session = self.write_ball()
        self.open_scan(session, preferences=preferences or {"hints_seen": 3})
        return session

    def in_slice(self):
        """A place in the slice across z, which is at the upper right."""
        x, y = self.middle()
        return x + 140, y - 130

    def wheel(self, button, *modifiers):
        keys = [part for modifier in modifiers for part in ("keydown", modifier)]
        released = [part for modifier in modifiers for part in ("keyup", modifier)]
        self.do(*keys, "click", button, *released, pause_s=0)

    def click_does(self, wanted, text, window=None):
        self.check_follows(lambda: self.click_on(text, window), wanted)

    def test_slices_are_zoomed_moved_stepped_through_and_fitted(self):
        session = self.scan()
        self.press("F6")
        self.see("z ")
        self.see_picture()
        self.do("mousemove", *self.in_slice(), pause_s=0)
        self.see_frames()
        self.assertEqual(set(self.what_follows(lambda: self.wheel(4), "push_probe")), {"push_probe"})
        for _ in range(6):
            self.assertIn("zoom", self.what_follows(lambda: self.wheel(4, "ctrl"), "zoom"))
        x, y = self.in_slice()
        moved = self.what_follows(lambda: self.do("mousedown", 2, "mousemove", x + 20, y + 9, "mouseup", 2, pause_s=0),
                                  "drag_in_map")
        self.assertNotIn("move_view", moved)
        kept = self.saved(session)["view"]["slices"]
        self.assertAlmostEqual(kept["zoom"], 1.12 ** 6, places=3)
        self.assertEqual(len(kept["center"]), 3)
        z = json.loads(session.read_text())["probe"]["voxel"][2]
        self.check_key("Right", "push_probe")
        self.check_key("Alt+Down", "push_probe")
        self.assertAlmostEqual(abs(self.saved(session)["probe"]["voxel"][2] - z), 1.0, places=6)
        self.check_key("Home", "fit_view")
        self.assertEqual(self.saved(session)["view"]["slices"]["zoom"], 1.0)
        self.finish()

    def test_the_bar_tells_what_the_mouse_does_over_each_pane(self):
        self.scan()
        self.press("F6")
        self.see("z ")
        self.do("mousemove", *self.in_slice(), pause_s=0)
        self.see("Mouse  left: set the cross-hairs, ...", "Tools")   # whole parts
        self.do("mousemove", *self.middle_of(self.see_at_rest("Mouse", "Tools")), pause_s=0)
        self.see("Over a slice, left: set the cross-hairs", "##Tooltip")
        self.see_frames()
        told = " ".join(seen["text"] for seen in self.seen(window="##Tooltip"))
        for words in ("Over the volume, left: turn", "wheel: next slice", "Ctrl + wheel: zoom"):
            self.assertIn(words, told)
        self.finish()

    def slices(self):
        """The numbers of the slices that their panes state, by axis."""
        return {seen["text"][0]: int(seen["text"].split()[1]) for seen in self.seen()
                if re.match("[xyz] [0-9]+ \\(0 to ", seen["text"])}

    def test_slices_follow_a_click_and_shift_but_no_mere_motion(self):
        self.scan()
        self.press("F6")
        self.see("z ")
        self.see_picture()
        before = self.slices()
        x, y = self.middle()
        places = [(x - 130, y - 120), (x - 100, y - 100), *((x + 90 + step, y - 130) for step in (0, 40, 80)), (x + 130, y + 90)]
        for tool in ("alt+1", "alt+2"):   # turn, paint
            self.do("key", tool, pause_s=0)
            for place in places:
                self.check_follows(lambda place=place: self.do("mousemove", *place, pause_s=0),
                                   "probe_to" if tool == "alt+1" else "place_probe")
                self.see_picture()
                self.assertEqual(self.slices(), before, (tool, place))
        self.do("key", "alt+1", pause_s=0)
        # A click in the slice across z moves the two others.
        self.do("mousemove", x + 150, y - 150, "click", 1, pause_s=0)
        after = self.until(lambda: self.slices() != before and self.slices(), "other slices")
        self.assertEqual(after["z"], before["z"])
        self.assertNotEqual(after["x"], before["x"])
        self.assertNotEqual(after["y"], before["y"])
        # With Shift the pointer leads them, over the volume, too.
        self.do("keydown", "shift", "mousemove", x - 135, y - 115, "mousemove", x - 130, y - 110, "keyup", "shift", pause_s=0)
        self.until(lambda: self.slices() != after, "slices that follow")
        self.finish()

    def test_a_cut_takes_two_clicks(self):
        session = self.scan()
        self.click_does("set view.cut_box", "Clip box", "Tools")
        self.see_picture()
        self.assertNotIn("cut", json.loads(session.read_text()))
        bottom = self.bottom_handle()
        self.check_drag(bottom, [(bottom[0], bottom[1] - 20 * step) for step in (1, 2, 3)], "set cut.lower")
        cut = self.saved(session)["cut"]
        self.assertGreater(cut["lower"][2], 5)
        self.assertEqual(cut["lower"][:2], [0, 0])
        self.finish()

    def pink_rows(self, x):
        """The rows of a column in which the oblique plane's lines and handles are, from the top."""
        _, _, rows = self.pixels()
        at = lambda row, channel: rows[row][3 * x + channel]
        return [row for row in range(90, WINDOW[1] - 40)
                if min(at(row, 0), at(row, 2)) > at(row, 1) + 60 and at(row, 2) > 150]

    def test_an_oblique_plane_is_added_moved_tilted_and_removed(self):
        session = self.scan()
        self.click_does("oblique_cut", "Cut plane", "Tools")
        self.see_picture()
        facing = self.saved(session)["cut"]
        x, y = self.middle()
        # Below the middle, since the normal points at the viewer: a drag upwards pushes the plane away.
        below = [row for row in self.pink_rows(x) if row > y + 20]
        ends = [row for row, after in zip(below, below[1:] + [WINDOW[1]]) if after > row + 8]
        self.assertTrue(ends)
        handle = x, ends[0] - 5   # a ring with a line to it
        self.check_drag(handle, [(x, handle[1] - 8 * step) for step in (1, 2, 3)], "set cut.plane_point")
        moved = self.saved(session)["cut"]
        self.assertEqual(moved["plane_normal"], facing["plane_normal"])
        way = [b - a for a, b in zip(facing["plane_point"], moved["plane_point"])]
        self.assertLess(sum(a * b for a, b in zip(way, facing["plane_normal"])), -1.0)
        # The tip of the normal is in the middle of the picture, below that of the window.
        y = next(row for row in self.pink_rows(x) if row > y - 20) + 5
        self.do("mousemove", x + 3, y, pause_s=0)
        self.see("tilt the plane")
        self.check_drag((x, y), [(x + 12 * step, y - 4 * step) for step in (1, 2, 3)], "set cut.plane_normal")
        tilted = self.saved(session)["cut"]
        self.assertEqual(tilted["plane_point"], moved["plane_point"])
        cosine = sum(a * b for a, b in zip(tilted["plane_normal"], facing["plane_normal"]))
        self.assertGreater(cosine, 0.1)
        self.assertLess(cosine, 0.99)
        # One undone step takes a whole drag back.
        self.check_key("ctrl+z", "undo")
        self.assertEqual(self.saved(session)["cut"], moved)
        self.click_does("oblique_cut", "Cut plane", "Tools")
        self.assertNotIn("plane_normal", self.saved(session).get("cut", {}))
        self.finish()

    def bottom_handle(self):
        """The lowest place below the middle of the picture where a handle's blue ring is."""
        x, y = self.middle()
        _, _, rows = self.pixels()
        blue = [row for row in range(y + 60, WINDOW[1] - 40) if rows[row][3 * x + 2] > rows[row][3 * x] + 80]
        self.assertTrue(blue)
        return x, (min(blue) + max(blue)) // 2

    def test_a_group_is_renamed_and_dragged_below_another(self):
        session = self.scan()
        x, y = self.middle_of(self.see_at_rest("2  group 2", "Side panel"))
        self.do("mousemove", x, y, "click", 1, "click", 1, pause_s=0)
        self.see("Belongs to no group")
        self.see_frames()   # the field has the keys from the second one on
        self.do("key", "ctrl+a", "type", "vein", pause_s=0)
        self.see("vein")
        self.press("Enter")
        self.see("2  vein")
        x, y = self.middle_of(self.see("2  vein", "Side panel"))
        to_x, to_y = self.middle_of(self.see("1  group 1", "Side panel"))
        self.check_drag((x, y), [(x + (to_x - x) * step // 8, y + (to_y - y) * step // 8)
                                 for step in range(1, 9)], "set groups.2.parent")
        group = self.saved(session)["groups"]["2"]
        self.assertEqual((group["name"], group["parent"]), ("vein", 1))
        # Which the menu of the right button takes back.
        self.click_on("2  vein", "Side panel", button=3)
        self.click_does("set groups.2.parent", "Belongs to no group")
        self.press("Escape")
        self.see_no_more("Belongs to no group")
        self.assertEqual(self.saved(session)["groups"]["2"].get("parent", 0), 0)
        self.finish()

    def test_points_of_the_curve_are_chosen_added_and_removed_without_the_mouse_on_it(self):
        session = self.scan()
        count = len(self.kept_points(session))
        self.click_does("set transfer_function.points", "+", "Side panel")
        self.assertEqual(len(self.saved(session)["transfer_function"]["points"]), count + 1)
        self.click_on("<", "Side panel")
        self.click_does("set transfer_function.points", "-", "Side panel")
        left = self.saved(session)["transfer_function"]["points"]
        self.assertEqual(len(left), count)
        self.assertNotEqual(left[0]["intensity"], 100)   # the first is what was removed
        self.finish()

    def test_a_window_comes_back_where_it_was_left(self):
        self.scan({"hints_seen": 3, "keys": {"messages": {"keys": "Ctrl+M"}}})
        self.press("Ctrl+M")
        x, y = self.middle_of(self.see_at_rest("Messages", "Messages"))
        self.check_drag((x, y), [(x - 4 * step, y + 6 * step) for step in range(1, 7)], "prefer")
        kept = self.until(self.kept_windows, "place of the window in the preferences")
        self.press("Ctrl+M")
        self.see_no_more("Messages", "Messages")
        self.press("Ctrl+M")
        at = self.middle_of(self.see_at_rest("Messages", "Messages"))
        self.assertLess(abs(at[0] - (x - 24)) + abs(at[1] - (y + 36)), 8, kept)
        self.finish()

    def kept_windows(self):
        layout = json.loads((self.configuration / "preferences.json").read_text()).get("layout", {})
        return layout.get("windows", {}).get("messages")

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
