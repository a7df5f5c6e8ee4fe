"""Scripts from pipes, what a run prints, undoing too much, Ctrl-C, and the example of the help."""
import json
import os
import re
import signal
import subprocess
import time
import unittest
from pathlib import Path

from harness import ENVIRONMENT, PROGRESS, SHVR, CliTest, Volume, run
from test_annotate import paint

PATIENCE_S = 60
STOP_IN_SAVE = Path(SHVR).resolve().parent / "stubs" / "libstop_in_save.so"


class Script(CliTest):
    def setUp(self):
        super().setUp()
        name = Volume((8, 8, 8), [100] * 512).write(self.folder).name
        self.session = self.write_session(volume={"path": name})

    def annotate(self, operations, *arguments, status=0):
        script = self.write_script("script.jsonl", operations)
        return self.check("annotate", self.session, "--script", script, *arguments, status=status)

    def dab(self, group):
        return paint("fill", "box", group, 50, 0.4, [[group + 0.5, 1.5, 1.5]])

    def pipe(self, text, script="-", **options):
        return subprocess.run([SHVR, "annotate", self.session, "--script", script], input=text, capture_output=True,
                              text=True, timeout=PATIENCE_S, env=ENVIRONMENT, **options)

    def test_a_session_without_a_name_for_the_mask_is_refused_before_a_script_that_saves_does_anything(self):
        session = self.write_session(name="scan.json", annotation={})
        dab = {"op": "paint", "brush": "fill", "region": "ball", "path": [[12, 12, 12]], "radius": 3, "threshold": 0,
               "group": 3}
        script = self.write_script("s.jsonl", [dab, {"op": "save"}])
        self.check_refused("annotate", session, "--script", script, says=[
            "scan.json: names no file for the mask, which ", "s.jsonl:2 saves; expected the key annotation.mask, as in ",
            "--set annotation.mask=scan.labels.zarr"])
        self.assertFalse((self.folder / "scan.journal").exists())
        self.check("annotate", session, "--script", script, "--set", "annotation.mask=scan.labels.zarr")
        self.assertTrue((self.folder / "scan.labels.zarr" / ".zattrs").exists())
        # Without a save nothing is missing.
        self.check("annotate", session, "--script", self.write_script("t.jsonl", [dab]))

    def test_a_script_comes_from_standard_input_or_a_pipe(self):
        text = json.dumps(self.dab(1)) + "\n" + json.dumps({"op": "expect", "voxels_in_group": {"1": 1}}) + "\n"
        result = self.pipe(text)
        self.assertEqual((result.returncode, result.stdout), (0, ""), result.stderr)
        self.assertIn("standard input: 2 commands, 1 voxel changed, 1 step not saved", result.stderr)
        wrong = self.pipe(text + '{"op":"pant"}\n')  # checked as a whole
        self.assertEqual(wrong.returncode, 1)
        self.assertIn("shvr: standard input:3: key op", wrong.stderr)
        fifo = self.folder / "fifo"
        os.mkfifo(fifo)
        writer = subprocess.Popen(["sh", "-c", f"cat > {fifo}"], stdin=subprocess.PIPE, text=True)
        writer.stdin.write(json.dumps(self.dab(2)) + "\n")
        writer.stdin.close()
        self.check("annotate", self.session, "--script", fifo)
        writer.wait()
        self.annotate([{"op": "expect", "voxels_in_group": {"1": 1, "2": 1, "3": 0}}])
        self.assertEqual(self.pipe("").returncode, 0)

    def test_a_line_a_command_only_where_it_is_asked_for(self):
        operations = [self.dab(1), {"op": "node", "at": [1, 1, 1]}, {"op": "save"}]
        said = [line for line in self.annotate(operations).stderr.splitlines()
                if not line.startswith("warning: ") and not PROGRESS.search(line)]
        self.assertEqual([line.split(": ", 1)[1] for line in said],
                         [f"saved {self.folder / 'paint.mask'}", f"saved {self.folder / 'paint.graphml'}",
                          "3 commands, 1 voxel changed, 0 steps not saved"])
        self.assertEqual(self.annotate([self.dab(2)], "--quiet").stderr, "")
        said = self.annotate(operations, "--verbose").stderr
        self.assertIn("script.jsonl:1: The stroke changed nothing: no voxel here is at or above the paint threshold, or "
                      "all are painted already", said)
        self.assertIn("script.jsonl:2: node 1 in group 1", said)

    def test_undo_of_more_than_there_is_undoes_nothing(self):
        for what, back in (("undo", "redo"), ("redo", "undo")):
            self.annotate([self.dab(1), self.dab(2)] + ([{"op": "undo", "count": 2}] if what == "redo" else []), "--fresh")
            said = self.annotate([{"op": what, "count": 3}], status=1).stderr
            self.assertIn(f"script.jsonl:1: key count is 3; expected at most 2, the steps there are to {what}", said)
            painted = 0 if what == "redo" else 1
            self.annotate([{"op": "expect", "voxels_in_group": {"1": painted, "2": painted}}, {"op": what, "count": 2},
                           {"op": "expect", "voxels_in_group": {"1": 1 - painted}}, {"op": back, "count": 2}])

    # Kind (Values): painting next to fill values of any share
    def test_fill_values_of_any_share_take_no_voxel_from_paint_and_are_told(self):
        random = [(i * 7919) % 200 for i in range(20 * 20 * 20)]
        for voxel_type, fill, every in [("int32", -2147483648, 12), ("float", -3.4e38, 3), ("float", 1e7, 500)]:
            with self.subTest(voxel_type=voxel_type, fill=fill):
                values = [fill if i % every == 0 else value for i, value in enumerate(random)]
                name = Volume((20, 20, 20), values, voxel_type=voxel_type).write(self.folder).name
                self.session = self.write_session(volume={"path": name})
                right = sum(value >= 60 for value in values)
                said = self.annotate([paint("fill", "box", 3, 60, 40, [[10, 10, 10]]),
                                      {"op": "expect", "voxels_in_group": {"3": right}}], "--fresh").stderr
                self.assertIn("far outside all others: it is taken for a fill value", said)
                info = self.check_json("info", self.session)
                self.assertEqual(info["fill_values"][0]["voxels"], values.count(fill))
                self.assertEqual(sum(info["histogram"]), len(values) - values.count(fill))
                info = self.check_json("info", self.session, "--set", "volume.nodata=none")
                self.assertEqual(info["fill_values"], [])
                info = self.check_json("info", self.session, "--set", "volume.nodata=7")
                self.assertEqual(info["fill_values"], [{"value": 7, "voxels": values.count(7)}])
                self.annotate([paint("fill", "box", 4, 60, 40, [[10, 10, 10]]),
                               {"op": "expect", "voxels_in_group": {"4": right}}], "--fresh",
                              "--set", "volume.nodata=none")

    def test_a_density_stroke_on_a_fresh_project_is_saved(self):
        project = self.folder / "project"
        self.check("import", Volume.noise((9, 8, 7), seed=1).write(self.folder, "other"), project)
        stroke = {"op": "density", "brush": "fill", "threshold": 0, "radius": 1.5, "path": [[4, 4, 3]], "offset": 5}
        script = self.write_script("script.jsonl", [stroke, {"op": "save"}])
        self.check("annotate", project, "--script", script)
        self.assertTrue((project / "shvr" / "paint.offsets.zarr" / "0" / ".zarray").exists())
        (project / "shvr" / "session.journal").unlink()
        raised = self.check_json("label", project, "--threshold", "0")["voxels_with_offset"]
        self.assertGreater(raised, 0)

    def test_a_stroke_by_hand_that_is_cut_ends_the_replay_at_its_line(self):
        session = self.write_session("large.json", volume={"procedural": "tubes", "size": [200] * 3},
                                     render={"size": [24, 16], "paging": "always"})
        strokes = [line for radius in (4, 50, 4) for line in (
            {"op": "set", "values": {"probe": {"brush": "fill", "radius_voxels": radius, "paint_threshold": 1}}},
            {"op": "place_probe", "voxel": [100, 100, 100]},
            {"op": "paint_here", "on": True}, {"op": "paint_here", "on": False})]
        script = self.write_script("strokes.jsonl", strokes)
        self.check_refused("annotate", session, "--actions", script, "--budget-device", 8, "--quiet",
                           says=["strokes.jsonl:8: ", "bricks", "; the rest of the stroke is not painted"])
        exported = self.check_json("export", session)
        self.assertEqual(exported["voxels_by_group"], {"1": 280})  # voxels whose centres, at halves, lie within 4 of a corner
        self.check("annotate", session, "--actions", script, "--quiet")  # as the budget is usually

    def test_a_transfer_function_is_kept_for_all_scans_and_preferences_stay(self):
        session = self.write_session("small.json", volume={"procedural": "tubes", "size": [16] * 3})
        settings = self.folder / "configuration" / "shvr"
        settings.mkdir(parents=True)
        (settings / "preferences.json").write_text("no JSON")   # of no concern to a replay
        script = self.write_script("keep.jsonl", [
            {"op": "keep_preset", "name": "vessels"}, {"op": "rename_preset", "name": "vessels", "to": "bundles of mine"},
            {"op": "prefer", "values": {"theme": "light"}}, {"op": "open", "path": str(session)}])
        replay = ["annotate", session, "--actions", script, "--quiet"]
        result = run(*replay, environment={"XDG_CONFIG_HOME": settings.parent})
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        kept, = (settings / "transfer_functions").iterdir()
        self.assertEqual(json.loads(kept.read_text())["points"][-1]["color"], "#ffe0c0")
        self.assertEqual((settings / "preferences.json").read_text(), "no JSON")
        result = run(*replay, environment={"XDG_CONFIG_HOME": "", "HOME": ""})
        self.assertEqual(result.returncode, 1)
        self.assertIn("keep.jsonl:1: no settings folder is known; expected HOME or XDG_CONFIG_HOME", result.stderr)

    def test_a_save_that_fails_ends_the_replay_at_its_line(self):
        session = self.write_session("small.json", volume={"procedural": "tubes", "size": [16] * 3})
        self.write_json("taken", {})
        for folder in ("taken", "missing"):
            script = self.write_script("saves.jsonl", [
                {"op": "save"}, {"op": "save_as", "path": str(self.folder / folder / "copy.json")}, {"op": "save"}])
            self.check_refused("annotate", session, "--actions", script, "--quiet",
                               says=["saves.jsonl:2: ", f"{folder} is no folder; expected one that exists"])
        self.assertFalse((self.folder / "missing").exists())

    def test_the_example_of_the_help_runs_with_and_without_its_undo(self):
        example = self.check("annotate", "--help").stdout.split("Example:\n")[1].splitlines()
        self.assertIn("shvr annotate scan/ --script strokes.jsonl", example[0])
        lines = [line for line in example if line.strip().startswith("{")]
        self.assertGreater(len(lines), 3)
        volume = Volume((64, 64, 32), [1300] * (64 * 64 * 32), voxel_type="uint16").write(self.folder, "other")
        for number, chosen in enumerate([lines, [line for line in lines if "undo" not in line]]):
            project = self.folder / f"project{number}"
            self.check("import", volume, project)
            script = self.folder / "strokes.jsonl"
            script.write_text("\n".join(chosen) + "\n")
            self.check("annotate", project, "--script", script)
            self.assertEqual((project / "shvr" / "paint.offsets.zarr").exists(), number == 1)


def catches(program, number):
    """Whether a process has a handler for a signal, as its status says: slow ones take a while to come to that."""
    try:
        status = Path(f"/proc/{program.pid}/status").read_text()
    except FileNotFoundError:
        return False
    return bool(int(re.search(r"SigCgt:\s*(\w+)", status)[1], 16) >> number - 1 & 1)


class Stopped(CliTest):
    """Ctrl-C and SIGTERM end every command in a sentence, and leave no half of a file."""

    def start(self, *arguments, **options):
        program = subprocess.Popen([SHVR, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, env=ENVIRONMENT, **options)
        self.addCleanup(program.communicate)
        self.addCleanup(program.kill)
        return program

    def check_stopped(self, program, number, says):
        program.send_signal(number)
        output, errors = program.communicate(timeout=PATIENCE_S)
        self.assertEqual(output, "")
        lines = [line for line in errors.splitlines() if not line.startswith("warning: ")]
        self.assertEqual(len([line for line in lines if line.startswith("shvr: ")]), 1, errors)
        self.assertRegex(errors, says)
        self.assertEqual([name for name in os.listdir(self.folder) if name.endswith((".tmp", ".lock"))], [])
        return program.returncode

    def wait_for(self, condition, program):
        end = time.monotonic() + PATIENCE_S
        while not condition():
            self.assertIsNone(program.poll())
            self.assertLess(time.monotonic(), end)
            time.sleep(0.005)

    def test_commands_that_write_at_the_end(self):
        session = self.write_session(volume={"procedural": "tubes", "size": [512, 512, 512]})
        large = self.write_session("large.json", volume={"procedural": "tubes", "size": [2048, 2048, 2048]})
        commands = [["info", session], ["label", large, "--threshold", "1", "-o", self.folder / "a.nrrd"],
                    ["render", session, "-o", self.folder / "a.png", "--size", "4000x4000"],
                    ["export", session, "--mask", self.folder / "a.mask"],
                    ["profile", session, "--frames", "100000"]]
        for command in commands:
            for number, name in ((signal.SIGINT, "Ctrl-C"), (signal.SIGTERM, "SIGTERM")):
                with self.subTest(command=command[0], signal=name):
                    program = self.start(*command)
                    self.wait_for(lambda: catches(program, number), program)
                    time.sleep(0.3)  # into its work
                    self.assertIsNone(program.poll())
                    status = self.check_stopped(program, number, f"shvr: stopped by {name}; no file is left half")
                    self.assertIn(status, (1, -number))  # by the signal where the work had not begun
        self.assertEqual(sorted(os.listdir(self.folder)), ["large.json", "session.json"])

    def test_annotate_ends_between_two_commands_and_says_where(self):
        session = self.write_session(volume={"procedural": "constant", "size": [48] * 3})
        operations = []
        for i in range(2000):  # far more than it can finish
            operations += [paint("fill", "box", i % 250 + 1, 1, 48, [[24] * 3]), {"op": "save"}]
        script = self.write_script("script.jsonl", operations)
        program = self.start("annotate", session, "--script", script, "--quiet")
        self.wait_for((self.folder / "paint.mask").exists, program)
        # The signal falls between two lines, or into one of the saves.
        status = self.check_stopped(program, signal.SIGINT, r":\d+: stopped (before this line; the |during this save; no file)")
        self.assertEqual(status, 1)
        said = self.check("annotate", session, "--script", self.write_script("s.jsonl", [])).stderr
        self.assertNotIn("are an incomplete or damaged record", said)
        self.assertEqual(len(set((self.folder / "paint.mask").read_bytes())), 1)

    # Kind (annotation files): Ctrl-C or SIGTERM while a dense mask or dense offsets are being saved.
    def test_a_dense_save_is_cut_off_and_leaves_the_old_file(self):
        (self.folder / "stopped").mkdir()
        raised = {"op": "density", "brush": "fill", "offset": 9, "radius": 3, "threshold": 0, "path": [[9, 9, 9]]}
        for name, key, stroke in (("a.mask", "mask", paint("fill", "box", 1, 0, 3, [[9, 9, 9]])),
                                  ("b.nrrd", "mask", paint("fill", "box", 2, 0, 3, [[9, 9, 9]])),
                                  ("c.tif", "mask", paint("fill", "box", 3, 0, 3, [[9, 9, 9]])),
                                  ("d.offset", "density", raised)):
            number = signal.SIGTERM if name == "b.nrrd" else signal.SIGINT
            with self.subTest(name=name):
                session = self.write_session(name + ".json", {"procedural": "constant", "size": [200, 200, 8]},
                                             annotation={"mask": name + ".labels.zarr", key: "stopped/" + name})
                save = self.write_script("save.jsonl", [{"op": "save"}])
                self.check("annotate", session, "--script", save)
                old = {path: path.read_bytes() for path in (self.folder / "stopped").iterdir()}
                both = self.write_script("both.jsonl", [stroke, {"op": "save"}])
                result = run("annotate", session, "--script", both, environment={
                    "LD_PRELOAD": str(STOP_IN_SAVE), "SHVR_STOP_SIGNAL": str(int(number)),
                    "ASAN_OPTIONS": "verify_asan_link_order=0"})
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn("both.jsonl:2: stopped during this save; no file is left half written, and the journal "
                              "has all commands", result.stderr)
                self.assertEqual({path: path.read_bytes() for path in (self.folder / "stopped").iterdir()}, old)
                self.check("annotate", session, "--script", save)  # which has the stroke, from the journal
                self.assertNotEqual((self.folder / "stopped" / name).read_bytes(),
                                    old.get(self.folder / "stopped" / name))

    def test_a_script_that_is_waited_for(self):
        session = self.write_session()
        program = self.start("annotate", session, "--script", "-", stdin=subprocess.PIPE)
        self.wait_for((self.folder / "session.journal.lock").exists, program)
        program.send_signal(signal.SIGINT)
        errors = program.communicate(timeout=PATIENCE_S)[1]
        self.assertIn("shvr: stopped by Ctrl-C", errors)


def fill_box(group, *at, radius=0.4):
    """One voxel, or a box of them."""
    return {"op": "paint", "brush": "fill", "region": "box", "group": group, "threshold": 0, "radius": radius,
            "path": [[c + 0.5 for c in at]]}


def expect_groups(**groups):
    return {"op": "expect", "voxels_in_group": {name[1:]: voxels for name, voxels in groups.items()}}


class OperationsOnGroups(CliTest):
    def prepare(self, size=(40, 20, 20), **keys):
        self.volume = Volume.noise(size, seed=4)
        self.session = self.write_session(volume={"path": self.volume.write(self.folder).name}, **keys)

    def annotate(self, operations):
        return self.check_json("annotate", self.session, "--script", self.write_script("script.jsonl", operations))

    def refused(self, line):
        script = self.write_script("script.jsonl", [line])
        return self.check("annotate", self.session, "--script", script, status=1).stderr.strip()

    def test_lines_of_the_contract(self):
        self.prepare()
        shell = [fill_box(3, 10, 10, 10, radius=2.2), fill_box(0, 10, 10, 10), fill_box(3, 30, 3, 3), fill_box(4, 35, 3, 3)]
        result = self.annotate(shell + [
            expect_groups(_3=125, _4=1),
            {"op": "fill_holes", "group": 3}, expect_groups(_3=126, _4=1),
            {"op": "undo"}, expect_groups(_3=125), {"op": "redo"}, expect_groups(_3=126),
            {"op": "islands", "group": 3, "split_from": 10}, expect_groups(_3=0, _10=125, _11=1),
            {"op": "undo"}, {"op": "islands", "group": 3, "keep": "at_least", "voxels": 2}, expect_groups(_3=125),
            {"op": "undo"}, {"op": "islands", "group": 3, "keep": "at", "at": [30.5, 3.5, 3.5]}, expect_groups(_3=1),
            {"op": "undo"}, {"op": "islands", "group": 3, "keep": "largest"}, expect_groups(_3=125),
            {"op": "combine", "group": 3, "with": 4, "how": "swap"}, expect_groups(_3=1, _4=125),
            {"op": "combine", "group": 3, "with": 4, "how": "add", "box": [0, 0, 0, 11, 40, 40]}, expect_groups(_3=76, _4=50),
            {"op": "undo"},
            {"op": "combine", "group": 5, "with": 4, "how": "move", "within": [0, 300], "inside": 4},
            expect_groups(_3=1, _5=125),
            {"op": "save"}])
        self.assertEqual(result["commands"], len(shell) + 26)
        mask = (self.folder / "paint.mask").read_bytes()
        self.assertEqual({group: mask.count(group) for group in set(mask)}, {0: 16000 - 126, 3: 1, 5: 125})
        # The history goes on where it ended.
        self.annotate([{"op": "undo", "count": 2}, expect_groups(_3=125, _4=1, _5=0)])

    def test_lines_by_distance_and_threshold(self):
        self.prepare()
        self.annotate([
            {"op": "threshold", "group": 7, "from": 0, "to": 255, "box": [0, 0, 0, 2, 2, 2]}, expect_groups(_7=8),
            {"op": "grow", "group": 7, "distance": 1}, expect_groups(_7=20),
            {"op": "shrink", "group": 7, "distance": 1}, expect_groups(_7=8),
            {"op": "close", "group": 7, "distance": 1}, expect_groups(_7=8),
            {"op": "open", "group": 7, "distance": 1}, expect_groups(_7=4),
            {"op": "undo"}, {"op": "hollow", "group": 7, "wall": 1}, expect_groups(_7=7),
            {"op": "undo"}, {"op": "hollow", "group": 7, "wall": 1, "side": "out"}, expect_groups(_7=12)])

    def test_lines_of_smoothing(self):
        self.prepare()
        self.annotate([
            {"op": "threshold", "group": 7, "from": 0, "to": 255, "box": [2, 2, 2, 5, 5, 5]}, expect_groups(_7=27),
            {"op": "smooth", "distance": 1.5}, expect_groups(_7=19), {"op": "undo"}, expect_groups(_7=27),
            {"op": "smooth", "distance": 1.5, "groups": [6, 7], "method": "gaussian"}, expect_groups(_7=19)])
        self.annotate([{"op": "smooth", "distance": 1.5, "groups": [6]}, expect_groups(_6=0, _7=19)])   # is empty

    def test_lines_of_filling_between_slices(self):
        self.prepare()
        slices = [{"op": "threshold", "group": 7, "from": 0, "to": 255, "box": [2, 2, z, 5, 5, z + 1]} for z in (1, 9)]
        self.annotate(slices + [
            {"op": "fill_between", "group": 7}, expect_groups(_7=81), {"op": "undo"}, expect_groups(_7=18),
            {"op": "fill_between", "group": 7, "axis": "x"}, expect_groups(_7=18),
            {"op": "fill_between", "group": 7, "axis": "z", "box": [0, 0, 4, 40, 20, 6]}, expect_groups(_7=36)])
        self.assertIn('key axis is "w"; expected one of "x", "y", "z"',
                      self.refused({"op": "fill_between", "group": 7, "axis": "w"}))
        self.annotate([{"op": "fill_between", "group": 9}, expect_groups(_7=36, _9=0)])   # is empty

    def test_lines_of_growing_from_seeds(self):
        self.prepare()
        box = [8, 8, 8, 11, 13, 13]
        self.annotate([
            fill_box(3, 10, 10, 10), {"op": "grow_seeds", "box": box}, expect_groups(_3=75), {"op": "undo"},
            {"op": "grow_seeds", "margin": 1, "on": "inverted"}, expect_groups(_3=27), {"op": "undo"},
            fill_box(4, 10, 12, 12),
            {"op": "grow_seeds", "groups": [4], "box": box, "only_unpainted": True}, expect_groups(_3=1, _4=74),
            {"op": "undo"}, {"op": "grow_seeds", "groups": [4], "box": box}, expect_groups(_3=0, _4=75),
            {"op": "undo"}, {"op": "grow_seeds", "box": box, "within": [300, 400]}, expect_groups(_3=1, _4=1)])
        self.assertIn("no group of [9] that is not locked has voxels; expected some as seeds",
                      self.refused({"op": "grow_seeds", "groups": [9]}))
        self.assertIn('key on is "fog"; expected one of "gradient", "intensity", "inverted"',
                      self.refused({"op": "grow_seeds", "on": "fog"}))

    def test_lines_of_cuts(self):
        self.prepare()
        cut = {"op": "lasso", "polygon": [[0, 0], [10.5, 0], [10.5, 30], [0, 30]], "camera": "front"}
        view = {"eye": [0, 0, 0], "target": [0, 0, -1], "up": [0, 1, 0]}
        # A perspective eye 100 voxels above the box, whose line of sight hits its middle.
        seen = {**cut, "camera": {"projection": "perspective", "eye": [10.5, 10.5, 110], "target": [10.5, 10.5, 0],
                                  "up": [0, 1, 0]},
                "polygon": [[-0.0001, -1], [0.0001, -1], [0.0001, 1], [-0.0001, 1]]}
        self.annotate([
            fill_box(3, 10, 10, 10, radius=2.2), expect_groups(_3=125),
            cut, expect_groups(_3=75), {"op": "undo"}, expect_groups(_3=125),
            {**cut, "side": "outside"}, expect_groups(_3=50), {"op": "undo"},
            {**cut, "depth": [9.5, 10.5]}, expect_groups(_3=105), {"op": "undo"},
            {**cut, "camera": view, "group": 7}, expect_groups(_3=75, _7=50), {"op": "undo"},
            {**cut, "camera": view, "depth": [-10.5, -9.5]}, expect_groups(_3=105), {"op": "undo"},
            seen, expect_groups(_3=100), {"op": "undo"},
            {**cut, "groups": [4]}, expect_groups(_3=125)])
        self.assertIn("expected an array of 3 to 10000 points", self.refused({**cut, "polygon": [[0, 0], [1, 1]]}))
        self.assertIn("key camera.up is [0,0,3]; expected a direction across the line from eye to target",
                      self.refused({**cut, "camera": {**view, "up": [0, 0, 3]}}))
        self.assertIn('key camera is "side"; expected one of "front", "back"', self.refused({**cut, "camera": "side"}))
        self.assertIn("key camera is missing", self.refused({"op": "lasso", "polygon": cut["polygon"]}))

    def test_mask_from_trace(self):
        self.prepare()
        self.annotate([
            {"op": "node", "at": [10.5, 10.5, 10.5], "radius": 2, "group": 5}, {"op": "mask_from_trace", "group": 7},
            expect_groups(_7=33),
            {"op": "undo"}, expect_groups(_7=0),
            {"op": "node", "at": [20.5, 10.5, 10.5], "radius": 2, "group": 6},
            {"op": "mask_from_trace", "group": 7, "of": [6]}, expect_groups(_7=33 + 10 * 13)])
        self.assertIn("key of is [9]; expected groups of which the trace has nodes",
                      self.refused({"op": "mask_from_trace", "group": 7, "of": [9]}))

    def test_trace_from_mask(self):
        self.prepare()
        expect = lambda nodes, internodes: {"op": "expect", "nodes": nodes, "internodes": internodes}
        self.annotate([
            fill_box(3, 10, 10, 10), {"op": "trace_from_mask", "group": 3}, expect(1, 0), {"op": "undo"}, expect(0, 0),
            {"op": "redo"}, expect(1, 0)])
        self.assertIn("group 9 has no voxels", self.refused({"op": "trace_from_mask", "group": 9}))

    def test_locks_are_heeded_and_counted(self):
        self.prepare(groups={"4": {"locked": True, "name": "vein"}})
        script = self.write_script("script.jsonl", [fill_box(3, 5, 5, 5), {"op": "save"}])
        self.check("annotate", self.session, "--script", script)
        script = self.write_script("script.jsonl", [{"op": "combine", "group": 4, "with": 3, "how": "add"}])
        result = self.check("annotate", self.session, "--script", script)
        self.assertIn("script.jsonl:1: Combine groups: nothing changed; group 4 (vein) is locked, so 1 voxel stayed",
                      result.stderr)
        keys = self.annotate([{"op": "combine", "group": 4, "with": 3, "how": "add"}])
        self.assertEqual((keys["voxels_changed"], keys["voxels_kept_locked"]), (0, 1))

    def test_a_failed_line_says_what_is_kept_and_empty_groups_are_named(self):
        self.prepare()
        self.assertNotIn("kept", self.refused({"op": "grow", "group": 3, "distance": 600}))
        script = self.write_script("script.jsonl", [fill_box(3, 10, 10, 10), {"op": "grow", "group": 3, "distance": 1},
                                                    {"op": "grow", "group": 9, "distance": 600}])
        said = self.check("annotate", self.session, "--script", script, status=1).stderr
        self.assertIn("script.jsonl:3: group 9 has no voxels", said)
        self.assertIn('2 steps of earlier lines are kept, and can be undone by {"op":"undo","count":2}', said)
        self.annotate([expect_groups(_3=7), {"op": "undo", "count": 2}, expect_groups(_3=0)])

    def test_lines_that_are_refused(self):
        self.prepare()
        for line, said in [
                ({"op": "combine", "group": 3, "with": 3, "how": "add"}, "key with is 3; expected another group"),
                ({"op": "combine", "group": 3, "with": 4, "how": "xor"}, 'expected one of "add", "subtract", "intersect"'),
                ({"op": "combine", "group": 3, "with": 4}, "key how is missing"),
                ({"op": "islands", "group": 3}, "expected largest, at_least or at, unless split_from is given"),
                ({"op": "islands", "group": 3, "keep": "at_least"}, "expected either voxels or mm3"),
                ({"op": "islands", "group": 3, "keep": "largest", "voxels": 3}, "expected either voxels or mm3"),
                ({"op": "islands", "group": 3, "keep": "largest", "connectivity": 18}, "expected 6 or 26"),
                ({"op": "fill_holes", "group": 0}, "key group is 0; expected a whole number from 1 to 255"),
                ({"op": "fill_holes", "group": 3, "size": 3}, "unknown key size"),
                ({"op": "fill_holes", "group": 3, "box": [0, 0, 0, 5, 5, 0]}, "expected six whole numbers"),
                ({"op": "fill_holes", "group": 3, "within": [9, 1]}, "the lower one first"),
                ({"op": "islands", "group": 3, "keep": "at", "at": [1, 1, 1]}, "where no voxel of group 3 is")]:
            with self.subTest(line=line):
                self.assertIn(said, self.refused(line))


if __name__ == "__main__":
    unittest.main()
