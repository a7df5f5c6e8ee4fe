"""Pictures and paint are the same bits where new memory is full of random ones, by a layer (tests/layers/noise.cpp):
whatever is read was written before."""
import unittest

from harness import IS_SLOW, CliTest, run

POINTS = [{"intensity": 40, "color": "#b08050", "opacity": 0.0}, {"intensity": 120, "color": "#d8b070", "opacity": 0.2},
          {"intensity": 255, "color": "#ffffff", "opacity": 0.5}]
FEATURES = {   # of whole keys of a session
    "shaded": {},
    "occluded": {"light": {"shaded": True, "occlusion": {"strength": 0.8, "radius": 6}}},
    "preintegrated": {"render": {"preintegration": True}},
    "filtered": {"render": {"sampling": "hardware"}},
    "gray": {"render": {"saturation": 0.3}},
    "with surfaces": {"surfaces": [{"from": [8, 8, 8], "to": [50, 45, 40], "radius": 4, "color": "#ff4020"}]},
    "with a shell": {"probe": {"shell": True, "radius_voxels": 14, "paint_threshold": 70}},
    "with a preview": {"probe": {"preview": True, "brush": "fill", "group": 1, "voxel": [30, 32, 33],
                                 "radius_voxels": 12, "paint_threshold": 60}},
    "in distance": {"blend": {"size": 0.7, "color": "#203060"}},
}


def drawings(first):
    """Pairs of a feature and paging. Every day features after the first take turns in paging, and test_noise and
    test_shuffle begin with different ones, so that each pair is drawn by one of them."""
    pagings = ["never", "always"] if first == "never" else ["always", "never"]
    for number, feature in enumerate(FEATURES):
        if feature == "filtered":
            # The filtered values of a paged brick depend on the slot that it happens to get.
            yield feature, "never"
        elif IS_SLOW or number == 0:
            yield from ((feature, paging) for paging in pagings)
        else:
            yield feature, pagings[number % 2]


class Scans(CliTest):
    def scan(self, name, **keys):
        render = {"size": [43, 31], **keys.pop("render", {})}
        return self.write_session(name, **{"volume": {"procedural": "tubes", "size": [70, 66, 68], "seed": 3},
                                           "transfer_function": {"points": POINTS}, "light": {"shaded": True},
                                           "groups": {"3": {"color": "#20a0ff", "opacity": 0.4}},
                                           "camera": {"side": "front", "turn_degrees": 30}, "render": render, **keys})

    def paint(self):
        """A command that paints paint.mask, with all brushes."""
        strokes = [{"op": "paint", "brush": brush, "region": "ball", "group": 3, "threshold": 60, "radius": 11,
                    "path": [[25, 20, 35], [40, 38, 33]]} for brush in ["fill", "flood", "speckle"]]
        script = self.write_script("strokes.jsonl", strokes + [{"op": "save"}])
        return ["annotate", self.scan("scan.json"), "--script", script, "--fresh"]


class Noise(Scans):
    def on_noise(self, *arguments):
        result = run(*arguments, environment={"VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_noise"})
        self.assertEqual(result.returncode, 0, f"{arguments}\n{result.stdout}\n{result.stderr}")

    def test_paint_and_pictures_have_their_bits(self):
        paint, mask = self.paint(), self.folder / "paint.mask"
        self.check(*paint)
        expected = mask.read_bytes()
        self.assertGreater(len(expected) - expected.count(0), 1000)
        mask.unlink()
        self.on_noise(*paint)
        self.assertEqual(mask.read_bytes(), expected)
        here, there = self.folder / "here.pfm", self.folder / "there.pfm"
        seen = {"never": [], "always": []}
        for feature, paging in drawings("never"):
            drawn = self.scan(f"{feature}.json", **FEATURES[feature])
            with self.subTest(feature=feature, paging=paging):
                arguments = ["--set", f"render.paging={paging}"]
                self.check("render", drawn, "-o", here, *arguments)
                self.on_noise("render", drawn, "-o", there, *arguments)
                self.assertEqual(there.read_bytes(), here.read_bytes())
            seen[paging].append(here.read_bytes())
        for pictures in seen.values():
            self.assertEqual(len(set(pictures)), len(pictures))   # each feature is in its picture


if __name__ == "__main__":
    unittest.main()
