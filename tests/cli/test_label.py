"""shvr label: connected components of whole volumes, compared with a breadth-first search and read by python3-zarr."""
import itertools
import json
import random
import struct
import subprocess
import unittest

from harness import CliTest, Volume
from test_import import python_with_zarr

KEYS = ["components", "foreground_voxels", "largest_voxels", "seconds", "kept", "largest", "output", "type", "peak_bytes"]

# Runs in an interpreter that has python3-zarr. Prints a label image's metadata, and the coarse voxels that break the rule
# of downscaling: the most frequent label of the finer level; among equally frequent labels the smallest other than 0.
ZARR = """
import json, sys
import numpy, zarr
group = zarr.open_group(sys.argv[1], "r")
entry = group.attrs["multiscales"][0]
arrays = [group[dataset["path"]][:] for dataset in entry["datasets"]]
problems = []
for number, (fine, coarse) in enumerate(zip(arrays, arrays[1:])):
    for place in numpy.ndindex(coarse.shape):
        labels, counts = numpy.unique(fine[tuple(slice(2 * i, 2 * i + 2) for i in place)], return_counts=True)
        most = [int(label) for label, count in zip(labels, counts) if count == counts.max()]
        if coarse[place] != min(most, key=lambda label: (label == 0, label)):
            problems.append(f"level {number + 1} at {place}")
arrays[0].astype(arrays[0].dtype.newbyteorder("<")).tofile(sys.argv[2])
print(json.dumps({"problems": problems[:5], "type": arrays[0].dtype.name, "shapes": [list(a.shape) for a in arrays],
                  "scales": [[t.get("scale", t.get("translation")) for t in d["coordinateTransformations"]]
                             for d in entry["datasets"]],
                  "units": [axis.get("unit") for axis in entry["axes"]], "kind": entry["type"],
                  "label": group.attrs["image-label"], "shvr": group.attrs.get("shvr")}))
"""


def read_by_zarr(test, folder, bare):
    python = python_with_zarr()
    if python is None:
        test.skipTest("no interpreter here has python3-zarr")
    result = subprocess.run([python, "-c", ZARR, folder, bare], capture_output=True, text=True, timeout=120)
    test.assertEqual(result.returncode, 0, result.stderr)
    found = json.loads(result.stdout)
    test.assertEqual(found["problems"], [])
    return found


class Label(CliTest):
    SIZE = (21, 17, 38)
    SPACING = (0.5, 1.0, 2.0)

    def setUp(self):
        super().setUp()
        self.volume = Volume.noise(self.SIZE, seed=3, spacing=self.SPACING)
        self.header = self.volume.write(self.folder)

    def label(self, *arguments):
        return self.check_json("label", self.header, *arguments)

    def expected(self, threshold, connectivity):
        """The label of each voxel: components are numbered by their first voxel, x fastest."""
        voxels = [voxel[::-1] for voxel in itertools.product(*map(range, self.SIZE[::-1]))]
        above = {voxel for voxel in voxels if self.volume.values[self.volume.index(voxel)] >= threshold}
        labels, count = dict.fromkeys(voxels, 0), 0
        for voxel in voxels:
            if voxel in above and labels[voxel] == 0:
                count += 1
                for found in self.volume.component(voxel, above, connectivity):
                    labels[found] = count
        return [labels[voxel] for voxel in voxels]

    def test_counts_and_labels_are_those_of_a_search(self):
        for connectivity, threshold in [(6, 176), (26, 230), (6, 128)]:
            with self.subTest(connectivity=connectivity, threshold=threshold):
                expected = self.expected(threshold, connectivity)
                sizes = [expected.count(label) for label in range(1, max(expected) + 1)]
                output = self.folder / f"labels-{connectivity}-{threshold}.nrrd"
                result = self.label("--threshold", threshold, "--connectivity", connectivity, "-o", output)
                self.assert_keys(result, KEYS)
                self.assertEqual(result["components"], len(sizes))
                self.assertEqual(result["foreground_voxels"], sum(sizes))
                self.assertEqual(result["largest_voxels"], max(sizes))
                by_size = sorted(range(len(sizes)), key=lambda i: (-sizes[i], i))[:100]
                self.assertEqual(result["largest"], [{"label": i + 1, "voxels": sizes[i]} for i in by_size])
                letter = {"uint8": "B", "uint16": "H"}[result["type"]]
                self.assertEqual(result["type"], "uint8" if len(sizes) < 256 else "uint16")
                data = output.read_bytes()
                packed = struct.pack(f"<{len(expected)}{letter}", *expected)
                self.assertTrue(data.endswith(b"\n\n" + packed))
                without = self.label("--threshold", threshold, "--connectivity", connectivity, "--threads", 1)
                self.assertEqual((without["components"], without["output"]), (len(sizes), None))

    def test_every_form_holds_the_same(self):
        expected = self.expected(230, 26)
        self.assertLess(max(expected), 256)
        self.label("--threshold", 230, "--connectivity", 26, "-o", self.folder / "a.mask")
        self.assertEqual(list((self.folder / "a.mask").read_bytes()), expected)
        for name in ["a.tif", "a.zarr"]:
            path = self.folder / name
            self.label("--threshold", 230, "--connectivity", 26, "-o", path)
            info = self.check_json("info", path)
            self.assertEqual((info["size"], info["type"]), (list(self.SIZE), "uint8"))
            self.assertEqual([round(s, 6) for s in info["spacing"]], list(self.SPACING))
            # Labelling the labels again, from 1 on, finds the same foreground.
            again = self.check_json("label", path, "--threshold", 1, "-o", self.folder / "again.nrrd")
            self.assertEqual(again["foreground_voxels"], len(expected) - expected.count(0))
            dice = self.check_json("evaluate", "--truth-mask", self.folder / "a.mask", "--mask", path, "--volume",
                                   self.header)
            self.assertEqual(set(dice["dice_by_group"].values()), {1})

    def test_python_zarr_reads_the_labels(self):
        expected = self.expected(176, 6)
        result = self.label("--threshold", 176, "-o", self.folder / "a.zarr")
        self.assertEqual(result["type"], "uint16")
        found = read_by_zarr(self, self.folder / "a.zarr", self.folder / "bare")
        self.assertEqual((self.folder / "bare").read_bytes(), struct.pack(f"<{len(expected)}H", *expected))
        self.assertEqual(found["shapes"][0], list(self.SIZE[::-1]))
        self.assertEqual(found["scales"][0], [[2, 1, 0.5], [0, 0, 0]])
        self.assertEqual(found["scales"][1], [[4, 2, 1], [1, 0.5, 0.25]])
        self.assertEqual(found["kind"], "mode")
        self.assertEqual(found["label"], {"version": "0.4"})
        self.assertEqual(sorted(path.name for path in (self.folder / "a.zarr").iterdir()),
                         sorted([".zattrs", ".zgroup", *map(str, range(len(found["shapes"])))]))

    def test_a_project_takes_labels(self):
        project = self.folder / "project"
        self.check("import", self.header, project)
        for name in ["b", "a", "b"]:
            result = self.check_json("label", project, "--threshold", 200, "-o", project / "labels" / name)
        self.assertEqual(json.loads((project / "labels" / ".zattrs").read_text()), {"labels": ["b", "a"]})
        found = read_by_zarr(self, project / "labels" / "b", self.folder / "bare")
        self.assertEqual(found["label"]["source"], {"image": "../../"})
        self.assertEqual(found["type"], result["type"])
        self.assertEqual(self.check_json("info", project)["size"], list(self.SIZE))

    def write_offsets(self, path, offsets):
        """An offset file of a volume of 8 bits: a signed 16-bit number for each voxel."""
        path.write_bytes(struct.pack(f"<{len(offsets)}h", *offsets))

    def test_density_offsets_are_added(self):
        numbers = random.Random(4)
        offsets = [numbers.randint(-255, 255) if numbers.randrange(4) == 0 else 0 for _ in self.volume.values]
        session = self.write_session(volume={"path": self.header.name},
                                     annotation={"mask": "paint.mask", "density": "raised.offset"})
        labels = self.folder / "labels.nrrd"
        arguments = ["label", session, "--threshold", 200, "--connectivity", 26, "-o", labels]
        bare = self.expected(200, 26)
        without = self.check_json(*arguments)
        self.assertEqual((without["components"], without["voxels_with_offset"]), (max(bare), 0))
        self.write_offsets(self.folder / "raised.offset", offsets)
        (self.folder / "paint.mask").write_bytes(b"a mask of another volume is of no concern")
        self.volume.values = [min(max(v + o, 0), 255) for v, o in zip(self.volume.values, offsets)]
        expected = self.expected(200, 26)
        self.assertNotEqual(max(expected), max(bare))
        result = self.check_json(*arguments)
        self.assertEqual(result["components"], max(expected))
        self.assertEqual(result["foreground_voxels"], sum(label > 0 for label in expected))
        self.assertEqual(result["voxels_with_offset"], sum(offset != 0 for offset in offsets))
        letter = {"uint8": "B", "uint16": "H"}[result["type"]]
        self.assertTrue(labels.read_bytes().endswith(struct.pack(f"<{len(expected)}{letter}", *expected)))
        # The volume on its own, without the session, has no offsets.
        self.assertEqual(self.label("--threshold", 200, "--connectivity", 26)["components"], max(bare))
        (self.folder / "raised.offset").write_bytes(bytes(9))
        self.check_refused(*arguments, says=["raised.offset", "holds 9 bytes"])

    def test_offsets_open_and_close_a_path_in_a_project_before_they_are_saved(self):
        size = (40, 9, 9)
        values = [200 if x in (2, 3, 36, 37) and (y, z) == (4, 4) else 10
                  for z, y, x in itertools.product(*map(range, size[::-1]))]
        header, project = Volume(size, values).write(self.folder, "path"), self.folder / "project"
        self.check("import", header, project)
        count = lambda: self.check_json("label", project, "--threshold", 60)["components"]
        self.assertEqual(count(), 2)
        corridor = {"op": "density", "brush": "fill", "region": "ball", "threshold": 0, "radius": 1.2, "offset": 50,
                    "path": [[4.5, 4.5, 4.5], [35.5, 4.5, 4.5]]}
        script = self.write_script("open.jsonl", [corridor])
        self.check("annotate", project, "--script", script)
        journal = (project / "shvr" / "session.journal").read_bytes()
        self.assertEqual(count(), 1)
        self.assertEqual((project / "shvr" / "session.journal").read_bytes(), journal)
        script = self.write_script("close.jsonl", [{**corridor, "offset": 49, "path": [[20.5, 4.5, 4.5]]}])
        self.check("annotate", project, "--script", script)
        self.assertEqual(count(), 2)

    def test_small_ones_are_left_out_and_the_largest_kept(self):
        everything = self.label("--threshold", 176)
        some = self.label("--threshold", 176, "--min-voxels", 10)
        self.assertEqual(some["components"], everything["components"])
        self.assertEqual(some["kept"], sum(item["voxels"] >= 10 for item in everything["largest"]))
        one = self.label("--threshold", 176, "--largest", 1, "-o", self.folder / "a.mask")
        self.assertEqual((one["kept"], one["kept_voxels"]), (1, everything["largest_voxels"]))
        self.assertEqual((self.folder / "a.mask").read_bytes().count(1), everything["largest_voxels"])

    def test_what_is_there_stays_where_labels_cannot_be_written(self):
        project = self.folder / "project"
        self.check("import", self.header, project)
        before = (project / ".zattrs").read_bytes()
        self.check_refused("label", self.header, "--threshold", 1, "-o", project / "x.mask" / "y.mask")
        (self.folder / "scan.zarr").symlink_to(project)
        self.check_refused("label", self.header, "--threshold", 1, "-o", self.folder / "scan.zarr",
                           says=["is not a label image"])
        self.assertEqual((project / ".zattrs").read_bytes(), before)
        self.check_refused("label", self.header, "--threshold", 176, "-o", self.folder / "a.mask",
                           says=["uint16", "255"])
        self.assertEqual([path.name for path in self.folder.iterdir() if ".part" in path.name or ".shvr" in path.name], [])

    def test_wrong_usage(self):
        for arguments in [["--threshold", "nan"], ["--threshold", "x"], ["--threshold", 1, "--connectivity", 18],
                          ["--threshold", 1, "-o", "a.png"], ["--threshold", 1, "--min-voxels", 0], []]:
            with self.subTest(arguments=arguments):
                self.check_refused("label", self.header, *arguments, status=2)


if __name__ == "__main__":
    unittest.main()
