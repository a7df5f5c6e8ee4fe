"""shvr annotate: nodes and internodes by script; saved, continued, undone."""
import os
import subprocess
import unittest
import xml.etree.ElementTree as ElementTree

from harness import ENVIRONMENT, IS_SLOW, SHVR, CliTest

NAMESPACE = "{http://graphml.graphdrawing.org/xmlns}"


def node(x, y, z, radius=2, group=1):
    return {"op": "node", "at": [x, y, z], "radius": radius, "group": group}


def expect(nodes, internodes):
    return {"op": "expect", "nodes": nodes, "internodes": internodes}


class Trace(CliTest):
    SPACING = [0.5, 1.0, 2.0]

    def setUp(self):
        super().setUp()
        self.session = self.write_session(
            volume={"procedural": "constant", "size": [24, 24, 24], "spacing": self.SPACING, "unit": "um"},
            annotation={"mask": "paint.mask", "trace": "veins.graphml"})
        self.trace = self.folder / "veins.graphml"

    def annotate(self, operations, *arguments, status=0):
        script = self.write_script("script.jsonl", operations)
        if status:
            return self.check("annotate", self.session, "--script", script, *arguments, status=status)
        return self.check_json("annotate", self.session, "--script", script, *arguments)

    def read_graph(self):
        """({id: {key: text}}, [(source, target, group)]) of the saved trace."""
        graph = ElementTree.parse(self.trace).getroot().find(NAMESPACE + "graph")

        def data(element):
            return {d.get("key"): d.text for d in element.findall(NAMESPACE + "data")}
        return ({n.get("id"): data(n) for n in graph.findall(NAMESPACE + "node")},
                [(e.get("source"), e.get("target"), data(e)["group"]) for e in graph.findall(NAMESPACE + "edge")])

    def test_nodes_are_joined_as_they_are_added(self):
        result = self.annotate([node(4, 4, 4), node(8, 4, 4, 3, 7), expect(2, 1), {"op": "deselect"}, node(1, 1, 1),
                                expect(3, 1), {"op": "save"}])
        self.assertEqual((result["nodes"], result["internodes"], result["voxels_changed"]), (3, 1, 0))
        nodes, edges = self.read_graph()
        # Voxels are converted to the volume's unit, radii by the spacing along x.
        self.assertEqual(nodes["n1"], {"x": "4", "y": "4", "z": "8", "radius": "1.5", "group": "7"})
        self.assertEqual(edges, [("n0", "n1", "7")])

    def test_every_command_of_tracing(self):
        self.annotate([
            node(2, 2, 2), node(4, 2, 2), node(6, 2, 2), expect(3, 2),
            {"op": "link", "near": [2.4, 2, 2]}, expect(3, 3),  # a loop
            {"op": "undo", "count": 1}, expect(3, 2), {"op": "redo", "count": 1}, expect(3, 3),
            {"op": "select", "near": [3.7, 2, 2]}, {"op": "move", "to": [4, 8, 2]}, {"op": "group", "group": 9},
            {"op": "radius", "radius": 4},
            {"op": "select", "near_internode": [3, 5, 2]}, {"op": "group", "group": 5},
            {"op": "select", "node": 2}, node(10, 2, 2), node(12, 2, 2), expect(5, 5),
            {"op": "select_segment"}, {"op": "group", "group": 3}, {"op": "radius", "radius": 1}, {"op": "save"}])
        nodes, edges = self.read_graph()
        self.assertEqual({n: (d["y"], d["group"], d["radius"]) for n, d in nodes.items()},
                         {"n0": ("2", "1", "1"), "n1": ("8", "9", "2"), "n2": ("2", "1", "1"),
                          "n3": ("2", "3", "0.5"), "n4": ("2", "3", "0.5")})
        self.assertEqual(edges, [("n0", "n1", "5"), ("n1", "n2", "1"), ("n2", "n0", "1"), ("n2", "n3", "3"),
                                 ("n3", "n4", "3")])
        # Continues the saved trace; the stalk is deleted as a whole, the branch stays.
        self.annotate([expect(5, 5), {"op": "select", "node": 4}, {"op": "select_segment"}, {"op": "delete"},
                       expect(3, 3), {"op": "select", "node": 2}, {"op": "delete"}, expect(2, 1),
                       {"op": "undo", "count": 2}, expect(5, 5)])
        self.annotate([expect(0, 0)], "--fresh")

    def test_sizes_of_groups(self):
        self.annotate([node(2, 2, 2, 2, 3), node(4, 2, 2, 2, 3), node(6, 2, 2, 2, 4),
                       {"op": "radius", "radius": 5, "group": 3},
                       {"op": "radius", "radius": 8, "group": 4, "of": "internodes"}, {"op": "save"}])
        nodes, _ = self.read_graph()
        self.assertEqual([nodes[f"n{i}"]["radius"] for i in range(3)], ["2.5", "2.5", "1"])
        self.assertIn('<data key="internode_radii">4=4</data>', self.trace.read_text())
        self.annotate([{"op": "radius", "radius": None, "group": 4, "of": "internodes"}, {"op": "save"}])
        self.assertNotIn("4=4", self.trace.read_text())

    def test_what_is_left_out_is_the_probes(self):
        session = self.write_session(volume={"procedural": "constant", "size": [24, 24, 24]},
                                     probe={"radius_voxels": 3.5, "group": 6})
        script = self.write_script("script.jsonl", [{"op": "node", "at": [1, 2, 3]}, {"op": "save"}])
        self.check("annotate", session, "--script", script)
        # If the session names no trace, it is written next to the mask.
        text = (self.folder / "paint.graphml").read_text()
        self.assertIn('<data key="radius">3.5</data>', text)
        self.assertIn('<data key="group">6</data>', text)

    def test_a_number_is_not_given_twice(self):
        self.annotate([node(2, 2, 2), {"op": "undo", "count": 1}, node(3, 2, 2), {"op": "save"}])
        self.annotate([{"op": "select", "node": 1}, {"op": "delete"}, {"op": "save"}])
        self.annotate([node(4, 2, 2), {"op": "save"}])
        self.assertEqual(list(self.read_graph()[0]), ["n2"])

    def test_painting_and_tracing_are_undone_in_order(self):
        paint = {"op": "paint", "brush": "fill", "region": "box", "group": 1, "threshold": 0, "radius": 6,
                 "path": [[5, 5, 5]]}
        result = self.annotate([paint, node(2, 2, 2), paint | {"group": 2}, {"op": "undo", "count": 2}, expect(0, 0),
                                {"op": "redo", "count": 1}, expect(1, 0), {"op": "undo", "count": 2},
                                {"op": "expect", "voxels_in_group": {"1": 0, "2": 0}}])
        self.assertGreater(result["voxels_changed"], 0)

    def test_a_link_reaches_no_farther_than_it_may(self):
        self.annotate([node(1, 1, 1), {"op": "deselect"}, node(6, 1, 1),
                       {"op": "link", "near": [2, 1, 1], "within": 1.5}, expect(2, 1)])

    def test_what_cannot_be_done_is_said_with_the_line(self):
        for operations, words in [
                ([{"op": "move", "to": [1, 1, 1]}], ["script.jsonl:1", "nothing is selected"]),
                ([{"op": "select", "near": [1, 1, 1]}], ["no nodes"]),
                ([node(1, 1, 1), {"op": "link", "near": [1, 1, 1]}], ["script.jsonl:2", "no other node"]),
                ([node(1, 1, 1), {"op": "select", "node": 7}], ["node 7 does not exist"]),
                ([node(1, 1, 1), node(2, 1, 1), {"op": "link", "near": [1, 1, 1]}], ["already linked"]),
                ([node(1, 1, 1), {"op": "select", "near": [9, 1, 1], "within": 3}], ["8 voxels away", "within 3"]),
                ([node(1, 1, 1), {"op": "deselect"}, node(6, 1, 1), {"op": "link", "near": [2, 1, 1], "within": 0.5}],
                 ["script.jsonl:4", "the nearest other node is 1 voxels away", "within 0.5"]),
                ([node(1, 1, 1), {"op": "select_segment"}], ["node 0 has no internodes"])]:
            with self.subTest(words=words):
                stderr = self.annotate(operations, "--fresh", status=1).stderr
                for word in words:
                    self.assertIn(word, stderr)

    def test_a_failing_expectation_is_a_gate(self):
        stderr = self.annotate([node(1, 1, 1), expect(2, 0)], status=3).stderr
        for word in ("script.jsonl:2", "1 nodes", "expected 2"):
            self.assertIn(word, stderr)

    def test_a_trace_of_another_volume_is_refused(self):
        self.annotate([node(1, 1, 1), {"op": "save"}])
        before = self.trace.read_bytes()
        self.session = self.write_session(
            volume={"procedural": "constant", "size": [24, 24, 25], "spacing": self.SPACING, "unit": "um"},
            annotation={"trace": "veins.graphml"})
        stderr = self.annotate([{"op": "save"}], status=1).stderr
        self.assertIn("session.journal: is of a volume of 24x24x24 voxels of uint8; expected 24x24x25 voxels", stderr)
        (self.folder / "session.journal").unlink()
        stderr = self.annotate([{"op": "save"}], status=1).stderr
        self.assertIn("24 24 24", stderr)
        self.assertIn("24 24 25", stderr)
        self.assertEqual(self.trace.read_bytes(), before)

    def test_a_tree_may_be_kept_as_swc_and_a_loop_not(self):
        self.session = self.write_session(volume={"procedural": "constant", "size": [24, 24, 24]},
                                          annotation={"trace": "veins.swc"})
        tree = [node(1, 1, 1), node(3, 1, 1), node(3, 3, 1)]
        self.annotate(tree + [{"op": "save"}])
        before = (self.folder / "veins.swc").read_bytes()
        self.annotate([expect(3, 2)])
        stderr = self.annotate([{"op": "select", "node": 2}, {"op": "link", "near": [1, 1, 1]}, {"op": "save"}],
                               status=1).stderr
        self.assertIn("SWC holds trees", stderr)
        self.assertEqual((self.folder / "veins.swc").read_bytes(), before)


    def test_a_node_far_outside_the_volume_is_refused(self):
        self.annotate([node(-3, 12, 12), node(24, 24, 24), {"op": "move", "to": [24, 24, 25.4]}, expect(2, 1)])
        script = self.write_script("far.jsonl", [node(5, 5, 5), node(-30, 12, 12)])
        self.check_refused("annotate", self.session, "--script", script, "--quiet",
                           says=["far.jsonl:2: the node at -30 12 12 is 30 voxel widths outside the volume of 24 x 24 x 24"])
        script = self.write_script("moved.jsonl", [{"op": "select", "node": 0}, {"op": "move", "to": [5, 5, 1e6]}])
        self.check_refused("annotate", self.session, "--script", script, "--quiet", says=["moved.jsonl:2", "outside the volume"])

    def peak_memory(self, nodes):
        """Of tracing and saving a zigzag of nodes, in bytes."""
        script = self.write_script("long.jsonl", [node(1 + i % 22, 1 + i // 22 % 22, 1 + i // 484 % 22)
                                                  for i in range(nodes)] + [{"op": "save"}])
        for old in self.folder.glob("long.journal*"):
            old.unlink()
        session = self.write_session("long.json", volume={"procedural": "constant", "size": [24, 24, 24]},
                                     annotation={"mask": "long.mask"})
        with subprocess.Popen([SHVR, "annotate", session, "--script", script, "--fresh", "--json"], env=ENVIRONMENT,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0)
        return 1024 * usage.ru_maxrss

    def test_memory_of_a_long_trace_is_bounded(self):
        nodes, most_mib = (100_000, 300) if IS_SLOW else (8_000, 40)
        self.assertLess(self.peak_memory(nodes) - self.peak_memory(1), most_mib << 20)


if __name__ == "__main__":
    unittest.main()
