"""Two programs on one project: who comes second is told at opening, may look and copy, and nobody is in anybody's way."""
import getpass
import json
import os
import signal
import socket
import subprocess
import time
import unittest
from pathlib import Path

from harness import ENVIRONMENT, SHVR, CliTest, Volume, run
from test_annotate import paint

PATIENCE_S = 60
NO_LOCKS = Path(SHVR).resolve().parent / "stubs" / "libno_locks.so"


class Writers(CliTest):
    def setUp(self):
        super().setUp()
        name = Volume.noise((9, 8, 7), seed=1).write(self.folder).name
        self.session = self.write_session(volume={"path": name})
        self.lock = self.folder / "session.journal.lock"

    def is_marked_by(self, program):
        marks = self.lock.parent.glob(f"session.journal.*.{program.pid}.*.lock")
        return any(f"process: {program.pid}\n" in mark.read_text() for mark in marks)

    def begin(self, *arguments, **environment):
        """A program that holds the project and waits for its script; returns it once it holds."""
        program = subprocess.Popen([SHVR, "annotate", self.session, "--script", "-", "--json", *arguments],
                                   stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env={**ENVIRONMENT, **environment})
        self.addCleanup(program.communicate)
        self.addCleanup(program.kill)
        end = time.monotonic() + PATIENCE_S
        while not self.is_marked_by(program):
            self.assertIsNone(program.poll())
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)
        return program

    def finish(self, program, operations, status=0):
        output, errors = program.communicate("".join(json.dumps(line) + "\n" for line in operations), PATIENCE_S)
        self.assertEqual(program.returncode, status, errors)
        return json.loads(output) if status == 0 else errors

    def annotate(self, operations, status=0):
        script = self.write_script("script.jsonl", operations)
        return self.check("annotate", self.session, "--script", script, status=status).stderr

    def dab(self, group):
        return paint("fill", "box", group, 0, 0.4, [[group + 0.5, 1.5, 1.5]])

    def files(self):
        return {path.name: path.read_bytes() for path in self.folder.iterdir() if path.suffix != ".lock"}

    def test_the_second_is_told_who_holds_the_project_before_any_work(self):
        self.annotate([self.dab(1), {"op": "save"}])
        before = self.files()
        first = self.begin()
        said = self.check_refused("annotate", self.session, "--script", self.folder / "none.jsonl",
                                  says=["session.journal: is open for writing in shvr annotate", str(first.pid),
                                        socket.gethostname(), getpass.getuser(), time.strftime("since %Y-%m-%d "),
                                        "expected nobody else to be writing it"])
        self.assertNotIn("none.jsonl", said)  # before the script is read
        self.assertEqual(self.files(), before)
        # Looking and copying go on, with a warning.
        for command in (["export", self.session, "--mask", self.folder / "copy.mask"],
                        ["label", self.session, "--threshold", "100"],
                        ["render", self.session, "-o", self.folder / "a.png"]):
            said = self.check(*command).stderr
            self.assertIn(f"is open for writing in shvr annotate, process {first.pid} ", said)
        self.assertEqual(sorted(set((self.folder / "copy.mask").read_bytes())), [0, 1])
        self.finish(first, [self.dab(2), {"op": "save"}])
        self.assertFalse(self.lock.exists())
        self.assertNotIn("is open for writing", self.annotate([{"op": "expect", "voxels_in_group": {"1": 1, "2": 1}}]))

    def test_whoever_dies_holds_nothing(self):
        for number in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT):
            first = self.begin()
            first.send_signal(number)
            first.wait(PATIENCE_S)
            self.annotate([self.dab(1), {"op": "undo"}, {"op": "save"}])
        self.lock.write_text("program: shvr view\nprocess: 1\nhost: elsewhere\n")  # left behind, held by no process
        self.annotate([{"op": "expect", "voxels_in_group": {"1": 0}}])

    def test_every_order_of_two_writers_keeps_what_each_was_told_is_done(self):
        """Each opens, writes with or without a save, and ends or is killed; the second in between or afterwards."""
        expected = {}
        group = 0
        for saves in (True, False):
            for ends in ("ends", "killed while it holds", "killed after its work"):
                for tries_between in (True, False):
                    with self.subTest(saves=saves, ends=ends, tries_between=tries_between):
                        group = group % 8 + 1
                        expected = {**expected, str(group): 1}
                        work = [self.dab(group)] + ([{"op": "save"}] if saves else [])
                        first = self.begin()
                        if tries_between:
                            self.annotate([self.dab(8), {"op": "save"}], status=1)
                        if ends == "killed while it holds":
                            first.kill()
                            first.wait(PATIENCE_S)
                            self.annotate(work)
                        elif ends == "ends":
                            self.finish(first, work)
                        else:
                            # A failing expectation ends it with all its work in the journal.
                            self.finish(first, work + [{"op": "expect", "nodes": 9}], status=3)
                        self.annotate([{"op": "expect", "voxels_in_group": expected}])

    def test_a_folder_without_locks_still_has_one_writer(self):
        self.lock.mkdir()
        self.annotate([self.dab(1), {"op": "save"}])
        self.annotate([{"op": "expect", "voxels_in_group": {"1": 1}}])

    def elsewhere(self, host, locks="hollow"):
        """The environment of a program on another computer, on a file system whose locks do not exclude."""
        return {"LD_PRELOAD": str(NO_LOCKS), "SHVR_LOCKS": locks, "SHVR_HOST": host,
                "ASAN_OPTIONS": "verify_asan_link_order=0"}

    def test_without_locks_that_exclude_the_second_is_refused_all_the_same(self):
        for locks in ("ENOSYS", "ENOLCK", "ENOTSUP", "hollow"):
            with self.subTest(locks=locks):
                here = {"LD_PRELOAD": str(NO_LOCKS), "SHVR_LOCKS": locks, "ASAN_OPTIONS": "verify_asan_link_order=0"}
                first = self.begin(**here)
                first.send_signal(signal.SIGSTOP)
                script = self.write_script("script.jsonl", [self.dab(2), {"op": "save"}])
                result = run("annotate", self.session, "--script", script, environment=here)
                self.assertEqual(result.returncode, 1)
                self.assertIn(f"is open for writing in shvr annotate, process {first.pid} on ", result.stderr)
                first.send_signal(signal.SIGCONT)
                self.finish(first, [self.dab(1), {"op": "undo"}, {"op": "save"}])
        self.assertEqual([name for name in self.files() if "journal" in name], ["session.journal"])

    # Kind (bad input and lost work): a save by a living program and remains of a killed one look alike without locks
    def test_what_another_program_builds_stays_where_no_lock_tells_whether_it_lives(self):
        built = self.folder / ".paint.mask.shvr-part" / "new" / "0"
        script = self.write_script("script.jsonl", [{"op": "expect", "voxels_in_group": {"1": 0}}])
        for locks, stays in (("ENOSYS", True), ("ENOLCK", True), ("ENOTSUP", True), ("files", False), ("", False)):
            with self.subTest(locks=locks):
                built.mkdir(parents=True, exist_ok=True)
                result = run("annotate", self.session, "--script", script, environment=self.elsewhere("here", locks))
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(built.exists(), stays)
                self.assertEqual(built.parent.parent.exists(), stays)

    def test_a_writer_on_another_computer_loses_nothing_and_who_comes_second_is_told(self):
        """The first is stopped while the second works, saves and ends."""
        self.annotate([self.dab(1), {"op": "save"}])
        before = self.files()["session.journal"]
        first = self.begin(**self.elsewhere("node1"))
        first.stdin.write(json.dumps(self.dab(2)) + "\n")
        first.stdin.flush()
        first.send_signal(signal.SIGSTOP)
        script = self.write_script("script.jsonl", [self.dab(3), {"op": "save"}])
        second = run("annotate", self.session, "--script", script, environment=self.elsewhere("node2"))
        self.assertEqual(second.returncode, 0, second.stderr)
        self.assertIn(f"is open for writing in shvr annotate, process {first.pid} on node1", second.stderr)
        self.assertIn("leaves this file to it, as " + str(self.folder / "session.journal.old"), second.stderr)
        first.send_signal(signal.SIGCONT)
        # It reads the project once its script is complete, so it goes on with what the second did.
        self.finish(first, [{"op": "save"}])
        self.annotate([{"op": "expect", "voxels_in_group": {"1": 1, "2": 1, "3": 1}}])
        self.assertEqual(self.files()["session.journal.old"], before)
        for mark in self.folder.glob("*.lock"):
            self.fail(f"{mark} is left")

    def test_a_project_is_not_replaced_under_the_hands_of_its_writer(self):
        volume = Volume.noise((9, 8, 7), seed=2).write(self.folder, "other")
        project = self.folder / "project"
        self.check("import", volume, project)
        self.session, self.lock = project, project / "shvr" / "session.journal.lock"
        first = self.begin()
        self.check_refused("import", volume, project, "--overwrite",
                           says=["is open for writing in shvr annotate", str(first.pid)])
        self.finish(first, [self.dab(1), {"op": "save"}])
        self.check("import", volume, project, "--overwrite")
        self.assertFalse((project / "labels").exists())


if __name__ == "__main__":
    unittest.main()
