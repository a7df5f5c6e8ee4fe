"""shvr profile: times, traces, tables and graphs."""
import csv
import json
import shutil
import unittest
import xml.etree.ElementTree

from harness import CliTest, run

KEYS = ["passes", "first_frame", "frame_median_ms", "sum_median_ms", "counters", "bytes", "device", "driver"]
PASS_KEYS = ["name", "count", "min_ms", "median_ms", "p95_ms", "max_ms", "bytes", "dispatches", "barrier"]
FRAMES = 5


class Profile(CliTest):
    def profile(self, *arguments):
        return self.check_json("profile", self.write_session(), "--frames", FRAMES, *arguments)

    def test_keys_and_counts(self):
        profile = self.profile()
        self.assert_keys(profile, KEYS)
        self.assertEqual(profile["frames"], FRAMES)
        for one in profile["passes"]:
            self.assert_keys(one, PASS_KEYS)
            self.assertLessEqual(one["min_ms"], one["median_ms"])
            self.assertLessEqual(one["median_ms"], one["p95_ms"])
            self.assertLessEqual(one["p95_ms"], one["max_ms"])
            self.assertEqual(one["count"], FRAMES)
            self.assertGreater(one["bytes"], 0)
        self.assertGreater(profile["frame_median_ms"], 0)
        self.assertGreater(profile["counters"]["samples"], 0)
        self.assertGreater(profile["bytes"]["device"], 0)

    def test_a_pass_that_a_frame_does_not_run_has_no_value_there(self):
        profile = self.profile()
        first = [one["name"] for one in profile["first_frame"]]
        steady = [one["name"] for one in profile["passes"]]
        self.assertIn("leap_occupancy", first)
        self.assertNotIn("leap_occupancy", steady)
        self.assertIn("raycast", first)
        self.assertIn("raycast", steady)

        cold = self.profile("--warmup", "0")
        counts = {one["name"]: one["count"] for one in cold["passes"]}
        self.assertEqual((counts["leap_occupancy"], counts["raycast"]), (1, FRAMES))

    def test_passes_do_not_take_longer_than_their_frame(self):
        # The processor's driver runs one pass after the other.
        profile = self.profile("--serialize")
        self.assertLessEqual(profile["sum_median_ms"], 1.05 * profile["frame_median_ms"] + 0.3)
        self.assertIs(profile["serialize"], True)

    def test_the_page_shows_every_pass_of_every_frame(self):
        path = self.folder / "profile.html"
        profile = self.profile("--html", path)
        self.assertEqual(profile["written"], [str(path)])
        page = path.read_text()
        self.assertNotRegex(page, r'(src|href)="(?!data:)')
        for one in profile["passes"]:
            self.assertEqual(page.count(f"<title>{one['name']}, frame "), one["count"], one["name"])
            self.assertAlmostEqual(one["gb_per_s"], one["bytes"] / one["median_ms"] / 1e6)
        self.assertEqual(page.count("<title>frame "), FRAMES)
        for name in profile["bytes"]["by_resource"]:
            self.assertIn(f"<td>{name}</td>", page)
        self.assertIn("<polyline", page)
        self.check_refused("profile", self.write_session(), "--html", self.folder / "a.txt", status=2, says=["--html"])

    def test_invocations_are_the_threads_of_whole_groups(self):
        session = self.write_session(render={"size": [100, 60]})
        invocations = self.check_json("profile", session, "--frames", 1, "--warmup", 0)["invocations"]
        threads = invocations["raycast"]
        self.assertGreaterEqual(threads, 100 * 60)
        self.assertLess(threads, 128 * 64)
        self.assertEqual(threads % 32, 0)
        text = self.check("profile", session, "--frames", 1).stdout
        self.assertRegex(text, rf"invocations of raycast +{threads}\n")

    def test_counters_are_those_of_render(self):
        session = self.write_session()
        picture = self.check_json("render", session, "-o", self.folder / "a.png")
        self.assertEqual(self.profile()["counters"], picture["counters"])

    def test_the_trace_is_monotone_and_its_spans_nest(self):
        path = self.folder / "trace.json"
        profile = self.profile("--trace", path)
        self.assertEqual(profile["written"], [str(path)])
        events = json.loads(path.read_text())["traceEvents"]
        self.assertEqual({event["ph"] for event in events}, {"M", "X", "C", "s", "f"})
        timed = [event for event in events if event["ph"] != "M"]
        self.assertEqual([event["ts"] for event in timed], sorted(event["ts"] for event in timed))
        names = {event["args"]["name"] for event in events if event["name"] == "process_name"}
        self.assertEqual(len(names), 2)

        ends = {}
        for event in events:
            if event["ph"] != "X":
                continue
            row = (event["pid"], event["tid"])
            self.assertGreaterEqual(event["dur"], 0)
            self.assertGreaterEqual(event["ts"], ends.get(row, 0) - 1e-3, event)  # nothing on a row overlaps
            ends[row] = event["ts"] + event["dur"]
            self.assertIsInstance(event["args"], dict)

        passes = [event["name"] for event in events if event["ph"] == "X" and event["cat"] == "pass"]
        self.assertEqual(passes, [one["name"] for one in profile["passes"]] * FRAMES)
        self.assertEqual(sum(event.get("cat") == "frame" for event in events), FRAMES)
        starts = [event["id"] for event in events if event["ph"] == "s"]
        self.assertEqual(starts, [event["id"] for event in events if event["ph"] == "f"])

    def test_the_table_has_a_row_per_frame_and_pass(self):
        path = self.folder / "times.csv"
        profile = self.profile("--csv", path)
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), FRAMES * len(profile["passes"]))
        for one in profile["passes"]:
            times = sorted(float(row["gpu_ms"]) for row in rows if row["pass"] == one["name"])
            self.assertAlmostEqual(times[0], one["min_ms"], places=6)
            self.assertAlmostEqual(times[FRAMES // 2], one["median_ms"], places=6)
            self.assertAlmostEqual(times[-1], one["max_ms"], places=6)

    def test_the_graph_as_json_holds_the_passes_that_ran(self):
        path = self.folder / "graph.json"
        profile = self.profile("--graph", path)
        graph = json.loads(path.read_text())
        alive = [one["name"] for one in graph["passes"] if one["alive"]]
        self.assertEqual(alive, [one["name"] for one in profile["passes"]])
        resources = {one["name"]: one for one in graph["resources"]}
        self.assertTrue(resources["atlas"]["imported"])
        self.assertIsNone(resources["cell ranges"]["lifetime"])  # only the leap grid reads it

    def test_memory_of_a_frame_has_lifetimes_budgets_and_sums(self):
        """The sums, worked out again from the graph, whose lifetimes another part of the program finds."""
        path, page = self.folder / "graph.json", self.folder / "profile.html"
        session = self.write_session(light={"occlusion": {"strength": 1}}, view={"arrangement": "overview"})
        profile = self.check_json("profile", session, "--frames", 1, "--warmup", 0, "--budget-device", 300,
                                  "--budget-host", 200, "--graph", path, "--html", page)
        memory, graph = profile["memory"], json.loads(path.read_text())
        self.assertEqual((memory["device_budget"], memory["host_budget"]), (300 << 20, 200 << 20))
        for kind in ("device", "host"):
            self.assertLessEqual(profile["bytes"][kind], profile["bytes"][f"peak_{kind}"])
            self.assertLessEqual(profile["bytes"][f"peak_{kind}"], memory[f"{kind}_budget"])
        steps = [one["name"] for one in graph["passes"] if one["alive"]]
        self.assertEqual(memory["steps"], len(steps))
        living = [one for one in graph["resources"] if one["lifetime"]]
        keys = ("name", "kind", "format", "bytes")
        self.assertEqual([[one[key] for key in keys] for one in memory["resources"]],
                         [[one[key] for key in keys] for one in living])
        self.assertEqual([one["lasting"] for one in memory["resources"]], [one["imported"] for one in living])
        for mine, theirs in zip(memory["resources"], living):
            self.assertIn(mine["first_step"], (0, theirs["lifetime"]["first_step"]))  # 0: the host filled it before
            self.assertEqual(mine["last_step"], theirs["lifetime"]["last_step"])
            self.assertEqual(mine["first_pass"], steps[mine["first_step"]])
            self.assertEqual(mine["last_pass"], steps[mine["last_step"]])

        transients = [one for one in memory["resources"] if not one["lasting"]]
        at_once = [sum(one["bytes"] for one in transients if one["first_step"] <= step <= one["last_step"])
                   for step in range(len(steps))]
        self.assertEqual(memory["transient_bytes"], sum(one["bytes"] for one in transients))
        self.assertEqual(memory["transient_most_at_once"], max(at_once))
        self.assertGreater(max(at_once), 0)
        self.assertLess(max(at_once), memory["transient_bytes"])  # some could share
        self.assertLessEqual(memory["transient_most_at_once"], memory["transient_packed"])
        self.assertLessEqual(memory["transient_packed"], memory["transient_bytes"])
        owners = [one for at, one in enumerate(memory["resources"]) if one["memory_of"] == at and not one["lasting"]]
        self.assertEqual(memory["transient_taken"], sum(one["bytes"] for one in owners))
        self.assertAlmostEqual(memory["sharing_saves"], 1 - memory["transient_taken"] / memory["transient_bytes"])
        for at, one in enumerate(memory["resources"]):
            owner = memory["resources"][one["memory_of"]]
            self.assertEqual(owner["memory_of"], one["memory_of"])
            self.assertTrue(one is owner or not one["lasting"])
            self.assertEqual([owner[key] for key in keys[1:]], [one[key] for key in keys[1:]])
            for other in memory["resources"][:at]:
                if other["memory_of"] == one["memory_of"]:
                    self.assertTrue(other["last_step"] < one["first_step"] or one["last_step"] < other["first_step"])
        for one in memory["resources"]:
            way = "outlives the frame, used from" if one["lasting"] else "from"
            title = f"<title>{one['name']}: {way} {one['first_pass']} to {one['last_pass']}</title>"
            self.assertIn(title, page.read_text())

        text = self.check("profile", session, "--frames", "1", "--budget-device", 300).stdout
        self.assertRegex(text, r"device memory: [0-9.]+ MiB, at most [0-9.]+ of a budget of 300\.0\n")
        self.assertRegex(text, r"transient resources: [0-9.]+ KiB in [0-9.]+ KiB of memory \([0-9]+ % less\)")
        self.assertRegex(text, r"(?m)^color .* rgba32_float  +raycast  +\w")

    @unittest.skipUnless(shutil.which("dot"), "Graphviz is not installed")
    def test_the_graph_as_a_drawing(self):
        drawing, text = self.folder / "graph.svg", self.folder / "graph.dot"
        self.profile("--graph", drawing, "--warmup", "0")
        root = xml.etree.ElementTree.parse(drawing).getroot()
        self.assertTrue(root.tag.endswith("svg"))
        self.assertIn("raycast", drawing.read_text())
        self.profile("--graph", text)
        self.assertTrue(text.read_text().startswith("digraph frame {"))

    def test_without_graphviz_one_sentence_says_so(self):
        result = run("profile", self.write_session(), "--frames", "1", "--quiet", "--graph", self.folder / "a.svg",
                     environment={"PATH": str(self.folder)})
        self.assertEqual(result.returncode, 1)
        self.assertIn("Graphviz", result.stderr)
        self.assertFalse((self.folder / "a.svg").exists())

    def test_people_read_a_table(self):
        lines = self.check("profile", self.write_session(), "--frames", "2").stdout.splitlines()
        self.assertTrue(any(line.startswith("pass ") and "median ms" in line for line in lines), lines)
        self.assertTrue(any(line.startswith("raycast") for line in lines), lines)

    def test_wrong_usage(self):
        session = self.write_session()
        self.check_refused("profile", status=2, says=["INPUT"])
        self.check_refused("profile", session, "--frames", "0", status=2)
        self.check_refused("profile", session, "--graph", "graph.pdf", status=2, says=[".svg"])


class SessionOfWork(CliTest):
    """A small scene whose bricks are paged, turned and painted."""

    LINES = [{"op": "orbit", "right_degrees": 30, "up_degrees": -10},
             {"op": "paint", "brush": "fill", "region": "ball", "group": 3, "threshold": 0, "radius": 3,
              "path": [[20, 20, 20]]},
             {"op": "undo"},
             {"op": "set", "values": {"light": {"ambient": 0.45}}}]
    PAINTED = [0, 136, -136, 0]  # the voxels whose centres, at halves, lie within 3 of a corner

    def write_work(self):
        project = self.folder / "project"
        (project / "shvr").mkdir(parents=True)
        self.write_session("project/shvr/session.json", volume={"procedural": "tubes", "size": [96, 96, 96]},
                           render={"size": [64, 48], "paging": "always"})
        script = self.folder / "work.jsonl"
        script.write_text("".join(json.dumps(line) + "\n" for line in self.LINES))
        return project, script

    def test_counts_are_exact_and_every_form_says_the_same(self):
        project, script = self.write_work()
        paths = {key: self.folder / f"session.{key}" for key in ("csv", "html")}
        paths["trace"] = self.folder / "trace.json"
        profile = self.check_json("profile", project, "--script", script, "--budget-device", 64,
                                  *(word for key, path in paths.items() for word in (f"--{key}", path)))
        actions = profile["actions"]
        self.assertEqual([one["action"] for one in actions], [line["op"] for line in self.LINES])
        self.assertEqual([one["line"] for one in actions], [1, 2, 3, 4])
        self.assertEqual([one["voxels_painted"] for one in actions], self.PAINTED)
        self.assertEqual([one["paint_ms"] is not None for one in actions], [voxels != 0 for voxels in self.PAINTED])
        for one in actions:
            self.assertGreaterEqual(one["sketch_ms"], one["paint_ms"] or 0)
            self.assertGreaterEqual(one["sharp_ms"], one["sketch_ms"])
            self.assertGreaterEqual(one["end_ms"] - one["begin_ms"], one["sharp_ms"])
            self.assertGreater(one["submits"], 0, one)
        for key in ("submits", "allocations", "uploads", "evictions", "voxels_painted"):
            self.assertEqual(profile["totals"][key], sum(one[key] for one in actions), key)
        sharp = sorted(one["sharp_ms"] for one in actions)
        self.assertEqual((profile["sharp_ms"]["min"], profile["sharp_ms"]["max"]), (sharp[0], sharp[-1]))
        self.assertEqual(profile["device_budget"], 64 << 20)
        self.assertLessEqual(profile["bytes"]["peak_device"], 64 << 20)

        with open(paths["csv"], newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([int(row["submits"]) for row in rows], [one["submits"] for one in actions])
        self.assertEqual([row["paint_ms"] == "" for row in rows], [one["paint_ms"] is None for one in actions])
        events = json.loads(paths["trace"].read_text())["traceEvents"]
        spans = [event for event in events if event["ph"] == "X"]
        self.assertEqual([event["args"] for event in spans], actions)
        for before, after in zip(spans, spans[1:]):
            self.assertLessEqual(before["ts"] + before["dur"], after["ts"] + 1e-3)
        page = paths["html"].read_text()
        self.assertNotRegex(page, r'(src|href)="(?!data:)')
        for one in actions:
            self.assertIn(f"<title>{one['line']}: {one['action']}, sharp after ", page)
            self.assertIn(f"<td>{one['device_bytes']}</td>", page)

    def test_people_read_a_table_of_actions(self):
        project, script = self.write_work()
        text = self.check("profile", project, "--script", script).stdout
        for words in (r"(?m)^1 +orbit +- ", r"(?m)^2 +paint +[0-9.]+ ", r"(?m)^to sharp ", r"(?m)^allocations +[0-9]+$"):
            self.assertRegex(text, words)

    def test_wrong_scripts_are_refused(self):
        project, script = self.write_work()
        self.check_refused("profile", project, "--script", script, "--graph", self.folder / "a.dot", status=2)
        script.write_text("\n")
        self.check_refused("profile", project, "--script", script, says=["holds no action"])
        script.write_text('{"op":"look_from","camera":"nowhere"}\n')
        self.check_refused("profile", project, "--script", script, says=["work.jsonl:1", "nowhere"])


class Diff(CliTest):
    def write_profile(self, name, passes, frame=10.0, samples=100):
        rows = [{"name": one, "median_ms": median, "min_ms": None if median is None else median - noise,
                 "p95_ms": None if median is None else median + noise} for one, median, noise in passes]
        return self.write_json(name, {"passes": rows, "frame_median_ms": frame, "frame_min_ms": frame - 0.1,
                                      "frame_p95_ms": frame + 0.1, "counters": {"samples": samples}})

    def test_every_verdict(self):
        a = self.write_profile("a.json", [("steady", 5.0, 0.3), ("sped", 4.0, 0.1), ("slowed", 2.0, 0.1),
                                          ("dropped", 1.0, 0.1), ("untimed", None, 0)])
        b = self.write_profile("b.json", [("steady", 5.2, 0.3), ("sped", 2.0, 0.1), ("slowed", 3.0, 0.1),
                                          ("added", 1.0, 0.1), ("untimed", None, 0)], frame=9.0, samples=90)
        diff = self.check_json("profile", "diff", a, b)
        rows = {row["name"]: row for row in diff["passes"]}
        self.assertEqual({name: row["verdict"] for name, row in rows.items()},
                         {"steady": "same", "sped": "faster", "slowed": "slower", "dropped": "gone", "added": "new",
                          "untimed": "same"})
        self.assertAlmostEqual(rows["sped"]["delta_ms"], -2.0)
        self.assertAlmostEqual(rows["sped"]["ratio"], 0.5)
        self.assertAlmostEqual(rows["sped"]["noise_ms"], 0.02 ** 0.5)
        self.assertEqual(diff["frame"]["verdict"], "faster")
        self.assertEqual(diff["counters"], [{"name": "samples", "a": 100, "b": 90, "delta": -10}])
        text = self.check("profile", "diff", a, b).stdout
        for word in ("faster", "slower", "gone", "new", "same"):
            self.assertIn(word, text)

    def test_a_profile_does_not_differ_from_itself(self):
        profile = self.folder / "a.json"
        profile.write_text(self.check("profile", self.write_session(), "--frames", "2", "--json").stdout)
        diff = self.check_json("profile", "diff", profile, profile)
        self.assertEqual({row["verdict"] for row in diff["passes"] + [diff["frame"]]}, {"same"})
        self.assertEqual({row["delta"] for row in diff["counters"]}, {0})

    def test_what_is_no_profile_is_refused(self):
        good = self.write_profile("good.json", [("a", 1.0, 0.1)])
        (self.folder / "text.json").write_text("hello")
        self.check_refused("profile", "diff", good, self.folder / "text.json", says=["text.json"])
        for name, value in [("list.json", []), ("empty.json", {}), ("nameless.json", {"passes": [{}]}),
                            ("number.json", {"passes": [{"name": "a", "median_ms": "fast"}]})]:
            self.check_refused("profile", "diff", good, self.write_json(name, value), says=[name])
        self.check_refused("profile", "diff", good, self.folder / "none.json", says=["none.json"])
        self.check_refused("profile", "diff", good, status=2)

    def test_deep_nesting_is_refused_in_one_sentence(self):
        good = self.write_profile("good.json", [("a", 1.0, 0.1)])
        deep = self.folder / "deep.json"
        for text in ("[" * 10_000_000, "[" * 50_000 + "]" * 50_000, '{"a":' * 50_000 + "1" + "}" * 50_000,
                     '{"counters":' + "[" * 17 + "]" * 17 + "}"):
            deep.write_text(text)
            self.check_refused("profile", "diff", deep, good, says=["deep.json: JSON nests deeper than 16 levels;"])
        # As deep as it may be, it is refused for what it lacks.
        deep.write_text('{"counters":' + "[" * 16 + "]" * 16 + "}")
        self.check_refused("profile", "diff", good, deep, says=["deep.json: the list 'passes' is missing"])


if __name__ == "__main__":
    unittest.main()
