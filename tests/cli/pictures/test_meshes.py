"""Meshes of a session in pictures: each format, where the volume lies, hidden, and what cannot be read."""
import json
import struct
import unittest

from harness import CliTest
from test_figure import changed, read_pfm

SIDE = 96
# One pixel is a quarter of a voxel of z.
FLAT = '{"projection":"orthographic","eye":[3,-60,12],"target":[3,2,12],"height":24}'


class Meshes(CliTest):
    def setUp(self):
        super().setUp()
        # The first axis of the file points along y of the patient, the second against x.
        size = (12, 5, 12)
        (self.folder / "scan.nrrd").write_bytes(
            ("NRRD0004\ntype: uint8\ndimension: 3\nencoding: raw\nspace: left-posterior-superior\n"
             f"sizes: {' '.join(map(str, size))}\nspace directions: (0,0.5,0) (-1,0,0) (0,0,2)\n"
             "space units: \"mm\" \"mm\" \"mm\"\nspace origin: (100,20,-30)\n\n").encode() + bytes(12 * 5 * 12))
        mask = bytearray(12 * 5 * 12)
        for z in (4, 5, 6):
            for x in (3, 4, 5, 6, 7):
                mask[x + 12 * (2 + 5 * z)] = 9
        (self.folder / "paint.mask").write_bytes(mask)
        points = [{"intensity": 0, "color": "#ff0000", "opacity": 0}, {"intensity": 100, "color": "#0000ff", "opacity": 0}]
        self.look = {"volume": {"path": "scan.nrrd"}, "render": {"size": [SIDE, SIDE]}, "transfer_function": {"points": points}}
        self.session = self.write_session(groups={"9": {"name": "vein", "color": "#ff8000"}}, **self.look)
        self.bare = self.write_session("bare.json", annotation={}, **self.look)

    def picture(self, session, *meshes, options=(), warnings=()):
        path = self.folder / "a.pfm"
        settings = ["--set", "meshes=" + json.dumps(list(meshes))] if meshes else []
        result = self.check_json("render", session, "-o", path, "--camera", FLAT, *settings, *options)
        self.assertEqual(len(result["warnings"]), len(warnings), result["warnings"])
        for warning, words in zip(result["warnings"], warnings):
            self.assertIn(words, warning)
        return read_pfm(path)

    def test_surfaces_of_every_format_lie_where_the_groups_lie(self):
        blank = self.picture(self.bare)
        # Voxels 3 to 8 along the first axis and 4 to 7 along z, of 0.5 and 2 mm: 2.5 by 6 mm, of 4 pixels each.
        left, top = 48 + round(4 * (1.5 - 3)), 48 - round(4 * (14 - 12))
        expected = (left, top, left + 10, top + 24)
        for form in ("stl", "ply", "obj", "glb"):
            for space in ("physical", "volume"):
                file = self.folder / f"{space}.{form}"
                self.check("export", self.session, "--surface", f"9:{file}", "--smooth", "0", "--space", space)
                with self.subTest(form=form, space=space):
                    seen = self.picture(self.bare, {"file": file.name})
                    self.assertEqual(changed(blank, seen), expected)
        red = self.picture(self.bare, {"file": "physical.stl", "color": "#ff0000"})[48 - 4][48]
        self.assertGreater(red[0], 4 * max(red[1:]))
        orange = self.picture(self.bare, {"file": "physical.glb"})[48 - 4][48]
        self.assertTrue(orange[0] > 1.5 * orange[1] > 2 * orange[2], orange)
        self.assertEqual(self.picture(self.bare, {"file": "physical.glb", "shown": False}), blank)
        self.assertEqual(self.picture(self.bare, {"file": "physical.glb"}, options=["--set", "view.meshes=false"]), blank)

    def test_a_mesh_of_another_frame_is_turned_into_the_frame_of_the_scan(self):
        blank = self.picture(self.bare)
        # The same place, stated in RAS.
        right = (self.folder / "scan.nrrd").read_bytes().replace(b"left-posterior-superior", b"right-anterior-superior")
        right = right.replace(b"(0,0.5,0) (-1,0,0) (0,0,2)", b"(0,-0.5,0) (1,0,0) (0,0,2)").replace(b"(100,20,", b"(-100,-20,")
        (self.folder / "right.nrrd").write_bytes(right)
        groups = {"9": {"name": "vein", "color": "#ff8000"}}
        turned = self.write_session("turned.json", groups=groups, **self.look | {"volume": {"path": "right.nrrd"}})
        turned_bare = self.write_session("turned_bare.json", annotation={}, **self.look | {"volume": {"path": "right.nrrd"}})
        expected = None
        for of, into, forms in ((self.session, turned_bare, ("stl", "ply", "obj", "glb")), (turned, self.bare, ("stl",)),
                                (turned, turned_bare, ("glb",))):
            for form in forms:
                with self.subTest(of=of.name, form=form):
                    file = self.folder / f"a.{form}"
                    self.check("export", of, "--surface", f"9:{file}", "--smooth", "0")
                    seen = changed(blank, self.picture(into, {"file": file.name}))
                    expected = expected or changed(blank, self.picture(self.bare, {"file": self.of_session()}))
                    self.assertEqual(seen, expected)
        # As 3D Slicer states it.
        stl = (self.folder / self.of_session()).read_bytes()
        (self.folder / "slicer.stl").write_bytes(b"3D Slicer output. SPACE=LPS".ljust(80) + stl[80:])
        self.assertEqual(changed(blank, self.picture(turned_bare, {"file": "slicer.stl"})), expected)

    def of_session(self):
        self.check("export", self.session, "--surface", f"9:{self.folder / 'own.stl'}", "--smooth", "0")
        return "own.stl"

    def test_stl_states_the_frame(self):
        path = self.folder / "a.stl"
        self.check("export", self.session, "--surface", f"9:{path}")
        self.assertEqual(path.read_bytes()[:80].rstrip(), b"SHVR surface, group 9, SPACE=LPS, space physical, unit mm")
        self.check("export", self.session, "--surface", f"9:{path}", "--space", "volume")
        self.assertEqual(path.read_bytes()[:80].rstrip(), b"SHVR surface, group 9, space volume, unit mm")

    def stl_at(self, name, corners, count=1):
        facet = struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *corner) for corner in corners) + bytes(2)
        (self.folder / name).write_bytes(bytes(80) + struct.pack("<I", count) + count * facet)
        return {"file": name}

    def test_meshes_that_cannot_be_shown_leave_the_others_in_the_picture(self):
        good = {"file": self.of_session()}
        alone = self.picture(self.bare, good)
        far = self.stl_at("far.stl", ((1e30, 0, 0), (0, 1e30, 0), (0, 0, 1)))
        broken = self.stl_at("broken.stl", ((0, 0, 0), (0, 1, 0), (0, 0, 1)))
        (self.folder / "broken.stl").write_bytes((self.folder / "broken.stl").read_bytes()[:-1])
        meshes = [{"file": "none.stl"}, far, good, broken]
        names = ["none.stl", "far.stl", "broken.stl"]
        seen = self.picture(self.bare, *meshes, options=["--allow-incomplete"], warnings=names)
        self.assertEqual(seen, alone)
        setting = ["--set", "meshes=" + json.dumps(meshes)]
        output = self.folder / "b.pfm"
        self.check_refused("render", self.bare, "-o", output, *setting, says=names)
        # JSON and --quiet report losses, too.
        render = ["render", self.bare, "-o", output, "--camera", FLAT, "--allow-incomplete", "--quiet"]
        self.assertIs(self.check_json(*render, *setting)["complete"], False)
        told = self.check(*render, *setting).stderr
        for name in names:
            self.assertIn(name, told)
        self.assertIs(self.check_json(*render, "--set", "meshes=" + json.dumps([good]))["complete"], True)

    def test_a_mesh_outside_the_scan_is_told_with_both_boxes(self):
        blank = self.picture(self.bare)
        mesh = self.stl_at("um.stl", ((9000, 20, 0), (9010, 20, 0), (9000, 20, 7.5)))
        seen = self.picture(self.bare, mesh, warnings=["um.stl: lies outside the scan: its box is x 9000 to 9010, y 20 to 20, "
                            "z 0 to 7.5, that of the scan x 95.5 to 100.5, y 19.75 to 25.75, z -31 to -7 mm"])
        self.assertEqual(seen, blank)
        self.picture(self.bare, self.stl_at("in.stl", ((9000, 22, -20), (90, 22, -20), (9000, 22, -12))))

    def test_meshes_share_one_budget_of_memory(self):
        corners = ((98, 22, -20), (99, 22, -20), (98, 22, -10))
        one, two = (self.stl_at(name, corners, 150000) for name in ("one.stl", "two.stl"))
        options = ["--budget-host", "64", "--set", "view.meshes=false"]   # drawing a pile of triangles takes long
        self.picture(self.bare, one, options=options)
        self.check_refused("render", self.bare, "-o", self.folder / "b.png", *options, "--set",
                           "meshes=" + json.dumps([one, two]), says=["two.stl: takes", "which the meshes before it leave"])

    def test_a_mesh_in_a_project_moves_with_it(self):
        project = self.folder / "project"
        self.check("import", self.folder / "scan.nrrd", project)
        inside = project / "inside.stl"
        inside.write_bytes((self.folder / self.of_session()).read_bytes())
        self.check("annotate", project, "--script",
                   self.write_script("load.jsonl", [{"op": "load", "path": str(inside)}, {"op": "save"}]))
        told = ["no transfer function given"]
        seen = self.picture(project, warnings=told)
        project.rename(self.folder / "moved")
        self.assertEqual(self.picture(self.folder / "moved", warnings=told), seen)

    def test_a_mesh_that_cannot_be_drawn_is_no_step_of_a_script(self):
        blank = self.picture(self.bare)
        self.stl_at("far.stl", ((1e30, 0, 0), (0, 1e30, 0), (0, 0, 1)))
        script = self.write_script("far.jsonl", [{"op": "load", "path": str(self.folder / "far.stl")}])
        told = self.check_refused("annotate", self.bare, "--script", script, says=["far.stl", "1e+30"])
        self.assertEqual(self.picture(self.bare), blank)

    def test_an_element_of_a_list_that_is_not_there_is_refused_with_what_to_write(self):
        for setting in ("meshes.0.file=a.stl", "meshes.file=a.stl"):
            self.check_refused("render", self.bare, "-o", self.folder / "b.png", "--set", setting, status=2,
                               says=["expected the whole list, as in --set 'meshes=[...]'"])

    def test_a_mesh_in_metres_has_the_size_that_it_states(self):
        # The triangle covers the whole of the volume from the front, in metres.
        blank = self.picture(self.bare)
        corners = [(100 - 2, 20 + 0.5 * x, -30 + 2 * z) for x, z in ((-0.5, -0.5), (11.5, -0.5), (-0.5, 11.5))]
        points = b"".join(struct.pack("<3f", *(1e-3 * value for value in corner)) for corner in corners)
        text = json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                           "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                           "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                           "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36}]}).encode()
        text += b" " * (-len(text) % 4)
        body = struct.pack("<2I", len(text), 0x4E4F534A) + text + struct.pack("<2I", 36, 0x004E4942) + points
        (self.folder / "m.glb").write_bytes(struct.pack("<3I", 0x46546C67, 2, 12 + len(body)) + body)
        left, top, right, bottom = changed(blank, self.picture(self.bare, {"file": "m.glb"}))
        self.assertEqual((left, bottom), (48 - 12, SIDE))
        self.assertLess(abs(right - (48 + 12)), 2)
        self.assertLess(top, 4)

    def test_a_mesh_that_cannot_be_read_is_named_and_no_picture_is_written(self):
        blank = self.picture(self.bare)
        (self.folder / "broken.stl").write_bytes(bytes(80) + struct.pack("<I", 1000) + bytes(200))
        for name, says in (("none.stl", "none.stl"), ("broken.stl", "broken.stl"), ("scan.nrrd", "scan.nrrd")):
            with self.subTest(name=name):
                meshes = "meshes=" + json.dumps([{"file": name}])
                output = self.folder / "b.png"
                self.check_refused("render", self.bare, "-o", output, "--set", meshes, says=[says, "--allow-incomplete"])
                self.assertFalse(output.exists())
                seen = self.picture(self.bare, {"file": name}, options=["--allow-incomplete"], warnings=[says])
                self.assertEqual(seen, blank)
        for value, says in (('[{"shown":true}]', "file"), ('[{"file":""}]', "file"), ('[{"file":"a.stl","colour":1}]', "colour"),
                            ("[" + ",".join(['{"file":"a.stl"}'] * 65) + "]", "64")):
            self.check_refused("render", self.bare, "-o", self.folder / "b.png", "--set", "meshes=" + value, says=[says])

    def test_a_script_shows_a_mesh_in_one_step_that_is_kept_and_undone(self):
        self.check("export", self.session, "--surface", f"9:{self.folder / 'a.glb'}")
        blank = self.picture(self.session)
        load = {"op": "load", "path": str(self.folder / "a.glb")}
        for lines in ([load, {"op": "save"}], [{**load, "what": "mesh"}]):
            self.check("annotate", self.session, "--script", self.write_script("load.jsonl", lines))
            self.assertIsNotNone(changed(blank, self.picture(self.session)))
            self.check("annotate", self.session, "--script", self.write_script("undo.jsonl", [{"op": "undo"}]))
            self.assertIsNone(changed(blank, self.picture(self.session)))
        self.check_refused("annotate", self.session, "--script",
                           self.write_script("none.jsonl", [{**load, "path": str(self.session), "what": "mesh"}]),
                           says=["session.json"])
        for name in ("model.gltf", "MODEL.DAE"):
            (self.folder / name).write_text("{}")
            self.check_refused("annotate", self.session, "--script",
                               self.write_script("other.jsonl", [{**load, "path": str(self.folder / name)}]),
                               says=[name, "expected .stl, .ply, .obj or .glb: export it as one of them"])


if __name__ == "__main__":
    unittest.main()
