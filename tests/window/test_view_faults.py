"""What the window does when the graphics device or its surface fails: by a layer that lets calls fail (tests/layers)."""
import time
import unittest

from test_view import PATIENCE_S, Window


class Faults(Window):
    def start_with_faults(self, session):
        self.now, self.log = self.folder / "faults", self.folder / "faults.log"
        # Without hazards between submissions: after one that failed, that part of the validation layer (1.3.239)
        # follows what is gone, and crashes where the program waits for the device.
        self.start(session, environment={"VK_LAYER_ENABLES": "", "VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_faults",
                                         "SHVR_FAULTS_NOW": self.now, "SHVR_FAULTS_LOG": self.log})
        self.wait_for_window("sphere.* - SHVR")
        return self.middle()

    def let_fail(self, *faults):
        """From now on; returns once the first of them has fired, while the pointer moves as a hand does."""
        before = self.log.read_text().count("fired") if self.log.exists() else 0
        written = self.folder / "faults.new"
        written.write_text(" ".join(faults))
        written.rename(self.now)
        x, y = self.middle()
        end = time.monotonic() + PATIENCE_S
        step = 0
        while not self.log.exists() or self.log.read_text().count("fired") == before:
            self.assertLess(time.monotonic(), end, f"{faults} did not fire")
            step += 1
            self.do("mousemove", x + 60 + step % 7, y + 60, pause_s=0.1)
        self.do("mousemove", x + 60, y + 60, pause_s=1)

    def paint_at(self, x, y, group):
        self.do("key", str(group), pause_s=0.2)
        self.put_probe(x, y)
        self.stroke((x, y), (x + 8, y + 4))

    def test_a_lost_device_is_made_anew_and_nothing_is_lost(self):
        session = self.write_ball()
        x, y = self.start_with_faults(session)
        self.paint_at(x, y, 3)
        self.do("key", "ctrl+s", pause_s=1)
        self.paint_at(x - 25, y - 15, 5)            # not saved
        for call in ["vkQueueSubmit2", "vkWaitForFences", "vkGetFenceStatus", "vkQueuePresentKHR"]:
            self.let_fail(f"{call}:3:device_lost")
            time.sleep(1.5)
        self.paint_at(x + 20, y - 20, 7)
        self.do("key", "ctrl+s", pause_s=1)
        self.do("key", "F12")
        photograph = self.folder / "session-view-1.png"
        self.wait_for_file(photograph)
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertEqual(said.count("was started again"), 4, said)
        self.assertEqual(sorted(report["voxels_in_group"]), ["3", "5", "7"])
        self.check_photograph(session, photograph)

    def test_a_surface_that_is_lost_or_out_of_date_is_made_anew(self):
        session = self.write_ball()
        x, y = self.start_with_faults(session)
        for fault in ["vkQueuePresentKHR:1:surface_lost", "vkAcquireNextImageKHR:1:surface_lost",
                      "vkAcquireNextImageKHR:1:out_of_date", "vkQueuePresentKHR:1:out_of_date",
                      "vkQueuePresentKHR:1+:suboptimal"]:
            self.let_fail(fault)
        self.paint_at(x, y, 3)
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertNotIn("surface", said)
        self.assertNotIn("Vulkan", said)
        self.assertEqual(sorted(report["voxels_in_group"]), ["3"])
        # Suboptimal for good, of a surface that stays as it is: nothing is made anew for that.
        self.assertNotIn("vkCreateSwapchainKHR", self.log.read_text().split("suboptimal")[-1])

    def test_memory_that_is_short_for_a_moment_is_said_and_the_work_goes_on(self):
        session = self.write_ball()
        x, y = self.start_with_faults(session)
        self.paint_at(x, y, 3)
        for call, error in [("vkEndCommandBuffer", "out_of_device_memory"), ("vkQueueSubmit2", "out_of_host_memory"),
                            ("vkResetFences", "out_of_device_memory"), ("vkBeginCommandBuffer", "out_of_device_memory"),
                            ("vkAllocateDescriptorSets", "out_of_device_memory")]:
            self.let_fail(f"{call}:1:{error}", f"{call}:2:{error}")
            time.sleep(1)
        self.paint_at(x + 20, y - 20, 5)
        self.do("key", "ctrl+s", pause_s=1)
        self.do("key", "F12")
        photograph = self.folder / "session-view-1.png"
        self.wait_for_file(photograph)
        report = self.finish()
        self.assertEqual(sorted(report["voxels_in_group"]), ["3", "5"], report["messages"])
        self.check_photograph(session, photograph)


if __name__ == "__main__":
    unittest.main()
