"""Operations on groups, by real events: chosen, limited, previewed in the picture and carried out."""
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from operating import OPERATIONS, Operating  # noqa: E402
from window import Display  # noqa: E402


class Operations(Operating):
    @classmethod
    def setUpClass(cls):
        cls.display = Display("1300x850")
        cls.addClassCleanup(cls.display.close)

    def test_an_operation_is_previewed_and_carried_out(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        x, y = self.middle()
        self.check_probe(x, y)
        self.check_stroke((x, y), (x + 20, y))
        self.see("Painted ", "Status")
        self.open_operations()
        previewed = self.see("Grow: ", OPERATIONS)["text"]
        self.assertIn(" painted in ", previewed)
        self.click_on("Grow", OPERATIONS)
        self.click_on("Shrink", "##Combo_00")
        self.assertIn(" erased", self.see("Shrink: ", OPERATIONS)["text"])
        self.click_on("Shrink", OPERATIONS)
        self.click_on("Grow", "##Combo_00")
        self.assertEqual(self.see("Grow: ", OPERATIONS)["text"], previewed)   # nothing was changed
        self.click_on("Apply", OPERATIONS)
        self.assertEqual(self.see("Grow: ", "Status")["text"], previewed)
        self.press("Escape")
        self.until(lambda: not self.seen(window=OPERATIONS), "closed window")

    def test_a_cut_is_drawn_in_the_picture_taken_back_and_carried_out(self):
        x, y = self.painted_scan()
        self.choose_operation("Cut by an outline")
        self.see("draw an outline", OPERATIONS)
        around = [(x - 80, y - 80), (x + 100, y - 80), (x + 100, y + 80), (x - 80, y + 80)]
        self.do("keydown", "ctrl", pause_s=0)
        self.check_drag(around[0], [around[2]], "preview_operation")   # a rectangle
        self.do("keyup", "ctrl", pause_s=0)
        previewed = self.see("Cut by an outline: ", OPERATIONS)["text"]
        self.assertIn(" erased", previewed)
        self.assertEqual(len(json.loads(self.done()[-1]["operation"])["polygon"]), 4)
        self.check_key("Escape", "preview_operation")                  # takes the outline away, not the window
        self.assertNotIn("operation", self.done()[-1])
        self.see("draw an outline", OPERATIONS)
        self.check_drag(around[0], around[1:], "preview_operation")    # a lasso
        self.assertEqual(self.see("Cut by an outline: ", OPERATIONS)["text"], previewed)
        self.check_key("Enter", "lasso")
        self.assertEqual(self.see("Cut by an outline: ", "Status")["text"], previewed)
        line = next(each for each in self.done() if each["op"] == "lasso")
        self.assertEqual(line["camera"]["projection"], "perspective")
        self.assertGreater(len(line["polygon"]), 3)
        self.see("draw an outline", OPERATIONS)
        self.check_key("Escape", "show_dialog")
        self.until(lambda: not self.seen(window=OPERATIONS), "closed window")

    def test_every_limit_of_scripts_limits_the_preview(self):
        self.painted_scan()
        self.choose_operation("Grow")
        whole = self.see("Grow: ", OPERATIONS)["text"]
        self.click_on("Only unpainted voxels", OPERATIONS)
        self.until(lambda: self.previewed().get("only_unpainted") is True, "only unpainted voxels")
        self.choose_of("Only in", "any group", "0  unpainted")
        self.until(lambda: self.previewed().get("inside") == 0, "inside unpainted voxels")
        self.choose_of("Where", "the whole scan", "a box")
        self.until(lambda: len(self.previewed().get("box", [])) == 6, "a box")
        self.see_frames(3)   # the box's rows have made the window higher, which then moves up
        word = self.see_at_rest("Intensities", OPERATIONS)
        self.do("mousemove", word["box"][0] + 9 * 14 + 8, self.middle_of(word)[1], pause_s=0)
        self.see_frames()
        self.do("click", 1, pause_s=0)
        self.until(lambda: self.previewed().get("within") == [0, 0], "an intensity range")
        self.until(lambda: self.see("Grow: ", OPERATIONS)["text"] != whole, "another count")

    def test_the_visible_part_ends_at_the_oblique_cutting_plane(self):
        self.painted_scan()
        self.check_follows(lambda: self.click_on("Cut plane", "Tools"), "oblique_cut")
        self.choose_operation("Grow")
        self.assertIn(" painted in ", self.see("Grow: ", OPERATIONS)["text"])
        self.see("Voxels behind cutting planes change, too.", OPERATIONS)
        self.assertFalse(self.seen("Plane normal", OPERATIONS))   # the row Where states the plane
        self.choose_of("Where", "the whole scan", "the visible part (cutting planes)")
        self.until(lambda: len(self.previewed().get("plane_normal", [])) == 3, "the plane among the limits")
        self.assertEqual(len(self.previewed()["plane_point"]), 3)
        self.see("Grow: nothing changed", OPERATIONS)   # the stroke is on the side that was cut away

    def test_a_click_says_which_part_is_kept(self):
        x, y = self.painted_scan()
        self.choose_operation("Islands")
        self.see("Islands: ", OPERATIONS)                       # a preview of a valid suggestion
        self.choose_of("Keep", "the largest part", "the part that is clicked")
        self.see("click the part to keep", OPERATIONS)
        self.check_follows(lambda: self.do("mousemove", x + 10, y, "click", 1, pause_s=0), "preview_operation")
        self.until(lambda: len(self.previewed().get("at", [])) == 3, "the place that was clicked")
        self.see("Islands: ", OPERATIONS)

    def test_the_preview_of_growing_from_seeds_follows_each_stroke(self):
        x, y = self.painted_scan()
        self.choose_operation("Grow from seeds")
        previewed = self.see("Grow from seeds: ", OPERATIONS)["text"]
        self.assertIn(" painted in ", previewed)
        self.check_follows(lambda: self.stroke((x - 20, y), (x - 25, y), pause_s=0), "preview_operation")
        self.until(lambda: self.see("Grow from seeds: ", OPERATIONS)["text"] != previewed, "renewed preview")


if __name__ == "__main__":
    unittest.main()
