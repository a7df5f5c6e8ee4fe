"""shvr golden: regression pictures, as someone uses them who has never seen this repository."""
import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree
from pathlib import Path

from harness import ENVIRONMENT, SHVR, CliTest

PAGE = Path("tools/golden/USING.md").read_text()
# Blessing refuses in continuous integration, where these tests may run.
AT_HOME = {key: value for key, value in ENVIRONMENT.items() if key != "CI"}


def blocks(language):
    """Of the page: what stands after the language, and the text."""
    return dict(re.findall(rf"^```{language} (\S+)\n(.*?)^```", PAGE, re.M | re.S))


VARIANTS = ["without-fma", "vectors-128", "vectors-512", "threads-0", "threads-1", "threads-7", "poisoned"]


def calibrated(text):
    """{golden: {column: cell}} of the table that shvr golden calibrate writes."""
    lines = [[cell.strip() for cell in line.strip("|\n").split("|")] for line in text.splitlines()
             if line.startswith("| ")]
    return {row[0]: dict(zip(lines[0], row)) for row in lines[1:]}


class Golden(CliTest):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="shvr-golden-")
        cls.addClassCleanup(temporary.cleanup)
        cls.accepted = Path(temporary.name) / "golden"

    def setUp(self):
        super().setUp()
        (self.folder / "golden").mkdir()
        for name, text in blocks("json").items():
            (self.folder / name).write_text(text)
        self.write_session("scan.json", annotation={})

    def begin_blessed(self):
        """The pictures and side-cars that the first test to call this got by blessing."""
        if not self.accepted.exists():
            self.bless()
            shutil.copytree(self.folder / "golden", self.accepted)
        shutil.copytree(self.accepted, self.folder / "golden", dirs_exist_ok=True)

    def golden(self, *arguments, status=0, **environment):
        """Runs in the test's folder; the JSON object that was printed, or None."""
        result = subprocess.run([str(Path(SHVR).resolve()), "golden", *map(str, arguments), "--json"], text=True,
                                capture_output=True, timeout=300, cwd=self.folder, env={**AT_HOME, **environment})
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        self.errors = result.stderr
        return json.loads(result.stdout) if result.stdout else None

    def bless(self, *arguments, **keys):
        return self.golden("bless", *arguments, "--reason", "first pictures", **keys)

    def test_the_page_works_in_a_fresh_folder(self):
        self.assertEqual(sorted(blocks("json")), ["golden/overview.json", "golden/spheres.json"])
        path = self.folder / "bin"
        path.mkdir()
        (path / "shvr").symlink_to(Path(SHVR).resolve())
        told = blocks("sh")
        for name, status in [("bless", 0), ("run", 0)]:
            done = subprocess.run(["bash", "-ec", told[name]], cwd=self.folder, capture_output=True, text=True,
                                  env={**AT_HOME, "PATH": f"{path}:{os.environ['PATH']}"}, check=False)
            self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        for name in ("overview", "spheres"):
            for end in (".json", ".png", ".blessed.json"):
                self.assertTrue((self.folder / "golden" / (name + end)).exists(), name + end)
        # The light changes: the picture fails, and is accepted.
        self.write_session("scan.json", annotation={}, light={"ambient": 0.9})
        self.assertEqual(self.golden("run", status=3)["failed"], ["overview"])
        done = subprocess.run(["bash", "-ec", told["accept"]], cwd=self.folder, capture_output=True, text=True,
                              env={**AT_HOME, "PATH": f"{path}:{os.environ['PATH']}"}, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.golden("run")["failed"], [])

    def test_a_side_car_says_who_drew_it_and_why(self):
        rows = self.bless()["blessed"]
        self.assertEqual([(row["name"], row["old"]) for row in rows], [("overview", "none"), ("spheres", "none")])
        side_car = json.loads((self.folder / "golden/spheres.blessed.json").read_text())
        self.assert_keys(side_car, ["reason", "device", "driver", "processor", "instructions", "class", "fnv1a64",
                                    "work", "previous"])
        self.assertEqual(side_car["reason"], "first pictures")
        self.assertIn("llvmpipe", side_car["device"])
        self.assertGreater(side_car["work"]["samples"], 0)
        self.assertEqual([row["new"] for row in self.bless()["blessed"]], ["unchanged", "unchanged"])

    def test_blessing_needs_a_reason_and_never_happens_in_ci(self):
        self.golden("bless", status=2)
        self.assertIn("--reason", self.errors)
        self.bless(status=1, CI="true")
        self.assertIn("continuous integration never blesses", self.errors)
        self.assertEqual(list((self.folder / "golden").glob("*.png")), [])

    def test_a_missing_golden_fails_and_none_is_written(self):
        result = self.golden("run", status=3)
        self.assertEqual(result["failed"], ["overview", "spheres"])
        self.assertEqual({one["status"] for one in result["goldens"]}, {"missing"})
        self.assertEqual(list((self.folder / "golden").glob("*.png")), [])

    def test_without_lavapipe_the_reason_says_what_needs_it(self):
        for chosen, says in (({}, "goldens are drawn on lavapipe"), ({"SHVR_DEVICE": "llvmpipe"}, "no Vulkan device")):
            with self.subTest(chosen=chosen):
                result = self.golden("run", "spheres", status=3, VK_DRIVER_FILES="/nonexistent",
                                     VK_ICD_FILENAMES="/nonexistent", **chosen)
                reason = result["goldens"][0]["reason"]
                self.assertIn(says, reason)
                self.assertEqual("goldens are drawn" in reason, not chosen)

    def test_a_picture_without_its_side_car_fails(self):
        self.begin_blessed()
        shutil.copy(self.folder / "golden/overview.png", self.folder / "golden/spheres.png")
        result = self.golden("run", "spheres", status=3)
        self.assertIn("its side-car says", result["goldens"][0]["reason"])

    def test_other_work_fails_although_the_picture_is_the_same(self):
        self.begin_blessed()
        golden = json.loads((self.folder / "golden/spheres.json").read_text())
        golden["session"]["render"]["skip_empty_space"] = False
        self.write_json("golden/spheres.json", golden)
        one = self.golden("run", "spheres", status=3)["goldens"][0]
        self.assertEqual(one["metrics"]["max_abs"], 0)
        self.assertRegex(one["reason"], r"other work: .*samples \d+ \(recorded: \d+\)")

    def test_a_counter_that_the_side_car_lacks_fails_with_the_command_that_records_it(self):
        self.begin_blessed()
        path = self.folder / "golden/spheres.blessed.json"
        side_car = json.loads(path.read_text())
        for lacks in (["samples"], ["samples", "density_reads"], list(side_car["work"])):
            work = {name: value for name, value in side_car["work"].items() if name not in lacks}
            path.write_text(json.dumps({**side_car, "work": work}))
            one = self.golden("run", "spheres", status=3)["goldens"][0]
            self.assertEqual(one["metrics"]["max_abs"], 0)
            self.assertRegex(one["reason"], r"^golden/spheres.blessed.json: work lacks [^.]*" + lacks[-1])
            self.assertIn("shvr golden bless 'spheres' --folder 'golden' --reason", one["reason"])
        path.write_text(json.dumps({key: value for key, value in side_car.items() if key != "work"}))
        self.assertIn("work lacks rays, samples", self.golden("run", "spheres", status=3)["goldens"][0]["reason"])
        # The command in the sentence repairs the side-car and leaves the picture unchanged.
        before = (self.folder / "golden/spheres.png").read_bytes()
        self.bless("spheres")
        self.assertEqual(self.golden("run", "spheres")["failed"], [])
        self.assertEqual(json.loads(path.read_text())["work"], side_car["work"])
        self.assertEqual((self.folder / "golden/spheres.png").read_bytes(), before)

    def test_the_report_holds_everything_itself(self):
        self.begin_blessed()
        self.write_session("scan.json", annotation={}, light={"ambient": 0.9})
        golden = json.loads((self.folder / "golden/overview.json").read_text())
        golden["why"] = "<script>alert(1)</script> & more"
        self.write_json("golden/overview.json", golden)
        result = self.golden("run", status=3)
        page = (self.folder / result["report"]).read_text()
        self.assertLess(page.index('id="overview"'), page.index('id="spheres"'))  # failures first
        self.assertGreaterEqual(page.count("data:image/png;base64,"), 6)
        self.assertNotRegex(page, r'(src|href)="(?!data:|#)')
        self.assertNotIn("<script>alert", page)
        self.assertIn("&lt;script&gt;alert(1)", page)
        self.assertIn("shvr golden bless &#39;overview&#39; --folder &#39;golden&#39; --reason", page)
        for word in ("FLIP", "RMSE", "PSNR", "SSIM", "difference, 16 times"):
            self.assertIn(word, page)
        junit = xml.etree.ElementTree.parse(self.folder / "golden-results/junit.xml").getroot()
        self.assertEqual((junit.get("tests"), junit.get("failures")), ("2", "1"))
        self.assertEqual([case.get("name") for case in junit.iter("testcase") if case.find("failure") is not None],
                         ["overview"])

        (self.folder / "golden-results/report.html").unlink()
        again = self.golden("report")
        self.assertEqual(again["failed"], ["overview"])
        self.assertEqual((self.folder / "golden-results/report.html").read_text(), page)

    def test_failed_alone_are_blessed_with_failed(self):
        self.begin_blessed()
        self.write_session("scan.json", annotation={}, light={"ambient": 0.9})
        self.golden("run", status=3)
        self.assertEqual([row["name"] for row in self.bless("--failed")["blessed"]], ["overview"])
        self.assertEqual(self.golden("run")["failed"], [])

    def test_an_edge_is_loosened_for_a_reason(self):
        golden = json.loads((self.folder / "golden/spheres.json").read_text())
        self.write_json("golden/spheres.json", {**golden, "class": "edge"})
        self.golden("run", "spheres", status=1)
        self.assertIn("loosened", self.errors)
        self.write_json("golden/spheres.json", {**golden, "class": "edge", "loosened": "rods' silhouettes"})
        self.bless("spheres")
        self.assertEqual(self.golden("run", "spheres")["failed"], [])

    def test_what_is_wrong_is_said_in_a_sentence(self):
        self.golden("run", "nothing", status=1)
        self.assertIn("'nothing'", self.errors)
        self.golden("run", "--folder", "elsewhere", status=1)
        self.assertIn("elsewhere is no folder", self.errors)
        self.write_json("golden/bad.json", {"why": "x", "session": 3})
        self.golden("run", "bad", status=1)
        self.assertRegex(self.errors, r"golden/bad.json: key session is 3; expected a session")
        self.write_json("golden/bad.json", {"why": "x", "session": "gone.json"})
        broken = self.golden("run", "bad", status=3)["goldens"][0]
        self.assertEqual(broken["status"], "broken")
        self.assertIn("gone.json", broken["reason"])
        # Blessing does not help if the picture cannot be drawn.
        text = subprocess.run([str(Path(SHVR).resolve()), "golden", "run", "bad"], text=True, capture_output=True,
                              timeout=300, cwd=self.folder, env=AT_HOME, check=False).stdout
        self.assertIn("broken  bad", text)
        for said in (text, (self.folder / "golden-results/report.html").read_text(),
                     (self.folder / "golden-results/junit.xml").read_text()):
            self.assertNotIn("shvr golden bless", said)
        self.golden("run", "-o", "/proc/none", status=1)
        self.assertIn("/proc/none: cannot be written", self.errors)

    def test_calibration_tells_how_far_the_driver_moves_a_picture(self):
        result = self.golden("calibrate", "spheres", "--table", "calibration.md", status=0)
        self.assertEqual(result["failed"], [])
        one = result["goldens"][0]
        self.assertTrue(one["holds"])
        self.assertEqual(sorted(one["variants"]), sorted(VARIANTS))
        for name in ("threads-0", "threads-1", "threads-7", "poisoned"):
            self.assertEqual((one["variants"][name]["max_abs"], one["variants"][name]["light"]), (0, 0), name)
        text = (self.folder / "calibration.md").read_text()
        self.assertIn("\n    shvr golden calibrate 'spheres' --folder golden --table calibration.md\n", text)
        [(name, row)] = calibrated(text).items()
        self.assertEqual((name, row["class"], row["holds"]), ("spheres", "tight", "yes"))
        self.assertEqual([row[variant] == "0" for variant in VARIANTS],
                         [one["variants"][variant]["light"] == 0 for variant in VARIANTS])
        # A shader cache does not distinguish vector widths: a shared one would draw all variants by the same code.
        for name in VARIANTS:
            self.assertTrue(any((self.folder / "golden-results" / name / "shader-cache").rglob("*")), name)
        self.golden("calibrate", "--table", "calibration.txt", status=2)

    def test_every_golden_of_the_tree_is_calibrated_in_its_class(self):
        folder = Path(__file__).resolve().parents[2] / "golden"
        rows = calibrated((folder / "CALIBRATION.md").read_text())
        classes = {path.stem: json.loads(path.read_text()).get("class", "tight") for path in folder.glob("*.json")
                   if not path.name.endswith(".blessed.json")}
        self.assertEqual({name: row["class"] for name, row in rows.items()}, classes)
        for name, row in rows.items():
            self.assertEqual(row["holds"], "yes", name)
            self.assertEqual(list(row)[3:], VARIANTS)
            for variant in VARIANTS:
                levels = float(row[variant].split(";")[0])
                self.assertLessEqual(2 * levels, {"exact": 0, "tight": 2, "edge": 255}[row["class"]], (name, variant))
        # Other instructions do round differently, so the variants are needed.
        self.assertTrue(any(row["without-fma"] != "0" for row in rows.values()))


if __name__ == "__main__":
    unittest.main()
