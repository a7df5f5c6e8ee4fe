"""Frequent tasks by real events, with their clicks and keys counted."""
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from counted import Counted  # noqa: E402
from harness import Volume  # noqa: E402
from xdnd import Source  # noqa: E402

MOST = {"scan to a 3-D picture by a drop": 2, "by a double click in the chooser": 2, "by keys in the chooser": 2,
        "recent scan to its picture": 2, "turntable movie": 3,
        "threshold of the whole volume": 3, "export mask, trace and measures": 2, "the same with the mouse": 3,
        "load a mask": 3, "load a mask that is suggested, with the mouse": 3, "spacing": 4, "import a scan": 3,
        "set a value": 3}


class Goals(Counted):
    most = MOST

    def test_a_scan_becomes_a_picture(self):
        scan = Volume.noise((16, 16, 16), seed=1).write(self.folder)
        self.view(preferences={"hints_seen": 3})
        self.see("Open the example")
        source = Source(self.display.name, int(self.window_named("SHVR")))
        self.addCleanup(source.close)
        self.drop(source, [scan])
        self.see("Transfer function", "Side panel")
        self.until(lambda: self.frame()["sharp"], "sharp picture")
        self.took("scan to a 3-D picture by a drop")
        self.finish()
        self.view()
        self.click(scan.name, "Start")
        self.until(lambda: self.frame()["sharp"], "sharp picture")
        self.took("recent scan to its picture")
        self.finish()

    def open_in_chooser(self, task, choose, count=1):
        """From a start in a folder with that many scans and a folder, to the picture."""
        scans = self.folder / "scans"
        (scans / "deep").mkdir(parents=True)
        (scans / "notes.txt").write_text("no scan")
        names = [f"leaf{i}.nrrd" for i in range(count)]
        for name in names:
            (scans / name).write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n\n" +
                                       bytes(range(256)) * 16)
        self.view(preferences={"hints_seen": 3, "recent": [{"path": str(scans / names[0])}]})
        self.see("Open the example")
        self.key("Ctrl+O")
        choose(names[-1])
        self.see("Transfer function", "Side panel")
        self.until(lambda: self.frame()["sharp"], "sharp picture")
        self.took(task)
        messages = self.finish()["messages"]
        self.assertTrue(any(line.startswith("Opened ") and names[-1] in line for line in messages), messages)

    def test_a_double_click_in_the_chooser_opens_a_scan(self):
        self.open_in_chooser("by a double click in the chooser",
                             lambda name: self.double_click(name, "Open a volume"), count=2)

    def test_enter_in_the_chooser_opens_the_only_scan_of_a_folder(self):
        def choose(name):
            self.see_at_rest(name, "Open a volume")
            self.key("Return")
        self.open_in_chooser("by keys in the chooser", choose)

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

    def open_annotated(self):
        session = self.write_ball(volume={"procedural": "sphere", "size": [32, 32, 32]})
        self.check("annotate", session, "--script", self.write_script("s.jsonl", [
            {"op": "paint", "brush": "fill", "region": "ball", "path": [[16, 16, 16]], "radius": 5, "threshold": 0,
             "group": 1},
            {"op": "node", "at": [16, 16, 16], "radius": 2, "group": 1}, {"op": "save"}]))
        self.open_scan(session, preferences={"hints_seen": 3})
        return session

    def exported(self):
        self.see("Exported ", "Status")
        names = {path.suffix for path in self.folder.glob("*-m*")} | {path.suffix for path in self.folder.glob("*-trace.*")}
        self.assertEqual(names, {".nrrd", ".csv", ".graphml"})

    def test_exporting_mask_trace_and_measures(self):
        self.open_annotated()
        self.key("Ctrl+E")
        self.see("Writes 3 files", "Export annotation")
        self.key("Return")
        self.exported()
        self.took("export mask, trace and measures")
        self.click("File", "##MainMenuBar")
        self.click("Export...", "##Menu_00")
        self.until(lambda: any("replaced" in seen["text"] for seen in self.seen(window="Export annotation")), "warning")
        self.key("Return")
        self.see_no_more("Cancel", "Export annotation")
        self.exported()
        self.took("the same with the mouse")
        self.finish()

    def test_loading_a_mask(self):
        session = self.write_ball(volume={"procedural": "sphere", "size": [16, 16, 16]})
        mask = self.folder / "leaf-mask.nrrd"
        mask.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n\n" + b"\3" * 4096)
        self.open_scan(session, preferences={"hints_seen": 3})
        self.key("Ctrl+L")
        self.see("Cancel", "Load annotation")
        self.text(mask, "Load annotation")
        self.see("+4096", "Load annotation")
        self.key("Return")
        self.see("Loaded the mask of ", "Status")
        self.took("load a mask")
        self.press("Ctrl+Z")
        self.see("Undone", "Status")
        self.click("File", "##MainMenuBar")
        self.click("Load annotation...", "##Menu_00")
        self.see("+4096", "Load annotation")   # the newest in the folder is suggested, and previewed
        self.key("Return")
        self.see("Loaded the mask of ", "Status")
        self.took("load a mask that is suggested, with the mouse")
        self.assertEqual(self.finish()["voxels_in_group"], {"3": 4096})

    def test_the_size_of_a_voxel(self):
        scan = Volume.noise((16, 16, 16), seed=1).write(self.folder)
        session = self.write_session(volume={"path": scan.name})
        self.open_scan(session, preferences={"hints_seen": 3})
        self.click("File", "##MainMenuBar")
        self.click("Correct the spacing...", "##Menu_00")
        self.see("Cancel", "Correct the spacing")
        self.text("0.8 0.8 1.2 um", "Correct the spacing")
        self.key("Return")
        self.until(lambda: [line for line in self.done() if line["op"] == "correct_spacing"], "correction")
        self.took("spacing")
        self.finish()
        self.assertIn("1.2", session.read_text())

    def test_importing_a_scan(self):
        scan = Volume.noise((16, 16, 16), seed=1).write(self.folder)
        self.view(preferences={"hints_seen": 3})
        self.see("Open the example")
        self.key("Ctrl+I")
        self.see("Cancel", "Import as project")
        self.text(scan, "Import as project")
        self.see("The scan has 16 x 16 x 16 voxels", "Import as project")
        self.key("Return")
        self.see("Transfer function", "Side panel")
        self.took("import a scan")
        self.finish()
        self.assertTrue((self.folder / f"{scan.stem}-project").is_dir())

    def test_setting_a_value_by_its_label(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        self.key("Ctrl+Shift+P")
        self.see("", "Find anything")
        self.text("ambient light 0.4", "Find anything")
        self.key("Return")
        self.until(lambda: {"op": "set", "values": {"light": {"ambient": 0.4}}} in self.done(), "ambient light")
        self.see("Set ambient light from 0.3 to 0.4", "Status")
        self.took("set a value")
        self.finish()



if __name__ == "__main__":
    unittest.main()
