"""Manual pages and shell completions against --help, from whose tables both come."""
import re
import shutil
import subprocess
import unittest

from harness import CliTest, commands, run


def every_command():
    for command in commands():
        yield [command]
        yield from ([command, part] for part in commands(command))


def options_in_help(command):
    """Long options as --help lists them, in one or several sections."""
    listed = run(*command, "--help").stdout
    return set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", listed, re.M)) | set(re.findall(r"^  (-h)", listed, re.M))


class Manual(CliTest):
    def setUp(self):
        super().setUp()
        self.check("manual", self.folder / "share")
        self.share = self.folder / "share"

    def page(self, command):
        return (self.share / "man/man1" / ("-".join(["shvr", *command]) + ".1")).read_text()

    def test_a_page_for_each_command_names_each_option_of_its_help(self):
        pages = {path.name for path in (self.share / "man/man1").iterdir()}
        wanted = {"-".join(["shvr", *command]) + ".1" for command in every_command()} | {"shvr.1"}
        self.assertEqual(pages, wanted)
        for command in every_command():
            with self.subTest(command=command):
                named = set(re.findall(r"^\\fB(.*?)\\fR", self.page(command), re.M))
                names = {name.replace("\\-", "-") for group in named for name in group.split(", ")}
                self.assertEqual(options_in_help(command) - names, set())

    def test_pages_format_without_a_warning(self):
        for command in [[], ["render"], ["haptics", "replay"]]:
            result = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z"], input=self.page(command), text=True,
                                    capture_output=True, check=False)
            self.assertEqual((result.returncode, result.stderr), (0, ""), command)

    def complete(self, *words):
        """The words that bash offers after these."""
        script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _shvr; '
                  'printf "%s\\n" "${COMPREPLY[@]}"')
        result = subprocess.run(["bash", "-c", script, "bash", self.share / "bash-completion/completions/shvr", *words],
                                capture_output=True, text=True, check=True)
        return set(result.stdout.split())

    def test_bash_completes_commands_options_and_values(self):
        self.assertLessEqual(set(commands()), self.complete("shvr", ""))
        self.assertEqual(self.complete("shvr", "rend"), {"render"})
        self.assertEqual(self.complete("shvr", "haptics", "rep"), {"replay"})
        for command in every_command():
            offered = self.complete("shvr", *command, "--")
            self.assertEqual({name for name in options_in_help(command) if name.startswith("--")}, offered, command)
        self.assertEqual(self.complete("shvr", "render", "a.json", "--believe", ""), {"files", "journal"})

    def test_zsh_and_fish_know_the_same_options(self):
        zsh = (self.share / "zsh/site-functions/_shvr").read_text()
        fish = (self.share / "fish/vendor_completions.d/shvr.fish").read_text()
        for command in every_command():
            body = zsh.partition("_" + "_".join(["shvr", *command]) + "()\n")[2].partition("\n}\n")[0]
            lines = [line for line in fish.splitlines()
                     if line.partition("' ")[0].endswith("__fish_seen_subcommand_from " + command[-1])]
            for option in options_in_help(command):
                self.assertIn(f"'{option}[", body, command)
                flag = f" -l {option[2:]} " if option.startswith("--") else f" -s {option[1:]} "
                self.assertTrue(any(flag in line for line in lines), (command, option))

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed")
    def test_fish_completes_commands_options_and_values(self):
        script = self.share / "fish/vendor_completions.d/shvr.fish"
        for line, wanted in [("shvr rend", {"render"}), ("shvr render --cam", {"--camera"}),
                             ("shvr haptics rep", {"replay"}), ("shvr render a.json --believe ", {"files", "journal"})]:
            result = subprocess.run(["fish", "--no-config", "-c", 'source $argv[1]; complete -C $argv[2]', script, line],
                                    capture_output=True, text=True, check=True)
            self.assertEqual({word.partition("\t")[0] for word in result.stdout.splitlines()}, wanted, line)

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh_finds_the_completion_and_parses_it(self):
        folder = self.share / "zsh/site-functions"
        subprocess.run(["zsh", "-n", folder / "_shvr"], check=True)
        script = 'fpath=("$1" $fpath); autoload -U compinit; compinit -D -u; print ${_comps[shvr]}; autoload +X _shvr'
        result = subprocess.run(["zsh", "-fc", script, "zsh", folder], capture_output=True, text=True, check=True)
        self.assertEqual((result.stdout, result.stderr), ("_shvr\n", ""))

    def test_a_second_run_gives_equal_files_and_refuses_no_folder(self):
        self.check("manual", self.folder / "again")
        for path in sorted(self.share.rglob("*")):
            if path.is_file():
                self.assertEqual(path.read_bytes(), (self.folder / "again" / path.relative_to(self.share)).read_bytes())
        (self.folder / "file").write_text("")
        self.check_refused("manual", self.folder / "file", says=["file", "folder"])


if __name__ == "__main__":
    unittest.main()
