"""What is done in the window can be replayed without one, and comes back after the program was killed."""
import json
import signal
import time
import unittest

from seen import Seen


class Log(Seen):
    def test_what_was_done_in_the_window_is_replayed_without_one(self):
        session = self.write_ball()
        again = self.folder / "again" / "session.json"
        again.parent.mkdir()
        again.write_text(session.read_text())
        log = self.folder / "log.jsonl"
        self.start(session, "--log", log, environment=self.with_keys(near_y_in="U"))
        self.wait_for_window("sphere.* - SHVR")
        x, y = self.middle()
        self.put_probe(x, y)
        self.stroke((x, y), (x + 12, y + 4), (x + 30, y + 10))
        self.do("key", "5", "keydown", "u", "sleep", 0.3, "keyup", "u", pause_s=0.5)
        self.put_probe(x - 30, y - 20)
        self.stroke((x - 30, y - 20), (x - 20, y - 35))
        self.do("key", "x", "key", "n", pause_s=0.3)
        self.do("mousemove", x + 20, y, pause_s=0.7)   # in the tool that traces the probe follows what is seen
        self.do("key", "n", "key", "ctrl+z", "key", "ctrl+y", pause_s=0.5)
        report = self.finish()
        self.assertEqual(sorted(report["voxels_in_group"]), ["3", "5"])
        lines = [json.loads(line) for line in log.read_text().splitlines()]
        self.assertEqual([line for line in lines if line["op"] == "redo"], [{"op": "redo", "count": 1}])
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

    @staticmethod
    def stays(measure, seconds):
        before = measure()
        time.sleep(seconds)
        return measure() == before

    def test_the_window_that_opens_after_a_kill_is_the_one_that_was_there(self):
        session = self.write_ball()
        self.open_scan(session)
        x, y = self.middle()
        self.assertIn("probe_onto", self.what_follows(lambda: self.put_probe(x, y), "probe_onto"))
        self.assertIn("paint_here", self.what_follows(lambda: self.stroke((x, y), (x + 10, y)), "paint_here"))
        # Other view, panes, brush and tool; none of it is saved.
        self.do("mousemove", x, y, "mousedown", 1, "mousemove", x + 60, y + 20, "mouseup", 1)
        journal = session.with_suffix(".journal")
        self.until(lambda: journal.exists(), "journal")
        size = journal.stat().st_size
        keys = ["F6", "7", "End", "x"]
        self.assertIn("set probe.tool", self.what_follows(lambda: self.do(*[word for key in keys for word in ("key", key)]),
                                                          "set probe.tool"))
        # What was set reaches the journal when the hand has rested for a while.
        self.until(lambda: journal.stat().st_size > size, "setting in the journal")
        self.until(lambda: self.stays(lambda: journal.stat().st_size, 2.0), "rest of the journal")
        self.program.send_signal(signal.SIGKILL)
        self.program.communicate(timeout=30)
        self.assertNotIn("window", json.loads(session.read_text()).get("cameras", {}))
        self.start(session)
        self.wait_for_window("sphere.* - SHVR")
        self.do("key", "ctrl+s", pause_s=1)
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
