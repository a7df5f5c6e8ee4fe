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

    def type_into(self, field, text):
        """Into the field beside that word, which begins right of it, in place of what it holds."""
        x0, y0, x1, y1 = self.see_at_rest(field, "Export annotation")["box"]
        others = [seen["box"] for seen in self.seen(window="Export annotation")]
        left = min(box[0] for box in others if box[0] > x1 and box[1] < y1 and box[3] > y0)
        self.do("mousemove", round(left) + 20, round((y0 + y1) / 2), "sleep", 0.1, "mousedown", 1, "sleep", 0.1,
                "mouseup", 1, pause_s=0.2)
        self.press("Ctrl+A")
        if str(text):
            self.do("type", "--delay", 40, text, pause_s=0)
        else:
            self.press("BackSpace")


if __name__ == "__main__":
    unittest.main()
