#include <algorithm>
#include <chrono>

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

/// Headers that name other files find them in the same folder.
constexpr const char* HEADERS[] = {
    "attached.nrrd",     "detached.nhdr", "tail.nhdr", "local.mha",      "detached.mhd",     "tail.mhd",
    "gzip.nrrd",         "gzip.nhdr",     "zlib.mha",  "zlib.mhd",       "pattern.nhdr",     "list.nhdr",
    "pattern_gzip.nhdr", "pattern.mhd",   "list.mhd",  "flipped_y.nrrd", "left_handed.nrrd", "flipped_z.mha"};

std::string refusal(const fs::path& path)
{
    return error_of([&] { open_volume(path); });
}

/// `text` with `line` in place of the line of `field` (its name up to the separator); "" removes it.
std::string with_line(std::string text, const std::string& field, const std::string& line)
{
    const size_t begin = ("\n" + text).find("\n" + field);
    REQUIRE(begin != std::string::npos);
    return text.replace(begin, text.find('\n', begin) + 1 - begin, line.empty() ? "" : line + "\n");
}

const std::string NHDR =
    "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nspacings: 1 2 3\nunits: \"um\" \"um\" \"um\"\nencoding: raw\n"
    "data file: a.voxels\n";
const std::string MHD =
    "ObjectType = Image\nNDims = 3\nBinaryData = True\nElementSpacing = 1 2 3\nDimSize = 5 4 3\n"
    "ElementType = MET_UCHAR\nElementDataFile = a.voxels\n";

/// A folder with 60 voxels in a.voxels.
class Folder : public TemporaryFolder {
public:
    Folder() { write("a.voxels", std::string(60, 'v')); }

    std::string nrrd_refusal(const std::string& field, const std::string& line) const
    {
        return refusal(write("a.nhdr", with_line(NHDR, field, line)));
    }
    std::string mhd_refusal(const std::string& field, const std::string& line) const
    {
        return refusal(write("a.mhd", with_line(MHD, field, line)));
    }
    std::unique_ptr<VolumeSource> nrrd(const std::string& field, const std::string& line) const
    {
        return open_volume(write("a.nhdr", with_line(NHDR, field, line)));
    }
    std::unique_ptr<VolumeSource> mhd(const std::string& field, const std::string& line) const
    {
        return open_volume(write("a.mhd", with_line(MHD, field, line)));
    }
};

}  // namespace

TEST_CASE("no format mirrors the chirality phantom, or loses its spacing")
{
    std::vector<std::string> names(std::begin(HEADERS), std::end(HEADERS));
    names.insert(names.end(), {"side_car.raw", "side_car.json", "nsi.raw", "nsi.dat"});
    for (const std::string& name : names) {
        CAPTURE(name);
        const auto source = open_volume(CHIRALITY / name);
        CHECK(is_chirality_phantom(*source));
        CHECK(source->info().spacing == glm::dvec3(0.5, 0.5, 1.25));
        CHECK(source->info().unit == "mm");
    }
    CHECK(is_chirality_phantom(*open_volume(CHIRALITY / "named_5x4x3_int16le.raw")));
    CHECK(open_volume(CHIRALITY / "attached.nrrd")->info().warnings.empty());
    CHECK(open_volume(CHIRALITY / "attached.nrrd")->info().format == "nrrd");
    CHECK(open_volume(CHIRALITY / "local.mha")->info().format == "mhd");
    CHECK(open_volume(CHIRALITY / "local.mha")->info().name == "local.mha");
}

TEST_CASE("a file cut anywhere is an error, or still says the same")
{
    std::vector<std::string> names(std::begin(HEADERS), std::end(HEADERS));
    names.insert(names.end(), {"nsi.dat", "side_car.json", "gzip.voxels", "zlib.zraw"});
    for (const std::string& name : names) {
        CAPTURE(name);
        const TemporaryFolder folder;
        fs::copy(CHIRALITY, folder.path);
        const std::string whole = bytes_of_file(CHIRALITY / name);
        for (size_t length = 0; length < whole.size(); ++length) {
            const fs::path path = folder.write(name, whole.substr(0, length));
            const bool is_header = !name.ends_with(".voxels") && !name.ends_with(".zraw");
            try {
                const auto source =
                    open_volume(is_header ? path : folder.path / (name == "zlib.zraw" ? "zlib.mhd" : "gzip.nhdr"));
                // A header cut before its byte order means little-endian, with a warning.
                const bool is_same = is_chirality_phantom(*source) || warns_of(*source, "no byte order stated");
                CAPTURE(length);
                CHECK(is_same);
            } catch (const Error& error) {
                CHECK((contains(error.what(), "; expected ") || contains(error.what(), ": cannot be opened: ")));
            }
        }
    }
}

TEST_CASE("hostile sizes in a header are refused by field, at once")
{
    const Folder folder;
    const Effort effort;
    for (const char* size :
         {"0 4 3", "-5 4 3", "5 4", "5 4 3 2", "5 4 x", "2147483648 1 1", "4294967296 1 1", "9223372036854775807 1 1",
          "18446744073709551616 1 1", "1e3 1 1", "5.0 4 3", "nan 1 1", ""}) {
        CAPTURE(size);
        CHECK(folder.nrrd_refusal("sizes:", sentence("sizes: ", size)) ==
              sentence((folder.path / "a.nhdr").string(), ": sizes is \"", size,
                       "\"; expected three whole numbers from 1 to 1048576"));
        CHECK(folder.mhd_refusal("DimSize", sentence("DimSize = ", size)) ==
              sentence((folder.path / "a.mhd").string(), ": DimSize is \"", size,
                       "\"; expected three whole numbers from 1 to 1048576"));
    }
    for (const char* size : {"1048576 1048576 1048576", "1048576 1048576 1", "65536 65536 1", "5 4 4"}) {
        CHECK(contains(folder.nrrd_refusal("sizes:", sentence("sizes: ", size)),
                       "a.voxels: holds 60 bytes; expected at least"));
        CHECK(contains(folder.mhd_refusal("DimSize", sentence("DimSize = ", size)),
                       "a.voxels: holds 60 bytes; expected at least"));
    }
    CHECK(effort.is_below(AT_ONCE_BYTES));
}

TEST_CASE("an NRRD that cannot be read says which field, what it found and what it expected")
{
    const Folder folder;
    const std::string at = (folder.path / "a.nhdr").string();
    for (const char* encoding : {"bzip2", "ascii", "txt", "hex"}) {
        CHECK(folder.nrrd_refusal("encoding:", sentence("encoding: ", encoding)) ==
              sentence(at, ": encoding \"", encoding, "\" is not supported; expected raw or gzip"));
    }
    CHECK(folder.nrrd_refusal("encoding:", "encoding: zip") ==
          at + ": encoding \"zip\" is unknown; expected raw or gzip");
    CHECK(folder.nrrd_refusal("encoding:", "encoding: gzip") ==
          (folder.path / "a.voxels").string() +
              ": its compressed data at byte 0 begins as neither gzip nor zlib does; expected one of them");
    CHECK(contains(folder.nrrd_refusal("encoding:", "encoding: gzip\nbyte skip: -1"), "byte skip is \"-1\"; expected"));
    CHECK(folder.nrrd_refusal("encoding:", "") == at + ": encoding is missing; expected raw or gzip");
    CHECK(folder.nrrd_refusal("dimension:", "dimension: 5") ==
          at + ": dimension is \"5\"; expected a whole number from 3 to 4");
    CHECK(contains(folder.nrrd_refusal("dimension:", "dimension: 4"), "sizes is \"5 4 3\"; expected 4 whole numbers"));
    CHECK(folder.nrrd_refusal("dimension:", "") == at + ": dimension is missing; expected 3");
    CHECK(contains(folder.nrrd_refusal("type:", "type: float16"),
                   ": type is \"float16\"; expected integers of 8, 16, 32 or 64 bits, signed or unsigned, or floats"));
    CHECK(folder.nrrd_refusal("type:", "type: short") == at + ": endian is missing; expected little or big");
    CHECK(contains(folder.nrrd_refusal("type:", "type: short\nendian: middle"), ": endian is \"middle\"; expected"));
    CHECK(folder.nrrd_refusal("data file:", "data file: LIST") ==
          at + ": data file names 0 files; expected 3, one for each slice");
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: LIST\na\nb\nc\nd"), "names 4 files; expected 3"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: LIST 3\na\nb"), "that divides the 3 slices"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: LIST 1\na\nb\nc"), "expected 12, one for each row"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: LIST 4\na"),
                   "expected 1, 2 or 3 as the number of axes"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: a.%03d.raw 1 3 1"),
                   "a.001.raw: cannot be opened: No such file"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: a.voxels%d 1 3 0"),
                   "a step that leads from one to the other"));
    CHECK(
        contains(folder.nrrd_refusal("data file:", "data file: a%d 3 1 1"), "a step that leads from one to the other"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: a%d 1 9223372036854775807 1"),
                   "to at most 65536 files"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: a%d%d 1 3 1"), "a pattern with one number"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: a%s 1 3 1"), "a pattern with one number"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: a%999999999d 1 3 1"), "a pattern with one number"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: LIST\na.voxels\na.voxels\nno"),
                   "/no: cannot be opened"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: no"), "/no: cannot be opened: No such file"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: ."), "is a folder; expected a file"));
    CHECK(contains(folder.nrrd_refusal("data file:", ""), "expected one of them"));
    CHECK(contains(folder.nrrd_refusal("spacings:", "spacings: 1 0 1"), "spacings is \"1 0 1\"; expected"));
    CHECK(contains(folder.nrrd_refusal("spacings:", "spacings: 1 inf 1"), "expected"));
    CHECK(contains(folder.nrrd_refusal("spacings:", "spacings: 1 1"), "expected 3 numbers"));
    CHECK(contains(folder.nrrd_refusal("units:", "units: \"um\" \"um\" \"mm\""), "expected one unit for all axes"));
    CHECK(
        contains(folder.nrrd_refusal("type:", "type: uchar\ntype: uchar"), "\"type\" is stated twice; expected once"));
    CHECK(contains(folder.nrrd_refusal("type:", "what is this"), "line 2 is \"what is this\"; expected"));
    CHECK(contains(folder.nrrd_refusal("NRRD", "NRRD0009"), "begins with \"NRRD0009\"; expected NRRD0001 to NRRD0006"));
    CHECK(contains(folder.nrrd_refusal("NRRD", "BRRD0004"), "begins with \"BRRD0004\"; expected"));
    CHECK(contains(folder.nrrd_refusal("type:", "type: uchar\nline skip: 9"),
                   "line skip is \"9\"; expected at most the 0 lines"));
    CHECK(contains(folder.nrrd_refusal("type:", "type: uchar\nbyte skip: -2"), "byte skip is \"-2\"; expected"));
    CHECK(contains(folder.nrrd_refusal("type:", "type: uchar\nbyte skip: 1"), "holds 60 bytes; expected at least 61"));
    CHECK(contains(folder.nrrd_refusal("type:", "type: uchar\nbyte skip: 4611686018427387904"), "expected at least"));
    CHECK(contains(folder.nrrd_refusal("type:", "type: uchar\nbyte skip: 99999999999999999999"), "expected"));
    for (const char* directions :
         {"(1,0,0) (0,1,0)", "none (0,1,0) (0,0,1)", "(1,0) (0,1) (0,0)", "(0,0,0) (0,1,0) (0,0,1)",
          "(1,0,0) (0,1,0) (0,0,1) (1,1,1)", "(1,0,nan) (0,1,0) (0,0,1)", "("}) {
        CAPTURE(directions);
        CHECK(contains(folder.nrrd_refusal("spacings:", sentence("space directions: ", directions)),
                       sentence(": space directions is \"", directions, "\"; expected")));
    }
}

TEST_CASE("spacing, unit and orientation of an NRRD survive, and what changes is said")
{
    const Folder folder;
    const auto plain = open_volume(folder.write("a.nhdr", NHDR));
    CHECK(plain->info().spacing == glm::dvec3(1, 2, 3));
    CHECK(plain->info().unit == "um");
    CHECK(plain->info().warnings.empty());
    CHECK(folder.nrrd("units:", "units: \"micron\" \"µm\" \"micrometers\"")->info().unit == "um");
    CHECK(folder.nrrd("units:", "")->info().unit == "mm");
    CHECK(warns_of(*folder.nrrd("units:", ""), "spacing is stated without a unit; mm assumed"));
    CHECK(warns_of(*folder.nrrd("spacings:", ""), "no spacing stated; 1 voxel assumed"));
    CHECK(folder.nrrd("spacings:", "")->info().unit == "voxel");
    CHECK(warns_of(*folder.nrrd("spacings:", "spacings: nan nan nan"), "no spacing stated"));

    const auto flipped = folder.nrrd("spacings:", "space: LPS\nspace directions: (1,0,0) (0,-2,0) (0,0,3)");
    CHECK(flipped->info().spacing == glm::dvec3(1, 2, 3));
    CHECK(warns_of(*flipped, "axes are left-handed; voxels are taken in reverse order along y"));
    const auto oblique = folder.nrrd("spacings:", "space directions: (0.6,0.8,0) (-1.6,1.2,0) (0,0,3)");
    CHECK(oblique->info().spacing.x == doctest::Approx(1.0));
    CHECK(oblique->info().spacing.y == doctest::Approx(2.0));
    CHECK(warns_of(*oblique, "axes are turned by up to 36.9 degrees against those of their space"));
    CHECK_FALSE(warns_of(*oblique, "mirror"));
    const std::string straight = "space directions: (1,0,0) (0,2,0) (0,0,3)";
    CHECK(folder.nrrd("spacings:", straight)->info().warnings.empty());
    CHECK(warns_of(*folder.nrrd("spacings:", "space: left-anterior-superior\n" + straight), "mirror"));
    const auto sheared = folder.nrrd("spacings:", "space: RAS\nspace directions: (1,0,0) (0.5,2,0) (0,0,3)");
    CHECK(warns_of(*sheared, "axes x and y meet at 76.0 degrees"));
    CHECK(warns_of(*sheared, "against those of the scanner (RAS)"));
    const auto backwards = folder.nrrd("spacings:", "spacings: 1 2 -3");
    CHECK(backwards->info().spacing == glm::dvec3(1, 2, 3));
    CHECK(warns_of(*backwards, "in reverse order along z"));
    CHECK(folder.nrrd("spacings:", "spacings: 1 -2 -3")->info().warnings.empty());  // a rotation by 180 degrees
}

// Kind (Headers): NRRD that states axis mins and maxs
TEST_CASE("axis mins and maxs of an NRRD give the spacing, node-centred or cell-centred")
{
    const Folder folder;
    const auto spacing_of = [&](const std::string& lines, const std::vector<std::string>& warnings) {
        const auto source = folder.nrrd("spacings", lines);
        CHECK(source->info().unit == "um");
        CHECK(source->info().warnings == warnings);
        return source->info().spacing;
    };
    const std::string mins = "axis mins: 0 0 0\n", maxs = "axis maxs: 8 9 8\n";
    CHECK(spacing_of(mins + maxs + "centerings: node node node", {}) == glm::dvec3(2, 3, 4));
    CHECK(spacing_of("axismins: 0 0 0\naxismaxs: 10 12 12\ncenters: cell cell cell", {}) == glm::dvec3(2, 3, 4));
    CHECK(spacing_of("axis mins: 5 0 0\naxis maxs: 15 12 12\ncenterings: cell cell cell",
                     {"axis mins is \"5 0 0\"; without a space only the spacing is taken from it"}) ==
          glm::dvec3(2, 3, 4));
    CHECK(spacing_of(mins + "axis maxs: 10 12 12",
                     {"axis mins and axis maxs are stated without centerings; cells are assumed"}) ==
          glm::dvec3(2, 3, 4));
    CHECK(spacing_of("spacings: 1 2 3\n" + mins + maxs + "centerings: node node node",
                     {"spacings is \"1 2 3\", which axis mins and axis maxs contradict; they are left out"}) ==
          glm::dvec3(1, 2, 3));
    // An axis whose maximum comes first runs backwards.
    CHECK(folder.nrrd("spacings", mins + "axis maxs: 8 9 -8\ncenterings: node node node")->info().spacing ==
          glm::dvec3(2, 3, 4));
    CHECK(contains(folder.nrrd_refusal("spacings", mins + "axis maxs: 8 9 x"), "axis maxs is \"8 9 x\""));
    CHECK(contains(folder.nrrd_refusal("spacings", mins + maxs + "centerings: node node edge"), "centerings is"));
}

// Kind (Headers): a colour picture in NRRD
TEST_CASE("a colour picture in an NRRD is one slice with channels, and no grey volume")
{
    const Folder folder;
    folder.write("p.nhdr",
                 "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 3 5 4\nkinds: RGB-color domain domain\n"
                 "spacings: NaN 0.5 0.25\nunits: \"\" \"mm\" \"mm\"\nencoding: raw\ndata file: a.voxels\n");
    CHECK(contains(error_of([&] { open_volume(folder.path / "p.nhdr"); }), "channel"));
    const auto green = open_volume(folder.path / "p.nhdr", {.channel = "green"});
    CHECK(green->info().size == Size3(5, 4, 1));
    CHECK(green->info().spacing == glm::dvec3(0.5, 0.25, 0.5));
    CHECK(green->info().unit == "mm");
}

// Kind (Headers): NRRD that states the range of its values before they were quantized
TEST_CASE("an NRRD whose values were quantized is read as stored, with a warning of their former range")
{
    const Folder folder;
    const auto source = folder.nrrd("encoding", "old min: -1000\nold max: 3000.5\nencoding: raw");
    CHECK(measure(*source).maximum == 'v');
    CHECK(warns_of(*source,
                   "its values were quantized: old min is -1000 and old max 3000.5; intensities are those stored"));
    CHECK(warns_of(*folder.nrrd("encoding", "oldmax: 7\nencoding: raw"), "oldmin is not stated and oldmax 7"));
}

// Kind (Headers): MetaImage with an intensity function
TEST_CASE("intensity functions of a MetaImage are applied")
{
    const Folder folder;
    const auto of = [&](const std::string& lines) {
        return folder.mhd("ElementSpacing", "ElementSpacing = 1 2 3\n" + lines);
    };
    const std::string slope = "ElementToIntensityFunctionSlope = 2\n",
                      offset = "ElementToIntensityFunctionOffset = -1000";
    const auto whole = of(slope + offset);
    CHECK(measure(*whole).maximum == 2.0 * 'v' - 1000.0);
    CHECK_FALSE(is_float(whole->info().type));
    CHECK(measure(*of("ElementToIntensityFunctionSlope = 0.5")).maximum == 0.5 * 'v');
    CHECK(of("ElementToIntensityFunctionSlope = 1\nElementToIntensityFunctionOffset = 0")->info().type ==
          VoxelType::uint8);
    CHECK(contains(folder.mhd_refusal("ElementSpacing", "ElementToIntensityFunctionSlope = 0"),
                   "ElementToIntensityFunctionSlope is \"0\"; expected a finite number other than 0"));
}

// Kind (Headers): Windows paths to voxels next to the header
TEST_CASE("a header from Windows finds the voxels that lie beside it")
{
    const Folder folder;
    for (const char* name :
         {"C:\\scans\\leaf\\a.voxels", "\\\\server\\share\\a.voxels", "/nowhere/else/a.voxels", "sub\\a.voxels"}) {
        CAPTURE(name);
        CHECK(folder.mhd("ElementDataFile", sentence("ElementDataFile = ", name))->info().size == Size3(5, 4, 3));
        CHECK(folder.nrrd("data file", sentence("data file: ", name))->info().size == Size3(5, 4, 3));
    }
    CHECK(contains(folder.mhd_refusal("ElementDataFile", "ElementDataFile = C:\\scans\\none.voxels"), "none.voxels"));
}

TEST_CASE("axes that run the other way are turned round, and the first voxel stays where it is")
{
    for (const char* name : {"flipped_y.nrrd", "left_handed.nrrd", "flipped_z.mha"}) {
        CAPTURE(name);
        const auto source = open_volume(CHIRALITY / name);
        CHECK(source->info().origin == glm::dvec3(10.0, 20.0, 30.0));
        CHECK(source->info().directions == glm::dmat3(1.0));
        CHECK(warns_of(*source, "mirror"));
        const std::vector<int16_t> whole = voxels_of<int16_t>(*source);
        for (int64_t x = 0; x < 5; ++x) {
            for (int64_t y = 0; y < 4; ++y) {
                for (int64_t z = 0; z < 3; ++z) {
                    const VoxelBox box{{x, y, z}, glm::min(Size3(x + 3, y + 2, z + 2), Size3(5, 4, 3))};
                    CHECK(voxels_in<int16_t>(*source, box)[0] == x + 10 * y + 100 * z - 99);
                    CHECK(voxels_in<int16_t>(*source, box).back() ==
                          box.upper.x - 1 + 10 * (box.upper.y - 1) + 100 * (box.upper.z - 1) - 99);
                }
            }
        }
    }
    CHECK(open_volume(CHIRALITY / "flipped_y.nrrd")->info().frame == "LPS");
    CHECK(open_volume(CHIRALITY / "left_handed.nrrd")->info().frame == "RAS");
}

TEST_CASE("one channel, or one time point, is taken from voxels that have several")
{
    const Folder folder;
    std::string mixed;
    for (int i = 0; i < 60; ++i) mixed += {char(i), char(i + 60), char(i + 120)};
    folder.write("a.voxels", mixed);
    const auto first_of = [](const VolumeSource& source) { return voxels_in<uint8_t>(source, {{1, 2, 1}, {3, 3, 2}}); };
    const auto expected = [](int add) { return std::vector<uint8_t>{uint8_t(31 + add), uint8_t(32 + add)}; };
    const std::string colors =
        with_line(with_line(with_line(NHDR, "sizes:", "sizes: 3 5 4 3\nkinds: RGB-color domain domain domain"),
                            "dimension:", "dimension: 4"),
                  "spacings:", "spacings: nan 1 2 3");
    const fs::path nhdr = folder.write("a.nhdr", with_line(colors, "units:", "units: \"\" \"um\" \"um\" \"um\""));
    CHECK(contains(refusal(nhdr), "holds 3 channels; expected channel to choose one: 1 to 3, red, green, blue"));
    CHECK(first_of(*open_volume(nhdr, {.channel = "Green"})) == expected(60));
    CHECK(first_of(*open_volume(nhdr, {.channel = "3"})) == expected(120));
    CHECK(open_volume(nhdr, {.channel = "3"})->info().spacing == glm::dvec3(1, 2, 3));
    CHECK(open_volume(nhdr, {.channel = "3"})->info().unit == "um");
    CHECK(contains(error_of([&] { open_volume(nhdr, {.channel = "4"}); }), "channel is \"4\"; expected 1 to 3, red"));
    const fs::path mhd = folder.write("a.mhd", with_line(MHD, "NDims", "NDims = 3\nElementNumberOfChannels = 3"));
    CHECK(first_of(*open_volume(mhd, {.channel = "blue"})) == expected(120));

    std::string in_turn;
    for (int i = 0; i < 180; ++i) in_turn += char(i);
    folder.write("a.voxels", in_turn);
    const std::string times = with_line(with_line(NHDR, "sizes:", "sizes: 5 4 3 3"), "dimension:", "dimension: 4");
    const fs::path moving =
        folder.write("t.nhdr", with_line(with_line(times, "units:", ""),
                                         "spacings:", "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1) none"));
    CHECK(contains(refusal(moving), "holds 3 time points; expected frame to choose one: 1 to 3"));
    CHECK(first_of(*open_volume(moving, {.frame = "2"})) == expected(60));
    CHECK_FALSE(warns_of(*open_volume(moving, {.frame = "2"}), "bytes more"));
    folder.write("a.voxels", in_turn.substr(0, 179));
    CHECK(contains(error_of([&] { open_volume(moving, {.frame = "1"}); }), "holds 179 bytes; expected at least 180"));
    CHECK(contains(refusal(folder.write("t.nhdr", times)), "dimension is \"4\"; expected 3, or 4 with kinds"));
}

TEST_CASE("an NRRD is found by its first bytes, whatever its lines end with")
{
    const Folder folder;
    std::string windows;
    for (const char character : NHDR) windows += character == '\n' ? std::string("\r\n") : std::string(1, character);
    CHECK(open_volume(folder.write("header", windows))->info().size == Size3(5, 4, 3));
    const std::string keys = NHDR + "key:=value: 3\nkey:=again\n# comment\nContent: phantom\n";
    CHECK(open_volume(folder.write("header", keys))->info().size == Size3(5, 4, 3));
    const fs::path absolute =
        folder.write("header", with_line(NHDR, "data file:", "data file: " + (folder.path / "a.voxels").string()));
    CHECK(open_volume(absolute)->info().format == "nrrd");
    fs::create_directory(folder.path / "below");
    CHECK(open_volume(folder.write("below/a.nhdr", with_line(NHDR, "data file:", "data file: ../a.voxels")))
              ->info()
              .size.x == 5);
}

TEST_CASE("a MetaImage that cannot be read says which field, what it found and what it expected")
{
    const Folder folder;
    const std::string at = (folder.path / "a.mhd").string();
    CHECK(contains(folder.mhd_refusal("BinaryData", "CompressedData = True"), "begins as neither gzip nor zlib does"));
    CHECK(contains(folder.mhd_refusal("BinaryData", "CompressedData = True\nHeaderSize = -1"),
                   "HeaderSize is \"-1\"; expected"));
    CHECK(contains(folder.mhd_refusal("BinaryData", "BinaryData = False"), "BinaryData is \"False\"; expected True"));
    CHECK(contains(folder.mhd_refusal("BinaryData", "BinaryData = maybe"), "expected True or False"));
    CHECK(folder.mhd_refusal("ObjectType", "ObjectType = Scene\nObjectType = Tube") ==
          at + ": ObjectType is \"Scene\"; expected Image");
    CHECK(folder.mhd_refusal("NDims", "NDims = 2") == at + ": NDims is \"2\"; expected 3");
    CHECK(folder.mhd_refusal("NDims", "") == at + ": NDims is missing; expected 3");
    CHECK(contains(folder.mhd_refusal("NDims", "NDims = 3\nElementNumberOfChannels = 3"),
                   "a.mhd: holds 3 channels; expected channel to choose one: 1 to 3, red, green, blue"));
    CHECK(contains(folder.mhd_refusal("ElementType", "ElementType = MET_LONG_DOUBLE"),
                   "ElementType is \"MET_LONG_DOUBLE\"; expected"));
    CHECK(contains(folder.mhd_refusal("ElementType", ""), "ElementType is missing; expected"));
    CHECK(contains(folder.mhd_refusal("ElementDataFile", ""), "ElementDataFile is missing; expected"));
    CHECK(contains(folder.mhd_refusal("ElementDataFile", "ElementDataFile = LIST"),
                   "ElementDataFile names 0 files; expected 3, one for each slice"));
    CHECK(folder.mhd_refusal("ElementDataFile", "ElementDataFile = LIST 3D\na.voxels").empty());
    CHECK(contains(folder.mhd_refusal("ElementDataFile", "ElementDataFile = a%03d.raw 1 3 1"),
                   "a001.raw: cannot be opened: No such file"));
    CHECK(contains(folder.mhd_refusal("ElementDataFile", "ElementDataFile = LOCAL"), " bytes; expected at least"));
    CHECK(contains(folder.mhd_refusal("ElementDataFile", "ElementDataFile ="), "expected the name of a file"));
    CHECK(contains(folder.mhd_refusal("ElementSpacing", "ElementSpacing = 1 nan 1"),
                   "expected 3 finite numbers above 0"));
    CHECK(
        contains(folder.mhd_refusal("ElementSpacing", "ElementSpacing = 1 -1 1"), "expected 3 finite numbers above 0"));
    CHECK(contains(folder.mhd_refusal("NDims", "NDims = 3\nHeaderSize = -2"), "HeaderSize is \"-2\"; expected"));
    CHECK(contains(folder.mhd_refusal("NDims", "no separator"), "line 2 is \"no separator\"; expected"));
    CHECK(contains(folder.mhd_refusal("NDims", "NDims = 3\nTransformMatrix = 1 0 0"), "expected 9 numbers"));
}

TEST_CASE("spacing, byte order and orientation of a MetaImage survive, and what is assumed is said")
{
    const Folder folder;
    const auto plain = open_volume(folder.write("a.mhd", MHD));
    CHECK(plain->info().spacing == glm::dvec3(1, 2, 3));
    CHECK(plain->info().unit == "mm");
    CHECK(warns_of(*plain, "spacing is stated without a unit; mm assumed"));
    CHECK(folder.mhd("ElementSpacing", "ElementSize = 4 5 6")->info().spacing == glm::dvec3(4, 5, 6));
    CHECK(folder.mhd("ElementSpacing", "ElementSize = 9 9 9\nElementSpacing = 4 5 6")->info().spacing ==
          glm::dvec3(4, 5, 6));
    CHECK(folder.mhd("ElementSpacing", "ElementSpacing = 1 1 1")->info().unit == "voxel");
    CHECK(folder.mhd("BinaryData", "DistanceUnits = um")->info().unit == "um");
    CHECK(warns_of(*folder.mhd("ElementSpacing", ""), "no spacing stated"));
    const auto turned = folder.mhd("BinaryData", "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 7 8 9");
    CHECK(turned->info().warnings.size() == 1);  // a quarter turn needs no warning
    CHECK(turned->info().directions[0] == glm::dvec3(0, 1, 0));
    CHECK(turned->info().directions[1] == glm::dvec3(-1, 0, 0));
    CHECK(turned->info().origin == glm::dvec3(7, 8, 9));
    CHECK(turned->info().frame.empty());
    CHECK(folder.mhd("BinaryData", "AnatomicalOrientation = RAI")->info().frame == "LPS");
    CHECK(folder.mhd("BinaryData", "AnatomicalOrientation = ???")->info().frame.empty());
    CHECK(warns_of(*folder.mhd("BinaryData", "TransformMatrix = 1 0 0 0 1 0 0 0 -1"), "mirror image"));
    CHECK(warns_of(*folder.mhd("BinaryData", "TransformMatrix = 1 0 0 0 0.8 0.6 0 -0.6 0.8"), "turned by up to 36.9"));

    folder.write("a.voxels", std::string(60, '\1') + std::string(60, '\2'));
    const std::string shorts = "ElementType = MET_USHORT\nHeaderSize = 59\nDimSize = 1 1 1\n";
    const auto header = [&](const std::string& order) {
        return with_line(with_line(MHD, "DimSize", ""), "ElementType", shorts + order);
    };
    CHECK(voxels_of<uint16_t>(*open_volume(folder.write("a.mhd", header("ElementByteOrderMSB = True"))))[0] == 0x0102);
    CHECK(voxels_of<uint16_t>(*open_volume(folder.write("a.mhd", header("BinaryDataByteOrderMSB = False"))))[0] ==
          0x0201);
    CHECK(warns_of(*open_volume(folder.write("a.mhd", header("Comment = none"))), "no byte order stated"));
}

TEST_CASE("control characters of a header reach neither a unit nor the name of a file")
{
    const Folder folder;
    CHECK(folder.nrrd("units:", "units: \"u\x1bm\" \"u\x1bm\" \"u\x1bm\"")->info().unit == "u?m");
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: a\x1b[2J.voxels"),
                   ": data file is \"a?[2J.voxels\"; expected the name of a file"));
    CHECK(contains(folder.mhd_refusal("ElementDataFile", "ElementDataFile = a\x7f.voxels"),
                   "expected the name of a file"));
}

TEST_CASE("axes that lie in one plane are left out, and it is said")
{
    const Folder folder;
    const auto source = open_volume(folder.write("flat.mhd", "TransformMatrix = 1 0 0 0 1 0 1 1 0\n" + MHD));
    CHECK(source->info().directions == glm::dmat3(1.0));
    CHECK(source->info().spacing == glm::dvec3(1, 2, 3));
    CHECK(warns_of(*source, "axes span no volume; orientation was left out"));
}

TEST_CASE("a spacing with which nothing can be computed is refused")
{
    const Folder folder;
    CHECK(contains(folder.nrrd_refusal("spacings:", "spacings: 1e-320 1 1"), "expected 3 finite numbers other than 0"));
    CHECK(contains(folder.nrrd_refusal("spacings:", "spacings: 1 1 1e-13"),
                   ": spacing along z is 1e-13 um; expected 1e-12 to 1e+12"));
    CHECK(contains(folder.mhd_refusal("ElementSpacing", "ElementSpacing = 1 1e13 1"),
                   ": spacing along y is 1e+13 mm; expected 1e-12 to 1e+12"));
}

TEST_CASE("bare voxels open by the header that names them")
{
    const Folder folder;
    folder.write("a.raw", std::string(60, 'v'));
    folder.write("a.nhdr", with_line(NHDR, "data file:", "data file: a.raw"));
    CHECK(open_volume(folder.path / "a.raw")->info().format == "nrrd");
    folder.write("a.nhdr", NHDR);
    CHECK(contains(refusal(folder.path / "a.raw"), "no file beside it"));
    folder.write("a.mhd", with_line(MHD, "ElementDataFile", "ElementDataFile = a.raw"));
    CHECK(open_volume(folder.path / "a.raw")->info().format == "mhd");
}

TEST_CASE("headers of noise are refused, with nothing but printable characters in the sentence")
{
    const TemporaryFolder folder;
    uint32_t state = 12345;  // seed
    for (int i = 0; i < 300; ++i) {
        std::string noise = i % 3 == 0 ? "NRRD0005\n" : i % 3 == 1 ? "NDims = 3\n" : "Resolution: 5 4 3\n";
        for (int j = 0; j < 200; ++j) {
            state = state * 1664525u + 1013904223u;
            noise += j % 7 == 0 ? ":= \n"[state >> 30] : char(state >> 24);
        }
        const std::string said = refusal(folder.write("noise.dat", noise));
        REQUIRE(!said.empty());
        CHECK(std::none_of(said.begin(), said.end(), [](char character) {
            return static_cast<unsigned char>(character) < 0x20 || character == 0x7f;
        }));
    }
}
