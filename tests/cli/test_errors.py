"""Every command's reaction to wrong usage and to unexpected files; --help lists the commands."""
import json
import os
import struct
import subprocess
import unittest
from pathlib import Path

from harness import ENVIRONMENT, SHVR, VALIDATED, CliTest, Volume, commands, run

PARTS = {command: commands(command) for command in commands()}  # the commands of each command
GROUPS = [command for command in PARTS if " SUBCOMMAND\n" in run(command, "--help").stdout]  # do nothing themselves
COMMANDS = [[command] for command in PARTS if command not in GROUPS] + \
           [[command, part] for command, parts in PARTS.items() for part in parts]
# Run elsewhere: in a window, or for seconds.
ELSEWHERE = {("view",): "tests/window/test_view.py", ("gather",): "tests/cli/array/test_label_tasks.py",
             ("golden", "calibrate"): "tests/cli/instruments/test_golden.py",
             ("haptics", "bench"): "tests/cli/test_haptics.py"}
# Further arguments of commands that read a file, which is not there.
READS = {("info",): [], ("import",): ["project"], ("render",): ["-o", "a.png"], ("annotate",): ["--script", "s.jsonl"],
         ("export",): [], ("evaluate",): ["--mask", "a.mask"], ("label",): ["--threshold", "1"],
         ("compare",): ["a.png"], ("profile",): [], ("profile", "diff"): ["missing.nhdr"],
         ("haptics", "replay"): ["--volume", "a.nhdr"], ("bench",): ["-o", "bench"]}
# The argument that a command without any names first.
NEEDS = {("info",): "INPUT", ("import",): "VOLUME", ("render",): "INPUT", ("annotate",): "PROJECT",
         ("export",): "PROJECT", ("evaluate",): "--truth-mask", ("label",): "VOLUME", ("compare",): "A",
         ("profile",): "INPUT", ("profile", "diff"): "A", ("golden", "bless"): "--reason", ("bench",): "--output",
         ("phantom",): "KIND", ("haptics", "replay"): "TRACE", ("study",): "--output",
         ("gather",): "MANIFEST"}


class ErrorTest(CliTest):
    def works(self):
        """What each command needs to do its work, in an order in which each finds what those before it made."""
        session, folder = self.write_session(), self.folder
        script = self.write_script("s.jsonl", [{"op": "expect", "nodes": 0}, {"op": "save"}])
        trace = self.write_script("t.trace", [{"shvr_stylus_trace": 1}, {"at": [0, 0, 0]}])
        (folder / "golden").mkdir()
        (folder / "conditions.csv").write_text("task,touch,law,probe_radii,noise\ntrace,none,potential,1.5,10\n")
        self.write_json("golden/sphere.json", {"why": "the smallest", "session": "../session.json"})
        golden = ["--folder", folder / "golden"]
        return {("info",): [session], ("render",): [session, "-o", folder / "a.png"],
                ("annotate",): [session, "--script", script], ("compare",): [folder / "a.png", folder / "a.png"],
                ("phantom",): ["tubes", "--size", "8", "-o", folder],
                ("import",): [folder / "tubes.nhdr", folder / "project"],
                ("label",): [folder / "tubes.nhdr", "--threshold", "100", "-o", folder / "labels.nrrd"],
                ("evaluate",): ["--truth-mask", folder / "labels.nrrd", "--mask", folder / "labels.nrrd"],
                ("export",): [session, "--mask", folder / "a.mask"],
                ("profile",): [session, "--frames", "3", "--set", "render.step_voxels=1"],
                ("profile", "diff"): [folder / "profile", folder / "profile"],
                ("golden", "bless"): [*golden, "--reason", "first picture"],
                ("golden", "run"): [*golden, "-o", folder / "results"],
                ("golden", "report"): [*golden, "-o", folder / "results"],
                ("bench",): ["--scenes", session, "--quick", "--size", "8,8", "--rounds", "1", "--peer", "none", "-o",
                             folder / "bench"],
                ("study",): ["--size", "small", "--seeds", "1", "--conditions", folder / "conditions.csv", "-o",
                             folder / "study"],
                ("haptics", "replay"): [trace, "--volume", session], ("haptics", "devices"): [], ("doctor",): []}


class Usage(ErrorTest):
    def test_help_shows_an_example(self):
        for command in COMMANDS + [[group] for group in GROUPS]:
            with self.subTest(command=command):
                text = self.check(*command, "--help").stdout
                self.assertIn(f"Example:\n  shvr {' '.join(command)} ", text)
                if command[0] not in GROUPS or len(command) == 2:
                    self.assertIn("--json", text)
                    self.assertIn("--quiet", text)

    def test_every_command_is_validated_in_one_file(self):
        self.assertEqual(sorted(VALIDATED), sorted(PARTS))
        tests = Path(__file__).resolve().parents[1]
        for command, name in VALIDATED.items():
            [file] = [*tests.glob(f"cli/**/{name}"), *tests.glob(f"window/{name}")]
            self.assertIn(f'"{command}"', file.read_text(), name)

    def test_an_unknown_option_is_status_2_and_names_the_help(self):
        needed = {**self.works(), **dict.fromkeys(ELSEWHERE, []), ("gather",): ["a.pieces"]}
        for command in COMMANDS:
            with self.subTest(command=command):
                self.check_refused(*command, *needed[tuple(command)], "--sise", status=2,
                                   says=["--sise", f"see shvr {command[0]} --help"])

    def test_a_command_that_is_given_nothing_names_what_it_needs(self):
        for command, needs in NEEDS.items():
            with self.subTest(command=command):
                self.check_refused(*command, status=2, says=[needs])
        for group in GROUPS:
            self.check_refused(group, status=2, says=[f"see shvr {group} --help"])

    def test_wrong_usage_is_status_2(self):
        session = self.write_session()
        for arguments in [["paint"], ["render"], ["render", session],
                          ["render", session, "-o", "a.png", "--sise", "1"],
                          ["render", session, "-o", "a.png", "--size", "12"],
                          ["render", session, "-o", "a.png", "--size", "0x5"],
                          ["render", session, "-o", "a.png", "--threads", "many"],
                          ["annotate", session], ["compare", "a.png"], ["info"]]:
            with self.subTest(arguments=arguments):
                self.check_refused(*arguments, status=2)

    def test_an_unknown_command_is_named_beside_the_known_ones(self):
        self.check_refused("reander", "a", status=2, says=['"reander" is an unknown command', "render", "view"])
        self.check_refused("--sise", "1", status=2, says=['"--sise" is an unknown option', "see shvr --help"])

    def test_an_empty_name_is_wrong_usage(self):
        session, picture = self.write_session(), self.folder / "a.png"
        for arguments, says in [(["info", ""], "argument 2, after info, is empty"), ([""], "argument 1 is empty"),
                                (["render", "", "-o", picture], "argument 2, after render, is empty"),
                                (["render", session, "-o", ""], "after -o, is empty"),
                                (["render", session, "--output="], "--output is empty"),
                                (["annotate", session, "--script", ""], "after --script, is empty"),
                                (["import", session, ""], "argument 3, after"),
                                (["phantom", "tubes", "-o", ""], "after -o, is empty"),
                                (["evaluate", "--truth-mask", "", "--mask", picture], "after --truth-mask, is empty")]:
            with self.subTest(arguments=arguments):
                self.check_refused(*arguments, status=2, says=[says])

    def test_the_version_is_told(self):
        told = self.check("--version").stdout
        self.assertRegex(told, r"^shvr \d+\.\d+\.\d+( \([0-9a-f]+\))?\n$")
        for command in PARTS:
            self.assertEqual(self.check(command, "--version").stdout, told)

    def test_budgets_are_numbers(self):
        session = self.write_session()
        for budget in ["0", "-5", "1.5", "99999999999999999999", "much"]:
            for option in ["--budget-device", "--budget-host"]:
                with self.subTest(option=option, budget=budget):
                    self.check_refused("render", session, "-o", self.folder / "a.png", option, budget, status=2,
                                       says=[option, budget, "expected a whole number of MiB from 1 to"])

    def test_a_malformed_layout_is_wrong_usage(self):
        for layout in ["12", "4x4:uint8", "4x4x4:uint9", "0x4x4:uint8", "4x4x4:uint8:middle"]:
            with self.subTest(layout=layout):
                self.check_refused("info", self.folder / "a.raw", "--raw", layout, status=2, says=[layout])

    def test_outputs_are_checked_before_any_work(self):
        volume = self.folder / "missing.nhdr"  # opening it would fail otherwise
        for command, option, name in [("render", "--output", "a.jpg"), ("export", "--mask", "a.png"),
                                      ("export", "--mesh", "a.stl"), ("profile", "--csv", "a.txt"),
                                      ("profile", "--graph", "a.pdf")]:
            with self.subTest(command=command, option=option):
                self.check_refused(command, volume, option, self.folder / name, status=2, says=[option, name])
        for command, option, name in [("render", "--output", "a.png"), ("export", "--metrics", "a.csv"),
                                      ("profile", "--trace", "a.json")]:
            with self.subTest(command=command, option=option):
                self.check_refused(command, volume, option, self.folder / "none" / name, says=["none", "no folder"])

    def test_outputs_in_missing_folders_are_refused_before_any_work(self):
        volume, none = self.folder / "missing.nhdr", self.folder / "none"  # opening the volume would fail otherwise
        picture = self.folder / "a.png"
        for command in (["label", volume, "--threshold", "1", "-o", none / "a.nrrd"],
                        ["export", volume, "--mask", none / "a.mask"],
                        ["compare", picture, picture, "--diff", none / "a.png"],
                        ["haptics", "bench", "--sweep", none / "a.csv"],
                        ["haptics", "bench", "--sweep", self.folder / "a.csv", "--plot", none / "a.svg"]):
            with self.subTest(command=command):
                self.check_refused(*command, says=["cannot be written: there is no folder", "none"])
        (self.folder / "file").write_text("")
        for command in (["bench", "--quick", "--scenes", "fog"], ["golden", "run"], ["golden", "report"]):
            with self.subTest(command=command):
                self.check_refused(*command, "-o", self.folder / "file" / "out", says=["file is a file; expected a folder"])

    def test_no_two_outputs_have_one_name(self):
        session, mask = self.write_session(), self.folder / "a.nrrd"
        self.check_refused("export", session, "--mask", mask, "--offset", self.folder / "." / "a.nrrd", status=2,
                           says=["--mask and --offset are both", "expected two names"])
        self.assertFalse(mask.exists())

    # Kind (Slices): an export into the folder of slices that is read
    def test_no_output_replaces_what_is_read(self):
        volume = Volume.noise((8, 8, 8), seed=1)
        scan = self.folder / "scan.nrrd"
        self.check("label", volume.write(self.folder), "--threshold", "100", "-o", scan)
        slices = self.folder / "slices"
        slices.mkdir()
        session = self.write_session(volume={"path": "scan.nrrd"})
        picture, other = self.folder / "a.png", self.folder / "b.png"
        self.check("render", session, "-o", picture, "--with-session")
        self.check("render", session, "-o", other)
        self.check("label", scan, "--threshold", "1", "-o", slices / "1.tif")
        before = {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}
        for command, name in ((["label", scan, "--threshold", "1", "-o", scan], "scan.nrrd"),
                              (["label", slices, "--threshold", "1", "-o", slices / "1.tif"], "1.tif"),
                              (["label", session, "--threshold", "1", "-o", scan], "scan.nrrd"),
                              (["export", session, "--mask", scan], "scan.nrrd"),
                              (["export", session, "--offset", scan], "scan.nrrd"),
                              (["render", picture, "-o", picture], "a.png"),
                              (["compare", picture, other, "--diff", other], "b.png"),
                              (["profile", session, "--frames", "1", "--trace", session], "session.json")):
            with self.subTest(command=command):
                self.check_refused(*command, says=[name, "is read", "it would be lost"])
        of_slices = self.write_session("of-slices.json", volume={"path": "slices"})
        before[of_slices] = of_slices.read_bytes()
        (self.folder / "link").symlink_to(slices)
        for command in (["export", of_slices, "--mask", slices / "x.tif"],
                        ["export", of_slices, "--offset", slices / "x.TIFF"],
                        ["export", of_slices, "--mask", self.folder / "link" / "x.tif"],
                        ["label", slices, "--threshold", "1", "-o", slices / "x.tif"]):
            with self.subTest(command=command):
                self.check_refused(*command, says=["would be read as a slice of", "a name in another folder"])
        self.assertEqual({path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}, before)
        self.check("export", of_slices, "--mask", slices / "x.nrrd")   # no slice
        self.check("info", slices)
        project = self.folder / "project"   # its volume lies in it, and its pictures are no slices
        (project / "shvr").mkdir(parents=True)
        scan.rename(project / "scan.nrrd")
        self.write_session("project/shvr/session.json", volume={"path": "../scan.nrrd"})
        for name in ("front.png", "side.png"):
            self.check("render", project, "-o", project / name, "--size", "8x8")

    def test_without_a_driver_the_package_is_named(self):
        session = self.write_session()
        result = run("render", session, "-o", self.folder / "a.png",
                     environment={"VK_ICD_FILENAMES": "/none.json", "VK_DRIVER_FILES": "/none.json"})
        self.assertEqual(result.returncode, 1)
        self.assertIn("no Vulkan device found; expected a GPU driver, or the package mesa-vulkan-drivers (lavapipe)\n",
                      result.stderr)

    def test_a_limit_of_memory_without_a_driver_is_named(self):
        """Under a low one no driver loads."""
        limited = subprocess.run(["sh", "-c", f"ulimit -v {4 << 20} && exec {SHVR} render {self.write_session()} -o "
                                  f"{self.folder}/a.png"], capture_output=True, text=True, timeout=60,
                                 env={**ENVIRONMENT, "VK_ICD_FILENAMES": "/none.json", "VK_DRIVER_FILES": "/none.json"})
        self.assertIn("mesa-vulkan-drivers (lavapipe), or more memory for drivers than the limit of 4096 MiB (ulimit -v)",
                      limited.stderr)

    def test_what_is_wrong_is_said_before_the_volume_is_read(self):
        session = self.write_session()
        output = self.folder / "a.png"
        for command in (["render", session, "-o", output], ["profile", session]):
            for camera in ("nowhere", '{"eye": 3}'):
                said = self.check_refused(*command, "--camera", camera, says=["camera"])
                self.assertNotIn("warning", said)
        # However many options replace a setting, it must be right.
        for options in (["--set", "render.size=wrong", "--size", "24x16"],
                        ["--set", "render.step_voxels=wrong", "--set", "render.quality=draft"],
                        ["--set", "light.ambient=-7", "--set", "light.ambient=0.5"]):
            self.check_refused("render", session, "-o", output, *options, says=[options[1].partition("=")[0]])
        for one, other in (("--trace", "--graph"), ("--csv", "--html")):
            name = self.folder / "same.json"
            extra = {"--csv": ".csv", "--html": ".html"}
            if one == "--csv":   # names that differ, of one file
                os.symlink(self.folder / "q.html", self.folder / "q.csv")
            first = name if one == "--trace" else self.folder / ("q" + extra[one])
            second = name if one == "--trace" else self.folder / ("q" + extra[other])
            self.check_refused("profile", session, one, first, other, second, status=2,
                               says=[f"{one} and {other} are both ", "expected a file for each"])
        self.assertFalse(output.exists())

    def test_intensities_beyond_float32_name_their_file(self):
        scan = self.folder / "huge.nrrd"
        scan.write_bytes(b"NRRD0004\ntype: double\ndimension: 3\nsizes: 4 4 4\nendian: little\nencoding: raw\n\n"
                         + struct.pack("<64d", *(i * 1e300 for i in range(64))))
        self.check_refused("render", scan, "-o", self.folder / "a.png",
                           says=["huge.nrrd: its intensities go from 0 to 6.3e+301", "the range of float32"])

    def test_escape_codes_of_arguments_do_not_reach_the_terminal(self):
        evil = "\x1b[31mred\x07\u009b2J"
        for command in (["info", self.folder / evil], [evil], ["render", "--" + evil], ["render", self.write_session(),
                        "-o", self.folder / "a.png", "--camera", evil], ["info", self.write_session(), "--set", evil]):
            result = run(*command)
            self.assertNotEqual(result.returncode, 0)
            for code in ("\x1b", "\x07", "\u009b"):
                self.assertNotIn(code, result.stderr + result.stdout, command)

    def test_without_a_display_the_window_says_so(self):
        for arguments in [[], ["view"], ["view", self.write_session()]]:
            result = run(*arguments, environment={"DISPLAY": "", "WAYLAND_DISPLAY": ""})
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
            self.assertIn("display", result.stderr)

    def test_help_is_no_error(self):
        self.assertIn("shvr COMMAND --help", self.check("--help").stdout)


class World(CliTest):
    def outputs(self):
        return ["-o", self.folder / "a.png"]

    def test_what_is_not_there(self):
        missing = self.folder / "missing.nhdr"
        before = {("evaluate",): ["--truth-mask"], ("bench",): ["--scenes"]}
        for command, more in READS.items():
            with self.subTest(command=command):
                more = [word if word.startswith("-") or word == "1" else self.folder / word for word in more]
                self.check_refused(*command, *before.get(command, []), missing, *more, says=["missing.nhdr"])
        self.assertEqual(list(self.folder.iterdir()), [])
        self.check_refused("annotate", self.write_session(), "--script", missing, says=["missing.nhdr"])
        self.check_refused("info", self.folder, says=["shvr/session.json"])

    def test_addresses_that_cannot_be_read_are_refused_in_words(self):
        for address in ("ftp://example.org/scan.zarr", "gs://bucket/scan.zarr", "file:///scan.zarr"):
            with self.subTest(address=address):
                says = [f"{address}: has the scheme", "expected http, https or s3"]
                for command in (["info", address], ["render", address, *self.outputs()], ["profile", address],
                                ["import", address, self.folder / "p.zarr"]):
                    said = self.check_refused(*command, says=says)
                    self.assertTrue(said.startswith(f"shvr: {address}"), said)
                session = self.write_session(volume={"path": address})
                self.check_refused("info", session, says=[*says, "volume.path"])
        session = self.write_session(annotation={"mask": "https://example.org/paint.mask"})
        self.check_refused("info", session, says=["annotation.mask", "only volumes are read over a network"])
        self.assertFalse((self.folder / "p.zarr").exists())

    def test_a_volume_that_is_cut_short(self):
        header = Volume.noise((8, 8, 8), seed=1).write(self.folder)
        (self.folder / "volume.raw").write_bytes(bytes(100))
        for command in (["info", header], ["render", header, *self.outputs()]):
            self.check_refused(*command, says=["100", "512"])

    def test_a_file_of_no_known_format(self):
        strange = self.folder / "strange.xyz"
        strange.write_bytes(b"\0\1\2\3" * 100)
        self.check_refused("info", strange, says=["strange.xyz"])

    def test_a_session_with_an_unknown_key(self):
        document = json.loads(self.write_session().read_text())
        document["render"]["stepp"] = 1
        session = self.write_json("wrong.json", document)
        self.check_refused("render", session, *self.outputs(), says=["wrong.json", "render.stepp"])

    def test_a_setting_that_is_none(self):
        session = self.write_session()
        self.check_refused("render", session, *self.outputs(), "--set", "render.stepp=1", says=["render.stepp"])

    def test_an_unknown_camera_names_the_known_ones(self):
        self.check_refused("render", self.write_session(), *self.outputs(), "--camera", "behind",
                           says=["behind", "front"])

    def test_an_unknown_device(self):
        self.check_refused("render", self.write_session(), *self.outputs(), "--device", "no such device",
                           says=["no such device"])

    def test_a_project_without_a_mask_cannot_be_saved(self):
        document = json.loads(self.write_session().read_text())
        del document["annotation"]
        session = self.write_json("maskless.json", document)
        script = self.write_script("s.jsonl", [{"op": "save"}])
        self.check_refused("annotate", session, "--script", script, says=["s.jsonl:1", "annotation.mask"])

    def test_nothing_is_left_behind_by_a_failure(self):
        session = self.write_session()
        before = sorted(os.listdir(self.folder))
        self.check_refused("render", session, *self.outputs(), "--camera", "behind")
        self.check_refused("profile", session, "--camera", "behind", "--trace", self.folder / "t.json")
        self.assertEqual(sorted(os.listdir(self.folder)), before)


class Output(ErrorTest):
    def test_json_is_the_only_thing_on_standard_output(self):
        works = self.works()
        self.assertEqual(sorted([*works, *ELSEWHERE]), sorted(map(tuple, COMMANDS)))
        for command, arguments in works.items():
            with self.subTest(command=command):
                result = run(*command, *arguments, "--json", "--quiet", environment={"CI": ""})
                self.assertEqual((result.returncode, result.stderr), (0, ""), result.stdout)
                self.assertIsInstance(json.loads(result.stdout), dict)  # as a whole
                (self.folder / command[-1]).write_text(result.stdout) if command == ("profile",) else None
        for command, file in ELSEWHERE.items():
            self.assertIn(f'"{command[-1]}"', (Path(__file__).resolve().parents[2] / file).read_text())

    def test_quiet_keeps_standard_error_empty(self):
        header = Volume.noise((8, 8, 8), seed=1).write(self.folder)
        self.assertIn("warning: ", self.check("render", header, "-o", self.folder / "a.png").stderr)
        self.assertEqual(self.check("render", header, "-o", self.folder / "a.png", "--quiet").stderr, "")

    def test_names_may_hold_anything(self):
        name = 'sch\u00f6n, "quoted" \\ $HOME'
        header = Volume.noise((8, 8, 8), seed=1).write(self.folder, "plain")
        strange = header.rename(self.folder / f"{name}.nhdr")
        info = self.check_json("info", strange)
        self.assertIn(name, info["input"])
        self.assertEqual(info["size"], [8, 8, 8])

    def test_a_full_standard_output_is_an_error(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("this system has no /dev/full")
        with open("/dev/full", "w") as full:
            result = subprocess.run([SHVR, "info", str(self.write_session()), "--json"], stdout=full,
                                    stderr=subprocess.PIPE, text=True, timeout=60, env=ENVIRONMENT)
        self.assertEqual(result.returncode, 1)
        self.assertIn("standard output", result.stderr)


if __name__ == "__main__":
    unittest.main()
