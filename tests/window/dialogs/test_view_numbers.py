"""Numbers that are typed, by real events: a decimal comma is a decimal point, and what is not a number changes nothing and
is refused in sight."""
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from operating import OPERATIONS, Operating  # noqa: E402
from seen import only_panel  # noqa: E402


class Numbers(Operating):
    def type_number(self, field, text):
        if field.startswith("Distance"):   # its value is too close to be a text of its own
            self.click_right_of(field)
            self.press("Ctrl+A")
            self.do("type", "--delay", 40, text, pause_s=0)
        else:
            self.type_into(field, text, OPERATIONS)
        self.see_among(text)

    # Kind (Values): a number with a decimal comma, typed
    def test_a_decimal_comma_is_a_decimal_point_in_a_dialog(self):
        self.painted_scan()
        self.open_operations()
        self.see("Grow: ", OPERATIONS)
        self.type_number("Distance in voxels", "1,5")
        self.press("Return")
        self.until(lambda: self.previewed()["distance"] == 1.5, "preview of 1.5")
        self.see_among("1.5")
        self.type_number("Distance in voxels", "2,2,5")
        self.see_among('"2,2,5" is not a number')
        self.press("Return")
        self.see_frames()
        self.until(lambda: any("2,2,5" in seen["text"] and "not a number" not in seen["text"]
                               for seen in self.seen(window=OPERATIONS)), "text that stays")   # nothing can be applied
        self.click_on("Apply", OPERATIONS)
        self.see_frames()
        self.assertEqual([line for line in self.done() if line["op"] == "grow"], [])
        # Numbers on the way there may have been previewed, a text with two commas not.
        self.assertLess(max(line["distance"] for line in self.previews()), 3)
        self.type_number("Distance in voxels", "0")
        self.press("Return")
        self.see_note("Distance is 0; expected a number above 0")   # the suggestion does not come back
        self.type_number("Distance in voxels", "2,25")
        self.until(lambda: not any("is not a number" in seen["text"] for seen in self.seen(window=OPERATIONS)),
                   "dialog without a refusal")
        self.press("Return")
        self.until(lambda: self.previewed()["distance"] == 2.25, "preview of 2.25")
        self.click_on("Apply", OPERATIONS)
        grown = self.until(lambda: [line for line in self.done() if line["op"] == "grow"], "grown group")
        self.assertEqual(grown[0]["distance"], 2.25)
        self.finish()

    def test_a_whole_number_has_no_decimals(self):
        self.painted_scan()
        self.open_operations()
        self.choose_of("Where", "the whole scan", "a box")
        box = self.until(lambda: self.previewed().get("box"), "a box")
        self.type_number("First voxel", "1,5")
        self.see_note('"1,5" is not a whole number; expected one such as 12')
        self.press("Return")
        self.see_frames()
        self.assertIn(self.previewed()["box"], (box, [1, *box[1:]]))   # 1 was typed on the way
        self.type_number("First voxel", "15")
        self.press("Return")
        self.until(lambda: self.previewed()["box"] == [15, *box[1:]], "the box from 15 on")
        self.finish()

    def test_a_smallest_part_is_a_whole_number_from_one_on(self):
        window = "Label connected parts"
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        self.click_on("File", "##MainMenuBar")
        self.click_on("Label connected parts...", "##Menu_00")
        self.see("Counts the parts; nothing is written.", window)
        self.type_into("Smallest part", "9999999999999999999", window)
        self.see('"9999999999999999999" is too large; expected a smaller number', window)
        self.type_into("Smallest part", "-5", window)
        self.see("the smallest part has -5 voxels; expected 1 or more", window)
        self.press("Return")
        self.see_frames()
        self.see("Cancel", window)
        self.type_into("Smallest part", "5", window)
        self.see("Counts the parts; nothing is written.", window)
        self.press("Return")
        self.see_no_more("", window)
        self.see("Found ", "Status")
        self.assertEqual([line["min_voxels"] for line in self.done() if line["op"] == "label"], [5])
        self.finish()

    def settings(self):
        return [line["values"] for line in self.done() if line["op"] == "set"]

    def type_over(self, label, text):
        """Over the number of a slider, or one that is dragged: with Ctrl and a click."""
        x0, y0, x1, y1 = self.see_at_rest(label, "Side panel")["box"]
        number = next(seen for seen in self.seen(window="Side panel")
                      if seen["box"][0] > x1 and seen["box"][1] < y1 and seen["box"][3] > y0)
        self.do("mousemove", *self.middle_of(number), pause_s=0)
        self.see_frames()
        self.do("keydown", "ctrl", "sleep", 0.1, "click", 1, "sleep", 0.1, "keyup", "ctrl", pause_s=0)
        self.see_frames()
        self.do("type", "--delay", 40, text, pause_s=0)
        self.see(text, "Side panel")

    def test_a_decimal_comma_is_a_decimal_point_over_sliders(self):
        self.open_scan(self.write_ball(), preferences=only_panel("light"))
        self.type_over("Ambient", "0,45")
        self.press("Return")
        self.until(lambda: self.settings()[-1] == {"light": {"ambient": 0.45}}, "ambient light of 0.45")
        self.type_over("Ambient", "0,6x")
        self.see('"0,6x" is not a number', "##Tooltip")
        self.press("Return")
        self.see_frames()
        self.see("0.45", "Side panel")
        self.assertEqual(self.settings()[-1], {"light": {"ambient": 0.45}})
        self.see('"0,6x" is not a number', "##Tooltip")   # until the next click
        self.do("mousemove", *self.middle(), "click", 1, pause_s=0)
        self.see_no_more('"0,6x" is not a number')
        self.finish()

    def test_a_decimal_comma_is_a_decimal_point_over_dragged_numbers_and_colours(self):
        self.open_scan(self.write_ball(), preferences=only_panel("transfer_function"))
        self.type_over("Intensity", "101,5")
        self.press("Return")
        points = self.until(lambda: self.settings()[-1]["transfer_function"]["points"], "points")
        self.assertEqual(points[0]["intensity"], 101.5)
        self.type_over("Colour", "127,5")   # red, of 255
        self.press("Return")
        self.until(lambda: self.settings()[-1]["transfer_function"]["points"][0]["color"].startswith("#8"), "red of 127.5")
        self.finish()

    def test_a_decimal_comma_is_a_decimal_point_in_the_palette(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        self.press("Ctrl+Shift+P")
        self.see("", "Find anything")
        self.see_frames()
        self.do("type", "--delay", 40, "ambient light 0,4", pause_s=0)
        self.see("Ambient light: 0.4", "Find anything")
        self.press("Return")
        self.until(lambda: {"light": {"ambient": 0.4}} in self.settings(), "ambient light of 0.4")
        self.finish()


if __name__ == "__main__":
    unittest.main()
