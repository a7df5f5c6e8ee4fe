"""The case studies of assets/case_studies, with small scans: they run from scan to figures, and assistance helps."""
import json
import re
import subprocess
import unittest
from pathlib import Path

from harness import IS_SLOW, SHVR, CliTest

STUDIES = Path(__file__).resolve().parents[3] / "assets" / "case_studies"


class CaseStudies(CliTest):
    def study(self, name):
        """What a study prints, and the names of its pictures."""
        done = subprocess.run([STUDIES / name, self.folder / name, "small", Path(SHVR).resolve()],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout, {path.stem for path in (self.folder / name).glob("*.png")}

    def test_paint_above_the_threshold_of_what_is_seen_does_not_bleed_into_dermal_tissue(self):
        text, pictures = self.study("stem")
        bleeding = [float(line.split("bleeding ")[1].split(",")[0]) for line in text.splitlines()
                    if line.startswith("threshold")]
        self.assertEqual(len(bleeding), 2, text)
        self.assertGreater(bleeding[0], 0.1)
        self.assertLess(bleeding[1], 0.02)
        self.assertEqual(pictures, {"5.6", "5.6-scan", "5.6-bled"})

    # Kind (Study): veins that leave the cropped scan, and come back
    def test_a_hand_places_no_node_outside_the_crop(self):
        path = self.trace([(x, 9, 5, 1) for x in (4, 8, 30, 12, 16, 40)], [(i, i + 1) for i in range(5)])
        lines = [json.loads(line) for line in
                 self.hand("trace", path, "--crop", "2,2,2", "--to", "20,20,20", "--shrink", 2).splitlines()]
        self.assertEqual([line["at"][0] for line in lines if line["op"] == "node"], [1, 3, 5, 7])
        self.assertEqual(len([line for line in lines if line["op"] == "deselect"]), 2)  # two pieces, not joined

    @unittest.skipUnless(IS_SLOW, "slow")
    def test_proximity_following_keeps_a_trace_in_roots(self):
        text, pictures = self.study("roots")
        score = {line.split()[1].rstrip(":"): float(line.split()[3].rstrip(",")) for line in text.splitlines()
                 if line.startswith("guided")}
        self.assertGreater(score["true"], score["false"] + 0.2)
        self.assertEqual(pictures, {"5.5", "5.5-scan", "5.5-unguided"})

    def trace(self, places, links):
        """A GraphML file of nodes (x, y, z, group)."""
        keys = "".join(f'<key id="{key}" for="node" attr.name="{key}"/>' for key in ("x", "y", "z", "group"))
        nodes = "".join(f'<node id="n{i}">' + "".join(f'<data key="{key}">{value}</data>' for key, value in
                                                      zip(("x", "y", "z", "group"), place)) + "</node>"
                        for i, place in enumerate(places))
        edges = "".join(f'<edge source="n{a}" target="n{b}"/>' for a, b in links)
        path = self.folder / "vein.graphml"
        path.write_text(f"<graphml>{keys}<graph>{nodes}{edges}</graph></graphml>")
        return path

    def hand(self, *arguments, text=True):
        return subprocess.run([STUDIES / "hand.py", *map(str, arguments)], capture_output=True, text=text,
                              check=True).stdout

    # Kind (Study): a scan darker towards its axis; veins that leave the crop, or end in another section
    def test_a_hand_paints_florets_and_veins_of_a_section_up_to_the_faces_of_the_crop(self):
        path = self.trace([(50, 50, 40, 2), (90, 50, 40, 2), (50, 50, 50, 3), (50, 50, 60, 3)],
                          [(1, 0), (0, 2), (2, 3)])
        where = ["--size", 100, "--crop", "2,2,2", "--to", "70,98,98", "--shrink", 2]
        lines = [json.loads(line) for line in
                 self.hand("paint", path, *where, "--section", 2, "--threshold", 90, "--on-axis", 50).splitlines()]
        self.assertEqual(len(lines), 1)
        self.assertEqual((lines[0]["group"], lines[0]["path"]), (2, [[34, 24, 19], [24, 24, 19]]))
        self.assertEqual(lines[0]["threshold"], 51.6)  # 50 + 40 (10 / 50)^2
        floret, = self.hand("florets", path, *where, "--section", 3, "--from", 4, "--up", 10).splitlines()
        self.assertEqual(json.loads(floret)["path"], [[24, 24, 31], [24, 24, 34]])
        vein, = self.hand("paint", path, "--section", 3).splitlines()
        self.assertEqual((json.loads(vein)["group"], len(json.loads(vein)["path"])), (3, 3))

    def test_a_halved_truth_is_what_fills_half_of_eight_voxels(self):
        mask = bytearray(6 * 6 * 6)
        for x, y, z, group in [(2, 2, 2, 3), (3, 2, 2, 3), (2, 3, 2, 1), (3, 3, 3, 3),
                               (4, 2, 2, 1), (4, 3, 2, 1), (5, 2, 2, 1)]:
            mask[x + 6 * (y + 6 * z)] = group
        path = self.folder / "true.raw"
        path.write_bytes(mask)
        halved = self.hand("mask", path, "--size", 6, "--crop", "2,2,2", "--to", "6,6,6", "--shrink", 2, text=False)
        self.assertEqual(halved, bytes([3, 0, 0, 0, 0, 0, 0, 0]))

    @unittest.skipUnless(IS_SLOW, "slow")
    def test_a_flower_head_is_annotated_from_scan_to_figures(self):
        text, pictures = self.study("gerbera")
        scores = {line.rsplit(" ", 1)[0]: float(line.rsplit(" ", 1)[1]) for line in text.splitlines()
                  if not line.startswith("==")}
        self.assertGreater(scores["dice"], 0.75)
        self.assertGreater(scores["dice of group 3"], 0.75)
        self.assertGreater(scores["node_score"], 0.8)
        self.assertEqual(pictures, {"4.4", "4.7-before", "4.7-after", "5.1a", "5.2b", "5.2c"})

    def test_every_figure_has_a_caption(self):
        named = set()
        for name, letters, last in re.findall(r"`([0-9.]+)([-a-zA-Z]*)[.]png`(?: to `[0-9.]+([a-d])[.]png`)?",
                                              (STUDIES / "README.md").read_text()):
            ends = [name + letters] if not last else [name + chr(code) for code in range(ord(letters), ord(last) + 1)]
            for end in ends:
                named |= ({end.replace("SPECIES", species) for species in ("gerbera", "helianthus", "bellis")}
                          if "SPECIES" in end else {end})
        lines = [line.split("\t") for line in (STUDIES / "captions.txt").read_text().splitlines()]
        self.assertTrue(all(len(line) == 2 and len(line[1]) > 12 for line in lines))
        self.assertEqual(sorted(line[0] for line in lines), sorted(named))

    @unittest.skipUnless(IS_SLOW, "slow")
    def test_every_figure_of_the_table_is_drawn(self):
        _, pictures = self.study("figures")
        rows = [line for line in (STUDIES / "README.md").read_text().splitlines() if "`figures`" in line]
        named = {name for row in rows for name in re.findall(r"`([0-9.]+[-a-z]*)[.]png`", row)}
        self.assertGreater(len(named), 15)
        self.assertLessEqual(named - {"5.1a", "5.2b", "5.2c"}, pictures)
        # Figure 6.6: (a) painting stops before the bundle's end; (d) an adaxial vein, all of it, is not painted.
        self.assertGreater(min(z for _, _, z in self.unpainted("6.6a")), 16)  # its root is at 15
        places = [x for x, _, _ in self.unpainted("6.6d")]
        self.assertGreater(max(places) - min(places), 32)  # of 34

    def unpainted(self, mistake, side=40):
        """The voxels of the partial truth that a figure of a mistake lacks."""
        true, painted = ((self.folder / "figures" / "section" / f"{name}.mask").read_bytes()
                         for name in ("partial", mistake))
        return [(i % side, i // side % side, i // side ** 2) for i in range(side ** 3) if true[i] and not painted[i]]


if __name__ == "__main__":
    unittest.main()
