#!/usr/bin/env python3
"""Ray-casting speed and error, against VTK where Debian's python3-vtk9 is installed (tools/peers/README.md).

tools/bench_raycast.py [--quick] [--rounds 3] [--mappers fixed gpu]

Scenes of one synthetic volume, drawn by both programs in turn with the same camera, transfer function, light and step;
those with ambient occlusion by SHVR alone, since VTK's ray casters have none. Errors are against the reference renderer, in linear light (tests/tools/README.md). Prints a table and writes
build/bench/raycast.json. The environment names the programs: SHVR and REFERENCE; without them, those of build/release.
"""
import argparse
import hashlib
import json
import math
import mmap
import os
import platform
import random
import statistics
import subprocess
import sys
import tempfile
import time
from array import array
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "build/bench"
SHVR = Path(os.environ.get("SHVR", ROOT / "build/release/shvr"))
REFERENCE = Path(os.environ.get("REFERENCE", SHVR.parent / "shvr_reference_picture"))
PEER = ROOT / "tools/peers/vtk_raycast.py"

SHVR_FRAMES = 7
PEER_FRAMES = 5
REFERENCE_PIXELS = 2000
CAMERA = "bench"

# Pairs of intensity and opacity per voxel. The background is noise around 40, at which the translucent ramp begins.
OPAQUE = [(120, 0.0), (160, 1.0), (255, 1.0)]
TRANSLUCENT = [(38.7, 0.0), (120, 0.005), (255, 0.02)]
OCCLUSION = {"strength": 0.8, "radius": 16, "rays": 32}
# Opacities, shading on or off, ambient occlusion.
SCENES = {"opaque shaded": (OPAQUE, True, None),
          "opaque occluded": (OPAQUE, True, OCCLUSION),
          "translucent shaded": (TRANSLUCENT, True, None),
          "translucent occluded": (TRANSLUCENT, True, OCCLUSION),
          "translucent unshaded": (TRANSLUCENT, False, None)}


def say(text):
    print(text, file=sys.stderr, flush=True)


def stop(sentence):
    sys.exit(f"tools/bench_raycast.py: {sentence}")


# ---- Running programs -----------------------------------------------------------------------------------------------


def run(arguments):
    """Standard output, seconds and the peak of resident memory in MiB."""
    arguments = [str(a) for a in arguments]
    with tempfile.TemporaryFile("w+") as output:
        started = time.monotonic()
        with subprocess.Popen(arguments, stdout=output) as process:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        seconds = time.monotonic() - started
        if process.returncode != 0:
            stop(f"{arguments[0]} ended with status {process.returncode}: {' '.join(arguments)}")
        output.seek(0)
        return output.read(), seconds, usage.ru_maxrss / 1024


def python_with_vtk():
    """The interpreter that has VTK: this one, or Debian's own; None where neither has."""
    for python in (sys.executable, "/usr/bin/python3"):
        if Path(python).exists() and subprocess.run([python, "-c", "import vtkmodules"], stderr=subprocess.DEVNULL,
                                                    check=False).returncode == 0:
            return python
    return None


# ---- The scenes -----------------------------------------------------------------------------------------------------


def make_volume(side):
    folder = FOLDER / f"tubes{side}"
    if not (folder / "tubes.nhdr").exists():
        say(f"making {folder}")
        run([SHVR, "phantom", "tubes", "--size", side, "--seed", 1, "-o", folder, "--quiet"])
    return folder / "tubes.nhdr"


def session_of(header, side, points, shaded, occlusion):
    centre = [0.5 * side] * 3
    offset = [1.35, -2.7, 0.95]  # at this distance, a field of view of 30 degrees covers every corner
    return {"shvr_session": 1,
            "volume": {"path": os.path.relpath(header, FOLDER)},
            "cameras": {CAMERA: {"projection": "perspective", "eye": [c + side * o for c, o in zip(centre, offset)],
                                 "target": centre, "up": [0, 0, 1], "fov_y_degrees": 30}},
            "camera": CAMERA,
            "transfer_function": {"points": [{"intensity": x, "color": "#f4e8d8", "opacity": y} for x, y in points]},
            "light": {"shaded": shaded, "ambient": 0.3, "diffuse": 0.7, "specular": 0, "direction": [0, 0, 1],
                      "gradient_fade": 0, **({"occlusion": occlusion} if occlusion else {})},
            "render": {"size": [512, 512], "step_voxels": 0.5, "background": "#000000"},
            # VTK's volume ends at the centres of its outermost voxels, so SHVR's is cut there.
            "cut": {"lower": [0.5] * 3, "upper": [side - 0.5] * 3}}


def visible_share(voxels, side, points):
    """The visible share of the volume: random positions whose trilinear intensity has any opacity."""
    lowest = max(x for (x, y), (_, above) in zip(points, points[1:]) if y == 0 and above > 0)
    place = random.Random(1)
    count = 50000
    seen = 0
    with open(voxels, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as volume:
        for _ in range(count):
            at = [place.uniform(0, side - 1.001) for _ in range(3)]
            low = [int(a) for a in at]
            value = 0.0
            for corner in range(8):
                bits = [corner >> axis & 1 for axis in range(3)]
                weight = math.prod(a - l if b else 1 - (a - l) for a, l, b in zip(at, low, bits))
                x, y, z = (l + b for l, b in zip(low, bits))
                value += weight * volume[x + side * (y + side * z)]
            seen += value > lowest
    return seen / count


# ---- Errors ---------------------------------------------------------------------------------------------------------


def read_pfm(path):
    """Width, height, and RGB rows from the bottom."""
    data = path.read_bytes()
    magic, size, scale, values = data.split(b"\n", 3)
    width, height = map(int, size.split())
    pixels = array("f", values)
    if (float(scale) < 0) != (sys.byteorder == "little"):
        pixels.byteswap()
    if magic != b"PF" or len(pixels) != 3 * width * height:
        stop(f"{path}: is no picture in linear light")
    return width, height, pixels


def reference_of(session_path, volume):
    """Reference pixels of the session: [[x, y, r, g, b, a], ...]; kept for the next time."""
    digest = hashlib.sha256()
    sources = [ROOT / "tests/tools/reference_picture.cpp", ROOT / "tools/bench/reference_scene.cpp",
               *sorted((ROOT / "tests/reference").glob("*.cpp"))]
    for path in (session_path, volume.with_suffix(".raw"), *sources):
        digest.update(path.read_bytes())
    digest.update(str(REFERENCE_PIXELS).encode())
    kept = FOLDER / f"reference-{digest.hexdigest()[:16]}.json"
    if not kept.exists():
        say(f"drawing {REFERENCE_PIXELS} pixels of {session_path.stem} with the reference renderer")
        run([REFERENCE, session_path, "--camera", CAMERA, "--pixels", REFERENCE_PIXELS, "-o", kept])
    return json.loads(kept.read_text())["pixels"]


def error_of(picture, reference):
    """Over the channels of the reference's pixels, in linear light."""
    width, height, values = read_pfm(picture)
    errors = []
    for x, y, *light, _ in reference:
        first = 3 * (x + width * (height - 1 - y))
        errors += [value - true for value, true in zip(values[first:first + 3], light)]
    return {"rmse": math.sqrt(sum(e * e for e in errors) / len(errors)), "max": max(map(abs, errors)),
            "mean": sum(errors) / len(errors)}


# ---- Rounds ---------------------------------------------------------------------------------------------------------


def round_of_shvr(session_path):
    output, _, peak_mib = run([SHVR, "profile", session_path, "--camera", CAMERA, "--frames", SHVR_FRAMES, "--json",
                               "--quiet"])
    profile = json.loads(output)
    passes = {one["name"]: one["median_ms"] for one in profile["passes"]}
    first = {}
    for one in profile["first_frame"]:
        first[one["name"]] = first.get(one["name"], 0.0) + (one["gpu_ms"] or 0.0)
    return {"frame_ms": profile["frame_median_ms"], "frame_min_ms": profile["frame_min_ms"],
            "raycast_ms": passes.get("raycast"), "first_frame_passes_ms": first, "peak_mib": peak_mib,
            "device": profile["device"], "driver": profile["driver"], "counters": profile["counters"]}


def round_of_vtk(python, mapper, session_path, picture):
    output, _, _ = run([python, PEER, session_path, "--camera", CAMERA, "--mapper", mapper, "--frames", PEER_FRAMES,
                        "-o", picture])
    lines = [json.loads(line) for line in output.splitlines() if line.startswith("{")]
    times = [line["ms"] for line in lines if "frame" in line]
    steady = times[2:]  # the first prepares, the second warms caches
    return {"frame_ms": statistics.median(steady), "frame_min_ms": min(steady), "first_frame_ms": times[0], **lines[-1]}


def draw_with_shvr(session_path, picture):
    """The wall time of a whole process, from its start to the picture on disk."""
    _, seconds, _ = run([SHVR, "render", session_path, "--camera", CAMERA, "-o", picture, "--quiet"])
    return seconds * 1e3


# ---- The report -----------------------------------------------------------------------------------------------------


def spread(values):
    return {"min": min(values), "median": statistics.median(values), "max": max(values)}


def summary_of(rounds, mapper_names):
    """Of one scene: {"shvr": {...}, "fixed": {...}}; times are medians over the rounds of medians over the frames."""
    shvr = [one["shvr"] for one in rounds]
    first = {name: statistics.median(one["first_frame_passes_ms"].get(name, 0.0) for one in shvr)
             for name in shvr[0]["first_frame_passes_ms"]}
    summary = {"shvr": {"frame_ms": spread([one["frame_ms"] for one in shvr]),
                        "raycast_ms": spread([one["raycast_ms"] for one in shvr]),
                        "first_frame_passes_ms": first,
                        "peak_mib": max(one["peak_mib"] for one in shvr),
                        "counters": shvr[0]["counters"]}}
    for name in mapper_names:
        if name not in rounds[0]:
            continue
        peers = [one[name] for one in rounds]
        ratios = spread([a["frame_ms"] / b["frame_ms"] for a, b in zip(shvr, peers)])
        frame = spread([one["frame_ms"] for one in peers])
        summary[name] = {"frame_ms": frame,
                         "first_frame_ms": spread([one["first_frame_ms"] for one in peers]),
                         "load_ms": spread([one["load_ms"] for one in peers]),
                         "peak_mib": max(one["peak_mib"] for one in peers),
                         "ratio_of_medians": summary["shvr"]["frame_ms"]["median"] / frame["median"],
                         "ratio_per_round": ratios}
    return summary


def table(rows):
    widths = [max(map(len, column)) for column in zip(*rows)]
    lines = ([cell.rjust(width) for cell, width in zip(row, widths)] for row in rows)
    return "\n".join("  ".join([row[0].ljust(widths[0]), *line[1:]]).rstrip() for row, line in zip(rows, lines))


def three(values, digits):
    return " / ".join(f"{values[key]:.{digits}f}" for key in ("min", "median", "max"))


def report(result, mapper_names):
    rows = [["ms a frame (min / median / max of rounds)", "SHVR", "ray cast alone",
             *(f"VTK {name}" for name in mapper_names), *(f"SHVR / VTK {name}" for name in mapper_names)]]
    costs = [["", "SHVR start to picture", "leap grid", "occlusion", "SHVR peak MiB",
              *(text for name in mapper_names for text in (f"VTK {name} load + first", "peak MiB"))]]
    errors = [["error in linear light (rmse, max)", "share seen", "SHVR", *(f"VTK {name}" for name in mapper_names)]]
    for name, scene in result["scenes"].items():
        shvr = scene["shvr"]
        peers = [scene.get(m) for m in mapper_names]
        rows.append([name, three(shvr["frame_ms"], 0), three(shvr["raycast_ms"], 0),
                     *(three(peer["frame_ms"], 0) if peer else "-" for peer in peers),
                     *(three(peer["ratio_per_round"], 2) if peer else "-" for peer in peers)])
        leap, occlusion = (sum(ms for one, ms in shvr["first_frame_passes_ms"].items() if one.startswith(start))
                           for start in ("leap", "occlusion"))
        costs.append([name, f"{shvr['start_to_picture_ms']:.0f}", f"{leap:.0f}", f"{occlusion:.0f}" if occlusion else "-",
                      f"{shvr['peak_mib']:.0f}",
                      *(text for peer in peers for text in
                        ((f"{peer['load_ms']['median'] + peer['first_frame_ms']['median']:.0f}",
                          f"{peer['peak_mib']:.0f}") if peer else ("-", "-")))])
        errors.append([name, f"{scene['visible_share']:.1%}",
                       *(f"{e['rmse']:.5f} {e['max']:.4f}" if (e := (one or {}).get("error")) else "-"
                         for one in (shvr, *peers))])
    return "\n\n".join(table(one) for one in (rows, costs, errors))


def processor():
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="128 voxels a side instead of 512")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--mappers", nargs="*", choices=["fixed", "gpu"], default=["fixed"],
                        help="VTK's ray casters: fixed point on the CPU, or OpenGL")
    return parser.parse_args()


def main():
    options = parse_arguments()
    if not SHVR.exists():
        stop(f"{SHVR} is missing; expected a built SHVR, as tools/build release makes it")
    python = python_with_vtk()
    mapper_names = options.mappers if python else []
    if not python:
        say("VTK for Python is missing (Debian: python3-vtk9), so SHVR is measured alone.")
    if not REFERENCE.exists():
        say(f"{REFERENCE} is missing (target shvr_reference_picture), so errors are not measured.")
    load = os.getloadavg()[0]
    if load > 1:
        say(f"The machine is busy (load {load:.1f}): trust ratios, not times.")
    side = 128 if options.quick else 512
    FOLDER.mkdir(parents=True, exist_ok=True)
    volume = make_volume(side)

    sessions, rounds = {}, {name: [] for name in SCENES}
    for name, (points, shaded, occlusion) in SCENES.items():
        sessions[name] = FOLDER / f"{name.replace(' ', '_')}_{side}.json"
        sessions[name].write_text(json.dumps(session_of(volume, side, points, shaded, occlusion), indent=1) + "\n")
    for number in range(options.rounds):
        for name, path in sessions.items():
            say(f"round {number + 1} of {options.rounds}: {name}")
            one = {"shvr": round_of_shvr(path)}
            for mapper in mapper_names if SCENES[name][2] is None else []:
                one[mapper] = round_of_vtk(python, mapper, path, path.with_suffix(f".vtk_{mapper}.pfm"))
            rounds[name].append(one)

    last = next(iter(rounds.values()))[-1]
    result = {"voxels": [side] * 3, "rounds": options.rounds, "processor": processor(), "cores": os.cpu_count(),
              "load_at_start": load, "device": last["shvr"]["device"], "driver": last["shvr"]["driver"],
              "peers": {m: {key: last[m][key] for key in ("vtk", "mapper", "renderer")} for m in mapper_names},
              "scenes": {}}
    for name, path in sessions.items():
        scene = summary_of(rounds[name], mapper_names)
        scene["visible_share"] = visible_share(volume.with_suffix(".raw"), side, SCENES[name][0])
        scene["shvr"]["start_to_picture_ms"] = draw_with_shvr(path, path.with_suffix(".shvr.pfm"))
        if REFERENCE.exists() and SCENES[name][2] is None:  # the reference has no occlusion: tests/gpu/occlusion/occlusion_test.cpp
            reference = reference_of(path, volume)
            for drawn in ("shvr", *(f"vtk_{m}" for m in mapper_names)):
                scene[drawn.removeprefix("vtk_")]["error"] = error_of(path.with_suffix(f".{drawn}.pfm"), reference)
        result["scenes"][name] = scene
    written = FOLDER / "raycast.json"
    written.write_text(json.dumps(result, indent=1) + "\n")
    print(f"\ntubes {side}^3 uint8, 512 x 512 pixels, step 0.5, {result['device']}, {options.rounds} rounds\n")
    print(report(result, mapper_names))
    print(f"\n{written}")


if __name__ == "__main__":
    main()
