"""shvr bench: errors against the reference renderer, exact work, files, and what counts as a regression."""
import copy
import csv
import json
import os
import shutil
import struct
import subprocess
import sys
import unittest
import xml.etree.ElementTree
from pathlib import Path

from harness import ENVIRONMENT, SHVR, CliTest

ROOT = Path(__file__).resolve().parents[3]
HAS_VTK = bool(shutil.which("xvfb-run") or os.environ.get("DISPLAY")) and subprocess.run(
    ["/usr/bin/python3", "-c", "import vtkmodules"], capture_output=True, check=False).returncode == 0
# Answers as tools/peers/vtk_raycast.py does: a black picture in so many milliseconds as its step is.
STAND_IN = f"""#!{sys.executable}
import json, sys
from array import array
scene = json.load(open(sys.argv[2]))
width, height = scene["render"]["size"]
print("something else")
print(json.dumps({{"vtk": "0.0"}}), flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    print(asked["step"], file=open(sys.argv[0] + ".log", "a"))
    if asked["output"]:
        open(asked["output"], "wb").write(f"PF\\n{{width}} {{height}}\\n-1.0\\n".encode() + array("f", [0] * 3 * width * height).tobytes())
    print(json.dumps({{"ms": 1000 * asked["step"]}}), flush=True)
"""
RUN_KEYS = ["name", "family", "settings", "error", "min_ms", "median_ms", "median_low_ms", "median_high_ms", "p95_ms", "work",
            "device_bytes", "redraws", "on_front"]


class Bench(CliTest):
    def bench(self, *arguments, scenes="fog", rounds=2, status=0):
        """Without VTK, unless the arguments name it."""
        self.output = self.folder / "bench"
        if "--peer" not in arguments:
            arguments = ("--peer", "none", *arguments)
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
                self.assertLessEqual(run["min_ms"], run["median_low_ms"])
                self.assertLessEqual(run["median_low_ms"], run["median_ms"])
                self.assertLessEqual(run["median_ms"], run["median_high_ms"])
                self.assertLessEqual(run["error"]["fraction_over_4"], run["error"]["fraction_over_1"])
            if scene == 1:  # in fog no pixel is off by a level
                self.assertGreater(runs["draft"]["error"]["fraction_over_1"],
                                   runs["reference"]["error"]["fraction_over_1"])
            self.assertEqual(runs["skipping off"]["error"], runs["step 0.5"]["error"])
            # The run before has another table: the picture that makes this one's is not the one that is timed.
            self.assertEqual(runs["pre-integrated 1"]["redraws"], 2)
            self.assertLessEqual({run["redraws"] for run in runs.values()}, {0, 1, 2})
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
                    # All voxels, then at least two and half a voxel a pixel: coarser levels, less work, more error.
                    all_voxels, two, half = runs["step 0.5"], runs["detail 2"], runs["detail 0.5"]
                    self.assertLessEqual(all_voxels["error"]["rmse"], two["error"]["rmse"])
                    self.assertLess(two["error"]["rmse"], half["error"]["rmse"])
                    self.assertGreater(two["work"]["samples"], half["work"]["samples"])
                    # A worse quality is not drawn of finer bricks.
                    bricks = [runs[name]["work"]["bricks_visited"] for name in ("draft", "interactive", "good")]
                    self.assertEqual(bricks, sorted(bricks))
                    self.assertEqual(runs["budget 16 MiB"]["error"], runs["budget 48 MiB"]["error"])

    def test_files(self):
        told = self.bench()
        names = sorted(path.split("/")[-1] for path in told["written"])
        self.assertEqual(names, ["bench.csv", "bench.json", "equal_error.csv", "equal_peer.csv", "equal_time.csv", "front.csv",
                                 "insets.png", "pareto-fog.png", "pareto-fog.svg", "pareto.png", "pareto.svg", "report.html"])
        with open(self.output / "bench.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["run"] for row in rows], list(self.runs()))
        self.assertEqual(int(rows[0]["samples"]), self.runs()["draft"]["work"]["samples"])
        for name in ("pareto.svg", "pareto-fog.svg"):
            tree = xml.etree.ElementTree.parse(self.output / name).getroot()
            texts = {text.text for text in tree.iter("{http://www.w3.org/2000/svg}text")}
            self.assertIn("RMSE in linear light", texts)
            self.assertIn("texels read for a picture" if name == "pareto.svg" else "median time of a picture, ms", texts)
            # The legend names a front where one is drawn; no mark lies on the frame, which is at 74.
            self.assertEqual("front" in texts, name != "pareto.svg")
            marks = [float(mark.get("cx")) for mark in tree.iter("{http://www.w3.org/2000/svg}circle")]
            self.assertGreater(min(marks), 80.0)
        self.assertTrue({"draft", "interactive", "good", "reference", "step"} <= texts)
        header = (self.output / "pareto-fog.png").read_bytes()[16:24]
        self.assertEqual(struct.unpack(">II", header), (720, 480))
        page = (self.output / "report.html").read_text()
        self.assertNotRegex(page, r'(src|href)="(?!data:)')
        for word in ("Equal error", "Equal time", "reference renderer", "difference, 16 times", "FLIP",
                     "errs most", "draft: RMSE here "):
            self.assertIn(word, page)
        # A row for the scene; the truth and the four qualities in it.
        width, height = struct.unpack(">II", (self.output / "insets.png").read_bytes()[16:24])
        self.assertEqual(width, 8 + 5 * (176 + 8))
        self.assertEqual(height, 8 + 132 + 34 + 8)

    def test_who_measured_is_in_the_file(self):
        subprocess.run([SHVR, "bench", "--scenes", "fog", "--quick", "--rounds", "1", "--peer", "none", "--mixed", "4",
                        "-o", self.folder / "bench"], check=True, capture_output=True, timeout=300,
                       env={**ENVIRONMENT, "LP_NUM_THREADS": "1", "SECRET": "not this"})
        found = json.loads((self.folder / "bench/bench.json").read_text())
        self.assertEqual(found["environment"]["LP_NUM_THREADS"], "1")
        self.assertNotIn("SECRET", found["environment"])
        self.assertRegex(found["version"], r"^\d+\.\d+\.\d+$")
        tree = Path(SHVR).resolve().parents[2]
        head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=tree, capture_output=True, text=True, check=False)
        expected = head.stdout.strip() if head.returncode == 0 and (tree / ".git").is_dir() else None
        self.assertEqual(found["commit"], expected)
        # All knobs at once, each in another part of its range.
        mixed = [run for run in found["scenes"][0]["runs"] if run["family"] == "mixed"]
        self.assertEqual([run["name"] for run in mixed], [f"mixed {i}" for i in (1, 2, 3, 4)])
        steps = sorted(float(run["settings"][0].split("=")[1]) for run in mixed)
        for step, expected in zip(steps, (0.105, 0.297, 0.841, 2.378)):
            self.assertAlmostEqual(step, expected, delta=0.002)
        self.assertEqual(sorted(run["scale"] for run in mixed), [0.43, 0.59, 0.76, 0.92])
        self.assertEqual(sum("render.preintegration=true" in run["settings"] for run in mixed), 2)

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

    def stand_in(self, text=STAND_IN):
        path = self.folder / "peer.py"
        path.write_text(text)
        path.chmod(0o755)
        return path

    def notes(self):
        return json.loads((self.output / "bench.json").read_text())["scenes"][0]["notes"]

    def test_another_program_is_measured_in_the_same_rounds_and_by_the_same_reference(self):
        self.bench("--peer", self.stand_in(), scenes="tissue-matt", rounds=3)
        # Each twice to begin with, then to and fro with all others.
        asked = (self.folder / "peer.py.log").read_text().split()
        there = ["2.0", "1.0", "0.5", "0.25"]
        self.assertEqual(asked, [step for step in there for _ in range(2)] + there + there[::-1] + there)
        runs = self.runs()
        self.assertEqual([runs[f"VTK step {step}"]["median_ms"] for step in ("2", "1", "0.5", "0.25")],
                         [2000, 1000, 500, 250])
        black = runs["VTK step 1"]["error"]["rmse"]  # that of a black picture
        self.assertGreater(black, 0.1)
        with open(self.output / "equal_peer.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["peer"] for row in rows], ["VTK step 2", "VTK step 1", "VTK step 0.5", "VTK step 0.25"])
        own = [run for run in runs.values() if not run["family"].startswith("VTK")]
        fastest = min((run for run in own if run["error"]["rmse"] <= black), key=lambda run: run["median_ms"])
        for row in rows:
            self.assertEqual(row["run"], fastest["name"])
            self.assertAlmostEqual(float(row["time_ratio"]) * float(row["peer_ms"]), fastest["median_ms"], places=6)
            self.assertEqual(float(row["same_step_rmse"]), runs[row["peer"].removeprefix("VTK ")]["error"]["rmse"])
        # The front that is kept is SHVR's own, whether VTK is there or not.
        self.assertNotIn("VTK", (self.output / "front.csv").read_text())
        page = (self.output / "report.html").read_text()
        for word in ("Time at equal error", "VTK step 0.5", ">VTK</text>"):
            self.assertIn(word, page)
        self.check("bench", "--compare", self.output / "bench.json", self.output / "bench.json")

    def test_where_another_program_is_not_there_or_draws_otherwise_a_sentence_says_so(self):
        for peer, says in [("none", "VTK is not measured beside"), (self.folder / "gone.py", "cannot be started"),
                           (self.stand_in("#!/bin/sh\necho 'no such module' >&2; exit 1\n"), "no such module")]:
            self.bench("--peer", peer, scenes="fog", rounds=1)
            self.assertEqual(len(self.notes()), 1)
            self.assertIn(says, self.notes()[0])
            self.assertIn("not measured beside", (self.output / "report.html").read_text())
            self.assertNotIn("VTK step 1", self.runs())
        peer = self.stand_in()
        for scene, says in [("tissue", "gradient_fade"), ("painted", "painted"), ("surfaces", "surfaces"),
                            ("occluded", "gradient_fade"), ("paged", "gradient_fade")]:
            self.bench("--peer", peer, scenes=scene, rounds=1)
            self.assertIn(says, self.notes()[0])
            self.assertNotIn("VTK step 1", self.runs())

    @unittest.skipUnless(HAS_VTK, "python3-vtk9 and xvfb are not installed")
    def test_vtk_draws_the_same_picture(self):
        # Near enough that nothing but its own rounding, steps and normals is between them: no shift, no other border.
        for scene, limit in [("fog", 0.006), ("tissue-matt", 0.02), ("tubes-matt", 0.03)]:
            self.bench("--peer", ROOT / "tools/peers/vtk_raycast.py", scenes=scene, rounds=1)
            self.assertEqual(self.notes(), [])
            runs = self.runs()
            self.assertLess(runs["VTK step 0.25"]["error"]["rmse"], limit)
            self.assertLess(runs["VTK step 0.25"]["error"]["rmse"], runs["VTK step 2"]["error"]["rmse"])

    def test_an_example_that_is_not_there_is_said_and_one_that_is_is_drawn(self):
        told = self.check_refused("bench", "--scenes", "stent", "--examples", self.folder, "-o", self.folder / "x",
                                  says=["stent/shvr/session.json", "tools/fetch_example stent"])
        self.assertNotIn("neither", told)
        # As tools/fetch_example leaves it, of a small volume.
        place = self.folder / "stent" / "shvr"
        place.mkdir(parents=True)
        shutil.copy(ROOT / "assets/examples/stent.session.json", place / "session.json")
        header = "NRRD0004\ntype: short\ndimension: 3\nsizes: 20 20 20\nspacings: 1 1 1\nencoding: raw\n" \
                 "endian: little\ndata file: stent.raw\n"
        (self.folder / "stent/stent.nhdr").write_text(header)
        (self.folder / "stent/stent.raw").write_bytes(b"".join(
            struct.pack("<h", min(900, 20 * abs(x - 10) * abs(y - 10) + 9 * z))
            for z in range(20) for y in range(20) for x in range(20)))
        self.bench("--peer", self.stand_in(), "--examples", self.folder, scenes="stent,stent-matt", rounds=1)
        self.assertLess(self.runs()["step 0.25"]["error"]["rmse"], 0.02)
        self.assertIn("gradient_fade", self.notes()[0])
        self.assertIn("VTK step 1", self.runs(1))
        self.assertEqual(self.runs()["step 0.5"]["work"]["rays"] > 0, True)

    def test_all_scenes_and_sweeps_are_measured_and_scans_that_are_not_there_are_said(self):
        self.output = self.folder / "all"
        result = self.check("bench", "--quick", "--side", 16, "--size", "8,8", "--rounds", 1, "--peer", "none",
                            "--examples", self.folder, "-o", self.output, "--json")
        told, kept = json.loads(result.stdout), json.loads((self.output / "bench.json").read_text())
        self.assertEqual(told["left_out"], kept["left_out"])
        self.assertEqual(len(told["left_out"]), 2)
        page = (self.output / "report.html").read_text()
        for name, sentence in zip(("stent", "cranium"), told["left_out"]):
            self.assertIn(f"tools/fetch_example {name}", sentence)
            self.assertIn(sentence, result.stderr)
            self.assertIn(sentence, page)
        names = [scene["name"] for scene in kept["scenes"]]
        self.assertEqual(names, ["tubes", "noisy-surface", "tissue", "fog", "peaks", "uint16", "anisotropic", "paged",
                                 "painted", "occluded", "surfaces", "tubes-matt", "noisy-surface-matt", "tissue-matt"])
        for sweep in ("blur", "labelling", "proxy"):
            self.assertIn(f"<h2>{sweep}</h2>", page)

    def test_sweeps_beside_pictures(self):
        self.output = self.folder / "sweeps"
        told = self.check_json("bench", "--quick", "--sweeps", "blur,labelling", "-o", self.output)
        names = [Path(path).name for path in told["written"]]
        for name in ("sweep-blur.csv", "sweep-blur.svg", "sweep-labelling.csv", "sweep-labelling.svg"):
            self.assertIn(name, names)

        def rows(name):
            with open(self.output / f"sweep-{name}.csv", encoding="utf-8") as file:
                return list(csv.DictReader(file))
        blur = {(row["series"], row["setting"]): float(row["error"]) for row in rows("blur")}
        # Rounding to a level: 0.289 of it. Of floats, what lies beyond 4 sigma.
        for kind, levels in (("uint8", 255), ("uint16", 65535)):
            self.assertAlmostEqual(blur[kind, "sigma 2"] * levels, 12 ** -0.5, delta=0.02)
        self.assertTrue(0 < blur["float32", "sigma 2"] < 1e-4, blur)
        labelling = rows("labelling")
        self.assertEqual({row["series"] for row in labelling}, {"over faces", "over corners"})
        self.assertEqual([float(row["error"]) for row in labelling], [0.0] * 12)
        self.assertGreater(min(float(row["ns_per_voxel"]) for row in labelling), 0.0)
        page = (self.output / "report.html").read_text()
        for word in ("<h2>blur</h2>", "<h2>labelling</h2>", "over corners", "sigma 0.5"):
            self.assertIn(word, page)

    def test_the_sweep_of_the_proxy_is_in_the_report(self):
        self.output = self.folder / "sweeps"
        self.check_json("bench", "--quick", "--sweeps", "proxy", "-o", self.output)
        page = (self.output / "report.html").read_text()
        for word in ("<h2>proxy</h2>", "microseconds a proxy", "even points"):
            self.assertIn(word, page)
        self.assertIn("exact,6,0,", (self.output / "sweep-proxy.csv").read_text())

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
        return {"shvr_bench": 1, "device": "d", "driver": "d", "processor": "p", "instructions": "fma", "cores": 2, "load": 0.0, "rounds": 20,
                "size": [4, 3], "scenes": [{"name": "s", "what": "w", "volume": "v", "reference_seconds": 0.0,
                                            "runs": [run]}]}

    def compare(self, status, *more, **keys):
        a = self.write_json("a.json", self.result())
        b = self.write_json("b.json", self.result(**keys))
        result = self.check("bench", "--compare", a, b, "--json", *more, status=status)
        return json.loads(result.stdout)

    def test_what_is_a_regression(self):
        self.assertEqual(self.compare(0), {"changes": [], "regressions": 0, "beside": []})
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

    def compare_times(self, status, rounds=20, yardsticks=(None, None), median_ms=11.5):
        a, b = self.result(), self.result(median_ms=median_ms)
        for result, yardstick in zip((a, b), yardsticks):
            result["rounds"] = rounds
            if yardstick:
                result["scenes"][0]["yardstick"] = {"min_ms": 0.99 * yardstick, "median_ms": yardstick,
                                                    "p95_ms": 1.01 * yardstick}
        result = self.check("bench", "--compare", self.write_json("a.json", a), self.write_json("b.json", b), "--json",
                            status=status)
        return json.loads(result.stdout)

    def test_few_rounds_tell_less_and_two_tell_no_time_at_all(self):
        self.compare_times(3)
        self.assertEqual(self.compare_times(0, rounds=5)["changes"], [])
        few = self.compare_times(0, rounds=2, median_ms=100.0)
        self.assertEqual((few["changes"], len(few["beside"])), ([], 1))
        self.assertIn("fewer than 3 rounds", few["beside"][0])

    def test_a_busier_machine_is_no_slower_program(self):
        # Everything takes twice as long, the yardstick, too.
        self.assertEqual(self.compare_times(0, yardsticks=(3.0, 6.0), median_ms=20.0)["changes"], [])
        self.compare_times(3, yardsticks=(3.0, 3.0), median_ms=20.0)
        # Where the machine is twice as fast, the same time is a program that is twice as slow.
        found = self.compare_times(3, yardsticks=(6.0, 3.0), median_ms=10.0)["changes"][0]
        self.assertEqual((found["what"], found["machine"], found["regression"]), ("median_ms", 0.5, True))

    def test_what_only_one_of_them_has_is_said(self):
        a, b = self.result(), self.result()
        b["scenes"].append({**copy.deepcopy(b["scenes"][0]), "name": "t"})
        a["scenes"][0]["runs"].append({**copy.deepcopy(a["scenes"][0]["runs"][0]), "name": "step 2"})
        files = self.write_json("a.json", a), self.write_json("b.json", b)
        told = json.loads(self.check("bench", "--compare", *files, "--json").stdout)
        self.assertEqual(told["beside"], ["only A has s: step 2", "only B has t"])
        self.assertIn("only A has s: step 2\nonly B has t\n", self.check("bench", "--compare", *files).stdout)

    def test_the_yardstick_is_measured_in_the_same_rounds(self):
        self.bench(rounds=3)
        yardstick = json.loads((self.output / "bench.json").read_text())["scenes"][0]["yardstick"]
        self.assertGreater(yardstick["min_ms"], 0.1)
        self.assertLessEqual(yardstick["min_ms"], yardstick["median_ms"])
        self.assertLessEqual(yardstick["median_ms"], yardstick["p95_ms"])

    def test_files_that_cannot_be_compared(self):
        a = self.write_json("a.json", self.result())
        other = copy.deepcopy(self.result())
        other["scenes"][0]["name"] = "t"
        self.check_refused("bench", "--compare", a, self.write_json("b.json", other), says=["no run of a scene in common"])
        self.check_refused("bench", "--compare", a, self.write_json("c.json", {}), says=["is no bench.json"])
        self.check_refused("bench", "--compare", a, self.write_json("d.json", {"shvr_bench": 1}),
                           says=["is not what shvr bench writes"])
        self.check_refused("bench", status=2, says=["--output is missing"])
        self.check_refused("bench", "--scenes", "fog", "-o", "/proc/none", says=["/proc/none: cannot be created"])


if __name__ == "__main__":
    unittest.main()
