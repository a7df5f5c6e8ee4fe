#include <algorithm>
#include <chrono>

#include <doctest/doctest.h>

#include "engine/volume/open_volume.h"
#include "tests/unit/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

const fs::path CHIRALITY = "tests/data/chirality";  // tests run in the repository's root

bool is_chirality_phantom(const VolumeSource& source)
{
    if (source.info().size != Size3(5, 4, 3) || source.info().type != VoxelType::int16) return false;
    const std::vector<int16_t> voxels = voxels_of<int16_t>(source);
    for (int i = 0; i < 60; ++i) {
        if (voxels[static_cast<size_t>(i)] != i % 5 + 10 * (i / 5 % 4) + 100 * (i / 20) - 99) return false;
    }
    return true;
}

std::string bytes_of_file(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string refusal(const fs::path& path)
{
    return error_of([&] { open_volume(path); });
}

/// `text` with the line of `field` (its name up to the separator) exchanged for `line`; "" takes it out.
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
    for (const char* name : {"attached.nrrd", "detached.nhdr", "tail.nhdr", "local.mha", "detached.mhd", "tail.mhd",
                             "side_car.raw", "side_car.json", "nsi.raw", "nsi.dat"}) {
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
    for (const char* name : {"attached.nrrd", "detached.nhdr", "tail.nhdr", "local.mha", "detached.mhd", "tail.mhd",
                             "nsi.dat", "side_car.json"}) {
        CAPTURE(name);
        const TemporaryFolder folder;
        fs::copy(CHIRALITY, folder.path);
        const std::string whole = bytes_of_file(CHIRALITY / name);
        for (size_t length = 0; length < whole.size(); ++length) {
            const fs::path path = folder.write(name, whole.substr(0, length));
            try {
                const auto source = open_volume(path);
                CAPTURE(length);
                CHECK(is_chirality_phantom(*source));
            } catch (const Error& error) {
                CHECK((contains(error.what(), "; expected ") || contains(error.what(), ": cannot be opened: ")));
            }
        }
    }
}

TEST_CASE("hostile sizes in a header are refused by field, at once")
{
    const Folder folder;
    const auto start = std::chrono::steady_clock::now();
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
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::milliseconds(500));
}

TEST_CASE("an NRRD that cannot be read says which field, what it found and what it expected")
{
    const Folder folder;
    const std::string at = (folder.path / "a.nhdr").string();
    CHECK(folder.nrrd_refusal("encoding:", "encoding: gzip") ==
          at + ": encoding \"gzip\" is not supported yet; expected raw");
    CHECK(folder.nrrd_refusal("encoding:", "") == at + ": encoding is missing; expected raw");
    CHECK(folder.nrrd_refusal("dimension:", "dimension: 4") == at + ": dimension is \"4\"; expected 3");
    CHECK(folder.nrrd_refusal("dimension:", "") == at + ": dimension is missing; expected 3");
    CHECK(contains(folder.nrrd_refusal("type:", "type: longlong"),
                   ": type is \"longlong\"; expected integers of 8, 16 or 32 bits, signed or unsigned, or floats"));
    CHECK(folder.nrrd_refusal("type:", "type: short") == at + ": endian is missing; expected little or big");
    CHECK(contains(folder.nrrd_refusal("type:", "type: short\nendian: middle"), ": endian is \"middle\"; expected"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: LIST"),
                   "spread over several files are not supported yet"));
    CHECK(contains(folder.nrrd_refusal("data file:", "data file: a.%03d.raw 1 3 1"), "spread over several files"));
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
    CHECK(warns_of(*flipped, "axis y runs against its space direction"));
    CHECK(warns_of(*flipped, "shown as its mirror image"));
    const auto oblique = folder.nrrd("spacings:", "space directions: (0.6,0.8,0) (-1.6,1.2,0) (0,0,3)");
    CHECK(oblique->info().spacing.x == doctest::Approx(1.0));
    CHECK(oblique->info().spacing.y == doctest::Approx(2.0));
    CHECK(warns_of(*oblique, "oblique"));
    CHECK_FALSE(warns_of(*oblique, "mirror"));
    const std::string straight = "space directions: (1,0,0) (0,2,0) (0,0,3)";
    CHECK(folder.nrrd("spacings:", straight)->info().warnings.empty());
    CHECK(warns_of(*folder.nrrd("spacings:", "space: left-anterior-superior\n" + straight), "mirror"));
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
    CHECK(folder.mhd_refusal("BinaryData", "CompressedData = True") ==
          at + ": CompressedData is \"True\"; expected False: compressed voxels are not supported yet");
    CHECK(contains(folder.mhd_refusal("BinaryData", "BinaryData = False"), "BinaryData is \"False\"; expected True"));
    CHECK(contains(folder.mhd_refusal("BinaryData", "BinaryData = maybe"), "expected True or False"));
    CHECK(folder.mhd_refusal("ObjectType", "ObjectType = Scene\nObjectType = Tube") ==
          at + ": ObjectType is \"Scene\"; expected Image");
    CHECK(folder.mhd_refusal("NDims", "NDims = 2") == at + ": NDims is \"2\"; expected 3");
    CHECK(folder.mhd_refusal("NDims", "") == at + ": NDims is missing; expected 3");
    CHECK(contains(folder.mhd_refusal("NDims", "NDims = 3\nElementNumberOfChannels = 3"),
                   "ElementNumberOfChannels is \"3\"; expected 1"));
    CHECK(contains(folder.mhd_refusal("ElementType", "ElementType = MET_LONG_LONG"),
                   "ElementType is \"MET_LONG_LONG\"; expected"));
    CHECK(contains(folder.mhd_refusal("ElementType", ""), "ElementType is missing; expected"));
    CHECK(contains(folder.mhd_refusal("ElementDataFile", ""), "ElementDataFile is missing; expected"));
    CHECK(contains(folder.mhd_refusal("ElementDataFile", "ElementDataFile = LIST"), "spread over several files"));
    CHECK(contains(folder.mhd_refusal("ElementDataFile", "ElementDataFile = a%03d.raw 1 3 1"),
                   "spread over several files"));
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
    CHECK(warns_of(*folder.mhd("BinaryData", "TransformMatrix = 0 1 0 -1 0 0 0 0 1"), "not the identity"));
    CHECK(warns_of(*folder.mhd("BinaryData", "TransformMatrix = 1 0 0 0 1 0 0 0 -1"), "mirror image"));
    CHECK_FALSE(warns_of(*folder.mhd("BinaryData", "TransformMatrix = 1 0 0 0 1 0 0 0 1"), "identity"));

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

TEST_CASE("bare voxels open by the header that names them")
{
    const Folder folder;
    folder.write("a.raw", std::string(60, 'v'));
    folder.write("a.nhdr", with_line(NHDR, "data file:", "data file: a.raw"));
    CHECK(open_volume(folder.path / "a.raw")->info().format == "nrrd");
    folder.write("a.nhdr", NHDR);
    CHECK(contains(refusal(folder.path / "a.raw"), "nothing beside it"));
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
            noise += j % 7 == 0 ? ":= \n"[state >> 30] : static_cast<char>(state >> 24);
        }
        const std::string said = refusal(folder.write("noise.dat", noise));
        REQUIRE(!said.empty());
        CHECK(std::none_of(said.begin(), said.end(), [](char character) {
            return static_cast<unsigned char>(character) < 0x20 || character == 0x7f;
        }));
    }
}
