"""Keys of the thesis and widgets of the side panel, by real events: what they ask for is in the log of actions."""
import json
import unittest

from harness import Volume
from seen import Seen, only_panel
from window import SIDE_PANEL, WINDOW


class Widgets(Seen):
    def view_ball(self, *arguments, **preferences):
        self.open_scan(self.write_ball(), *arguments, preferences={"hints_seen": 3, **preferences})
        self.do("mousemove", *self.middle(), pause_s=0)

    def settings(self):
        """What was set, in order."""
        lines = [json.loads(line) for line in self.log.read_text().splitlines()]
        return [line["values"] for line in lines if line["op"] == "set"]

    def hold(self, *keys):
        """Until the workspace has been scaled by several steps."""
        before = len(self.settings())
        self.do(*[word for key in keys for word in ("keydown", key)], pause_s=0)
        self.until(lambda: len(self.settings()) >= before + 3, f"three steps by {keys}")
        self.do(*[word for key in reversed(keys) for word in ("keyup", key)], pause_s=0)

    def test_keys_switch_what_is_shown_and_scale_the_workspace(self):
        self.view_ball()
        for key, setting in (("F2", "view.volume"), ("F3", "view.meshes"), ("F2", "view.volume"), ("F3", "view.meshes"),
                             ("Shift+F1", "probe.arrow")):
            self.check_key(key, f"set {setting}")
        self.hold("F7")
        report = self.finish()
        self.assertEqual(self.settings()[:5], [{"view": {"volume": False}}, {"view": {"meshes": False}},
                                               {"view": {"volume": True}}, {"view": {"meshes": True}},
                                               {"probe": {"arrow": False}}])
        scales = [values["interaction"]["workspace_scale"] for values in self.settings()[5:]]
        self.assertTrue(scales and all(1.0 < a < b for a, b in zip(scales, scales[1:])), scales)
        self.assertIn("The volume is not drawn, except in slices", report["messages"])

    def test_the_thesis_keys_are_those_that_it_prints(self):
        self.view_ball(key_set="thesis")
        self.check_key("F1", "set probe.arrow")
        self.hold("ctrl", "F7")
        report = self.finish()
        self.assertEqual(self.settings()[0], {"probe": {"arrow": False}})
        self.assertLess(self.settings()[-1]["interaction"]["workspace_scale"], 1.0)
        self.assertIn("Arrow towards the probe off", report["messages"])

    def test_the_wheel_over_the_curve_shifts_all_points_and_slowly_with_shift(self):
        self.view_ball()
        x, y = WINDOW[0] - 160, round(self.see_at_rest("paint", "Side panel")["box"][3] + 3 * self.FONT)
        self.see("255", "Side panel")   # the end of the axis
        self.do("mousemove", x, y, pause_s=0)
        self.see("Intensity 1", "Side panel")   # what is under the pointer, near the middle
        self.check_follows(lambda: self.do("click", 4, pause_s=0), "set transfer_function.points")
        self.see_frames()
        self.do("keydown", "shift", pause_s=0)
        self.see_frames()
        self.check_follows(lambda: self.do("click", 4, pause_s=0), "set transfer_function.points")
        self.do("keyup", "shift", pause_s=0)
        self.finish()
        shifted = [values["transfer_function"]["points"] for values in self.settings() if "transfer_function" in values]
        self.assertEqual([p["intensity"] for p in shifted[0]], [103, 163, 258])  # a hundredth of 255, in whole numbers
        self.assertEqual([p["intensity"] for p in shifted[-1]], [104, 164, 259])

    # ---- Fine drags

    FONT = 14                    # pixels, as it ships
    HEIGHT = 150 - 1.3 * FONT    # height of the curve's axes, from opacity 0 to 1

    def open_panel(self, panel, **keys):
        self.open_scan(self.write_ball(**keys), preferences=only_panel(panel))

    def test_keys_over_the_picture_stay_shortcuts_after_a_click_in_a_panel(self):
        self.open_panel("light")
        self.click_on("Grey", "Side panel")
        self.do("mousemove", *self.middle(), pause_s=0)
        self.see_frames()
        for key, action in (("Left", "push_probe"), ("Right", "push_probe"), ("Home", "fit_view"),
                            ("Alt+Down", "push_probe"), ("Space", "set probe.guided")):
            self.check_key(key, action)
        self.assertNotIn("folded", self.log.read_text())
        self.finish()

    def drag(self, begin, by, *, finely=False, tail=()):
        """By so many pixels, with Shift where it is to be fine."""
        way = [(begin[0] + by[0] * step // 5, begin[1] + by[1] * step // 5) for step in range(1, 6)]
        before = len(self.settings())
        for event in (["mousemove", *begin], ["mousedown", 1], ["keydown", "shift"] if finely else [],
                      *(["mousemove", *place] for place in way), tail, ["mouseup", 1],
                      ["keyup", "shift"] if finely else []):
            if event:
                self.do(*event, pause_s=0)
                self.see_frames()
        self.until(lambda: len(self.settings()) > before, "what was dragged in the log")
        known = -1
        while known != len(self.settings()):   # the last place may be logged some frames later
            known = len(self.settings())
            self.see_frames()

    def last(self, *keys):
        """The value that was set last."""
        found = self.settings()
        values = [value for value in found if keys[0] in value]
        value = values[-1]
        for key in keys:
            value = value[key]
        return value

    def test_points_and_lines_of_the_curve_are_dragged_a_tenth_as_far_with_shift(self):
        # Where two lines coincide, the paint threshold is dragged, below their words.
        self.open_panel("transfer_function", probe={"paint_threshold": 120, "haptic_threshold": 120})
        word = self.see("paint")
        top = word["box"][1] - self.FONT / 4
        x = round(word["box"][0] - self.FONT / 4)
        # The threshold's line: as far as the mouse, and then a tenth of it.
        low = round(top + 0.7 * self.HEIGHT)
        self.drag((x, low), (40, 0))
        far = self.last("probe", "paint_threshold") - 120
        per_pixel = far / 40
        self.drag((x + 40, low), (40, 0), finely=True)
        near = self.last("probe", "paint_threshold") - 120 - far
        self.assertGreater(far, 20)
        self.assertAlmostEqual(near, far / 10, delta=1.5)   # thresholds of whole numbers
        # Its word is dragged as the line is.
        before = self.last("probe", "paint_threshold")
        self.drag(self.middle_of(self.see("paint")), (-20, 0))
        self.assertAlmostEqual(self.last("probe", "paint_threshold") - before, -20 * per_pixel, delta=2)
        # The point at 160 and 0.9, which lies where that tells.
        point = (round(x + (160 - 120) / per_pixel), round(top + self.HEIGHT * (1 - 0.9 ** 0.5)))
        self.drag(point, (20, 10))
        once = self.last("transfer_function", "points")[1]
        self.drag((point[0] + 20, point[1] + 10), (20, 10), finely=True)
        twice = self.last("transfer_function", "points")[1]
        self.assertAlmostEqual(once["intensity"] - 160, 20 * per_pixel, delta=2)
        self.assertAlmostEqual(twice["intensity"] - once["intensity"], 2 * per_pixel, delta=0.3)
        self.assertAlmostEqual(once["opacity"] ** 0.5 - twice["opacity"] ** 0.5, 1 / self.HEIGHT, delta=0.003)
        # Shift may be let go of on the way: nothing jumps.
        self.drag((point[0] + 22, point[1] + 11), (20, 0), finely=True, tail=("keyup", "shift"))
        self.assertAlmostEqual(self.last("transfer_function", "points")[1]["intensity"] - twice["intensity"],
                               2 * per_pixel, delta=0.3)
        self.finish()

    def test_numbers_and_sliders_are_dragged_a_tenth_as_far_with_shift(self):
        self.open_panel("transfer_function")
        number = self.middle_of(self.until(lambda: self.after("Intensity"), "number of the intensity"))
        self.drag(number, (-50, 0))
        before, once = 100, self.last("transfer_function", "points")[0]["intensity"]
        self.drag(number, (-50, 0), finely=True)
        twice = self.last("transfer_function", "points")[0]["intensity"]
        self.assertLess(once, before - 10)
        self.assertAlmostEqual(once - twice, (before - once) / 10, delta=0.2)
        # The handle of a slider follows the mouse; from where it was taken with Shift only a tenth of the way.
        x, y = self.middle_of(self.after("Volume"))
        self.drag((x, y), (40, 0))
        at_mouse = self.last("unpainted", "opacity")
        self.drag((x, y), (40, 0), finely=True)
        finely = self.last("unpainted", "opacity")
        self.drag((x, y), (1, 0))
        begin = self.last("unpainted", "opacity")
        self.assertGreater(at_mouse - begin, 0.1)
        self.assertAlmostEqual(finely - begin, (at_mouse - begin) / 10, delta=0.03)
        self.finish()

    def test_distance_blending_ends_where_all_of_the_far_end_is_the_other_colour(self):
        self.open_panel("light")
        self.drag(self.middle_of(self.until(lambda: self.after("Blend size"), "the size of blending")), (500, 0))
        self.until(lambda: self.last("blend", "size") == 1, "all of the far end in the other colour")
        self.finish()

    def test_escape_closes_the_colour_picker_and_nothing_else(self):
        self.open_panel("groups")
        self.press("Alt+2")
        self.see("Paint (left: paint", "Status")
        left, _, _, _ = self.see("See")["box"]          # its column is right of the colours
        bottom = self.see("0  unpainted")["box"][3]
        row = next(seen["box"] for seen in self.seen("3  group 3") if seen["box"][1] > bottom)   # not in the tool bar
        self.do("mousemove", round(left - self.FONT), round((row[1] + row[3]) / 2), "sleep", 0.2, "mousedown", 1,
                "sleep", 0.1, "mouseup", 1, pause_s=0)
        self.until(lambda: self.seen(window="##Popup"), "colour picker")
        self.press("Escape")
        self.see_no_more("", "##Popup")
        self.assertEqual([action for action in self.done() if action["op"] == "set"][1:], [], "the tool stays")
        self.press("Escape")
        self.see("Turn (left: turn", "Status")
        self.finish()

    def test_what_is_drawn_over_the_picture_is_switched_in_its_panel(self):
        self.open_panel("aids")
        for words, key in (("Scale bar", "scale_bar"), ("Axes", "axes"), ("Names of groups", "group_legend"),
                           ("Depth and filling at the probe", "probe_label")):
            before = len(self.settings())
            self.click_on(words)
            self.until(lambda: self.settings()[before:], f"setting of {key}")
            self.assertEqual(self.settings()[before:], [{"interaction": {key: False}}])
        self.click_on("Clip box with handles")
        self.until(lambda: self.settings()[-1] == {"view": {"cut_box": True}}, "setting of the edges")
        self.finish()

    def test_hidden_parts_are_felt_by_a_box_in_the_panel(self):
        self.open_panel("touch")
        for value in (True, False):
            before = len(self.settings())
            self.click_on("Feel hidden parts")
            self.until(lambda: self.settings()[before:], "setting of what is felt")
            self.assertEqual(self.settings()[before:], [{"probe": {"touch": {"feels_hidden": value}}}])
        self.finish()

    def test_exact_integrals_are_switched_where_sampling_is_exact(self):
        self.open_panel("quality", render={"sampling": "exact"})
        x, y = self.middle_of(self.see_at_rest("Narrow peaks"))
        self.do("mousemove", x, y, *["click", 5] * 6, pause_s=0)   # scrolls the side panel
        for value in (True, False):
            before = len(self.settings())
            self.click_on("Exact integral")
            self.until(lambda: self.settings()[before:], "setting of the integral")
            self.assertEqual(self.settings()[before:], [{"render": {"exact_integral": value}}])
        self.finish()

    # Kind (Values): a spacing that no float holds, typed
    def test_a_spacing_is_kept_as_it_was_typed(self):
        scan = Volume.noise((16, 16, 16), seed=1).write(self.folder)
        session = self.write_session(volume={"path": scan.name})
        self.open_scan(session, preferences={"hints_seen": 3})
        self.click_on("File", "##MainMenuBar")
        self.click_on("Correct the spacing...", "##Menu_00")
        self.see("Cancel", "Correct the spacing")
        self.do("type", "--delay", 30, "0.1 1", pause_s=0)   # at once, in place of the present one
        self.see("expected the size of a voxel", "Correct the spacing")
        self.press("Return")   # refused in the dialog
        self.do("type", "--delay", 30, " 2 um", pause_s=0)
        self.see("0.1 1 2 um", "Correct the spacing")
        self.see_no_more("expected the size", "Correct the spacing")
        self.press("Return")
        asked = self.until(lambda: [line for line in self.done() if line["op"] == "correct_spacing"], "correction")
        self.assertEqual((asked[0]["spacing"], asked[0]["unit"]), ([0.1, 1, 2], "um"))
        self.finish()
        self.assertIn("0.1", session.read_text())
        self.assertNotIn("0.10000000149", session.read_text())

    def picture(self):
        """Rows of the graphics window, once it is sharp and nothing is drawn any more."""
        self.see_picture()
        self.until(self.rests, "window at rest")
        return [row[:3 * (WINDOW[0] - SIDE_PANEL - 8)] for row in self.pixels()[2][80:WINDOW[1] - 60]]

    def test_hints_are_shown_once_and_move_no_pixel_of_the_picture(self):
        session = self.write_ball()
        self.open_scan(session)
        before = self.picture()
        for words, button in (("Drag to turn the volume", "Next hint"), ("The bar at the top", "Next hint"),
                              ("Everything can be undone", "Done")):
            self.see(words, "First hints")
            self.click_on(button, "First hints")
            self.see_no_more(words)
        self.see_no_more("", "First hints")
        after = self.picture()
        self.assertEqual([y for y, row in enumerate(before) if row != after[y]], [])
        self.finish()
        self.open_scan(session)
        self.assertEqual(self.seen(window="First hints"), [])
        self.assertGreater(len(set(after)), 50)   # rows that show something
        self.finish()

    def after(self, label):
        """What stands on the row of a label, right of it."""
        rows = [seen for seen in self.seen(label) if seen["text"] == label]
        if not rows:
            return None
        _, top, right, bottom = rows[0]["box"]
        return next((seen for seen in self.seen() if seen["box"][0] > right and seen["box"][1] < bottom
                     and seen["box"][3] > top), None)


if __name__ == "__main__":
    unittest.main()
