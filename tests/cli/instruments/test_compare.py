"""shvr compare: error between two pictures."""
import json
import struct
import unittest
import zlib

from harness import CliTest, read_png_header

KEYS = ["max_abs", "rmse", "alpha_rmse", "psnr_db", "ssim", "flip_mean", "flip_p99", "fraction_over_1",
        "fraction_over_4"]


def write_png(path, width, height, pixel):
    """An 8-bit RGBA file; `pixel(x, y)` gives its four numbers."""
    rows = b"".join(b"\0" + b"".join(bytes(pixel(x, y)) for x in range(width)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
                     chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
    return path


class Compare(CliTest):
    def setUp(self):
        super().setUp()
        self.a = write_png(self.folder / "a.png", 20, 10, lambda x, y: (100, 100, 100, 255))
        # Ten of 200 pixels differ by 6 levels in one of four channels.
        self.b = write_png(self.folder / "b.png", 20, 10, lambda x, y: (106 if x == 3 else 100, 100, 100, 255))

    def test_equal_pictures(self):
        result = self.check_json("compare", self.a, self.a)
        self.assert_keys(result, KEYS)
        self.assertEqual((result["max_abs"], result["rmse"], result["flip_mean"]), (0, 0, 0))
        self.assertEqual((result["ssim"], result["psnr_db"]), (1, None))

    def test_a_known_difference(self):
        result = self.check_json("compare", self.a, self.b)
        self.assertEqual(result["max_abs"], 6)
        self.assertAlmostEqual(result["rmse"], (10 * 36 / 600) ** 0.5, places=9)
        self.assertAlmostEqual(result["fraction_over_1"], 0.05, places=9)
        self.assertAlmostEqual(result["fraction_over_4"], 0.05, places=9)
        self.assertLess(result["ssim"], 1)
        self.assertGreater(result["flip_mean"], 0)
        self.assertEqual(result["size"], [20, 10])

    def test_the_difference_as_a_picture(self):
        picture = self.folder / "diff.png"
        self.check_json("compare", self.a, self.b, "--diff", picture)
        self.assertEqual(read_png_header(picture), (20, 10))
        # 6 levels times 16, compared with a picture of that value.
        expected = write_png(self.folder / "expected.png", 20, 10,
                             lambda x, y: (96 if x == 3 else 0, 0, 0, 255))
        self.assertEqual(self.check_json("compare", picture, expected)["max_abs"], 0)

    def test_gates(self):
        self.check("compare", self.a, self.b, "--max-abs", "6", "--max-rmse", "1")
        for gate in (["--max-abs", "5"], ["--max-rmse", "0.5"]):
            result = self.check("compare", self.a, self.b, *gate, "--json", status=3)
            self.assertIn(gate[0], result.stderr)
            self.assertIn('"max_abs"', result.stdout)  # the numbers are printed either way

    # Kind (Instruments): pictures that differ in alpha
    def test_the_error_of_alpha_is_gated(self):
        faint = write_png(self.folder / "faint.png", 20, 10, lambda x, y: (100, 100, 100, 251))
        result = self.check("compare", self.a, faint, "--max-rmse", "3", "--json", status=3)
        self.assertIn("alpha of", result.stderr)
        numbers = json.loads(result.stdout)
        self.assertEqual((numbers["rmse"], numbers["alpha_rmse"], numbers["psnr_db"]), (0, 4, None))
        self.check("compare", self.a, faint, "--max-rmse", "4")

    def test_sizes_that_differ_are_refused(self):
        other = write_png(self.folder / "other.png", 10, 20, lambda x, y: (0, 0, 0, 255))
        self.check_refused("compare", self.a, other, says=["a.png has 20 x 10", "other.png has 10 x 20"])

    def test_files_that_are_no_pictures_are_refused(self):
        broken = self.folder / "broken.png"
        broken.write_bytes(self.a.read_bytes()[:60])
        self.check_refused("compare", self.a, broken, says=["broken.png"])
        self.check_refused("compare", self.a, self.folder / "none.png", says=["none.png"])


if __name__ == "__main__":
    unittest.main()
