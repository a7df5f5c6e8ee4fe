"""Two programs on one project, one of them a window; and files that others change while it is open."""
import json
import signal
import subprocess
import time
import unittest

from harness import ENVIRONMENT, SHVR
from window import PATIENCE_S, WINDOW, Window

DAB = {"op": "paint", "brush": "fill", "region": "ball", "path": [[32, 32, 32]], "radius": 5, "threshold": 0, "group": 3}


class Writers(Window):
    def annotate(self, session, operations, *arguments, status=0):
        script = self.write_script("script.jsonl", operations)
        return self.check("annotate", session, "--script", script, *arguments, status=status).stderr

    def writer(self, session):
        """A program that holds the project and waits for its script."""
        program = subprocess.Popen([SHVR, "annotate", session, "--script", "-"], stdin=subprocess.PIPE,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
        self.addCleanup(program.communicate)
        self.addCleanup(program.kill)
        self.wait_for_file(session.with_suffix(".journal.lock"))
        return program

    def view(self, session):
        self.start(session)
        self.wait_for_window("sphere.* - SHVR")
        x, y = self.middle()
        self.put_probe(x, y)

    def paint(self):
        x, y = self.middle()
        self.stroke((x, y), (x + 20, y))

    def files(self):
        return {path.name: path.read_bytes() for path in self.folder.iterdir()
                if path.is_file() and path.suffix not in (".lock", ".jsonl")}

    def test_the_second_window_is_read_only_says_so_and_closes(self):
        session = self.write_ball()
        self.annotate(session, [DAB])  # not saved: the window would save it when it closes
        before = self.files()
        holder = self.writer(session)
        self.view(session)
        self.paint()
        self.do("key", "7", "key", "ctrl+s", pause_s=0.7)
        report = self.finish()  # by one key
        said = "\n".join(report["messages"])
        self.assertIn(f"read only, for it is open for writing in shvr annotate, process {holder.pid} on ", said)
        self.assertIn("session.json: is not saved, since the project is open for writing", said)
        self.assertEqual(sorted(report["voxels_in_group"]), ["3"])
        self.assertEqual(self.files(), before)
        _, errors = holder.communicate('{"op":"save"}\n', PATIENCE_S)
        self.assertEqual(holder.returncode, 0, errors)

    def click(self, x, y):
        self.do("mousemove", x, y, "sleep", 0.3, "mousedown", 1, "sleep", 0.2, "mouseup", 1, pause_s=3)

    def test_a_copy_is_worked_on_while_the_project_is_held(self):
        session = self.write_ball()
        self.annotate(session, [DAB, {"op": "save"}])
        before = self.files()
        self.writer(session)
        self.view(session)
        self.click(63, 67)  # "Work on a copy"
        self.wait_for_file(self.folder / "session-copy.json")
        self.do("key", "7", pause_s=0.5)
        self.paint()
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertIn("Opened " + str(self.folder / "session-copy.json"), said)
        self.assertIn("7", report["voxels_in_group"], said)
        after = self.files()
        self.assertEqual({name: after[name] for name in before}, before)
        self.annotate(self.folder / "session-copy.json", [{"op": "expect", "voxels_in_group": report["voxels_in_group"]}])

    def test_a_window_that_is_read_only_tries_again(self):
        session = self.write_ball()
        holder = self.writer(session)
        self.view(session)
        elsewhere = {**DAB, "path": [[32, 54, 54]]}  # not where the window paints
        holder.communicate(json.dumps(elsewhere) + '\n{"op":"save"}\n', PATIENCE_S)
        self.click(158, 67)  # "Try again"
        self.do("key", "7", pause_s=0.5)
        self.paint()
        report = self.finish()
        self.assertEqual(sorted(report["voxels_in_group"]), ["3", "7"], report["messages"])
        self.annotate(session, [{"op": "expect", "voxels_in_group": report["voxels_in_group"]}])

    def test_a_window_holds_what_it_has_open_and_lets_go_of_it(self):
        session = self.write_ball()
        self.view(session)
        self.check_refused("annotate", session, "--script", self.write_script("s.jsonl", [DAB]),
                           says=["is open for writing in shvr view", str(self.program.pid)])
        self.open(session)  # the same once more, in the same window
        self.paint()
        report = self.finish()
        self.assertNotIn("read only", "\n".join(report["messages"]))
        self.assertIn("3", report["voxels_in_group"], report["messages"])
        self.assertFalse(session.with_suffix(".journal.lock").exists())
        self.annotate(session, [{"op": "expect", "voxels_in_group": report["voxels_in_group"]}])

    def test_where_no_lock_can_be_kept_the_first_can_still_be_closed(self):
        """The first has steps that were not saved, and the second writes and saves meanwhile."""
        session = self.write_ball()
        self.annotate(session, [DAB])
        session.with_suffix(".journal.lock").mkdir()
        self.view(session)
        self.annotate(session, [{**DAB, "group": 5, "path": [[20, 20, 20]]}, {"op": "save"}])
        before = self.files()
        self.do("key", "ctrl+q", pause_s=1.0)
        self.assertIsNone(self.program.poll())
        said = "\n".join(self.finish()["messages"])
        self.assertIn("all paint is in the journal: close it again to leave it there", said)
        self.assertEqual(self.files(), before)

    def test_a_changed_mask_is_asked_about_and_both_are_kept(self):
        session, mask = self.write_ball(), self.folder / "paint.mask"
        self.annotate(session, [DAB, {"op": "save"}])
        voxels = bytearray(mask.read_bytes())
        voxels[0:100] = bytes([9] * 100)
        mask.write_bytes(voxels)
        before = self.files()
        # Closed without an answer, nothing has changed.
        self.view(session)
        self.paint()
        report = self.finish()
        self.assertNotIn("9", report["voxels_in_group"])
        after = self.files()
        self.assertEqual({name: after[name] for name in before if name != "session.json"},
                         {name: before[name] for name in before if name != "session.json"})
        # "Take the files": in the middle of the window, below the text.
        self.view(session)
        for y in range(WINDOW[1] // 2 - 60, WINDOW[1] // 2 + 90, 12):
            self.do("mousemove", WINDOW[0] // 2 - 150, y, "sleep", 0.1, "mousedown", 1, "sleep", 0.1, "mouseup", 1,
                    pause_s=0.2)
            if (self.folder / "session.journal").read_bytes() != before["session.journal"]:
                break
        self.do("key", "ctrl+z", "key", "ctrl+s", pause_s=1)
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertIn("the file is taken, as a step that undo takes back", said)
        self.assertIn("Undone: files that were changed", said)
        self.assertEqual(sorted(report["voxels_in_group"]), ["3"])
        self.annotate(session, [{"op": "redo"}, {"op": "expect", "voxels_in_group": {"9": 100}}])

    def test_a_session_that_others_write_meanwhile_is_kept(self):
        session = self.write_ball()
        self.view(session)
        session.write_text('{"what": "another program wrote"}')
        self.do("key", "7", "key", "ctrl+s", pause_s=1)
        said = "\n".join(self.finish()["messages"])
        self.assertIn("session.json: was written by another program since it was opened; it is kept as", said)
        self.assertEqual((self.folder / "session.json.old").read_text(), '{"what": "another program wrote"}')
        self.assertEqual(json.loads(session.read_text())["probe"]["group"], 7)

    def test_a_signal_closes_the_window_as_its_button_does(self):
        session = self.write_ball()
        for number in (signal.SIGINT, signal.SIGTERM):
            self.view(session)
            self.paint()
            self.program.send_signal(number)
            output, errors = self.program.communicate(timeout=PATIENCE_S)
            self.assertEqual(self.program.returncode, 0, errors)
            self.assertTrue((self.folder / "paint.mask").exists())
            (self.folder / "paint.mask").unlink()


if __name__ == "__main__":
    unittest.main()
