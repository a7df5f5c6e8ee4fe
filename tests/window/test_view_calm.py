"""A window in which nothing happens asks nothing of the device: counted by a layer that lets its next call fail
(tests/layers)."""
import time
import unittest

from seen import Seen

CALLS = "vkQueueSubmit2:1:out_of_host_memory vkQueuePresentKHR:1:out_of_date"
IDLE_S = 3


class Calm(Seen):
    def fired(self):
        return self.faults.read_text().count("fired") if self.faults.exists() else 0

    def test_while_nothing_happens_nothing_is_submitted_and_no_frame_is_drawn(self):
        now, self.faults = self.folder / "faults", self.folder / "faults.log"
        layers = {"VK_LAYER_ENABLES": "", "VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_faults", "SHVR_FAULTS_NOW": now,
                  "SHVR_FAULTS_LOG": self.faults}
        self.open_scan(self.write_ball(), preferences={"hints_seen": 3}, environment=layers)
        self.do("mousemove", *self.middle(), pause_s=0)
        for _ in range(50):   # until the last event has been answered for good
            frame = self.frame()["frame"]
            time.sleep(1)
            if self.frame()["frame"] == frame:
                break
        written = self.folder / "faults.new"
        written.write_text(CALLS)
        written.rename(now)
        time.sleep(IDLE_S)
        self.assertEqual(self.fired(), 0)
        self.assertEqual(self.frame()["frame"], frame)
        x, y = self.middle()
        for step in range(50):   # the layer does log
            if self.fired():
                break
            self.do("mousemove", x + step % 7, y, pause_s=0.1)
        self.assertGreater(self.fired(), 0)
        self.finish()


if __name__ == "__main__":
    unittest.main()
