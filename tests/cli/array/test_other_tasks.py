"""shvr golden run, export, study and bench --task: what several processes make and gather joins equals that of one."""
import json
import unittest

from harness import ENVIRONMENT, IS_SLOW, Volume
from tasks import SplitTest, files_below


def without_times(results):
    for row in results["goldens"]:
        row["seconds"] = 0
    return results


def timeless(value):
    """Results of bench without times, and without what follows from them."""
    if isinstance(value, list):
        return [timeless(each) for each in value]
    if not isinstance(value, dict):
        return value
    return {key: timeless(each) for key, each in value.items()
            if not key.endswith(("_ms", "_seconds")) and key not in ("load", "on_front")}


class OtherTasks(SplitTest):
    def test_goldens_are_drawn_by_several_processes(self):
        ENVIRONMENT.pop("CI", None)  # blessing refuses there
        folder = self.folder / "golden"
        folder.mkdir()
        for name, ambient in [("a", 0.1), ("b", 0.4), ("c", 0.9), ("d", 0.2)]:
            self.write_session(f"{name}.json", annotation={}, light={"ambient": ambient})
            self.write_json(f"golden/{name}.json", {"why": "light", "session": f"../{name}.json"})
        self.check("golden", "bless", "--folder", folder, "--reason", "first pictures")
        # One of them fails.
        (folder / "c.png").write_bytes((folder / "a.png").read_bytes())
        run = ["golden", "run", "--folder", folder, "-o"]
        whole = self.check_json(*run, self.folder / "whole", status=3)
        for of in (2, 7):
            output = self.folder / f"of-{of}"
            self.tasks(of, *run, output)
            self.assertFalse((output / "results.json").exists())
            told = self.gather(output, status=3)
            self.assertEqual((told["missing"], told["result"]["failed"]), ([], whole["failed"]))
            found, expected = files_below(output), files_below(self.folder / "whole")
            self.assertEqual(list(found), list(expected))
            for name in expected:
                if name.endswith(".png"):
                    self.assertEqual(found[name], expected[name], name)
            self.assertEqual(without_times(json.loads(found["results.json"])),
                             without_times(json.loads(expected["results.json"])))

    def test_an_export_is_split_by_its_files(self):
        header = Volume.noise((12, 10, 8), seed=4).write(self.folder)
        project = self.folder / "project"
        self.check("import", header, project, "--quiet")
        self.check("annotate", project, "--script", self.write_script("s.jsonl", [
            {"op": "paint", "brush": "fill", "region": "ball", "group": 3, "threshold": 100, "radius": 3,
             "path": [[6, 5, 4]]},
            {"op": "node", "at": [2, 2, 2], "radius": 1, "group": 2}, {"op": "node", "at": [9, 7, 5], "radius": 1},
            {"op": "save"}]))

        def export(name, exists=False):
            (self.folder / name).mkdir(exist_ok=exists)
            return ["export", project, "--mask", self.folder / name / "m.mask", "--trace",
                    self.folder / name / "t.graphml", "--mesh", self.folder / name / "t.ply", "--metrics",
                    self.folder / name / "m.csv"]
        whole = self.check_json(*export("whole"))
        for of in (1, 2, 7):
            self.tasks(of, *export(f"of-{of}"))
            told = self.gather(self.folder / f"of-{of}" / "m.mask", "--remove")["result"]
            self.assertEqual(len(told["written"]), 4)
            for key in ("voxels_by_group", "nodes", "internodes", "length_by_group"):
                self.assertEqual(told[key], whole[key])
            self.assert_equal_files(self.folder / f"of-{of}", self.folder / "whole")
        self.check_refused("export", project, "--task", "0/2", status=2, says=["--mask"])
        # A file that was removed since is missing.
        self.tasks(2, *export("lost"))
        trace = self.folder / "lost" / "t.graphml"
        trace.unlink()
        said = self.check_refused("gather", self.folder / "lost" / "m.mask", status=1, says=["t.graphml: is missing"])
        piece = self.folder / "lost" / "m.mask.pieces" / ("piece-0" if "piece-0 " in said else "piece-1")
        piece.unlink()
        self.tasks(2, *export("lost", exists=True))
        self.gather(self.folder / "lost" / "m.mask", "--remove")
        self.assert_equal_files(self.folder / "lost", self.folder / "whole")

    def test_a_study_is_gathered_and_a_repeated_task_keeps_what_it_made(self):
        conditions = self.folder / "conditions.csv"
        conditions.write_text("task,touch,law,probe_radii,noise\ntrace,none,potential,1.5,10\n")

        def study(name):
            return ["study", "--size", "small", "--conditions", conditions, "--seeds", 3, "-o", self.folder / name]
        self.check(*study("whole"))
        for index in (0, 0):
            self.check_json(*study("parts"), "--task", f"{index}/2")
        told = self.gather(self.folder / "parts", status=1)
        self.assertEqual(told["missing"], ["1/2"])
        self.assertEqual(self.check_json(*study("parts"), "--task", "1/2")["missing"], 0)
        told = self.gather(self.folder / "parts")
        self.assertEqual((told["result"]["made"], told["result"]["missing"]), (0, 0))
        for name in ("rows.csv", "report.html"):
            self.assert_equal_files(self.folder / "parts" / name, self.folder / "whole" / name)

    def test_scenes_of_a_bench_are_measured_by_several_processes(self):
        scenes = ["uint16", "fog"] if IS_SLOW else ["fog"]  # of one scene, the second task makes an empty piece

        def bench(name):
            return ["bench", "--scenes", ",".join(scenes), "--quick", "--side", 16, "--size", "8,8", "--rounds", 1, "--peer",
                    "none", "-o", self.folder / name]
        whole, parts = self.folder / "whole", self.folder / "parts"
        self.check_json(*bench("whole"))
        self.tasks(2, *bench("parts"), order=(1,))
        self.assertEqual(self.gather(parts, status=1)["missing"], ["0/2"])
        self.assertFalse((parts / "bench.json").exists())
        self.tasks(2, *bench("parts"), order=(0,))
        told = self.gather(parts)
        self.assertEqual((told["missing"], told["result"]["bench"]), ([], str(parts / "bench.json")))
        self.assertEqual(sorted(files_below(parts)), sorted(files_below(whole)))
        found, expected = (json.loads((folder / "bench.json").read_text()) for folder in (parts, whole))
        self.assertEqual([scene["name"] for scene in expected["scenes"]], scenes)
        self.assertEqual(timeless(found), timeless(expected))

    def test_what_no_task_has_made_is_named_by_its_own_manifest(self):
        for given, manifest in [("no.zarr", "no.zarr.pieces/manifest.json"),
                                ("no.zarr.pieces", "no.zarr.pieces/manifest.json"),
                                ("no.zarr.pieces/manifest.json", "no.zarr.pieces/manifest.json"),
                                ("", self.folder.name + ".pieces/manifest.json")]:
            said = self.check_refused("gather", self.folder / given, status=1, says=["is missing", "--task 0/N"])
            self.assertIn(f"/{manifest}: ", said)


if __name__ == "__main__":
    unittest.main()
