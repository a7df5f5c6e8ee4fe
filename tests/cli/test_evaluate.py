"""shvr evaluate: scores of constructed annotations with known answers."""
import unittest

from harness import CliTest, Volume

KEYS = ["dice", "dice_by_group", "node_score", "node_out", "internode_score", "internode_out", "segments",
        "topological_errors", "centreline_rms_um"]


def trace_text(chains, radius=1.5):
    """Chains of places along straight lines, a node every 2, in the thesis's text. Equal places are one node."""
    index, lines, links = {}, [], []

    def number(place):
        if place not in index:
            index[place] = len(index)
            lines.append("-v {}, {}, {}, 1, {}\n".format(*place, radius))
        return index[place]
    for a, b in chains:
        parts = max(1, round(max(abs(q - p) for p, q in zip(a, b)) / 2))
        places = [tuple(p + (q - p) * i / parts for p, q in zip(a, b)) for i in range(parts + 1)]
        places[0], places[-1] = tuple(map(float, a)), tuple(map(float, b))
        links += [f"-l {number(p)}, {number(q)}, 1\n" for p, q in zip(places, places[1:])]
    return "".join(lines + links)


class Evaluate(CliTest):
    SIZE = (32, 24, 20)
    TRUTH = [((4, 12, 10), (16, 12, 10)), ((16, 12, 10), (28, 20, 10)), ((16, 12, 10), (28, 4, 10))]

    def setUp(self):
        super().setUp()
        self.session = self.write_session(volume={"procedural": "constant", "size": list(self.SIZE), "unit": "mm"})

    def mask(self, name, group_at):
        width, height, depth = self.SIZE
        path = self.folder / name
        path.write_bytes(bytes(group_at(x, y, z) for z in range(depth) for y in range(height) for x in range(width)))
        return path

    def trace(self, name, chains, radius=1.5):
        path = self.folder / name
        path.write_text(trace_text(chains, radius))
        return path

    def evaluate(self, *arguments):
        return self.check_json("evaluate", *arguments)

    def test_dice_of_two_bare_masks_needs_no_volume(self):
        truth = self.mask("truth.mask", lambda x, y, z: 1 if x < 8 else 2 if x < 16 else 0)
        mine = self.mask("mine.mask", lambda x, y, z: 1 if x < 4 else 2 if x < 12 else 0)
        for arguments in [(), ("--volume", self.session)]:
            result = self.evaluate("--truth-mask", truth, "--mask", mine, *arguments)
            self.assert_keys(result, KEYS)
            self.assertAlmostEqual(result["dice"], 2 * 12 / 28)
            self.assertAlmostEqual(result["dice_by_group"]["1"], 2 * 4 / 12)
            self.assertAlmostEqual(result["dice_by_group"]["2"], 2 * 4 / 16)
            self.assertIsNone(result["node_score"])

    def test_a_trace_is_scored_in_the_true_mask_and_against_the_true_trace(self):
        truth_mask = self.mask("truth.mask", lambda x, y, z: int(8 <= z < 12))
        truth = self.trace("truth.txt", self.TRUTH)
        arguments = ["--truth-mask", truth_mask, "--truth-trace", truth, "--volume", self.session]
        result = self.evaluate(*arguments, "--trace", truth)
        self.assertEqual((result["node_score"], result["internode_score"]), (1, 1))
        nodes = truth.read_text().count("-v")
        self.assertEqual((result["node_out"], result["internode_out"]), ([0, nodes], [0, nodes - 1]))
        self.assertEqual((result["segments"], result["topological_errors"]), ([3, 3], 0))
        self.assertAlmostEqual(result["centreline_rms_um"], 0, places=6)

        # One arm is missing, and one is linked to an empty place.
        mine = self.trace("mine.txt", self.TRUTH[:2] + [((4, 12, 10), (4, 12, 18))])
        result = self.evaluate(*arguments, "--trace", mine)
        self.assertEqual((result["segments"], result["topological_errors"]), ([2, 3], 1))
        self.assertEqual(result["topological_errors_by_kind"],
                         {"wrong": 1, "doubled": 0, "gaps": 0, "breaks": 0, "spurs": 0, "superfluous": 0})
        # Nodes at z 10 are inside, those at 12 half or less, those at 14, 16 and 18 outside.
        self.assertEqual(result["node_out"][1], mine.read_text().count("-v"))
        self.assertGreaterEqual(result["node_out"][0], 3)

    def test_a_broken_tube_and_a_spur_count_by_kind(self):
        truth_mask = self.mask("truth.mask", lambda x, y, z: 1)
        truth = self.trace("truth.txt", [((2, 12, 10), (30, 12, 10))])
        arguments = ["--truth-mask", truth_mask, "--truth-trace", truth, "--volume", self.session]
        for chains, kind in [([((2, 12, 10), (14, 12, 10)), ((18, 12, 10), (30, 12, 10))], "breaks"),
                             ([((2, 12, 10), (14, 12, 10)), ((14, 12, 10), (30, 12, 10)),
                               ((14, 12, 10), (14, 14, 10))], "spurs")]:
            result = self.evaluate(*arguments, "--trace", self.trace("mine.txt", chains))
            self.assertEqual(result["topological_errors"], 1, kind)
            self.assertEqual(result["topological_errors_by_kind"][kind], 1)

    def test_a_trace_one_voxel_beside_the_truth(self):
        truth_mask = self.mask("truth.mask", lambda x, y, z: 1)
        truth = self.trace("truth.txt", self.TRUTH)
        moved = self.trace("moved.txt", [tuple((x, y, z + 1) for x, y, z in chain) for chain in self.TRUTH])
        result = self.evaluate("--truth-mask", truth_mask, "--truth-trace", truth, "--trace", moved,
                               "--volume", self.session)
        self.assertAlmostEqual(result["centreline_rms_um"], 1000, places=6)  # a voxel of 1 mm
        self.assertEqual((result["segments"], result["topological_errors"]), ([3, 3], 0))
        thin = self.trace("thin.txt", [tuple((x, y, z + 1) for x, y, z in chain) for chain in self.TRUTH], 0)
        none = self.trace("none.txt", self.TRUTH, 0)
        result = self.evaluate("--truth-mask", truth_mask, "--truth-trace", none, "--trace", thin,
                               "--volume", self.session, "--slack", "0.5")
        self.assertEqual((result["segments"], result["topological_errors"]), ([0, 3], 3))

    def test_two_ways_between_two_branches_are_no_error(self):
        mask = self.mask("truth.mask", lambda x, y, z: 1)
        trace = self.folder / "anastomosis.txt"
        places = [(8, 12, 10), (20, 12, 10), (14, 18, 10), (2, 12, 10), (28, 12, 10)]
        trace.write_text("".join("-v {}, {}, {}, 1, 1\n".format(*place) for place in places)
                         + "".join(f"-l {a}, {b}, 1\n" for a, b in [(0, 1), (0, 2), (2, 1), (0, 3), (1, 4)]))
        result = self.evaluate("--truth-mask", mask, "--truth-trace", trace, "--trace", trace, "--volume", self.session)
        self.assertEqual((result["segments"], result["topological_errors"]), ([4, 4], 0))
        self.assertEqual(result["centreline_most_um"], 0)

    def test_the_greatest_distance_is_not_that_of_samples(self):
        mask = self.mask("truth.mask", lambda x, y, z: 1)
        truth, trace = self.folder / "truth.txt", self.folder / "trace.txt"
        truth.write_text("-v 4, 12, 10, 1, 1\n-v 28, 12, 10, 1, 1\n-l 0, 1, 1\n")
        trace.write_text("-v 4, 12, 10, 1, 1\n-v 9, 15, 14, 1, 1\n-v 28, 12, 10, 1, 1\n-l 0, 1, 1\n-l 1, 2, 1\n")
        result = self.evaluate("--truth-mask", mask, "--truth-trace", truth, "--trace", trace, "--volume", self.session)
        self.assertAlmostEqual(result["centreline_most_um"], 5000, places=5)  # 3, 4, 5 voxels of 1 mm

    def test_groups_that_do_not_match_are_said_and_can_be_matched(self):
        truth = self.mask("truth.mask", lambda x, y, z: 255 if x < 8 else 0)  # as other programs write masks
        mine = self.mask("mine.mask", lambda x, y, z: 1 if x < 8 else 2 if x < 16 else 0)
        voxels = 8 * self.SIZE[1] * self.SIZE[2]
        for arguments in [(), ("--volume", self.session)]:
            told = ["evaluate", "--truth-mask", truth, "--mask", mine, *arguments]
            result = self.check_json(*told)
            self.assertAlmostEqual(result["dice"], 2 / 3)
            self.assertEqual(result["dice_by_group"], {"1": 0, "2": 0, "255": 0})
            self.assertEqual(result["voxels_by_group"],
                             {"truth": {"255": voxels}, "mask": {"1": voxels, "2": voxels}})
            self.assertEqual(len(result["warnings"]), 1)
            for words in ["truth.mask: holds group 255, but", "mine.mask holds groups 1 and 2", "--truth-group 255=1"]:
                self.assertIn(words, result["warnings"][0])
            self.assertEqual(self.check(*told).stderr, f"warning: {result['warnings'][0]}\n")
            result = self.check_json(*told, "--truth-group", "255=1")
            self.assertEqual((result["dice_by_group"], result["warnings"]), ({"1": 1, "2": 0}, []))
        for text in ["255", "0=1", "1=256", "=", "a=b", "1=2=3"]:
            self.check_refused(*told, "--truth-group", text, status=2, says=["--truth-group", text, "255=1"])

    def test_what_is_missing_or_does_not_fit_is_said(self):
        mask = self.mask("a.mask", lambda x, y, z: 1)
        trace = self.trace("a.txt", self.TRUTH)
        self.check_refused("evaluate", "--truth-mask", mask, status=2, says=["--mask", "--trace"])
        self.check_refused("evaluate", "--truth-mask", mask, "--trace", trace, status=2, says=["--volume"])
        self.check_refused("evaluate", "--truth-mask", mask, "--mask", mask, "--truth-trace", trace, status=2)
        (self.folder / "short.mask").write_bytes(bytes(7))
        self.check_refused("evaluate", "--truth-mask", mask, "--mask", self.folder / "short.mask",
                           says=["short.mask", "7 bytes", str(32 * 24 * 20)])
        self.check_refused("evaluate", "--truth-mask", self.folder / "no.mask", "--mask", mask, says=["no.mask"])


class Projects(CliTest):
    def test_a_project_with_annotation_is_no_mask_and_one_made_of_a_mask_is(self):
        volume = Volume((6, 5, 4), [(i % 7 == 0) * 2 for i in range(120)]).write(self.folder)
        project = self.folder / "project"
        self.check("import", volume, project, "--labels")
        evaluate = ["evaluate", "--truth-mask", volume, "--mask", project]
        self.assertEqual(self.check_json(*evaluate)["dice"], 1)
        script = self.write_script("s.jsonl", [{"op": "paint", "brush": "fill", "region": "box", "group": 2,
                                                "threshold": 1, "radius": 9, "path": [[1, 1, 1]]}, {"op": "save"}])
        self.check("annotate", project, "--script", script)
        mask = project / "labels" / "paint"
        self.check_refused(*evaluate, says=["project: is a project", f"expected its mask, {mask}"])
        self.assertEqual(self.check_json("evaluate", "--truth-mask", volume, "--mask", mask)["dice"], 1)


if __name__ == "__main__":
    unittest.main()
