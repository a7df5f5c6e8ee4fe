"""Hands: the tools of the mouse, strokes that jump, clicks that select, trace and measure, and slices; by real events."""
import json
import re
import time
import unittest

from window import PATIENCE_S, WINDOW, Window


class Hands(Window):
    def begin(self, tool, **probe):
        session = self.write_ball(probe={"radius_voxels": 4, "group": 3, "paint_threshold": 120, "tool": tool, **probe})
        self.start(session, "--set", f"probe.tool={tool}")   # a session that was left painting opens with turning
        self.wait_for_window("sphere.* - SHVR")
        return session, *self.middle()

    def drag(self, *places, button=1, pause_s=0.6):
        """With a button held from the first place to the last."""
        moves = [word for place in places[1:] for word in ("mousemove", *place, "sleep", 0.05)]
        self.do("mousemove", *places[0], "sleep", 0.1, "mousedown", button, "sleep", 0.05, *moves, "mouseup", button,
                pause_s=pause_s)

    def click(self, x, y, pause_s=0.6):
        self.do("mousemove", x, y, "sleep", 0.1, "click", 1, pause_s=pause_s)

    def save(self, session):
        """Waits until the session's file is another one: something in it must have changed."""
        before = session.stat().st_mtime_ns
        self.do("key", "ctrl+s", pause_s=0)
        end = time.monotonic() + PATIENCE_S
        while session.stat().st_mtime_ns == before:
            self.assertLess(time.monotonic(), end, "nothing is saved")
            time.sleep(0.02)
        return json.loads(session.read_text())

    def camera_of(self, session):
        return json.loads(session.read_text())["cameras"].get("window")

    def test_the_left_button_paints_and_erases_on_what_is_seen_and_the_right_one_turns(self):
        session, x, y = self.begin("paint")
        self.do("key", "ctrl+s", pause_s=0.7)
        before = self.camera_of(session)
        self.drag((x, y), (x + 20, y + 5), (x + 40, y + 10), pause_s=1.2)
        self.do("key", "ctrl+s", pause_s=0.7)
        self.assertEqual(self.camera_of(session), before)
        self.do("key", "alt+3", pause_s=0.4)
        self.drag((x, y), (x + 10, y), pause_s=1.2)
        self.drag((x, y + 60), (x + 30, y + 60), button=3)
        self.do("key", "ctrl+s", pause_s=0.7)
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertIn("Painted", said)
        self.assertGreater(report["voxels_in_group"].get("3", 0), 20, said)
        self.assertEqual(report["undoable"], 2, said)   # a stroke of each tool
        self.assertNotEqual(self.camera_of(session), before)

    def test_a_pointer_that_jumps_while_painting_paints_nothing_in_between(self):
        _, x, y = self.begin("turn", paint_threshold=0, brush="fill")
        # The same way, slowly and in one motion; the probe stays in its plane.
        self.put_probe(x, y)
        steps = [(x - 80 + 20 * i, y) for i in range(9)]
        self.stroke(*steps, pause_s=1.5)
        self.do("key", "ctrl+z", "key", "7", pause_s=0.5)
        self.stroke(steps[0], steps[-1], pause_s=1.5)
        report = self.finish()
        said = "\n".join(report["messages"])
        slowly, jumping = (int(re.search(rf"Painted ([0-9]+) voxels in group {group}", said)[1]) for group in (3, 7))
        self.assertLess(jumping, 0.7 * slowly, said)
        self.assertGreater(jumping, 300, said)   # a ball at each end

    def test_the_first_motion_after_a_panel_takes_the_probe_along(self):
        _, x, y = self.begin("turn")
        self.put_probe(x - 100, y)
        self.do("mousemove", WINDOW[0] - 100, y, pause_s=0.6)   # over the side panel
        self.do("mousemove", x, y, "keydown", "f", "keyup", "f", pause_s=1.2)
        report = self.finish()
        # Seen from the front, x of the volume is to the right: the probe was put to the middle by that motion.
        self.assertAlmostEqual(report["probe_voxel"][0], 32.0, delta=3.0)

    def test_nodes_are_clicked_dragged_and_linked(self):
        _, x, y = self.begin("trace", centered_nodes=False)
        for at in [(x - 60, y), (x, y - 60), (x + 60, y)]:
            self.click(*at)
        self.click(x - 60, y)   # selects the first again
        self.drag((x, y - 60), (x, y - 40), (x + 10, y - 30))
        report = self.finish()
        said = "\n".join(report["messages"])
        for line in ["Node 0 added", "Node 1 added, linked with node 0", "Node 2 added, linked with node 1",
                     "Node 0 is selected", "Node 1 is selected", "Node 1 was moved"]:
            self.assertIn(line, said)

    def test_a_click_takes_the_group_that_is_painted_there_and_a_double_click_puts_the_probe_there(self):
        _, x, y = self.begin("turn")
        self.put_probe(x, y)
        self.do("key", "f", pause_s=1.2)
        self.do("key", "5", pause_s=0.3)
        self.click(x, y, pause_s=1.0)
        report = self.finish()
        said = report["messages"]
        self.assertIn("Group 3: group 3", said)
        self.assertEqual(sum(line.startswith("Probe at voxel") for line in said), 1)

    def test_a_distance_is_clicked(self):
        _, x, y = self.begin("measure")
        self.click(x - 50, y)
        self.click(x + 50, y)
        self.do("key", "ctrl+c", pause_s=0.3)
        self.do("key", "Escape", pause_s=0.3)
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertRegex(said, r"Distance 1: [0-9.]+ voxels")
        self.assertIn("1 distance is on the clipboard", said)
        self.assertNotIn("Distances are removed", said)   # nothing would bring them back

    def test_in_a_slice_the_brush_paints_and_the_contrast_is_dragged(self):
        session, x, y = self.begin("paint")
        self.do("mousemove", x, y, "key", "F6", pause_s=1.0)
        right, above = x + 140, y - 130   # in the slice across z
        self.drag((right, above), (right + 15, above), pause_s=1.2)
        self.do("keydown", "ctrl", pause_s=0.1)
        self.drag((right, above), (right + 20, above + 10), (right + 40, above + 20))
        self.do("keyup", "ctrl", pause_s=0.1)
        dragged = self.save(session)["view"]["slices"]
        self.do("key", "b", pause_s=0.5)
        automatic = self.save(session)["view"]["slices"]
        report = self.finish()
        self.assertGreater(report["voxels_in_group"].get("3", 0), 20, report["messages"])
        self.assertNotEqual((dragged["black"], dragged["white"]), (automatic["black"], automatic["white"]))
        self.assertGreater(dragged["white"] - dragged["black"], automatic["white"] - automatic["black"])

    def test_views_are_kept_and_looked_from_again(self):
        session, x, y = self.begin("turn")
        self.do("mousemove", x, y, "key", "ctrl+d", pause_s=0.4)
        self.drag((x, y), (x + 40, y), (x + 80, y + 20))
        self.do("key", "shift+1", pause_s=0.5)
        self.do("key", "ctrl+s", pause_s=0.7)
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertIn("This view is kept as view 1", said)
        self.assertIn("Looking from view 1", said)
        cameras = json.loads(session.read_text())["cameras"]
        self.assertEqual(cameras["window"], cameras["view 1"])


if __name__ == "__main__":
    unittest.main()
