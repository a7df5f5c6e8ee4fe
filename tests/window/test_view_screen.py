"""Tools, panels, theme, sizes and keyboard, by real events on a virtual display."""
import json
import tempfile
import time
import unittest
from pathlib import Path

from harness import ENVIRONMENT, read_png_header
from window import SIDE_PANEL, WINDOW, Window

MENU, TOOLS = 20, 31          # heights in pixels, at a scale of 1
TOOL, FIRST_TOOL = 31, 20     # from tool to tool, and the middle of the first


class Screen(Window):
    def setUp(self):
        super().setUp()
        folder = tempfile.TemporaryDirectory(prefix="shvr-config-")
        self.addCleanup(folder.cleanup)
        self.configuration = folder.name
        before = ENVIRONMENT["XDG_CONFIG_HOME"]
        ENVIRONMENT["XDG_CONFIG_HOME"] = folder.name
        self.addCleanup(ENVIRONMENT.__setitem__, "XDG_CONFIG_HOME", before)

    def preferences(self):
        with open(self.configuration + "/shvr/preferences.json") as file:
            return json.load(file)

    def prefer(self, patch):
        file = Path(self.configuration) / "shvr" / "preferences.json"
        file.parent.mkdir(exist_ok=True)
        file.write_text(json.dumps({"shvr_preferences": 1, **patch}))

    def click(self, x, y, pause_s=0.5):
        self.do("mousemove", x, y, "sleep", 0.2, "mousedown", 1, "sleep", 0.1, "mouseup", 1, pause_s=pause_s)

    def drag(self, begin, end):
        self.do("mousemove", *begin, "sleep", 0.3, "mousedown", 1, "sleep", 0.2, "mousemove",
                (begin[0] + end[0]) // 2, (begin[1] + end[1]) // 2, "sleep", 0.2, "mousemove", *end, "sleep", 0.3,
                "mouseup", 1, pause_s=0.7)

    def saved(self, session):
        return json.loads(session.read_text())

    def started(self, session):
        self.start(session)
        self.wait_for_window("sphere.* - SHVR")
        time.sleep(1)

    def test_a_click_takes_a_tool_and_steps_through_groups(self):
        session = self.write_ball()
        self.started(session)
        for number in [1, 4, 2]:
            self.click(FIRST_TOOL + TOOL * number, MENU + TOOLS // 2)
        self.do("key", "alt+Next", "key", "alt+Next", pause_s=0.5)
        report = self.finish()
        said = "\n".join(report["messages"])
        for name in ["Paint (left: paint,", "Select (", "Erase (left: erase,", "Group 4: ", "Group 5: "]:
            self.assertIn(name, said)
        self.assertEqual(self.saved(session)["probe"]["tool"], "erase")
        self.assertEqual(self.saved(session)["probe"]["group"], 5)

    def test_panels_are_widened_hidden_and_remembered(self):
        session = self.write_ball()
        self.started(session)
        edge = WINDOW[0] - SIDE_PANEL
        self.drag((edge, 300), (edge + 70, 300))
        width = self.preferences()["layout"]["side_width"]
        self.assertAlmostEqual(width, (SIDE_PANEL - 70) / 14, delta=0.3)
        self.do("key", "ctrl+b", pause_s=0.7)
        self.assertFalse(self.preferences()["layout"]["shows_side"])
        self.do("key", "F12")   # the picture is as wide as the window now
        photograph = self.folder / "session-view-1.png"
        self.wait_for_file(photograph)
        self.finish()
        self.assertEqual(read_png_header(photograph)[0], WINDOW[0])

        self.started(session)   # remembered
        self.do("key", "ctrl+b", pause_s=0.7)   # keys of one frame take the picture as it was
        self.do("key", "F12", pause_s=1)
        again = self.folder / "session-view-2.png"
        self.wait_for_file(again)
        self.finish()
        self.assertAlmostEqual(read_png_header(again)[0], WINDOW[0] - round(14 * width), delta=1)

    def test_the_side_takes_at_most_half_of_a_narrow_window(self):
        self.prefer({"layout": {"side_width": 60}})
        session = self.write_ball()
        self.started(session)
        self.do("key", "F12")
        photograph = self.folder / "session-view-1.png"
        self.wait_for_file(photograph)
        self.finish()
        self.assertEqual(read_png_header(photograph)[0], WINDOW[0] // 2)

    def test_tracing_is_folded_while_tracing_and_a_panel_floats_and_comes_back(self):
        session = self.write_ball()
        self.started(session)
        self.do("key", "ctrl+shift+p", pause_s=0.7)
        line = '{"layout":{"panels":{"transfer_function":{"place":"floating","at":[4,8]}}}}'
        self.do("type", "--delay", 5, f"prefer values={line}", pause_s=0.7)
        self.do("key", "Return", pause_s=1)
        # Its own window: the button that puts it back is its first line.
        self.assertEqual(self.preferences()["layout"]["panels"]["transfer_function"]["place"], "floating")
        self.click(4 * 14 + 50, 8 * 14 + 38, pause_s=1)
        self.assertEqual(self.preferences()["layout"]["panels"]["transfer_function"]["place"], "side")
        self.do("mousemove", *self.middle(), "key", "x", pause_s=0.7)
        self.do("key", "ctrl+shift+p", pause_s=0.7)
        line = '{"layout":{"panels":{"trace":{"folded":true}}}}'
        self.do("type", "--delay", 5, f"prefer values={line}", pause_s=0.7)
        self.do("key", "Return", pause_s=1)
        self.do("key", "ctrl+s", pause_s=0.5)
        self.finish()
        self.assertTrue(self.preferences()["layout"]["panels"]["trace"]["folded"])
        self.assertEqual(self.saved(session)["probe"]["tool"], "trace")

    def test_theme_and_scale_change_while_it_runs_and_names_have_any_script(self):
        names = {"1": {"name": "\u8840\u7ba1 \u2014 \u0430\u043e\u0440\u0442\u0430"},
                 "2": {"name": "\u0391\u03bf\u03c1\u03c4\u03ae, \u05d0\u05d1\u05d2, \u0639\u0631\u0642, " + "long " * 30}}
        session = self.write_ball(groups=names)
        self.started(session)
        self.do("key", "ctrl+shift+p", pause_s=0.7)
        self.do("type", "--delay", 5, 'prefer values={"theme":"light","scale":1.5,"font_pixels":16}', pause_s=0.7)
        self.do("key", "Return", pause_s=2)
        self.assertEqual((self.preferences()["theme"], self.preferences()["scale"]), ("light", 1.5))
        # Tools are where a larger scale puts them: at the old place is another one.
        scale = 1.5 * 16 / 14
        self.click(round(scale * (FIRST_TOOL + TOOL * 4)), round(scale * (MENU + TOOLS // 2)))
        self.do("key", "ctrl+s", pause_s=0.7)
        self.finish()
        self.assertEqual(self.saved(session)["probe"]["tool"], "select")

    def test_escape_closes_windows_and_then_the_tool(self):
        session = self.write_ball()
        self.started(session)
        self.do("key", "alt+2", "key", "ctrl+comma", pause_s=1)
        self.do("key", "Escape", pause_s=0.5)
        self.do("key", "ctrl+s", pause_s=0.5)
        self.assertEqual(self.saved(session)["probe"]["tool"], "paint")
        self.do("key", "Escape", pause_s=0.5)
        self.finish()
        self.assertEqual(self.saved(session)["probe"].get("tool", "turn"), "turn")

    def test_a_panel_is_used_by_keyboard_and_shortcuts_go_on(self):
        session = self.write_ball()
        self.started(session)
        self.do("mousemove", *self.middle(), "key", "ctrl+F6", pause_s=1)
        self.do("key", "space", pause_s=0.7)   # the first thing of the panel, and not guidance
        self.do("key", "7", pause_s=0.5)       # a shortcut as always
        self.do("key", "Escape", pause_s=0.5)
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertNotIn("Guidance", said)
        self.assertIn("Group 7", said)
        self.assertTrue(self.preferences()["layout"]["panels"]["transfer_function"]["folded"])



if __name__ == "__main__":
    unittest.main()
