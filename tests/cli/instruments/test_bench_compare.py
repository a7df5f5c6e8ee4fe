"""shvr bench --compare: what counts as a regression."""
import copy
import json
import unittest

from harness import CliTest


class Compared(CliTest):
    def result(self, **keys):
        """A file of one run, as --compare reads it."""
        run = {"name": "step 1", "family": "step", "settings": [], "scale": 1.0,
               "error": {"rmse": 1e-3, "max_abs": 1e-2, "alpha_rmse": 0.0, "alpha_max_abs": 0.0, "psnr_db": 50.0,
                         "ssim": 1.0, "flip_mean": 0.01, "flip_p99": 0.1},
               "min_ms": 9.0, "median_ms": 10.0, "p95_ms": 11.0, "first_ms": 20.0,
               "work": {"samples": 1000, "bricks_skipped": 50, "passes": 3}, "device_bytes": 1, "on_front": True}
        for key, value in keys.items():
            place = run["error"] if key in run["error"] else run["work"] if key in run["work"] else run
            place[key] = value
        return {"shvr_bench": 1, "device": "d", "driver": "d", "processor": "p", "instructions": "fma", "cores": 2,
                "load": 0.0, "rounds": 20, "size": [4, 3],
                "scenes": [{"name": "s", "what": "w", "volume": "v", "reference_seconds": 0.0, "runs": [run]}]}

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
        self.assertEqual(self.compare(3, alpha_rmse=1e-5)["changes"][0]["what"], "alpha_rmse")
        older = self.result()
        del older["scenes"][0]["runs"][0]["error"]["alpha_rmse"]
        self.check("bench", "--compare", self.write_json("older.json", older), self.folder / "b.json")
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

    def test_files_that_cannot_be_compared(self):
        a = self.write_json("a.json", self.result())
        other = copy.deepcopy(self.result())
        other["scenes"][0]["name"] = "t"
        self.check_refused("bench", "--compare", a, self.write_json("b.json", other),
                           says=["no run of a scene in common"])
        self.check_refused("bench", "--compare", a, self.write_json("c.json", {}), says=["is no bench.json"])
        self.check_refused("bench", "--compare", a, self.write_json("d.json", {"shvr_bench": 1}),
                           says=["is not what shvr bench writes"])
        self.check_refused("bench", status=2, says=["--output is missing"])
        self.check_refused("bench", "--scenes", "fog", "-o", "/proc/none", says=["/proc/none: cannot be written"])


if __name__ == "__main__":
    unittest.main()
