"""Rendering, painting, paging and labelling on devices with other limits, by a layer that reports and keeps to them
(tests/layers/records.h): pictures and paint have the bits that they have on this device."""
import unittest

from harness import CliTest, run

RECORDS = ["nvidia", "amd", "apu", "intel", "minimum"]


class Records(CliTest):
    def on(self, record, *arguments):
        """Runs it on such a device; it may not ask for what the device does not have."""
        log = self.folder / "limits.log"
        result = run(*arguments, environment={"VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_limits", "SHVR_LIMITS": record,
                                              "SHVR_LIMITS_LOG": log})
        self.assertEqual(result.returncode, 0, f"{record}: shvr {arguments}\n{result.stdout}\n{result.stderr}")
        self.assertEqual(log.read_text() if log.exists() else "", "", record)
        return result

    def session(self, name, voxels, **render):
        return self.write_session(name, volume={"procedural": "sphere", "size": voxels},
                                  render={"sampling": "exact", **render},
                                  light={"shaded": True, "occlusion": {"strength": 0.8}})

    def test_pictures_have_the_same_bits(self):
        session = self.session("small.json", [50, 40, 70], size=[61, 43])
        for paging in ["automatic", "always"]:
            here = self.folder / f"{paging}.pfm"
            self.check("render", session, "-o", here, "--set", f"render.paging={paging}")
            for record in RECORDS:
                there = self.folder / f"{record}-{paging}.pfm"
                self.on(record, "render", session, "-o", there, "--set", f"render.paging={paging}")
                self.assertEqual(there.read_bytes(), here.read_bytes(), (record, paging))

    def test_a_volume_larger_than_an_image_is_paged(self):
        # 512 bricks, where an image of 256 texels a side holds 343: without paging it cannot be drawn.
        session = self.session("large.json", [250, 250, 250], size=[24, 16], step_voxels=4)
        self.check("render", session, "-o", self.folder / "here.pfm", "--set", "light.occlusion.strength=0")
        picture = self.folder / "there.pfm"
        self.on("minimum", "render", session, "-o", picture, "--set", "light.occlusion.strength=0")
        self.assertEqual(picture.read_bytes(), (self.folder / "here.pfm").read_bytes())
        result = run("render", session, "-o", picture, "--set", "render.paging=never",
                     environment={"VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_limits", "SHVR_LIMITS": "minimum"})
        self.assertEqual(result.returncode, 1)
        self.assertIn("render.paging is never, and an image of device record of the least device cannot hold all",
                      result.stderr)

    def test_a_device_that_cannot_run_the_kernels_is_refused_by_what_it_lacks(self):
        session = self.session("small.json", [20, 20, 20], size=[24, 16])
        result = run("render", session, "-o", self.folder / "there.pfm",
                     environment={"VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_limits", "SHVR_LIMITS": "bare"})
        self.assertEqual(result.returncode, 1)
        self.assertIn("it allows 4 storage images in a kernel; expected at least 13", result.stderr)

    def test_paint_has_the_same_voxels(self):
        session = self.session("paint.json", [50, 40, 70], size=[24, 16])
        strokes = [{"op": "paint", "brush": brush, "region": "ball", "group": group, "threshold": 60, "radius": 14,
                    "path": [[25, 20, 35], [20, 25, 45]]} for group, brush in [(3, "fill"), (5, "flood")]]
        script = self.write_script("strokes.jsonl", strokes + [{"op": "save"}])
        arguments = ["annotate", session, "--script", script, "--fresh"]
        mask = self.folder / "paint.mask"
        self.check(*arguments)
        expected = mask.read_bytes()
        self.assertGreater(len(expected) - expected.count(0), 1000)
        for record in RECORDS:
            mask.unlink()
            self.on(record, *arguments)
            self.assertEqual(mask.read_bytes(), expected, record)

    def test_labels_are_made_and_devices_named(self):
        for record in RECORDS:
            labels = self.folder / f"{record}.zarr"
            self.on(record, "label", self.session("label.json", [40, 40, 40]), "-o", labels, "--threshold", 100)
            self.assertTrue(labels.exists(), record)


if __name__ == "__main__":
    unittest.main()
