// Metadata about a stack as a whole: ImageJ, OME-TIFF, and the resolution fields.

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "tests/support/tiff_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

const fs::path FIXTURES = "tests/data/tiff";  // tests run in the repository's root

/// Pages of one voxel each, 1, 2, 3, ...: shows which pages were read, and in which order.
fs::path numbered(const fs::path& path, int pages, const std::string& description, TiffSpec spec = {})
{
    spec.width = spec.height = 1;
    spec.bits = 8;
    fs::remove(path);
    TiffWriter writer(path, "wl");
    for (int page = 0; page < pages; ++page) {
        spec.description = page == 0 ? description : std::string();
        writer.page(spec, std::string(1, char(page + 1)));
    }
    return path;
}

std::vector<uint8_t> pages_of(const fs::path& path, const OpenOptions& options = {})
{
    return voxels_of<uint8_t>(*open_volume(path, options));
}

std::string refusal(const fs::path& path, const OpenOptions& options = {})
{
    const std::string said = error_of([&] { open_volume(path, options); });
    return said.starts_with(path.string()) ? said.substr(path.string().size()) : said;
}

std::string ome(const std::string& pixels, const std::string& inside = "", const std::string& before = "")
{
    return R"(<?xml version="1.0" encoding="UTF-8"?><OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06">)" +
           before + R"(<Image ID="Image:0"><Pixels ID="Pixels:0" Type="uint8" SizeX="1" SizeY="1" )" + pixels + ">" +
           inside + "</Pixels></Image></OME>";
}

glm::dvec3 spacing_of(const TiffSpec& spec, std::string* unit = nullptr)
{
    const TemporaryFolder folder;
    const auto source = open_volume(numbered(folder.path / "a.tif", 2, spec.description, spec));
    if (unit != nullptr) *unit = source->info().unit;
    return source->info().spacing;
}

}  // namespace

TEST_CASE("an ImageJ stack keeps its hand, its spacing, its unit and its sign")
{
    const TemporaryFolder folder;
    std::vector<std::string> pages;
    for (const std::string& page : chirality_pages()) {
        pages.push_back(page);
        for (size_t i = 1; i < page.size(); i += 2) pages.back()[i] = char(page[i] ^ '\x80');
    }
    TiffSpec spec{.description =
                      "ImageJ=1.53t\nimages=3\nslices=3\nunit=mm\nspacing=1.25\nloop=false\ncf=0\nc0=-32768.0\n"
                      "c1=1.0\nvunit=Gray Value\n"};
    spec.x_resolution = 2.0;
    for (const char* mode : {"wb", "wl"}) {
        const auto source = open_volume(write_tiff(folder.path / "a.tif", spec, pages, mode));
        CHECK(is_chirality_phantom(*source));
        CHECK(source->info().spacing == glm::dvec3(0.5, 0.5, 1.25));
        CHECK(source->info().unit == "mm");
        CHECK(source->info().warnings.empty());
    }
}

TEST_CASE("ImageJ's stacks above 4 GiB, one directory for all slices, are read whole")
{
    for (const char* name : {"imagej_long_big_endian.tif", "imagej_long_little_endian.tif"}) {
        CAPTURE(name);
        const auto source = open_volume(FIXTURES / name);
        CHECK(is_chirality_phantom(*source));
        CHECK(source->info().spacing == glm::dvec3(0.5, 0.5, 1.25));
        CHECK(source->info().unit == "mm");
        CHECK(source->info().warnings.empty());
        CHECK(voxels_in<int16_t>(*source, {{3, 1, 2}, {5, 2, 3}}) == std::vector<int16_t>{114, 115});

        const TemporaryFolder folder;
        const std::string whole = bytes_of_file(FIXTURES / name);
        const fs::path cut = folder.write("a.tif", whole.substr(0, whole.size() - 1));
        CHECK(refusal(cut) ==
              ": its ImageJ description counts 3 images, but it holds one page and 119 bytes of voxels; expected 120: "
              "it is truncated, or pages are missing");
    }
    const TemporaryFolder folder;
    TiffSpec spec{.width = 20, .height = 20, .bits = 8, .compression = COMPRESSION_LZW};
    spec.description = "ImageJ=1.53t\nimages=5\nslices=5\n";
    CHECK(contains(refusal(write_tiff(folder.path / "a.tif", spec, {std::string(400, 'x')})),
                   "counts 5 images, but it holds one page that is compressed; expected a page for each image"));
}

// Kind (Slices): a z-stack that was recorded as time points or channels
TEST_CASE("time points of one slice each are slices, and channels on request")
{
    const TemporaryFolder folder;
    const fs::path times =
        numbered(folder.path / "t.tif", 4, "ImageJ=1.11a\nimages=4\nframes=4\nhyperstack=true\nmode=grayscale\n");
    CHECK(pages_of(times, {}) == std::vector<uint8_t>{1, 2, 3, 4});
    CHECK(pages_of(times, {"", "slices"}) == std::vector<uint8_t>{1, 2, 3, 4});
    CHECK(pages_of(times, {"", "3"}) == std::vector<uint8_t>{3});
    CHECK(warns_of(*open_volume(times),
                   "the description counts 4 time points of one slice each; they were taken as "
                   "slices; --frame 1 to 4 takes one of them"));
    const fs::path channels = numbered(folder.path / "c.tif", 3, "ImageJ=1.53t\nimages=3\nchannels=3\n");
    CHECK(refusal(channels) ==
          ": has 3 channels (1, 2, 3); expected one: choose with --channel 1, 2 or 3; --channel "
          "slices takes all of them as the slices of one volume");
    CHECK(pages_of(channels, {"slices"}) == std::vector<uint8_t>{1, 2, 3});
    const fs::path both = numbered(folder.path / "b.tif", 6, "ImageJ=1.53t\nimages=6\nchannels=2\nframes=3\n");
    CHECK(contains(refusal(both), "--frame slices takes all of them as the slices of one volume"));
    CHECK(pages_of(both, {"2", "slices"}) == std::vector<uint8_t>{2, 4, 6});
}

TEST_CASE("channels and time points of an ImageJ hyperstack are chosen")
{
    const TemporaryFolder folder;
    const std::string description = "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\n";
    const fs::path path = numbered(folder.path / "a.tif", 12, description);
    CHECK(refusal(path) ==
          ": has 2 channels (1, 2) and 2 time points; expected one of each: choose with --channel 1 or 2 and "
          "--frame 1 "
          "or 2");
    CHECK(refusal(path, {.channel = "1"}) == ": has 2 time points; expected one: choose with --frame 1 or 2");
    CHECK(refusal(path, {.frame = "2"}) == ": has 2 channels (1, 2); expected one: choose with --channel 1 or 2");
    CHECK(refusal(path, {.channel = "3", .frame = "1"}) == ": has no channel \"3\"; expected 1 or 2");
    CHECK(refusal(path, {.channel = "red", .frame = "1"}) == ": has no channel \"red\"; expected 1 or 2");
    CHECK(refusal(path, {.channel = "1", .frame = "0"}) == ": has no time point \"0\"; expected 1 or 2");
    CHECK(pages_of(path, {"1", "1"}) == std::vector<uint8_t>{1, 3, 5});
    CHECK(pages_of(path, {"2", "1"}) == std::vector<uint8_t>{2, 4, 6});
    CHECK(pages_of(path, {"1", "2"}) == std::vector<uint8_t>{7, 9, 11});
    CHECK(pages_of(path, {"2", "2"}) == std::vector<uint8_t>{8, 10, 12});

    CHECK(refusal(numbered(path, 11, description)) ==
          ": its ImageJ description counts 2 channels of 3 slices at 2 time points; expected 12 pages, but it holds "
          "11");
    CHECK(refusal(numbered(path, 12, "ImageJ=1.53t\nimages=12\nchannels=2\nslices=5\n")) ==
          ": its ImageJ description counts 12 images but 2 x 5 x 1 channels, slices and frames; expected equal counts: "
          "save it again, for example from Fiji");
    CHECK(refusal(numbered(path, 2, "ImageJ=1.53t\nimages=-3\n")) ==
          ": its ImageJ description: images is \"-3\"; expected a whole number from 1 to 1048576");
    CHECK(
        contains(refusal(numbered(path, 2, "ImageJ=1.53t\nimages=99999999999999999999\n")), "expected a whole number"));
    CHECK(pages_of(numbered(path, 3, "ImageJ=1.53t\nimages=3\n")) == std::vector<uint8_t>{1, 2, 3});
    const auto short_of = open_volume(numbered(path, 3, "ImageJ=1.53t\nimages=4\nslices=4\n"));
    CHECK(short_of->info().size.z == 3);
    CHECK(warns_of(*short_of, "the description counts 4 images, the file holds 3 pages; all pages were taken"));
}

TEST_CASE("slices that a script wrote as channels are taken as slices, and it is said")
{
    const TemporaryFolder folder;
    const fs::path path = numbered(folder.path / "a.tif", 9, "ImageJ=1.11a\nimages=9\nchannels=9\nhyperstack=true\n");
    const auto source = open_volume(path);
    CHECK(source->info().size.z == 9);
    CHECK(warns_of(*source, "counts 9 channels of one slice each; they were taken as slices"));
    CHECK(pages_of(path, {.channel = "4"}) == std::vector<uint8_t>{4});
    CHECK(contains(refusal(numbered(path, 7, "ImageJ=1.11a\nimages=7\nchannels=7\n")),
                   "choose with --channel 1, 2, 3, 4, 5, 6 or 7"));
}

TEST_CASE("spacing and unit of ImageJ files, in all spellings")
{
    const TemporaryFolder folder;
    const std::string start = "ImageJ=1.53t\nimages=2\nslices=2\n";
    for (const char* unit :
         {"um", "micron", "microns", "micrometer", "\\u00B5m", "\\u00b5m", "µm", "\u03bcm", "\xb5m"}) {
        CAPTURE(unit);
        std::string found;
        const TiffSpec spec{
            .description = start + "unit=" + unit + "\nspacing=2.5\n", .x_resolution = 4.0, .y_resolution = 2.0};
        CHECK(spacing_of(spec, &found) == glm::dvec3(0.25, 0.5, 2.5));
        CHECK(found == "um");
    }
    std::string unit;
    CHECK(spacing_of({.description = start + "unit=um\n", .x_resolution = 4.0}, &unit) == glm::dvec3(0.25, 0.25, 1.0));
    CHECK(spacing_of({.description = start + "unit=um\nspacing=-3\n", .x_resolution = 1.0}) ==
          glm::dvec3(1.0, 1.0, 3.0));
    CHECK(spacing_of({.description = start + "unit=um\nzunit=nm\nspacing=500\n", .x_resolution = 1.0}) ==
          glm::dvec3(1.0, 1.0, 0.5));
    CHECK(spacing_of({.description = start + "unit=inch\nspacing=0.5\n", .x_resolution = 10.0}, &unit) ==
          glm::dvec3(2.54, 2.54, 12.7));
    CHECK(unit == "mm");
    CHECK(spacing_of({.description = start + "unit=pixel\n", .x_resolution = 1.0}, &unit) == glm::dvec3(1.0));
    CHECK(unit == "voxel");
    CHECK(
        spacing_of({.description = start + "spacing=2\n", .x_resolution = 100.0, .resolution_unit = RESUNIT_CENTIMETER},
                   &unit)
            .z == doctest::Approx(20000.0));
    CHECK(unit == "um");

    // A resolution is a quotient of whole numbers; libtiff would return a float.
    CHECK(spacing_of({.description = start + "unit=um\n", .x_resolution = 16.666667}).x ==
          doctest::Approx(0.06).epsilon(1e-7));

    const auto no_distance =
        open_volume(numbered(folder.path / "a.tif", 2, start + "unit=um\n", {.x_resolution = 4.0}));
    CHECK(warns_of(*no_distance, "no distance of slices stated; 1 um assumed, as ImageJ does"));
    const auto no_pixels = open_volume(numbered(folder.path / "a.tif", 2, start + "unit=um\nspacing=2\n"));
    CHECK(no_pixels->info().spacing == glm::dvec3(1.0, 1.0, 2.0));
    CHECK(warns_of(*no_pixels, "no distance of pixels stated; 1 um assumed, as ImageJ does"));
    const auto no_unit = open_volume(numbered(folder.path / "a.tif", 2, start + "spacing=2\n", {.x_resolution = 0.5}));
    CHECK(no_unit->info().spacing == glm::dvec3(2.0));
    CHECK(warns_of(*no_unit, "spacing is stated without a unit; voxel assumed"));
    const auto odd = open_volume(
        numbered(folder.path / "a.tif", 2, start + "unit=furlong\nzunit=um\nspacing=2\n", {.x_resolution = 1.0}));
    CHECK(
        warns_of(*odd, "spacing along z is stated in \"um\", which does not convert to \"furlong\", and was ignored"));
    CHECK(odd->info().unit == "furlong");
}

TEST_CASE("other calibrations of intensities are said to be left out")
{
    const TemporaryFolder folder;
    const auto warned = [&](const std::string& lines, const char* part) {
        return warns_of(*open_volume(numbered(folder.path / "a.tif", 2, "ImageJ=1.53t\nimages=2\n" + lines)), part);
    };
    CHECK(
        warned("cf=0\nc0=-1024\nc1=0.5\n", "calibrated as -1024 + 0.5 times what is stored; they are shown as stored"));
    CHECK(warned("cf=3\nc0=1\nc1=2\n", "calibrated by a curve; they are shown as stored"));
    CHECK_FALSE(warned("cf=0\nc0=0\nc1=1\n", "calibrated"));
    CHECK_FALSE(warned("c0=5\n", "calibrated"));
}

TEST_CASE("resolution fields give the spacing where no program states it, unless they are a printer's")
{
    const TemporaryFolder folder;
    std::string unit;
    CHECK(spacing_of({.x_resolution = 2540.0, .resolution_unit = RESUNIT_INCH}, &unit) == glm::dvec3(10.0));
    CHECK(unit == "um");
    CHECK(spacing_of({.x_resolution = 5000.0, .y_resolution = 2500.0, .resolution_unit = RESUNIT_CENTIMETER}) ==
          glm::dvec3(2.0, 4.0, 2.0));
    const auto stack = open_volume(
        numbered(folder.path / "a.tif", 2, "", {.x_resolution = 5000.0, .resolution_unit = RESUNIT_CENTIMETER}));
    CHECK(warns_of(*stack, "no distance of slices stated; 2 um assumed, as between pixels"));
    for (const double dots : {72.0, 96.0, 300.0}) {
        CHECK(spacing_of({.x_resolution = dots, .resolution_unit = RESUNIT_INCH}, &unit) == glm::dvec3(1.0));
        CHECK(spacing_of({.x_resolution = dots / 2.54, .resolution_unit = RESUNIT_CENTIMETER}) == glm::dvec3(1.0));
        CHECK(unit == "voxel");
    }
    const auto screen =
        open_volume(numbered(folder.path / "a.tif", 2, "", {.x_resolution = 72.0, .resolution_unit = RESUNIT_INCH}));
    CHECK(warns_of(*screen, "its 72 pixels for each inch are those of a screen or printer, and were ignored"));
    CHECK(warns_of(*screen, "no spacing stated; 1 voxel assumed"));
    CHECK(spacing_of({.x_resolution = 2.0, .y_resolution = 1.0}, &unit) == glm::dvec3(1.0, 2.0, 1.0));
    CHECK(unit == "voxel");
}

TEST_CASE("an OME-TIFF keeps its spacing, whatever the units")
{
    const TemporaryFolder folder;
    const auto source_of = [&](const std::string& attributes) {
        return open_volume(numbered(folder.path / "a.tif", 2,
                                    ome("SizeZ=\"2\" SizeC=\"1\" SizeT=\"1\" DimensionOrder=\"XYZCT\" " + attributes)));
    };
    const auto plain = source_of(R"(PhysicalSizeX="0.5" PhysicalSizeY="0.25" PhysicalSizeZ="2")");
    CHECK(plain->info().spacing == glm::dvec3(0.5, 0.25, 2.0));
    CHECK(plain->info().unit == "um");
    CHECK(plain->info().warnings.empty());
    const auto mixed = source_of(
        R"(PhysicalSizeX="500" PhysicalSizeXUnit="nm" PhysicalSizeY="0.5" PhysicalSizeYUnit="µm" PhysicalSizeZ="0.002" PhysicalSizeZUnit="mm")");
    CHECK(mixed->info().unit == "nm");
    CHECK(mixed->info().spacing.y == doctest::Approx(500.0));
    CHECK(mixed->info().spacing.z == doctest::Approx(2000.0));
    const auto flat = source_of(R"(PhysicalSizeX="3" PhysicalSizeY="3")");
    CHECK(flat->info().spacing == glm::dvec3(3.0));
    CHECK(warns_of(*flat, "no distance of slices stated; 3 um assumed, as between pixels"));
    CHECK(warns_of(*source_of(""), "no spacing stated; 1 voxel assumed"));
    CHECK(source_of(R"(PhysicalSizeX="nan" PhysicalSizeY="-1" PhysicalSizeZ="0")")->info().unit == "voxel");
}

TEST_CASE("planes of an OME-TIFF follow its DimensionOrder or its TiffData")
{
    const TemporaryFolder folder;
    const fs::path path = folder.path / "a.tif";
    const std::string sizes = R"(SizeZ="2" SizeC="3" SizeT="2" DimensionOrder=")";
    const OpenOptions second{"2", "2"};
    numbered(path, 12, ome(sizes + "XYZCT\""));
    CHECK(pages_of(path, second) == std::vector<uint8_t>{9, 10});
    numbered(path, 12, ome(sizes + "XYCZT\""));
    CHECK(pages_of(path, second) == std::vector<uint8_t>{8, 11});
    numbered(path, 12, ome(sizes + "XYTZC\""));
    CHECK(pages_of(path, second) == std::vector<uint8_t>{6, 8});
    numbered(path, 12, ome(sizes + "XYTCZ\"", "<TiffData/>"));
    CHECK(pages_of(path, second) == std::vector<uint8_t>{4, 10});

    const std::string one = R"(SizeZ="3" SizeC="1" SizeT="1" DimensionOrder="XYZCT")";
    numbered(path, 5, ome(one, R"(<TiffData FirstZ="2" IFD="0"/><TiffData FirstZ="0" IFD="3" PlaneCount="2"/>)"));
    CHECK(pages_of(path) == std::vector<uint8_t>{4, 5, 1});
    numbered(path, 5,
             ome(one, R"(<TiffData IFD="2" PlaneCount="3"><UUID FileName="renamed.ome.tif">u</UUID></TiffData>)"));
    CHECK(pages_of(path) == std::vector<uint8_t>{3, 4, 5});

    numbered(path, 12, ome(sizes + "XYZCT\"", R"(<Channel Name="DAPI"/><Channel Name="GFP 2"/><Channel/>)"));
    CHECK(refusal(path, {.frame = "1"}) ==
          ": has 3 channels (DAPI, 2 = \"GFP 2\", 3); expected one: choose with --channel DAPI, 2 or 3");
    CHECK(pages_of(path, {"dapi", "1"}) == std::vector<uint8_t>{1, 2});
    CHECK(pages_of(path, {"GFP 2", "1"}) == std::vector<uint8_t>{3, 4});
}

// Kind (TIFF): OME-XML in a companion file, and a stack in several files
TEST_CASE("a stack of OME in several files is opened by any of them, with its XML in a companion")
{
    const TemporaryFolder folder;
    const std::string planes =
        R"(<TiffData FirstZ="0" IFD="1"><UUID FileName="a.ome.tif">urn:uuid:a</UUID></TiffData>)"
        R"(<TiffData FirstZ="1" IFD="0"><UUID FileName="b.ome.tif">urn:uuid:b</UUID></TiffData>)"
        R"(<TiffData FirstZ="2" IFD="0"><UUID FileName="a.ome.tif">urn:uuid:a</UUID></TiffData>)";
    const std::string whole = ome(R"(SizeZ="3" SizeC="1" SizeT="1" DimensionOrder="XYZCT" PhysicalSizeX="2")", planes);
    const auto binary_only = [](const std::string& name) {
        return R"(<OME UUID="urn:uuid:)" + name + R"("><BinaryOnly MetadataFile="x.companion.ome" UUID="u"/></OME>)";
    };
    folder.write("x.companion.ome", whole);
    const fs::path a = numbered(folder.path / "a.ome.tif", 2, binary_only("a"));
    const fs::path b = numbered(folder.path / "b.ome.tif", 1, binary_only("b"));
    CHECK(pages_of(a) == std::vector<uint8_t>{2, 1, 1});
    CHECK(pages_of(b) == std::vector<uint8_t>{2, 1, 1});
    CHECK(open_volume(b)->info().spacing.x == 2.0);
    // A renamed file is found by its identifier.
    fs::rename(b, folder.path / "c.ome.tif");
    CHECK(contains(refusal(a), "\"b.ome.tif\" is missing; expected it next to this one"));
    CHECK(pages_of(folder.path / "c.ome.tif") == std::vector<uint8_t>{2, 1, 1});
    numbered(folder.path / "b.ome.tif", 0 + 1, whole);
    CHECK(pages_of(folder.path / "b.ome.tif") == std::vector<uint8_t>{2, 1, 1});
    // The companion of a companion, and one that is itself a TIFF.
    folder.write("x.companion.ome", binary_only("x"));
    CHECK(contains(refusal(a), "x.companion.ome: its OME-XML is in another file"));
    numbered(folder.path / "x.companion.ome", 1, whole);
    CHECK(pages_of(a) == std::vector<uint8_t>{2, 1, 1});
}

// Kind (TIFF): an OME-TIFF whose writing was aborted
TEST_CASE("of an aborted OME-TIFF the slices that it lacks cannot be read, the others can")
{
    const TemporaryFolder folder;
    const fs::path path =
        numbered(folder.path / "a.tif", 3, ome(R"(SizeZ="5" SizeC="1" SizeT="1" DimensionOrder="XYZCT")"));
    const auto source = open_volume(path);
    CHECK(source->info().size == Size3(1, 1, 5));
    CHECK(warns_of(*source, "its OME-XML names 2 pages more than the 3 that the file holds"));
    uint8_t voxel = 0;
    const auto read = [&](int64_t z) {
        source->read({{0, 0, z}, {1, 1, z + 1}}, std::as_writable_bytes(std::span(&voxel, 1)));
    };
    read(2);
    CHECK(voxel == 3);
    CHECK(contains(error_of([&] { read(3); }),
                   "lacks the page of slice 4, which its OME-XML names; expected a complete"));
}

TEST_CASE("an OME-TIFF that is not whole says so")
{
    const TemporaryFolder folder;
    const fs::path path = folder.path / "a.tif";
    const std::string one = R"(SizeZ="3" SizeC="1" SizeT="1" DimensionOrder="XYZCT")";
    const auto refused = [&](const std::string& description) { return refusal(numbered(path, 3, description)); };
    CHECK(refused(ome(one, R"(<TiffData IFD="0"><UUID FileName="a.ome.tif">1</UUID></TiffData>)"
                           R"(<TiffData FirstZ="1" IFD="0"><UUID FileName="b.ome.tif">2</UUID></TiffData>)")) ==
          ": its OME-XML describes a stack in several files; \"a.ome.tif\" is missing; expected it next to this one");
    CHECK(contains(
        refused(R"(<OME><BinaryOnly MetadataFile="a.companion.ome" UUID="u"/></OME>)"),
        ": its OME-XML is in another file, \"a.companion.ome\", which is missing; expected it next to this one"));
    CHECK(refused(ome(one, R"(<TiffData IFD="0"/>)")) ==
          ": its OME-XML names no page for slice 2; expected one for each slice");
    CHECK(refused(ome(R"(SizeZ="0" SizeC="1" SizeT="1" DimensionOrder="XYZCT")")) ==
          ": its OME-XML: SizeZ is \"0\"; expected a whole number from 1 to 1048576");
    CHECK(contains(refused(ome(R"(SizeZ="1048576" SizeC="1048576" SizeT="1048576" DimensionOrder="XYZCT")")),
                   "slices, channels and time points; expected at most 1048576 pages"));
    CHECK(contains(refused(ome(R"(SizeZ="3" SizeC="1" SizeT="1" DimensionOrder="XYZZT")")),
                   "DimensionOrder is \"XYZZT\"; expected"));
    CHECK(contains(refused(ome(one, R"(<TiffData FirstZ="3"/>)")), "FirstZ is 3; expected less than the 3 there are"));
    CHECK(contains(refused(ome(one, R"(<TiffData IFD="-1"/>)")), "IFD is \"-1\"; expected"));
    CHECK(contains(refused("<?xml version=\"1.0\"?><OME><Image>"), "its OME-XML cannot be read: "));
    CHECK(contains(refused("<OME></OME>"), "has no Image with Pixels; expected at least one"));
    std::string many;
    for (int i = 0; i < 3000; ++i) many += R"(<TiffData IFD="0" PlaneCount="1000000"/>)";
    CHECK(contains(refused(ome(one, many)), "planes; expected the 3 there are"));

    // Truncated anywhere, it is either refused or means the same.
    const std::string whole = ome(one, R"(<TiffData IFD="0" PlaneCount="3"/>)");
    for (size_t length = 0; length < whole.size(); ++length) {
        const std::string said = refused(whole.substr(0, length));
        if (said.empty()) CHECK(pages_of(path) == std::vector<uint8_t>{1, 2, 3});
    }
}

TEST_CASE("of several images in an OME-TIFF the largest is taken")
{
    const TemporaryFolder folder;
    const std::string label =
        R"(<Image ID="Image:1" Name="label"><Pixels SizeX="1" SizeY="1" SizeZ="1" SizeC="1" SizeT="1" DimensionOrder="XYZCT"><TiffData IFD="0"/></Pixels></Image>)";
    const fs::path path = numbered(
        folder.path / "a.tif", 3,
        ome(R"(SizeZ="2" SizeC="1" SizeT="1" DimensionOrder="XYZCT")", R"(<TiffData IFD="1" PlaneCount="2"/>)", label));
    CHECK(pages_of(path) == std::vector<uint8_t>{2, 3});
    CHECK(warns_of(*open_volume(path), "the file holds 2 images; the largest was taken"));
}
