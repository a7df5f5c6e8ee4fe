"""shvr study: simulated annotators, their rows, and a study that is split or continued."""
import csv
import unittest
from pathlib import Path

from harness import CliTest

CONDITIONS = "task,touch,law,probe_radii,noise\n"


class Study(CliTest):
    def conditions(self, *lines):
        path = self.folder / "conditions.csv"
        path.write_text(CONDITIONS + "".join(line + "\n" for line in lines))
        return path

    def study(self, folder, *arguments):
        return self.check_json("study", "--size", "small", "-o", self.folder / folder, *arguments)

    def rows(self, folder, name="rows.csv"):
        with open(self.folder / folder / name, newline="") as file:
            return list(csv.DictReader(file))

    def test_a_small_study_shows_that_object_following_helps_tracing(self):
        result = self.study("small")
        self.assert_keys(result, ["report", "csv", "rows", "made", "missing"])
        rows = self.rows("small")
        self.assertEqual((len(rows), result["missing"]), (result["rows"], 0))
        page = Path(result["report"]).read_text()
        for part in ("simulated annotators", "dice_partial", "baselines.csv", "CALIBRATION.md", "table 6.1"):
            self.assertIn(part, page)
        self.assertNotIn("http", page.replace("http://www.w3.org", ""))
        # Two pairs for each task by one annotator, and two by two.
        self.assertEqual(len(self.rows("small", "repeats.csv")), 8)

        # The report is made again from the folder alone, with results of algorithms that came later.
        (self.folder / "small" / "baselines.csv").write_text(
            "method,noise,seed,skipped,dice_partial\nflood,10,1,,0.12345\n")
        marked = (self.folder / "small" / "repeats.csv").read_text().splitlines()
        marked[1] = ",".join([*marked[1].split(",")[:8], "", "0.4321", "2"])
        (self.folder / "small" / "repeats.csv").write_text("\n".join(marked) + "\n")
        again = self.study("small")
        self.assertEqual((again["made"], again["missing"]), (0, 0))
        self.assertEqual(self.rows("small", "repeats.csv")[0]["segment_agreement"], "0.4321")  # read, not made again
        self.assertIn("<td>0.123</td>", Path(result["report"]).read_text())

        def scores(task, touch, column):
            return {row["seed"]: float(row[column]) for row in rows
                    if (row["task"], row["touch"], row["law"]) == (task, touch, "potential")
                    and (float(row["probe_radii"]), float(row["noise"])) == (1.5, 10.0)}
        guided, free = scores("trace", "object", "node_score"), scores("trace", "none", "node_score")
        self.assertEqual(sorted(guided), ["1", "2", "3"])
        for seed, score in free.items():
            self.assertGreater(guided[seed], score)
        self.assertEqual({row["touch"] for row in rows}, {"none", "surface", "proximity", "object"})
        self.assertEqual({row["law"] for row in rows}, {"potential", "mean", "thesis"})
        for row in rows:
            self.assertLessEqual(float(row["seconds"]), 600.0)
            self.assertEqual(row["dice_partial"] == "", row["task"] == "trace")
            if row["touch"] == "none":
                self.assertEqual(float(row["force_most"]), 0.0)

    def test_rows_are_equal_at_any_number_of_threads_and_however_the_study_is_split_or_continued(self):
        chosen = ["--conditions", self.conditions("trace,none,potential,1.5,10", "paint,none,potential,1,3"),
                  "--seeds", 2]
        self.assertEqual(self.study("one", *chosen, "--threads", 1)["made"], 4)
        whole = (self.folder / "one" / "rows.csv").read_bytes()
        self.study("four", *chosen, "--threads", 4)
        self.assertEqual((self.folder / "four" / "rows.csv").read_bytes(), whole)
        self.assertEqual(self.study("one", *chosen)["made"], 0)
        made = [self.study("parts", *chosen, "--task", f"{part}/3") for part in range(3)]
        self.assertEqual(sum(part["made"] for part in made), 4)
        self.assertEqual([part["missing"] for part in made][-1], 0)
        self.assertEqual(self.study("parts", *chosen)["made"], 0)
        self.study("begun", *chosen[:2], "--seeds", 1)
        self.assertEqual(self.study("begun", *chosen)["made"], 2)
        self.assertEqual((self.folder / "begun" / "rows.csv").read_bytes(), whole)
        # A smaller study in the same folder loses no row of the larger one.
        self.assertEqual(self.study("one", *chosen[:2], "--seeds", 1)["made"], 0)
        self.study("one", "--conditions", self.conditions("paint,none,potential,1,3"), "--seeds", 1)
        again = (self.folder / "one" / "rows.csv").read_text().splitlines()
        self.assertEqual(sorted(again), sorted(whole.decode().splitlines()))

    def test_annotations_are_kept_on_request_and_score_as_their_rows_say(self):
        chosen = ["--conditions", self.conditions("trace,none,potential,1.5,10", "paint,none,potential,1.5,10"),
                  "--seeds", 1, "--annotators", "8,6,8"]
        self.assertEqual(self.study("kept", *chosen)["made"], 4)
        self.assertFalse((self.folder / "kept" / "annotations").exists())
        self.assertEqual(self.study("kept", *chosen, "--keep-annotations")["made"], 4)  # to have their annotations
        self.assertEqual(self.study("kept", *chosen, "--keep-annotations")["made"], 0)
        rows = self.rows("kept")
        self.assertEqual([(row["task"], row["annotator"]) for row in rows],
                         [("trace", "6"), ("trace", "8"), ("paint", "6"), ("paint", "8")])
        truth = self.check_json("phantom", "section", "--size", 96, "--noise", 10, "-o", self.folder)
        for row in rows:
            kind = {"trace": ("--trace", "graphml"), "paint": ("--mask", "mask")}[row["task"]]
            name = f"{row['task']}-none-potential-1.5-10-seed-1-annotator-{row['annotator']}.{kind[1]}"
            scores = self.check_json("evaluate", "--truth-mask", truth["truth_partial_mask" if row["task"] == "paint"
                                                                       else "truth_mask"],
                                     kind[0], self.folder / "kept" / "annotations" / name)
            found, score = (("dice_partial", "dice") if row["task"] == "paint" else ("node_score", "node_score"))
            self.assertAlmostEqual(float(row[found]), scores[score], places=9)

    def test_what_does_not_fit_is_refused(self):
        study = ["study", "--size", "small", "-o", self.folder / "study"]
        for lines, says in [(["trace,all,mean,1.5,10"], "line 2, column touch is \"all\"; expected one of none"),
                            (["trace,none,mean,1.5"], "line 2 has 4 fields; expected 5"),
                            (["trace,none,mean,9,10"], "column probe_radii is \"9\"; expected a number from 0.5 to 4"),
                            ([], "holds no condition")]:
            with self.subTest(says=says):
                self.check_refused(*study, "--conditions", self.conditions(*lines), status=1, says=[says])
        for part in ("3/3", "a/2", "1", "0/0", "-1/2"):
            with self.subTest(part=part):
                self.check_refused(*study, "--task", part, status=2, says=["--task is"])
        for annotators in ("0", "11", "3,x", ""):
            self.check_refused(*study, f"--annotators={annotators}", status=2, says=["--annotators"])
        (self.folder / "study").mkdir(exist_ok=True)
        (self.folder / "study" / "phantoms.txt").write_text("side 7\n")
        chosen = ["--conditions", self.conditions("trace,none,potential,1.5,10"), "--seeds", 1]
        self.check_refused(*study, *chosen, status=1, says=["phantoms.txt", "side 7", "side 96", "another folder"])
        (self.folder / "study" / "phantoms.txt").write_text("side 96\n")
        (self.folder / "study" / "rows.csv").write_text("broken\n")
        self.check_refused(*study, *chosen, status=1, says=["rows.csv: line 1 is \"broken\""])
        self.assertEqual((self.folder / "study" / "rows.csv").read_text(), "broken\n")


if __name__ == "__main__":
    unittest.main()
