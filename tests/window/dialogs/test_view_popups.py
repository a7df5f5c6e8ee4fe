"""Popups of panels: a dialog that a shortcut shows closes them, and so does Escape; names are typed in them. Names are
shown as they are written, in lists and menus, too."""
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from seen import Seen, in_short, only_panel  # noqa: E402

FONT = 14   # pixels, as it ships
EXPORT = "Export annotation"
POPUP = "##Popup"


class Popups(Seen):
    def open_groups(self):
        self.open_scan(self.write_ball(groups={"3": {"name": "root"}}), preferences=only_panel("groups"))

    def open_picker(self):
        """Of group 3, by a click on its colour, left of the column See; the pointer stays there."""
        _, top, _, bottom = self.see_at_rest("3  root", "Side panel")["box"]
        left = self.see_at_rest("See", "Side panel")["box"][0]
        self.do("mousemove", round(left - FONT), round((top + bottom) / 2), pause_s=0)
        self.see_frames()
        for step in ("mousedown", "mouseup"):
            self.do(step, 1, pause_s=0)
            self.see_frames(1)
        self.see("#", POPUP)

    def open_list(self):
        self.click_on("3  root", "Tools")
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
        self.click_on("3  root", "Side panel", button=3)
        self.see("Belongs to no group", POPUP)
        self.see_frames()   # the field has the keys from the second one on
        self.press("Escape")
        self.see_no_more("", POPUP)
        self.check_key("Ctrl+E", "show_dialog")
        self.see("Cancel", EXPORT)
        self.press("Escape")
        self.see_no_more("", EXPORT)
        self.finish()

    def names(self):
        """What group 3 was named, in order."""
        return [action["values"]["groups"]["3"]["name"] for action in self.done()
                if in_short(action) == "set groups.3.name"]

    def begin_name(self, *keys):
        """Types a name over the present one, which is selected, in the popup of the button."""
        self.click_on("Rename", "Side panel")
        self.see("root", POPUP)
        self.see_frames()   # the field has the keys from the second one on
        self.do(*keys, pause_s=0)
        self.see_frames()

    def check_named(self, name):
        """Its popup is closed, and one undone step takes the name back."""
        self.see_no_more("", POPUP)
        self.see(f"3  {name}", "Side panel")
        self.check_key("Ctrl+Z", "undo")
        self.see("3  root", "Side panel")

    def test_a_typed_name_is_one_step_of_the_history(self):
        self.open_groups()
        wanted = "set groups.3.name"
        self.begin_name("type", "--delay", 40, " vein 1 ")
        self.check_key("Enter", wanted)
        self.check_named("vein 1")
        self.begin_name("type", "--delay", 40, "leaf")
        self.check_follows(lambda: self.click_on("Transfer function", "Side panel"), wanted)   # elsewhere
        self.check_named("leaf")
        self.click_on("3  root", "Side panel", button=3)
        self.see("Belongs to no group", POPUP)
        self.see_frames()
        self.do("type", "--delay", 40, "stalk", pause_s=0)
        self.see("stalk", POPUP)
        self.check_key("Enter", wanted)
        self.check_named("stalk")
        for keys, last in ((("type", "--delay", 40, "pith"), "Escape"), (("key", "BackSpace"), "Enter")):
            self.begin_name(*keys)
            self.press(last)
            self.see_no_more("", POPUP)
            self.see("3  root", "Side panel")
        self.click_on("3  root", "Side panel", button=3)
        self.check_follows(lambda: self.click_on("Default name", POPUP), wanted)
        self.see("3  group 3", "Side panel")
        self.finish()
        self.assertEqual(self.names(), ["vein 1", "leaf", "stalk", None])

    def test_names_with_signs_are_shown_in_full(self):
        # Dear ImGui would end the labels of its widgets before "##".
        session = self.write_ball(groups={"3": {"name": "v##x###y"}}, cameras={"top##1": {"side": "top"}})
        session = session.rename(self.folder / "ball##1.json")
        name = "3  v##x###y"
        self.open_scan(session, preferences={**only_panel("groups"), "recent": [{"path": str(session)}]})
        self.see(name, "Side panel")
        self.click_on(name, "Tools")
        self.see(name, "##Combo_00")
        self.press("Escape")
        self.see_no_more("", "##Combo_00")
        for path, words in ((("Paint",), name), (("View", "Kept views"), "top##1"), (("View", "Look from"), "top##1"),
                            (("File", "Open recent"), str(session))):
            self.click_on(path[0], "##MainMenuBar")
            for entry in path[1:]:
                self.click_on(entry, "##Menu_00")
            self.see(words, f"##Menu_{len(path) - 1:02}")
            self.press("Escape")
            self.see_no_more("", "##Menu_")
        self.finish()


if __name__ == "__main__":
    unittest.main()
