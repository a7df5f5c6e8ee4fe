"""How often shvr calls the driver, on a device that is infinitely fast (tests/layers/speed.cpp): exact gates, which
time on a shared machine cannot be."""
import subprocess
import unittest

from harness import ENVIRONMENT, SHVR, TIMEOUT_S, CliTest


class Counts(CliTest):
    def counts(self, *arguments):
        log = self.folder / "calls.log"
        subprocess.run([SHVR, *map(str, arguments)], check=True, capture_output=True, timeout=TIMEOUT_S,
                       env={**ENVIRONMENT, "SHVR_VALIDATION": "", "SHVR_FAULTS_LOG": str(log),
                            "VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_faults:VK_LAYER_SHVR_speed"})
        return {line.split()[0]: int(line.split()[1]) for line in log.read_text().splitlines()}

    def test_a_picture_of_a_4k_screen(self):
        counts = self.counts("render", self.write_session(), "-o", self.folder / "a.pfm", "--size", "3840x2160")
        # A submission for each of twelve parts, and more for the first one, whose duration is unknown: one for each of
        # its fifteen tiles.
        self.assertLessEqual(counts["vkQueueSubmit2"], 27)
        self.assertLessEqual(counts["vkAllocateMemory"], 17)
        self.assertLessEqual(counts["vkDeviceWaitIdle"], 2)   # at the end
        self.assertLessEqual(counts["vkCreateComputePipelines"], 5)   # three of the leap grid, its sample bits, rays
        for made_once in ["vkCreateFence", "vkCreateCommandPool", "vkCreateQueryPool", "vkCreateDescriptorPool"]:
            self.assertEqual(counts[made_once], 1, made_once)

    def test_paint_allocates_little(self):
        strokes = [{"op": "paint", "brush": "flood", "region": "ball", "group": 3, "threshold": 60, "radius": radius,
                    "path": [[12, 12, 12], [14, 13, 12]]} for radius in [3, 3.5, 4, 4.5, 5, 5.5, 6, 6.5, 7]]
        script = self.write_script("strokes.jsonl", strokes)
        counts = self.counts("annotate", self.write_session(), "--script", script)
        # Regions of every size find buffers of one, or small ones within one allocation.
        self.assertLessEqual(counts["vkAllocateMemory"], 40)


if __name__ == "__main__":
    unittest.main()
