"""What the driver compiled is kept from one start of shvr to the next, by a driver that remembers
(tests/layers/cache.cpp)."""
import subprocess
import unittest

from harness import ENVIRONMENT, SHVR, TIMEOUT_S, CliTest


class Cache(CliTest):
    def setUp(self):
        super().setUp()
        self.session = self.write_session()
        self.kept = self.folder / "cache"

    def start(self, layers="VK_LAYER_SHVR_cache", **environment):
        """Draws a picture; what the driver compiled, had cached, and what the first thread waited for."""
        log, picture = self.folder / "cache.log", self.folder / "a.pfm"
        result = subprocess.run([SHVR, "render", self.session, "-o", picture], capture_output=True, text=True,
                                timeout=TIMEOUT_S,
                                env={**ENVIRONMENT, "SHVR_VALIDATION": "", "XDG_CACHE_HOME": str(self.kept),
                                     "VK_INSTANCE_LAYERS": layers, "SHVR_CACHE_LOG": str(log), **environment})
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertNotIn("warning", result.stderr)
        counts = {line.split()[0]: int(line.split()[1]) for line in log.read_text().splitlines()}
        self.assertEqual(counts["refused"], 0)
        return counts

    def file(self):
        files = list((self.kept / "shvr").iterdir())
        self.assertEqual(len(files), 1)
        return files[0]

    def test_a_second_start_compiles_nothing(self):
        first = self.start()
        self.assertGreater(first["compiled"], 0)
        before = self.file().stat().st_mtime_ns
        second = self.start()
        self.assertEqual((second["compiled"], second["cached"]), (0, first["compiled"]))
        self.assertEqual(self.file().stat().st_mtime_ns, before)   # there was nothing to add

    def test_on_a_gpu_another_thread_makes_what_was_used_the_last_time(self):
        layers = "VK_LAYER_SHVR_limits:VK_LAYER_SHVR_cache"
        first = self.start(layers, SHVR_LIMITS="nvidia")
        self.assertEqual(first["waited"], first["compiled"])
        second = self.start(layers, SHVR_LIMITS="nvidia", SHVR_CACHE_PATIENT="1")
        self.assertEqual((second["compiled"], second["cached"]), (0, first["compiled"]))
        self.assertLess(second["waited"], first["waited"])

    def test_a_file_that_is_damaged_or_another_drivers_counts_as_none_and_is_replaced(self):
        first = self.start()
        whole = self.file().read_bytes()
        damaged = {"empty": b"", "short": whole[:40], "half": whole[:len(whole) // 2], "long": whole + b"x",
                   "flipped": whole[:-20] + bytes([whole[-20] ^ 1]) + whole[-19:], "noise": bytes(range(256)) * 40}
        for name, content in damaged.items():
            with self.subTest(name):
                self.file().write_bytes(content)
                self.assertEqual(self.start(), first)
                self.assertEqual(self.file().read_bytes(), whole)
                self.assertEqual(self.start()["compiled"], 0)
        self.assertEqual(self.start(SHVR_CACHE_DRIVER="7"), first)
        self.assertEqual(self.start(SHVR_CACHE_DRIVER="7")["compiled"], 0)
        self.assertEqual(self.start(), first)

    def test_a_place_that_cannot_be_written_is_no_failure(self):
        first = self.start()
        self.kept = self.folder / "file"
        self.kept.write_text("")
        self.assertEqual(self.start(), first)
        self.kept = self.folder / "other"
        (self.kept / "shvr").mkdir(parents=True)
        name = next((self.folder / "cache" / "shvr").iterdir()).name
        (self.kept / "shvr" / name).mkdir()   # a folder where the file would be
        self.assertEqual(self.start(), first)

    def test_a_driver_that_keeps_nothing_gets_no_file(self):
        (self.folder / "cache.log").write_text("refused 0")   # without the cache layer: refusals are not counted
        self.start("VK_LAYER_SHVR_speed")
        self.assertFalse((self.kept / "shvr").exists())


if __name__ == "__main__":
    unittest.main()
