"""What keeps work from being saved is said in a banner, with the action that helps: a folder that may not be written to,
and a save that fails, also when the window is to be closed."""
import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from seen import Seen  # noqa: E402
from window import PATIENCE_S, SIDE_PANEL, WINDOW  # noqa: E402

BANNER = "Not saved"


class Trouble(Seen):
    def mount_disk(self, *options):
        """A small disk of its own; skips the test where none can be mounted."""
        disk = self.folder / "disk"
        disk.mkdir()
        mount = ["mount", "-t", "tmpfs", "-o", ",".join(["size=16m", *options]), "none", disk]
        if subprocess.run(mount, capture_output=True).returncode != 0:
            self.skipTest("this process may not mount a file system")
        self.addCleanup(subprocess.run, ["umount", "-l", disk], check=True)
        return disk

    def put_onto(self, disk):
        session = self.write_ball()
        return shutil.copy(session, disk / session.name)

    def banner(self):
        """The words of the banner, without spaces: lines are wrapped anywhere."""
        return "".join(seen["text"] for seen in self.seen(window=BANNER)).replace(" ", "")

    def see_banner(self, text):
        self.until(lambda: text.replace(" ", "") in self.banner(), f"banner with '{text}'")

    def lies_within(self, window):
        """Whether all words of a window lie within the picture's width."""
        return all(seen["box"][0] >= 0 and seen["box"][2] <= WINDOW[0] - SIDE_PANEL
                   for seen in self.seen(window=window))

    def test_a_folder_that_cannot_be_written_to_is_said_at_opening_and_another_one_helps(self):
        disk = self.mount_disk()
        session = self.put_onto(disk)
        subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
        home = self.folder / "home"
        home.mkdir()
        self.open_scan(session, preferences={"hints_seen": 3}, environment={"HOME": home})
        self.see("Nothing can be saved: the folder ", BANNER)
        self.see_banner(f"{disk} cannot be written to: Read-only file system. Save as continues in another folder.")
        self.click_on("Save as...", BANNER)
        self.see("Continue under another name")
        self.press("Enter")
        self.wait_for_file(home / "session-2.json")
        self.see_no_more("", BANNER)
        self.assertEqual([path.name for path in disk.iterdir()], [session.name])
        self.finish()

    def test_where_no_journal_can_be_made_a_banner_stays_until_a_save_succeeds(self):
        disk = self.mount_disk("nr_inodes=40")
        self.open_scan(self.put_onto(disk), preferences={"hints_seen": 3})
        self.assertEqual(self.seen(window=BANNER), [])
        others = []
        try:   # the disk takes no more files, though it has space
            while True:
                others.append(disk / f"other{len(others)}")
                others[-1].touch()
        except OSError:
            others.pop()
        x, y = self.middle()
        self.check_probe(x, y)
        self.do("mousemove", x, y, "keydown", "f", "mousemove", x + 20, y, "keyup", "f", pause_s=0)
        self.see_banner(f"Nothing can be saved: {disk / 'session.journal'}: cannot be written: No space left on device")
        self.see_banner("Save as continues in another folder.")
        for other in others:
            other.unlink()
        self.check_stroke((x, y + 30), (x + 20, y + 30))   # the picture begins below the banner
        self.see("Painted ", "Status")
        self.click_on("Try to save", BANNER)
        self.see_no_more("", BANNER)
        self.finish()

    def fill(self, disk, left):
        """Leaves so many bytes free."""
        free = os.statvfs(disk).f_bavail * os.statvfs(disk).f_frsize
        with (disk / "other").open("wb", buffering=0) as other:
            try:
                other.write(bytes(max(0, free - left)))
            except OSError:   # the file itself takes some
                pass

    def paint_on(self, disk):
        self.open_scan(self.put_onto(disk), preferences={"hints_seen": 3})
        self.assertEqual(self.seen(window=BANNER), [])
        self.check_probe(*self.middle())
        x, y = self.middle()
        self.check_stroke((x, y), (x + 20, y))
        self.see("Painted ", "Status")
        return x, y

    def test_what_the_journal_lacks_is_not_given_up(self):
        disk = self.mount_disk()
        x, y = self.paint_on(disk)
        self.fill(disk, 0)
        for step in range(-6, 7):   # a file grows within its last block on a full disk, too
            if not self.seen(window=BANNER):
                self.check_stroke((x - 60, y + 10 * step), (x + 60, y + 10 * step))
        self.see_banner("No space left on device")
        self.see_banner("The last changes are in memory only")
        self.do("key", "ctrl+q", pause_s=0)
        self.see_banner("The window stays open, since not all could be saved: ")
        self.assertEqual(self.seen("Close without saving"), [])
        (disk / "other").unlink()
        self.finish()

    def test_a_full_disk_is_said_until_a_save_succeeds_and_closing_can_be_insisted_upon(self):
        disk = self.mount_disk()
        x, y = self.paint_on(disk)
        self.fill(disk, 128 << 10)   # room for the journal, not for the mask
        self.check_key("Ctrl+S", "save")
        self.see("Not saved: ", BANNER)
        self.see_banner("the free space of its disk")
        self.see_banner("All paint and traces are in the journal.")
        self.assertEqual(self.seen("Close without saving"), [])
        # Closing is refused, in words that end within the picture's width, with what helps as buttons.
        self.do("key", "ctrl+q", pause_s=0)
        self.see("Close without saving", BANNER)
        self.see_banner("Save as... Try to save Close without saving The window stays open, since not all could be saved: ")
        self.see_banner("closing without saving leaves them there.")
        self.assertTrue(self.lies_within(BANNER), self.seen(window=BANNER))
        (disk / "other").unlink()
        self.click_on("Try to save", BANNER)
        self.see_no_more("", BANNER)
        self.see("Saved ", "Status")
        self.fill(disk, 128 << 10)
        self.check_stroke((x, y + 20), (x + 20, y + 20))
        self.do("key", "ctrl+q", pause_s=0)
        self.click_on("Close without saving", BANNER)
        output, errors = self.program.communicate(timeout=PATIENCE_S)
        self.assertEqual(self.program.returncode, 0, errors)
        self.assertIn('"voxels_in_group"', output)


if __name__ == "__main__":
    unittest.main()
