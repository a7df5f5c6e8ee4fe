"""A double click on a slider takes the value that ships, in every panel that has sliders, by real events; both clicks
may fall into one frame."""
import unittest

from seen import Seen, only_panel

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
        """What was set there since `self.begun`, in order."""
        found = []
        for action in self.done(self.begun):
            value = action.get("values") if action["op"] == op else None
            for part in key.split("."):
                value = value.get(part, "none") if isinstance(value, dict) else "none"
            if value != "none":
                found.append(value)
        return found

    def check_slider(self, panel, label, key, delay_ms):
        self.begin(panel, label)
        ships = self.number(label)
        x0, y0, _, y1 = self.number_of(label)["box"]
        self.do("mousemove", x0 - PIXELS_LEFT_OF_THE_NUMBER, (y0 + y1) / 2, pause_s=0)
        self.see_frames()
        self.do("click", "--repeat", 2, "--delay", delay_ms, 1, pause_s=0)
        self.until(lambda: None in self.values(key), f"reset of {key}; set were {self.values(key)}")
        self.assertEqual(len(self.values(key)), 2, "one value by the first click, one reset by the second")
        self.assertIsNone(self.values(key)[-1])
        self.until(lambda: self.number(label) == ships, f"{ships} on {label}")
        self.move_on()
        self.assertEqual(len(self.values(key)), 2, "the slider follows the mouse after the reset")

    def begin(self, panel, label):
        """The panel alone is unfolded, and at rest."""
        if panel != self.unfolded:
            self.unfold(panel, self.unfolded)
            self.unfolded = panel
        self.see_at_rest(label, "Side panel")
        self.begun = len(self.done())

    def move_on(self):
        self.do("mousemove_relative", "--", -10, 0, pause_s=0)
        self.see_frames()

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
        self.begin(panel, label)
        x0, y0, x1, y1 = self.number_after(label)["box"]
        self.do("mousemove", x0 - left if left else (x0 + x1) / 2, (y0 + y1) / 2, pause_s=0)
        self.see_frames()
        self.double_click()
        self.until(lambda: None in self.values(key), f"reset of {key}; set were {self.values(key)}")
        self.move_on()
        self.assertEqual(self.values(key).count(None), 1)
        self.assertIsNone(self.values(key)[-1], "the field follows the mouse after the reset")

    def open_with(self, panel):
        self.open_scan(self.write_ball(), preferences=only_panel(panel))
        self.unfolded = panel

    def test_sliders_of_all_panels(self):
        self.open_with(SLIDERS[0][0])
        for panel, label, key in SLIDERS:
            with self.subTest(panel=panel, label=label):
                self.check_slider(panel, label, key, delay_ms=5)
        with self.subTest("clicks in two frames"):
            self.check_slider(*SLIDERS[2], delay_ms=120)
        self.finish()

    def test_other_fields(self):
        self.open_with(FIELDS[0][0])
        for panel, label, key, left in FIELDS:
            with self.subTest(panel=panel, label=label):
                self.check_field(panel, label, key, left)
        self.finish()

    def test_preferences(self):
        self.begun = 0
        self.open_scan(self.write_ball(), preferences={"font_pixels": 15, "hints_seen": 3})
        self.press("Ctrl+,")
        self.see_at_rest("Text", "Preferences")
        x0, y0, _, y1 = self.number_after("Text", "Preferences")["box"]
        self.do("mousemove", x0 - 30, (y0 + y1) / 2, pause_s=0)
        self.see_frames()
        self.double_click()
        self.until(lambda: None in self.values("font_pixels", "prefer"), "reset of the height of letters")
        self.move_on()
        self.assertIsNone(self.values("font_pixels", "prefer")[-1], self.values("font_pixels", "prefer"))
        self.finish()


if __name__ == "__main__":
    unittest.main()
