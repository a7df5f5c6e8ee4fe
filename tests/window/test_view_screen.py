"""Tools, panels, theme, sizes and keyboard, by real events on a virtual display."""
import json
import unittest

from harness import read_png_header
from seen import Seen
from window import SIDE_PANEL, WINDOW

MENU, TOOLS = 20, 31          # heights in pixels, at a scale of 1
TOOL, FIRST_TOOL = 31, 20     # from tool to tool, and the middle of the first
NO_HINTS = {"hints_seen": 3}


class Screen(Seen):
    def preferences(self):
        return json.loads((self.configuration / "preferences.json").read_text())

    def preferred(self, *keys, holds):
        """Waits until the file of preferences has that value there, and returns it."""
        def value():
            found = self.preferences()
            for key in keys:
                found = found.get(key) if isinstance(found, dict) else None
            return found
        self.until(lambda: value() is not None and holds(value()), f"value of {'.'.join(keys)} in the preferences")
        return value()

    def click(self, x, y, makes):
        self.do("mousemove", x, y, pause_s=0)
        self.see_frames()
        self.check_follows(lambda: self.do("mousedown", 1, "sleep", 0.1, "mouseup", 1, pause_s=0), makes)

    def type_in_palette(self, line, makes):
        self.press("Ctrl+Shift+P")
        self.see("", "Find anything")
        self.see_frames()   # it has the keys from the second one on
        self.do("type", "--delay", 5, line, pause_s=0)
        self.see(line[:20], "Find anything")
        self.see_frames()
        self.check_key("Enter", makes)
        self.see_no_more("", "Find anything")

    def photograph(self, number=1):
        self.see_picture()
        self.check_key("F12", "screenshot")
        path = self.folder / f"session-view-{number}.png"
        self.wait_for_file(path)
        return read_png_header(path)

    def test_a_click_takes_a_tool_and_steps_through_groups(self):
        session = self.write_ball()
        self.open_scan(session, preferences=NO_HINTS)
        for number in [1, 4, 2]:
            self.click(FIRST_TOOL + TOOL * number, MENU + TOOLS // 2, makes="set probe.tool")
        for _ in range(2):
            self.check_key("Alt+PageDown", "set probe.group")
        report = self.finish()
        said = "\n".join(report["messages"])
        for name in ["Paint (left: paint,", "Select (", "Erase (left: erase,", "Group 4: ", "Group 5: "]:
            self.assertIn(name, said)
        saved = json.loads(session.read_text())
        self.assertEqual(saved["probe"]["tool"], "erase")
        self.assertEqual(saved["probe"]["group"], 5)

    def test_panels_are_widened_hidden_and_remembered(self):
        session = self.write_ball()
        self.open_scan(session, preferences=NO_HINTS)
        edge = WINDOW[0] - SIDE_PANEL
        self.check_drag((edge, 300), [(edge + 35, 300), (edge + 70, 300)], "prefer")
        width = self.preferred("layout", "side_width", holds=lambda value: value < (SIDE_PANEL - 60) / 14)
        self.assertAlmostEqual(width, (SIDE_PANEL - 70) / 14, delta=0.3)
        self.check_key("Ctrl+B", "prefer")
        self.preferred("layout", "shows_side", holds=lambda value: value is False)
        self.assertEqual(self.photograph()[0], WINDOW[0])   # the picture is as wide as the window now
        self.finish()

        self.open_scan(session)   # remembered
        self.check_key("Ctrl+B", "prefer")
        self.assertAlmostEqual(self.photograph(2)[0], WINDOW[0] - round(14 * width), delta=1)
        self.finish()

    def test_the_side_takes_at_most_half_of_a_narrow_window(self):
        self.open_scan(self.write_ball(), preferences={**NO_HINTS, "layout": {"side_width": 60}})
        self.assertEqual(self.photograph()[0], WINDOW[0] // 2)
        self.finish()

    def test_tracing_is_folded_while_tracing_and_a_panel_floats_and_comes_back(self):
        session = self.write_ball()
        self.open_scan(session, preferences=NO_HINTS)
        line = '{"layout":{"panels":{"transfer_function":{"place":"floating","at":[4,8]}}}}'
        self.type_in_palette(f"prefer values={line}", "prefer")
        panel = ("layout", "panels", "transfer_function", "place")
        self.preferred(*panel, holds=lambda value: value == "floating")
        # Its own window: the button that puts it back is its first line.
        self.see_frames()
        self.click(4 * 14 + 50, 8 * 14 + 38, makes="prefer")
        self.preferred(*panel, holds=lambda value: value == "side")
        self.do("mousemove", *self.middle(), pause_s=0)
        self.check_key("X", "set probe.tool")
        self.type_in_palette('prefer values={"layout":{"panels":{"trace":{"folded":true}}}}', "prefer")
        self.preferred("layout", "panels", "trace", "folded", holds=lambda value: value is True)
        self.finish()
        self.assertEqual(json.loads(session.read_text())["probe"]["tool"], "trace")

    def test_theme_and_scale_change_while_it_runs_and_names_have_any_script(self):
        names = {"1": {"name": "\u8840\u7ba1 \u2014 \u0430\u043e\u0440\u0442\u0430"},
                 "2": {"name": "\u0391\u03bf\u03c1\u03c4\u03ae, \u05d0\u05d1\u05d2, \u0639\u0631\u0642, " + "long " * 30}}
        session = self.write_ball(groups=names)
        self.open_scan(session, preferences=NO_HINTS)
        self.type_in_palette('prefer values={"theme":"light","scale":1.5,"font_pixels":16}', "prefer")
        self.preferred("scale", holds=lambda value: value == 1.5)
        self.assertEqual(self.preferences()["theme"], "light")
        # Tools are where a larger scale puts them: at the old place is another one.
        self.see_frames()
        scale = 1.5 * 16 / 14
        self.click(round(scale * (FIRST_TOOL + TOOL * 4)), round(scale * (MENU + TOOLS // 2)), makes="set probe.tool")
        self.finish()
        self.assertEqual(json.loads(session.read_text())["probe"]["tool"], "select")

    def test_escape_closes_windows_and_then_the_tool(self):
        session = self.write_ball()
        self.open_scan(session, preferences=NO_HINTS)
        self.check_key("Alt+2", "set probe.tool")
        self.press("Ctrl+,")
        self.see("Text", "Preferences")
        self.see_frames()
        self.press("Escape")
        self.see_no_more("", "Preferences")
        self.assertEqual(self.saved(session)["probe"]["tool"], "paint")
        self.check_key("Escape", "set probe.tool")
        self.finish()
        self.assertEqual(json.loads(session.read_text())["probe"].get("tool", "turn"), "turn")

    def test_a_panel_is_used_by_keyboard_and_shortcuts_go_on(self):
        self.open_scan(self.write_ball(), preferences=NO_HINTS)
        self.do("mousemove", *self.middle(), pause_s=0)
        self.check_key("Ctrl+F6", "focus")
        self.see_frames()
        self.check_key("Space", "prefer")          # the first thing of the panel, and not guidance
        self.check_key("7", "set probe.group")     # a shortcut as always
        self.press("Escape")
        self.see_frames()
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertNotIn("Guidance", said)
        self.assertIn("Group 7", said)
        self.assertTrue(self.preferences()["layout"]["panels"]["transfer_function"]["folded"])


if __name__ == "__main__":
    unittest.main()
