"""Distances, paths and angles are clicked, named, listed with units and removed, and are there again at the next start."""
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from seen import Seen, only_panel  # noqa: E402

PANEL = "Side panel"


class Measures(Seen):
    def clicks(self, *places):
        for x, y in places:
            before = self.frame()["frame"]
            self.do("mousemove", x - 1, y, "mousemove", x, y, "sleep", 0.1, "click", 1, pause_s=0.5)
            self.until(lambda: self.frame()["frame"] > before, "a frame")

    def test_a_path_and_an_angle_are_measured_named_and_kept(self):
        session = self.write_ball()
        self.open_scan(session, preferences=only_panel("measurements"))
        x, y = self.middle()
        self.click_on("Path", PANEL)
        self.clicks((x - 60, y), (x, y - 40), (x + 60, y), (x + 40, y + 20))
        self.check_key("Ctrl+Z", "take_back_point")
        self.check_key("Enter", "end_measure")
        self.see("Path 1: ", "Status")
        self.see("Path 1: ")
        # A path that is begun is kept when another tool is chosen, and undo takes it back.
        self.clicks((x - 60, y), (x + 60, y))
        self.check_key("Alt+1", "set probe.tool")
        self.see("Path 2: ")
        self.check_key("Ctrl+Z", "undo")
        self.see_no_more("Path 2: ")
        self.click_on("Angle", PANEL)
        self.clicks((x - 40, y + 30), (x, y + 30), (x, y - 10))
        self.see("Angle 1: ", "Status")
        self.click_on("Angle 1", PANEL)
        self.select_all()
        self.do("type", "--delay", 40, "petiole", pause_s=0.2)
        self.press("Enter")
        self.see("petiole: ")
        self.check_key("Ctrl+S", "save")
        self.finish()
        kept = json.loads(session.read_text())["measurements"]
        self.assertEqual([(one["name"], one["kind"], len(one["points"])) for one in kept],
                         [("Path 1", "path", 3), ("petiole", "angle", 3)])
        table = self.folder / "table.csv"
        self.check("export", session, "--measurements", table)
        self.assertTrue(table.read_text().startswith("number,name,kind,length_voxel,angle_degrees,points_voxel_physical\n"))


if __name__ == "__main__":
    unittest.main()
