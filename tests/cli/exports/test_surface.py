"""shvr export --surface: closed surfaces of groups, read back in plain Python."""
import itertools
import json
import os
import random
import re
import signal
import struct
import subprocess
import unittest
from collections import Counter

from harness import ENVIRONMENT, SHVR, TIMEOUT_S, CliTest

SIZE, SPACING, ORIGIN = (6, 5, 4), (0.5, 1.0, 2.0), (100.0, 20.0, -30.0)
VOXEL_MM3 = 0.5 * 1.0 * 2.0


def placed(corner):
    """The physical position of a corner of voxels: the axes are turned by 90 degrees, voxel 0 has its centre at ORIGIN."""
    x, y, z = ((c - 0.5) * s for c, s in zip(corner, SPACING))
    return (ORIGIN[0] - y, ORIGIN[1] + x, ORIGIN[2] + z)


def read_stl(path):
    """Triangles as their corners."""
    data = path.read_bytes()
    count, = struct.unpack_from("<I", data, 80)
    assert len(data) == 84 + 50 * count and not data.startswith(b"solid")
    found = []
    for i in range(count):
        numbers = struct.unpack_from("<12fH", data, 84 + 50 * i)
        found.append(tuple(numbers[3 * j:3 * j + 3] for j in (1, 2, 3)))
    return found


def read_ply(path):
    """The vertices, and the triangles of each group as their indices."""
    header, body = path.read_bytes().split(b"end_header\n", 1)
    vertices, faces = (int(count) for count in re.findall(rb"element \w+ (\d+)", header))
    assert len(body) == 27 * vertices + 14 * faces
    points = [struct.unpack_from("<3d", body, 27 * i) for i in range(vertices)]
    groups = {}
    for i in range(faces):
        count, a, b, c, group = struct.unpack_from("<B3IB", body, 27 * vertices + 14 * i)
        assert count == 3
        groups.setdefault(group, []).append((a, b, c))
    return points, groups


def read_obj(path):
    points, groups, group = [], {}, None
    for line in path.read_text().splitlines():
        word, *rest = line.split()
        if word == "g":
            group = int(rest[0].removeprefix("group_"))
        elif word == "v":
            points.append(tuple(map(float, rest)))
        elif word == "f":
            groups.setdefault(group, []).append(tuple(int(i) - 1 for i in rest))
    return points, groups


def read_glb(path):
    """The same as `read_ply`, in millimetres, and the JSON."""
    data = path.read_bytes()
    magic, version, size, length, kind = struct.unpack_from("<4s4I", data)
    assert (magic, version, size, kind) == (b"glTF", 2, len(data), 0x4E4F534A) and length % 4 == 0
    content = json.loads(data[20:20 + length])
    count, kind = struct.unpack_from("<II", data, 20 + length)
    binary = data[28 + length:]
    assert kind == 0x004E4942 and count == len(binary) == content["buffers"][0]["byteLength"]

    def values(accessor, form):
        described = content["accessors"][accessor]
        view = content["bufferViews"][described["bufferView"]]
        assert view["byteLength"] == described["count"] * struct.calcsize(form)
        return [struct.unpack_from(form, binary, view["byteOffset"] + i)
                for i in range(0, view["byteLength"], struct.calcsize(form))]
    root, points, groups = content["nodes"][0], [], {}
    for child in root["children"]:
        node = content["nodes"][child]
        primitive = content["meshes"][node["mesh"]]["primitives"][0]
        first = len(points)
        stored = values(primitive["attributes"]["POSITION"], "<3f")
        bounds = content["accessors"][primitive["attributes"]["POSITION"]]
        assert bounds["min"] == [min(axis) for axis in zip(*stored)]
        assert bounds["max"] == [max(axis) for axis in zip(*stored)]
        points += [tuple(1000 * (t + s * p) for t, s, p in zip(root["translation"], root["scale"], point))
                   for point in stored]
        content["accessors"][primitive["indices"]]["count"] //= 3
        groups[node["extras"]["group"]] = [tuple(first + i for i in triangle)
                                           for triangle in values(primitive["indices"], "<3I")]
    return points, groups, content


def volume_of(points, triangles):
    total = 0
    base = points[triangles[0][0]]
    for triangle in triangles:
        a, b, c = ([p - q for p, q in zip(points[i], base)] for i in triangle)
        total += sum(a[i] * (b[(i + 1) % 3] * c[(i + 2) % 3] - b[(i + 2) % 3] * c[(i + 1) % 3]) for i in range(3))
    return total / 6


class Surface(CliTest):
    def setUp(self):
        super().setUp()
        noise = random.Random(3)
        self.use(SIZE, bytes(noise.choice((0, 1, 2, 9)) for _ in range(6 * 5 * 4)))

    def use(self, size, mask):
        (self.folder / "scan.nrrd").write_bytes(
            ("NRRD0004\ntype: uint8\ndimension: 3\nencoding: raw\nspace: left-posterior-superior\n"
             f"sizes: {' '.join(map(str, size))}\nspace directions: (0,0.5,0) (-1,0,0) (0,0,2)\n"
             "space units: \"mm\" \"mm\" \"mm\"\nspace origin: (100,20,-30)\n\n").encode() + bytes(len(mask)))
        (self.folder / "paint.mask").write_bytes(mask)
        self.mask = mask
        self.session = self.write_session(volume={"path": "scan.nrrd"},
                                          groups={"9": {"name": "vein", "color": "#ff8000"}})

    def export(self, text, *options):
        return self.check_json("export", self.session, "--surface", text, *options)

    def test_all_formats_hold_the_same_closed_surfaces(self):
        for steps, tolerance in ((0, 1e-9), (20, 0.01)):
            with self.subTest(steps=steps):
                files = {form: self.folder / f"a{steps}.{form}" for form in ("ply", "obj", "glb", "stl")}
                for form, file in files.items():
                    result = self.export(file, "--smooth", steps)
                    if form != "stl":
                        self.assertEqual(result["written"], [str(file)])
                self.assertEqual(result["written"], [str(self.folder / f"a{steps}-{g}.stl") for g in (1, 2, 9)])
                points, groups = read_ply(files["ply"])
                self.assertEqual(result["triangles_by_group"], {str(g): len(t) for g, t in groups.items()})
                self.assertEqual(read_obj(files["obj"]), (points, groups))
                near, same, _ = read_glb(files["glb"])
                self.assertEqual(same, groups)
                for p, q in zip(points, near):
                    self.assertLess(max(abs(a - b) for a, b in zip(p, q)), 1e-5)
                for group, triangles in groups.items():
                    edges = Counter((t[i], t[(i + 1) % 3]) for t in triangles for i in range(3))
                    self.assertEqual(set(edges.values()), {1})
                    self.assertTrue(all((b, a) in edges for a, b in edges))
                    voxels = self.mask.count(group) * VOXEL_MM3
                    self.assertAlmostEqual(volume_of(points, triangles), voxels, delta=tolerance * voxels)
                    stored = read_stl(self.folder / f"a{steps}-{group}.stl")
                    self.assertEqual(len(stored), len(triangles))
                    for at, triangle in zip(stored, triangles):
                        for p, q in zip(at, triangle):
                            self.assertLess(max(abs(a - b) for a, b in zip(p, points[q])), 1e-5)

    def test_surfaces_lie_where_the_volume_lies(self):
        mask = bytearray(6 * 5 * 4)
        mask[2 + 6 * (1 + 5 * 3)] = 9
        self.use(SIZE, bytes(mask))
        corners = list(itertools.product((2, 3), (1, 2), (3, 4)))
        path = self.folder / "a.ply"
        self.export(f"9:{path}", "--smooth", "0")
        points, groups = read_ply(path)
        self.assertEqual(sorted(points), sorted(placed(corner) for corner in corners))
        self.assertEqual(len(groups[9]), 12)
        self.assertIn(b"comment unit mm\n", path.read_bytes())
        self.assertIn(b"comment SPACE=LPS\n", path.read_bytes())
        self.export(f"9:{path}", "--smooth", "0", "--space", "volume")
        self.assertEqual(sorted(read_ply(path)[0]),
                         sorted(tuple(c * s for c, s in zip(corner, SPACING)) for corner in corners))

    def test_borders_are_shared_by_files_of_two_commands(self):
        files = {group: self.folder / f"{group}.ply" for group in (1, 2)}
        for group, file in files.items():
            self.export(f"{group}:{file}")
        found = []
        for group, file in files.items():
            points, groups = read_ply(file)
            self.assertEqual(list(groups), [group])
            found.append({frozenset(points[i] for i in triangle) for triangle in groups[group]})
        def at(x, y, z):
            return self.mask[x + 6 * (y + 5 * z)]
        touching = sum({at(*a), at(*b)} == {1, 2} for a in itertools.product(*map(range, SIZE)) for b in
                       (tuple(c + (i == axis) for i, c in enumerate(a)) for axis in range(3)) if
                       all(c < s for c, s in zip(b, SIZE)))
        self.assertGreater(touching, 5)
        self.assertGreaterEqual(len(found[0] & found[1]), 2 * touching)

    def test_decimated_surfaces_of_two_commands_are_closed_and_share_borders(self):
        size = (24, 20, 16)
        mask = bytearray(24 * 20 * 16)
        for x, y, z in itertools.product(*map(range, size)):
            if (x - 12) ** 2 / 4 + (y - 10) ** 2 + (z - 8) ** 2 < 36:
                mask[x + 24 * (y + 20 * z)] = 1 if x < 12 else 2
        self.use(size, bytes(mask))
        voxel_mm = min(SPACING)
        full, coarse = {}, {}
        for group in (1, 2):
            file = self.folder / f"{group}.ply"
            full[group] = self.export(f"{group}:{file}")["triangles_by_group"][str(group)]
            result = self.export(f"{group}:{file}", "--decimate", "0.1")
            points, groups = read_ply(file)
            coarse[group] = {frozenset(points[i] for i in triangle) for triangle in groups[group]}
            self.assertEqual(result["triangles_by_group"], {str(group): len(groups[group])})
            self.assertLess(len(groups[group]), 0.4 * full[group])
            self.assertLess(0.0, result["decimation_error"])
            self.assertLessEqual(result["decimation_error"], voxel_mm)
            edges = Counter((t[i], t[(i + 1) % 3]) for t in groups[group] for i in range(3))
            self.assertEqual(set(edges.values()), {1})
            self.assertTrue(all((b, a) in edges for a, b in edges))
            voxels = mask.count(group) * VOXEL_MM3
            self.assertAlmostEqual(volume_of(points, groups[group]), voxels, delta=0.01 * voxels)
        border = coarse[1] & coarse[2]
        # A disc of about 100 voxels, whose outline stays.
        self.assertGreater(len(border), 20)
        self.assertLess(len(border), 100)
        def at_border(triangle):
            return all(abs(point[1] - placed((12, 0, 0))[1]) < 0.3 for point in triangle)
        self.assertEqual(border, {triangle for triangle in coarse[1] | coarse[2] if at_border(triangle)})
        self.assertIsNone(self.export(self.folder / "a.ply")["decimation_error"])
        for share in ("0", "1.5", "many"):
            self.check_refused("export", self.session, "--surface", self.folder / "a.ply", "--decimate", share, status=2,
                               says=["--decimate"])

    def test_a_group_of_gltf_has_its_name_and_colour(self):
        self.export(f"9+1:{self.folder / 'a.glb'}")
        _, groups, content = read_glb(self.folder / "a.glb")
        self.assertEqual(list(groups), [1, 9])
        self.assertEqual([mesh["name"] for mesh in content["meshes"]], ["group 1", "vein"])
        red, green, blue, alpha = content["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"]
        self.assertEqual((red, blue, alpha), (1, 0, 1))
        self.assertAlmostEqual(green, ((128 / 255 + 0.055) / 1.055) ** 2.4, places=6)

    def test_what_cannot_be_written_is_refused_in_a_sentence_and_old_files_stay(self):
        path = self.folder / "a.ply"
        path.write_text("old")

        def refuse(*options, status, says):
            self.check_refused("export", self.session, *options, status=status, says=says)
            self.assertEqual(path.read_text(), "old")
        refuse("--surface", f"4:{path}", status=1, says=["a.ply", "group 4 has no painted voxels", "1, 2, 9"])
        refuse("--surface", f"stem:{path}", status=2, says=["--surface names the groups", "stem", "1+4"])
        refuse("--surface", f"1+:{path}", status=2, says=["1+", "1+4"])
        refuse("--surface", f"256:{path}", status=2, says=["1 to 255"])
        refuse("--surface", self.folder / "a.vtk", status=2, says=["--surface is", ".stl, .ply, .obj, .glb"])
        refuse("--surface", self.folder / "none" / "a.stl", status=1, says=["there is no folder"])
        (self.folder / "paint.mask").write_bytes(bytes(6 * 5 * 4))
        refuse("--surface", path, status=1, says=["a.ply", "nothing is painted"])
        noise = random.Random(4)
        self.use((40, 40, 40), bytes(noise.choice((0, 1)) for _ in range(40 ** 3)))
        refuse("--surface", path, "--budget-host", "1", status=1, says=["MiB of memory", "at most 1 MiB", "--budget-host"])
        self.assertEqual(self.check("export", self.session, "--smooth", "3", status=2).stdout, "")

    def test_an_interrupt_leaves_no_partial_file(self):
        noise = random.Random(5)
        self.use((96, 96, 96), noise.randbytes(96 ** 3))
        path = self.folder / "a.obj"
        path.write_text("old")
        before = set(os.listdir(self.folder))
        with subprocess.Popen([SHVR, "export", str(self.session), "--surface", str(path), "--smooth", "1000"],
                              stderr=subprocess.PIPE, text=True, env=ENVIRONMENT) as process:
            self.addCleanup(process.kill)
            next(line for line in process.stderr if "making surfaces" in line)  # the first line of progress
            process.send_signal(signal.SIGINT)
            _, rest = process.communicate(timeout=TIMEOUT_S)
        self.assertEqual(process.returncode, 1, rest)
        self.assertEqual(path.read_text(), "old")
        self.assertEqual(set(os.listdir(self.folder)), before)


if __name__ == "__main__":
    unittest.main()
