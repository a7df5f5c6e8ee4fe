#!/usr/bin/env python3
"""Refuses loops in kernels whose results a driver may lose (shaders/README.md, "House rules"): lanes leave a loop one by
one, and SwiftShader keeps of a lane that has left only what each iteration computes from the iteration before. So a
variable that is declared before a loop, assigned in it and read after it must be assigned from itself:

    is_hit = is_set(voxel);                            refused
    is_hit = is_hit || (goes_on && is_set(voxel));     accepted
    slot = is_taken ? new_slot : slot;                 accepted

tools/check_loops.py            checks shaders/
tools/check_loops.py FILES      checks these files

A loop that all lanes leave together (`for` with bounds of constants and parameters, no `break`, `continue` or `return`)
loses nothing and is not looked at. An assignment that gives a lane which has left the same value again is accepted with
a comment `same again: REASON` on its line or the line before. Functions are not followed: what a function that is
called in a loop assigns to its `inout` parameters is not seen.
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NAME = r"[A-Za-z_]\w*"
ASSIGNED = re.compile(rf"(?<![\w.])({NAME})((?:\.\w+|\[[^\]=]*\])*)\s*(?<![=!<>+\-*/|&^%])=(?!=)")
DECLARED = re.compile(rf"(?<![\w.])(?:const\s+)?(?:bool|int|uint|float|double|[biud]?vec[234]|mat[234]|[A-Z]\w*)\s+({NAME})"
                      r"\s*(?=[=;,\[)])")


def plain(text):
    """The text without comments and preprocessor lines, in as many lines."""
    text = re.sub(r"/\*.*?\*/", lambda match: "\n" * match.group().count("\n"), text, flags=re.S)
    text = re.sub(r"//[^\n]*", "", text)
    return re.sub(r"(?m)^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", lambda match: "\n" * match.group().count("\n"), text)


def closing(text, at):
    """Where the bracket that opens at `at` is closed."""
    depth = 0
    for i in range(at, len(text)):
        depth += text[i] in "({["
        depth -= text[i] in ")}]"
        if depth == 0:
            return i
    return len(text) - 1


def statement_end(text, at):
    """The end of the statement that begins at `at`: a block, or what a ';' ends."""
    while at < len(text) and text[at].isspace():
        at += 1
    if at < len(text) and text[at] == "{":
        return closing(text, at) + 1
    depth = 0
    for i in range(at, len(text)):
        depth += text[i] in "({["
        depth -= text[i] in ")}]"
        if text[i] == "{" and depth == 1:
            return closing(text, i) + 1
        if text[i] == ";" and depth == 0:
            return i + 1
    return len(text)


def functions(text):
    """(begin, end) of every block at the outermost level that follows a ')'."""
    at = 0
    while (brace := text.find("{", at)) >= 0:
        end = closing(text, brace)
        if text[:brace].rstrip().endswith(")"):
            yield brace, end
        at = end + 1


def loops(text, begin, end):
    """(begin, head, body, end) of each loop, nested ones too."""
    for match in re.compile(r"\b(for|while|do)\b").finditer(text, begin, end):
        if match.group(1) == "do":
            body_end = statement_end(text, match.end())
            condition = re.compile(r"\s*while\s*\(").match(text, body_end)
            if condition:
                yield match.start(), text[condition.end():closing(text, condition.end() - 1)], \
                    (match.end(), body_end), closing(text, condition.end() - 1) + 1
            continue
        head = text.find("(", match.end())
        head_end = closing(text, head)
        rest = text[head_end + 1:].lstrip()
        if match.group(1) == "while" and rest.startswith(";"):
            continue  # the end of a do loop
        yield match.start(), text[head + 1:head_end], (head_end + 1, statement_end(text, head_end + 1)), \
            statement_end(text, head_end + 1)


def counter_of_all(head, body, counters):
    """The counter of a loop that all lanes run equally often, or None: a `for` loop without another way out, bounded by
    numbers, constants, fields of `params` and `counters`, those of such loops around it."""
    parts = head.split(";")
    if len(parts) != 3 or re.search(r"\b(break|return|continue)\b", body):
        return None
    bound = re.fullmatch(rf"\s*({NAME})\s*(?:<|<=|>|>=|!=)(.*)", parts[1], re.S)
    first = re.search(r"=(.*)", parts[0], re.S)
    if not bound or not first:
        return None
    same = rf"(?:\s|[-+*/()]|\d+u?\b|\b[A-Z][A-Z0-9_]*\b|\bparams(?:\.\w+)+|\b(?:{'|'.join(sorted(counters)) or '0'})\b)*"
    is_same = all(re.fullmatch(same, part) for part in (first.group(1), bound.group(2)))
    return bound.group(1) if is_same else None


def assignment_ends(text, at):
    depth = 0
    for i in range(at, len(text)):
        if text[i] in "({[":
            depth += 1
        elif text[i] in ")}]":
            depth -= 1
            if depth < 0:
                return i
        elif depth == 0 and text[i] in ";,":
            return i
    return len(text)


def lost_in(text):
    """[(line, name)] of the assignments whose values a lane may lose."""
    lines = text.splitlines()
    text = plain(text)
    found = set()
    for begin, end in functions(text):
        counters = set()
        for start, head, (body_begin, body_end), loop_end in loops(text, begin, end):
            body = text[body_begin:body_end]
            counter = counter_of_all(head, body, counters)
            if counter:
                counters.add(counter)
                continue
            inside = set(DECLARED.findall(body)) | set(DECLARED.findall(head))
            for match in ASSIGNED.finditer(text, body_begin, body_end):
                name = match.group(1)
                value = text[match.end():assignment_ends(text, match.end())]
                before = text[max(begin, match.start() - 40):match.start()]
                if name in inside or re.search(rf"[\w\]]\s+$", before) or re.search(rf"(?<![\w.]){name}\b", value):
                    continue
                if not re.search(rf"(?<![\w.]){name}\b", text[begin:start]):
                    continue  # a global or shared variable
                line = text.count("\n", 0, match.start())
                if any("same again:" in lines[i] for i in (line - 1, line)):
                    continue
                if re.search(rf"(?<![\w.]){name}\b(?!\s*=[^=])", text[loop_end:end]):
                    found.add((line + 1, name))
    return sorted(found)


def main():
    files = [Path(name) for name in sys.argv[1:]] or \
        sorted(path for path in (ROOT / "shaders").rglob("*") if path.suffix in (".comp", ".glsl", ".h"))
    lines = [f"{path}:{line}: {name} is assigned in a loop without its former value, and read after it; expected "
             f"'{name} = ... {name} ...', since lanes that have left keep nothing else (shaders/README.md)"
             for path in files for line, name in lost_in(path.read_text())]
    for line in lines:
        print(line.replace(str(ROOT) + "/", ""), file=sys.stderr)
    sys.exit(1 if lines else 0)


if __name__ == "__main__":
    main()
