"""A mesh is dropped onto the window, seen with the scan, hidden, taken back, saved, and drawn alike by shvr render."""
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from seen import Seen, only_panel  # noqa: E402
from xdnd import Source  # noqa: E402

PANEL = "Side panel"
CORNERS = [(30, 0, 0), (-30, 0, 0), (0, 30, 0), (0, -30, 0), (0, 0, 30), (0, 0, -30)]
FACES = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]


class Meshes(Seen):
    def write_octahedron(self, name):
        """Around the ball, which it hides; green."""
        file = self.folder / name
        file.write_text("ply\nformat ascii 1.0\nelement vertex 6\n" +
                        "".join(f"property float {axis}\n" for axis in "xyz") +
                        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                        "element face 8\nproperty list uchar int vertex_indices\nend_header\n" +
                        "".join(f"{x + 32} {y + 32} {z + 32} 0 200 0\n" for x, y, z in CORNERS) +
                        "".join(f"3 {a} {b} {c}\n" for a, b, c in FACES))
        return file

    def is_green(self):
        _, _, rows = self.pixels()
        x, y = self.middle()
        red, green, blue = rows[y][3 * x:3 * x + 3]
        return green > 40 and green > 2 * red and green > 2 * blue

    def drop(self, path):
        source = Source(self.display.name, int(self.window_named("SHVR")))
        self.addCleanup(source.close)
        source.drop([path], self.middle())

    def test_a_mesh_is_dropped_hidden_undone_and_kept(self):
        session, mesh = self.write_ball(), self.write_octahedron("octahedron.ply")
        self.open_scan(session, preferences=only_panel("meshes"))
        self.see("Load a mesh...", PANEL)
        self.assertFalse(self.is_green())
        self.drop(mesh)
        self.see("octahedron.ply", PANEL)
        self.until(self.is_green, "the mesh in the picture")
        self.press("Ctrl+Z")
        self.until(lambda: not self.is_green(), "the picture without the mesh")
        self.see_no_more("octahedron.ply", PANEL)
        self.press("Ctrl+Shift+Z")
        self.until(self.is_green, "the mesh again")
        self.check_key("Ctrl+S", "save")
        self.finish()
        self.assertEqual(json.loads(session.read_text())["meshes"], [{"file": "octahedron.ply", "shown": True}])

        # A broken one is refused by name, and changes nothing.
        broken = self.folder / "broken.ply"
        broken.write_bytes(mesh.read_bytes()[:-8])
        self.open_scan(session, preferences=only_panel("meshes"))
        self.until(self.is_green, "the mesh of the session")
        self.drop(broken)
        self.until(lambda: any("broken.ply" in seen["text"] for seen in self.seen(window="Status")), "the reason")
        # So is a format that is not read.
        (self.folder / "model.gltf").write_text("{}")
        self.drop(self.folder / "model.gltf")
        self.until(lambda: any("is no mesh that can be read" in seen["text"] for seen in self.seen(window="Status")),
                   "the formats")
        report = self.finish()
        self.assertTrue(any("broken.ply" in said for said in report["messages"]), report["messages"])

        # One whose file is gone is listed as not drawn.
        mesh.rename(self.folder / "away.ply")
        self.open_scan(session, preferences=only_panel("meshes"))
        self.see("octahedron.ply: not drawn", PANEL)
        self.finish()


if __name__ == "__main__":
    unittest.main()
