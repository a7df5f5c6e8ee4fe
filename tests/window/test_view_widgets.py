"""Keys of the thesis and widgets of the side panel, by real events: what they ask for is in the log of actions."""
import json
import unittest
from pathlib import Path

from harness import ENVIRONMENT
from seen import Seen
from test_view import WINDOW


class Widgets(Seen):
    def view_ball(self, *arguments):
        self.log = self.folder / "log.jsonl"
        self.start(self.write_ball(), "--log", self.log, *arguments)
        self.wait_for_window("sphere.* - SHVR")
        self.do("mousemove", *self.middle())

    def settings(self):
        """What was set, in order."""
        lines = [json.loads(line) for line in self.log.read_text().splitlines()]
        return [line["values"] for line in lines if line["op"] == "set"]

    def test_keys_switch_what_is_shown_and_scale_the_workspace(self):
        self.view_ball()
        for key in ("F2", "F3", "F2", "F3", "shift+F1"):
            self.do("key", key, pause_s=0.5)
        self.do("keydown", "F7", "sleep", 0.4, "keyup", "F7", pause_s=0.5)
        report = self.finish()
        self.assertEqual(self.settings()[:5], [{"view": {"volume": False}}, {"view": {"meshes": False}},
                                               {"view": {"volume": True}}, {"view": {"meshes": True}},
                                               {"probe": {"arrow": False}}])
        scales = [values["interaction"]["workspace_scale"] for values in self.settings()[5:]]
        self.assertTrue(scales and all(1.0 < a < b for a, b in zip(scales, scales[1:])), scales)
        self.assertIn("The volume is not drawn, except in slices", report["messages"])

    def test_the_thesis_keys_are_those_that_it_prints(self):
        preferences = Path(ENVIRONMENT["XDG_CONFIG_HOME"]) / "shvr" / "preferences.json"
        preferences.parent.mkdir(parents=True, exist_ok=True)
        preferences.write_text(json.dumps({"shvr_preferences": 1, "key_set": "thesis"}))
        self.addCleanup(preferences.unlink, missing_ok=True)
        self.view_ball()
        self.do("key", "F1", pause_s=0.5)
        self.do("keydown", "ctrl", "keydown", "F7", "sleep", 0.4, "keyup", "F7", "keyup", "ctrl", pause_s=0.5)
        report = self.finish()
        self.assertEqual(self.settings()[0], {"probe": {"arrow": False}})
        self.assertLess(self.settings()[-1]["interaction"]["workspace_scale"], 1.0)
        self.assertIn("Arrow towards the probe off", report["messages"])

    def test_the_wheel_over_the_curve_shifts_all_points_and_slowly_with_shift(self):
        self.view_ball()
        points = []
        for y in range(110, 580, 20):  # wherever the curve is; elsewhere the panel is scrolled, which sets nothing
            self.do("mousemove", WINDOW[0] - 160, y, "sleep", 0.2, "click", 4, pause_s=0.4)
            points = [values["transfer_function"]["points"] for values in self.settings() if "transfer_function" in values]
            if points:
                self.do("keydown", "shift", "sleep", 0.1, "click", 4, "sleep", 0.2, "keyup", "shift", pause_s=0.6)
                break
        self.finish()
        self.assertTrue(points, "no place where the wheel shifts the points")
        shifted = [values["transfer_function"]["points"] for values in self.settings() if "transfer_function" in values]
        self.assertEqual([p["intensity"] for p in shifted[0]], [103, 163, 258])  # a hundredth of 255, in whole numbers
        self.assertEqual([p["intensity"] for p in shifted[-1]], [104, 164, 259])

    def test_a_double_click_resets_a_slider_and_its_number_is_read_over_the_handle(self):
        self.open_scan(self.write_ball(light={"ambient": 0.4}), preferences={
            "hints_seen": 3, "layout": {"panels": {"light": {"folded": False}, "transfer_function": {"folded": True},
                                                   "groups": {"folded": True}, "probe": {"folded": True},
                                                   "trace": {"folded": True}}}})
        self.see("Ambient")
        number = next(seen for seen in self.seen("0.40") if abs(seen["box"][1] - self.see("Ambient")["box"][1]) < 8)
        x, y = self.middle_of(number)
        # The handle is dragged to the middle, under the number.
        made = self.what_follows(lambda: self.do("mousemove", x - 20, y, "sleep", 0.1, "mousedown", 1, "sleep", 0.1,
                                                 "mousemove", x, y, "sleep", 0.2, "mouseup", 1), "set light.ambient")
        self.assertIn("set light.ambient", made)
        self.do("mousemove", *self.middle(), pause_s=0.3)
        number = next(seen for seen in self.seen("0.5") if abs(seen["box"][1] - self.see("Ambient")["box"][1]) < 8)
        width, height, rows = self.pixels()
        box = [round(side) for side in number["box"]]
        blue = 0   # pixels with the handle's hue
        for row in rows[box[1]:box[3]]:
            for at in range(box[0], box[2]):
                r, g, b = row[3 * at:3 * at + 3]
                blue += b > r + 40
        self.assertEqual(blue, 0)
        self.what_follows(lambda: self.do("mousemove", x + 1, y, "sleep", 0.1, "click", "--repeat", 2, "--delay", 80, 1),
                          "set light.ambient")
        self.until(lambda: self.done()[-1] == {"op": "set", "values": {"light": {"ambient": None}}} or
                   {"op": "set", "values": {"light": {"ambient": None}}} in self.done(), "reset of the slider")
        self.finish()


if __name__ == "__main__":
    unittest.main()
