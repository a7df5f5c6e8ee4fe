"""The window on a screen that is slow to give images back, or that gives none (tests/layers/screen.cpp)."""
import time
import unittest

from seen import Seen


class Vblank(Seen):
    def on_slow_screen(self, blank_us=16700, **others):
        self.hidden, self.screen_log = self.folder / "hidden", self.folder / "screen.log"
        return {"VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_screen", "SHVR_SCREEN_BLANK_US": blank_us,
                "SHVR_SCREEN_HIDDEN": self.hidden, "SHVR_SCREEN_LOG": self.screen_log, **others}

    def open_on_slow_screen(self, blank_us=16700):
        session = self.write_ball()
        self.open_scan(session, environment=self.on_slow_screen(blank_us))
        return session

    def counts(self):
        return {line.split()[0]: int(line.split()[1]) for line in self.screen_log.read_text().splitlines()}

    def test_nothing_waits_for_the_screen(self):
        self.open_on_slow_screen(blank_us=150_000)  # longer than a frame takes on a busy machine
        x, y = self.middle()
        self.do("mousemove", x, y, "mousedown", 1)
        for step in range(40):
            self.do("mousemove", x + step, y + step // 2, pause_s=0.02)
        self.do("mouseup", 1)
        self.until(lambda: self.frame()["sharp"], "sharp picture")
        self.finish()
        counts = self.counts()
        self.assertGreater(counts["acquired"], 10)
        # Except for the first images of a swapchain, which some drivers are slow to make.
        self.assertLessEqual(counts["waited"], 4 * counts["swapchains"])
        self.assertEqual(counts["mailboxes"], counts["swapchains"])  # an X server has them

    def test_where_presenting_waits_for_the_screen_work_is_handed_in_before(self):
        self.view(self.write_fog(), environment=self.on_slow_screen(
            SHVR_SCREEN_FIFO=1, VK_INSTANCE_LAYERS="VK_LAYER_SHVR_screen:VK_LAYER_SHVR_limits", SHVR_LIMITS="nvidia"))
        x, y = self.middle()
        self.do("mousemove", x, y, "mousedown", 1)
        first, step = self.frame()["frame"], 0
        while self.frame()["frame"] < first + 30:
            step += 1
            self.do("mousemove", x + step % 60, y + step % 40, pause_s=0.02)
        self.do("mouseup", 1)
        self.finish()
        counts = self.counts()
        self.assertEqual(counts["mailboxes"], 0)
        self.assertGreaterEqual(counts["waited_for_blank"], 30)
        # Without that none would be filled. A slow device always has enough work in flight.
        self.assertGreater(counts["filled"], 0)

    def test_work_goes_on_while_the_window_is_hidden_and_is_seen_once_it_is_not(self):
        session = self.open_on_slow_screen()
        x, y = self.middle()
        self.put_probe(x, y)
        self.until(lambda: self.frame()["sharp"], "sharp picture")
        self.hidden.touch()
        time.sleep(0.2)  # what is on its way is shown
        before = self.frame()["frame"]
        kept = session.read_text()
        self.stroke((x, y), (x + 12, y + 4))
        self.assertIn("save", self.what_follows(lambda: self.press("Ctrl+S"), "save"))
        self.until(lambda: session.read_text() != kept, "saved session")
        self.assertEqual(self.frame()["frame"], before)
        self.hidden.unlink()
        self.until(lambda: self.frame()["frame"] > before, "frame")  # though nothing happens in the window
        report = self.finish()
        self.assertEqual(sorted(report["voxels_in_group"]), ["3"])


if __name__ == "__main__":
    unittest.main()
