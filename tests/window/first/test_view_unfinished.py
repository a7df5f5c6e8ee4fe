"""What a cancelled import has left: said in a banner, also by the next run, and resumed or deleted by a button."""
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from seen import Seen  # noqa: E402


class Unfinished(Seen):
    def begin_import(self):
        scan, self.project = self.folder / "scan.nrrd", self.folder / "hung" / "project"
        self.project.parent.mkdir(exist_ok=True)
        scan.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 80 70 66\nencoding: raw\n\n" +
                         bytes(number * 7 % 251 for number in range(80 * 70)) * 66)
        self.answers = self.folder / "answers"
        self.view(preferences={"hints_seen": 3}, environment={
            **self.hung_disk(self.answers, self.folder / "hung.log"), "SHVR_HUNG_PATH": "/project.part/1/0/"})
        self.see("Open the example")
        self.press("Ctrl+I")
        self.see("Cancel", "Import as project")
        self.type_into("Scan", scan, "Import as project")
        self.type_into("Project", self.project, "Import as project")
        self.see("The scan has 80 x 70 x 66 voxels", "Import as project")
        self.press("Return")
        self.part = self.project.with_name("project.part")
        self.until(lambda: any(self.part.glob("0/0/*/*")), "chunk")

    def cancel_import(self):
        """The disk answers again only when the window has heard the click: what is left to do takes no time."""
        self.click_on("Cancel", "Jobs")
        self.until(lambda: any(line["op"] == "cancel_job" for line in self.done()), "cancelled job")
        self.answers.write_text("")

    def test_a_cancelled_import_names_what_it_left_and_is_resumed_or_deleted(self):
        self.begin_import()
        self.cancel_import()
        self.see("An import was not finished: ", "Unfinished import")
        said = "".join(seen["text"] for seen in self.seen(window="Unfinished import"))
        self.assertRegex(said.replace(" ", ""), r"project\.parttakes[\d.]+(kB|MB)ofthedisk")
        # It is told by the next run, too, which goes on with it.
        self.finish()
        self.view(preferences=None)
        self.click_on("Resume the import", "Unfinished import")
        self.see("Opened ", "Status")
        self.see_no_more("", "Unfinished import")
        self.assertFalse(self.part.exists())
        self.finish()

    def test_what_a_cancelled_import_has_left_is_deleted_by_a_button(self):
        self.begin_import()
        self.cancel_import()
        self.click_on("Delete what is left", "Unfinished import")
        self.until(lambda: not self.part.exists(), "deleted remainder")
        self.see_no_more("", "Unfinished import")
        self.finish()
        self.view(preferences=None)
        self.see("Open the example")
        self.see_frames(6)
        self.assertEqual(self.seen(window="Unfinished import"), [])
        self.finish()


if __name__ == "__main__":
    unittest.main()
