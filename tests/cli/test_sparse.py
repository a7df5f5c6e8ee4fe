"""Sparse and huge volumes: work costs what is stored, sizes decide before voxels are read, and estimates are stated."""
import json
import os
import re
import shutil
import unittest

from harness import IS_SLOW, CliTest
from test_large import read_png

HUGE = 2 ** 20
CHUNK = 32


def write_sparse(folder, side, chunks, levels=1, separator="/", fill=0, value=200):
    """An OME-Zarr image of `side`^3 voxels of uint8 in which only `chunks` (x, y, z of level 0) are stored."""
    folder.mkdir()
    (folder / ".zgroup").write_text('{"zarr_format": 2}')
    (folder / ".zattrs").write_text(json.dumps({"multiscales": [{
        "version": "0.4", "axes": [{"name": axis, "type": "space", "unit": "micrometer"} for axis in "zyx"],
        "datasets": [{"path": str(level), "coordinateTransformations": [
            {"type": "scale", "scale": [2.0 ** level] * 3},
            {"type": "translation", "translation": [0.5 * (2 ** level - 1)] * 3}]} for level in range(levels)]}]}))
    for level in range(levels):
        array = folder / str(level)
        array.mkdir()
        (array / ".zarray").write_text(json.dumps({
            "zarr_format": 2, "shape": [-(-side // 2 ** level)] * 3, "chunks": [CHUNK] * 3, "dtype": "|u1",
            "compressor": None, "fill_value": fill, "order": "C", "filters": None, "dimension_separator": separator}))
        for chunk in chunks:
            file = array / separator.join(str(place >> level) for place in chunk[::-1])
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(bytes([value]) * CHUNK ** 3)
    return folder


class Sparse(CliTest):
    def picture_of(self, volume, target, height):
        """Red where something is, seen from the front."""
        session = self.write_json("session.json", {
            "shvr_session": 1, "volume": {"path": str(volume)},
            "transfer_function": {"points": [{"intensity": 60, "color": "#ff0000", "opacity": 0.0},
                                             {"intensity": 100, "color": "#ff0000", "opacity": 1.0},
                                             {"intensity": 255, "color": "#ff0000", "opacity": 1.0}]},
            "cameras": {"here": {"projection": "orthographic", "eye": [target[0], -100, target[2]], "target": target,
                                 "up": [0, 0, 1], "height": height}},
            "light": {"shaded": False}, "render": {"size": [32, 32], "background": "#ffffff"}})
        picture = self.folder / "a.png"
        result = self.check_json("render", session, "-o", picture, "--camera", "here", "--budget-device", "128")
        self.assertIs(result["complete"], True)
        return read_png(picture)

    # Kind (annotation files): label images of 2^20 voxels a side, compared.
    def test_masks_of_any_size_are_compared_at_the_cost_of_what_they_store(self):
        truth = write_sparse(self.folder / "truth.zarr", HUGE, [(1, 1, 1), (20000, 3, 4)], value=2)
        mask = write_sparse(self.folder / "mask.zarr", HUGE, [(1, 1, 1), (9, 3, 4), (HUGE // CHUNK - 1, 0, 0)], value=2)
        self.assertEqual(self.check_json("evaluate", "--truth-mask", truth, "--mask", mask)["dice"], 0.4)

    def test_one_chunk_of_any_side_is_described_labelled_and_drawn(self):
        for side, levels, separator in ((10 ** 4, 1, "."), (10 ** 6, 1, "/"), (HUGE, 3, "/"), (HUGE, 1, ".")):
            with self.subTest(side=side, levels=levels, separator=separator):
                chunk = (side // 2 // CHUNK, 1, side // CHUNK - 2)
                volume = write_sparse(self.folder / f"{side}-{levels}{separator == '/'}", side, [chunk], levels,
                                      separator)
                info = self.check_json("info", volume)
                self.assertEqual((info["statistics"], info["min"], info["max"]), ("exact", 0, 200))
                self.assertEqual((info["voxels"], info["bytes"]), (side ** 3, side ** 3))
                self.assertEqual(info["mean"], 200 * CHUNK ** 3 / side ** 3)
                self.assertEqual(info["histogram"][255], CHUNK ** 3)
                label = self.check_json("label", volume, "--threshold", "100")
                self.assertEqual((label["components"], label["foreground_voxels"]), (1, CHUNK ** 3))
                self.assertLess(label["peak_bytes"], 16 << 20)
                middle = [(place + 0.5) * CHUNK for place in chunk]
                rows = self.picture_of(volume, middle, 2 * CHUNK)
                self.assertEqual(rows[16][16], (255, 0, 0))
                self.assertEqual(rows[2][2], (255, 255, 255))
                (self.folder / "session.json").unlink()

    def test_the_whole_of_2_to_the_20_a_side_is_drawn_from_coarse_levels_made_of_what_is_stored(self):
        volume = write_sparse(self.folder / "sparse", HUGE, [(0, 0, 0), (HUGE // CHUNK - 1,) * 3])
        middle = HUGE / 2
        rows = self.picture_of(volume, [middle] * 3, HUGE)
        self.assertEqual(len(rows), 32)

    def test_labels_of_many_chunks_are_written_where_their_number_allows(self):
        # A diagonal of touching corners: one component over corners, as many as chunks over faces.
        chunks = [(i, i, i) for i in range(0, 8)]
        volume = write_sparse(self.folder / "sparse", 4096, chunks)
        self.assertEqual(self.check_json("label", volume, "--threshold", "1")["components"], 8)
        self.assertEqual(self.check_json("label", volume, "--threshold", "1", "--connectivity", "26")["components"], 1)

    def test_labels_of_one_chunk_of_2_to_the_20_a_side_are_written(self):
        volume = write_sparse(self.folder / "sparse", HUGE, [(5, 6, 7)])
        labels = self.folder / "labels.zarr"
        result = self.check_json("label", volume, "--threshold", "100", "-o", labels)
        self.assertEqual((result["components"], result["kept_voxels"], result["type"]), (1, CHUNK ** 3, "uint8"))
        info = self.check_json("info", labels)
        self.assertEqual((info["size"], info["min"], info["max"]), ([HUGE] * 3, 0, 1))
        self.assertEqual(info["histogram"][255], CHUNK ** 3)
        self.assertLess(sum(1 for path in labels.rglob("*") if path.is_file()), 64)
        again = self.check_json("label", labels, "--threshold", "1")
        self.assertEqual((again["components"], again["foreground_voxels"]), (1, CHUNK ** 3))

    def test_forms_that_hold_every_voxel_are_refused_before_any_work(self):
        volume = write_sparse(self.folder / "sparse", HUGE, [(5, 6, 7)])
        for name in ("labels.nrrd", "labels.tif", "labels.mask"):
            self.check_refused("label", volume, "--threshold", "100", "-o", self.folder / name,
                               says=["or .zarr, which holds what is stored alone", "leave out --output"])
            self.assertFalse((self.folder / name).exists())

    def test_all_voxels_of_2_to_the_20_a_side_are_refused_before_any_work_and_a_part_of_them_is_imported(self):
        volume = write_sparse(self.folder / "sparse", HUGE, [(5, 6, 7)])
        for more in ("--reverse",), ("--blur", "1"), ("--downscale", "2"):
            self.check_refused("import", volume, self.folder / "project", *more, "--budget-host", "4096",
                               says=["takes up to", "of memory; expected at most 4096 MiB", "--crop", "--downscale"])
            self.assertEqual([path.name for path in self.folder.iterdir()], ["sparse"])
        part = self.check_json("import", volume, self.folder / "project", "--crop", "128,160,192,224,256,288",
                               "--reverse")
        self.assertEqual(part["size"], [96, 96, 96])
        info = self.check_json("info", self.folder / "project")
        self.assertEqual((info["min"], info["max"], info["histogram"][0]), (0, 200, CHUNK ** 3))

    def test_a_project_of_2_to_the_20_a_side_is_imported_painted_measured_and_drawn(self):
        volume, project = write_sparse(self.folder / "sparse", HUGE, [(HUGE // CHUNK - 2, 6, 7)]), self.folder / "project"
        report = self.check_json("import", volume, project, "--budget-host", "512")
        self.assertEqual((report["size"], report["levels"]), ([HUGE] * 3, 16))
        self.assertEqual(len(report["warnings"]), 1)   # one block of one value might as well be labels
        self.assertIn("looks like a label image", report["warnings"][0])
        self.assertLess(report["bytes"], 1 << 20)
        self.assertLess(report["peak_rss_mib"], 512)
        info = self.check_json("info", project)
        self.assertEqual((info["statistics"], info["min"], info["max"]), ("exact", 0, 200))
        self.assertEqual(info["mean"], 200 * CHUNK ** 3 / HUGE ** 3)
        place = [HUGE - 1.5 * CHUNK, 6.5 * CHUNK, 7.5 * CHUNK]
        script = self.folder / "strokes.jsonl"
        script.write_text("".join(json.dumps(line) + "\n" for line in (
            {"op": "paint", "brush": "fill", "region": "box", "group": 3, "threshold": 100, "radius": 4,
             "path": [place]}, {"op": "save"})))
        painted = self.check_json("annotate", project, "--script", script)["voxels_changed"]
        self.assertGreater(painted, 100)
        exported = self.check_json("export", project, "--metrics", self.folder / "m.csv", "--mask",
                                   self.folder / "mask.zarr")
        self.assertEqual(exported["voxels_by_group"], {"3": painted})
        rows = self.picture_of(project, place, 2 * CHUNK)
        self.assertEqual(rows[16][16], (255, 0, 0))
        self.assertEqual(self.check_json("label", project, "--threshold", "100")["foreground_voxels"], CHUNK ** 3)

    def test_a_volume_with_another_fill_value_keeps_it(self):
        volume, project = write_sparse(self.folder / "sparse", HUGE, [(5, 6, 7)], fill=7), self.folder / "project"
        self.check_json("import", volume, project)
        self.assertEqual(json.loads((project / "3/.zarray").read_text())["fill_value"], 7)
        info = self.check_json("info", project)
        self.assertEqual((info["min"], info["max"]), (7, 200))
        self.assertNotIn("fill_value", " ".join(info["warnings"]))

    def test_an_import_that_would_exceed_its_budget_is_refused_and_one_that_fits_keeps_to_it(self):
        volume = write_sparse(self.folder / "sparse", 512, [(x, y, z) for x in range(16) for y in range(16)
                                                            for z in range(0, 16, 2)], value=9)
        project = self.folder / "project"
        self.check_refused("import", volume, project, "--budget-host", "64", "--threads", "2",
                           says=["importing 512 x 512 x 512 voxels of uint8 takes up to", "expected at most 64 MiB",
                                 "--budget-host"])
        self.assertFalse(project.exists())
        report = self.check_json("import", volume, project, "--budget-host", "512", "--threads", "2")
        self.assertLess(report["peak_rss_mib"], 512)

    def test_no_import_takes_more_memory_than_its_estimate(self):
        """With the estimate --budget-host is compared; the message states it."""
        spread = [(x * 37 % 128, x * 53 % 128, x * 91 % 128) for x in range(64)]
        sources = {"sparse": (write_sparse(self.folder / "sparse", 4096, spread), [])}
        for name, kind, size, voxel, options in (("fog", "fog", 160, "float32", []),
                                                 ("blurred", "fog", 128, "uint16", ["--blur", "1.5"]),
                                                 ("dense", "speckles", 512, "uint8", [])):
            if name != "dense" or IS_SLOW:
                self.check("phantom", kind, "--size", size, "--type", voxel, "-o", self.folder / name)
                sources[name] = (self.folder / name / f"{kind}.nhdr", options)
        for name, (volume, options) in sources.items():
            for threads in (1, 2, 8) if IS_SLOW else (2,):
                with self.subTest(source=name, threads=threads):
                    project = self.folder / f"{name}{threads}"
                    command = ["import", volume, project, "--threads", threads, *options]
                    said = self.check_refused(*command, "--budget-host", "1", says=["takes up to "])
                    estimate = int(re.search(r"takes up to ([0-9]+) MiB", said)[1])
                    peak = self.check_json(*command, "--quiet")["peak_rss_mib"]
                    self.assertLess(peak, estimate)
                    self.assertGreater(peak, 10)

    # Kind (Sparse volumes): one chunk as large as the volume
    def test_a_chunk_as_large_as_the_volume_is_refused_by_its_size(self):
        volume = write_sparse(self.folder / "sparse", HUGE, [(0, 0, 0)])
        array = volume / "0/.zarray"
        array.write_text(json.dumps({**json.loads(array.read_text()), "chunks": [HUGE] * 3}))
        self.check_refused("import", volume, self.folder / "project", says=["chunks", "256 MiB"])
        self.assertFalse((self.folder / "project").exists())

    # Kind (Sparse volumes): names of chunks outside the volume
    def test_chunks_outside_the_volume_are_told_and_left_out(self):
        volume = write_sparse(self.folder / "sparse", HUGE, [(5, 6, 7)])
        stray = volume / "0/7/6" / str(HUGE)
        stray.write_bytes(bytes(CHUNK ** 3))
        report = self.check_json("import", volume, self.folder / "project")
        self.assertIn("lies outside the array", " ".join(report["warnings"]))
        self.assertEqual(self.check_json("info", self.folder / "project")["histogram"][255], CHUNK ** 3)

    # Kind (Sparse volumes): shards whose index is damaged
    def test_a_damaged_index_of_a_shard_ends_the_import_in_a_sentence(self):
        volume, shards = write_sparse(self.folder / "sparse", HUGE, [(5, 6, 7)]), self.folder / "shards"
        first = self.check_json("import", volume, shards, "--ome-zarr", "0.5", "--shards")
        shutil.rmtree(shards / "shvr")  # an image of another program
        again = self.check_json("import", shards, self.folder / "project")
        self.assertEqual(self.check_json("info", self.folder / "project")["histogram"][255], CHUNK ** 3)
        self.assertEqual(again["bricks_stored"], first["bricks_stored"])
        shard = next(path for path in (shards / "0/c").rglob("*") if path.is_file())
        content = bytearray(shard.read_bytes())
        content[-9] ^= 1
        shard.write_bytes(content)
        self.check_refused("import", shards, self.folder / "damaged", says=[str(shard)])
        self.assertFalse((self.folder / "damaged").exists())

    # Kind (Sparse volumes): a stored chunk that is too short
    def test_a_damaged_chunk_ends_the_import_in_a_sentence(self):
        volume = write_sparse(self.folder / "sparse", HUGE, [(5, 6, 7)])
        (volume / "0/7/6/5").write_bytes(bytes(100))
        self.check_refused("import", volume, self.folder / "project", says=["0/7/6/5"])
        self.assertFalse((self.folder / "project").exists())

    def test_a_background_at_or_above_the_threshold_is_refused_in_a_sentence(self):
        volume = write_sparse(self.folder / "sparse", HUGE, [(1, 1, 1)], fill=7)
        self.check_refused("label", volume, "--threshold", "7",
                           says=["holds 7 wherever nothing is stored, and the threshold is 7; expected one above"])
        self.assertEqual(self.check_json("label", volume, "--threshold", "8")["components"], 1)

    def test_a_background_at_or_above_the_threshold_is_labelled_where_it_can_be(self):
        volume = write_sparse(self.folder / "sparse", 128, [(1, 1, 1)], fill=7, value=3)
        label = self.check_json("label", volume, "--threshold", "7")
        self.assertEqual((label["components"], label["foreground_voxels"]), (1, 128 ** 3 - CHUNK ** 3))


class Contradictions(CliTest):
    def change(self, array, **values):
        path = array / ".zarray"
        path.write_text(json.dumps({**json.loads(path.read_text()), **values}))

    def warnings(self, volume):
        warnings = self.check_json("info", volume)["warnings"]
        return " | ".join(warning for warning in warnings if not warning.startswith("no transfer function given"))

    def test_chunks_that_the_metadata_cannot_mean_are_told(self):
        for key, value, said in (("dimension_separator", ".", "named like a chunk"),
                                 ("shape", [64, 64, 64], "named like a chunk"),
                                 ("chunks", [64, 64, 64], "named like a chunk")):
            with self.subTest(key=key):
                volume = write_sparse(self.folder / key, 128, [(1, 1, 3)])
                self.assertNotIn("chunk", self.warnings(volume))
                self.change(volume / "0", **{key: value})
                self.assertIn(said, self.warnings(volume))

    def test_a_project_whose_arrays_contradict_each_other_is_told(self):
        source = write_sparse(self.folder / "source", 128, [(0, 0, 0), (1, 1, 1)])
        for level, key, value in (("0", "chunks", [32, 32, 32]), ("1", "chunks", [32, 32, 32]), ("0", "dtype", "|i1"),
                                  ("1", "dtype", "|i1"), ("0", "shape", [127, 128, 128]), ("1", "shape", [63, 64, 64]),
                                  ("0", "fill_value", 9), ("1", "fill_value", 9), ("0", "dimension_separator", "."),
                                  ("2", "shape", [31, 32, 32])):
            with self.subTest(level=level, key=key):
                project = self.folder / f"{level}-{key}"
                self.check("import", source, project, "--quiet")
                self.assertEqual(self.warnings(project), "")
                self.change(project / level, **{key: value})
                said = self.check("info", project, "--json").stdout
                self.assertIn(f"/{level}/.zarray", said)
                self.assertIn(f"key {key} is", said)


class Huge(CliTest):
    """Files of bare voxels, most of them holes."""

    def write_raw(self, gigavoxels, marks=()):
        raw = self.folder / "huge.raw"
        depth = gigavoxels * 1024
        with open(raw, "wb") as file:
            os.truncate(raw, depth * 1024 * 1024)
            for place, value in marks:
                file.seek(place)
                file.write(bytes([value]))
        return ["--raw", f"1024x1024x{depth}:uint8"], raw

    def test_statistics_are_a_stated_sample_or_exact(self):
        layout, raw = self.write_raw(2, [(2 ** 31 - 1, 250)])
        sample = self.check_json("info", raw, *layout)
        self.assertEqual(sample["statistics"], f"sample of {2 ** 26} voxels")
        self.assertEqual((sample["min"], sample["max"]), (0, 0))
        self.assertIn("estimated from a sample", " ".join(sample["warnings"]))
        self.assertIn(f"(sample of {2 ** 26} voxels)", self.check("info", raw, *layout).stdout)
        exact = self.check_json("info", raw, *layout, "--exact")
        self.assertEqual((exact["statistics"], exact["max"]), ("exact", 250))
        self.assertNotIn("sample", " ".join(exact["warnings"]))

    def test_20_gigavoxels_are_described_at_once_and_refused_by_their_size(self):
        layout, raw = self.write_raw(20)
        self.assertEqual(self.check_json("info", raw, *layout)["voxels"], 20 * 2 ** 30)
        self.check_refused("render", raw, *layout, "-o", self.folder / "a.png", "--budget-device", "256", "--budget-host",
                           "256", says=["huge.raw: is drawn in pieces, and making its coarser levels takes",
                                        "or make a project"])


if __name__ == "__main__":
    unittest.main()
