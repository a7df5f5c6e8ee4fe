"""shvr bench: errors against the reference renderer, exact work, files, and what counts as a regression."""
import copy
import csv
import json
import struct
import unittest
import xml.etree.ElementTree

from harness import CliTest

RUN_KEYS = ["name", "family", "settings", "error", "min_ms", "median_ms", "p95_ms", "work", "device_bytes", "on_front"]


class Bench(CliTest):
    def bench(self, *arguments, scenes="fog", rounds=2, status=0):
        self.output = self.folder / "bench"
        return self.check_json("bench", "--scenes", scenes, "--quick", "--rounds", rounds, "-o", self.output, *arguments,
                               status=status)

    def runs(self, scene=0):
        scenes = json.loads((self.output / "bench.json").read_text())["scenes"]
        return {run["name"]: run for run in scenes[scene]["runs"]}

    def test_errors_fall_along_the_qualities_and_the_steps(self):
        told = self.bench(scenes="fog,tissue")
        self.assertEqual(told["bench"], str(self.output / "bench.json"))
        for scene in (0, 1):
            runs = self.runs(scene)
            for names in (["draft", "interactive", "good"], ["step 2", "step 1", "step 0.5", "step 0.25"]):
                errors = [runs[name]["error"]["rmse"] for name in names]
                self.assertEqual(errors, sorted(errors, reverse=True), names)
                work = [runs[name]["work"]["samples"] for name in names]
                self.assertEqual(work, sorted(work), names)
            self.assertLess(runs["reference"]["error"]["rmse"], 2e-3)
            self.assertLess(runs["interactive"]["error"]["rmse"], 1e-2)
            for run in runs.values():
                self.assert_keys(run, RUN_KEYS)
                self.assertLessEqual(run["min_ms"], run["median_ms"])
                self.assertLessEqual(run["median_ms"], run["p95_ms"])
            self.assertEqual(runs["skipping off"]["error"], runs["step 0.5"]["error"])
        # On the front: no run of the scene is better in both.
        for row in told["pareto"]:
            runs = self.runs(["fog", "tissue"].index(row["scene"]))
            better = [run for run in runs.values()
                      if run["median_ms"] < row["median_ms"] and run["error"]["rmse"] < row["rmse"]]
            self.assertEqual(better, [])

    def test_what_is_painted_occluded_paged_or_opaque_is_drawn_as_the_reference_draws_it(self):
        # A step of a quarter voxel; edges of opaque things differ by the share of a pixel's ray that a step is.
        for scene, limit in [("painted", 0.01), ("surfaces", 0.01), ("anisotropic", 0.01), ("uint16", 0.01),
                             ("occluded", 0.03), ("paged", 0.01)]:
            with self.subTest(scene=scene):
                self.bench(scenes=scene, rounds=1)
                runs = self.runs()
                self.assertLess(runs["step 0.25"]["error"]["rmse"], limit)
                self.assertEqual("occlusion rays 64" in runs, scene == "occluded")
                if scene == "paged":
                    self.assertEqual(runs["budget 16 MiB"]["error"], runs["budget 48 MiB"]["error"])

    def test_files(self):
        told = self.bench()
        names = sorted(path.split("/")[-1] for path in told["written"])
        self.assertEqual(names, ["bench.csv", "bench.json", "equal_error.csv", "equal_time.csv", "front.csv",
                                 "pareto-fog.png", "pareto-fog.svg", "pareto.png", "pareto.svg", "report.html"])
        with open(self.output / "bench.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["run"] for row in rows], list(self.runs()))
        self.assertEqual(int(rows[0]["samples"]), self.runs()["draft"]["work"]["samples"])
        for name in ("pareto.svg", "pareto-fog.svg"):
            tree = xml.etree.ElementTree.parse(self.output / name).getroot()
            texts = {text.text for text in tree.iter("{http://www.w3.org/2000/svg}text")}
            self.assertIn("RMSE in linear light", texts)
            self.assertIn("samples of a picture" if name == "pareto.svg" else "median time of a picture, ms", texts)
            # The legend names a front where one is drawn; no mark lies on the frame, which is at 74.
            self.assertEqual("front" in texts, name != "pareto.svg")
            marks = [float(mark.get("cx")) for mark in tree.iter("{http://www.w3.org/2000/svg}circle")]
            self.assertGreater(min(marks), 80.0)
        self.assertTrue({"draft", "interactive", "good", "reference", "step"} <= texts)
        header = (self.output / "pareto-fog.png").read_bytes()[16:24]
        self.assertEqual(struct.unpack(">II", header), (720, 480))
        page = (self.output / "report.html").read_text()
        self.assertNotRegex(page, r'(src|href)="(?!data:)')
        for word in ("Equal error", "Equal time", "reference renderer", "difference, 16 times", "FLIP"):
            self.assertIn(word, page)

    def test_references_are_kept_and_errors_and_work_repeat(self):
        self.bench()
        kept = list(self.output.glob("reference-*.light"))
        self.assertEqual(len(kept), 1)
        before, first = kept[0].stat().st_mtime_ns, self.runs()
        (self.output / "bench.json").rename(self.folder / "a.json")
        self.bench()
        self.assertEqual(kept[0].stat().st_mtime_ns, before)
        for name, run in self.runs().items():
            self.assertEqual((run["error"], run["work"]), (first[name]["error"], first[name]["work"]), name)
        self.check("bench", "--compare", self.folder / "a.json", self.output / "bench.json", "--ignore-time")

    def test_a_volume_of_a_single_brick_is_paged(self):
        session = self.write_session(annotation={})
        self.bench(scenes=str(session), rounds=1)
        unpaged = self.runs()
        text = json.loads(session.read_text())
        text["render"] = {**text.get("render", {}), "paging": "always", "detail": 0}
        self.bench(scenes=str(self.write_json("paged.json", text)), rounds=1)
        self.assertEqual(self.runs()["step 0.5"]["error"], unpaged["step 0.5"]["error"])

    def test_a_session_of_ones_own(self):
        session = self.write_session(annotation={})
        self.bench(scenes=str(session))
        self.assertLess(self.runs()["step 0.25"]["error"]["rmse"], 0.01)
        self.check_refused("bench", "--scenes", "tubs", "-o", self.folder / "x", says=["tubs", "tubes, noisy-surface"])
        rods = self.write_session("rods.json", annotation={},
                                  surfaces=[{"from": [2, 2, 2], "to": [9, 9, 9], "radius": 2}])
        self.check_refused("bench", "--scenes", rods, "-o", self.folder / "x", says=["does not draw rods"])

    def result(self, **keys):
        """A file of one run, as --compare reads it."""
        run = {"name": "step 1", "family": "step", "settings": [], "scale": 1.0,
               "error": {"rmse": 1e-3, "max_abs": 1e-2, "psnr_db": 50.0, "ssim": 1.0, "flip_mean": 0.01, "flip_p99": 0.1},
               "min_ms": 9.0, "median_ms": 10.0, "p95_ms": 11.0, "first_ms": 20.0,
               "work": {"samples": 1000, "bricks_skipped": 50, "passes": 3}, "device_bytes": 1, "on_front": True}
        for key, value in keys.items():
            place = run["error"] if key in run["error"] else run["work"] if key in run["work"] else run
            place[key] = value
        return {"shvr_bench": 1, "device": "d", "driver": "d", "processor": "p", "instructions": "fma", "cores": 2, "load": 0.0, "rounds": 3,
                "size": [4, 3], "scenes": [{"name": "s", "what": "w", "volume": "v", "reference_seconds": 0.0,
                                            "runs": [run]}]}

    def compare(self, status, *more, **keys):
        a = self.write_json("a.json", self.result())
        b = self.write_json("b.json", self.result(**keys))
        result = self.check("bench", "--compare", a, b, "--json", *more, status=status)
        return json.loads(result.stdout)

    def test_what_is_a_regression(self):
        self.assertEqual(self.compare(0), {"changes": [], "regressions": 0})
        # Error: more than 1 %.
        self.assertEqual(self.compare(0, rmse=1.005e-3)["changes"], [])
        self.assertEqual(self.compare(3, rmse=1.02e-3)["changes"][0]["what"], "rmse")
        self.assertEqual(self.compare(0, rmse=0.5e-3)["regressions"], 0)
        # Work: a single sample or pass; what is saved is none.
        self.assertEqual(self.compare(3, samples=1001)["changes"][0]["what"], "samples")
        self.assertEqual(self.compare(3, passes=4)["changes"][0]["what"], "passes")
        self.assertEqual(self.compare(0, samples=999, bricks_skipped=60)["regressions"], 0)
        other = {**self.result(samples=1001), "instructions": "sse4_1"}
        self.check("bench", "--compare", self.folder / "a.json", self.write_json("c.json", other))
        # Time: beyond the noise of both, hypot(1, 1) = 1.41 ms.
        self.assertEqual(self.compare(0, median_ms=11.3)["changes"], [])
        self.assertEqual(self.compare(3, median_ms=11.5)["changes"][0]["what"], "median_ms")
        self.assertEqual(self.compare(0, "--ignore-time", median_ms=11.5)["changes"], [])
        self.assertEqual(self.compare(0, median_ms=5.0)["regressions"], 0)

    def test_files_that_cannot_be_compared(self):
        a = self.write_json("a.json", self.result())
        other = copy.deepcopy(self.result())
        other["scenes"][0]["name"] = "t"
        self.check_refused("bench", "--compare", a, self.write_json("b.json", other), says=["no run of a scene in common"])
        self.check_refused("bench", "--compare", a, self.write_json("c.json", {}), says=["is no bench.json"])
        self.check_refused("bench", "--compare", a, self.write_json("d.json", {"shvr_bench": 1}),
                           says=["is not what shvr bench writes"])
        self.check_refused("bench", status=2, says=["--output is missing"])


if __name__ == "__main__":
    unittest.main()
