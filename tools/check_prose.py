#!/usr/bin/env python3
"""Counts phrases that need a second reading, in everything that is read: comments, texts on the screen, messages, --help,
Markdown. The counts of tests/prose.txt are ceilings that only fall: more is a failure, and so is less until the ceiling
is lowered to it.

tools/check_prose.py           checks the counts; the places of a pattern that has too many, one a line
tools/check_prose.py --list    every place
tools/check_prose.py --lower   writes the counts as they are to tests/prose.txt, unless one has risen
"""
import collections
import re
import sys
from pathlib import Path

from check_layers import files_below

ROOT = Path(__file__).resolve().parent.parent
CEILINGS = ROOT / "tests" / "prose.txt"

# name: (pattern, what to write instead)
PATTERNS = {
    "fragment": (r"(?:^|///<\s*|\.\s+)[Oo]f (?:what|each|all|some|two|an?|the|those|these|it|them|that|which|its)\b",
                 "name the subject: 'voxel size of the parent', not 'Of the parent.'"),
    "clause": (r"(?:^|[.:;]\s+)(?:What|Whatever|Whoever|Who|That which)\s+\w+(?:\s+\w+)*?\s+"
               r"(?:is|are|has|have|was|were|goes|stays|comes|lies|may|must|does|says|reads|asks|takes)\b",
               "a noun as the subject: 'Released memory is freed later'"),
    "nobody": (r"\b(?:[Nn]obody|[Ss]omebody|[Ee]verybody|[Ww]hoever)\b", "name the caller, the thread or the user"),
    "no_number": (r"\bno numbers?\b(?! of)", "NaN, or not finite"),
    "anew": (r"\banew\b", "again, re-create, rebuild"),
    "beside": (r"\b[Bb]eside\b(?! (?:it|the (?:file|scan|volume|project|session|code|program|picture|image)))",
               "next to, in addition to, in the background"),
    "but_for": (r"\bbut for\b", "except"),
    "so_many": (r"\bso (?:many|much|manyth)\b(?! (?:that|as to))", "this many, N"),
    "told_of": (r"\b(?:told|tells?) (?:of|that|what|which|from)\b", "report, warn, notify, indicate"),
    "give_way": (r"\bgiv(?:e|es|ing) way\b|\bgave way\b", "is evicted, releases memory"),
    "turn": (r"\b(?:a|each|every|one|per|of) turns?\b(?! of the (?:head|camera|volume|wheel))", "iteration, frame"),
    "there_is": (r"\bthat there (?:is|are|was|were)\b", "the noun first"),
    "come_by": (r"\bc(?:o|a)mes? by\b", "pass, poll, visit"),
    "limit": (r"\b(?:MOST|LEAST|LARGEST|SMALLEST|LONGEST|FEWEST)_[A-Z_]+\b", "MAX_..., MIN_..."),
}
COMPILED = {name: re.compile(pattern) for name, (pattern, _) in PATTERNS.items()}
CODE = re.compile(r"\.(?:cpp|h|comp|glsl)$")
COMMENT = re.compile(r"(?<![:\"'])//+<?\s?(.*)$")
SAID = ("ui/", "engine/", "haptics/", "tools/")  # rooms whose string literals are texts on screen, messages or --help


def prose_of(path, line):
    """The parts of a line that a person reads."""
    if path.endswith(".md"):
        return [] if line.lstrip().startswith(("```", "    ")) else [line.strip()]
    if CODE.search(path):
        found = [match.group(0) for match in [COMMENT.search(line)] if match]
        if path.startswith(SAID):
            found += [text for text in re.findall(r'"((?:[^"\\]|\\.){12,})"', line) if " " in text]
        return found + re.findall(r"\b(?:MOST|LEAST|LARGEST|SMALLEST|LONGEST|FEWEST)_[A-Z_]+\s*=", line)
    match = re.search(r"(?:^|\s)#\s(.*)$", line)
    return [match[1]] if match else []


def places():
    """(pattern, path, line number, text) of every phrase in the tree."""
    for name in map(str, files_below(ROOT)):
        is_script = "." not in Path(name).name and name.startswith(("tools/", "tests/"))
        if name in ("tools/check_prose.py", "tests/prose.txt") or not (
                is_script or CODE.search(name) or name.endswith((".md", ".py", ".sh", ".cmake"))):
            continue
        for number, line in enumerate((ROOT / name).read_text(encoding="utf-8", errors="replace").splitlines(), 1):
            for text in prose_of(name, line):
                for pattern, compiled in COMPILED.items():
                    if compiled.search(text):
                        yield pattern, name, number, text.strip()


def read_ceilings():
    lines = CEILINGS.read_text(encoding="utf-8").splitlines() if CEILINGS.is_file() else []
    return {name: int(count) for name, count in (line.split() for line in lines if line and not line.startswith("#"))}


def main():
    if sys.argv[1:] not in ([], ["--list"], ["--lower"]):
        print(__doc__)
        return 0 if sys.argv[1:] in (["-h"], ["--help"]) else 2
    found = list(places())
    counts = collections.Counter(place[0] for place in found)
    ceilings = read_ceilings()
    risen = [name for name in PATTERNS if counts[name] > ceilings.get(name, 0)]
    fallen = [name for name in PATTERNS if counts[name] < ceilings.get(name, 0)]
    if sys.argv[1:] == ["--lower"] and (not risen or not ceilings):
        CEILINGS.write_text("# Phrases that need a second reading: ceilings of tools/check_prose.py, which only fall.\n"
                            + "".join(f"{name} {counts[name]}\n" for name in PATTERNS if counts[name]), encoding="utf-8")
        return 0
    for name, path, number, text in found:
        if name in risen or sys.argv[1:] == ["--list"]:
            print(f"{path}:{number}: [{name}] {text[:120]}")
    for name in risen:
        print(f"{name}: {counts[name]} places; expected at most {ceilings.get(name, 0)}: write {PATTERNS[name][1]}")
    for name in fallen:
        print(f"{name}: {counts[name]} places; tests/prose.txt allows {ceilings[name]}: run tools/check_prose.py --lower")
    return 1 if risen or fallen else 0


if __name__ == "__main__":
    sys.exit(main())
