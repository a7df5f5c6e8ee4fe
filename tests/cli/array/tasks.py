"""Shared by the tests of commands that are split into tasks: running tasks, and comparing what is written."""
import os
import signal
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from harness import ENVIRONMENT, SHVR, CliTest, run  # noqa: E402


def files_below(path):
    """{name relative to the path: bytes}, for a file or a folder."""
    path = Path(path)
    if path.is_file():
        return {"": path.read_bytes()}
    return {str(file.relative_to(path)): file.read_bytes() for file in sorted(path.rglob("*")) if file.is_file()}


class SplitTest(CliTest):
    COUNTS = (1, 2, 3, 7)

    def tasks(self, of, *arguments, order=None):
        """Runs the tasks, the last one first, and returns what the last of them printed."""
        for index in order or reversed(range(of)):
            told = self.check_json(*arguments, "--task", f"{index}/{of}")
            self.assertEqual((told["task"], told["pieces"]), (f"{index}/{of}", of))
        return told

    def slurm(self, variables, *arguments):
        result = run(*arguments, environment=variables)
        self.assertEqual(result.returncode, 0, result.stderr)

    def gather(self, output, *arguments, status=0):
        return self.check_json("gather", f"{output}.pieces", *arguments, status=status)

    def assert_equal_files(self, found, expected):
        found, expected = files_below(found), files_below(expected)
        self.assertEqual(list(found), list(expected))
        self.assertEqual([name for name in expected if found[name] != expected[name]], [])

    def check_rules(self, output, *arguments):
        """What holds for every command that can be split: repeated and missing tasks, another N, other arguments."""
        pieces = Path(f"{output}.pieces")
        self.tasks(3, *arguments, order=(0, 2))
        told = self.gather(output, status=1)
        self.assertEqual((told["pieces"], told["missing"], told["path"]), (3, ["1/3"], None))
        self.assertFalse(Path(output).is_file())
        self.assertIn("1/3", self.check_refused("gather", pieces, status=1, says=["missing"]))
        self.assertIn("split into 3 tasks, and this is one of 4",
                      self.check_refused(*arguments, "--task", "1/4", status=1))
        self.assertIn("2.5", self.check_refused(*arguments, *self.OTHER, "--task", "1/3", status=1))
        # A task that runs twice leaves the piece as it is.
        before = (pieces / "piece-0").stat()
        self.tasks(3, *arguments, order=(0,))
        after = (pieces / "piece-0").stat()
        self.assertEqual((before.st_ino, before.st_mtime_ns), (after.st_ino, after.st_mtime_ns))

    def kill(self, *arguments, number=signal.SIGKILL):
        """Ends a task as soon as it has begun; it may have finished by then."""
        process = subprocess.Popen([SHVR, *map(str, arguments), "--quiet"], env=ENVIRONMENT,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        manifest = Path(f"{arguments[arguments.index('-o') + 1]}.pieces") / "manifest.json"
        while process.poll() is None and not manifest.exists():
            os.sched_yield()
        process.send_signal(number)
        return process.wait()
