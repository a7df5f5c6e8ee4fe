#!/usr/bin/env python3
"""Checks that includes point the way the architecture says, and that the tree is as it should be.

tools/check_layers.py               checks the repository; one line per finding, exit status 1 if there is any
tools/check_layers.py --self-test   proves on a small made-up tree that each rule reports what it forbids
"""
import os
import re
import sys
import tempfile
from pathlib import Path, PurePosixPath

# ---- The rules, as data ---------------------------------------------------------------------------------------------

ENGINE = "engine/base engine/graph engine/volume engine/gpu engine/passes engine/annotation engine/scene shaders"

# module: the modules whose files it may include, besides its own. What is not listed here may not exist.
MAY_INCLUDE = {
    "shaders": "",
    "engine/base": "",
    "engine/graph": "engine/base shaders",
    "engine/volume": "engine/base shaders",
    "haptics": "engine/base",
    "engine/gpu": "engine/graph engine/base shaders",
    "engine/passes": "engine/graph engine/volume engine/base shaders",
    "engine/annotation": "engine/volume engine/base shaders",
    "engine/scene": ENGINE,
    "ui": f"{ENGINE} haptics",
    "tools": f"{ENGINE} haptics ui",
    "tests": f"{ENGINE} haptics ui tools",
}

# third party: pattern of its headers, pattern of the files that may include them
THIRD_PARTIES = {
    "Vulkan": (r"vulkan/", r"engine/gpu/|ui/window\.cpp"),
    "hidapi": (r"hidapi", r"haptics/hid_device\.cpp"),
    "GLFW": (r"GLFW/", r"ui/"),
    "Dear ImGui": (r"(backends/|imgui/)?imgui", r"ui/"),
    # 25,000 lines that every reader of a header would compile; json_fwd.hpp is small.
    "nlohmann/json": (r"nlohmann/(?!json_fwd\.hpp)", r".*\.cpp|tools/|tests/"),
    "GDCM": (r"gdcm", r"engine/volume/dicom_file\.cpp|tests/unit/source_dicom_test\.cpp"),
    "zlib": (r"zlib\.h", r"engine/volume/.*\.cpp|tests/"),
    "blosc": (r"blosc", r"engine/volume/zarr_codec\.cpp"),
    "libtiff": (r"tiff(io)?\.h", r"engine/volume/.*tiff.*\.cpp|tests/unit/tiff_files\.h"),
    "pugixml": (r"pugixml", r"engine/volume/.*\.cpp|engine/annotation/trace_.*\.cpp"),
    "xxHash": (r"xxhash", r"engine/volume/|engine/annotation/journal_file\.cpp"),
    "CLI11": (r"CLI/", r"tools/cli/"),
    "doctest": (r"doctest", r"tests/"),
}

TOP_LEVEL_FILES = {"CMakeLists.txt", "CMakePresets.json", "DECISIONS.md", "LICENSE", "README.md"}
TOP_LEVEL_FOLDERS = {"assets", "engine", "haptics", "shaders", "tests", "tools", "ui"}

INCLUDING = {".h", ".cpp", ".comp", ".glsl"}
SOURCES = INCLUDING | {".py", ".cmake"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)

# ---- The checks, each a list of findings ----------------------------------------------------------------------------


def module_of(path):
    """engine/gpu/device.h -> engine/gpu; tools/cli/main.cpp -> tools"""
    return "/".join(path.parts[:2]) if path.parts[0] == "engine" else path.parts[0]


def files_below(root):
    """Paths relative to the root, without build products and hidden folders."""
    for folder, names, files in os.walk(root):
        at_top = Path(folder) == root
        names[:] = sorted(n for n in names if not n.startswith((".", "__")) and not (at_top and n == "build"))
        for file in sorted(files):
            yield PurePosixPath((Path(folder) / file).relative_to(root).as_posix())


def read_includes(root, files):
    """file -> [(line, spelled, file of ours or None)]; findings where a quoted file is nowhere"""
    known, includes, findings = set(files), {}, []
    for file in files:
        if file.suffix not in INCLUDING:
            continue
        text = (root / file).read_text(encoding="utf-8")
        includes[file] = []
        for match in INCLUDE.finditer(text):
            line, spelled = text.count("\n", 0, match.start(2)) + 1, match[2]
            # As compilers do: first beside the including file, then from the root.
            beside = PurePosixPath(os.path.normpath(file.parent / spelled))
            target = next((path for path in (beside, PurePosixPath(spelled)) if path in known), None)
            includes[file].append((line, spelled, target))
            if match[1] == '"' and target is None:
                findings.append(f'{file}:{line}: "{spelled}" is no file of ours; third parties are included with <>')
    return includes, findings


def check_arrows(includes):
    for file, lines in includes.items():
        module = module_of(file)
        if module not in MAY_INCLUDE:
            yield f"{file}: module {module} is not in the table of tools/check_layers.py"
            continue
        allowed = [module, *MAY_INCLUDE[module].split()]
        for line, spelled, target in lines:
            if target is not None:
                if module_of(target) not in allowed:
                    yield f"{file}:{line}: {module} may not include {target}; it may use {', '.join(allowed)}"
                continue
            for name, (header, place) in THIRD_PARTIES.items():
                if re.match(header, spelled) and not re.match(place, str(file)):
                    yield f"{file}:{line}: {name} ({spelled}) may be included only in {place}"


def check_cycles(includes):
    done, path = set(), []

    def visit(file):
        if file in path:
            yield "cycle of includes: " + " -> ".join(map(str, [*path[path.index(file):], file]))
        elif file not in done:
            path.append(file)
            for _, _, target in includes.get(file, ()):
                if target is not None:
                    yield from visit(target)
            path.pop()
            done.add(file)

    for file in includes:
        yield from visit(file)


def is_source(root, file):
    if file.suffix:
        return file.suffix in SOURCES
    with open(root / file, "rb") as content:  # scripts have no suffix
        return content.read(2) == b"#!"


def check_tree(root, files):
    for entry in sorted(root.iterdir()):
        allowed = TOP_LEVEL_FOLDERS if entry.is_dir() else TOP_LEVEL_FILES
        if not entry.name.startswith(".") and entry.name not in allowed | {"build"}:
            yield f"{entry.name}: does not belong at the top level"
    for name in sorted(TOP_LEVEL_FILES):
        if not (root / name).is_file():
            yield f"{name}: is missing at the top level"
    folders = {parent for file in files if is_source(root, file) for parent in file.parents if parent.parts}
    for folder in sorted(folders):
        if len(folder.parts) <= 2 and not (root / folder / "README.md").is_file():
            yield f"{folder}: holds sources but no README.md"


def check(root):
    files = list(files_below(root))
    includes, findings = read_includes(root, files)
    return [*findings, *check_arrows(includes), *check_cycles(includes), *check_tree(root, files)]


# ---- The self-test --------------------------------------------------------------------------------------------------

# file with its content -> what the one finding must contain
FORBIDDEN = [
    ("engine/base/bad.h", '#include "engine/volume/volume.h"', "engine/base may not include engine/volume/volume.h"),
    ("engine/graph/bad.cpp", "#include <vulkan/vulkan.h>", "Vulkan (vulkan/vulkan.h) may be included only in"),
    ("engine/graph/bad.cpp", '# include "engine/gpu/device.h"', "engine/graph may not include engine/gpu/device.h"),
    ("shaders/bad.comp", '#include "../engine/base/error.h"', "shaders may not include engine/base/error.h"),
    ("haptics/bad.cpp", '\n#include "engine/volume/volume.h"', "haptics/bad.cpp:2: haptics may not include"),
    ("haptics/bad.cpp", "#include <hidapi/hidapi.h>", "hidapi"),
    ("engine/scene/bad.h", "#include <nlohmann/json.hpp>", "nlohmann/json"),
    ("engine/scene/bad.cpp", '#include "ui/window.h"', '"ui/window.h" is no file of ours'),
    ("tools/bad.cpp", "#include <CLI/CLI.hpp>", "CLI11"),
    ("engine/base/error.h", '#include "error.h"', "cycle of includes: engine/base/error.h -> engine/base/error.h"),
    ("engine/new/bad.h", "", "module engine/new is not in the table"),
    ("notes.txt", "", "notes.txt: does not belong at the top level"),
    ("scripts/README.md", "", "scripts: does not belong at the top level"),
    ("tests/cli/test_bad.py", "", "tests/cli: holds sources but no README.md"),
    ("ui/bad.cpp", "", "ui: holds sources but no README.md"),
]

ALLOWED = {
    "engine/base/error.h": "#include <string>",
    "engine/volume/volume.h": '#include "engine/base/error.h"\n#include "shaders/bricks.h"',
    "engine/gpu/device.h": "#include <vulkan/vulkan.h>",
    "engine/scene/session.cpp": '#include <nlohmann/json.hpp>\n#include "engine/gpu/device.h"',
    "shaders/bricks.h": "",
    "shaders/raycast.comp": '#include "bricks.h"',
    "tools/cli/main.cpp": "#include <CLI/CLI.hpp>",
    "build/made.cpp": '#include "nowhere.h"',
}


def self_test():
    failures = 0
    for path, content, expected in [(None, None, None), *FORBIDDEN]:
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            tree = dict.fromkeys(TOP_LEVEL_FILES, "") | ALLOWED | ({path: content} if path else {})
            for name in tree:
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(tree[name], encoding="utf-8")
            for name in ["engine", *MAY_INCLUDE, "engine/new", "tools/cli"]:
                if (root / name).is_dir() and name != "ui":  # ui is where a README is missed
                    (root / name / "README.md").touch()
            findings = check(root)
        if (expected is None and findings) or (expected and (len(findings) != 1 or expected not in findings[0])):
            print(f"self-test: {path} {content!r}: expected {expected or 'no finding'}, found {findings}")
            failures += 1
    return failures


def main():
    if sys.argv[1:] == ["--self-test"]:
        failures = self_test()
        print(f"{len(FORBIDDEN) + 1} cases, {failures} failed")
        return 1 if failures else 0
    if sys.argv[1:]:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    findings = check(Path(__file__).resolve().parent.parent)
    print("\n".join(findings) or "includes and folders are as they should be")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
