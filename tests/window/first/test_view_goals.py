"""Frequent tasks by real events, with their clicks and keys counted: a typed text, a drop and a click count as one
each. More of them are in test_view_export.py: a mask, a spacing, an export."""
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from harness import Volume  # noqa: E402
from seen import Seen  # noqa: E402
from xdnd import Source  # noqa: E402

MOST = {"scan to a 3-D picture by a drop": 2, "recent scan to its picture": 2, "turntable movie": 3,
        "threshold of the whole volume": 3}


class Goals(Seen):
    inputs = 0

    def click(self, text, window=None):
        self.click_on(text, window)
        self.inputs += 1

    def key(self, chord):
        self.press(chord)
        self.inputs += 1

    def took(self, task):
        self.assertGreater(self.inputs, 0)
        self.assertLessEqual(self.inputs, MOST[task], task)
        print(f"{task}: {self.inputs} inputs")
        self.inputs = 0

    def test_a_scan_becomes_a_picture(self):
        scan = Volume.noise((16, 16, 16), seed=1).write(self.folder)
        self.view(preferences={"hints_seen": 3})
        self.see("Open the example")
        source = Source(self.display.name, int(self.window_named("SHVR")))
        self.addCleanup(source.close)
        source.drop([scan], self.middle())
        self.inputs += 1
        self.see("Transfer function", "Side panel")
        self.until(lambda: self.frame()["sharp"], "sharp picture")
        self.took("scan to a 3-D picture by a drop")
        self.finish()
        self.view()
        self.click(scan.name, "Start")
        self.until(lambda: self.frame()["sharp"], "sharp picture")
        self.took("recent scan to its picture")
        self.finish()

    def test_a_turntable_movie(self):
        self.open_scan(self.write_ball(volume={"procedural": "sphere", "size": [16, 16, 16]}),
                       preferences={"hints_seen": 3})
        self.click("File", "##MainMenuBar")
        self.click("Movie...", "##Menu_00")
        self.see("Draws 120 frames", "Movie")
        self.key("Return")
        self.see("Movie: frame ", "Status")
        self.took("turntable movie")
        self.assertEqual([line["op"] for line in self.done() if line["op"] == "movie"], ["movie"])
        self.click_on("Cancel", "Jobs")
        self.see("Cancelled: the movie", "Status")
        self.finish()

    def test_a_threshold_of_the_whole_volume_into_a_group(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        self.click("Edit", "##MainMenuBar")
        self.click("Threshold into a group...", "##Menu_00")
        window = "Operations on groups"
        self.until(lambda: any("voxels" in seen["text"] for seen in self.seen(window=window)), "preview")
        self.click("Apply", window)
        self.until(lambda: [line for line in self.done() if line["op"] == "threshold"], "threshold")
        self.took("threshold of the whole volume")
        self.press("Escape")
        self.check_key("Ctrl+Z", "undo")
        self.finish()


if __name__ == "__main__":
    unittest.main()
