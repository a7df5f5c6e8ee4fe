"""shvr bench: errors against the reference renderer, exact work, files, and what counts as a regression."""
import csv
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree
from pathlib import Path

from harness import ENVIRONMENT, IS_SLOW, SHVR, CliTest

ROOT = Path(__file__).resolve().parents[3]
HAS_VTK = bool(shutil.which("xvfb-run") or os.environ.get("DISPLAY")) and subprocess.run(
    ["/usr/bin/python3", "-c", "import vtkmodules"], capture_output=True, check=False).returncode == 0
# Answers as tools/peers/vtk_raycast.py does: with a black picture, and 1000 ms per unit of the step as its time.
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
# Pictures of a scene are this small every day; without it they are those of --quick.
SMALL = () if IS_SLOW else ("--size", "24,18")
# The largest RMSE at a step of a quarter voxel; edges of opaque things differ by a step's share of a pixel's ray.
LIMITS = {"painted": 0.01, "surfaces": 0.01, "anisotropic": 0.01, "uint16": 0.01, "occluded": 0.03, "paged": 0.01}
RUN_KEYS = ["name", "family", "settings", "error", "min_ms", "median_ms", "median_low_ms", "median_high_ms", "p95_ms", "work",
            "device_bytes", "redraws", "on_front"]


class BenchTest(CliTest):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="shvr-references-")
        cls.addClassCleanup(folder.cleanup)
        cls.references = Path(folder.name)

    def bench(self, *arguments, scenes="fog", rounds=2, knows_references=True):
        """Without VTK, unless the arguments name it; with the references that an earlier call left."""
        self.output = self.folder / "bench"
        if "--peer" not in arguments:
            arguments = ("--peer", "none", *arguments)
        self.output.mkdir(exist_ok=True)
        for path in self.references.iterdir() if knows_references else []:
            shutil.copy2(path, self.output)
        told = self.check_json("bench", "--scenes", scenes, "--quick", "--rounds", rounds, "-o", self.output, *SMALL,
                               *arguments)
        for path in self.output.glob("reference-*"):
            shutil.copy2(path, self.references)
        return told

    def results(self):
        return json.loads((self.output / "bench.json").read_text())["scenes"]

    def runs(self, scene=0):
        return {run["name"]: run for run in self.results()[scene]["runs"]}

    def notes(self, scene=0):
        return self.results()[scene]["notes"]

    def stand_in(self, text=STAND_IN):
        path = self.folder / "peer.py"
        path.write_text(text)
        path.chmod(0o755)
        return path


class Bench(BenchTest):
    def test_errors_fall_along_the_qualities_and_the_steps(self):
        scenes = ["fog", "tissue"] if IS_SLOW else ["tissue"]
        told = self.bench(scenes=",".join(scenes))
        self.assertEqual(told["bench"], str(self.output / "bench.json"))
        for at, scene in enumerate(scenes):
            runs = self.runs(at)
            for names in (["draft", "interactive", "good"], ["step 2", "step 1", "step 0.5", "step 0.25"]):
                errors = [runs[name]["error"]["rmse"] for name in names]
                self.assertEqual(errors, sorted(errors, reverse=True), names)
                work = [runs[name]["work"]["samples"] for name in names]
                self.assertEqual(work, sorted(work), names)
            self.assertLess(runs["reference"]["error"]["rmse"], 1e-4)
            self.assertLess(runs["interactive"]["error"]["rmse"], 1e-2)
            for run in runs.values():
                self.assert_keys(run, RUN_KEYS)
                self.assertLessEqual(run["min_ms"], run["median_ms"])
                self.assertLessEqual(run["median_ms"], run["p95_ms"])
                self.assertLessEqual(run["min_ms"], run["median_low_ms"])
                self.assertLessEqual(run["median_low_ms"], run["median_ms"])
                self.assertLessEqual(run["median_ms"], run["median_high_ms"])
                self.assertLessEqual(run["error"]["fraction_over_4"], run["error"]["fraction_over_1"])
            if scene != "fog":  # in fog no pixel is off by a level
                self.assertGreater(runs["draft"]["error"]["fraction_over_1"],
                                   runs["reference"]["error"]["fraction_over_1"])
            self.assertEqual(runs["skipping off"]["error"], runs["step 0.5"]["error"])
            # The run before has another table: the picture that makes this one's is not the one that is timed.
            self.assertEqual(runs["pre-integrated 1"]["redraws"], 2)
            self.assertLessEqual({run["redraws"] for run in runs.values()}, {0, 1, 2})
        # On the front: no run of the scene is better in both.
        for row in told["pareto"]:
            runs = self.runs(scenes.index(row["scene"]))
            better = [run for run in runs.values()
                      if run["median_ms"] < row["median_ms"] and run["error"]["rmse"] < row["rmse"]]
            self.assertEqual(better, [])

    def test_what_is_painted_occluded_paged_or_opaque_is_drawn_as_the_reference_draws_it(self):
        # test_bench_scenes.py holds the others to the same limits in smaller pictures.
        for scene in LIMITS if IS_SLOW else ["occluded", "paged"]:
            with self.subTest(scene=scene):
                self.bench(scenes=scene, rounds=1)
                runs = self.runs()
                self.assertLess(runs["step 0.25"]["error"]["rmse"], LIMITS[scene])
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
        told = self.bench(rounds=3)
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
        # The yardstick is measured in the same rounds.
        yardstick = self.results()[0]["yardstick"]
        self.assertGreater(yardstick["min_ms"], 0.1)
        self.assertLessEqual(yardstick["min_ms"], yardstick["median_ms"])
        self.assertLessEqual(yardstick["median_ms"], yardstick["p95_ms"])

    def test_who_measured_is_in_the_file(self):
        subprocess.run([SHVR, "bench", "--scenes", "fog", "--quick", "--rounds", "1", "--peer", "none", "--mixed", "4",
                        *SMALL, "-o", self.folder / "bench"], check=True, capture_output=True, timeout=300,
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
        self.bench(knows_references=False)
        kept = list(self.output.glob("reference-*.light"))
        self.assertEqual(len(kept), 1)
        before, first = kept[0].stat().st_mtime_ns, self.runs()
        (self.output / "bench.json").rename(self.folder / "a.json")
        self.bench(knows_references=False)
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

    @unittest.skipUnless(HAS_VTK, "python3-vtk9 and xvfb are not installed")
    def test_vtk_draws_the_same_picture(self):
        # Near enough that nothing but its own rounding, steps and normals is between them: no shift, no other border.
        limits = {"tissue-matt": 0.02, **({"fog": 0.006, "tubes-matt": 0.03} if IS_SLOW else {})}
        for scene, limit in limits.items():
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

    def test_a_session_of_ones_own(self):
        session = self.write_session(annotation={})
        self.bench(scenes=str(session))
        self.assertLess(self.runs()["step 0.25"]["error"]["rmse"], 0.01)
        self.check_refused("bench", "--scenes", "tubs", "-o", self.folder / "x", says=["tubs", "tubes, noisy-surface"])
        rods = self.write_session("rods.json", annotation={},
                                  surfaces=[{"from": [2, 2, 2], "to": [9, 9, 9], "radius": 2}])
        self.check_refused("bench", "--scenes", rods, "-o", self.folder / "x", says=["does not draw rods"])

if __name__ == "__main__":
    unittest.main()
