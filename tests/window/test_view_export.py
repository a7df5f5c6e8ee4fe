"""Exporting by its dialog, onto a disk that does not answer."""
import unittest

from seen import Seen


class Export(Seen):
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
        # A trace and labels would need to be there; that is known without the disk.
        self.type_into("Trace", hung / "out.swc")
        self.see("nothing is traced yet")
        self.type_into("Trace", "")
        self.type_into("Mask", hung / "out.nrrd")
        self.see("Waiting for the disk")
        before = self.frame()["frame"]
        self.until(lambda: self.frame()["frame"] > before + 5, "frames beside it")
        answers.write_text("")
        self.see_no_more("Waiting for the disk")
        self.click_on("Export", "Export annotation")
        self.wait_for_file(hung / "out.nrrd")
        self.see("Exported")
        self.finish()
        self.assertEqual(log.read_text() if log.exists() else "", "", "the main thread asked the disk")

    def test_an_import_takes_at_most_the_memory_of_the_preferences(self):
        scan = self.folder / "scan.nrrd"
        scan.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n\n" + bytes(512))
        self.view(preferences={"hints_seen": 3, "budget_host_mib": 16})   # less than any import takes
        self.see("Open the example")
        self.click_on("File", "##MainMenuBar")
        self.click_on("Import as project...", "##Menu_00")
        self.type_into("Volume", scan, "Import as project")
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
        self.see("Volume", "Import as project")
        self.do("type", "--delay", 40, scan, pause_s=0)   # at once, without a click
        self.see(str(scan), "Import as project")
        self.press("Return")                              # refused: the project has no name yet
        self.type_into("Project", self.folder / "project", "Import as project")
        self.press("Return")
        self.see_no_more("", "Import as project")
        self.see("Transfer function", "Side panel")
        self.click_on("File", "##MainMenuBar")
        self.click_on("Correct the spacing...", "##Menu_00")
        self.see("Cancel", "Correct the spacing")
        self.check_follows(lambda: self.press("Return"), "correct_spacing")
        self.see_no_more("", "Correct the spacing")
        self.finish()
        self.assertTrue((self.folder / "project").is_dir())


if __name__ == "__main__":
    unittest.main()
