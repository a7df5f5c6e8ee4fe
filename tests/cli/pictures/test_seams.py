"""Pictures while they refine: where bricks of one level stand next to those of the next, the step between neighbouring
pixels is at most twice that inside bricks. Fine chunks of every second column are torn, so coarser levels are drawn in
their place, as they are until fine ones have been read. Two levels or more lie between neighbours only where chunks
cannot be read (gpu/paging_levels); there the step is not much more than twice."""
import json
import lzma
import shutil
import unittest
from pathlib import Path

from harness import CliTest
from test_figure import read_pfm

MOST, MOST_OF_FAR_LEVELS = 2.0, 2.4
CHUNK = 64
ASSETS = Path(__file__).resolve().parents[3] / "assets" / "examples"


class Seams(CliTest):
    def project_of(self, scan, name, *options):
        project = self.folder / name
        self.check("import", scan, project, "--quiet", *options)
        return project

    def torn(self, project, size, levels=()):
        """A copy whose chunks are unreadable in every second column along y, and everywhere in those coarser levels."""
        copy = self.folder / "torn"
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(project, copy)
        broken = [path for z in range(-(-size[2] // CHUNK)) for x in range(-(-size[0] // CHUNK)) if (x + z) % 2
                  for path in (copy / "0" / str(z)).glob(f"*/{x}")]
        self.assertTrue(broken)
        for level in levels:
            broken += [path for path in (copy / str(level)).rglob("*") if path.is_file() and not path.name.startswith(".")]
        for path in broken:
            path.write_bytes(b"torn")
        return copy

    def ratio(self, project, size, settings):
        """The mean step across borders of chunks, by the mean step next to them, inside; a voxel is a pixel."""
        x, y, z = size
        camera = {"eye": [x / 2, -3 * y, z / 2], "target": [x / 2, y / 2, z / 2], "up": [0, 0, 1],
                  "projection": "orthographic", "height": z}
        path = self.folder / "a.pfm"
        patch = [word for key, value in settings.items() for word in ("--set", f"{key}={json.dumps(value)}")]
        self.check("render", project, "-o", path, "--size", f"{x}x{z}", "--camera", json.dumps(camera), "--quiet",
                   "--allow-incomplete", "--set", 'render.paging="always"', *patch)
        rows = [[sum(pixel) for pixel in row] for row in read_pfm(path)]
        across, inside = [], []
        for line, flipped in [(row, False) for row in rows] + [(column, True) for column in zip(*rows)]:
            line = line[::-1] if flipped else line   # z grows upwards
            for border in range(CHUNK, len(line), CHUNK):
                steps = [abs(line[border + i] - line[border + i - 1]) for i in range(-6, 7)]
                if any(steps):
                    across.append(steps[6])
                    inside += steps[:5] + steps[8:]
        self.assertGreater(len(across), 200)
        return sum(across) / len(across) / (sum(inside) / len(inside))

    def check_scene(self, name, scan, size, settings):
        project = self.project_of(scan, name)
        whole = self.ratio(project, size, settings)
        found = {"no border": whole}
        for levels in ((), (1,), (1, 2)):
            found[f"levels 0 and {len(levels) + 1}"] = self.ratio(self.torn(project, size, levels), size, settings)
        print(f"{name}: step across borders by step inside: " + ", ".join(f"{k} {v:.2f}" for k, v in found.items()))
        for what, ratio in found.items():
            self.assertLessEqual(ratio, MOST if what in ("no border", "levels 0 and 1") else MOST_OF_FAR_LEVELS, what)
        return project

    def test_a_phantom(self):
        size = (192, 192, 192)
        self.check("phantom", "tubes", "--size", size[0], "--seed", 3, "-o", self.folder / "phantom", "--quiet")
        points = [{"intensity": 90, "color": "#c04020", "opacity": 0}, {"intensity": 140, "color": "#e0b050", "opacity": 0.05},
                  {"intensity": 255, "color": "#ffffff", "opacity": 0.05}]
        scan, settings = self.folder / "phantom" / "tubes.nhdr", {"transfer_function": {"points": points}}
        wrong = self.torn(self.check_scene("tubes", scan, size, settings), size)
        # A coarse level that shows something else is seen to do so.
        other = self.project_of(scan, "reversed", "--reverse")
        shutil.rmtree(wrong / "1")
        shutil.copytree(other / "1", wrong / "1")
        shutil.copy(other / "shvr" / "checksums-1", wrong / "shvr" / "checksums-1")
        self.assertGreater(self.ratio(wrong, size, settings), MOST_OF_FAR_LEVELS)

    def test_a_scan(self):
        (self.folder / "stent.raw").write_bytes(lzma.decompress((ASSETS / "stent.raw.xz").read_bytes()))
        scan = self.folder / "stent.nhdr"
        scan.write_text("NRRD0004\ntype: short\ndimension: 3\nsizes: 128 128 256\nencoding: raw\nendian: little\n"
                        "data file: stent.raw\n")
        session = json.loads((ASSETS / "stent.session.json").read_text())
        self.check_scene("scan", scan, (128, 128, 256), {key: session[key] for key in ("transfer_function", "light")})


if __name__ == "__main__":
    unittest.main()
