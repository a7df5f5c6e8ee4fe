"""The form of the user manual's pages, and the tool that carries them out; test_user_manual_slow.py carries out all."""
import re
import subprocess
import unittest
from pathlib import Path

from harness import SHVR, CliTest, commands

TOOL = Path("tools/package/make_manual").resolve()
PAGES = Path("assets/manual")
FENCE = re.compile(r"^```(\S+)(?: (\S+))?\n(.*?)^```$", re.M | re.S)


class UserManual(CliTest):
    def make(self, page, *arguments):
        """Runs the tool on a manual of one page."""
        pages = self.folder / "pages"
        pages.mkdir(exist_ok=True)
        (pages / "index.md").write_text("# Index\n\n[One](one.md)\n")
        (pages / "one.md").write_text(page)
        return subprocess.run([TOOL, SHVR, *arguments, "--pages", pages], capture_output=True, text=True, check=False)

    def test_ten_pages_each_with_steps_and_a_picture(self):
        pages = sorted(PAGES.glob("*.md"))
        self.assertEqual(len(pages), 12)   # with README.md and index.md
        for path in pages:
            if path.name in ("README.md", "index.md"):
                continue
            text = path.read_text()
            self.assertGreaterEqual(len(FENCE.findall(text)), 3, path)
            self.assertRegex(text, r"!\[[^\]]+\]\([\w-]+\.png\)", path)

    def test_pages_name_commands_that_exist_and_link_pages_that_exist(self):
        known = set(commands())
        for path in PAGES.glob("*.md"):
            text = path.read_text()
            for kind, _, body in FENCE.findall(text):
                if kind == "sh":
                    self.assertLessEqual(set(re.findall(r"^ *shvr (\w+)", body, re.M)), known, path)
            for link in re.findall(r"[^!]\[[^\]]+\]\(([\w-]+\.md)\)", text):
                self.assertTrue((PAGES / link).is_file(), (path, link))

    def test_a_page_that_holds_passes(self):
        page = "# One\n\n```json a.json\n{}\n```\n\n```sh\ngrep -q '{}' a.json\ncp a.json a.png\n```\n\n![a](a.png)\n"
        self.assertEqual(self.make(page, "--check").returncode, 0)

    def test_a_step_that_fails_is_named_with_its_text(self):
        for step in ["false\ntrue", "false | true", "echo $unset_variable", "shvr info no-such-file"]:
            result = self.make(f"# One\n\n```sh\n{step}\n```\n", "--check")
            self.assertEqual(result.returncode, 1, step)
            self.assertIn("one.md has a step that ends with status", result.stderr)
            self.assertIn(step, result.stderr)

    def test_a_picture_that_no_step_makes_and_an_unknown_block_are_refused(self):
        for page, says in [("# One\n\n![a](a.png)\n", "one.md shows a.png"),
                           ("# One\n\n```python\n1\n```\n", "block of the kind 'python'")]:
            result = self.make(page, "--check")
            self.assertEqual(result.returncode, 1, page)
            self.assertIn(says, result.stderr)

    def test_a_page_that_the_index_lacks_is_refused(self):
        (self.folder / "pages").mkdir()
        (self.folder / "pages" / "lost.md").write_text("# Lost\n")
        self.assertIn("index.md does not link lost.md", self.make("# One\n", "--check").stderr)

    def test_html_has_the_page_its_picture_and_its_links(self):
        page = ("# One & more\n\nSee [the index](index.md).\n\n```sh\necho '<b>' > a.png\n```\n\n![a](a.png)\n\n"
                "| a | b |\n|---|---|\n| 1 | 2 |\n\nA look:\n\n```json look.json\n{}\n```\n")
        result = self.make(page, self.folder / "html")
        if "python3-markdown is missing" in result.stderr:
            self.skipTest("no interpreter here has python3-markdown")
        self.assertEqual(result.returncode, 0, result.stderr)
        html = (self.folder / "html" / "one.html").read_text()
        for part in ["<title>One &amp; more</title>", 'href="index.html"', 'src="one-a.png"', "&lt;b&gt;", "<table>",
                     "File <code>look.json</code></p>\n\n<pre><code>{}"]:
            self.assertIn(part, html)
        self.assertTrue((self.folder / "html" / "one-a.png").is_file())


if __name__ == "__main__":
    unittest.main()
