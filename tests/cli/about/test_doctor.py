"""shvr doctor: a page about this machine, whatever is missing."""
import os
import unittest

from harness import CliTest, run

NO_DRIVER = {"VK_ICD_FILENAMES": "/nonexistent.json", "VK_DRIVER_FILES": "/nonexistent.json"}


class Doctor(CliTest):
    def test_names_device_limits_memory_and_folders(self):
        report = self.check_json("doctor")
        self.assertEqual(report["why_no_device"], "")
        self.assertGreater(report["limits"]["storage images in a kernel"], 0)
        self.assert_keys(report, ["device", "driver", "limits", "missing", "folders", "versions", "memory", "display"])
        self.assertEqual("shvr " + report["versions"]["shvr"] + "\n", self.check("--version").stdout)
        self.assertEqual(report["memory"]["processors"], len(os.sched_getaffinity(0)))
        pages, size = os.sysconf("SC_PHYS_PAGES"), os.sysconf("SC_PAGE_SIZE")
        self.assertEqual(report["memory"]["bytes"], pages * size)
        text = self.check("doctor").stdout
        for part in (report["device"], report["driver"], "Folders", "Missing"):
            self.assertIn(part, text)

    # Kind (Drivers): a machine without a Vulkan driver, display or home
    def test_without_device_display_or_home_it_says_what_to_install(self):
        bare = {**NO_DRIVER, **dict.fromkeys(["DISPLAY", "WAYLAND_DISPLAY", "HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME"], "")}
        result = run("doctor", environment=bare)
        self.assertEqual(result.returncode, 0, result.stderr)
        for part in ("no Vulkan device found", "package mesa-vulkan-drivers", "a display", "expected HOME"):
            self.assertIn(part, result.stdout)
        self.assertEqual(result.stderr, "")

    def test_a_folder_that_cannot_be_written_is_named(self):
        (self.folder / "file").write_text("")
        report_of = run("doctor", environment={"XDG_CACHE_HOME": str(self.folder / "file")}).stdout
        self.assertIn("is not a folder", report_of)

    def test_a_device_that_is_not_there_is_named(self):
        result = run("doctor", environment={"SHVR_DEVICE": "no such device"})
        self.assertEqual(result.returncode, 0)
        self.assertIn("SHVR_DEVICE is 'no such device'", result.stdout)

    def test_programs_that_help_are_missed(self):
        (self.folder / "bin").mkdir()
        said = run("doctor", environment={"PATH": str(self.folder / "bin")}).stdout
        for package in ("ffmpeg", "graphviz", "xdg-utils"):
            self.assertIn(f"package {package}", said)


if __name__ == "__main__":
    unittest.main()
