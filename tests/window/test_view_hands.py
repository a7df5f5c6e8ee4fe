"""Hands: the tools of the mouse, strokes that jump, clicks that select, trace and measure, and slices; by real events."""
import json
import re
import unittest

from seen import Seen
from window import WINDOW


class Hands(Seen):
    def begin(self, tool, **probe):
        session = self.write_ball(probe={"radius_voxels": 4, "group": 3, "paint_threshold": 120, "tool": tool, **probe})
        # A session that was left painting opens with turning.
        self.open_scan(session, "--set", f"probe.tool={tool}", preferences={"hints_seen": 3})
        return session, *self.middle()

    def drag(self, *places, makes, button=1, meanwhile=()):
        """With a button held from the first place to the last, and a modifier down as `meanwhile` says."""
        moves = [word for place in places[1:] for word in ("mousemove", *place, "sleep", 0.05)]
        down, up = (["keydown", meanwhile], ["keyup", meanwhile]) if meanwhile else ([], [])
        self.check_follows(lambda: self.do(
            "mousemove", *places[0], *down, "sleep", 0.1, "mousedown", button, "sleep", 0.05, *moves, "mouseup", button,
            *up, pause_s=0), makes)

    def click(self, x, y, makes):
        self.check_follows(lambda: self.do("mousemove", x, y, "sleep", 0.1, "click", 1, pause_s=0), makes)

    def save(self):
        """Waits until the window says so; something else must have been said since it did so before."""
        self.check_key("Ctrl+S", "save")
        self.see("Saved", "Status")

    def camera_of(self, session):
        return json.loads(session.read_text())["cameras"].get("window")

    def test_the_left_button_paints_and_erases_on_what_is_seen_and_the_right_one_turns(self):
        session, x, y = self.begin("paint")
        self.save()
        before = self.camera_of(session)
        self.drag((x, y), (x + 20, y + 5), (x + 40, y + 10), makes="paint_here")
        self.see("Painted", "Status")
        self.save()
        self.assertEqual(self.camera_of(session), before)
        self.check_key("Alt+3", "set probe.tool")
        self.drag((x, y), (x + 10, y), makes="paint_here")
        self.drag((x, y + 60), (x + 30, y + 60), button=3, makes="orbit")
        report = self.finish()   # which saves
        said = "\n".join(report["messages"])
        self.assertIn("Painted", said)
        self.assertGreater(report["voxels_in_group"].get("3", 0), 20, said)
        self.assertEqual(report["undoable"], 2, said)   # a stroke of each tool
        self.assertNotEqual(self.camera_of(session), before)

    def test_a_pointer_that_jumps_while_painting_paints_nothing_in_between(self):
        _, x, y = self.begin("turn", paint_threshold=0, brush="fill")
        # The same way, slowly and in one motion; the probe stays in its plane.
        self.check_probe(x, y)
        steps = [(x - 80 + 20 * i, y) for i in range(9)]
        self.check_stroke(*steps)
        self.see("Painted", "Status")
        self.check_key("Ctrl+Z", "undo")
        self.check_key("7", "set probe.group")
        self.check_stroke(steps[0], steps[-1])
        report = self.finish()
        said = "\n".join(report["messages"])
        slowly, jumping = (int(re.search(rf"Painted ([0-9]+) voxels in group {group}", said)[1]) for group in (3, 7))
        self.assertLess(jumping, 0.7 * slowly, said)
        self.assertGreater(jumping, 300, said)   # a ball at each end

    def test_the_first_motion_after_a_panel_takes_the_probe_along(self):
        _, x, y = self.begin("turn")
        self.check_probe(x - 100, y)
        self.do("mousemove", WINDOW[0] - 100, y, pause_s=0)   # over the side panel
        self.see_frames()
        self.check_follows(lambda: self.do("mousemove", x, y, "keydown", "f", "keyup", "f", pause_s=0), "paint_here")
        report = self.finish()
        # Seen from the front, x of the volume is to the right: the probe was put to the middle by that motion.
        self.assertAlmostEqual(report["probe_voxel"][0], 32.0, delta=3.0)

    def test_nodes_are_clicked_dragged_and_linked(self):
        _, x, y = self.begin("trace", centered_nodes=False)
        for at in [(x - 60, y), (x, y - 60), (x + 60, y)]:
            self.click(*at, makes="node")
        self.click(x - 60, y, makes="select")   # the first again
        self.drag((x, y - 60), (x, y - 40), (x + 10, y - 30), makes="drag_node")
        report = self.finish()
        said = "\n".join(report["messages"])
        for line in ["Node 0 added", "Node 1 added, linked with node 0", "Node 2 added, linked with node 1",
                     "Node 0 is selected", "Node 1 is selected", "Node 1 was moved"]:
            self.assertIn(line, said)

    def test_a_click_takes_the_group_that_is_painted_there_and_a_double_click_puts_the_probe_there(self):
        _, x, y = self.begin("turn")
        self.check_probe(x, y)
        self.check_follows(lambda: self.do("key", "f", pause_s=0), "paint_here")
        self.see("Painted", "Status")
        self.check_key("5", "set probe.group")
        self.see("Group 5", "Status")
        self.do("mousemove", x, y, "sleep", 0.1, "click", 1, pause_s=0)
        self.see("Group 3: group 3", "Status")   # once no second click has come
        report = self.finish()
        said = report["messages"]
        self.assertIn("Group 3: group 3", said)
        self.assertEqual(sum(line.startswith("Probe at voxel") for line in said), 1)

    def test_a_distance_is_clicked(self):
        _, x, y = self.begin("measure")
        self.click(x - 50, y, makes="measure_at")
        self.click(x + 50, y, makes="measure_at")
        self.check_key("Ctrl+C", "copy_measurements")
        self.check_key("Escape", "set probe.tool")
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertRegex(said, r"Distance 1: [0-9.]+ voxels")
        self.assertIn("1 measurement is on the clipboard", said)
        self.assertNotIn("Measurements are removed", said)   # nothing would bring them back

    def test_in_a_slice_the_brush_paints_and_the_contrast_is_dragged(self):
        session, x, y = self.begin("paint")
        self.do("mousemove", x, y, pause_s=0)
        self.check_key("F6", "set view.arrangement")
        self.see_picture()
        right, above = x + 140, y - 130   # in the slice across z
        self.drag((right, above), (right + 15, above), makes="paint_here")
        self.drag((right, above), (right + 20, above + 10), (right + 40, above + 20), meanwhile="ctrl",
                  makes="set view.slices.black, view.slices.white")
        dragged = self.saved(session)["view"]["slices"]
        self.check_key("B", "auto_contrast")
        automatic = self.saved(session)["view"]["slices"]
        report = self.finish()
        self.assertGreater(report["voxels_in_group"].get("3", 0), 20, report["messages"])
        self.assertNotEqual((dragged["black"], dragged["white"]), (automatic["black"], automatic["white"]))
        self.assertGreater(dragged["white"] - dragged["black"], automatic["white"] - automatic["black"])

    def test_views_are_kept_and_looked_from_again(self):
        session, x, y = self.begin("turn")
        self.do("mousemove", x, y, pause_s=0)
        self.check_key("Ctrl+D", "keep_camera")
        self.drag((x, y), (x + 40, y), (x + 80, y + 20), makes="orbit")
        self.check_key("Shift+1", "look_from")
        cameras = self.saved(session)["cameras"]
        report = self.finish()
        said = "\n".join(report["messages"])
        self.assertIn("This view is kept as view 1", said)
        self.assertIn("Looking from view 1", said)
        self.assertEqual(cameras["window"], cameras["view 1"])


if __name__ == "__main__":
    unittest.main()
