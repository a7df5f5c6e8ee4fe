#!/usr/bin/python3
"""Draws a session with VTK's volume ray caster, to compare SHVR with: the same volume, camera, transfer function, light
and step. Prints one JSON line about the run, one for every frame, and one at the end.

tools/peers/vtk_raycast.py SESSION [--camera NAME] [--mapper fixed|gpu] [--frames 5] [--threads 2] [-o PICTURE.pfm]

Needs Debian's python3-vtk9 and, without a display, xvfb.
"""
import argparse
import json
import os
import resource
import sys
import time
from array import array
from pathlib import Path

# Defaults of a session (engine/session/README.md).
LIGHT = {"shaded": True, "ambient": 0.3, "diffuse": 0.7, "specular": 0.2, "shininess": 32, "direction": [0, 0, 0]}
RENDER = {"size": [512, 512], "step_voxels": 0.5, "background": "#ffffff"}


def linear_color(text):
    """"#rrggbb" to linear light: VTK has no colour curve, so its input and output are linear light."""
    encoded = [int(text[i:i + 2], 16) / 255 for i in (1, 3, 5)]
    return [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in encoded]


def read_header(path):
    """Fields of a detached NRRD header."""
    fields = dict(line.split(": ", 1) for line in path.read_text().splitlines() if ": " in line)
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
    reader.SetDataOrigin([0.5 * s for s in spacing])
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
    light = vtk.vtkLight()
    light.SetAmbientColor(ambient)  # VTK's default is none
    light.PositionalOff()
    light.SetLightTypeToCameraLight()
    light.SetPosition(direction if any(direction) else [0.3, 0.5, 1.0])
    light.SetFocalPoint(0, 0, 0)
    renderer.AddLight(light)
    renderer.TwoSidedLightingOff()
    renderer.ResetCameraClippingRange()


def save(vtk, window, path):
    """A portable float map, with rows from the bottom as in VTK. The rendered image has 8 bits per channel."""
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.SetInputBufferTypeToRGB()
    grab.ReadFrontBufferOff()
    grab.ShouldRerenderOff()
    grab.Update()
    image = grab.GetOutput()
    width, height, _ = image.GetDimensions()
    values = array("f", (byte / 255 for byte in bytes(memoryview(image.GetPointData().GetScalars()))))
    if sys.byteorder == "big":
        values.byteswap()
    path.write_bytes(f"PF\n{width} {height}\n-1.0\n".encode() + values.tobytes())


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


def draw(options):
    vtk = import_vtk()
    session = json.loads(Path(options.session).read_text())
    if "path" not in session["volume"] or session.get("annotation"):
        sys.exit(f"{options.session}: expected a volume in a file, and no mask")
    light, settings = {**LIGHT, **session.get("light", {})}, {**RENDER, **session.get("render", {})}
    started = time.monotonic()
    reader, unit = open_volume(vtk, Path(options.session).parent / session["volume"]["path"])
    reader.Update()
    load_ms = (time.monotonic() - started) * 1e3

    mapper = make_mapper(vtk, options.mapper, settings["step_voxels"] * unit, options.threads)
    mapper.SetInputConnection(reader.GetOutputPort())
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    points = session["transfer_function"]["points"]
    volume.SetProperty(make_property(vtk, points, light, unit))
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(linear_color(settings["background"]))
    renderer.AddVolume(volume)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(settings["size"])
    window.AddRenderer(renderer)
    # The OpenGL mapper adds ambient light without the volume's colour, so the light carries the colour of a volume of
    # one colour. The fixed-point mapper multiplies by it.
    ambient = linear_color(points[0]["color"]) if options.mapper == "gpu" else [1.0, 1.0, 1.0]
    aim(vtk, renderer, session["cameras"][options.camera], light["direction"], ambient)

    for frame in range(options.frames + 1):
        volume.Modified()
        renderer.GetActiveCamera().Modified()
        started = time.monotonic()
        window.Render()
        window.WaitForCompletion()
        say(frame=frame, ms=(time.monotonic() - started) * 1e3)
    # Querying the driver's name costs memory and time.
    peak_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    if options.output:
        save(vtk, window, Path(options.output))
    say(vtk=vtk.vtkVersion.GetVTKVersion(), mapper=mapper.GetClassName(), renderer=renderer_name(window),
        load_ms=load_ms, peak_mib=peak_mib)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("session", help="session file of SHVR")
    parser.add_argument("--camera", default="bench", help="one of the session's cameras, with eye and target")
    parser.add_argument("--mapper", choices=["fixed", "gpu"], default="fixed",
                        help="vtkFixedPointVolumeRayCastMapper or vtkGPUVolumeRayCastMapper")
    parser.add_argument("--frames", type=int, default=5, help="after the first, which also prepares")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("-o", "--output", help="picture to write, in linear light (.pfm)")
    options = parser.parse_args()
    if not os.environ.get("DISPLAY"):
        xvfb = ["xvfb-run", "-a", "-s", "-screen 0 640x480x24", sys.executable, *sys.argv]
        try:
            os.execvp(xvfb[0], xvfb)
        except FileNotFoundError:
            sys.exit("there is no display and no xvfb-run; expected one of them (Debian: xvfb)")
    draw(options)


if __name__ == "__main__":
    main()
