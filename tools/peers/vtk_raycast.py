#!/usr/bin/python3
"""Draws a session with VTK's volume ray caster, to compare SHVR with: the same volume, camera, transfer function, light
and step. Prints one JSON line about the run, one for every frame, and one at the end.

tools/peers/vtk_raycast.py SESSION [--camera NAME] [--mapper fixed|gpu] [--frames 5] [--threads 2] [-o PICTURE.pfm]
tools/peers/vtk_raycast.py --serve SESSION   draws on request, a line of JSON each, as shvr bench asks (README.md)

Needs Debian's python3-vtk9 and, without a display, xvfb.
"""
import argparse
import ctypes
import json
import os
import resource
import sys
import time
from array import array
from pathlib import Path

# Defaults of a session (engine/session/README.md).
LIGHT = {"shaded": True, "ambient": 0.3, "diffuse": 0.7, "specular": 0.2, "shininess": 32, "direction": [0, 0, 0]}
FIXED_POINT_ONE = 32767  # VTKKW_FP_SCALE
RENDER = {"size": [512, 512], "step_voxels": 0.5, "background": "#ffffff"}


def linear_color(text):
    """"#rrggbb" to linear light: VTK has no colour curve, so its input and output are linear light. Three numbers are
    linear light already."""
    if not isinstance(text, str):
        return text
    encoded = [int(text[i:i + 2], 16) / 255 for i in (1, 3, 5)]
    return [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in encoded]


def read_header(path):
    """Fields of a detached NRRD header."""
    fields = dict(line.split(": ", 1) for line in path.read_text().splitlines() if ": " in line)
    fields.update(line.split(":=", 1) for line in path.read_text().splitlines() if ":=" in line)
    if fields.get("encoding") != "raw" or "data file" not in fields:
        sys.exit(f"{path}: expected a detached header of raw voxels")
    return fields


def open_volume(vtk, path):
    """A reader that places voxels as SHVR does: the centre of voxel i lies at (i + 0.5) * spacing."""
    fields = read_header(path)
    sizes = [int(n) for n in fields["sizes"].split()]
    spacing = [float(n) for n in fields["spacings"].split()]
    types = {"uint8": vtk.VTK_UNSIGNED_CHAR, "int8": vtk.VTK_SIGNED_CHAR, "uint16": vtk.VTK_UNSIGNED_SHORT,
             "int16": vtk.VTK_SHORT, "float": vtk.VTK_FLOAT}
    reader = vtk.vtkImageReader2()
    reader.SetFileName(str(path.parent / fields["data file"]))
    reader.SetFileDimensionality(3)
    reader.FileLowerLeftOn()  # rows stay in the order of the file
    reader.SetDataScalarType(types[fields["type"]])
    reader.SetDataExtent(0, sizes[0] - 1, 0, sizes[1] - 1, 0, sizes[2] - 1)
    reader.SetDataSpacing(spacing)
    # `padded`: number of voxels on each side that repeat the border, so that the volume extends to its outer faces.
    padded = int(fields.get("padded", 0))
    reader.SetDataOrigin([(0.5 - padded) * s for s in spacing])
    if fields.get("endian", "little") == "little":
        reader.SetDataByteOrderToLittleEndian()
    else:
        reader.SetDataByteOrderToBigEndian()
    return reader, min(spacing)


def make_mapper(vtk, kind, step, threads):
    if kind == "fixed":
        mapper = vtk.vtkFixedPointVolumeRayCastMapper()
        mapper.SetNumberOfThreads(threads)
        mapper.SetInteractiveSampleDistance(step)
        mapper.IntermixIntersectingGeometryOff()  # there is none
    else:
        mapper = vtk.vtkGPUVolumeRayCastMapper()
        mapper.SetUseJittering(0)
        mapper.SetMaxMemoryInBytes(8 << 30)
        mapper.SetMaxMemoryFraction(1.0)
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetImageSampleDistance(1.0)
    mapper.SetSampleDistance(step)
    return mapper


def make_property(vtk, points, light, unit):
    opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    opacity.ClampingOff()  # nothing outside the outermost points
    for point in points:
        opacity.AddPoint(point["intensity"], point["opacity"])
        color.AddRGBPoint(point["intensity"], *linear_color(point["color"]))
    look = vtk.vtkVolumeProperty()
    look.SetScalarOpacity(opacity)
    look.SetScalarOpacityUnitDistance(unit)
    look.SetColor(color)
    look.SetInterpolationTypeToLinear()
    look.SetShade(1 if light["shaded"] else 0)
    look.SetAmbient(light["ambient"])
    look.SetDiffuse(light["diffuse"])
    look.SetSpecular(light["specular"])
    look.SetSpecularPower(light["shininess"])
    return look


def aim(vtk, renderer, camera, direction, ambient):
    """`direction` points towards the light, in the camera's right, up and back."""
    view = renderer.GetActiveCamera()
    view.SetPosition(camera["eye"])
    view.SetFocalPoint(camera["target"])
    view.SetViewUp(camera.get("up", [0, 0, 1]))
    view.SetViewAngle(camera.get("fov_y_degrees", 30))
    if camera.get("projection") == "orthographic":
        view.ParallelProjectionOn()
        view.SetParallelScale(0.5 * camera["height"])
    light = vtk.vtkLight()
    light.SetAmbientColor(ambient)  # VTK's default is none
    light.PositionalOff()
    light.SetLightTypeToCameraLight()
    light.SetPosition(direction if any(direction) else [0.3, 0.5, 1.0])
    light.SetFocalPoint(0, 0, 0)
    renderer.AddLight(light)
    renderer.TwoSidedLightingOff()
    renderer.ResetCameraClippingRange()


def write_pfm(path, width, height, values):
    """A portable float map, with rows from the bottom as in VTK."""
    if sys.byteorder == "big":
        values.byteswap()
    path.write_bytes(f"PF\n{width} {height}\n-1.0\n".encode() + values.tobytes())


def save_fixed_point(mapper, window, background, path):
    """The mapper's own picture, of 15 bits a channel, over the background: what it drew before OpenGL showed it."""
    image = mapper.GetRayCastImage()
    (row_pixels, _), (used_x, used_y), (left, bottom) = (image.GetImageMemorySize(), image.GetImageInUseSize(),
                                                         image.GetImageOrigin())
    width, height = window.GetSize()
    address = int(image.GetImage().split("_")[1], 16)  # VTK wraps the pointer as "_00000000deadbeef_p_void"
    pixels = (ctypes.c_ushort * (4 * row_pixels * used_y)).from_address(address)
    values = array("f", list(background) * (width * height))
    for y in range(used_y):
        for x in range(used_x):
            at, to = 4 * (row_pixels * y + x), 3 * (width * (bottom + y) + left + x)
            through = 1 - pixels[at + 3] / FIXED_POINT_ONE
            for channel in range(3):
                values[to + channel] = pixels[at + channel] / FIXED_POINT_ONE + through * background[channel]
    write_pfm(path, width, height, values)


def save(vtk, window, path):
    """What the window shows, of 8 bits a channel."""
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.SetInputBufferTypeToRGB()
    grab.ReadFrontBufferOff()
    grab.ShouldRerenderOff()
    grab.Update()
    image = grab.GetOutput()
    width, height, _ = image.GetDimensions()
    write_pfm(path, width, height, array("f", (b / 255 for b in bytes(memoryview(image.GetPointData().GetScalars())))))


def say(**values):
    print(json.dumps(values), flush=True)


def renderer_name(window):
    lines = window.ReportCapabilities().splitlines()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("OpenGL renderer")), "unknown")


def import_vtk():
    """Only the modules in use: all of VTK takes a second to load, and memory."""
    import types

    try:
        from vtkmodules import (vtkCommonCore, vtkCommonDataModel, vtkIOImage, vtkRenderingCore, vtkRenderingOpenGL2,
                                vtkRenderingVolume, vtkRenderingVolumeOpenGL2)
        from vtkmodules.util import vtkConstants
    except ImportError as error:
        sys.exit(f"{sys.executable}: {error}; expected an interpreter with VTK (Debian: /usr/bin/python3, python3-vtk9)")
    parts = (vtkCommonCore, vtkCommonDataModel, vtkIOImage, vtkRenderingCore, vtkRenderingVolume, vtkRenderingOpenGL2,
             vtkRenderingVolumeOpenGL2, vtkConstants)
    return types.SimpleNamespace(**{name: value for part in parts for name, value in vars(part).items()})


class Scene:
    """A session: its volume, read once, and its pictures."""

    def __init__(self, vtk, path, camera):
        self.vtk, self.session = vtk, json.loads(Path(path).read_text())
        if "path" not in self.session["volume"] or self.session.get("annotation"):
            sys.exit(f"{path}: expected a volume in a file, and no mask")
        self.camera = self.session["cameras"][camera]
        self.light = {**LIGHT, **self.session.get("light", {})}
        self.settings = {**RENDER, **self.session.get("render", {})}
        self.points = self.session["transfer_function"]["points"]
        self.reader, self.unit = open_volume(vtk, Path(path).parent / self.session["volume"]["path"])
        self.reader.Update()

    def planes(self):
        """The session's cut, in voxels, as planes that face inwards."""
        planes, cut = self.vtk.vtkPlaneCollection(), self.session.get("cut")
        spacing = self.reader.GetDataSpacing()
        for side, sign in (("lower", 1), ("upper", -1)):
            for axis in range(3 if cut else 0):
                plane, normal, origin = self.vtk.vtkPlane(), [0, 0, 0], [0, 0, 0]
                normal[axis], origin[axis] = sign, cut[side][axis] * spacing[axis]
                plane.SetNormal(normal)
                plane.SetOrigin(origin)
                planes.AddItem(plane)
        return planes


class Drawn:
    """A scene by one mapper at one step, in a window of its own; drawn any number of times."""

    def __init__(self, scene, kind, step, threads):
        vtk = scene.vtk
        self.vtk, self.kind = vtk, kind
        self.mapper = make_mapper(vtk, kind, step * scene.unit, threads)
        self.mapper.SetInputConnection(scene.reader.GetOutputPort())
        self.mapper.SetClippingPlanes(scene.planes())
        self.volume = vtk.vtkVolume()
        self.volume.SetMapper(self.mapper)
        self.volume.SetProperty(make_property(vtk, scene.points, scene.light, scene.unit))
        self.background = linear_color(scene.settings["background"])
        self.renderer = vtk.vtkRenderer()
        self.renderer.SetBackground(self.background)
        self.renderer.AddVolume(self.volume)
        self.window = vtk.vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(scene.settings["size"])
        self.window.AddRenderer(self.renderer)
        # The OpenGL mapper adds ambient light without multiplying by the volume's colour, so the light is given the
        # colour, which must be the same everywhere. The fixed-point mapper does multiply.
        ambient = linear_color(scene.points[0]["color"]) if kind == "gpu" else [1.0, 1.0, 1.0]
        aim(vtk, self.renderer, scene.camera, scene.light["direction"], ambient)

    def draw(self):
        """Milliseconds."""
        self.volume.Modified()
        self.renderer.GetActiveCamera().Modified()
        started = time.monotonic()
        self.window.Render()
        self.window.WaitForCompletion()
        return (time.monotonic() - started) * 1e3

    def save(self, path):
        if self.kind == "fixed":
            save_fixed_point(self.mapper, self.window, self.background, Path(path))
        else:
            save(self.vtk, self.window, Path(path))


def draw(options):
    vtk = import_vtk()
    started = time.monotonic()
    scene = Scene(vtk, options.session, options.camera)
    load_ms = (time.monotonic() - started) * 1e3
    drawn = Drawn(scene, options.mapper, scene.settings["step_voxels"], options.threads)
    for frame in range(options.frames + 1):
        say(frame=frame, ms=drawn.draw())
    # Measured before the driver's name is queried, since the query costs memory and time.
    peak_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    if options.output:
        drawn.save(options.output)
    say(vtk=vtk.vtkVersion.GetVTKVersion(), mapper=drawn.mapper.GetClassName(), renderer=renderer_name(drawn.window),
        load_ms=load_ms, peak_mib=peak_mib)


def serve(options):
    """A request is {"mapper", "step", "output": a file or null}, its answer {"ms"}; ends with standard input."""
    vtk = import_vtk()
    scene, kept = Scene(vtk, options.session, options.camera), {}
    say(vtk=vtk.vtkVersion.GetVTKVersion())
    for line in sys.stdin:
        asked = json.loads(line)
        key = asked["mapper"], asked["step"]
        if key not in kept:
            kept[key] = Drawn(scene, *key, options.threads)
        ms = kept[key].draw()
        if asked["output"]:
            kept[key].save(asked["output"])
        say(ms=ms)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("session", help="session file of SHVR")
    parser.add_argument("--camera", default="bench", help="one of the session's cameras, with eye and target")
    parser.add_argument("--mapper", choices=["fixed", "gpu"], default="fixed",
                        help="vtkFixedPointVolumeRayCastMapper or vtkGPUVolumeRayCastMapper")
    parser.add_argument("--frames", type=int, default=5, help="after the first, which also prepares")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("-o", "--output", help="picture to write, in linear light (.pfm)")
    parser.add_argument("--serve", action="store_true", help="draw on request, by lines on standard input")
    options = parser.parse_args()
    if not os.environ.get("DISPLAY"):
        xvfb = ["xvfb-run", "-a", "-s", "-screen 0 640x480x24", sys.executable, *sys.argv]
        try:
            os.execvp(xvfb[0], xvfb)
        except FileNotFoundError:
            sys.exit("there is no display and no xvfb-run; expected one of them (Debian: xvfb)")
    (serve if options.serve else draw)(options)


if __name__ == "__main__":
    main()
