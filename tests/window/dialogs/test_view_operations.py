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
        previewed = self.note("Grow: ")
        self.assertIn(" would be painted in ", previewed)
        self.click_on("Grow", OPERATIONS)
        self.click_on("Shrink", "##Combo_00")
        self.assertIn(" would be erased", self.note("Shrink: "))
        self.click_on("Shrink", OPERATIONS)
        self.click_on("Grow", "##Combo_00")
        self.assertEqual(self.note("Grow: "), previewed)   # nothing was changed
        self.click_on("Apply", OPERATIONS)
        self.see_done(previewed)
        self.see_note("This was applied.")
        self.check_key("Ctrl+Z", "undo")
        self.assertEqual(self.note("Grow: "), previewed)   # the annotation is what it was about
        self.press("Escape")
        self.until(lambda: not self.seen(window=OPERATIONS), "closed window")

    def color_before(self, words, window):
        """Red, green and blue of the square that stands left of the words in a list."""
        x0, y0, _, y1 = self.see_at_rest(words, window)["box"]
        x, y = round(x0) - 21, round((y0 + y1) / 2)
        return tuple(self.pixels()[2][y][3 * x:3 * x + 3])

    def test_a_group_has_the_same_colour_everywhere(self):
        self.painted_scan()
        self.open_operations()
        shown = self.color_before("3  group 3", "Tools")
        self.assertGreater(max(shown) - min(shown), 40, shown)   # no grey of the bar
        self.assertEqual(self.color_before("3  group 3", OPERATIONS), shown)

    def test_a_cut_is_drawn_in_the_picture_taken_back_and_carried_out(self):
        x, y = self.painted_scan()
        self.choose_operation("Cut by an outline")
        self.see("draw an outline", OPERATIONS)
        around = [(x - 80, y - 80), (x + 100, y - 80), (x + 100, y + 80), (x - 80, y + 80)]
        self.do("keydown", "ctrl", pause_s=0)
        self.check_drag(around[0], [around[2]], "preview_operation")   # a rectangle
        self.do("keyup", "ctrl", pause_s=0)
        previewed = self.note("Cut by an outline: ")
        self.assertIn(" would be erased", previewed)
        self.assertEqual(len(json.loads(self.done()[-1]["operation"])["polygon"]), 4)
        self.check_key("Escape", "preview_operation")                  # takes the outline away, not the window
        self.assertNotIn("operation", self.done()[-1])
        self.see("draw an outline", OPERATIONS)
        self.check_drag(around[0], around[1:], "preview_operation")    # a lasso
        self.assertEqual(self.note("Cut by an outline: "), previewed)
        self.check_key("Enter", "lasso")
        self.see_done(previewed)
        line = next(each for each in self.done() if each["op"] == "lasso")
        self.assertEqual(line["camera"]["projection"], "perspective")
        self.assertGreater(len(line["polygon"]), 3)
        self.see("draw an outline", OPERATIONS)
        self.check_key("Escape", "show_dialog")
        self.until(lambda: not self.seen(window=OPERATIONS), "closed window")

    def test_every_limit_of_scripts_limits_the_preview(self):
        self.painted_scan()
        self.choose_operation("Grow")
        whole = self.note("Grow: ")
        self.click_on("Only unpainted voxels", OPERATIONS)
        self.until(lambda: self.previewed().get("only_unpainted") is True, "only unpainted voxels")
        self.choose_of("Only in", "any group", "0  unpainted")
        self.until(lambda: self.previewed().get("inside") == 0, "inside unpainted voxels")
        self.choose_of("Where", "the whole scan", "a box")
        self.until(lambda: len(self.previewed().get("box", [])) == 6, "a box")
        self.see_frames(3)   # the box's rows have made the window higher, which then moves up
        self.assertFalse(self.seen("Intensities from", OPERATIONS))
        self.click_on("Only some intensities", OPERATIONS)
        self.until(lambda: self.previewed().get("within", [0])[0] == 120, "intensities from the paint threshold on")
        self.see("Intensities from", OPERATIONS)
        self.until(lambda: self.note("Grow: ") != whole, "another count")
        self.click_on("Grow", OPERATIONS)
        self.click_on("Threshold", "##Combo_00")
        self.see("From", OPERATIONS)
        self.assertFalse(self.seen("Only some intensities", OPERATIONS))   # it has a range of its own
        self.until(lambda: self.previewed()["op"] == "threshold", "threshold")
        self.assertNotIn("within", self.previewed())

    def test_the_preview_follows_what_is_typed_without_enter(self):
        self.painted_scan()
        self.open_operations()
        previewed = self.note("Grow: ")
        self.click_right_of("Distance in voxels")
        self.select_all()
        self.do("type", "--delay", 40, "3", pause_s=0)
        self.until(lambda: self.previewed()["distance"] == 3, "preview of 3")
        self.until(lambda: self.note("Grow: ") != previewed, "another count")
        self.do("type", "--delay", 40, ",5", pause_s=0)   # the field still has the keyboard
        self.until(lambda: self.previewed()["distance"] == 3.5, "preview of 3.5")

    def test_a_threshold_without_bounds_is_refused_in_the_words_of_its_rows(self):
        self.painted_scan()
        self.choose_operation("Threshold")
        self.until(lambda: self.previewed()["op"] == "threshold", "threshold")
        self.assertEqual(self.previewed()["from"], 120)
        self.click_right_of("From")
        self.select_all()
        self.press("BackSpace")
        self.see_note("From is empty; expected a lowest intensity, a highest one, or both")

    def test_the_window_leaves_the_picture_free_and_stays_where_it_is_put(self):
        size, least = (1280, 800), 0.58
        self.open_scan(self.write_ball(), "--size", "{}x{}".format(*size),
                       preferences={"scale": 2, "hints_seen": 3})
        self.open_operations()
        title = self.see_at_rest("Operations on groups", OPERATIONS)
        self.assertGreater(min(seen["box"][0] for seen in self.seen(window=OPERATIONS)), least * size[0])
        x, y = self.middle_of(title)
        self.check_drag((x, y), [(x - 100, y), (x - 400, y)], "prefer")
        put = self.see_at_rest("Operations on groups", OPERATIONS)["box"][0]
        self.assertAlmostEqual(put, title["box"][0] - 400, delta=3)
        self.check_key("Escape", "show_dialog")
        self.until(lambda: not self.seen(window=OPERATIONS), "closed window")
        self.open_operations()
        self.assertAlmostEqual(self.see_at_rest("Operations on groups", OPERATIONS)["box"][0], put, delta=3)

    def test_the_visible_part_ends_at_the_oblique_cutting_plane(self):
        self.painted_scan()
        self.check_follows(lambda: self.click_on("Cut plane", "Tools"), "oblique_cut")
        self.choose_operation("Grow")
        self.assertIn(" would be painted in ", self.note("Grow: "))
        self.see_note("Voxels behind cutting planes change, too.")
        self.assertFalse(self.seen("Plane normal", OPERATIONS))   # the row Where states the plane
        self.choose_of("Where", "the whole scan", "the visible part (cutting planes)")
        self.until(lambda: len(self.previewed().get("plane_normal", [])) == 3, "the plane among the limits")
        self.assertEqual(len(self.previewed()["plane_point"]), 3)
        self.see_note("Grow: nothing would change")   # the stroke is on the side that was cut away

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
        previewed = self.note("Grow from seeds: ")
        self.assertIn(" would be painted in ", previewed)
        self.check_follows(lambda: self.stroke((x - 20, y), (x - 25, y), pause_s=0), "preview_operation")
        self.until(lambda: self.note("Grow from seeds: ") != previewed, "renewed preview")


if __name__ == "__main__":
    unittest.main()
