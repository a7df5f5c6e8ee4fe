"""Popups of panels: a dialog that a shortcut shows closes them, and so does Escape; names are typed in them."""
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from seen import Seen, only_panel  # noqa: E402

FONT = 14   # pixels, as it ships
EXPORT = "Export annotation"
POPUP = "##Popup"


class Popups(Seen):
    def open_groups(self):
        session = self.write_ball()
        self.open_scan(session, preferences=only_panel("groups"))
        return session

    def open_picker(self):
        """Of group 3, by a click on its colour, left of the column See; the pointer stays there."""
        _, top, _, bottom = self.see_at_rest("3  group 3", "Side panel")["box"]
        left = self.see_at_rest("See", "Side panel")["box"][0]
        self.do("mousemove", round(left - FONT), round((top + bottom) / 2), pause_s=0)
        self.see_frames()
        for step in ("mousedown", "mouseup"):
            self.do(step, 1, pause_s=0)
            self.see_frames(1)
        self.see("#", POPUP)

    def open_list(self):
        self.click_on("3  group 3", "Tools")
        self.see("", "##Combo_00")

    def test_a_dialog_closes_an_open_popup(self):
        self.open_groups()
        for open_popup, window in ((self.open_picker, POPUP), (self.open_list, "##Combo_00")):
            open_popup()
            self.check_key("Ctrl+E", "show_dialog")
            self.see("Cancel", EXPORT)
            self.see_no_more("", window)
            self.press("Escape")
            self.see_no_more("", EXPORT)
        self.finish()

    def test_escape_closes_a_popup_even_out_of_its_field(self):
        self.open_groups()
        self.open_picker()
        self.click_on("#", POPUP)   # the colour as hexadecimal digits
        self.press("Escape")
        self.see_no_more("", POPUP)
        self.click_on("3  group 3", "Side panel", button=3)
        self.see("Belongs to no group", POPUP)
        self.see_frames()   # the field has the keys from the second one on
        self.press("Escape")
        self.see_no_more("", POPUP)
        self.check_key("Ctrl+E", "show_dialog")
        self.see("Cancel", EXPORT)
        self.press("Escape")
        self.see_no_more("", EXPORT)
        self.finish()


if __name__ == "__main__":
    unittest.main()
