"""shvr render --scale-bar, --color-bar, --legend, --axes, --measurements, --title, --text: what publications need beside a picture."""
import struct
import unittest

from harness import CliTest

SIDE = 96
EDGE = 8  # 0.8 lines of text, which are 10 pixels high
# One pixel is a quarter of a voxel.
FLAT = '{"projection":"orthographic","eye":[12,-60,12],"target":[12,12,12],"height":24}'
BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)


def read_pfm(path):
    """Rows from the top, each a list of colours in linear light."""
    kind, size, scale, rest = path.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    assert kind == b"PF" and float(scale) < 0
    values = struct.unpack(f"<{3 * width * height}f", rest)
    colors = list(zip(values[0::3], values[1::3], values[2::3]))
    return [colors[width * row:width * (row + 1)] for row in reversed(range(height))]


def changed(before, after):
    """The box of the pixels that differ: (left, top, right, bottom), half-open."""
    places = [(x, y) for y, row in enumerate(before) for x, color in enumerate(row) if color != after[y][x]]
    if not places:
        return None
    return (min(x for x, _ in places), min(y for _, y in places),
            max(x for x, _ in places) + 1, max(y for _, y in places) + 1)


class Figure(CliTest):
    def setUp(self):
        super().setUp()
        # Nothing of the volume is visible, so that each pixel is the background or an element.
        self.session = self.write_session(render={"size": [SIDE, SIDE]}, transfer_function={"points": [
            {"intensity": 0, "color": "#ff0000", "opacity": 0}, {"intensity": 100, "color": "#0000ff", "opacity": 0}]})

    def picture(self, *arguments, camera=FLAT, warnings=()):
        path = self.folder / "a.pfm"
        result = self.check_json("render", self.session, "-o", path, "--camera", camera, *arguments)
        self.assertEqual(len(result["warnings"]), len(warnings), result["warnings"])
        for warning, words in zip(result["warnings"], warnings):
            self.assertIn(words, warning)
        return read_pfm(path)

    def test_a_scale_bar_is_as_long_as_it_says(self):
        rows = self.picture("--scale-bar")
        # At most 0.3 of the width, 7.2 voxels: 5 voxels are 20 pixels, which end at the edge.
        expected = [SIDE - EDGE - 20 <= x < SIDE - EDGE for x in range(SIDE)]
        for y in (SIDE - EDGE - 2, SIDE - EDGE - 1):
            self.assertEqual([color == BLACK for color in rows[y]], expected)
        self.assertTrue(all(color == WHITE for y in range(SIDE - EDGE, SIDE) for color in rows[y]))
        self.assertTrue(any(color != WHITE for y in range(SIDE - EDGE - 14, SIDE - EDGE - 3) for color in rows[y]))
        # The words of a perspective, which say where it holds, are longer, where there is room for them.
        size = ["--size", "320x96"]
        blank = self.picture(*size)
        wide, narrow = (changed(blank, self.picture("--scale-bar", *size, camera=camera)) for camera in ("front", FLAT))
        self.assertLess(wide[0], narrow[0])
        small = changed(self.picture(), self.picture("--scale-bar", camera="front", warnings=[
            "the scale bar holds at the middle of the view: the picture is too small to say it"]))
        self.assertGreaterEqual(small[0], EDGE - 1)

    def test_words_are_wrapped_or_shortened_and_never_cut_off(self):
        blank = self.picture()
        one = changed(blank, self.picture("--title", "Bellis"))
        two = changed(blank, self.picture("--title", "Bellis perennis"))
        self.assertEqual(self.picture("--title", "Bellis\nperennis"), self.picture("--title", "Bellis perennis"))
        self.assertGreater(two[3], one[3] + 8)
        warning = "the title is shortened: the picture is too small for it"
        four = changed(blank, self.picture("--title", "Bellis perennis " * 6, warnings=[warning]))
        for box in (one, two, four):
            self.assertTrue(EDGE - 1 <= box[0] and box[2] <= SIDE - EDGE + 1 and box[3] < SIDE / 2 + 8, box)
        long = changed(blank, self.picture("--text", f"6,12,18:{'stem' * 20}", warnings=["is shortened"]))
        self.assertTrue(21 <= long[0] and 80 < long[2] < SIDE, long)
        self.assertEqual(changed(blank, self.picture("--text", "6,12,18:a\nb"))[0], 22)

    def test_no_element_is_drawn_over_another(self):
        size, function = ["--size", "160x160"], self.function("0.5")
        bar = changed(self.picture(*size, *function), self.picture(*size, "--color-bar", *function))
        both = self.picture(*size, "--axes", "--title", "a b", "--color-bar", *function)
        without = self.picture(*size, "--axes", "--title", "a b", *function)
        left, top, right, bottom = changed(without, both)
        self.assertLess(bottom, bar[3])  # the axes need room below it
        self.assertTrue(all(color == WHITE for row in without[top:bottom] for color in row[left:right]))
        self.picture("--size", "120x120", "--axes", "--title", "a b", "--color-bar", *function,
                     warnings=["the colour bar is left out: the picture is too small for it"])
        # A text goes to the other side of its point where something is there.
        blank = self.picture()
        right = changed(blank, self.picture("--text", "11,12,12:abc"))
        taken = self.picture("--text", "13,12,12:abc")
        left = changed(taken, self.picture("--text", "13,12,12:abc", "--text", "11,12,12:abc"))
        self.assertTrue(right[2] > 60 and left[0] < 25 and left[2] < 48, (right, left))

    @staticmethod
    def function(opacity):
        return ["--set", 'transfer_function={"points":[{"intensity":1000,"color":"#ff0000","opacity":0.5},'
                         '{"intensity":2000,"color":"#0000ff","opacity":%s}]}' % opacity]

    def test_each_element_is_where_it_belongs(self):
        blank = self.picture()
        self.assertTrue(all(color == WHITE for row in blank for color in row))
        left, top, right, bottom = changed(blank, self.picture("--title", "Bellis"))
        self.assertLess(bottom, 20)
        self.assertAlmostEqual(left + right, SIDE, delta=4)
        left, top, right, bottom = changed(blank, self.picture("--axes"))
        # x goes to the right and z upwards, from 40 pixels right of and above the corner; y goes away from the eye.
        for found, expected in zip((left, bottom), (40, SIDE - 40)):
            self.assertAlmostEqual(found, expected, delta=4)
        self.assertTrue(60 < right < 80 and 16 < top < SIDE - 60, (left, top, right, bottom))
        # The dot is at the voxel, the text to its right, or to its left where the right has no room.
        left, top, right, bottom = changed(blank, self.picture("--text", "6,12,18:stem"))
        self.assertTrue(21 <= left <= 23 and top < 24 < bottom and right > 35, (left, top, right, bottom))
        left, top, right, bottom = changed(blank, self.picture("--text", "18,12,18:stem"))
        self.assertTrue(73 <= right <= 75 and left < 60, (left, top, right, bottom))
        both = changed(blank, self.picture("--text", "18,12,18:stem", "--text", "6,12,18:stem: left"))
        self.assertEqual(both[2], right)
        self.assertTrue(21 <= both[0] <= 23)

    def test_measurements_are_drawn_with_their_values(self):
        size = ["--size", "240x240"]  # one pixel is a tenth of a voxel
        blank = self.picture(*size)
        self.assertEqual(blank, self.picture(*size, "--measurements", warnings=["the session has none"]))
        self.session = self.write_session(measurements=[{"name": "a", "from": [6, 12, 18], "to": [18, 12, 18]}],
                                          transfer_function={"points": [
                                              {"intensity": 0, "color": "#ff0000", "opacity": 0},
                                              {"intensity": 100, "color": "#0000ff", "opacity": 0}]})
        rows = self.picture(*size, "--measurements")
        level = [x for x in range(240) if rows[60][x][0] < 0.6]  # the line lies between two rows of pixels
        self.assertEqual(level, list(range(level[0], level[-1] + 1)))
        self.assertTrue(57 <= level[0] <= 61 and 178 <= level[-1] <= 182, level)  # its ends have dots
        words = [y for y in range(240) if any(color[0] < 0.6 for color in rows[y]) and not 57 <= y <= 63]
        self.assertTrue(40 <= min(words) and max(words) < 57, words)  # above the line
        # The label avoids other elements, and one line that is out of sight is counted.
        self.picture(*size, "--measurements", "--set",
                     'measurements=[{"from":[6,12,18],"to":[18,12,18]},{"from":[60,12,18],"to":[90,12,18]}]',
                     warnings=["1 measurement of 2 cannot be seen"])
        text = ["--text", "12,12,20:stem"]
        both = self.picture(*size, "--measurements", *text)
        self.assertEqual(changed(self.picture(*size, *text), both)[3], changed(blank, rows)[3])

    def test_a_legend_has_the_colours_of_the_groups_that_are_drawn(self):
        self.check("annotate", self.session, "--script", self.write_script("s.jsonl", [
            {"op": "paint", "brush": "fill", "group": 3, "threshold": 0, "radius": 2, "path": [[12, 12, 12]]},
            {"op": "paint", "brush": "fill", "group": 5, "threshold": 0, "radius": 2, "path": [[4, 4, 4]]}, {"op": "save"}]))
        groups = ["--set", 'groups={"3":{"name":"vein","color":"#ff0000","opacity":0.001},'
                           '"5":{"color":"#00ff00","opacity":1,"visible":false}}']
        with_it = self.picture("--legend", *groups)
        box = changed(self.picture(*groups), with_it)
        self.assertTrue(box[0] > SIDE / 2 and box[3] < SIDE / 3, box)
        squares = [color for row in with_it for color in row if color == (1.0, 0.0, 0.0)]
        self.assertEqual(len(squares), 64)  # 8 x 8 pixels
        self.assertFalse(any(color == (0.0, 1.0, 0.0) for row in with_it for color in row))  # a hidden group

    def test_a_colour_bar_has_the_colours_of_the_transfer_function(self):
        function = self.function("0.5")
        side, height = 120, 48
        blank = self.picture("--size", f"{side}x{side}", *function)
        rows = self.picture("--size", f"{side}x{side}", "--color-bar", *function)
        left, top, right, bottom = changed(blank, rows)
        # Captions are above and below the bar, which is 48 pixels high.
        self.assertTrue(left == EDGE - 1 and side / 8 < top < side / 4, (left, top, right, bottom))
        self.assertTrue(3 * side / 4 < bottom < 7 * side / 8, (left, top, right, bottom))
        x = EDGE + 6
        first = (side - height) // 2
        for row in range(height):
            blue = 1 - (row + 0.5) / height
            for value, expected in zip(rows[first + row][x], (1 - blue, 0, blue)):
                self.assertAlmostEqual(value, expected, places=5)
        # All colours at full strength; to their right the opacity, 7 pixels wide at its maximum.
        fading = self.picture("--size", f"{side}x{side}", "--color-bar", *self.function("0"))
        for row in range(1, height):
            self.assertEqual(fading[first + row][x], rows[first + row][x])
            dark = sum(1 - color[0] for color in fading[first + row][EDGE + 13:EDGE + 20])
            self.assertAlmostEqual(dark, 7 * (row + 0.5) / height, delta=0.02)

    def test_words_stand_out_from_the_background(self):
        for background, colors in [("#ffffff", {BLACK}), ("#000000", {WHITE}), ("#ffffff00", {BLACK})]:
            rows = self.picture("--scale-bar", "--set", f'render.background="{background}"')
            self.assertIn(rows[SIDE - EDGE - 1][SIDE - EDGE - 5], colors, background)

    def test_larger_text_has_more_pixels(self):
        blank = self.picture()
        small = changed(blank, self.picture("--title", "abc"))
        large = changed(blank, self.picture("--title", "abc", "--text-pixels", 20))
        self.assertAlmostEqual(large[3] - large[1], 2 * (small[3] - small[1]), delta=4)

    def test_what_cannot_be_drawn_is_named(self):
        self.picture("--legend", "--color-bar", "--text", "100,12,12:far", "--title", "a", warnings=[
            "the colour bar is left out: the transfer function draws nothing",
            "the legend is left out: no group is painted or traced, and visible",
            'the text "far" is left out: its point is outside of the picture'])
        self.picture("--axes", "--scale-bar", "--size", "20x20", warnings=["the scale bar is left out", "the axes are left out"])

    def test_wrong_usage(self):
        for options, says in [(["--text", "1,2:x"], '--text is "1,2:x"; expected X,Y,Z:TEXT'),
                              (["--text", "1,2,3"], "--text is"), (["--text", "1,2,3: "], "--text is"),
                              (["--text", "1,2,3,4:x"], "--text is"), (["--text", "1,2,nan:x"], "--text is"),
                              (["--title", "a", "--text-pixels", "1"], "--text-pixels is 1; expected a number from 6"),
                              (["--text-pixels", "12"], "without anything to draw; expected")]:
            self.check_refused("render", self.session, "-o", self.folder / "a.png", *options, says=[says], status=2)

    def dots(self, name):
        """Per metre along both axes, as a PNG file states."""
        content = (self.folder / name).read_bytes()
        chunk = content.find(b"pHYs")
        if chunk < 0:
            return None
        x, y, is_metre = struct.unpack(">IIB", content[chunk + 4:chunk + 13])
        self.assertEqual((x, is_metre), (y, 1))
        return x

    def test_a_size_on_paper_is_kept_in_the_file(self):
        for name, size, expected, dots in [("a.png", "25.4x12.7mm", (300, 150), 11811), ("b.png", "25.4x12.7mm", (100, 50), 3937),
                                           ("c.png", "40x30", (40, 30), 3937), ("d.png", "40x30", (40, 30), None)]:
            dpi = ["--dpi", "100"] if dots == 3937 else []
            result = self.check_json("render", self.session, "-o", self.folder / name, "--size", size, *dpi)
            self.assertEqual(tuple(result["size"]), expected)
            self.assertEqual(self.dots(name), dots)
        for options, says in [(["--size", "0x10mm"], "expected WIDTHxHEIGHTmm"), (["--size", "85mm"], "--size is"),
                              (["--size", "9000x10mm"], "1 to 65536 pixels"), (["--dpi", "1"], "--dpi is 1; expected"),
                              (["--size", "85x60mm", "--dpi", "0"], "--dpi is 0; expected")]:
            self.check_refused("render", self.session, "-o", self.folder / "x.png", *options, says=[says], status=2)

    def test_a_tiff_holds_its_session(self):
        tiff, again, direct = (self.folder / name for name in ("a.tif", "again.png", "direct.png"))
        session = self.write_session(render={"size": [40, 30]})
        self.check("render", session, "-o", tiff, "--camera", "left", "--with-session", "--dpi", "300")
        self.check("render", tiff, "-o", again, "--with-session")
        self.check("render", session, "-o", direct, "--camera", "left")
        self.check("compare", again, direct, "--max-abs", "0")
        self.assertEqual((self.dots("again.png"), self.dots("direct.png")), (11811, None))
        self.check("render", again, "-o", direct)
        self.assertEqual(self.dots("direct.png"), 11811)
        self.check("render", again, "-o", direct, "--size", "20x15")
        self.assertEqual(self.dots("direct.png"), None)

    def test_a_picture_that_is_rendered_again_has_its_elements(self):
        elements = ["--scale-bar", "--color-bar", "--axes", "--title", "Bellis\nperennis", "--text", "6,12,18:stem",
                    "--text-pixels", "12"]
        size = ["--size", "240x200", *self.function("0")]

        def render(source, name, *arguments):
            self.check("render", source, "-o", self.folder / name, *arguments)
            return self.folder / name

        def check_same(a, b):
            self.check("compare", a, b, "--max-abs", "0")

        direct = render(self.session, "direct.png", "--camera", "left", *size, *elements)
        for name in ("kept.png", "kept.tif"):
            kept = render(self.session, name, "--camera", "left", *size, *elements, "--with-session")
            check_same(render(kept, "again.png"), direct)
        plain = render(self.session, "plain.png", "--camera", "left", *size)
        self.assertNotEqual(plain.read_bytes(), direct.read_bytes())
        check_same(render(kept, "none.png", "--no-elements"), plain)
        titled = render(self.session, "titled.png", "--camera", "left", *size, "--title", "other")
        check_same(render(kept, "replaced.png", "--title", "other"), titled)
        self.check("render", kept, "--movie", self.folder / "m", "--frames", "2", "--turntable", "90", "--with-session")
        check_same(self.folder / "m" / "frame-0001.png", direct)
        last = self.folder / "m" / "frame-0002.png"
        check_same(render(last, "frame.png"), last)
        self.check_refused("render", plain, "-o", self.folder / "x.png", "--text-pixels", "12", status=2,
                           says=["without anything to draw"])

    def test_frames_of_a_movie_have_the_same_elements(self):
        elements = ["--title", "turn", "--scale-bar", "--axes", "--size", "48x48"]
        self.check("render", self.session, "--movie", self.folder / "m", "--frames", "2", *elements)
        self.check("render", self.session, "-o", self.folder / "a.png", "--camera", "front", *elements)
        self.assertEqual((self.folder / "m" / "frame-0001.png").read_bytes(), (self.folder / "a.png").read_bytes())


if __name__ == "__main__":
    unittest.main()
