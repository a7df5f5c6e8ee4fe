// A folder of TIFFs, one slice each.

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "tests/support/tiff_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

class Slices : public TemporaryFolder {
public:
    /// Adds a slice of 2 x 2 voxels of one value.
    void add(const std::string& name, char value, TiffSpec spec = {.width = 2, .height = 2, .bits = 8}) const
    {
        write_tiff(path / name, spec, {std::string(spec.page_bytes(), value)});
    }
    /// The values of the slices, in the order in which they are read.
    std::string order() const
    {
        std::string order;
        const auto source = open_volume(path);
        for (int64_t z = 0; z < source->info().size.z; ++z) {
            order += char(voxels_in<uint8_t>(*source, {{0, 0, z}, {1, 1, z + 1}})[0]);
        }
        return order;
    }
    std::string refusal(const OpenOptions& options = {}) const
    {
        const std::string said = error_of([&] { open_volume(path, options); });
        return said.starts_with(path.string()) ? said.substr(path.string().size()) : said;
    }
};

}  // namespace

TEST_CASE("a folder of TIFFs does not mirror the chirality phantom")
{
    const TemporaryFolder folder;
    TiffSpec spec{.format = SAMPLEFORMAT_INT};
    spec.description = "ImageJ=1.53t\nunit=mm\nspacing=1.25\n";
    spec.x_resolution = 2.0;
    for (int z = 0; z < 3; ++z) {
        write_tiff(folder.path / sentence("slice_", 9 + z, ".tif"), spec, {chirality_page(z)}, z == 1 ? "wb8" : "wl");
    }
    for (const fs::path& path : {folder.path, folder.path / ""}) {
        const auto source = open_volume(path);
        CHECK(is_chirality_phantom(*source));
        CHECK(source->info().format == "tiff");
        CHECK(source->info().name == folder.path.filename().string());
        CHECK(source->info().spacing == glm::dvec3(0.5, 0.5, 1.25));
        CHECK(source->info().unit == "mm");
        CHECK(source->info().warnings.empty());
    }
}

TEST_CASE("slices come in the order of their numbers, whatever the case and length of their names")
{
    const Slices slices;
    slices.add("Slice2.tif", 'b');
    slices.add("slice10.TIF", 'd');
    slices.add("SLICE9.tiff", 'c');
    slices.add("slice001.Tiff", 'a');
    slices.add("slice99999999999999999999999.tif", 'e');
    slices.write("slice3.tif.txt", "not a slice");
    slices.write("notes.txt", "nor this");
    slices.write(".slice4.tif", "what another system keeps beside a file");
    fs::create_directory(slices.path / "slice5.tif");
    CHECK(slices.order() == "abcde");
}

TEST_CASE("other numbers in the names do not matter, and gaps are said")
{
    const Slices slices;
    slices.add("scan_2024_10um_0001.tif", 'a');
    slices.add("scan_2024_10um_0002.tif", 'b');
    slices.add("scan_2024_10um_0003.tif", 'c');
    CHECK(slices.order() == "abc");
    CHECK_FALSE(warns_of(*open_volume(slices.path), "apart"));
    slices.add("scan_2024_10um_0005.tif", 'd');
    CHECK(slices.order() == "abcd");
    CHECK(
        warns_of(*open_volume(slices.path),
                 "the numbers of \"scan_2024_10um_0003.tif\" and \"scan_2024_10um_0005.tif\" are 2 apart, those before "
                 "1; slices may be missing; they were taken as evenly spaced"));

    const Slices exposures;  // a count, and a second number that changes with it
    exposures.add("img_1_1200.tif", 'a');
    exposures.add("img_2_1187.tif", 'b');
    exposures.add("img_10_1190.tif", 'c');
    CHECK(exposures.order() == "abc");
}

TEST_CASE("two series in one folder are not mixed")
{
    const Slices slices;
    slices.add("a_1.tif", 'a');
    slices.add("a_2.tif", 'b');
    slices.add("b_1.tif", 'c');
    slices.add("b_2.tif", 'd');
    CHECK(slices.refusal() ==
          ": holds 2 series of slices, from \"a_1.tif\" on and from \"b_1.tif\" on; expected one: put each into a "
          "folder of its own");

    const Slices times;
    for (const char* name : {"t1_z1.tif", "t1_z2.tif", "t2_z1.tif", "t2_z2.tif", "t3_z1.tif", "t3_z2.tif"})
        times.add(name, 'x');
    CHECK(times.refusal() ==
          ": holds 3 series of slices, from \"t1_z1.tif\" on and from \"t2_z1.tif\" on among them; expected one: put "
          "each into a folder of its own");

    const Slices twice;
    twice.add("s1.tif", 'a');
    twice.add("s2.tif", 'b');
    twice.add("s02.tif", 'c');
    CHECK(twice.refusal() ==
          ": \"s02.tif\" and \"s2.tif\" have the same number; expected one file for each slice: remove one of them");

    const Slices unnumbered;
    unnumbered.add("brain.tif", 'a');
    unnumbered.add("mask.tif", 'b');
    CHECK(unnumbered.refusal() ==
          ": holds 2 TIFFs without numbers in their names, \"brain.tif\" and \"mask.tif\" among "
          "them; expected the numbered slices of one volume: number them, or open one of the files");
    const Slices same;
    same.add("brain.tif", 'a');
    same.add("brain.tiff", 'b');
    CHECK(contains(same.refusal(), "differ only in their extension; expected one of them"));
}

// Kind (Slices): TIFF slices with decimal numbers, a preview and a log next to them
TEST_CASE("a preview next to slices is left out, decimal numbers count, and the log states the spacing")
{
    const Slices slices;
    slices.add("bone_rec0001.tif", 'a');
    slices.add("bone_rec0002.tif", 'b');
    slices.add("bone_rec_spr.tif", 'c');
    slices.write("bone_rec.log", "[Reconstruction]\r\nPixel Size (um)=17.5\r\nSection to Section Step=1\r\n");
    CHECK(slices.order() == "ab");
    const auto source = open_volume(slices.path);
    CHECK(warns_of(*source, "\"bone_rec_spr.tif\" is not numbered like the slices or of another size, and left out"));
    CHECK(source->info().spacing == glm::dvec3(17.5));
    CHECK(source->info().unit == "um");

    const Slices decimals;
    for (const char* name : {"z_10.0.tif", "z_8.05.tif", "z_8.5.tif", "z_9.0.tif"})
        decimals.add(name, name[2] == '1' ? 'd' : name[2] == '9' ? 'c' : name[4] == '0' ? 'a' : 'b');
    CHECK(decimals.order() == "abcd");
    CHECK(warns_of(*open_volume(decimals.path), "slices may be missing"));
}

TEST_CASE("slices of another size or type are refused by name")
{
    const Slices slices;
    for (int i = 1; i < 12; ++i) slices.add(sentence("s", i, ".tif"), 'a');
    slices.add("s7.tif", 'b', {.width = 3, .height = 2, .bits = 8});
    CHECK(slices.refusal() == "/s7.tif: has 3x2 pixels of uint8; expected 2x2 pixels of uint8, as s1.tif");
    slices.add("s7.tif", 'b', {.width = 2, .height = 2, .bits = 16});
    CHECK(slices.refusal() == "/s7.tif: has 2x2 pixels of uint16; expected 2x2 pixels of uint8, as s1.tif");
    slices.add("s7.tif", 'b', {.width = 2, .height = 2, .bits = 8, .format = SAMPLEFORMAT_INT});
    CHECK(slices.refusal() == "/s7.tif: has 2x2 pixels of int8; expected 2x2 pixels of uint8, as s1.tif");
    const TiffSpec spec{.width = 2, .height = 2, .bits = 8};
    write_tiff(slices.path / "s7.tif", spec, {"abcd", "efgh"});
    CHECK(contains(slices.refusal(), "/s7.tif: holds 2 pages; expected one, as a slice of the folder"));
    slices.write("s7.tif", "what is this");
    CHECK(slices.refusal() == "/s7.tif: begins with \"what\"; expected the first bytes of a TIFF, II or MM");
    slices.write("s7.tif", bytes_of_file(slices.path / "s1.tif").substr(0, 40));
    CHECK(contains(slices.refusal(), "/s7.tif: "));
}

TEST_CASE("slices may be compressed in different ways, and change after opening is an error")
{
    const Slices slices;
    slices.add("s1.tif", 'a');
    slices.add("s2.tif", 'b', {.width = 2, .height = 2, .bits = 8, .compression = COMPRESSION_LZW});
    slices.add("s3.tif", 'c',
               {.width = 2, .height = 2, .bits = 8, .compression = COMPRESSION_PACKBITS, .rows_per_strip = 1});
    CHECK(slices.order() == "abc");
    const auto source = open_volume(slices.path);
    fs::remove(slices.path / "s2.tif");
    CHECK(contains(error_of([&] { voxels_of<uint8_t>(*source); }), "/s2.tif: cannot be opened: No such file"));
    slices.add("s2.tif", 'b', {.width = 3, .height = 3, .bits = 8});
    CHECK(error_of([&] { voxels_of<uint8_t>(*source); }) != "");
}

TEST_CASE("colours of the slices of a folder are chosen")
{
    const Slices slices;
    const TiffSpec spec{.width = 1, .height = 1, .bits = 8, .samples = 3, .photometric = PHOTOMETRIC_RGB};
    write_tiff(slices.path / "s1.tif", spec, {"rgb"});
    write_tiff(slices.path / "s2.tif", spec, {"RGB"});
    CHECK(slices.refusal() ==
          ": has 3 channels (red, green, blue); expected one: choose with --channel red, green or blue");
    CHECK(voxels_of<uint8_t>(*open_volume(slices.path, {.channel = "green"})) == std::vector<uint8_t>{'g', 'G'});
    CHECK(slices.refusal({.channel = "red", .frame = "2"}) == ": has no time point \"2\"; expected 1");
}

TEST_CASE("a folder of one TIFF is that TIFF, and one without TIFFs is no volume")
{
    const TemporaryFolder folder;
    write_tiff(folder.path / "stack.tif", {.format = SAMPLEFORMAT_INT}, chirality_pages());
    CHECK(is_chirality_phantom(*open_volume(folder.path)));
    const TemporaryFolder empty;
    empty.write("notes.txt", "nothing");
    CHECK(contains(error_of([&] { open_volume(empty.path); }), ": is a folder without"));
}

TEST_CASE("a folder of many slices keeps few files open")
{
    const Slices slices;
    for (int i = 0; i < 2000; ++i) slices.add(sentence("s", i, ".tif"), char(i % 256));
    const auto open_files = [] {
        return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
    };
    const auto before = open_files();
    const auto source = open_volume(slices.path);
    CHECK(voxels_of<uint8_t>(*source)[4 * 1999] == 1999 % 256);
    CHECK(open_files() <= before + 2);
}

TEST_CASE("files of an OME-TIFF in several files are slices of a folder")
{
    const Slices slices;
    TiffSpec spec{.width = 2, .height = 2, .bits = 8};
    const auto ome = [](const std::string& channels) {
        return R"(<OME><Image><Pixels SizeX="2" SizeY="2" SizeZ="2" SizeC=")" + channels +
               R"(" SizeT="1" DimensionOrder="XYZCT" PhysicalSizeX="0.5" PhysicalSizeY="0.5" PhysicalSizeZ="2">)"
               R"(<TiffData IFD="0"><UUID FileName="s1.ome.tif">1</UUID></TiffData>)"
               R"(<TiffData FirstZ="1" IFD="0"><UUID FileName="s2.ome.tif">2</UUID></TiffData></Pixels></Image></OME>)";
    };
    spec.description = ome("1");
    slices.add("s1.ome.tif", 'a', spec);
    slices.add("s2.ome.tif", 'b', spec);
    CHECK(slices.order() == "ab");
    CHECK(open_volume(slices.path)->info().spacing == glm::dvec3(0.5, 0.5, 2.0));
    spec.description = ome("2");
    slices.add("s1.ome.tif", 'a', spec);
    CHECK(contains(slices.refusal(),
                   "the description of its first file states 2 channels and 1 time points; expected one of each"));
}
