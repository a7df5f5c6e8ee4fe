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


if __name__ == "__main__":
    unittest.main()
