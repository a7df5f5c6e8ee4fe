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
a comment `same again: REASON` on its line or the line before.

Functions that a loop calls are followed, through the files that theirs includes: what they assign to `inout` and `out`
parameters, the loop assigns. Of several functions of one name, all with that number of parameters count, since macros
choose between them. A parameter that is `inout` or `out` counts as read after every loop.
"""
from functools import cache
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


class Function:
    """A function of a file; [begin, end) is its body, and `written` names its `inout` and `out` parameters."""
    def __init__(self, name, parameters, begin, end):
        self.name, self.begin, self.end = name, begin, end
        self.parameters = [part.replace("[]", "").split()[-1] for part in split(parameters)]
        self.written = {words[-1] for part in split(parameters) if {"inout", "out"} & set(words := part.split())}


def split(text):
    """The parts between the commas that no bracket encloses."""
    parts, depth, first = [], 0, 0
    for i, letter in enumerate(text):
        depth += letter in "({["
        depth -= letter in ")}]"
        if letter == "," and depth == 0:
            parts.append(text[first:i].strip())
            first = i + 1
    return [part for part in [*parts, text[first:].strip()] if part]


def functions(text):
    """Every function that has a body."""
    at = 0
    while (brace := text.find("{", at)) >= 0:
        end = closing(text, brace)
        head = re.compile(rf"({NAME})\s*\(([^()]*)\)\s*$").search(text[at:brace])
        if head:
            yield Function(head.group(1), head.group(2), brace, end)
        at = end + 1


@cache
def parsed(path):
    """(lines, plain text, functions) of a file."""
    source = path.read_text(encoding="utf-8")
    text = plain(source)
    return source.splitlines(), text, list(functions(text))


@cache
def seen_from(path):
    """[(file, function)] of a file and all that it includes."""
    files, waiting = [], [path.resolve()]
    while waiting:
        file = waiting.pop()
        if file not in files and file.is_file():
            files.append(file)
            included = re.findall(r'(?m)^[ \t]*#[ \t]*include[ \t]+"([^"]+)"', file.read_text(encoding="utf-8"))
            waiting += [(file.parent / name).resolve() for name in included]
    return [(file, function) for file in files for function in parsed(file)[2]]


def calls(text, begin, end, found):
    """(position, file, function, arguments) of each call of a function of `found` that writes parameters."""
    by_name = {}
    for file, function in found:
        if function.written:
            by_name.setdefault(function.name, []).append((file, function))
    for match in re.compile(rf"(?<![\w.])({NAME})\s*\(").finditer(text, begin, end):
        for file, function in by_name.get(match.group(1), []):
            arguments = split(text[match.end():closing(text, match.end() - 1)])
            if len(arguments) == len(function.parameters):
                yield match.start(), file, function, arguments


def carriers(text, begin, end, name):
    """`name`, and the constants of [begin, end) that are computed from all of it, not from a member alone."""
    names = {name}
    for match in re.compile(rf"\bconst\s+\w+\s+({NAME})\s*=").finditer(text, begin, end):
        value = text[match.end():assignment_ends(text, match.end())]
        if any(re.search(rf"(?<![\w.]){one}\b(?!\s*\.|\()", value) for one in names):
            names.add(match.group(1))
    return names


def base_of(argument):
    return re.match(rf"({NAME})|", argument).group(1)


def is_excused(lines, line):
    return any("same again:" in lines[i] for i in (line - 1, line) if 0 <= i < len(lines))


def written_by(kernel, file, function, parameter, on_the_way=()):
    """{(file, line, name)} of the assignments to a parameter that do without its former value, also in functions that
    this one calls."""
    if (file, function.begin, parameter) in on_the_way:
        return set()
    lines, text, _ = parsed(file)
    result = set()
    for match in ASSIGNED.finditer(text, function.begin, function.end):
        value = text[match.end():assignment_ends(text, match.end())]
        line = text.count("\n", 0, match.start())
        is_carried = any(re.search(rf"(?<![\w.]){one}\b", value)
                         for one in carriers(text, function.begin, match.start(), parameter))
        if match.group(1) == parameter and not is_carried and not is_excused(lines, line):
            result.add((file, line + 1, parameter))
    for at, callee_file, callee, arguments in calls(text, function.begin, function.end, seen_from(kernel)):
        for given, name in zip(arguments, callee.parameters):
            if name in callee.written and base_of(given) == parameter and \
                    not is_excused(lines, text.count("\n", 0, at)):
                result |= written_by(kernel, callee_file, callee, name,
                                     (*on_the_way, (file, function.begin, parameter)))
    return result


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


def is_read_after(function, text, name, loop_end):
    return name in function.written or re.search(rf"(?<![\w.]){name}\b(?!\s*=[^=])", text[loop_end:function.end])


def diverging_loops(text, function):
    """(begin, (first, last) of the body, end, names declared inside) of the loops that lanes leave one by one."""
    counters = set()
    for start, head, (first, last), loop_end in loops(text, function.begin, function.end):
        counter = counter_of_all(head, text[first:last], counters)
        if counter:
            counters.add(counter)
        else:
            yield start, (first, last), loop_end, set(DECLARED.findall(text[first:last])) | set(DECLARED.findall(head))


def lost_in(kernel, path):
    """{(file, line, name)} of the assignments in loops of a file whose values a lane may lose; `kernel` includes it."""
    lines, text, found = parsed(path)
    lost = set()
    for function in found:
        for start, (first, last), loop_end, inside in diverging_loops(text, function):
            def is_outer(name, function=function, start=start, inside=inside):
                before = text[function.begin:start]
                return name not in inside and (name in function.parameters or
                                               re.search(rf"(?<![\w.]){name}\b", before))  # no global or shared one
            for match in ASSIGNED.finditer(text, first, last):
                name = match.group(1)
                value = text[match.end():assignment_ends(text, match.end())]
                line = text.count("\n", 0, match.start())
                is_declaration = re.search(r"[\w\]]\s+$", text[max(function.begin, match.start() - 40):match.start()])
                if is_outer(name) and not is_declaration and not re.search(rf"(?<![\w.]){name}\b", value) and \
                        not is_excused(lines, line) and is_read_after(function, text, name, loop_end):
                    lost.add((path, line + 1, name))
            for at, file, callee, arguments in calls(text, first, last, seen_from(kernel)):
                for given, name in zip(arguments, callee.parameters):
                    base = base_of(given)
                    if name in callee.written and base and is_outer(base) and \
                            not is_excused(lines, text.count("\n", 0, at)) and \
                            is_read_after(function, text, base, loop_end):
                        lost |= written_by(kernel, file, callee, name)
    return lost


def main():
    files = [Path(name).resolve() for name in sys.argv[1:]] or \
        sorted(path for path in (ROOT / "shaders").rglob("*") if path.suffix in (".comp", ".glsl", ".h"))
    lost = set()
    for kernel in files:
        for file in {kernel, *(file for file, _ in seen_from(kernel))}:
            lost |= lost_in(kernel, file)
    lines = [f"{path}:{line}: {name} is assigned in a loop without its former value, and read after it; expected "
             f"'{name} = ... {name} ...', since lanes that have left keep nothing else (shaders/README.md)"
             for path, line, name in sorted(lost)]
    for line in lines:
        print(line.replace(str(ROOT) + "/", ""), file=sys.stderr)
    sys.exit(1 if lines else 0)


if __name__ == "__main__":
    main()
