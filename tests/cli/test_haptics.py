"""shvr haptics: the servo without hardware."""
import csv
import json
import math
import unittest
from xml.etree import ElementTree

from harness import CliTest

KEYS = ["ticks", "late", "max_force_n", "energy_mj", "proxy_rms_um", "tick_us", "forces_hash"]
SIDE = 64


def varint(length):
    digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"
    text = ""
    while length >= 32:
        text, length = text + digits[32 + length % 32], length // 32
    return text + digits[length]


class Haptics(CliTest):
    def setUp(self):
        super().setUp()
        # A tube along x through the middle, 4 voxels in radius; another beside it, one voxel apart.
        voxels = bytearray(SIDE**3)
        for z in range(SIDE):
            for y in range(SIDE):
                first, second = (y - 32)**2 + (z - 32)**2 <= 16, (y - 41)**2 + (z - 32)**2 <= 9
                if first or second:
                    start = SIDE * (y + SIDE * z)
                    voxels[start:start + SIDE] = b"\xc8" * SIDE
        (self.folder / "tube.raw").write_bytes(voxels)
        self.volume = self.folder / "tube.nhdr"
        self.volume.write_text(f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {SIDE} {SIDE} {SIDE}\nspacings: 2 2 2\n"
                               'units: "um" "um" "um"\nencoding: raw\ndata file: tube.raw\n')

    def trace(self, name="t.trace", ticks=3000, mode="proximity", more=()):
        """A hand along the tube that strays; a voxel (2 um) is 0.25 mm in the hand."""
        scale = 2 / 0.00025
        lines = [{"shvr_stylus_trace": 1, "caps": {"outputs_force": True}},
                 {"settings": {"assistance": True, "mode": mode, "threshold": 100, "probe_radius": 20,
                               "to_volume": [scale, 0, 0, 0, scale, 0, 0, 0, scale], "origin": [65, 65, 65]}}]
        for i in range(ticks):
            stray = 0.0012 * math.sin(i / 150) * min(i / 1500, 1)
            lines.append({"at": [-0.003 + 0.000002 * i, stray, 0]})
        path = self.folder / name
        path.write_text("".join(json.dumps(line) + "\n" for line in [*lines, *more]))
        return path

    def replay(self, *arguments):
        result = self.check_json("haptics", "replay", *arguments, "--volume", self.volume)
        self.assert_keys(result, KEYS)
        self.assert_keys(result["tick_us"], ["p50", "p99", "max"])
        return result

    # Kind (Touch): a trace recorded while assistance was off
    def test_a_trace_without_assistance_says_that_it_has_no_forces(self):
        trace = self.trace(ticks=400)
        off = self.folder / "off.trace"
        off.write_text(trace.read_text().replace('"assistance": true, ', ""))
        self.assertNotIn("assistance", self.check("haptics", "replay", trace, "--volume", self.volume).stderr)
        self.assertIn("off.trace: settings: key assistance is false in all ticks",
                      self.check("haptics", "replay", off, "--volume", self.volume).stderr)
        self.assertEqual(self.replay(off)["assisted_ticks"], 0)
        self.assertEqual(self.replay(trace)["assisted_ticks"], 400)

    def test_the_same_trace_gives_the_same_forces(self):
        trace = self.trace()
        first, again = self.replay(trace), self.replay(trace)
        self.assertEqual(first["forces_hash"], again["forces_hash"])
        self.assertEqual((first["ticks"], first["late"]), (3000, 0))
        self.assertGreater(first["max_force_n"], 0.05)
        self.assertLessEqual(first["max_force_n"], 3.3)
        self.assertGreater(first["proxy_rms_um"], 0.5)
        self.assertLessEqual(first["max_step_n"], 0.1 + 1e-9)
        self.assertEqual(first["unit"], "um")

    def test_a_modelled_touch_is_led_along_the_tube_beside_another(self):
        trace = self.trace()
        near = self.replay(trace, "--device-model", "touch")
        own = self.replay(trace, "--device-model", "touch", "--mode", "object")
        again = self.replay(trace, "--device-model", "touch", "--mode", "object")
        self.assertEqual(own["forces_hash"], again["forces_hash"])
        self.assertEqual((own["mode"], own["objects"], near["objects"]), ("object", 1, 0))
        self.assertNotEqual(own["forces_hash"], near["forces_hash"])

    def test_what_is_above_the_threshold_decides(self):
        trace = self.trace()
        self.assertEqual(self.replay(trace, "--threshold", "250")["max_force_n"], 0)

    # Kind (Touch): a replay in which only some groups are felt
    def test_only_the_chosen_groups_are_felt(self):
        trace = self.trace(ticks=600)
        self.assertEqual(self.replay(trace)["contact_ticks"] > 500, True)
        self.assertEqual(self.replay(trace, "--set", "probe.touch.groups=[5]")["contact_ticks"], 0)
        self.assertGreater(self.replay(trace, "--set", "probe.touch.groups=[0]")["contact_ticks"], 500)
        # Painted, group 5 is felt and what is unpainted is not.
        voxels = (self.folder / "tube.raw").read_bytes()
        (self.folder / "paint.mask").write_bytes(voxels.replace(b"\xc8", b"\x05"))
        painted = self.write_session(volume={"path": "tube.nhdr"})
        felt = {group: self.check_json("haptics", "replay", trace, "--volume", painted,
                                       "--set", f"probe.touch.groups=[{group}]")["contact_ticks"] for group in (5, 6)}
        self.assertGreater(felt[5], 500)
        self.assertEqual(felt[6], 0)

    # Kind (Touch): a trace without relevance, of a scan whose session hides what it touches
    def test_what_the_session_hides_is_not_felt_except_by_older_traces(self):
        older = self.trace(ticks=600)
        whole = self.replay(older)
        seen = self.folder / "seen.trace"
        head, rest = older.read_text().split("\n", 1)
        seen.write_text(json.dumps({**json.loads(head), "feels_seen": True}) + "\n" + rest)
        self.assertEqual(self.replay(seen)["forces_hash"], whole["forces_hash"])
        hidden = (["cut.lower=[0,0,50]"], ["unpainted.visible=false"], ["view.solo=3"],
                  ['transfer_function.points=[{"intensity":210,"opacity":0},{"intensity":220,"opacity":1}]'])
        for settings in hidden:
            arguments = [argument for setting in settings for argument in ("--set", setting)]
            with self.subTest(settings=settings):
                self.assertEqual(self.replay(seen, *arguments)["contact_ticks"], 0)
                self.assertEqual(self.replay(older, *arguments)["forces_hash"], whole["forces_hash"])
                felt = self.replay(seen, *arguments, "--set", "probe.touch.feels_hidden=true")
                self.assertEqual(felt["forces_hash"], whole["forces_hash"])
        # Half of the tube is felt where the other half is cut away.
        half = self.replay(seen, "--set", "cut.lower=[0,0,32]")
        self.assertGreater(half["contact_ticks"], 500)
        self.assertNotEqual(half["forces_hash"], whole["forces_hash"])

    # Kind (Touch): a replay with a ball that needs coarser levels
    def test_a_large_ball_is_felt_on_coarser_levels(self):
        # A slab that the ball reaches, outside the largest cube of the finest level, which is 128 voxels a side.
        side, radius = 160, 156
        voxels = bytearray(side**3)
        for z in range(side):
            start = side * side * z
            voxels[start:start + 15 * side] = b"\xc8" * (15 * side)
        (self.folder / "large.raw").write_bytes(voxels)
        large = self.folder / "large.nhdr"
        large.write_text(self.volume.read_text().replace("64 64 64", "160 160 160").replace("tube.raw", "large.raw"))
        scale = radius / 0.0025
        lines = [{"shvr_stylus_trace": 1},
                 {"settings": {"assistance": True, "threshold": 100, "probe_radius": radius,
                               "to_volume": [scale, 0, 0, 0, scale, 0, 0, 0, scale], "origin": [160, 160, 160]}}]
        lines += [{"at": [0, 0, 0]}] * 400
        trace = self.folder / "large.trace"
        trace.write_text("".join(json.dumps(line) + "\n" for line in lines))
        result = self.check_json("haptics", "replay", trace, "--volume", large)
        self.assertGreater(result["contact_ticks"], 350)
        self.assertGreater(result["max_force_n"], 0.001)

    def test_forces_of_the_trace_are_compared(self):
        trace = self.trace(more=[{"force": [9, 9, 9]}])
        result = self.replay(trace)
        self.assertEqual((result["forces_told"], result["forces_equal"]), (1, 0))

    def test_what_was_felt_is_replayed_without_the_scan(self):
        trace = self.trace(ticks=100)
        said = self.check("haptics", "replay", trace, status=1).stderr
        self.assertIn("--volume is not given", said)
        lines = [json.loads(line) for line in trace.read_text().splitlines()]
        lines[0]["shvr_stylus_trace"] = 2
        # All 64^3 voxels but the first, one of which is 2 um: a length of 1 and one of 64^3 - 1.
        lines.insert(2, {"relevance": {"sequence": 1, "origin": [0, 0, 0], "size": [64, 64, 64], "words_per_row": 2,
                                       "spacing": [2, 2, 2], "volume_size": [64, 64, 64], "runs": "B_____H"}})
        lines[3]["relevance_time"] = 10**15
        felt = self.folder / "felt.trace"
        felt.write_text("".join(json.dumps(line) + "\n" for line in lines))
        said = self.check("haptics", "replay", felt, status=1).stderr
        self.assertIn("runs that fill its words", said)
        felt.write_text(felt.read_text().replace("B_____H", "B" + varint(64**3 - 1)))
        result = self.check_json("haptics", "replay", felt)
        self.assertEqual((result["ticks"], result["relevance_made"], result["contact_ticks"]), (100, 1, 100))
        self.assertEqual((result["relevance"], result["device_swaps"]), ("recorded", 0))
        self.assertEqual(self.replay(felt, "--threshold", "20")["relevance"], "made")
        self.assertEqual(self.replay(felt, "--device-model", "touch")["relevance"], "made")
        self.assertEqual(self.replay(trace)["relevance"], "made")
        said = self.check("haptics", "replay", felt, "--threshold", "20", status=1).stderr
        self.assertIn("another threshold, radius, choice of groups, latency or device", said)

    # Kind (Touch): a table of ticks, with a position that is not a number among them
    def test_the_ticks_are_a_table(self):
        trace = self.trace(ticks=400, more=[{"at": ["nan", 0, 0]}])
        table = self.folder / "ticks.csv"
        result = self.replay(trace, "--csv", table)
        self.assertEqual(result["forces_hash"], self.replay(trace)["forces_hash"])
        with table.open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0])[:8], ["tick", "time_s", "read", "buttons", "hand_x_m", "hand_y_m", "hand_z_m",
                                             "probe_x_um"])
        self.assertEqual((len(rows), rows[-1]["hand_x_m"]), (401, ""))
        forces = [math.hypot(*(float(row[f"force_{axis}_n"]) for axis in "xyz")) for row in rows]
        self.assertAlmostEqual(max(forces), result["max_force_n"], places=12)
        self.assertEqual(sum(int(row["in_contact"]) for row in rows), result["contact_ticks"])
        squares = [sum((float(row[f"proxy_{axis}_um"]) - float(row[f"probe_{axis}_um"]))**2 for axis in "xyz")
                   for row in rows if row["in_contact"] == "1"]
        self.assertAlmostEqual(math.sqrt(sum(squares) / len(squares)), result["proxy_rms_um"], places=9)
        self.assertAlmostEqual(1e3 * float(rows[-1]["energy_j"]), result["energy_mj"], places=12)
        self.assertAlmostEqual(float(rows[300]["time_s"]), 0.3)
        # The hand begins at (-3 mm, 0, 0); 0.25 mm there are a voxel of 2 um, around (65, 65, 65) um.
        self.assertAlmostEqual(float(rows[0]["probe_x_um"]), 65 - 24, places=9)
        self.assertIn("engaging", rows[10]["flags"].split("|"))
        self.assertIn("fault", rows[-1]["flags"].split("|"))

        before = trace.read_bytes()
        self.check_refused("haptics", "replay", trace, "--volume", self.volume, "--csv", self.folder / "t.txt",
                           status=2, says=["--csv", ".csv"])
        copied = self.folder / "trace.csv"
        copied.write_bytes(before)
        self.check_refused("haptics", "replay", copied, "--volume", self.volume, "--csv", copied, says=["trace.csv"])
        self.assertEqual(copied.read_bytes(), before)

    # Kind (Touch): each setting of a trace replaced
    def test_settings_of_the_trace_are_replaced(self):
        trace = self.trace(ticks=900)
        as_is = self.replay(trace)
        self.assertEqual((as_is["probe_radius"], as_is["surface_share"], as_is["strength"], as_is["latency_ms"]),
                         (20, 0.4, 1, 24))
        # The trace's own values: ten voxels of 2 um, and the window's latency.
        self.assertEqual(self.replay(trace, "--radius", "10", "--strength", "1", "--latency", "24")["forces_hash"],
                         as_is["forces_hash"])
        self.assertLess(self.replay(trace, "--strength", "0.5")["max_force_n"], 0.75 * as_is["max_force_n"])
        self.assertEqual(self.replay(trace, "--strength", "0")["max_force_n"], 0)
        small = self.replay(trace, "--radius", "6")
        self.assertEqual(small["probe_radius"], 12)
        self.assertNotEqual(small["forces_hash"], as_is["forces_hash"])
        unfelt = self.replay(trace, "--groups", "5,7")
        self.assertEqual((unfelt["contact_ticks"], unfelt["groups"], as_is["groups"]), (0, [5, 7], None))
        self.assertEqual(self.replay(trace, "--groups", "5,0")["contact_ticks"], as_is["contact_ticks"])
        # Nothing is felt before the first answer.
        late = self.replay(trace, "--latency", "300")
        self.assertEqual(as_is["contact_ticks"] - late["contact_ticks"], 276)
        surface = [self.replay(trace, "--mode", "surface", "--share", share) for share in ("0.05", "0.9")]
        self.assertGreater(surface[0]["contact_ticks"], surface[1]["contact_ticks"])
        self.check_refused("haptics", "replay", trace, "--volume", self.volume, "--strength", "2", status=2,
                           says=["--strength"])
        self.check_refused("haptics", "replay", trace, "--volume", self.volume, "--groups", "256", status=2,
                           says=["--groups"])

    # Kind (Touch): hands that differ from the model's default
    def test_the_modelled_hand_is_chosen(self):
        trace = self.trace(ticks=1500)

        def away(*arguments):
            """How far the hand is led from its path, at most, in metres."""
            table = self.folder / "ticks.csv"
            result = self.replay(trace, "--device-model", "touch", "--csv", table, *arguments)
            with table.open(newline="") as file:
                rows = list(csv.DictReader(file))
            self.assertAlmostEqual(1e3 * float(rows[-1]["energy_j"]), result["energy_mj"], places=9)
            at = [float(row["hand_y_m"]) for row in rows]
            path = [0.0012 * math.sin(i / 150) * min(i / 1500, 1) for i in range(1500)]
            return max(abs(a - b) for a, b in zip(at, path))
        loose, firm = away("--hand-stiffness", "50"), away("--hand-stiffness", "3000")
        self.assertGreater(loose, 2 * firm)
        result = self.replay(trace, "--device-model", "touch", "--hand-mass", "0.2", "--hand-damping", "6")
        self.assertEqual(result["hand"], {"mass_kg": 0.2, "stiffness_n_per_m": 150, "damping_n_s_per_m": 6})
        self.assertNotEqual(result["forces_hash"], self.replay(trace, "--device-model", "touch")["forces_hash"])
        self.check_refused("haptics", "replay", trace, "--volume", self.volume, "--hand-mass", "0.2", status=2,
                           says=["--hand-mass", "--device-model"])

    def test_what_cannot_be_replayed(self):
        bad = self.folder / "bad.trace"
        bad.write_text('{"shvr_stylus_trace":1}\n{"at":[0,0]}\n')
        self.check_refused("haptics", "replay", bad, "--volume", self.volume, says=["bad.trace:2", "at"])
        bad.write_text('{"shvr_stylus_trace":1,"unit":"mm"}\n{"at":[0,0,0]}\n')
        self.check_refused("haptics", "replay", bad, "--volume", self.volume, says=["unit", "mm", "um"])
        bad.write_text('{"shvr_stylus_trace":3}\n{"at":[0,0,0]}\n')
        self.check_refused("haptics", "replay", bad, "--volume", self.volume, says=["bad.trace", "cut off or changed"])
        self.check_refused("haptics", "replay", self.folder / "none", "--volume", self.volume, says=["none"])
        self.check_refused("haptics", "replay", bad, "--volume", self.volume, "--mode", "magic", status=2,
                           says=["--mode"])

    def test_devices(self):
        result = self.check_json("haptics", "devices")
        self.assert_keys(result, ["devices", "profiles", "models"])
        self.assertEqual(result["devices"][-1]["id"], "mouse")
        self.assertEqual(result["devices"][-1]["why_unusable"], "")
        said = self.check("haptics", "devices", "--record", "2988:0304", status=2).stderr
        self.assertIn("--record is given without -o", said)
        reports = self.folder / "reports.jsonl"
        said = self.check("haptics", "devices", "--record", "2988:0304", "-o", reports, status=1).stderr
        self.assertIn("2988:0304", said)
        self.assertFalse(reports.exists())
        self.assertIn("SHVR reference layout", [profile["name"] for profile in result["profiles"]])

    def test_bench(self):
        result = self.check_json("haptics", "bench", "--seconds", "0.2")
        self.assert_keys(result, [key for key in KEYS if key != "forces_hash"])
        self.assertEqual({case["side"] for case in result["cases"]}, {64, 128})

    def test_the_sweep_is_a_table_and_a_picture_of_it(self):
        table, picture = self.folder / "proxy.csv", self.folder / "proxy.svg"
        result = self.check_json("haptics", "bench", "--sweep", table, "--plot", picture)
        with table.open() as file:
            rows = list(csv.DictReader(file))
        self.assertEqual((result["rows"], len(rows)), (27, 27))
        error = {(row["method"], int(row["radius_voxels"]), int(row["points"])): float(row["error_percent_of_radius"])
                 for row in rows}
        for radius, goal in [(6, 0.4), (12, 0.2), (24, 0.2)]:  # goal 3 of haptics/PROOFS.md
            self.assertLess(error["exact", radius, 0], goal)
            for few, many in [(300, 1000), (1000, 3000), (3000, 10000)]:
                self.assertLess(error["even", radius, many], error["even", radius, few])
            self.assertLess(error["even", radius, 3000], 0.6 * error["random", radius, 3000])
            self.assertLess(error["exact", radius, 0], 0.2 * error["even", radius, 10000])

        # Each row has its mark where its numbers are, in the axes; then the legend's six.
        root = ElementTree.parse(picture).getroot()
        tag = "{http://www.w3.org/2000/svg}"
        marks = [{key: mark.get(key) for key in ("cx", "cy", "r", "fill")} for mark in root.iter(tag + "circle")]
        self.assertEqual(len(marks), 27 + 6)
        for row, mark in zip(rows, marks):
            x = 70 + 420 * min(max(math.log10(float(row["microseconds"])) / 3, 0), 1)
            y = 380 - 360 * (math.log10(float(row["error_percent_of_radius"])) + 3) / 4
            self.assertAlmostEqual(float(mark["cx"]), x, delta=1)
            self.assertAlmostEqual(float(mark["cy"]), y, delta=1.5)
            self.assertAlmostEqual(float(mark["r"]), 2 + int(row["radius_voxels"]) / 6, delta=0.01)
        self.assertEqual(len({mark["fill"] for mark in marks[:27]}), 3)
        words = [text.text for text in root.iter(tag + "text")]
        for word in ["microseconds a proxy", "RMS error, % of the radius", "exact", "even points", "24 voxels"]:
            self.assertIn(word, words)
        for count in ["300", "3000", "10000"]:
            self.assertEqual(words.count(count), 2)  # both kinds of points
        self.assertEqual(words.count("1000"), 3)  # and the axis


if __name__ == "__main__":
    unittest.main()
