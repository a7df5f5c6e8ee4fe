"""Density painting, the ball that the light is dragged on, and a window that goes away and comes back, by real events."""
import json
import unittest

from seen import Seen, only_panel


class Events(Seen):
    def open_with(self, panel, **keys):
        self.session = self.write_ball(**keys)
        self.open_scan(self.session, preferences=only_panel(panel))

    def test_density_is_painted_undone_and_saved(self):
        # Voxels at the threshold are not visible yet.
        self.open_with("probe", probe={"radius_voxels": 5, "group": 3, "paint_threshold": 60})
        self.click_on("raises intensities")
        self.until(lambda: any(action.get("values", {}).get("probe", {}).get("density") for action in self.done()),
                   "density painting")
        x, y = self.middle()
        self.check_probe(x, y)
        for way in (0, 16):
            self.check_stroke((x + way, y), (x + way + 12, y + 4))
        self.until(lambda: self.frame()["sharp"], "sharp picture")
        self.press("Ctrl+z")
        self.press("Ctrl+s")
        offsets = self.folder / "paint.offset"
        self.until(offsets.exists, "saved offsets")
        report = self.finish()
        self.assertEqual(sorted(report["voxels_in_group"]), ["3"])  # which it paints as well
        self.assertEqual((report["undoable"], report["redoable"]), (1, 1))
        # The stroke that is left raised what it raised, and nothing else is raised without it.
        self.check_refused("annotate", self.session, "--script", self.write_script("s.jsonl", [
            {"op": "expect", "voxels_with_offset": 0}]), says=["voxels have an offset"], status=3)
        self.check_json("annotate", self.session, "--script", self.write_script("s.jsonl", [
            {"op": "undo"}, {"op": "expect", "voxels_with_offset": 0, "voxels_in_group": {"3": 0}}]))

    def test_the_light_is_dragged_on_its_ball_and_put_back_by_a_double_click(self):
        self.open_with("light")
        left, top, _, bottom = self.see_at_rest("Light from")["box"]
        height = bottom - top
        x, y = left - 3 * height, top + 2 * height
        self.check_drag((x, y), [(x - 8, y + 6)], "set light.direction")
        self.see_frames()
        directions = [action["values"]["light"]["direction"] for action in self.done() if "light" in
                      action.get("values", {})]
        self.assertTrue(directions and directions[-1] is not None, self.done())
        self.do("click", "--repeat", 2, "--delay", 60, 1, pause_s=0)
        self.until(lambda: {"op": "set", "values": {"light": {"direction": None}}} in self.done(), "light put back")
        self.finish()

    def test_a_window_that_is_unmapped_works_on_and_is_drawn_when_it_is_back(self):
        self.open_with("probe")
        x, y = self.middle()
        self.check_probe(x, y)
        window = self.window_named("sphere.* - SHVR")
        for _ in range(3):
            self.do("windowunmap", window, pause_s=0.4)
            self.do("windowmap", window, pause_s=0.4)
        before = self.frame()["frame"]
        self.check_stroke((x, y), (x + 12, y + 4))
        self.until(lambda: self.frame()["frame"] > before and self.frame()["sharp"], "frame after the window is back")
        report = self.finish()
        self.assertEqual(sorted(report["voxels_in_group"]), ["3"])


if __name__ == "__main__":
    unittest.main()
