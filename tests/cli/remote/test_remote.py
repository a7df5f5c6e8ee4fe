"""OME-Zarr over HTTP: every command that takes a volume gives what it gives for the folder that is served; faults of
servers are passed, bounded or refused in a sentence; credentials stay where they belong."""
import json
import shutil
import signal
import subprocess
import sys
import threading
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import store_server as faults  # noqa: E402
from harness import ENVIRONMENT, SHVR, CliTest, Volume, run  # noqa: E402
from store_server import StoreServer  # noqa: E402

SIZE = (70, 66, 40)
# A test must not wait for the limits that people get.
QUICK = {"SHVR_REMOTE_CONNECT_S": "5", "SHVR_REMOTE_STALL_S": "1", "SHVR_REMOTE_TRIES": "3"}
ENVIRONMENT.update(QUICK)


def image_of(project):
    """The project without what only a project has: an OME-Zarr as others write it."""
    for name in ("shvr", "labels"):
        shutil.rmtree(project / name, ignore_errors=True)
    return project


class RemoteTest(CliTest):
    def make(self, *options, name="x.zarr"):
        header = Volume.noise(SIZE, seed=7, voxel_type="uint16", high=999, spacing=(0.5, 0.5, 0.75)).write(self.folder)
        self.check("import", header, self.folder / "made.zarr", "--unit", "um", "--spacing", "0.5,0.5,0.75", *options, "--quiet")
        (self.folder / "served").mkdir(exist_ok=True)
        target = self.folder / "served" / name
        (self.folder / "made.zarr").rename(target)
        return image_of(target)

    def serve(self, fault=None):
        server = StoreServer(self.folder / "served", fault)
        server.__enter__()
        self.addCleanup(server.__exit__)
        return server


class Equal(RemoteTest):
    def compare(self, *options):
        local, server = self.make(*options), self.serve()
        address = server.address("x.zarr")

        def told(path):
            return {key: value for key, value in self.check_json("info", path).items()
                    if key not in ("input", "name", "mask", "warnings")}
        self.assertEqual(told(address), told(local))
        pictures = []
        for number, path in enumerate((address, local)):
            picture = self.folder / f"{number}.pfm"
            self.check("render", path, "-o", picture, "--size", "48x32", "--quiet")
            pictures.append(picture.read_bytes())
        self.assertEqual(*pictures)
        labels = [self.check_json("label", path, "--threshold", "900") for path in (address, local)]
        for key in ("components", "foreground_voxels", "largest_voxels"):
            self.assertEqual(labels[0][key], labels[1][key])
        imported = self.folder / "imported.zarr"
        self.check("import", address, imported, "--quiet")
        self.assertEqual(told(imported), told(local))
        self.assertIn(address, (imported / "shvr" / "volume.json").read_text())
        return server

    # Kind (Servers): the same OME-Zarr over HTTP and from its folder, in chunks and in shards read by ranges
    def test_0_4_in_chunks(self):
        self.compare()

    def test_chunks_of_a_box_are_asked_for_together(self):
        self.make()
        together = threading.Event()

        def hold(path, _):
            # Answers chunks of level 0 once four of them are asked for, or a client asked for fewer for long.
            if "/0/0/" in path:
                if server.busy >= 4:
                    together.set()
                together.wait(20)
        server = self.serve(hold)
        self.check("label", server.address("x.zarr"), "--threshold", "500", "--quiet")
        self.assertTrue(together.is_set(), "requests are made one after another")

    def test_0_5_in_shards(self):
        server = self.compare("--ome-zarr", "0.5", "--shards")
        whole = [path for path, headers in server.requests if "/0/c/" in path and "Range" not in headers]
        self.assertEqual(whole, [], "a shard is read as a whole")

    def test_a_session_names_an_address(self):
        self.make()
        address = self.serve().address("x.zarr")
        session = self.write_session(volume={"path": address})
        self.assertEqual(self.check_json("info", session)["size"], list(SIZE))
        self.check("annotate", session, "--script", self.write_script("s.jsonl", [
            {"op": "paint", "brush": "fill", "region": "box", "group": 3, "threshold": 0, "radius": 4,
             "path": [[20, 20, 20]]}, {"op": "save"}]), "--quiet")
        self.assertEqual(json.loads(session.read_text())["volume"]["path"], address)
        self.assertIn(3, self.mask_of(session))

    def test_what_is_no_ome_zarr(self):
        self.make()
        server = self.serve()
        self.check_refused("info", server.address("y.zarr"), says=["y.zarr: has no zarr.json, .zattrs"])
        self.check_refused("info", server.address("x.zarr") + "/0/0", says=["has no zarr.json"])
        (self.folder / "served/x.ozx").touch()
        for name in ("x.ozx", "x.ozx/0", "x.zip"):
            self.check_refused("info", server.address(name), says=[f"{name}: archives are not read", "download it"])
        said = self.check_refused("annotate", server.address("x.zarr"), "--script", self.write_script("s", []),
                                  says=["annotation is kept only in projects", '"x"'])
        self.assertNotIn("http:/1", said)
        self.check_refused("label", server.address("x.zarr"), "--threshold", "1", "-o", server.address("l.zarr"),
                           says=["nothing is written over a network"])
        self.check_refused("import", server.address("x.zarr"), server.address("p.zarr"), says=["p.zarr"])
        self.assertEqual({p.name for p in self.folder.iterdir()}, {"served", "volume.raw", "volume.nhdr", "s"})
        (self.folder / "served/x.zarr/shvr").mkdir()
        (self.folder / "served/x.zarr/shvr/volume.json").write_text("{}")
        self.assertIn("is a project on another machine, of which only the image is read",
                      self.check("info", server.address("x.zarr")).stderr)


class Project(RemoteTest):
    # Kind (Servers): a sparse project behind an address, whose tables say what is empty and need not be asked for
    def test_a_project_tells_what_is_empty(self):
        side = 160
        voxels = bytearray(side ** 3)
        for z in range(20, 40):
            for y in range(20, 40):
                begin = (z * side + y) * side
                voxels[begin + 20:begin + 40] = bytes(range(100, 120))
        (self.folder / "scan.raw").write_bytes(voxels)
        (self.folder / "served").mkdir()
        project = self.folder / "served" / "x.zarr"
        self.check("import", self.folder / "scan.raw", project, "--raw", f"{side}x{side}x{side}:uint8", "--spacing", "1,1,1",
                   "--unit", "um", "--quiet")
        local = self.check_json("info", project)
        missing = {}
        for has_tables in (True, False):
            if not has_tables:
                shutil.rmtree(project / "shvr")
            server = self.serve()
            told = run("info", server.address("x.zarr"), "--json", environment={"SHVR_REMOTE_CACHE_MIB": "0"})
            self.assertEqual(told.returncode, 0, told.stderr)
            for key in ("min", "max", "mean", "size", "spacing", "unit"):
                self.assertEqual(json.loads(told.stdout)[key], local[key])
            self.assertEqual(has_tables, "is a project on another machine" in told.stderr, told.stderr)
            picture = self.folder / f"{has_tables}.pfm"
            self.check("render", server.address("x.zarr"), "-o", picture, "--size", "48x32", "--quiet")
            chunks = [path for path in server.paths() if path.startswith("/x.zarr/0/") and "/." not in path]
            missing[has_tables] = [path for path in chunks if not (self.folder / "served" / path.lstrip("/")).is_file()]
        self.assertEqual(missing[True], [])
        self.assertGreater(len(missing[False]), 0)
        self.assertEqual((self.folder / "True.pfm").read_bytes(), (self.folder / "False.pfm").read_bytes())


class Missing(RemoteTest):
    # Kind (Servers): chunks that are missing, refused, removed and changed meanwhile, and what commands make of each
    def test_missing_and_forbidden_chunks(self):
        local = self.make()
        chunk = "x.zarr/0/0/1/0"
        server = self.serve()
        whole = self.check_json("label", server.address("x.zarr"), "--threshold", "0")["foreground_voxels"]
        self.assertEqual(whole, SIZE[0] * SIZE[1] * SIZE[2])
        (self.folder / "served" / chunk).unlink()
        counts = [self.check_json("label", path, "--threshold", "1")["foreground_voxels"]
                  for path in (server.address("x.zarr"), local)]
        self.assertEqual(counts[0], counts[1])
        server.check = lambda path, _: chunk not in path
        said = self.check_refused("label", server.address("x.zarr"), "--threshold", "1",
                                  says=[chunk, "access is refused (status 403)"])
        self.assertIn("expected", said)
        left = self.check_json("label", server.address("x.zarr"), "--threshold", "0", "--allow-incomplete")
        self.assertGreater(left["voxels_not_read"], 0)
        server.check = lambda *_: False
        self.check_refused("info", server.address("x.zarr"), says=["access is refused (status 403)"])

    def test_what_was_read_is_kept(self):
        self.make()
        counting = ["--threshold", "500", "--json"]
        with StoreServer(self.folder / "served") as server:
            address = server.address("x.zarr")
            first = run("label", address, *counting)
            self.assertEqual(first.returncode, 0, first.stderr)
            before = len(server.requests)
            self.assertEqual(json.loads(run("label", address, *counting).stdout)["components"],
                             json.loads(first.stdout)["components"])
            again = server.requests[before:]
            chunks = [headers for path, headers in again if "/0/" in path and not path.endswith(".zarray")]
            self.assertTrue(chunks and all("If-None-Match" in headers for headers in chunks))
        offline = run("label", address, *counting)
        self.assertEqual(offline.returncode, 0, offline.stderr)
        self.assertIn("no server answers; what was read of it before is taken from the cache", offline.stderr)
        self.assertEqual(json.loads(offline.stdout)["components"], json.loads(first.stdout)["components"])
        for environment in ({"SHVR_REMOTE_CACHE_MIB": "0"}, {"XDG_CACHE_HOME": str(self.folder)}):
            self.assertIn("cannot be read", run("label", address, *counting, environment=environment).stderr)
        self.assertIn("SHVR_REMOTE_CACHE_MIB", run("info", address, environment={"SHVR_REMOTE_CACHE_MIB": "x"}).stderr)

    def test_a_volume_that_changes_meanwhile(self):
        self.make("--ome-zarr", "0.5", "--shards")
        shard = self.folder / "served/x.zarr/0/c/0/0/0"
        server = self.serve()

        def before_chunks(path, count):
            if path.endswith("/x.zarr/0/c/0/0/0") and count == 1:
                content = bytearray(shard.read_bytes())
                content[20] ^= 255
                shard.write_bytes(content)
        server.fault = before_chunks
        self.check_refused("label", server.address("x.zarr"), "--threshold", "1",
                           says=["was changed since it was first read", "open it again"])


class Faults(RemoteTest):
    # Kind (Servers): servers that fail for a while, for ever, without end, too slowly, and by halves
    def test_faults_that_pass(self):
        self.make()
        answers = [faults.status(503, Retry_After="0"), faults.status(429), faults.reset, faults.too_short]
        server = self.serve(lambda _, count: answers[(count + len(server.requests)) % 4] if count < 2 else None)
        self.assertEqual(self.check_json("info", server.address("x.zarr"))["size"], list(SIZE))

    def refused(self, fault, *says):
        server = self.serve(lambda path, _: fault if path.endswith("0/.zarray") or fault is faults.endless_headers else None)
        begun = time.monotonic()
        said = self.check_refused("info", server.address("x.zarr"), says=says)
        self.assertLess(time.monotonic() - begun, 60)
        self.assertLess(len(said), 600)

    def test_faults_that_stay(self):
        self.make()
        self.refused(faults.status(500), "status 500, after 3 tries")
        self.refused(faults.too_short, "cannot be read", "after 3 tries")
        self.refused(faults.endless, "the body is longer than")
        self.refused(faults.endless_headers, "bytes of headers")
        self.refused(faults.drip, "no answer in time")
        self.refused(faults.silent, "no answer in time")
        self.refused(faults.status(200), "0/.zarray")
        self.refused(faults.status(302, Location="ftp://127.0.0.1/x?secret=1"), "an address with the scheme \"ftp\"")
        self.refused(faults.status(302, Location="/x.zarr/0/.zarray"), "redirected more than 5 times")

    def test_no_server(self):
        with StoreServer(self.folder) as server:
            address = server.address("x.zarr")
        for tries, words in (("3", "after 3 tries"), ("1", "after 1 try\n")):
            result = run("info", address, environment={"SHVR_REMOTE_TRIES": tries})
            self.assertEqual(result.returncode, 1)
            self.assertIn(address, result.stderr)
            self.assertIn(": cannot be read: Failed to connect to 127.0.0.1 port", result.stderr)
            self.assertIn(words, result.stderr)
            self.assertEqual((result.stderr.count("onnect"), result.stderr.count("Connection refused")), (2, 1), result.stderr)

    def test_redirects_are_followed(self):
        self.make()
        server = self.serve()
        server.fault = lambda path, _: faults.status(307, Location=path.replace("moved", "x.zarr")) if "moved" in path else None
        self.assertEqual(self.check_json("info", server.address("moved"))["size"], list(SIZE))

    def test_ctrl_c_ends_a_wait(self):
        self.make()
        server = self.serve(lambda path, _: faults.silent if path.endswith(".zarray") else None)
        with subprocess.Popen([SHVR, "info", server.address("x.zarr")], stderr=subprocess.PIPE, text=True,
                              env={**ENVIRONMENT, "SHVR_REMOTE_STALL_S": "400"}) as process:
            while not any(path.endswith(".zarray") for path in server.paths()):
                time.sleep(0.02)
            process.send_signal(signal.SIGINT)
            _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, said)
        self.assertIn("stopped", said)


class Secrets(RemoteTest):
    def test_the_query_of_an_address(self):
        self.make()
        server, secret = self.serve(), "sig=T0p%2FSecret"
        server.check = lambda path, _: path.endswith("?" + secret)
        address = server.address("x.zarr")
        self.check_refused("info", address, says=["access is refused"])
        for command in (["info", f"{address}?{secret}", "--json"],
                        ["import", f"{address}/?{secret}", self.folder / "p.zarr"],
                        ["render", f"{address}?{secret}", "-o", self.folder / "a.png", "--size", "16x16"],
                        ["info", self.write_session(volume={"path": f"{address}?{secret}"})],
                        ["info", self.write_session("b.json"), "--set", f"volume={{\"path\":\"{address}?{secret}\"}}"],
                        ["info", self.write_session("b.json", volume={"path": "x"}), "--set", f"volume.path={address}?{secret}"]):
            result = run(*command)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertNotIn("Secret", result.stdout + result.stderr)
        self.assertNotIn("Secret", self.check_refused("info", f"{address}?{secret}", "", status=2, says=["is empty"]))
        for place in [self.folder / "a.png", *(self.folder / "p.zarr").rglob("*")]:
            self.assertTrue(not place.is_file() or b"Secret" not in place.read_bytes(), place)
        server.check = lambda *_: False
        self.assertNotIn("Secret", self.check_refused("info", f"{address}?{secret}", says=["a query that is still valid"]))

    def test_redirects_do_not_take_a_query_along(self):
        self.make()
        other = self.serve()
        server = self.serve(lambda path, _: faults.status(302, Location=other.address(path.split("?")[0].lstrip("/"))))
        result = self.check_json("info", server.address("x.zarr") + "?sig=Secret")
        self.assertEqual(result["size"], list(SIZE))
        self.assertTrue(all(path.endswith("?sig=Secret") for path in server.paths()))
        self.assertTrue(other.requests and not any("Secret" in path for path in other.paths()))

    def test_passwords_in_addresses(self):
        said = self.check_refused("info", "https://me:Secret@example.org/x.zarr", says=["a name or a password"])
        self.assertNotIn("Secret", said)


if __name__ == "__main__":
    unittest.main()
