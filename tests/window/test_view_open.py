"""Opening by the file chooser, with real keys: a window that was started without anything."""
import json
import unittest

from seen import Seen, in_short
from window import PATIENCE_S


class Open(Seen):
    def open_nothing(self, environment=None):
        self.view(preferences={"hints_seen": 3}, environment=environment)
        self.see("Open the example")
        self.do("mousemove", *self.middle(), pause_s=0)

    def begin(self):
        """A folder `scans` with a session in it and a file that is none, and a window that shows nothing."""
        self.write_ball(volume={"procedural": "sphere", "size": [16, 16, 16]}).rename(self.folder / "ball.json")
        (self.folder / "scans" / "deep").mkdir(parents=True)
        (self.folder / "ball.json").rename(self.folder / "scans" / "deep" / "ball.json")
        (self.folder / "scans" / "deep" / "broken.nrrd").write_text("no header")
        self.open_nothing()

    def choose_path(self, path):
        self.press("Ctrl+O")
        self.see_at_rest("Hidden")
        self.do("type", "--delay", 40, path, pause_s=0)
        self.see(str(path), "Open a volume")
        self.press("Enter")

    def press_and_see(self, key, text):
        self.press(key)
        self.see_at_rest(text)

    def test_a_scan_is_found_with_keys_and_opened(self):
        self.begin()
        self.choose_path(self.folder / "scans")
        # The folder in it, by its letter; into it; out of it, and in again; then the first file.
        self.see_at_rest("deep")
        self.press("D")
        self.press_and_see("Enter", "ball.json")
        self.press_and_see("BackSpace", "deep")
        self.see_no_more("ball.json")
        self.see_at_rest("deep")
        self.press("Down")
        self.press_and_see("Enter", "ball.json")
        self.see_at_rest("ball.json")
        self.press("B")
        self.press("Enter")
        self.wait_for_window("sphere.* - SHVR")
        messages = self.finish()["messages"]
        self.assertTrue(any(line.startswith(f"Opened {self.folder}/scans/deep/ball.json") for line in messages), messages)
        # What letters do in the list, they do nowhere else.
        self.assertFalse(any("broken" in line for line in messages), messages)

    def test_what_cannot_be_opened_says_why_and_the_chooser_is_where_it_was(self):
        self.begin()
        self.choose_path(f"{self.folder}/gone.nrrd")
        # The chooser says so and keeps the path; the rest of another is typed over it.
        self.until(lambda: any("no such" in seen["text"] for seen in self.seen(window="Open a volume")), "refusal")
        self.press("Ctrl+A")
        self.do("type", "--delay", 40, f"{self.folder}/scans/deep/", pause_s=0)
        self.see("broken.nrrd")
        self.do("type", "--delay", 40, "br", pause_s=0)
        self.see(f"{self.folder}/scans/deep/br", "Open a volume")
        self.press_and_see("Tab", f"{self.folder}/scans/deep/broken.nrrd")
        self.press("Enter")
        self.until(lambda: any("broken.nrrd: " in seen["text"] for seen in self.seen()), "reason")
        # Open again, it shows the same folder and the same name, and the one above it opens.
        self.press_and_see("Ctrl+O", "broken.nrrd")
        self.press_and_see("Up", f"{self.folder}/scans/deep/ball.json")
        self.press("Enter")
        self.wait_for_window("sphere.* - SHVR")
        messages = self.finish()["messages"]
        self.assertTrue(any("broken.nrrd: " in line for line in messages), messages)
        self.assertFalse(any("gone" in line for line in messages), messages)
        self.assertTrue(any(line.startswith(f"Opened {self.folder}/scans/deep/ball.json") for line in messages), messages)

    def test_escape_closes_it_and_keys_mean_again_what_they_did(self):
        self.open_nothing()
        self.press_and_see("Ctrl+O", "Hidden")
        self.press("Escape")
        self.see_no_more("Hidden")
        self.press("Ctrl+Q")
        self.program.communicate(timeout=PATIENCE_S)
        self.assertEqual(self.program.returncode, 0)

    def test_what_is_typed_before_a_field_is_there_is_typed_into_it_and_behind_it_keys_are_shortcuts(self):
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3})
        self.do("mousemove", *self.middle(), pause_s=0)
        path = f"{self.folder}/5f8s"
        self.at_once("key", "ctrl+o", "type", "--delay", 1, path)
        self.see(path, "Open a volume")
        self.at_once("key", "Escape", "key", "6", "key", "ctrl+shift+p", "type", "--delay", 1, "53 nothing")
        self.see("53 nothing", "Find anything")
        self.see_no_more("Hidden")
        self.at_once("key", "Escape", "key", "7", "key", "ctrl+o")
        self.see_at_rest("Hidden")
        # In the list, where Enter leads, a slash begins a path.
        self.press("Return")
        self.see_at_rest("Hidden")
        self.at_once("type", "--delay", 1, f"{self.folder}/9f")
        self.see(f"{self.folder}/9f", "Open a volume")
        self.at_once("key", "Escape", "key", "8", "key", "ctrl+q")
        self.program.communicate(timeout=PATIENCE_S)
        groups = [action["values"]["probe"]["group"] for action in self.done() if in_short(action) == "set probe.group"]
        self.assertEqual(groups, [6, 7, 8])
        self.assertFalse([action for action in self.done() if action["op"] == "paint_here"])

    def test_a_folder_that_does_not_answer_is_waited_for_in_words_and_the_rest_goes_on(self):
        (self.folder / "hung" / "deep").mkdir(parents=True)
        (self.folder / "hung" / "slow.nrrd").write_text("no header")
        (self.folder / "scans").mkdir()
        (self.folder / "scans" / "near.nrrd").write_text("no header")
        answers, log = self.folder / "answers", self.folder / "hung.log"
        self.open_nothing(self.hung_disk(answers, log))
        self.press("Ctrl+O")
        self.see("Hidden")
        self.do("type", "--delay", 40, f"{self.folder}/hung/", pause_s=0)
        self.see(f"Waiting for {self.folder}/hung")
        before = self.frame()["frame"]
        self.until(lambda: self.frame()["frame"] > before + 5, "frames beside it")
        # Elsewhere all is as ever.
        self.press("Ctrl+A")
        self.do("type", "--delay", 40, f"{self.folder}/scans/", pause_s=0)
        self.see("near.nrrd")
        self.see_no_more("Waiting")
        # A path that is typed in full and accepted is waited for, too, until the folder answers.
        self.press("Ctrl+A")
        self.do("type", "--delay", 40, f"{self.folder}/hung/deep", pause_s=0)
        self.press("Enter")
        self.see(f"Waiting for {self.folder}/hung/deep")
        answers.write_text("")
        self.see_no_more("Waiting")
        self.press("BackSpace")
        self.see("slow.nrrd")
        self.press("Escape")
        self.see_no_more("Hidden")
        self.finish()
        self.assertFalse(log.exists() and log.read_text(), "the main thread asked the disk")

    def test_a_scan_that_was_worked_on_is_gone_on_with_and_a_typed_folder_is_listed(self):
        scan = self.folder / "scan.nrrd"
        scan.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n\n" +
                         bytes(range(256)) * 16)
        self.open_scan(scan, preferences={"hints_seen": 3})
        self.do("mousemove", *self.middle(), pause_s=0)
        self.what_follows(lambda: self.press("F2"), "set view.volume")
        self.press("Ctrl+S")
        session = self.folder / "scan.session.json"
        self.wait_for_file(session)
        self.finish()
        saved = json.loads(session.read_text())
        saved["render"]["step_voxels"] = 0.7   # in no journal
        session.write_text(json.dumps(saved))

        self.open_nothing()
        self.press("Ctrl+O")
        self.see("Hidden")
        self.do("type", "--delay", 40, f"{self.folder}/", pause_s=0)
        self.see("scan.nrrd")   # without Enter
        self.do("type", "--delay", 40, "scan.nrrd", pause_s=0)
        self.press("Enter")
        self.wait_for_window("scan.* - SHVR")
        self.do("mousemove", *self.middle(), pause_s=0)
        self.what_follows(lambda: self.press("F2"), "set view.volume")
        self.press("Ctrl+S")
        self.until(lambda: any(seen["text"].startswith("Saved") for seen in self.seen()), "Saved")
        messages = self.finish()["messages"]
        self.assertFalse(any("were changed since" in line for line in messages), messages)
        self.assertTrue(any(f"Opened {scan}, and goes on with {session.name}" in line for line in messages), messages)
        self.assertEqual(json.loads(session.read_text())["render"]["step_voxels"], 0.7)

        # A setting of the command line changes that setting alone.
        self.open_scan(scan, "--set", "blend.size=0.5", preferences={"hints_seen": 3})
        self.do("mousemove", *self.middle(), pause_s=0)
        self.what_follows(lambda: self.press("F2"), "set view.volume")
        self.press("Ctrl+S")
        self.until(lambda: any(seen["text"].startswith("Saved") for seen in self.seen()), "Saved")
        messages = self.finish()["messages"]
        self.assertFalse(any("were changed since" in line for line in messages), messages)
        self.assertEqual(json.loads(session.read_text())["render"]["step_voxels"], 0.7)


if __name__ == "__main__":
    unittest.main()
