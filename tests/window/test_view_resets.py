"""A double click on a slider takes the value that ships, in every panel that has sliders, by real events; both clicks
may fall into one frame."""
import unittest

from seen import Seen
from test_view_photographs import PANELS

# Panel (its key in the preferences), words before the slider, its key in the session.
SLIDERS = [
    ("transfer_function", "Volume", "unpainted.opacity"),
    ("light", "Ambient", "light.ambient"),
    ("occlusion", "Strength", "light.occlusion.strength"),
    ("quality", "Detail", "render.detail"),
    ("aids", "Probe's opacity", "probe.opacity"),
    ("views", "In motion", "interaction.resolution"),
    ("touch", "Strength", "probe.touch.strength"),
    ("touch", "Workspace", "interaction.workspace_scale"),
]
PIXELS_LEFT_OF_THE_NUMBER = 40   # still on the slider, and far from what ships


# Other fields: (panel, words, key, pixels left of the number's ink); 0: on the number, of fields that a click alone does
# not change.
FIELDS = [
    ("probe", "Radius", "probe.radius_voxels", 0),
    ("probe", "Paint threshold", "probe.paint_threshold", 40),
    ("touch", "Haptic threshold", "probe.haptic_threshold", 40),
    ("groups", "0  unpainted", "unpainted.opacity", 0),
]


class Resets(Seen):
    def number_of(self, label):
        """What stands on the slider whose words these are."""
        _, top, right, _ = self.words_of(label)["box"]
        on_row = [seen for seen in self.seen() if abs(seen["box"][1] - top) < 4 and seen["box"][0] > right]
        return min(on_row, key=lambda seen: seen["box"][0])

    def number(self, label):
        return self.number_of(label)["text"]

    def words_of(self, label):
        return next(seen for seen in self.seen(label) if seen["text"] == label)

    def values(self, key, op="set"):
        """What was set there, in order."""
        found = []
        for action in self.done():
            value = action.get("values") if action["op"] == op else None
            for part in key.split("."):
                value = value.get(part, "none") if isinstance(value, dict) else "none"
            if value != "none":
                found.append(value)
        return found

    def check_slider(self, panel, label, key, delay_ms):
        folds = {name: {"folded": name != panel} for name in PANELS}
        self.open_scan(self.write_ball(), preferences={"layout": {"panels": folds}, "hints_seen": 3})
        self.until(lambda: self.seen(label), f"slider {label}", 10)
        ships = self.number(label)
        x0, y0, _, y1 = self.number_of(label)["box"]
        self.do("mousemove", x0 - PIXELS_LEFT_OF_THE_NUMBER, (y0 + y1) / 2, pause_s=0.3)
        self.do("click", "--repeat", 2, "--delay", delay_ms, 1, pause_s=0)
        self.until(lambda: None in self.values(key), f"reset of {key}; set were {self.values(key)}", 5)
        self.assertEqual(len(self.values(key)), 2, "one value by the first click, one reset by the second")
        self.assertIsNone(self.values(key)[-1])
        self.until(lambda: self.number(label) == ships, f"{ships} on {label}", 5)
        self.do("mousemove_relative", "--", -10, 0, pause_s=0.3)
        self.assertEqual(len(self.values(key)), 2, "the slider follows the mouse after the reset")
        self.finish()


    def double_click(self):
        """As a hand does it: each press lasts for some frames."""
        for _ in range(2):
            self.do("mousedown", 1, "sleep", 0.08, "mouseup", 1, "sleep", 0.04, pause_s=0)

    def number_after(self, label, window=None):
        """What is right of the words, on their row."""
        _, top, right, bottom = [seen for seen in self.seen(label, window) if seen["text"] == label][-1]["box"]
        on_row = [seen for seen in self.seen(window=window) if seen["box"][0] > right and seen["text"][-1:].isalnum()
                  and seen["box"][1] < bottom and seen["box"][3] > top]
        return min(on_row, key=lambda seen: seen["box"][0])

    def check_field(self, panel, label, key, left):
        folds = {name: {"folded": name != panel} for name in PANELS}
        self.open_scan(self.write_ball(), preferences={"layout": {"panels": folds}, "hints_seen": 3})
        self.until(lambda: self.seen(label), f"field {label}", 10)
        x0, y0, x1, y1 = self.number_after(label)["box"]
        self.do("mousemove", x0 - left if left else (x0 + x1) / 2, (y0 + y1) / 2, pause_s=0.3)
        self.double_click()
        self.until(lambda: None in self.values(key), f"reset of {key}; set were {self.values(key)}", 5)
        self.do("mousemove_relative", "--", -10, 0, pause_s=0.3)
        self.assertEqual(self.values(key).count(None), 1)
        self.assertIsNone(self.values(key)[-1], "the field follows the mouse after the reset")
        self.finish()

    def test_preferences(self):
        self.open_scan(self.write_ball(), preferences={"font_pixels": 15, "hints_seen": 3})
        self.press("Ctrl+,")
        self.see("Text", "Preferences")
        x0, y0, _, y1 = self.number_after("Text", "Preferences")["box"]
        self.do("mousemove", x0 - 30, (y0 + y1) / 2, pause_s=0.3)
        self.double_click()
        self.until(lambda: None in self.values("font_pixels", "prefer"), "reset of the height of letters", 5)
        self.do("mousemove_relative", "--", -10, 0, pause_s=0.5)
        self.assertIsNone(self.values("font_pixels", "prefer")[-1], self.values("font_pixels", "prefer"))
        self.finish()


def add_test(panel, label, key, delay_ms):
    name = f"test_{panel}_{label.lower()}_after_{delay_ms}_ms"
    setattr(Resets, name, lambda self: self.check_slider(panel, label, key, delay_ms))


for slider in SLIDERS:
    add_test(*slider, 5)
add_test(*SLIDERS[2], 120)
for field in FIELDS:
    setattr(Resets, f"test_field_{field[2].replace('.', '_')}", lambda self, field=field: self.check_field(*field))

if __name__ == "__main__":
    unittest.main()
