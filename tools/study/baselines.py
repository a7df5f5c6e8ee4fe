#!/usr/bin/env python3
"""Annotations that common algorithms make without a hand, scored like those of a study (README.md next to this file).

tools/study/baselines.py -o F.csv [--size 256] [--seeds 1,2,3] [--noise 10] [--methods A,B] [--shvr PROGRAM]

Each phantom section is written by `shvr phantom`, annotated by each method, and scored by `shvr evaluate`. Needs
python3-numpy, python3-scipy and python3-skimage; where one is missing, the file names it in place of results.
"""
import argparse
import csv
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
MODULES = {"numpy": "python3-numpy", "scipy": "python3-scipy", "skimage": "python3-skimage"}
KEYS = ["method", "noise", "seed", "skipped"]
OUTCOMES = ["dice_partial", "dice_full", "node_score", "nodes_out", "nodes", "internode_score", "internodes_out",
            "internodes", "segments_found", "segments_total", "topological_errors", "centreline_rms",
            "centreline_most"]


def missing():
    """The packages of Debian that this interpreter lacks."""
    return [package for module, package in MODULES.items() if importlib.util.find_spec(module) is None]


def use_debians_python():
    """Continues in Debian's own interpreter where that one has more of the packages."""
    debians = "/usr/bin/python3"
    if not missing() or os.environ.get("SHVR_BASELINES_PYTHON") or not os.path.exists(debians):
        return
    os.environ["SHVR_BASELINES_PYTHON"] = "chosen"
    os.execv(debians, [debians, *sys.argv])


def run(program, *arguments):
    """The JSON that a sub-command prints."""
    ran = subprocess.run([str(program), *map(str, arguments), "--json", "--quiet"], capture_output=True, text=True,
                         check=False)
    if ran.returncode != 0:
        sys.exit(f"baselines.py: {' '.join(map(str, arguments[:2]))}: {ran.stderr.strip()}")
    return json.loads(ran.stdout)


# ---- Volumes ---------------------------------------------------------------------------------------------------------

def read_volume(header):
    """The voxels, [z, y, x], of an NRRD with detached bytes, as `shvr phantom` writes it."""
    import numpy
    fields = dict(line.split(": ", 1) for line in Path(header).read_text().splitlines()[1:] if ": " in line)
    if (fields["type"], fields["encoding"]) != ("uint8", "raw"):
        sys.exit(f"baselines.py: {header}: is {fields['type']}, {fields['encoding']}; expected uint8, raw")
    sizes = [int(size) for size in fields["sizes"].split()]
    return numpy.fromfile(Path(header).parent / fields["data file"], numpy.uint8).reshape(sizes[::-1])


def write_mask(mask, path):
    """Writes the mask as an NRRD, with 1 for what is in it."""
    depth, height, width = mask.shape
    mask.astype("uint8").tofile(path.with_suffix(".raw"))
    path.write_text(f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {width} {height} {depth}\nspacings: 1 1 1\n"
                    f'units: "voxel" "voxel" "voxel"\nencoding: raw\ndata file: {path.stem}.raw\n')


# ---- Skeletons as traces ---------------------------------------------------------------------------------------------

EVERY = 4      # voxels between nodes along a chain
PRUNED = 8     # voxels: shorter chains with a free end are bumps of the surface, not branches


def neighbours_of(voxel, known):
    """The voxels of `known` that share a face, an edge or a corner with one."""
    z, y, x = voxel
    around = ((z + dz, y + dy, x + dx) for dz in (-1, 0, 1) for dy in (-1, 0, 1) for dx in (-1, 0, 1))
    return [other for other in around if other != voxel and other in known]


def clusters_of(voxels):
    """Groups of voxels that touch."""
    left, clusters = set(voxels), []
    while left:
        cluster, edge = set(), [left.pop()]
        while edge:
            voxel = edge.pop()
            cluster.add(voxel)
            near = neighbours_of(voxel, left)
            left.difference_update(near)
            edge += near
        clusters.append(sorted(cluster))
    return sorted(clusters)


def in_order(chain):
    """The voxels of a chain from one end to the other; of a closed one from any."""
    known = set(chain)
    at = next((voxel for voxel in chain if len(neighbours_of(voxel, known)) < 2), chain[0])
    order, left = [at], known - {at}
    while near := sorted(neighbours_of(at, left)):
        at = near[0]
        order.append(at)
        left.discard(at)
    return order


def graph_of(skeleton, radii):
    """(nodes [(x, y, z, radius)], edges [(a, b)]) of a skeleton: a node at each meeting of branches, and one every few
    voxels between them."""
    voxels = {tuple(int(i) for i in at) for at in zip(*skeleton.nonzero())}
    joints = clusters_of(voxel for voxel in voxels if len(neighbours_of(voxel, voxels)) > 2)
    of_joint = {voxel: i for i, cluster in enumerate(joints) for voxel in cluster}
    nodes, edges = [], []

    def add(cluster):
        z, y, x = (sum(axis) / len(cluster) + 0.5 for axis in zip(*cluster))
        nodes.append((x, y, z, max(sum(float(radii[voxel]) for voxel in cluster) / len(cluster), 0.5)))
        return len(nodes) - 1
    numbers = [add(cluster) for cluster in joints]
    for chain in clusters_of(voxels - set(of_joint)):
        order = in_order(chain)
        ends = []
        for voxel in (order[0], order[-1]):
            met = sorted({of_joint[near] for near in neighbours_of(voxel, of_joint)})
            ends.append([numbers[joint] for joint in met])
        if len(order) == 1:  # between two joints, or at one
            ends = [ends[0][:1], ends[0][1:2]]
        if len(order) < PRUNED and not (ends[0] and ends[1]):
            continue
        middle = order[EVERY // 2::EVERY] if ends[0] and ends[1] else order[::EVERY]
        if not ends[1] and middle[-1] != order[-1]:
            middle.append(order[-1])
        path = ends[0][:1] + [add([voxel]) for voxel in middle] + ends[1][:1]
        edges += [(a, b) for a, b in zip(path, path[1:]) if a != b]
    used = sorted({node for edge in edges for node in edge})
    new = {old: i for i, old in enumerate(used)}
    return [nodes[old] for old in used], sorted({tuple(sorted((new[a], new[b]))) for a, b in edges})


def write_trace(nodes, edges, size, path):
    """Writes GraphML with the keys of SHVR's own (engine/annotation/trace/README.md)."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', '<graphml xmlns="http://graphml.graphdrawing.org/xmlns">']
    lines += [f'<key id="{key}" for="node" attr.name="{key}" attr.type="double" />' for key in ("x", "y", "z", "radius")]
    lines += [f'<key id="{key}" for="graph" attr.name="{key}" attr.type="string" />'
              for key in ("space", "unit", "size", "spacing")]
    lines.append('<graph id="trace" edgedefault="undirected"><data key="space">volume</data><data key="unit">voxel</data>'
                 f'<data key="size">{size[0]} {size[1]} {size[2]}</data><data key="spacing">1 1 1</data>')
    for i, (x, y, z, radius) in enumerate(nodes):
        lines.append(f'<node id="n{i}"><data key="x">{x}</data><data key="y">{y}</data><data key="z">{z}</data>'
                     f'<data key="radius">{radius}</data></node>')
    lines += [f'<edge id="e{i}" source="n{a}" target="n{b}" />' for i, (a, b) in enumerate(edges)]
    path.write_text("\n".join([*lines, "</graph>", "</graphml>", ""]))


# ---- Methods ---------------------------------------------------------------------------------------------------------

SIGMAS = (2.0, 3.0, 4.0, 5.0)  # voxels; the veins of a section with a side of 256 have radii of 3 to 6


def smoothed(volume):
    from scipy import ndimage
    return ndimage.gaussian_filter(volume.astype("float32"), 1.0)


def above_otsu(values, classes=2):
    """At or above the highest of Otsu's thresholds. A section has four classes: air, ground
    tissue, receptacle and florets, veins."""
    from skimage.filters import threshold_multiotsu
    return values >= threshold_multiotsu(values, classes)[-1]


def largest_component(volume, _):
    """Otsu's threshold of veins in the smoothed volume; its largest component over faces. No trace."""
    import numpy
    from scipy import ndimage
    labels, count = ndimage.label(above_otsu(smoothed(volume), 4))
    if count == 0:
        return labels > 0, None
    return labels == 1 + numpy.bincount(labels.ravel())[1:].argmax(), None


def flood(volume, seed):
    """Everything joined over faces, at or above the same threshold, to a point clicked on an adaxial vein. No trace."""
    from scipy import ndimage
    labels, _ = ndimage.label(above_otsu(smoothed(volume), 4))
    label = labels[seed]
    return (labels == label) & (label > 0), None


def skeleton_of(response):
    """Otsu's threshold of a filter's response; its skeleton as a trace."""
    from scipy import ndimage
    from skimage.morphology import remove_small_objects, skeletonize_3d
    mask = remove_small_objects(above_otsu(response), 64)
    return mask, graph_of(skeletonize_3d(mask) > 0, ndimage.distance_transform_edt(mask))


def scaled(volume):
    return [sigma * volume.shape[0] / 256 for sigma in SIGMAS]


def frangi(volume, _):
    """Frangi's vesselness (1998) at the veins' sizes."""
    from skimage.filters import frangi as filtered
    return skeleton_of(filtered(volume.astype("float32"), sigmas=scaled(volume), black_ridges=False))


def sato(volume, _):
    """Sato's tubeness (1998) at the veins' sizes."""
    from skimage.filters import sato as filtered
    return skeleton_of(filtered(volume.astype("float32"), sigmas=scaled(volume), black_ridges=False))


METHODS = {"threshold_largest": largest_component, "frangi_skeleton": frangi, "sato_skeleton": sato, "flood": flood}


# ---- Scores ----------------------------------------------------------------------------------------------------------

def click_on(volume, partial, group):
    """The brightest voxel of the partial truth's adaxial veins: where a person would click."""
    import numpy
    inside = numpy.where(partial == group, volume.astype("int32"), -1)
    return numpy.unravel_index(int(inside.argmax()), inside.shape)


def scores(shvr, phantom, mask, trace):
    """The outcomes of a row; without a trace those of painting alone."""
    traced = ["--truth-trace", phantom["truth_trace"], "--trace", trace] if trace else []
    partial = run(shvr, "evaluate", "--truth-mask", phantom["truth_partial_mask"], "--mask", mask)
    full = run(shvr, "evaluate", "--truth-mask", phantom["truth_mask"], "--mask", mask, *traced)
    row = {"dice_partial": partial["dice"], "dice_full": full["dice"]}
    if trace:
        row |= {"node_score": full["node_score"], "nodes_out": full["node_out"][0], "nodes": full["node_out"][1],
                "internode_score": full["internode_score"], "internodes_out": full["internode_out"][0],
                "internodes": full["internode_out"][1], "segments_found": full["segments"][0],
                "segments_total": full["segments"][1], "topological_errors": full["topological_errors"],
                "centreline_rms": full["centreline_rms"], "centreline_most": full.get("centreline_most")}
    return {key: value for key, value in row.items() if value is not None}


def row_of(shvr, method, phantom, folder):
    volume, partial = read_volume(phantom["volume"]), read_volume(phantom["truth_partial_mask"])
    mask, graph = METHODS[method](volume, click_on(volume, partial, phantom["sections"]["adaxial"]))
    write_mask(mask, folder / "mask.nhdr")
    if graph is None:
        return scores(shvr, phantom, folder / "mask.nhdr", None)
    if not graph[1]:
        return {"skipped": "the skeleton has no branch"}
    write_trace(*graph, volume.shape[::-1], folder / "trace.graphml")
    return scores(shvr, phantom, folder / "mask.nhdr", folder / "trace.graphml")


def rows_of(options):
    lacking = missing()
    if lacking:
        for method in options.methods:
            yield {"method": method, "skipped": f"needs {', '.join(lacking)}, not installed"}
        return
    for noise in options.noise:
        for seed in options.seeds:
            with tempfile.TemporaryDirectory() as name:
                folder = Path(name)
                phantom = run(options.shvr, "phantom", "section", "--size", options.size, "--seed", seed, "--noise",
                              noise, "-o", folder)
                for method in options.methods:
                    yield {"method": method, "noise": noise, "seed": seed,
                           **row_of(options.shvr, method, phantom, folder)}


def listed(of):
    return lambda text: [of(word) for word in text.split(",")]


def method(word):
    if word not in METHODS:
        raise argparse.ArgumentTypeError(f"{word} is not one of {', '.join(METHODS)}")
    return word


def main():
    use_debians_python()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True, help="CSV file to write")
    parser.add_argument("--shvr", type=Path, default=os.environ.get("SHVR", ROOT / "build/release/shvr"))
    parser.add_argument("--size", type=int, default=256, help="voxels a side, as of the standard study")
    parser.add_argument("--seeds", type=listed(int), default=[1, 2, 3])
    parser.add_argument("--noise", type=listed(float), default=[10.0], help="percent, as of `shvr phantom`")
    parser.add_argument("--methods", type=listed(method), default=list(METHODS), help=", ".join(METHODS))
    options = parser.parse_args()
    options.output.parent.mkdir(parents=True, exist_ok=True)
    partial = options.output.with_name(options.output.name + ".part")
    try:
        with partial.open("w", newline="") as file:
            writer = csv.DictWriter(file, KEYS + OUTCOMES, restval="", lineterminator="\n")
            writer.writeheader()
            for row in rows_of(options):
                writer.writerow(row)
                print(f"{row['method']}: {row.get('skipped') or row['dice_partial']}", file=sys.stderr)
        partial.replace(options.output)
    finally:
        partial.unlink(missing_ok=True)


if __name__ == "__main__":
    main()
