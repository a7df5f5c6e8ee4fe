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
        keys = "".join(f'<key id="{key}" for="node" attr.name="{key}"/>' for key in ("x", "y", "z", "group"))
        places = [(4, 9), (8, 9), (30, 9), (12, 9), (16, 9), (40, 9)]
        nodes = "".join(f'<node id="n{i}"><data key="x">{x}</data><data key="y">{y}</data><data key="z">5</data>'
                        '<data key="group">1</data></node>' for i, (x, y) in enumerate(places))
        edges = "".join(f'<edge source="n{i}" target="n{i + 1}"/>' for i in range(len(places) - 1))
        path = self.folder / "vein.graphml"
        path.write_text(f"<graphml>{keys}<graph>{nodes}{edges}</graph></graphml>")
        done = subprocess.run([STUDIES / "hand.py", "trace", path, "--crop", "2,2,2", "--to", "20,20,20",
                               "--shrink", "2"], capture_output=True, text=True, check=True)
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        self.assertEqual([line["at"][0] for line in lines if line["op"] == "node"], [1, 3, 5, 7])
        self.assertEqual(len([line for line in lines if line["op"] == "deselect"]), 2)  # two pieces, not joined

    @unittest.skipUnless(IS_SLOW, "slow")
    def test_proximity_following_keeps_a_trace_in_roots(self):
        text, pictures = self.study("roots")
        score = {line.split()[1].rstrip(":"): float(line.split()[3].rstrip(",")) for line in text.splitlines()
                 if line.startswith("guided")}
        self.assertGreater(score["true"], score["false"] + 0.2)
        self.assertEqual(pictures, {"5.5", "5.5-scan", "5.5-unguided"})

    @unittest.skipUnless(IS_SLOW, "slow")
    def test_a_flower_head_is_annotated_from_scan_to_figures(self):
        text, pictures = self.study("gerbera")
        self.assertIn("node_score", text)
        self.assertEqual(pictures, {"4.4", "4.7-before", "4.7-after", "5.1a", "5.1c", "5.2b", "5.2c"})

    @unittest.skipUnless(IS_SLOW, "slow")
    def test_every_figure_of_the_table_is_drawn(self):
        _, pictures = self.study("figures")
        rows = [line for line in (STUDIES / "README.md").read_text().splitlines() if "`figures`" in line]
        named = {name for row in rows for name in re.findall(r"`([0-9.]+[-a-z]*)[.]png`", row)}
        self.assertGreater(len(named), 15)
        self.assertLessEqual(named - {"5.1a", "5.1c", "5.2b", "5.2c"}, pictures)


if __name__ == "__main__":
    unittest.main()
