"""Work that takes long: it says how far it is on standard error, and Ctrl-C ends it in a sentence."""
import os
import pty
import select
import signal
import struct
import subprocess
import unittest
import zlib

from harness import ENVIRONMENT, PROGRESS, SHVR, TIMEOUT_S, CliTest


def write_png(path, width, height):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    row = b"\0" + bytes(value % 251 for value in range(3 * width))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                     chunk(b"IDAT", zlib.compress(row * height, 1)) + chunk(b"IEND", b""))


class Long(CliTest):
    """Every command here would take minutes to years."""

    def setUp(self):
        super().setUp()
        self.raw = self.folder / "huge.raw"
        self.raw.touch()
        os.truncate(self.raw, 2 ** 36)
        self.layout = ["--raw", "4096x4096x4096:uint8"]
        self.fog = self.write_session(volume={"procedural": "fog", "size": [2048, 2048, 2048]})

    def stop(self, *arguments, signal_number=signal.SIGINT):
        """Runs until the first line of progress, then asks to stop; (that line, the lines after it, standard output)."""
        with subprocess.Popen([SHVR, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              env=ENVIRONMENT) as process:
            try:
                line = next(line for line in process.stderr if PROGRESS.search(line.rstrip("\n")))
                process.send_signal(signal_number)
                out, err = process.communicate(timeout=TIMEOUT_S)
            finally:
                process.kill()
        self.assertEqual(process.returncode, 1, line + err)
        return line.rstrip("\n"), err.splitlines(), out

    def check_stopped(self, *arguments, says="stopped", **options):
        files = sorted(self.folder.iterdir())
        line, rest, out = self.stop(*arguments, **options)
        self.assertRegex(line, PROGRESS)
        self.assertEqual(out, "")
        said = [line for line in rest if not PROGRESS.search(line) and not line.startswith("warning: ")]
        self.assertEqual(len(said), 1, rest)
        self.assertTrue(said[0].startswith("shvr: "), said)
        self.assertIn(says, said[0])
        self.assertEqual(sorted(self.folder.iterdir()), files)
        return line

    def test_info(self):
        line = self.check_stopped("info", self.raw, *self.layout, "--exact", "--json")
        self.assertTrue(line.startswith(f"measuring {self.raw}: "), line)

    def test_label(self):
        self.check_stopped("label", self.fog, "--threshold", "100", "-o", self.folder / "labels.nrrd")

    def test_phantom(self):
        self.check_stopped("phantom", "fog", "--size", "2048", "-o", self.folder, signal_number=signal.SIGTERM)

    def test_render(self):
        small = self.write_session("small.json", volume={"procedural": "fog", "size": [128, 128, 128]})
        self.check_stopped("render", small, "-o", self.folder / "a.png", "--size", "8000x8000", "--set",
                           "render.step_voxels=0.1")

    def test_profile(self):
        self.check_stopped("profile", self.fog, "--frames", "100000", "--set", "volume.size=[64,64,64]")

    def test_compare(self):
        picture = self.folder / "a.png"
        write_png(picture, 2000, 2000)
        line = self.check_stopped("compare", picture, picture, "--diff", self.folder / "d.png")
        self.assertRegex(line, r"^comparing pictures: \d+ %")

    def test_import_keeps_what_is_done(self):
        line, rest, _ = self.stop("import", self.raw, self.folder / "p", *self.layout)
        self.assertRegex(line, PROGRESS)
        self.assertIn("the import was stopped; what is done is kept", rest[-1])
        self.assertTrue((self.folder / "p.part").is_dir())

    def test_import_says_how_far_it_is_before_it_reverses(self):
        line = self.check_stopped("import", self.raw, self.folder / "p", *self.layout, "--reverse")
        self.assertRegex(line, rf"^measuring {self.raw}: \d+ %.* left$")

    def test_quiet_work_says_nothing_but_can_be_stopped(self):
        process = subprocess.Popen([SHVR, "info", self.raw, *self.layout, "--exact", "--quiet"], env=ENVIRONMENT,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        self.assertEqual(select.select([process.stderr], [], [], 4)[0], [])
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=TIMEOUT_S)
        self.assertEqual((process.returncode, out, len(err.splitlines())), (1, "", 1))

    def test_on_a_terminal_one_line_is_rewritten(self):
        ours, theirs = pty.openpty()
        process = subprocess.Popen([SHVR, "info", self.raw, *self.layout, "--exact"], env=ENVIRONMENT,
                                   stdout=subprocess.PIPE, stderr=theirs)
        self.addCleanup(process.kill)
        os.close(theirs)
        shown = b""
        while shown.count(b"left") < 3:
            shown += os.read(ours, 4096)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=TIMEOUT_S)
        while True:
            try:
                shown += os.read(ours, 4096)
            except OSError:  # the other end is closed
                break
        os.close(ours)
        lines = [line for line in shown.decode().split("\r\n") if line and not line.startswith("warning: ")]
        self.assertEqual(len(lines), 1, lines)
        *rewritten, last = lines[0].split("\r\x1b[K")
        self.assertGreaterEqual(len(rewritten), 3)
        self.assertTrue(last.startswith("shvr: stopped"), lines)


if __name__ == "__main__":
    unittest.main()
