"""What is done in the window can be replayed without one, and comes back after the program was killed."""
import datetime
import json
import signal
import unittest

from seen import Seen


class Log(Seen):
    def test_what_was_done_in_the_window_is_replayed_without_one(self):
        session = self.write_ball()
        again = self.folder / "again" / "session.json"
        again.parent.mkdir()
        again.write_text(session.read_text())
        self.open_scan(session, environment=self.with_keys(near_y_in="U"))
        log = self.log
        x, y = self.middle()
        self.check_probe(x, y)
        self.check_stroke((x, y), (x + 12, y + 4), (x + 30, y + 10))
        self.check_key("5", "set probe.group")
        self.check_follows(lambda: self.do("keydown", "u", "sleep", 0.3, "keyup", "u", pause_s=0), "move_cut")
        self.check_probe(x - 30, y - 20)
        self.check_stroke((x - 30, y - 20), (x - 20, y - 35))
        self.check_key("X", "set probe.tool")
        self.check_key("N", "node")
        self.lead_probe(x + 20, y)   # in the tool that traces the probe follows what is seen
        for key, action in (("N", "node"), ("Ctrl+Z", "undo"), ("Ctrl+Y", "redo")):
            self.check_key(key, action)
        report = self.finish()
        self.assertEqual(sorted(report["voxels_in_group"]), ["3", "5"])
        lines = [json.loads(line) for line in log.read_text().splitlines()]
        self.assertEqual([line for line in self.done() if line["op"] == "redo"], [{"op": "redo", "count": 1}])
        times = [datetime.datetime.fromisoformat(line["time"].replace("Z", "+00:00")) for line in lines]
        now = datetime.datetime.now(datetime.timezone.utc)
        for time in times:  # of this hour
            self.assertLess(abs((now - time).total_seconds()), 3600)
        replayed = self.check_json("annotate", again, "--actions", log)
        self.assertEqual(replayed["voxels_in_group"], report["voxels_in_group"])
        self.assertEqual(replayed["nodes"], 2, (lines[-14:], report["messages"]))
        self.assertEqual(replayed["internodes"], 1)
        self.assertEqual(replayed["undoable"], report["undoable"])

    def test_a_line_that_is_no_action_is_named_before_anything_is_done(self):
        session = self.write_ball()
        log = self.folder / "log.jsonl"
        log.write_text('{"op":"place_probe","voxel":[32,32,32]}\n{"op":"paint_here"}\n')
        self.check_refused("annotate", session, "--actions", log, says=["log.jsonl:2: key on is missing"])
        self.assertFalse(session.with_suffix(".journal").exists())

    def test_the_window_that_opens_after_a_kill_is_the_one_that_was_there(self):
        session = self.write_ball()
        self.open_scan(session)
        x, y = self.middle()
        self.check_probe(x, y)
        self.check_stroke((x, y), (x + 10, y))
        # Other view, panes, brush and tool; none of it is saved.
        self.check_follows(lambda: self.do("mousemove", x, y, "mousedown", 1, "mousemove", x + 60, y + 20, "mouseup", 1,
                                           pause_s=0), "orbit")
        journal = session.with_suffix(".journal")
        self.until(lambda: journal.exists(), "journal")
        size = journal.stat().st_size
        keys = ["F6", "7", "End", "x"]
        self.check_follows(lambda: self.do(*[word for key in keys for word in ("key", key)], pause_s=0),
                           "set probe.tool")
        # Settings reach the journal after a pause in the input.
        self.until(lambda: journal.stat().st_size > size, "setting in the journal")
        self.until(lambda: self.stays(lambda: journal.stat().st_size, 2.0), "rest of the journal")
        self.program.send_signal(signal.SIGKILL)
        self.program.communicate(timeout=30)
        self.assertNotIn("window", json.loads(session.read_text()).get("cameras", {}))
        self.open_scan(session)
        self.check_key("Ctrl+S", "save")
        report = self.finish()
        self.assertEqual(list(report["voxels_in_group"]), ["3"])
        saved = json.loads(session.read_text())
        self.assertEqual(saved["camera"], "window")
        self.assertEqual(saved["view"]["arrangement"], "slices")
        self.assertEqual(saved["probe"]["group"], 7)
        self.assertEqual(saved["probe"]["brush"], "speckle")
        self.assertEqual(saved["probe"]["tool"], "trace")
        eye, target = saved["cameras"]["window"]["eye"], saved["cameras"]["window"]["target"]
        # From the front the eye stands on the -y side, exactly.
        self.assertGreater(abs(eye[0] - target[0]), 1.0, "the view was turned")


if __name__ == "__main__":
    unittest.main()
