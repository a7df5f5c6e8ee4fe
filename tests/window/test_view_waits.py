"""Beside a heavy picture the window's thread waits for neither the device nor the screen, on a device that says it is
no software (tests/layers/limits.cpp); tests/layers/waits.cpp tells of each call that would."""
import unittest

from seen import Seen


class Waits(Seen):
    def waits(self):
        return [line for line in self.log_of_waits.read_text().splitlines() if line.startswith("main ")]

    def test_painting_and_turning_beside_a_heavy_picture_wait_for_nothing(self):
        self.log_of_waits = self.folder / "waits.log"
        self.log_of_waits.write_text("")
        session = self.write_fog()
        self.view(session, preferences={"hints_seen": 3},
                  environment={"VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_waits:VK_LAYER_SHVR_limits",
                               "SHVR_LIMITS": "nvidia", "SHVR_WAITS_LOG": self.log_of_waits})
        self.wait_for_window("fog.* - SHVR")
        x, y = self.middle()
        self.put_probe(x, y)
        self.until(lambda: not self.frame()["sharp"], "picture that is refined")
        self.rests_in_size()
        self.log_of_waits.write_text("")
        begun = self.frame()["frame"]
        for turn in range(3):
            self.do("mousemove", x, y, "mousedown", 1, "mousemove", x + 5 + turn, y, "mousemove", x + 9 + turn, y,
                    "mouseup", 1, pause_s=0)
            self.until(lambda: not self.frame()["sharp"], "picture that is refined")
            strokes = len([1 for action in self.done() if action["op"] == "paint_here"])
            self.stroke((x, y), (x + 6, y + 3), (x - 6, y + 5 + turn), pause_s=0)
            self.until(lambda: len([1 for action in self.done() if action["op"] == "paint_here"]) > strokes, "stroke")
            self.wander(10)
        self.see_frames(begun + 3)
        self.assertEqual(self.waits(), [])
        self.finish()
        # The layer does log waits: the device must be idle before it is destroyed.
        self.assertIn("main vkDeviceWaitIdle", self.waits())

    def rests_in_size(self):
        """The first images of a swapchain are waited for, since some drivers are slow to make them."""
        self.see_frames(self.frame()["frame"] + 8)

    def see_frames(self, number):
        """Moves the pointer until so many have been drawn: once the picture is sharp, nothing else asks for one, and a
        busy machine answers several moves by one."""
        def seen():
            self.wander(10)
            return self.frame()["frame"] > number
        self.until(seen, "frames")


if __name__ == "__main__":
    unittest.main()
