"""A double click on a slider takes the value that ships, in every panel that has sliders, by real events; both clicks
may fall into one frame."""
import unittest

from seen import Seen
from test_view_photographs import PANELS

# Panel (its key in the preferences), words beside the slider, its key in the session.
SLIDERS = [
    ("transfer_function", "Volume", "unpainted.opacity"),
    ("light", "Ambient", "light.ambient"),
    ("occlusion", "Strength", "light.occlusion.strength"),
    ("quality", "Detail", "render.detail"),
    ("aids", "Probe's opacity", "probe.opacity"),
    ("views", "In motion", "interaction.resolution"),
]
PIXELS_LEFT_OF_THE_WORDS = 30   # still on the slider, and far from what ships


class Resets(Seen):
    def number(self, label):
        """What stands on the slider whose words these are."""
        left, top, _, _ = self.words_of(label)["box"]
        on_row = [seen for seen in self.seen() if abs(seen["box"][1] - top) < 4 and seen["box"][2] < left]
        return max(on_row, key=lambda seen: seen["box"][2])["text"]

    def words_of(self, label):
        return next(seen for seen in self.seen(label) if seen["text"] == label)

    def values(self, key):
        """What was set there, in order."""
        found = []
        for action in self.done():
            value = action.get("values") if action["op"] == "set" else None
            for part in key.split("."):
                value = value.get(part, "none") if isinstance(value, dict) else "none"
            if value != "none":
                found.append(value)
        return found

    def check_slider(self, panel, label, key, delay_ms):
        folds = {name: {"folded": name != panel} for name in [*PANELS, "touch"]}
        self.open_scan(self.write_ball(), preferences={"layout": {"panels": folds}, "hints_seen": 3})
        self.until(lambda: self.seen(label), f"slider {label}", 10)
        ships = self.number(label)
        x0, y0, _, y1 = self.words_of(label)["box"]
        self.do("mousemove", x0 - PIXELS_LEFT_OF_THE_WORDS, (y0 + y1) / 2, pause_s=0.3)
        self.do("click", "--repeat", 2, "--delay", delay_ms, 1, pause_s=0)
        self.until(lambda: None in self.values(key), f"reset of {key}; set were {self.values(key)}", 5)
        self.assertEqual(len(self.values(key)), 2, "one value by the first click, one reset by the second")
        self.assertIsNone(self.values(key)[-1])
        self.until(lambda: self.number(label) == ships, f"{ships} on {label}", 5)
        self.do("mousemove_relative", "--", -10, 0, pause_s=0.3)
        self.assertEqual(len(self.values(key)), 2, "the slider follows the mouse after the reset")
        self.finish()


def add_test(panel, label, key, delay_ms):
    name = f"test_{panel}_after_{delay_ms}_ms"
    setattr(Resets, name, lambda self: self.check_slider(panel, label, key, delay_ms))


for slider in SLIDERS:
    add_test(*slider, 5)
add_test(*SLIDERS[2], 120)

if __name__ == "__main__":
    unittest.main()
