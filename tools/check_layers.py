#!/usr/bin/env python3
"""Checks that includes point the way the architecture says, that the tree is as it should be, that no phantom uses a
mathematical function whose last bit depends on the processor, and that wrapped functions are called by their wrappers.

tools/check_layers.py               checks the repository; one line per finding, exit status 1 if there is any
tools/check_layers.py --self-test   proves on a small made-up tree that each rule reports what it forbids
"""
import os
import re
import sys
import tempfile
from pathlib import Path, PurePosixPath

# ---- The rules, as data ---------------------------------------------------------------------------------------------

# Each room (folder), and the other rooms whose files it may include. The table lists exactly the dependencies in use:
# adding one is a decision, made here. A file belongs to the room with the longest path that is a prefix of the file's
# path; a file without a room is an error. From the ground up:
MAY_INCLUDE = {
    "shaders": "",
    "engine/base": "",
    "engine/touch": "engine/base",
    "engine/volume": "engine/base shaders",
    "engine/graph": "engine/base",
    "engine/gpu": "engine/base engine/graph",
    "engine/passes": "engine/graph shaders",
    "engine/look": "engine/base engine/volume shaders",
    "engine/components": "engine/base engine/volume shaders",
    "engine/annotation": "engine/base engine/volume shaders",
    "engine/remote": "engine/base",
    "engine/formats": "engine/base engine/volume engine/remote",
    "engine/formats/raw": "engine/base engine/volume engine/formats",
    "engine/formats/slices": "engine/base engine/volume engine/formats",
    "engine/formats/tiff": "engine/base engine/volume engine/formats engine/formats/slices",
    "engine/formats/dicom": "engine/base engine/formats",
    "engine/formats/meshes": "engine/base engine/volume",
    "engine/formats/zip": "engine/base",
    "engine/formats/zarr": "engine/base engine/volume engine/remote engine/formats engine/formats/zip shaders",
    "engine/formats/headers": "engine/base engine/volume engine/formats engine/formats/raw",
    "engine/formats/export": "engine/base engine/volume engine/formats",
    "engine/bricks": "engine/base engine/volume engine/look shaders",
    "engine/projects": "engine/base engine/pieces engine/volume engine/remote engine/formats engine/formats/zarr shaders",
    "engine/annotation/trace": "engine/base engine/volume engine/annotation",
    "engine/annotation/measures": "engine/base engine/volume engine/annotation engine/annotation/trace",
    "engine/annotation/patterns": "engine/base engine/volume engine/annotation/trace engine/annotation/measures",
    "engine/annotation/files": "engine/base engine/volume engine/annotation engine/annotation/trace engine/formats "
    "engine/formats/export engine/formats/tiff engine/formats/zarr engine/projects shaders",
    "engine/annotation/sets": "engine/base engine/components engine/annotation",
    "engine/annotation/meshes": "engine/base engine/annotation",
    "engine/annotation/operations": "engine/base engine/volume engine/annotation engine/annotation/trace "
    "engine/annotation/sets",
    "engine/annotation/script": "engine/base engine/annotation engine/annotation/trace engine/annotation/operations "
    "engine/session",
    "engine/annotation/writers": "engine/base",
    "engine/annotation/work": "engine/base engine/volume engine/annotation engine/annotation/files "
    "engine/annotation/trace engine/annotation/writers engine/projects",
    "engine/session": "engine/base engine/touch engine/volume engine/look engine/annotation engine/annotation/files "
    "engine/annotation/measures engine/annotation/trace engine/remote engine/formats engine/formats/zarr engine/projects",
    "engine/movie": "engine/base engine/look engine/session engine/tasks",
    "engine/session/looks": "engine/base engine/session",
    "engine/session/meshes": "engine/base engine/volume engine/look engine/annotation/trace engine/formats/meshes engine/session",
    "engine/session/words": "engine/base engine/annotation engine/session",
    "engine/jobs": "engine/base",
    "engine/pages": "engine/base",
    "engine/pieces": "engine/base",
    "engine/ranks": "engine/base",
    "engine/ranks/alone": "engine/base engine/ranks",
    "engine/ranks/mpi": "engine/base engine/ranks",
    "engine/tasks": "engine/base engine/pieces engine/volume engine/remote engine/look engine/components engine/formats/export engine/formats/meshes engine/annotation "
    "engine/annotation/trace engine/annotation/measures engine/annotation/patterns engine/annotation/meshes "
    "engine/annotation/files engine/annotation/writers engine/projects engine/session engine/jobs",
    "engine/device": "engine/base engine/volume engine/gpu engine/passes engine/look engine/bricks engine/annotation "
    "engine/annotation/trace engine/annotation/work shaders",
    "engine/picture": "engine/base engine/volume engine/passes engine/look engine/annotation/work engine/session engine/device",
    "engine/live": "engine/base engine/touch engine/volume engine/passes engine/look engine/annotation engine/annotation/trace "
    "engine/annotation/work engine/session engine/session/words engine/picture shaders",
    "haptics": "engine/base engine/touch",
    "haptics/hid": "engine/base haptics",
    "haptics/inverse3": "engine/base haptics",
    "haptics/openhaptics": "engine/base haptics",
    "haptics/devices": "engine/base haptics haptics/hid haptics/inverse3 haptics/openhaptics",
    "engine/study": "engine/base engine/touch engine/volume engine/annotation engine/annotation/trace "
    "engine/annotation/measures engine/annotation/files engine/annotation/work engine/live haptics",
    "engine/study/report": "engine/base engine/pages engine/study",
    "engine/workbench/appearance": "engine/base",
    "engine/workbench/curves": "engine/look engine/session",
    "engine/workbench/touch": "engine/base engine/look engine/annotation/trace engine/annotation/work engine/session "
    "engine/live haptics haptics/devices",
    "engine/workbench/models": "engine/base engine/remote engine/volume engine/annotation engine/annotation/work engine/session "
    "engine/session/looks engine/tasks "
    "engine/jobs engine/live haptics haptics/devices engine/workbench/appearance engine/workbench/touch",
    "engine/workbench/actions": "engine/base engine/remote engine/annotation/operations engine/annotation/script engine/session engine/tasks engine/workbench/models",
    "engine/workbench/lists": "engine/base engine/volume engine/look engine/annotation/trace engine/session engine/live "
    "engine/workbench/models engine/workbench/actions",
    "engine/workbench/forms": "engine/base engine/remote engine/volume engine/session/looks engine/movie engine/tasks engine/workbench/models engine/workbench/actions "
    "engine/workbench/sight",
    "engine/workbench/sight": "engine/base engine/volume engine/look engine/annotation/operations engine/annotation/trace engine/session engine/session/words engine/workbench/models "
    "engine/workbench/actions engine/workbench/lists",
    "engine/workbench/edits": "engine/session haptics engine/workbench/touch engine/workbench/models "
    "engine/workbench/actions",
    "engine/workbench/bindings": "engine/base engine/remote engine/session engine/session/words engine/workbench/models engine/workbench/actions "
    "engine/workbench/sight engine/workbench/edits engine/workbench/appearance",
    "engine/workbench/words": "engine/base engine/annotation/trace engine/annotation/work engine/session engine/session/words engine/tasks "
    "engine/workbench/models engine/workbench/bindings engine/workbench/forms",
    "engine/workbench/document": "engine/base engine/remote engine/annotation/trace engine/annotation/work engine/session engine/session/words engine/jobs "
    "engine/movie engine/picture engine/live haptics engine/workbench/touch engine/workbench/models engine/workbench/actions "
    "engine/workbench/sight",
    "engine/workbench/desk": "engine/base engine/session engine/session/looks engine/jobs engine/workbench/touch engine/workbench/models "
    "engine/workbench/actions engine/workbench/lists engine/workbench/sight engine/workbench/bindings "
    "engine/workbench/document",
    "engine/workbench/services": "engine/base engine/remote engine/look engine/movie engine/annotation/operations engine/annotation/work "
    "engine/session engine/session/meshes engine/session/looks engine/session/words engine/tasks engine/live "
    "engine/workbench/models engine/workbench/actions engine/workbench/lists engine/workbench/sight engine/workbench/edits "
    "engine/workbench/words engine/workbench/document engine/workbench/desk",
    "engine/workbench": "engine/base engine/workbench/actions engine/workbench/lists engine/workbench/desk "
    "engine/workbench/services",
    "ui/files": "engine/base engine/remote engine/formats",
    "ui/thumbnails": "engine/base engine/workbench/models ui/files",
    "ui/panels/tools": "engine/workbench/models engine/workbench/actions engine/workbench/sight",
    "ui/panels/signs": "engine/workbench/appearance engine/workbench/bindings",
    "ui/panels": "ui/thumbnails ui/panels/signs ui/panels/tools engine/base engine/session engine/session/words engine/workbench/appearance engine/workbench/curves engine/workbench/models "
    "engine/workbench/actions engine/workbench/lists engine/workbench/sight engine/workbench/edits "
    "engine/workbench/bindings",
    "ui/panels/look": "engine/base engine/session engine/workbench/curves engine/workbench/models "
    "engine/workbench/actions engine/workbench/edits engine/workbench/bindings ui/panels ui/panels/dialogs",
    "ui/panels/start": "engine/base engine/remote engine/workbench/models engine/workbench/bindings ui/files ui/thumbnails ui/panels",
    "ui/panels/banners": "engine/base engine/workbench/models engine/workbench/actions engine/workbench/forms ui/panels",
    "ui/panels/dialogs": "engine/base engine/session engine/session/words engine/workbench/models engine/workbench/actions "
    "engine/workbench/lists engine/workbench/forms engine/tasks ui/files ui/thumbnails ui/panels ui/panels/tools",
    "ui/panels/touch": "engine/workbench/models engine/workbench/lists engine/workbench/edits engine/workbench/bindings "
    "engine/workbench/words ui/panels",
    "ui": "engine/base engine/gpu engine/live haptics engine/workbench engine/workbench/models engine/workbench/sight "
    "engine/workbench/edits engine/workbench/bindings ui/files ui/thumbnails ui/panels ui/panels/tools",
    "tests": "*",
    "tests/reference": "engine/annotation engine/annotation/operations engine/annotation/trace",
    "tools/report": "engine/base engine/pages",
    "tools/bench": "engine/base engine/annotation engine/bricks engine/components engine/pages engine/projects engine/session "
    "tests/reference tools/golden tools/report",
    "tools/golden": "engine/base engine/annotation/script engine/session engine/live engine/pages shaders",
    "tools": "engine/base engine/remote engine/pages engine/pieces engine/ranks engine/volume engine/graph engine/gpu engine/projects engine/annotation/script engine/annotation/trace "
    "engine/annotation/work engine/annotation/writers engine/session engine/session/looks engine/session/meshes engine/jobs engine/tasks engine/movie engine/picture engine/live "
    "haptics haptics/devices haptics/hid ui engine/study engine/study/report engine/workbench "
    "engine/workbench/touch engine/workbench/actions engine/workbench/lists engine/workbench/sight "
    "tools/golden tools/bench tools/report",
}
# Rooms that must work without a device: none may include a room that depends on one, directly or indirectly.
WITHOUT_DEVICE = ["engine/session", "engine/movie", "engine/projects", "engine/bricks", "engine/annotation/work", "engine/tasks", "haptics",
                  "haptics/devices"]
WITH_DEVICE = {"engine/gpu", "engine/passes", "engine/device"}
MAX_SOURCES = 30  # per folder
# Folders of the product that may include each other in a cycle. There are none; adding one needs a reason here.
FOLDER_CYCLES = []
PRODUCT = {"engine", "haptics", "shaders", "ui"}

# library: pattern of its headers, pattern of the files that may include them
THIRD_PARTIES = {
    "Vulkan": (r"vulkan/", r"engine/gpu/|ui/swapchain(_frame)?\.cpp|tests/layers/"),
    "hidapi": (r"hidapi", r"haptics/hid/hid_device\.cpp|tests/vm/"),
    "GLFW": (r"GLFW/", r"ui/"),
    "Dear ImGui": (r"(backends/|imgui/)?imgui", r"ui/|tests/unit/ui/screen_text_test"),
    # json.hpp adds 25,000 lines to each file that includes it; json_fwd.hpp is small. engine/base/json.h reads JSON;
    # the other files write JSON.
    "nlohmann/json": (
        r"nlohmann/(?!json_fwd\.hpp)",
        r"engine/(base/json|graph/|pieces/|session/|tasks/|projects/|formats/(zarr|export)/|annotation/files/).*\.cpp|tools/|tests/",
    ),
    "GDCM": (r"gdcm", r"engine/formats/dicom/|tests/unit/formats/dicom/"),
    "zlib": (r"zlib\.h", r"engine/formats/|engine/base/image_tiff|tests/"),
    "blosc": (r"blosc", r"engine/formats/zarr/"),
    "libtiff": (r"tiff(io)?\.h", r"engine/formats/(tiff|export)/|tests/unit/base/image_test|tests/support/tiff_files\.h"),
    "libjpeg": (r"j(peglib|error)\.h", r"engine/formats/slices/|tests/unit/formats/slices/"),
    "pugixml": (r"pugixml", r"engine/formats/tiff/|engine/annotation/trace/"),
    "xxHash": (r"xxhash", r"engine/(volume|remote|formats/zarr|projects|annotation/work)/"),
    "libcurl": (r"curl/", r"engine/remote/"),
    "MPI": (r"mpi\.h", r"engine/ranks/mpi/"),
    "CLI11": (r"CLI/", r"tools/cli/"),
    "doctest": (r"doctest", r"tests/"),
}

# Folders whose results have equal bits on every machine. The last bits of the functions below depend on the processor,
# unlike those of square roots and rounding. engine/volume/procedural/turns.h has a sine and a cosine to use instead.
EQUAL_BITS = ["engine/volume/phantoms", "engine/volume/procedural"]
UNEQUAL_BITS = re.compile(
    r"(?<![\w.>])(?:std::|glm::|::)?((?:a?(?:sin|cos|tan)h?|atan2|sincos|exp[2m]?1?|log(?:2|10|1p)?|pow|hypot|cbrt|fma|erfc?|"
    r"[lt]gamma|radians|degrees|rotate|slerp)[fl]?)\s*\("
)

# Functions of libraries that one file alone calls: (pattern, that file, what the others call)
WRAPPED = [(re.compile(r"\bBeginPopupModal\s*\("), "ui/panels/widgets.cpp", "begin_dialog (ui/panels/widgets.h)")]

TOP_LEVEL_FILES = {"CMakeLists.txt", "CMakePresets.json", "DECISIONS.md", "LICENSE", "README.md"}
TOP_LEVEL_FOLDERS = {"assets", "engine", "haptics", "shaders", "tests", "tools", "ui"}

INCLUDING = {".h", ".cpp", ".comp", ".glsl"}
SOURCES = INCLUDING | {".py", ".cmake"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)

# ---- The checks, each a list of findings ----------------------------------------------------------------------------


def room_of(path, rooms=MAY_INCLUDE):
    """engine/formats/tiff/tiff_page.h -> engine/formats/tiff; tools/cli/main.cpp -> tools; engine/new/x.h -> engine/new"""
    for folder in path.parents:
        if str(folder) in rooms or len(folder.parts) == (2 if path.parts[0] == "engine" else 1):
            return str(folder)
    return str(path.parent)


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
            # Resolves includes as compilers do: first relative to the including file, then from the root.
            beside = PurePosixPath(os.path.normpath(file.parent / spelled))
            target = next((path for path in (beside, PurePosixPath(spelled)) if path in known), None)
            includes[file].append((line, spelled, target))
            if match[1] == '"' and target is None:
                findings.append(f'{file}:{line}: "{spelled}" is no file of ours; third parties are included with <>')
    return includes, findings


def check_arrows(includes, rooms):
    for file, lines in includes.items():
        room = room_of(file, rooms)
        if room not in rooms:
            yield f"{file}: room {room} is not in the table of tools/check_layers.py"
            continue
        allowed = [room, *rooms[room].split()]
        for line, spelled, target in lines:
            if target is not None:
                if room_of(target, rooms) not in allowed and allowed[1:] != ["*"]:
                    yield f"{file}:{line}: {room} may not include {target}; it may use {', '.join(allowed)}"
                continue
            for name, (header, place) in THIRD_PARTIES.items():
                if re.match(header, spelled) and not re.match(place, str(file)):
                    yield f"{file}:{line}: {name} ({spelled}) may be included only in {place}"


def check_equal_bits(root, files):
    for file in files:
        if str(file.parent) not in EQUAL_BITS or file.suffix not in INCLUDING:
            continue
        for number, line in enumerate((root / file).read_text(encoding="utf-8").splitlines(), 1):
            if match := UNEQUAL_BITS.search(line.split("//")[0]):
                yield f"{file}:{number}: the last bit of {match[1]} depends on the processor; use turns.h or sums and products"


def check_wrapped(root, files):
    for file in files:
        if file.suffix not in INCLUDING:
            continue
        for number, line in enumerate((root / file).read_text(encoding="utf-8").splitlines(), 1):
            for pattern, place, wrapper in WRAPPED:
                if str(file) != place and pattern.search(line.split("//")[0]):
                    yield f"{file}:{number}: call {wrapper} instead"


def check_table(includes, rooms):
    """Arrows of the table that no file uses; cycles of rooms; rooms that must not know a device but could."""
    in_use = {
        (room_of(file, rooms), room_of(target, rooms)) for file, lines in includes.items() for _, _, target in lines if target
    }
    for room, allowed in rooms.items():
        for other in allowed.split():
            if other != "*" and (room, other) not in in_use:
                yield f"tools/check_layers.py: {room} may include {other}, but does not; take it out of the table"

    def reached(room, path):
        for other in rooms.get(room, "").split():
            if other in path:
                yield f"tools/check_layers.py: rooms in a circle: {' -> '.join([*path[path.index(other):], other])}"
            else:
                yield from reached(other, [*path, other])
                if other in WITH_DEVICE and path[0] in WITHOUT_DEVICE:
                    yield f"tools/check_layers.py: {path[0]} may know no device, but {' -> '.join([*path, other])}"

    yield from sorted({finding for room in rooms for finding in reached(room, [room])})


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


def check_folder_cycles(includes, accepted):
    """Folders, the parents of including and included files, that reach each other: each such set must be accepted."""
    uses = {}
    for file, lines in includes.items():
        for _, _, target in lines:
            if target is not None and target.parent != file.parent and file.parts[0] in PRODUCT:
                uses.setdefault(str(file.parent), set()).add(str(target.parent))

    def reached(folder):
        found, pending = set(), [folder]
        while pending:
            new = uses.get(pending.pop(), set()) - found
            found |= new
            pending.extend(new)
        return found

    reach = {folder: reached(folder) for folder in uses}
    cycles = {frozenset(other for other in there if folder in reach.get(other, ())) for folder, there in reach.items()}
    for cycle in sorted(map(sorted, cycles - {frozenset()})):
        if set(cycle) not in accepted:
            yield f"folders include each other in a circle: {', '.join(cycle)}"
    for cycle in accepted:
        if frozenset(cycle) not in cycles:
            yield f"tools/check_layers.py: {', '.join(sorted(cycle))} are no such circle any more; take them out of FOLDER_CYCLES"


def is_source(root, file):
    if file.suffix:
        return file.suffix in SOURCES
    with open(root / file, "rb") as content:  # scripts have no suffix
        return content.read(2) == b"#!"


def check_tree(root, files, rooms):
    for entry in sorted(root.iterdir()):
        allowed = TOP_LEVEL_FOLDERS if entry.is_dir() else TOP_LEVEL_FILES
        if not entry.name.startswith(".") and entry.name not in allowed | {"build"}:
            yield f"{entry.name}: does not belong at the top level"
    for name in sorted(TOP_LEVEL_FILES):
        if not (root / name).is_file():
            yield f"{name}: is missing at the top level"
    folders = {parent for file in files if is_source(root, file) for parent in file.parents if parent.parts}
    for folder in sorted(folders):
        is_room = len(folder.parts) <= 2 or str(folder) in rooms
        if is_room and not str(folder).startswith("tests/unit/") and not (root / folder / "README.md").is_file():
            yield f"{folder}: holds sources but no README.md"
        sources = [file for file in files if file.parent == folder and is_source(root, file)]
        if len(sources) > MAX_SOURCES:
            yield f"{folder}: holds {len(sources)} sources; expected at most {MAX_SOURCES}: cut it along an idea"


def check(root, rooms=MAY_INCLUDE, folder_cycles=FOLDER_CYCLES):
    files = list(files_below(root))
    includes, findings = read_includes(root, files)
    return [
        *findings,
        *check_arrows(includes, rooms),
        *check_equal_bits(root, files),
        *check_wrapped(root, files),
        *check_table(includes, rooms),
        *check_cycles(includes),
        *check_folder_cycles(includes, folder_cycles),
        *check_tree(root, files, rooms),
    ]


# ---- The self-test --------------------------------------------------------------------------------------------------

# The rooms of a made-up tree.
ROOMS = {
    "shaders": "",
    "engine/base": "",
    "engine/volume": "engine/base shaders",
    "engine/formats": "engine/volume",
    "engine/formats/tiff": "engine/formats",
    "engine/gpu": "",
    "engine/session": "engine/formats/tiff",
    "haptics": "",
    "ui": "engine/gpu",
    "tests": "*",
    "tools": "",
}

ALLOWED = {
    "engine/base/error.h": "#include <string>",
    "engine/volume/volume.h": '#include "engine/base/error.h"\n#include "shaders/bricks.h"',
    "engine/volume/phantoms/stem.cpp": "double cos_of(double x); y = std::sqrt(x) + cos_of(x) + vein.exp(x);",
    "engine/formats/readers.h": '#include "engine/volume/volume.h"',
    "engine/formats/tiff/tiff.h": '#include "engine/formats/readers.h"',
    "engine/gpu/device.h": "#include <vulkan/vulkan.h>",
    "engine/session/session.cpp": '#include <nlohmann/json.hpp>\n#include "engine/formats/tiff/tiff.h"',
    "haptics/device.h": "",
    "shaders/bricks.h": "",
    "shaders/raycast.comp": '#include "bricks.h"',
    "tools/cli/main.cpp": "#include <CLI/CLI.hpp>",
    "tests/unit/test.cpp": '#include "engine/session/session.cpp"\n#include "engine/gpu/device.h"',
    "ui/panels/panel.cpp": '#include "engine/gpu/device.h"',
    "build/made.cpp": '#include "nowhere.h"',
}

# Self-test: a file with its content -> text that the only finding must contain
FORBIDDEN = [
    ("engine/base/bad.h", '#include "engine/volume/volume.h"', "engine/base may not include engine/volume/volume.h"),
    ("engine/volume/bad.cpp", "#include <vulkan/vulkan.h>", "Vulkan (vulkan/vulkan.h) may be included only in"),
    ("engine/formats/bad.cpp", '# include "tiff/tiff.h"', "engine/formats may not include engine/formats/tiff/tiff.h"),
    ("engine/formats/tiff/bad.h", '#include "engine/volume/volume.h"', "engine/formats/tiff may not include"),
    ("engine/session/bad.cpp", '#include "engine/gpu/device.h"', "engine/session may not include engine/gpu/device.h"),
    ("shaders/bad.comp", '#include "../engine/base/error.h"', "shaders may not include engine/base/error.h"),
    ("haptics/bad.cpp", '\n#include "engine/volume/volume.h"', "haptics/bad.cpp:2: haptics may not include"),
    ("haptics/bad.cpp", "#include <hidapi/hidapi.h>", "hidapi"),
    ("engine/volume/bad.h", "#include <nlohmann/json.hpp>", "nlohmann/json"),
    ("engine/volume/bad.cpp", '#include "ui/window.h"', '"ui/window.h" is no file of ours'),
    ("tools/bad.cpp", "#include <CLI/CLI.hpp>", "CLI11"),
    ("engine/volume/phantoms/bad.cpp", "// cos(x)\ny = 2 * std::cos(x);", "bad.cpp:2: the last bit of cos depends"),
    ("engine/volume/procedural/bad.h", "return expf (x);", "bad.h:1: the last bit of expf depends"),
    ("ui/panels/bad.cpp", 'if (ImGui::BeginPopupModal("x")) {', "bad.cpp:1: call begin_dialog"),
    ("engine/base/error.h", '#include "error.h"', "cycle of includes: engine/base/error.h -> engine/base/error.h"),
    ("engine/new/bad.h", "", "room engine/new is not in the table"),
    ("notes.txt", "", "notes.txt: does not belong at the top level"),
    ("scripts/README.md", "", "scripts: does not belong at the top level"),
    ("tests/cli/test_bad.py", "", "tests/cli: holds sources but no README.md"),
    ("engine/formats/tiff/tiff.h", "", "engine/formats/tiff may include engine/formats, but does not"),
]

# Self-test: a change of the table -> text that one of the findings must contain
FORBIDDEN_TABLES = [
    ({"engine/base": "engine/volume"}, "rooms in a circle: engine/base -> engine/volume -> engine/base"),
    ({"engine/volume": "engine/base shaders engine/gpu"},
     "engine/session may know no device, but engine/session -> engine/formats/tiff -> engine/formats -> engine/volume"),
]


# Self-test: sources of folders that include each other in a cycle, and these folders
FOLDERS_IN_A_CIRCLE = (
    {
        "ui/keys.h": '#include "ui/panels/panel.h"',
        "ui/panels/panel.h": '#include "ui/panels/look/light.h"',
        "ui/panels/look/light.h": '#include "ui/state.h"',
        "ui/state.h": "",
    },
    {"ui", "ui/panels", "ui/panels/look"},
)


def findings_of(tree, rooms, folder_cycles=()):
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for name, content in (dict.fromkeys(TOP_LEVEL_FILES, "") | ALLOWED | tree).items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(content, encoding="utf-8")
        for name in ["engine", *rooms, "engine/new", "tools/cli", "tests/unit", "ui/panels"]:
            if (root / name).is_dir():
                (root / name / "README.md").touch()
        return check(root, rooms, folder_cycles)


def self_test():
    failures = []
    if findings := findings_of({}, ROOMS):
        failures.append(f"the allowed tree: {findings}")
    for path, content, expected in FORBIDDEN:
        # Some of these files also close a cycle of folders, which is a separate rule.
        findings = [each for each in findings_of({path: content}, ROOMS) if not each.startswith("folders include")]
        if len(findings) != 1 or expected not in findings[0]:
            failures.append(f"{path} {content!r}: expected {expected}, found {findings}")
    for change, expected in FORBIDDEN_TABLES:
        if not any(expected in finding for finding in findings_of({}, ROOMS | change)):
            failures.append(f"{change}: expected {expected}")
    tree, circle = FOLDERS_IN_A_CIRCLE
    expected = f"folders include each other in a circle: {', '.join(sorted(circle))}"
    if (findings := findings_of(tree, ROOMS)) != [expected]:
        failures.append(f"a circle of folders: expected {expected}, found {findings}")
    if findings := findings_of(tree, ROOMS, [circle]):
        failures.append(f"an accepted circle of folders: {findings}")
    if not any("no such circle any more" in finding for finding in findings_of({}, ROOMS, [circle])):
        failures.append("an accepted circle of folders that is none is not reported")
    crowd = {f"shaders/kernel_{number}.comp": "" for number in range(MAX_SOURCES)}
    if not any("shaders: holds" in finding for finding in findings_of(crowd, ROOMS)):
        failures.append("a crowded folder is not reported")
    print("\n".join(f"self-test: {failure}" for failure in failures))
    return len(failures), len(FORBIDDEN) + len(FORBIDDEN_TABLES) + 5


def main():
    if sys.argv[1:] == ["--self-test"]:
        failures, cases = self_test()
        print(f"{cases} cases, {failures} failed")
        return 1 if failures else 0
    if sys.argv[1:]:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    findings = check(Path(__file__).resolve().parent.parent)
    print("\n".join(findings) or "includes and folders are as they should be")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
