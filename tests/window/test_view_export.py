"""Exporting and importing by their dialogs, onto a disk that does not answer, and over what is there."""
import unittest

from harness import Volume
from seen import Seen

WINDOW, IMPORT = "Export annotation", "Import as project"


class Export(Seen):
    def says(self, words, window):
        """Waits for words that may be on several lines."""
        self.until(lambda: words.replace(" ", "") in "".join(
            seen["text"] for seen in self.seen(window=window)).replace(" ", ""), f"'{words}'")

    def test_a_dialog_waits_for_the_disk_in_words_and_the_window_goes_on(self):
        hung = self.folder / "hung"
        hung.mkdir()
        session = self.write_ball(volume={"procedural": "sphere", "size": [16, 16, 16]},
                                  annotation={"trace": str(hung / "trace.graphml")})
        answers, log = self.folder / "answers", self.folder / "hung.log"
        answers.write_text("")   # until it is open
        self.open_scan(session, preferences={"hints_seen": 3}, environment=self.hung_disk(answers, log))
        answers.unlink()
        log.unlink(missing_ok=True)
        self.click_on("File", "##MainMenuBar")
        self.click_on("Export...", "##Menu_00")
        # The suggestion needs no disk; nothing is traced, so no trace is offered.
        self.see("nothing is traced yet", WINDOW)
        self.do("key", "ctrl+a", "type", "--delay", 40, hung / "out", pause_s=0)
        self.see("Waiting for the disk")
        before = self.frame()["frame"]
        self.until(lambda: self.frame()["frame"] > before + 5, "frames beside it")
        answers.write_text("")
        self.see_no_more("Waiting for the disk")
        self.click_on("Export", WINDOW)
        self.wait_for_file(hung / "out-mask.nrrd")
        self.see("Exported")
        self.finish()
        self.assertEqual(log.read_text() if log.exists() else "", "", "the main thread asked the disk")

    def test_all_annotation_is_exported_by_a_key_and_enter_and_the_message_names_the_folder(self):
        session = self.write_ball()
        self.check("annotate", session, "--script", self.write_script("s.jsonl", [
            {"op": "paint", "brush": "fill", "region": "ball", "path": [[32, 32, 32]], "radius": 5, "threshold": 0,
             "group": 1},
            {"op": "node", "at": [32, 32, 32], "radius": 2, "group": 1}, {"op": "node", "at": [40, 32, 32], "radius": 2},
            {"op": "save"}]))
        self.open_scan(session, preferences={"hints_seen": 3})
        self.press("Ctrl+E")
        self.see("Writes 3 files to " + str(self.folder), WINDOW)
        self.do("key", "n", pause_s=0)              # typed into the name, not acting behind the dialog
        self.see("n-mask.nrrd, 262 kB", WINDOW)
        # Keys and text that arrive during one long frame take effect in their order.
        self.at_once("key", "BackSpace", "type", "--delay", 2, "bean")
        self.see("bean-mask.nrrd, 262 kB", WINDOW)
        self.at_once("key", "ctrl+a", "type", "--args", 1, "--delay", 2, "stalk", "key", "--delay", 2, "BackSpace",
                     "BackSpace", "Home", "Delete", "e")
        self.see("eta-mask.nrrd, 262 kB", WINDOW)
        self.at_once("key", "ctrl+a", "type", "--delay", 2, "leaf")
        self.see("leaf-mask.nrrd, 262 kB", WINDOW)   # a relative name is beside the scan
        self.press("Return")
        self.see_no_more("Cancel", WINDOW)
        self.see("Exported leaf-trace.graphml, leaf-mask.nrrd and leaf-measures.csv to ", "Status")
        report = self.finish()
        said = next(line for line in report["messages"] if line.startswith("Exported"))
        self.assertIn(f" to {self.folder} (", said)
        self.assertEqual(sorted(path.name for path in self.folder.glob("leaf-*")),
                         ["leaf-mask.nrrd", "leaf-measures.csv", "leaf-trace.graphml"])
        trace = (self.folder / "leaf-trace.graphml").read_text()
        self.assertEqual(trace.count("<node "), 2, "letters typed into the name act on nothing behind the dialog")
        self.assertEqual((report["undoable"], report["redoable"]), (3, 0))

    def test_surfaces_are_exported_by_a_tick(self):
        session = self.write_ball()
        self.check("annotate", session, "--script", self.write_script("s.jsonl", [
            {"op": "paint", "brush": "fill", "region": "ball", "path": [[32, 32, 32]], "radius": 5, "threshold": 0,
             "group": 1}, {"op": "save"}]))
        self.open_scan(session, preferences={"hints_seen": 3})
        self.press("Ctrl+E")
        self.see("Writes 2 files to ", WINDOW)
        self.see("session-surface", WINDOW)
        # The box to tick is left of the format.
        x0, y0, _, y1 = self.see_at_rest(".ply", WINDOW)["box"]
        self.do("mousemove", round(x0 - 1.7 * (y1 - y0)), round((y0 + y1) / 2), "sleep", 0.1, "mousedown", 1, "sleep",
                0.1, "mouseup", 1, pause_s=0.2)
        self.see("Writes 3 files to ", WINDOW)
        self.press("Return")
        self.see_no_more("Cancel", WINDOW)
        self.see("Exported ", "Status")
        self.finish()
        surface = next(self.folder.glob("*-surface.ply"))
        faces = int(surface.read_bytes().split(b"element face ")[1].split()[0])
        self.assertGreater(faces, 500)

    def test_text_goes_into_the_name_even_with_more_unfolded(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        self.press("Ctrl+E")
        self.see("Writes 1 file to ", WINDOW)
        self.click_on("More", WINDOW)
        self.see("Density offsets", WINDOW)
        self.press("Escape")
        self.see_no_more("Cancel", WINDOW)
        self.press("Ctrl+E")
        self.see("Density offsets", WINDOW)
        self.do("key", "ctrl+a", "type", "--delay", 40, "hello", pause_s=0)
        self.see("hello-mask.nrrd, 262 kB", WINDOW)
        self.press("Escape")
        self.finish()

    def test_a_mistake_is_told_in_the_dialog_and_the_dialog_stays(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        self.press("Ctrl+E")
        self.see("Writes 1 file to ", WINDOW)
        self.do("key", "ctrl+a", "type", "--delay", 40, "/nowhere/at/all/leaf", pause_s=0)
        self.see("/nowhere/at/all/leaf-mask.nrrd: cannot be written: there is no folder", WINDOW)
        self.press("Return")
        self.see_frames()
        self.see("Cancel", WINDOW)
        self.do("key", "ctrl+a", "type", "--delay", 2, "x" * 300, pause_s=0)
        self.says("is too long, with 310 bytes; expected at most 255", WINDOW)
        self.press("Return")
        self.see_frames()
        self.see("Cancel", WINDOW)
        self.press("Escape")
        self.see_no_more("Cancel", WINDOW)
        report = self.finish()
        self.assertNotIn("nowhere", "\n".join(report["messages"]))

    def test_an_import_over_a_project_names_the_annotation_that_is_lost_and_over_a_file_is_refused(self):
        scan, project = self.folder / "scan.nrrd", self.folder / "plant"
        scan.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n\n" + bytes(range(256)) * 2)
        self.check("import", scan, project, "--quiet")
        self.check("annotate", project, "--script", self.write_script("s.jsonl", [
            {"op": "paint", "brush": "fill", "region": "ball", "path": [[4, 4, 4]], "radius": 2, "threshold": 0,
             "group": 1}, {"op": "save"}]))
        self.view(preferences={"hints_seen": 3})
        self.see("Open the example")
        self.press("Ctrl+I")
        self.see("Cancel", IMPORT)
        self.type_into("Scan", scan, IMPORT)
        self.type_into("Project", project, IMPORT)
        self.says("plant: exists already; expected a new name, or Overwrite under More", IMPORT)
        self.click_on("More", IMPORT)
        # The box to tick begins nine letters' heights right of the row's name.
        x0, y0, _, y1 = self.see_at_rest("Overwrite", IMPORT)["box"]
        self.do("mousemove", x0 + 9 * 14 + 8, round((y0 + y1) / 2), "sleep", 0.1, "mousedown", 1, "sleep", 0.1,
                "mouseup", 1, pause_s=0.2)
        self.says("plant exists and will be deleted, with its annotation: paint (labels/paint)", IMPORT)
        self.says("The scan has 8 x 8 x 8 voxels", IMPORT)   # still
        self.type_into("Project", scan, IMPORT)
        self.says("scan.nrrd: is a file; expected a new name", IMPORT)
        self.press("Return")
        self.see_frames()
        self.see("Cancel", IMPORT)
        self.press("Escape")
        self.see_no_more("", IMPORT)
        self.finish()
        self.assertTrue((project / "labels" / "paint").is_dir())

    def test_an_import_takes_at_most_the_memory_of_the_preferences(self):
        scan = self.folder / "scan.nrrd"
        scan.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n\n" + bytes(512))
        self.view(preferences={"hints_seen": 3, "budget_host_mib": 16})   # less than any import takes
        self.see("Open the example")
        self.click_on("File", "##MainMenuBar")
        self.click_on("Import as project...", "##Menu_00")
        self.type_into("Scan", scan, "Import as project")
        self.type_into("Project", self.folder / "project", "Import as project")
        self.click_on("Import", "Import as project")
        self.until(lambda: any("expected at most 16 MiB" in seen["text"] for seen in self.seen()), "refusal")
        self.finish()
        self.assertFalse((self.folder / "project").exists())

    def test_text_typed_as_a_dialog_appears_is_kept_and_enter_confirms_it(self):
        scan = self.folder / "scan.nrrd"
        scan.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n\n" + bytes(range(256)) * 2)
        self.view(preferences={"hints_seen": 3})
        self.see("Open the example")
        self.click_on("File", "##MainMenuBar")
        self.click_on("Import as project...", "##Menu_00")
        self.see("Scan", "Import as project")
        self.do("type", "--delay", 40, scan, pause_s=0)   # at once, without a click
        self.see(str(scan), "Import as project")
        self.see(str(self.folder / "scan-project"), "Import as project")   # suggested
        self.see("The scan has 8 x 8 x 8 voxels of uint8", "Import as project")
        self.press("Return")
        self.see_no_more("", "Import as project")
        self.see("Transfer function", "Side panel")
        self.click_on("File", "##MainMenuBar")
        self.click_on("Correct the spacing...", "##Menu_00")
        self.see("Cancel", "Correct the spacing")
        self.check_follows(lambda: self.press("Return"), "correct_spacing")
        self.see_no_more("", "Correct the spacing")
        self.finish()
        self.assertTrue((self.folder / "scan-project").is_dir())


if __name__ == "__main__":
    unittest.main()
