"""What the window does when the graphics device or its surface fails: by a layer that lets calls fail (tests/layers)."""
import subprocess
import time
import unittest
from pathlib import Path

from harness import ENVIRONMENT, SHVR
from seen import Seen
from window import PATIENCE_S, WINDOW


class Faults(Seen):
    def start_with_faults(self, session):
        self.now, self.faults_log = self.folder / "faults", self.folder / "faults.log"
        # Without hazards between submissions: after one that failed, that part of the validation layer (1.3.239)
        # follows what is gone, and crashes where the program waits for the device.
        self.open_scan(session, preferences={"hints_seen": 3},
                       environment={"VK_LAYER_ENABLES": "", "VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_faults",
                                    "SHVR_FAULTS_NOW": self.now, "SHVR_FAULTS_LOG": self.faults_log})
        return self.middle()

    def fired(self):
        return self.faults_log.read_text().count("fired") if self.faults_log.exists() else 0

    def let_fail(self, *faults, meanwhile=lambda: None):
        """From now on; returns once the first of them has fired, while the pointer moves as a hand does. `meanwhile`:
        done once they may fire."""
        before = self.fired()
        written = self.folder / "faults.new"
        written.write_text(" ".join(faults))
        written.rename(self.now)
        meanwhile()
        x, y = self.middle()
        end = time.monotonic() + PATIENCE_S
        step = 0
        while self.fired() == before:
            self.assertLess(time.monotonic(), end, f"{faults} did not fire")
            step += 1
            self.do("mousemove", x + 60 + step % 7, y + 60, pause_s=0.05)
        self.do("mousemove", x + 60, y + 60, pause_s=0)

    def recover_from(self, *faults, **others):
        """Lets them fail, and waits until the whole picture is on the screen again."""
        self.let_fail(*faults, **others)
        self.see_picture()

    def tell_of(self, *calls):
        """Each is logged when it is first called from now on, and goes on as ever."""
        written = self.folder / "faults.new"
        written.write_text(" ".join(f"{call}:1:suboptimal" for call in calls))
        written.rename(self.now)
        end = time.monotonic() + PATIENCE_S
        while self.now.exists():   # until any call has been made
            self.assertLess(time.monotonic(), end, f"no call was made since {self.now} was written")
            self.do("mousemove_relative", 1, 0, pause_s=0.1)

    def paint_at(self, x, y, group):
        self.press_first(str(group), "set probe.group")   # it may be that one already
        self.check_probe(x, y)
        self.check_stroke((x, y), (x + 8, y + 4))

    def photograph(self, session):
        """After a save; returns its file."""
        self.check_key("Ctrl+S", "save")
        self.check_key("F12", "screenshot")
        path = self.folder / f"{session.stem}-view-1.png"
        self.wait_for_file(path)
        return path

    def test_a_lost_device_is_made_anew_and_nothing_is_lost(self):
        session = self.write_ball()
        x, y = self.start_with_faults(session)
        self.paint_at(x, y, 3)
        self.check_key("Ctrl+S", "save")
        self.paint_at(x - 25, y - 15, 5)            # not saved
        for call in ["vkQueueSubmit2", "vkWaitForFences", "vkGetFenceStatus", "vkQueuePresentKHR"]:
            self.recover_from(f"{call}:3:device_lost")
        # A stroke that is under way goes on with the new device.
        self.check_key("6", "set probe.group")
        self.check_probe(x - 10, y + 20)
        self.check_follows(lambda: self.do("keydown", "f", "mousemove_relative", 6, -4, pause_s=0), "paint_here")
        self.recover_from("vkQueueSubmit2:3:device_lost")
        self.check_follows(lambda: self.do("keyup", "f", pause_s=0), "paint_here")
        self.paint_at(x + 20, y - 20, 7)
        photograph = self.photograph(session)
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertEqual(said.count("was restarted"), 5, said)
        self.assertNotIn("incomplete", said)
        self.assertEqual(sorted(report["voxels_in_group"]), ["3", "5", "6", "7"])
        self.check_photograph(session, photograph)

    def test_nothing_waits_for_the_device_while_the_window_is_painted_in_turned_and_resized(self):
        session = self.write_ball()
        x, y = self.start_with_faults(session)
        window = self.window_named("sphere.* - SHVR")

        def work(step):
            self.display.do("windowsize", window, WINDOW[0] - 9 * step, WINDOW[1] - 7 * step)
            self.see_frames()
            self.check_follows(lambda: self.do("mousemove", x, y, "mousedown", 1, "mousemove", x + 20 + step, y + 9,
                                               "mouseup", 1, pause_s=0), "orbit")
            self.check_stroke((x, y), (x + 6, y + 2))

        self.check_probe(x, y)
        work(0)
        self.tell_of("vkDeviceWaitIdle", "vkQueueWaitIdle")
        for step in [*range(1, 9), *range(8, -1, -1)]:
            work(step)
        # Dragged by an edge: a swapchain for each frame, none of which is drawn in twice.
        for step in range(40):
            self.do("windowsize", window, WINDOW[0] - 3 * step, WINDOW[1] - 2 * step, pause_s=0.03)
        self.do("mousemove", x + 3, y + 3, pause_s=0)
        self.see_picture()
        self.assertFalse(self.faults_log.exists(), "something waited for the device")
        self.assertEqual(sorted(self.finish()["voxels_in_group"]), ["3"])
        log = self.faults_log.read_text()
        self.assertIn("fired vkDeviceWaitIdle", log)    # the layer does log
        self.assertNotIn("leaked", log)
        made = next(int(line.split()[1]) for line in log.splitlines() if line.startswith("vkCreateSwapchainKHR "))
        self.assertGreater(made, 17)

    def test_a_surface_that_is_lost_or_out_of_date_is_made_anew(self):
        session = self.write_ball()
        x, y = self.start_with_faults(session)
        for fault in ["vkQueuePresentKHR:1:surface_lost", "vkAcquireNextImageKHR:1:surface_lost",
                      "vkAcquireNextImageKHR:1:out_of_date", "vkQueuePresentKHR:1:out_of_date",
                      "vkQueuePresentKHR:1+:suboptimal"]:
            self.recover_from(fault)
        self.paint_at(x, y, 3)
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertNotIn("surface", said)
        self.assertNotIn("Vulkan", said)
        self.assertEqual(sorted(report["voxels_in_group"]), ["3"])
        # Permanently suboptimal, for a surface that does not change: the swapchain is not re-created for that.
        self.assertNotIn("vkCreateSwapchainKHR", self.faults_log.read_text().split("suboptimal")[-1])

    def test_a_screen_that_never_takes_a_picture_again_keeps_nobody_from_work_and_from_leaving(self):
        for fault in ["vkAcquireNextImageKHR:1+:not_ready", "vkAcquireNextImageKHR:1+:out_of_date",
                      "vkAcquireNextImageKHR:1+:surface_lost", "vkQueuePresentKHR:1+:out_of_date",
                      "vkQueuePresentKHR:1+:surface_lost"]:
            with self.subTest(fault):
                session = self.write_ball()
                x, y = self.start_with_faults(session)
                self.paint_at(x, y, 3)
                self.let_fail(fault)
                self.check_key("5", "set probe.group")
                self.check_stroke((x + 12, y + 8), (x - 8, y + 4))
                for group in (6, 7) * 5:   # after each another frame fails
                    self.check_key(str(group), "set probe.group")
                report = self.finish()
                self.assertEqual(sorted(report["voxels_in_group"]), ["3", "5"], report["messages"])
                log = self.faults_log.read_text()
                self.assertNotIn("leaked", log)
                self.faults_log.unlink()

    def test_memory_that_is_short_for_a_moment_is_said_and_the_work_goes_on(self):
        session = self.write_ball()
        x, y = self.start_with_faults(session)
        self.paint_at(x, y, 3)
        for call, error in [("vkEndCommandBuffer", "out_of_device_memory"), ("vkQueueSubmit2", "out_of_host_memory"),
                            ("vkResetFences", "out_of_device_memory"), ("vkBeginCommandBuffer", "out_of_device_memory"),
                            ("vkAllocateDescriptorSets", "out_of_device_memory")]:
            self.recover_from(f"{call}:1:{error}", f"{call}:2:{error}")
        self.paint_at(x + 20, y - 20, 5)
        photograph = self.photograph(session)
        report = self.finish()
        self.assertEqual(sorted(report["voxels_in_group"]), ["3", "5"], report["messages"])
        self.check_photograph(session, photograph)

    def window(self):
        return self.window_named("sphere.* - SHVR")

    def test_a_window_that_is_resized_and_hidden_while_calls_fail_goes_on(self):
        session = self.write_ball()
        x, y = self.start_with_faults(session)
        self.paint_at(x, y, 3)
        for size, fault in [((700, 500), "vkCreateSwapchainKHR:1:out_of_device_memory"),
                            ((960, 640), "vkAllocateMemory:1:out_of_device_memory"),
                            ((640, 480), "vkCreateImage:1:out_of_host_memory"),
                            ((720, 620), "vkCreateImageView:1:out_of_device_memory"),
                            ((760, 520), "vkCreateFramebuffer:1:out_of_device_memory"),
                            ((820, 640), "vkGetPhysicalDeviceSurfaceCapabilitiesKHR:1:surface_lost"),
                            ((900, 600), "vkCreateSwapchainKHR:1:device_lost")]:
            with self.subTest(fault):
                self.recover_from(fault, meanwhile=lambda: self.do("windowsize", self.window(), *size, pause_s=0))
                self.assertIsNone(self.program.poll())
        # Out of sight nothing is lost, and in sight again the work goes on.
        hidden = self.window()
        self.recover_from("vkQueueSubmit2:1:device_lost", meanwhile=lambda: self.do(
            "key", "5", "keydown", "f", "mousemove_relative", 8, 4, "windowunmap", hidden, "sleep", 0.5, "windowmap",
            hidden, "keyup", "f", pause_s=0))
        self.paint_at(x + 20, y - 20, 7)
        photograph = self.photograph(session)
        report = self.finish()
        self.assertLessEqual({"3", "7"}, set(report["voxels_in_group"]), report["messages"])
        self.check_photograph(session, photograph)


class Memory(Seen):
    """A scan for which there is no memory, opened beside one that is painted in."""

    def ask_for(self, path):
        self.press("Ctrl+O")
        self.see_at_rest("Hidden")
        self.do("key", "ctrl+a", "type", "--delay", 30, path, pause_s=0)
        self.see(str(path), "Open a volume")
        self.press("Enter")

    def test_a_scan_that_host_memory_is_too_short_for_is_refused_in_words_and_the_work_goes_on(self):
        stub = Path(SHVR).resolve().parent / "stubs" / "libshort_memory.so"
        if subprocess.run([SHVR, "--version"], env={**ENVIRONMENT, "LD_PRELOAD": str(stub)}, stdout=subprocess.DEVNULL,
                          check=False).returncode:
            self.skipTest("the program's sanitizer wants to be loaded first")
        short, refused = self.folder / "short", self.folder / "short.log"
        said = self.check_refusal({"LD_PRELOAD": stub, "SHVR_SHORT_BYTES": 1 << 20, "SHVR_SHORT_WHILE": short,
                                   "SHVR_SHORT_LOG": refused}, short, refused, f"{self.folder / 'large.nrrd'}: ")
        self.assertIn("host memory is exhausted", said)
        self.assertRegex(self.told, "large.nrrd: host memory is exhausted, with [0-9]+ MiB in use; expected more: close")

    def test_a_scan_that_device_memory_is_too_short_for_is_refused_in_words_and_the_work_goes_on(self):
        short, refused = self.folder / "short", self.folder / "short.log"
        said = self.check_refusal({"VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_memory", "SHVR_DEVICE_SHORT_BYTES": 1 << 20,
                                   "SHVR_DEVICE_SHORT_WHILE": short, "SHVR_DEVICE_SHORT_LOG": refused}, short, refused,
                                  "the device is out of memory")
        self.assertIn("SHVR uses", said)

    def check_refusal(self, environment, short, refused, begins):
        """Opens a scan while the file `short` is there, and once it is not; returns why the first did not succeed,
        words that begin so."""
        side, scan = 128, self.folder / "large.nrrd"
        scan.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nencoding: raw\n\n"
                         % (side, side, side) + bytes(range(256)) * (side ** 3 // 256))
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3}, environment=environment)
        x, y = self.middle()
        self.check_probe(x, y)
        self.check_stroke((x, y), (x + 8, y + 4))

        short.touch()
        self.ask_for(scan)
        said = self.see(begins)["text"]
        self.assertNotIn("bad_alloc", said)
        self.assertTrue(refused.exists())
        # The chooser stays, and what was open is painted in as before.
        self.press("Escape")
        self.see_no_more("Hidden")
        self.check_key("5", "set probe.group")
        self.check_stroke((x - 12, y - 8), (x - 20, y - 4))

        short.unlink()
        self.ask_for(scan)
        self.see("Opened ")
        report = self.finish()
        self.assertTrue(any(line.startswith(f"Opened {scan}") for line in report["messages"]), report["messages"])
        self.told = "\n".join(report["messages"])
        # The strokes are complete although they were not saved.
        exported = self.check_json("export", self.folder / "session.json", "--mask", self.folder / "mask.nrrd")
        self.assertEqual(set(exported["voxels_by_group"]), {"3", "5"})
        return said


if __name__ == "__main__":
    unittest.main()
