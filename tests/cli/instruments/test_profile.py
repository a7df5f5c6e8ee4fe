"""shvr profile: times, traces, tables and graphs."""
import copy
import csv
import json
import re
import shutil
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree
from pathlib import Path

from harness import ENVIRONMENT, SHVR, CliTest, Volume, run

KEYS = ["passes", "first_frame", "frame_median_ms", "sum_median_ms", "counters", "bytes", "device", "driver"]
PASS_KEYS = ["name", "count", "min_ms", "median_ms", "p95_ms", "max_ms", "record_min_ms", "record_median_ms",
             "record_p95_ms", "bytes", "dispatches", "barrier"]
FRAMES = 5
# What ui.perfetto.dev and chrome://tracing need of an event of each phase (the trace event format), and its type.
NUMBER = (int, float)
EVENT_KEYS = {"M": {"name": str, "pid": int, "tid": int, "args": dict},
              "X": {"name": str, "cat": str, "pid": int, "tid": int, "ts": NUMBER, "dur": NUMBER, "args": dict},
              "C": {"name": str, "pid": int, "ts": NUMBER, "args": dict},
              "s": {"name": str, "cat": str, "id": int, "pid": int, "tid": int, "ts": NUMBER},
              "f": {"name": str, "cat": str, "id": int, "pid": int, "tid": int, "ts": NUMBER, "bp": str}}
SAME = 1e-3  # microseconds, of rounding


def trace_errors(trace):
    """What is wrong with a trace: keys and types, order, spans that cross, arrows that begin or end nowhere, rows and
    processes without a name."""
    errors, spans, arrows, named, last = [], {}, {}, set(), None
    if set(trace) - {"traceEvents", "displayTimeUnit", "otherData"} or trace.get("displayTimeUnit") not in ("ms", "ns"):
        errors.append("keys of the trace")
    for event in trace["traceEvents"]:
        keys = EVENT_KEYS.get(event.get("ph"), {})
        wrong = [key for key, kind in keys.items() if not isinstance(event.get(key), kind)]
        if not keys or wrong or set(event) - set(keys) - {"ph"}:
            errors.append(f"event {event}: {wrong}")
            continue
        if event["ph"] == "M":
            named.add((event["name"], event["pid"], event["tid"] if event["name"] == "thread_name" else None))
            if last is not None or not isinstance(event["args"].get("name"), str):
                errors.append(f"{event} is not a name before all events")
            continue
        if last is not None and event["ts"] < last:
            errors.append(f"{event} is earlier than the event before")
        last = event["ts"]
        if event["ph"] == "X":
            spans.setdefault((event["pid"], event["tid"]), []).append(event)
            if event["dur"] < 0:
                errors.append(f"{event} ends before it begins")
        elif event["ph"] == "C":
            if not event["args"] or not all(isinstance(value, NUMBER) for value in event["args"].values()):
                errors.append(f"{event} counts what is no number")
        else:
            arrows.setdefault((event["cat"], event["id"]), []).append(event)
    for row, events in spans.items():
        if ("thread_name", *row) not in named or ("process_name", row[0], None) not in named:
            errors.append(f"row {row} has no name")
        open_until = []
        for event in sorted(events, key=lambda event: (event["ts"], -event["dur"])):
            while open_until and open_until[-1] <= event["ts"] + SAME:
                open_until.pop()
            end = event["ts"] + event["dur"]
            if open_until and end > open_until[-1] + SAME:
                errors.append(f"{event} crosses the end of what it is in")
            open_until.append(end)
    for key, events in arrows.items():
        if [event["ph"] for event in events] != ["s", "f"]:
            errors.append(f"arrow {key}: {events}")
        for event in events:
            within = spans.get((event["pid"], event["tid"]), [])
            if not any(one["ts"] <= event["ts"] + SAME and event["ts"] <= one["ts"] + one["dur"] + SAME
                       for one in within):
                errors.append(f"{event} is at no span")
    return errors


def contrast(a, b):
    """Of two colours #rrggbb or #rgb, from 1 to 21 (WCAG 2)."""
    def luminance(color):
        digits = color[1:] if len(color) == 7 else "".join(2 * digit for digit in color[1:])
        parts = [int(digits[i:i + 2], 16) / 255 for i in (0, 2, 4)]
        linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    dark, light = sorted((luminance(a), luminance(b)))
    return (light + 0.05) / (dark + 0.05)


def grouped(number):
    """As pages write integers: three digits, a narrow space."""
    return f"{number:,}".replace(",", "\u202f")


class Profile(CliTest):
    @classmethod
    def setUpClass(cls):
        """One profile, and all its files."""
        folder = tempfile.TemporaryDirectory(prefix="shvr-profile-")
        cls.addClassCleanup(folder.cleanup)
        one = cls("test_keys_and_counts")
        one.folder = Path(folder.name)
        cls.paths = {option: one.folder / name for option, name in
                     (("trace", "trace.json"), ("csv", "times.csv"), ("graph", "graph.json"), ("html", "profile.html"))}
        cls.whole = one.profile(*(word for option, path in cls.paths.items() for word in (f"--{option}", path)))

    def profile(self, *arguments):
        return self.check_json("profile", self.write_session(), "--frames", FRAMES, *arguments)

    def test_keys_and_counts(self):
        profile = self.whole
        self.assertEqual(sorted(profile["written"]), sorted(map(str, self.paths.values())))
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
        profile = self.whole
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
        profile, page = self.whole, self.paths["html"].read_text()
        self.assertNotRegex(page, r'(src|href)="(?!data:)')
        # In the chart of all frames and, enlarged, in that of the median one.
        for one in profile["passes"]:
            self.assertEqual(page.count(f"<title>{one['name']}, frame "), one["count"] + 1, one["name"])
            self.assertEqual(page.count(f"<title>recording {one['name']}, frame "), one["count"] + 1, one["name"])
            self.assertAlmostEqual(one["gb_per_s"], one["bytes"] / one["median_ms"] / 1e6)
        self.assertEqual(page.count("<title>frame "), FRAMES + 1)
        for name in profile["bytes"]["by_resource"]:
            self.assertIn(f"<td>{name}</td>", page)
        self.assertIn("<polyline", page)
        # A colour of its own for each pass, in the table as in the charts, and words that can be read on it.
        colors = re.findall(r'swatch" style="background:(#[0-9a-f]{6})', page)
        self.assertEqual(len(set(colors)), len(profile["passes"]))
        self.assertGreaterEqual(len(colors), 2)
        for color, one in zip(colors, profile["passes"]):
            self.assertEqual(page.count(f'fill="{color}"><title>{one["name"]}, frame '), one["count"] + 1)
        written = re.findall(r'fill="(#[0-9a-f]{6})"><title>[^<]*</title></rect>\n<text class="on" style="fill:(#\w+)',
                             page)
        self.assertIn((colors[0], "#fff"), written)
        for color, ink in written:
            self.assertGreaterEqual(contrast(color, ink), 4.5, (color, ink))
        self.assertIn(f"prepares: {len(profile['first_frame'])} passes", page)
        self.assertGreater(len(profile["first_frame"]), len(profile["passes"]))
        for one in profile["first_frame"]:
            self.assertIn(f"<td>{one['name']}</td>", page)
        self.assertIn(f"<td>{grouped(profile['invocations']['raycast'])}</td>", page)
        self.assertIn(f"<td>device, budget</td><td>{grouped(profile['memory']['device_budget'])}</td>", page)
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
        self.assertEqual(self.whole["counters"], picture["counters"])

    def test_the_trace_is_one_that_perfetto_reads(self):
        profile, trace = self.whole, json.loads(self.paths["trace"].read_text())
        self.assertEqual(trace_errors(trace), [])
        events = trace["traceEvents"]
        self.assertEqual({event["ph"] for event in events}, {"M", "X", "C", "s", "f"})
        names = {event["args"]["name"] for event in events if event["name"] == "process_name"}
        self.assertEqual(len(names), 2)

        def spans(category):
            return [event["name"] for event in events if event["ph"] == "X" and event["cat"] == category]
        passes = [one["name"] for one in profile["passes"]]
        self.assertEqual(spans("pass"), passes * FRAMES)
        # In each frame the host records what the device then does.
        self.assertEqual(spans("frame"), [name for frame in range(FRAMES)
                                          for name in [f"frame {frame}", *(f"record {one}" for one in passes)]])
        self.assertEqual(sum(event["ph"] == "s" for event in events), FRAMES)

    def test_recording_is_timed_beside_the_device(self):
        profile = self.whole
        with open(self.paths["csv"], newline="") as file:
            rows = list(csv.DictReader(file))
        for one in profile["passes"]:
            self.assertGreater(one["record_min_ms"], 0)
            self.assertLessEqual(one["record_min_ms"], one["record_median_ms"])
            self.assertLessEqual(one["record_median_ms"], one["record_p95_ms"])
            records = sorted(float(row["record_ms"]) for row in rows if row["pass"] == one["name"])
            self.assertAlmostEqual(records[FRAMES // 2], one["record_median_ms"], places=6)
            # A descriptor set and a few commands, not the work itself.
            self.assertLess(one["record_min_ms"], 0.5 * profile["frame_median_ms"] + 0.5)

    def test_passes_that_overlap_have_rows_of_their_own_and_a_sum_above_their_frame(self):
        # A layer whose clock goes on by 2000 ns for each group of threads, and starts passes 300000 ns early.
        path = self.folder / "trace.json"
        session = self.write_session(render={"size": [64, 48], "saturation": 0.3},
                                     surfaces=[{"from": [8, 8, 8], "to": [20, 20, 20], "radius": 3, "color": "#ff4020"}])
        done = run("profile", session, "--frames", 2, "--trace", path, "--json",
                   environment={"VK_INSTANCE_LAYERS": "VK_LAYER_SHVR_clocks", "SHVR_CLOCKS": "2000",
                                "SHVR_CLOCKS_EARLY": "300000"})
        self.assertEqual(done.returncode, 0, done.stderr)
        profile = json.loads(done.stdout)
        self.assertEqual([(one["name"], round(one["median_ms"], 6)) for one in profile["passes"]],
                         [("surface_tiles", 0.302), ("surfaces", 0.396), ("raycast", 0.396), ("saturation", 0.396),
                          ("read back color", 0.3)])
        self.assertAlmostEqual(profile["sum_median_ms"], 0.302 + 3 * 0.396 + 0.3)
        trace = json.loads(path.read_text())
        self.assertEqual(trace_errors(trace), [])
        rows = {}
        for event in trace["traceEvents"]:
            if event["ph"] == "X" and event["pid"] == 2:
                rows.setdefault(event["name"], []).append(event)
        self.assertEqual([len({event["tid"] for event in events}) for events in rows.values()], [1] * 5)
        self.assertEqual(len({events[0]["tid"] for events in rows.values()}), 5)
        first = [events[0] for events in rows.values()]
        whole = first[-1]["ts"] + first[-1]["dur"] - first[0]["ts"]
        self.assertAlmostEqual(whole, 2 + 3 * 96 + 300, places=3)  # less than the sum of 1790

    def test_a_trace_that_is_wrong_is_found_to_be(self):
        good = json.loads(self.paths["trace"].read_text())

        def broken(change):
            trace = json.loads(json.dumps(good))
            change(trace["traceEvents"])
            return trace_errors(trace)

        def of(events, phase):
            return next(event for event in events if event["ph"] == phase)
        self.assertTrue(broken(lambda events: of(events, "X").pop("dur")))
        self.assertTrue(broken(lambda events: of(events, "X").update(ts="1")))
        def cross(events):  # what is recorded in a frame ends after it
            frame = next(event for event in events if event["name"] == "frame 0")
            next(event for event in events if event["name"].startswith("record ")).update(dur=frame["dur"] + 1)
        self.assertTrue(broken(cross))
        self.assertTrue(broken(lambda events: events.remove(of(events, "f"))))
        self.assertTrue(broken(lambda events: of(events, "s").update(ts=-50)))
        self.assertTrue(broken(lambda events: events.pop(1)))
        self.assertTrue(broken(lambda events: events.reverse()))
        self.assertTrue(broken(lambda events: of(events, "C").update(args={"bytes": "many"})))

    def test_the_table_has_a_row_per_frame_and_pass(self):
        profile = self.whole
        with open(self.paths["csv"], newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), FRAMES * len(profile["passes"]))
        for one in profile["passes"]:
            times = sorted(float(row["gpu_ms"]) for row in rows if row["pass"] == one["name"])
            self.assertAlmostEqual(times[0], one["min_ms"], places=6)
            self.assertAlmostEqual(times[FRAMES // 2], one["median_ms"], places=6)
            self.assertAlmostEqual(times[-1], one["max_ms"], places=6)

    def test_the_graph_as_json_holds_the_passes_that_ran(self):
        profile, graph = self.whole, json.loads(self.paths["graph"].read_text())
        alive = [one["name"] for one in graph["passes"] if one["alive"]]
        self.assertEqual(alive, [one["name"] for one in profile["passes"]])
        resources = {one["name"]: one for one in graph["resources"]}
        self.assertTrue(resources["atlas"]["imported"])
        self.assertIsNone(resources["cell ranges"]["lifetime"])  # only the leap grid reads it

    def test_budgets_are_shares_of_the_memory_that_a_process_was_given(self):
        limit = 4 << 30
        header = Volume.noise((12, 10, 8), seed=4).write(self.folder)
        result = subprocess.run(["prlimit", f"--as={limit}", SHVR, "profile", header, "--frames", "1", "--json", "--quiet"],
                                capture_output=True, text=True, check=False, env=ENVIRONMENT)
        self.assertEqual(result.returncode, 0, result.stderr)
        memory = json.loads(result.stdout)["memory"]
        self.assertEqual((memory["device_budget"], memory["host_budget"]), (limit // 4, limit // 2))

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
        # A sketch comes before the sharp picture, and each action has its own submissions: undoing takes fewer than turning.
        self.assertTrue(any(one["sketch_ms"] < one["sharp_ms"] for one in actions))
        self.assertLess(actions[2]["submits"], actions[0]["submits"])
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
        self.assertEqual(trace_errors(json.loads(paths["trace"].read_text())), [])
        spans = [event for event in events if event["ph"] == "X"]
        self.assertEqual([event["args"] for event in spans],
                         [{key: value for key, value in one.items() if key != "over_replays"} for one in actions])
        self.assertEqual(sum(event["ph"] == "C" for event in events), len(actions))
        page = paths["html"].read_text()
        self.assertNotRegex(page, r'(src|href)="(?!data:)')
        for one in actions:
            self.assertIn(f"<title>{one['line']}: {one['action']}, sharp after ", page)
            self.assertIn(f"<td>{grouped(one['device_bytes'])}</td>", page)
        self.assertIn("<polyline", page)
        self.assertIn("Done once", page)

    def test_replays_begin_with_the_same_work_and_leave_that_of_one(self):
        project, script = self.write_work()
        script.write_text("".join(json.dumps(line) + "\n" for line in self.LINES[:2]))
        trace, table, page = self.folder / "trace.json", self.folder / "work.csv", self.folder / "work.html"
        before = set(Path(tempfile.gettempdir()).glob("shvr-replays-*"))
        profile = self.check_json("profile", project, "--script", script, "--replays", 3, "--trace", trace, "--csv",
                                  table, "--html", page)
        self.assertEqual(set(Path(tempfile.gettempdir()).glob("shvr-replays-*")), before)
        self.assertEqual(profile["replays"], 3)
        self.assertEqual([one["voxels_painted"] for one in profile["actions"]], self.PAINTED[:2])
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([(row["replay"], row["action"]) for row in rows],
                         [(str(replay), line["op"]) for replay in (1, 2, 3) for line in self.LINES[:2]])
        # Each paints all of it: none saw what the others had done.
        self.assertEqual([int(row["voxels_painted"]) for row in rows], self.PAINTED[:2] * 3)
        for at, one in enumerate(profile["actions"]):
            for key in ("sketch_ms", "sharp_ms"):
                times = sorted(float(row[key]) for row in rows[at::2])
                spread = one["over_replays"][key]
                self.assertEqual([spread["min"], spread["median"], spread["max"]], times)
                self.assertEqual(one[key], times[1])
        sums = sorted(sum(float(row["sharp_ms"]) for row in rows[at:at + 2]) for at in (0, 2, 4))
        for found, expected in zip((profile["whole"]["sharp_ms"][key] for key in ("min", "median", "max")), sums):
            self.assertAlmostEqual(found, expected)
        self.assertEqual(trace_errors(json.loads(trace.read_text())), [])
        events = json.loads(trace.read_text())["traceEvents"]
        self.assertEqual(sorted(event["tid"] for event in events if event["ph"] == "X"), [1, 1, 2, 2, 3, 3])
        self.assertIn("Done 3 times", page.read_text())
        # The work has it once, in its journal: there is one step to take back.
        shown = self.check_json("profile", project, "--script", self.write_script("undo.jsonl", [{"op": "undo"}]))
        self.assertEqual(shown["actions"][0]["voxels_painted"], -136)

    def test_a_script_that_fails_in_a_replay_leaves_the_work_as_it_was(self):
        project, script = self.write_work()
        script.write_text(json.dumps(self.LINES[1]) + '\n{"op":"look_from","camera":"nowhere"}\n')
        said = self.check_refused("profile", project, "--script", script, "--replays", 2, says=["work.jsonl:2", "nowhere"])
        self.assertIn("in a replay on a copy", said)
        shown = self.check_json("profile", project, "--script", self.write_script("orbit.jsonl", self.LINES[:1]))
        self.assertEqual(shown["totals"]["voxels_painted"], 0)
        self.assertFalse((project / "shvr/session.journal").exists())

    def with_times(self, profile, name, ms):
        """A profile as of a machine on which everything took so long, and a tenth more at most."""
        spread = {"min": ms, "median": 1.05 * ms, "p95": 1.1 * ms, "max": 1.1 * ms}
        timed = copy.deepcopy(profile)
        for times in [*(one["over_replays"] for one in timed["actions"]), timed["whole"]]:
            times.update({key: dict(spread) for key, found in times.items() if found is not None})
        path = self.folder / name
        path.write_text(json.dumps(timed))
        return path

    def test_a_diff_of_sessions_tells_what_changed_beyond_the_noise(self):
        project, script = self.write_work()
        # As of three replays, each of which takes the times that `with_times` gives.
        profile = {**self.check_json("profile", project, "--script", script), "replays": 3}
        before, after, almost = (self.with_times(profile, name, ms)
                                 for name, ms in (("before", 10), ("after", 20), ("almost", 11)))
        diff = self.check_json("profile", "diff", before, after)
        self.assertEqual([one["action"] for one in diff["actions"]], [line["op"] for line in self.LINES])
        self.assertEqual(diff["actions"][0]["sharp_ms"]["verdict"], "slower")
        self.assertEqual({row["name"]: row["verdict"] for row in diff["session"]}["to sharp"], "slower")
        text = self.check("profile", "diff", before, after).stdout
        self.assertRegex(text, r"(?m)^1: orbit to sharp .* slower$")
        self.assertRegex(self.check("profile", "diff", after, before).stdout, r"(?m)^1: orbit to sharp .* faster$")
        same = self.check_json("profile", "diff", before, almost)
        verdicts = {one[key]["verdict"] for one in same["actions"] for key in ("paint_ms", "sketch_ms", "sharp_ms")}
        self.assertEqual(verdicts | {row["verdict"] for row in same["session"]}, {"same"})
        self.assertEqual({row["delta"] for row in same["counters"] + same["memory"]}, {0})

    def test_people_read_a_table_of_actions(self):
        project, script = self.write_work()
        text = self.check("profile", project, "--script", script).stdout
        for words in (r"(?m)^1 +orbit +- ", r"(?m)^2 +paint +[0-9.]+ ", r"(?m)^to sharp ", r"(?m)^allocations +[0-9]+$"):
            self.assertRegex(text, words)

    def test_wrong_scripts_are_refused(self):
        project, script = self.write_work()
        self.check_refused("profile", project, "--script", script, "--graph", self.folder / "a.dot", status=2)
        self.check_refused("profile", project, "--replays", 2, status=2, says=["--script"])
        script.write_text("\n")
        self.check_refused("profile", project, "--script", script, says=["holds no action"])
        script.write_text('{"op":"look_from","camera":"nowhere"}\n')
        self.check_refused("profile", project, "--script", script, says=["work.jsonl:1", "nowhere"])


class Diff(CliTest):
    def write_profile(self, name, passes, frame=10.0, samples=100, frames=20):
        rows = [{"name": one, "count": frames, "median_ms": median, "min_ms": None if median is None else median - noise,
                 "p95_ms": None if median is None else median + noise} for one, median, noise in passes]
        return self.write_json(name, {"passes": rows, "frames": frames, "frame_median_ms": frame,
                                      "frame_min_ms": frame - 0.1, "frame_p95_ms": frame + 0.1,
                                      "counters": {"samples": samples}, "bytes": {"device": samples * 1000}})

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
        self.assertEqual(diff["memory"], [{"name": "device", "a": 100000, "b": 90000, "delta": -10000}])
        text = self.check("profile", "diff", a, b).stdout
        for word in ("faster", "slower", "gone", "new", "same"):
            self.assertIn(word, text)

    def test_few_frames_have_more_noise_and_two_have_none(self):
        def verdict(frames):
            a = self.write_profile("a.json", [("pass", 4.0, 0.1)], frames=frames)
            b = self.write_profile("b.json", [("pass", 4.3, 0.1)], frames=frames)
            row = self.check_json("profile", "diff", a, b)["passes"][0]
            return row["verdict"], row["noise_ms"]
        self.assertEqual(verdict(20)[0], "slower")
        self.assertEqual(verdict(3)[0], "same")
        self.assertGreater(verdict(3)[1], 5 * verdict(20)[1])
        self.assertEqual(verdict(2), ("unknown", None))
        text = self.check("profile", "diff", self.folder / "a.json", self.folder / "b.json").stdout
        self.assertIn("fewer than 3 times", text)

    def test_a_profile_does_not_differ_from_itself(self):
        profile = self.folder / "a.json"
        profile.write_text(self.check("profile", self.write_session(), "--frames", "3", "--json").stdout)
        diff = self.check_json("profile", "diff", profile, profile)
        self.assertEqual({row["verdict"] for row in diff["passes"] + diff["recording"] + [diff["frame"]]}, {"same"})
        self.assertEqual({row["delta"] for row in diff["counters"]}, {0})

    def test_what_is_no_profile_is_refused(self):
        good = self.write_profile("good.json", [("a", 1.0, 0.1)])
        (self.folder / "text.json").write_text("hello")
        self.check_refused("profile", "diff", good, self.folder / "text.json", says=["text.json"])
        for name, value in [("list.json", []), ("empty.json", {}), ("nameless.json", {"passes": [{}]}),
                            ("number.json", {"passes": [{"name": "a", "median_ms": "fast"}]})]:
            self.check_refused("profile", "diff", good, self.write_json(name, value), says=[name])
        self.check_refused("profile", "diff", good, self.folder / "none.json", says=["none.json"])
        # Profiles of a session must be complete, and are never compared with profiles of frames.
        action = {"line": 1, "action": "orbit", "over_replays": {}}
        self.check_refused("profile", "diff", good, self.write_json("s.json", {"actions": []}),
                           says=["s.json", "expected two of one kind"])
        for name, value, says in [("list.json", {"actions": 3}, "'actions' is no list"),
                                  ("bare.json", {"actions": [action]}, "'replays' is not a number"),
                                  ("lacks.json", {"actions": [action], "replays": 3}, "'paint_ms' is missing"),
                                  ("nameless.json", {"actions": [{}]}, "'action' is missing")]:
            path = self.write_json(name, value)
            self.check_refused("profile", "diff", path, path, says=[name, says])
        other = self.write_json("other.json", {"actions": [{**action, "action": "paint"}], "replays": 3})
        self.check_refused("profile", "diff", self.folder / "lacks.json", other, says=["expected profiles of one script"])
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
