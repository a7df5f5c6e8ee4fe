#!/usr/bin/python3
"""Operations on groups by scipy, scikit-image and VTK, to compare SHVR with. Prints one JSON line.

tools/peers/editor.py run NAME SIDE MASK VOLUME OUT    carries out one operation of PEERS on files of bytes, and times it
tools/peers/editor.py prepare FOLDER SIDE              writes the masks of `prepare` from the phantom in that folder
tools/peers/editor.py differ A B                       counts the bytes that differ

Needs Debian's python3-scipy, python3-skimage and python3-vtk9. Arrays are [z, y, x]; only the operation itself is timed.
"""
import json
import sys
import time
from pathlib import Path

import numpy
from scipy import ndimage

GROUP = 1


def ball(radius):
    axis = numpy.arange(-radius, radius + 1)
    z, y, x = numpy.meshgrid(axis, axis, axis, indexing="ij")
    return x * x + y * y + z * z <= radius * radius


def merged(mask, wanted):
    """The mask where the group has the wanted voxels, and loses all others."""
    mask[mask == GROUP] = 0
    mask[wanted] = GROUP
    return mask


# ---- Operations ------------------------------------------------------------------------------------------------------

def numpy_threshold(mask, volume):
    mask[volume >= 120] = GROUP
    return mask


def numpy_combine(mask, _):
    mask[mask == 2] = GROUP
    return mask


def thin(mask):
    """A distance that leaves something of the bundles."""
    return 2 if mask.shape[0] >= 256 else 1


def grown(group, distance):
    if not group.any():
        return group  # scipy would measure from a corner of the array
    return ndimage.distance_transform_edt(~group) <= distance


def shrunk(group, distance):
    return ndimage.distance_transform_edt(group) > distance


def scipy_distances_grow(mask, _):
    return merged(mask, grown(mask == GROUP, 3))


def scipy_ball_grow(mask, _):
    return merged(mask, ndimage.binary_dilation(mask == GROUP, ball(3)))


def scipy_distances_shrink(mask, _):
    return merged(mask, shrunk(mask == GROUP, thin(mask)))


def scipy_ball_shrink(mask, _):
    return merged(mask, ndimage.binary_erosion(mask == GROUP, ball(thin(mask)), border_value=1))


def scipy_distances_open(mask, _):
    return merged(mask, grown(shrunk(mask == GROUP, thin(mask)), thin(mask)))


def scipy_distances_close(mask, _):
    return merged(mask, shrunk(grown(mask == GROUP, 3), 3))


def scipy_distances_hollow(mask, _):
    group = mask == GROUP
    return merged(mask, group & ~shrunk(group, thin(mask)))


def scipy_median(mask, _):
    return ndimage.median_filter(mask, footprint=ball(3), mode="constant")


def skimage_majority(mask, _):
    from skimage.filters import rank
    return rank.majority(mask, ball(3))


def scipy_gaussian(mask, _):
    weights = ndimage.gaussian_filter((mask == GROUP).astype(numpy.float32), 1.5, mode="constant", truncate=2)
    return merged(mask, weights > 0.5)


def scipy_fill_holes(mask, _):
    return merged(mask, ndimage.binary_fill_holes(mask == GROUP))


def scipy_label_holes(mask, _):
    """Whatever part of the outside does not touch the border."""
    labels, count = ndimage.label(mask != GROUP)
    is_open = numpy.zeros(count + 1, bool)
    for axis in range(3):
        for side in (0, -1):
            is_open[labels.take(side, axis)] = True
    is_open[0] = False
    return merged(mask, ~is_open[labels])


def scipy_largest(mask, _):
    labels, _ = ndimage.label(mask == GROUP)
    sizes = numpy.bincount(labels.ravel())
    sizes[0] = 0
    return merged(mask, labels == sizes.argmax())


def skimage_largest(mask, _):
    from skimage import measure
    labels = measure.label(mask == GROUP, connectivity=1)
    sizes = numpy.bincount(labels.ravel())
    sizes[0] = 0
    return merged(mask, labels == sizes.argmax())


def scipy_slices(mask, _):
    """Signed distances in the painted slices, weighted linearly between them."""
    def signed(group):
        wide = numpy.pad(group, 1)
        return (ndimage.distance_transform_edt(~wide) - ndimage.distance_transform_edt(wide))[1:-1, 1:-1]
    painted = numpy.flatnonzero((mask == GROUP).any((1, 2)))
    below = None
    for lower, upper in zip(painted, painted[1:]):
        below = signed(mask[lower] == GROUP) if below is None else below
        above = signed(mask[upper] == GROUP)
        for z in range(lower + 1, upper):
            mask[z][below * (upper - z) + above * (z - lower) <= 0] = GROUP
        below = above
    return mask


def skimage_watershed(mask, volume):
    from skimage.segmentation import watershed
    volume[mask != 0] = 0  # seeds cost nothing, as in SHVR
    return watershed(volume, mask, connectivity=1).astype(numpy.uint8)


def skimage_polygon(mask, _):
    from skimage.draw import polygon2mask
    side = mask.shape[0]
    corners = numpy.array([(0.21, 0.13), (0.32, 0.87), (0.83, 0.44)]) * side - 0.5  # z, x
    mask[numpy.broadcast_to(polygon2mask((side, side), corners)[:, None, :], mask.shape)] = 0
    return mask


def skimage_skeleton(mask, _):
    from skimage.morphology import skeletonize
    return (skeletonize(mask == GROUP) > 0).astype(numpy.uint8)


def vtk_surfaces(mask, _):
    """Surfaces of all groups by flying edges, smoothed by a windowed sinc."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk
    image = vtk.vtkImageData()
    image.SetDimensions(*mask.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(mask.ravel()))
    edges = vtk.vtkDiscreteFlyingEdges3D()
    edges.SetInputData(image)
    groups = [int(group) for group in numpy.unique(mask) if group]
    edges.SetNumberOfContours(len(groups))
    for index, group in enumerate(groups):
        edges.SetValue(index, group)
    smooth = vtk.vtkWindowedSincPolyDataFilter()
    smooth.SetInputConnection(edges.GetOutputPort())
    smooth.SetNumberOfIterations(20)
    smooth.Update()
    return {"triangles": smooth.GetOutput().GetNumberOfPolys()}


PEERS = {function.__name__: function for function in (
    numpy_threshold, numpy_combine, scipy_distances_grow, scipy_ball_grow, scipy_distances_shrink, scipy_ball_shrink,
    scipy_distances_open, scipy_distances_close, scipy_distances_hollow, scipy_median, skimage_majority, scipy_gaussian,
    scipy_fill_holes, scipy_label_holes, scipy_largest, skimage_largest, scipy_slices, skimage_watershed,
    skimage_polygon, skimage_skeleton, vtk_surfaces)}

# ---- Commands --------------------------------------------------------------------------------------------------------


def memory(line):
    """A line of /proc/self/status, in bytes."""
    status = Path("/proc/self/status").read_text()
    return 1024 * int(status.split(line, 1)[1].split()[0])


def voxels(path, side):
    return numpy.fromfile(path, numpy.uint8).reshape((side,) * 3)


def run(name, side, mask, volume, out):
    operation = PEERS[name]
    small = numpy.zeros((16, 16, 16), numpy.uint8)
    small[6:9, 6:9, 6:9] = GROUP
    operation(small.copy(), small)  # imports
    mask, volume = voxels(mask, side), voxels(volume, side)
    Path("/proc/self/clear_refs").write_text("5")  # the peak begins here
    held, cpu, begin = memory("VmRSS:"), time.process_time(), time.perf_counter()
    result = operation(mask, volume)
    cost = {"seconds": time.perf_counter() - begin, "cpu_seconds": time.process_time() - cpu,
            "peak_bytes": memory("VmHWM:") - held}
    if isinstance(result, dict):
        cost.update(result)
    else:
        result.tofile(out)
        if name == "skimage_skeleton":
            cost["parts"] = int(ndimage.label(result, numpy.ones((3, 3, 3)))[1])
    print(json.dumps(cost))


def prepare(folder, side):
    """bundles (group 1), both (with a tissue as group 2), and what operations need: slices, holes, specks, seeds."""
    folder, random = Path(folder), numpy.random.default_rng(1)
    bundles = voxels(folder / "stem-mask.raw", side)
    bundles[bundles != 0] = GROUP
    bundles.tofile(folder / "bundles.raw")
    both = bundles.copy()
    both[(voxels(folder / "stem-tissue-mask.raw", side) != 0) & (both == 0)] = 2
    both.tofile(folder / "both.raw")
    slices = bundles.copy()
    slices[numpy.arange(side) % 8 != 0] = 0
    slices.tofile(folder / "slices.raw")
    holes = bundles.copy()
    holes[random.random(holes.shape, numpy.float32) < 0.01] = 0
    holes.tofile(folder / "holes.raw")
    specks = bundles.copy()
    specks[random.random(specks.shape, numpy.float32) < 0.0005] = GROUP
    specks.tofile(folder / "specks.raw")
    seeds = slices.copy()
    seeds[::8][(both[::8] == 2)] = 2
    seeds.tofile(folder / "seeds.raw")
    print(json.dumps({"painted": int(numpy.count_nonzero(bundles))}))


def main():
    command, *rest = sys.argv[1:]
    if command == "run":
        run(rest[0], int(rest[1]), *rest[2:])
    elif command == "prepare":
        prepare(rest[0], int(rest[1]))
    else:
        a, b = (numpy.fromfile(path, numpy.uint8) for path in rest)
        print(json.dumps({"differ": int(numpy.count_nonzero(a != b))}))


if __name__ == "__main__":
    main()
