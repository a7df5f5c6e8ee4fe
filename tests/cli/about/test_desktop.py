"""The desktop entry, the description for software centres, and the file types: valid, and the types that files get."""
import configparser
import os
import re
import shutil
import subprocess
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from harness import CliTest

PACKAGE = Path("tools/package")
NEEDED = {"desktop-file-validate": "desktop-file-utils", "appstreamcli": "appstream",
          "update-mime-database": "shared-mime-info", "gio": "libglib2.0-bin"}
MISSING = sorted(package for program, package in NEEDED.items() if not shutil.which(program))
# What a file begins with, by its name, and the type that it gets.
FILES = {"stem.session.json": (b"{}", "application/x-shvr-session"), "other.json": (b"{}", "application/json"),
         "stem.ozx": (b"PK\3\4", "application/x-ome-zarr-zip"),
         "stem.nrrd": (b"NRRD0004\n", "application/x-nrrd"), "stem.nhdr": (b"NRRD0005\n", "application/x-nrrd"),
         "stem.nii": (b"\0\0\1\x5c", "application/x-nifti"), "stem.nii.gz": (b"\x1f\x8b\b", "application/x-nifti-gz"),
         "stem.mhd": (b"ObjectType = Image\n", "application/x-metaimage"),
         "stem.mha": (b"ObjectType = Image\n", "application/x-metaimage"),
         "stem.dcm": (bytes(128) + b"DICM", "application/dicom"), "stem.tif": (b"II*\0", "image/tiff")}


def entry():
    parser = configparser.ConfigParser(interpolation=None)
    parser.optionxform = str
    parser.read(PACKAGE / "shvr.desktop")
    return parser["Desktop Entry"]


@unittest.skipIf(MISSING, f"not installed: {', '.join(MISSING)}")
class Desktop(CliTest):
    def test_entry_and_description_are_valid(self):
        result = subprocess.run(["desktop-file-validate", PACKAGE / "shvr.desktop"], capture_output=True, text=True,
                                check=False)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        result = subprocess.run(["appstreamcli", "validate", "--no-net", PACKAGE / "shvr.metainfo.xml"],
                                capture_output=True, text=True, check=False)
        # AppStream 1.0 warns of the missing home page; the project has none.
        problems = [line for line in result.stdout.splitlines() if re.match("[EW]: ", line)]
        self.assertEqual([line for line in problems if "url-homepage-missing" not in line], [])
        self.assertTrue(problems or result.returncode == 0, result.stdout + result.stderr)
        self.assertEqual(entry()["Icon"], (PACKAGE / "shvr.svg").stem)
        self.assertTrue(entry()["Exec"].startswith("shvr view "))

    def test_the_description_has_the_version_that_is_built(self):
        version = re.search(r"^project\(SHVR VERSION ([\d.]+)", Path("CMakeLists.txt").read_text(), re.M)[1]
        releases = ElementTree.parse(PACKAGE / "shvr.metainfo.xml").iter("release")
        self.assertEqual(next(releases).get("version"), version)
        self.assertTrue((PACKAGE / "changelog").read_text().startswith(f"shvr ({version}-"))
        self.assertIn(f"\n## {version}\n", (PACKAGE / "CHANGELOG.md").read_text())

    def test_files_get_their_types_and_the_entry_opens_each(self):
        data = self.folder / "data"
        (data / "mime" / "packages").mkdir(parents=True)
        shutil.copy(PACKAGE / "shvr.mime.xml", data / "mime" / "packages" / "shvr.xml")
        subprocess.run(["update-mime-database", data / "mime"], check=True, capture_output=True)
        opened = set(entry()["MimeType"].rstrip(";").split(";"))
        files = self.folder / "files"
        files.mkdir()
        for name, (head, _) in FILES.items():
            (files / name).write_bytes(head + bytes(600))
        environment = {**os.environ, "LC_ALL": "C", "XDG_DATA_HOME": str(data)}
        listed = subprocess.run(["gio", "list", "--attributes=standard::content-type", files], check=True, text=True,
                                capture_output=True, env=environment).stdout
        found = dict(re.findall(r"^(\S+)\t.*standard::content-type=(\S+)", listed, re.M))
        self.assertEqual(found, {name: kind for name, (_, kind) in FILES.items()})
        self.assertEqual({kind for _, kind in FILES.values()} - {"application/json"} - opened, set())
        self.assertEqual(opened - {kind for _, kind in FILES.values()}, {"inode/directory"})   # Open with, for folders


if __name__ == "__main__":
    unittest.main()
