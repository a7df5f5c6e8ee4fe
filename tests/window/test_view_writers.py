"""Two programs on one project, one of them a window; and files that others change while it is open."""
import json
import signal
import subprocess
import unittest
from pathlib import Path

from harness import ENVIRONMENT, IS_SLOW, SHVR, Volume, run
from seen import Seen
from window import PATIENCE_S

# Runs in an interpreter that has python3-zarr: voxels of each group in the labels of a project.
ZARR = """
import json, sys
import numpy, zarr
voxels = zarr.open_group(sys.argv[1], "r")["labels/paint/0"][:]
print(json.dumps({str(group): int((voxels == group).sum()) for group in numpy.unique(voxels[voxels > 0])}))
"""
NO_LOCKS = Path(SHVR).resolve().parent / "stubs" / "libno_locks.so"
DAB = {"op": "paint", "brush": "fill", "region": "ball", "path": [[32, 32, 32]], "radius": 5, "threshold": 0, "group": 3}


class Writers(Seen):
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

    def elsewhere(self, host):
        """The environment of a program on another computer, on a file system whose locks do not exclude."""
        chosen = {"LD_PRELOAD": str(NO_LOCKS), "SHVR_LOCKS": "hollow", "SHVR_HOST": host}
        if subprocess.run([SHVR, "--version"], env={**ENVIRONMENT, **chosen}, stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL).returncode:
            self.skipTest("a program with sanitizers cannot be loaded with another library before them")
        return chosen

    def open_project(self, session, environment=None):
        self.open_scan(session, preferences={"hints_seen": 3}, environment=environment)
        self.check_probe(*self.middle())

    def paint(self):
        x, y = self.middle()
        self.check_stroke((x, y), (x + 20, y))

    def files(self):
        """What is in the project's folder, but for what tests and locks leave there."""
        return {path.name: path.read_bytes() for path in self.folder.iterdir()
                if path.is_file() and path.suffix not in (".lock", ".jsonl") and path.name != "words.json"}

    def test_the_second_window_is_read_only_says_so_and_closes(self):
        session = self.write_ball()
        self.annotate(session, [DAB])  # not saved: the window would save it when it closes
        before = self.files()
        holder = self.writer(session)
        self.open_project(session)
        x, y = self.middle()
        self.stroke((x, y), (x + 20, y), pause_s=0)
        self.do("key", "7", "key", "ctrl+s", pause_s=0)
        self.see_frames()
        report = self.finish()  # by one key
        said = "\n".join(report["messages"])
        self.assertIn(f"read only, for it is open for writing in shvr annotate, process {holder.pid} on ", said)
        self.assertIn("session.json: is not saved, since it is open for writing", said)
        self.assertIn(f"The scan is read only, since it is open for writing in shvr annotate, process {holder.pid} on ",
                      said)
        self.assertEqual(sorted(report["voxels_in_group"]), ["3"])
        self.assertEqual(self.files(), before)
        _, errors = holder.communicate('{"op":"save"}\n', PATIENCE_S)
        self.assertEqual(holder.returncode, 0, errors)

    def test_a_copy_is_worked_on_while_the_project_is_held(self):
        session = self.write_ball()
        self.annotate(session, [DAB, {"op": "save"}])
        before = self.files()
        self.writer(session)
        self.open_project(session)
        self.click_on("Work on a copy")
        self.see("Opened ", "Status")
        self.see_no_more("Work on a copy")
        self.see_picture()
        self.check_probe(*self.middle())
        self.check_key("7", "set probe.group")
        self.paint()
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertIn("Opened " + str(self.folder / "session-copy.json"), said)
        self.assertIn("7", report["voxels_in_group"], said)
        after = self.files()
        self.assertEqual({name: after[name] for name in before}, before)
        self.annotate(self.folder / "session-copy.json", [{"op": "expect", "voxels_in_group": report["voxels_in_group"]}])

    def test_a_session_that_saves_outside_its_folder_is_read_only_until_the_user_agrees(self):
        inside, outside = self.folder / "inside", self.folder / "mine.mask"
        inside.mkdir()
        session = self.write_ball(annotation={"mask": "../mine.mask"})
        session = session.rename(inside / session.name)
        self.open_project(session)
        self.see("Read only: this session writes files outside its folder")
        self.do("key", "ctrl+s", pause_s=0)
        self.see("Error: ", "Status")
        self.assertFalse(outside.exists())
        self.assertEqual([path.name for path in inside.iterdir()], [session.name])
        self.click_on("Write there")
        self.see_no_more("Write there")
        self.see_picture()
        self.check_probe(*self.middle())
        self.paint()
        self.press("Ctrl+S")
        self.wait_for_file(outside)
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertIn("session.json: is not saved, since its session writes outside its folder", said)

    def test_a_window_that_is_read_only_tries_again(self):
        session = self.write_ball()
        holder = self.writer(session)
        self.open_project(session)
        elsewhere = {**DAB, "path": [[32, 54, 54]]}  # not where the window paints
        holder.communicate(json.dumps(elsewhere) + '\n{"op":"save"}\n', PATIENCE_S)
        self.click_on("Try again")
        self.see_no_more("Try again")
        self.see_picture()
        self.check_probe(*self.middle())
        self.check_key("7", "set probe.group")
        self.paint()
        report = self.finish()
        self.assertEqual(sorted(report["voxels_in_group"]), ["3", "7"], report["messages"])
        self.annotate(session, [{"op": "expect", "voxels_in_group": report["voxels_in_group"]}])

    def test_a_window_holds_what_it_has_open_and_lets_go_of_it(self):
        session = self.write_ball()
        self.open_project(session)
        self.check_refused("annotate", session, "--script", self.write_script("s.jsonl", [DAB]),
                           says=["is open for writing in shvr view", str(self.program.pid)])
        self.open(session)  # the same once more, in the same window
        self.see("Opened ", "Status")
        self.see_picture()
        self.check_probe(*self.middle())
        self.paint()
        report = self.finish()
        self.assertNotIn("read only", "\n".join(report["messages"]))
        self.assertIn("3", report["voxels_in_group"], report["messages"])
        self.assertFalse(session.with_suffix(".journal.lock").exists())
        self.annotate(session, [{"op": "expect", "voxels_in_group": report["voxels_in_group"]}])

    def test_where_no_lock_can_be_kept_the_second_is_refused(self):
        session = self.write_ball()
        self.annotate(session, [DAB])
        session.with_suffix(".journal.lock").mkdir()
        self.open_project(session)
        self.see_kept()
        before = self.files()
        said = self.annotate(session, [{**DAB, "group": 5}, {"op": "save"}], status=1)
        self.assertIn(f"is open for writing in shvr view, process {self.program.pid} ", said)
        self.assertEqual(self.files(), before)
        self.finish()

    def test_a_window_whose_project_is_claimed_from_another_computer_says_so_and_keeps_its_work(self):
        """Locks that do not exclude: the other program paints and saves while the window is open."""
        session = self.write_ball()
        self.annotate(session, [DAB, {"op": "save"}])
        self.open_project(session, self.elsewhere("node1"))
        self.check_key("7", "set probe.group")
        journal = session.with_suffix(".journal")
        before = len(journal.read_bytes())
        self.paint()
        self.until(lambda: len(journal.read_bytes()) > before, "step in the journal")
        self.see_kept()   # a record written while the other program opens would refuse it
        script = self.write_script("other.jsonl", [{**DAB, "group": 5, "path": [[20, 20, 20]]}, {"op": "save"}])
        other = run("annotate", session, "--script", script, environment=self.elsewhere("node2"))
        self.assertEqual(other.returncode, 0, other.stderr)
        self.assertIn("is open for writing in shvr view, process", other.stderr)
        before = self.files()
        x, y = self.middle()
        self.stroke((x, y + 10), (x + 20, y + 10), pause_s=0)
        self.see("Read only: open for writing in ")
        self.see("Work on a copy")
        said = "\n".join(self.finish()["messages"])
        self.assertIn("what was done here is kept in " + str(self.folder / "session.journal.old"), said)
        self.assertEqual(self.files(), before)
        # Both are there: the other program continued what the window had painted before the claim.
        self.check("export", session, "--mask", self.folder / "seen.mask")
        self.assertLessEqual({5, 7}, set((self.folder / "seen.mask").read_bytes()))
        (self.folder / "session.journal.old").replace(journal)
        (self.folder / "paint.mask").unlink()
        self.annotate(session, [{"op": "expect", "voxels_in_group": {"5": 0}}], "--believe", "journal")

    def test_a_changed_mask_is_asked_about_and_both_are_kept(self):
        session, mask = self.write_ball(), self.folder / "paint.mask"
        self.annotate(session, [DAB, {"op": "save"}])
        voxels = bytearray(mask.read_bytes())
        voxels[0:100] = bytes([9] * 100)
        mask.write_bytes(voxels)
        before = self.files()
        # Closed without an answer, nothing has changed.
        self.open_scan(session, preferences={"hints_seen": 3})
        x, y = self.middle()
        self.put_probe(x, y, pause_s=0)
        self.stroke((x, y), (x + 20, y), pause_s=0)
        self.see_frames()
        report = self.finish()
        self.assertNotIn("9", report["voxels_in_group"])
        after = self.files()
        self.assertEqual({name: after[name] for name in before if name != "session.json"},
                         {name: before[name] for name in before if name != "session.json"})
        self.open_scan(session, preferences={"hints_seen": 3})
        # The question can be put off, which is said until it is answered.
        self.click_on("Decide later")
        self.see("Nothing can be painted, traced or saved until you have decided", "Put off")
        self.see_no_more("Take the files")
        self.click_on("Decide now...", "Put off")
        self.click_on("Take the files")
        self.see_no_more("", "Put off")
        journal = self.folder / "session.journal"
        self.until(lambda: journal.read_bytes() != before["session.journal"], "step in the journal")
        self.check_key("Ctrl+Z", "undo")
        self.check_key("Ctrl+S", "save")
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertIn("the file is taken, as a step that undo takes back", said)
        self.assertIn("Undone: files that were changed", said)
        self.assertEqual(sorted(report["voxels_in_group"]), ["3"])
        self.annotate(session, [{"op": "redo"}, {"op": "expect", "voxels_in_group": {"9": 100}}])

    def test_a_session_that_others_write_meanwhile_is_kept(self):
        session = self.write_ball()
        self.open_project(session)
        session.write_text('{"what": "another program wrote"}')
        self.check_key("7", "set probe.group")
        self.check_key("Ctrl+S", "save")
        said = "\n".join(self.finish()["messages"])
        self.assertIn("session.json: was written by another program since it was opened; it is kept as", said)
        self.assertEqual((self.folder / "session.json.old").read_text(), '{"what": "another program wrote"}')
        self.assertEqual(json.loads(session.read_text())["probe"]["group"], 7)

    # Kind (annotation files): the window and a script in turns on one project, whose labels python3-zarr reads in between
    def test_a_project_s_labels_are_saved_by_the_window_and_a_script_in_turns(self):
        if subprocess.run(["/usr/bin/python3", "-c", "import zarr"], capture_output=True).returncode:
            self.skipTest("/usr/bin/python3 has no python3-zarr")
        project, session = self.folder / "project", self.folder / "project" / "shvr" / "session.json"
        self.check("import", Volume.noise((48, 40, 36), seed=4).write(self.folder), project)
        session.write_text(json.dumps({
            **json.loads(session.read_text()), "camera": "front",
            "probe": {"radius_voxels": 4, "group": 3, "paint_threshold": 0}, "transfer_function": {"points": [
                {"intensity": 0, "color": "#c0a080", "opacity": 0.5}, {"intensity": 255, "opacity": 0.9}]}}))
        script = self.write_script("script.jsonl", [{**DAB, "path": [[9, 9, 9]], "group": 7, "region": "box"}, {"op": "save"}])

        def by_zarr():
            found = subprocess.run(["/usr/bin/python3", "-c", ZARR, project], capture_output=True, text=True)
            self.assertEqual(found.returncode, 0, found.stderr)
            self.assertEqual(json.loads(found.stdout), self.check_json("export", project)["voxels_by_group"])
            return json.loads(found.stdout)
        before = {}
        for turn in range(2 if IS_SLOW else 1):
            self.open_project(project)
            self.check_stroke(self.middle(), (self.middle()[0] + 20 * turn, self.middle()[1] + 15 * turn))
            said = self.check_refused("annotate", project, "--script", script)
            self.assertIn(f"process {self.program.pid} on ", said)
            self.saved(session)
            painted = by_zarr()
            self.assertGreater(painted["3"], before.get("3", 0))
            self.assertEqual(painted.get("7"), before.get("7"))
            self.assertEqual(self.finish()["voxels_in_group"], painted)
            self.check("annotate", project, "--script", script)
            after = by_zarr()
            self.assertEqual(after, {**painted, "7": 1000})
            before = after

    def test_a_signal_closes_the_window_as_its_button_does(self):
        session = self.write_ball()
        for number in (signal.SIGINT, signal.SIGTERM):
            self.open_project(session)
            self.paint()
            self.program.send_signal(number)
            output, errors = self.program.communicate(timeout=PATIENCE_S)
            # On a busy machine the signal cuts the save off; then the journal has what was painted.
            self.assertIn(self.program.returncode, (0, -number), errors)
            if self.program.returncode == 0:
                self.assertTrue((self.folder / "paint.mask").exists())
                (self.folder / "paint.mask").unlink()
            exported = self.folder / "exported.mask"
            self.check("export", session, "--mask", exported, "--believe", "journal")
            self.assertIn(3, exported.read_bytes())


if __name__ == "__main__":
    unittest.main()
