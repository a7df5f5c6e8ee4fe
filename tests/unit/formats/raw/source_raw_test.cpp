#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

/// Random voxels of one type, in the byte order of files.
template <class T>
struct Sample {
    std::vector<T> voxels;
    std::string file;
};

template <class T>
Sample<T> sample_of(size_t count, bool big_endian)
{
    Sample<T> sample;
    std::mt19937 random(1);  // seed 1
    for (size_t i = 0; i < count; ++i) {
        const auto bits = uint32_t(random());
        T voxel;
        if constexpr (std::is_floating_point_v<T>) {
            voxel = static_cast<T>(bits) / T{1000} - T{5e5};
        } else {
            voxel = static_cast<T>(bits);
        }
        sample.voxels.push_back(voxel);
        std::string bytes(reinterpret_cast<const char*>(&voxel), sizeof(T));
        if (big_endian) std::reverse(bytes.begin(), bytes.end());
        sample.file += bytes;
    }
    return sample;
}

std::string refusal(const fs::path& path)
{
    return error_of([&] { open_volume(path); });
}

/// 5 x 4 x 3 bytes, each with a distinct value: any mirrored or exchanged axis shows.
std::string marked_bytes()
{
    std::string bytes;
    for (int i = 0; i < 60; ++i) bytes += char(i + 1);
    return bytes;
}

void check_marked(const VolumeSource& source)
{
    REQUIRE(source.info().size == Size3(5, 4, 3));
    REQUIRE(source.info().type == VoxelType::uint8);
    const std::vector<uint8_t> voxels = voxels_of<uint8_t>(source);
    for (size_t i = 0; i < voxels.size(); ++i) CHECK(voxels[i] == i + 1);
}

constexpr const char* SIDE_CAR = R"({"size": [5, 4, 3], "type": "uint8", "spacing": [1, 2, 3.5], "unit": "um"})";

}  // namespace

TEST_CASE("every type and byte order comes back from a raw file as it was written")
{
    const TemporaryFolder folder;
    const auto check = [&]<class T>(VoxelType type, T) {
        for (const bool big_endian : {false, true}) {
            for (const int64_t offset : {0, 13}) {
                const Sample<T> sample = sample_of<T>(105, big_endian);
                const fs::path path = folder.write("a.raw", std::string(size_t(offset), '?') + sample.file);
                const auto source = open_raw(path, {{7, 5, 3}, type, big_endian, offset});
                CHECK(source->info().type == type);
                CHECK(source->info().format == "raw");
                CHECK(source->info().name == "a.raw");
                CHECK(voxels_of<T>(*source) == sample.voxels);
            }
        }
    };
    check(VoxelType::uint8, uint8_t{});
    check(VoxelType::int8, int8_t{});
    check(VoxelType::uint16, uint16_t{});
    check(VoxelType::int16, int16_t{});
    check(VoxelType::uint32, uint32_t{});
    check(VoxelType::int32, int32_t{});
    check(VoxelType::float32, float{});
    check(VoxelType::float64, double{});
}

TEST_CASE("any box of a raw file is what the whole holds there, from several threads too")
{
    const TemporaryFolder folder;
    const Size3 size(9, 7, 5);
    const Sample<uint16_t> sample = sample_of<uint16_t>(315, true);
    const auto source = open_raw(folder.write("a.raw", sample.file), {size, VoxelType::uint16, true});
    const auto check_boxes = [&](unsigned seed) {
        std::mt19937 random(seed);
        size_t wrong = 0;
        for (int i = 0; i < 200; ++i) {
            VoxelBox box;
            for (int axis = 0; axis < 3; ++axis) {
                const auto side = unsigned(size[axis]);
                const bool whole = random() % 3 == 0;
                box.lower[axis] = whole ? 0 : random() % side;
                box.upper[axis] = whole ? side : box.lower[axis] + 1 + random() % (side - unsigned(box.lower[axis]));
            }
            const std::vector<uint16_t> found = voxels_in<uint16_t>(*source, box);
            size_t at = 0;
            for (int64_t z = box.lower.z; z < box.upper.z; ++z) {
                for (int64_t y = box.lower.y; y < box.upper.y; ++y) {
                    for (int64_t x = box.lower.x; x < box.upper.x; ++x) {
                        wrong += found[at++] != sample.voxels[size_t(x + size.x * (y + size.y * z))];
                    }
                }
            }
        }
        return wrong;
    };
    size_t wrong[3] = {};
    {
        std::vector<std::jthread> threads;
        for (unsigned i = 0; i < 3; ++i) threads.emplace_back([&, i] { wrong[i] = check_boxes(i); });
    }
    CHECK(wrong[0] + wrong[1] + wrong[2] == 0);
}

TEST_CASE("a raw layout is read from its text")
{
    const RawLayout plain = parse_raw_layout("256x255x108:int16");
    CHECK(plain.size == Size3(256, 255, 108));
    CHECK(plain.type == VoxelType::int16);
    CHECK_FALSE(plain.big_endian);
    CHECK(plain.offset_bytes == 0);
    CHECK(parse_raw_layout("1x1x1048576:float32:big").big_endian);
    CHECK(parse_raw_layout("1x2x3:uint8:little:512").offset_bytes == 512);
    CHECK(parse_raw_layout("1x2x3:uint8:7").offset_bytes == 7);
}

TEST_CASE("a raw layout that is none is refused with the expected form")
{
    for (const char* text :
         {"", ":", "1x2:uint8", "1x2x3", "1x2x3:", "1x2x3:int64", "1x2x3x4:uint8", "1x2x3:uint8:middle",
          "1x2x3:uint8:-1", "1x2x3:uint8:big:big", "1x2x3:uint8:1:big", "1x2x3:uint8:big:1:2", "ax2x3:uint8",
          "1 x2x3:uint8", "1x2x3.5:uint8", "1x2x99999999999999999999:uint8", "0x1x2x3:uint8"}) {
        CAPTURE(text);
        CHECK_THROWS_AS(parse_raw_layout(text), UsageError);
        CHECK(contains(error_of([&] { parse_raw_layout(text); }), "expected WxHxD:TYPE[:big|little][:OFFSET]"));
    }
    CHECK(error_of([] { parse_raw_layout("4x0x4:uint8"); }) ==
          "raw layout \"4x0x4:uint8\": size along y is 0; expected 1 to 1048576");
    CHECK(contains(error_of([] { parse_raw_layout("4x4x2147483648:uint8"); }), "size along z is 2147483648; expected"));
}

TEST_CASE("a raw file of the wrong length is refused or said to be longer")
{
    const TemporaryFolder folder;
    const fs::path path = folder.write("a.raw", std::string(100, 'x'));
    CHECK(error_of([&] {
              open_raw(path, {{5, 7, 3}, VoxelType::uint8});
          }) == path.string() + ": holds 100 bytes; expected at least 105 for 5x7x3 voxels of uint8");
    CHECK(error_of([&] {
              open_raw(path, {{5, 5, 2}, VoxelType::uint16, false, 1});
          }) ==
          path.string() + ": holds 100 bytes; expected at least 101 for 5x5x2 voxels of uint16 after a header of 1");
    CHECK(warns_of(*open_raw(path, {{5, 5, 3}, VoxelType::uint8}), "25 bytes more"));
    CHECK(warns_of(*open_raw(path, {{5, 5, 4}, VoxelType::uint8}), "no spacing stated"));
    CHECK(open_raw(path, {{5, 5, 4}, VoxelType::uint8, false, 0, glm::dvec3(2.0), "um"})->info().warnings.empty());
}

TEST_CASE("what counts as at once sees bytes that are read and memory that is touched")
{
    const TemporaryFolder folder;
    const size_t bytes = AT_ONCE_BYTES + 1;
    const fs::path path = folder.write("a.raw", std::string(bytes, 'x'));
    const Effort reading;
    std::ifstream file(path, std::ios::binary);
    std::array<char, 4096> some;
    while (file.read(some.data(), some.size())) {
    }
    CHECK(reading.bytes_read() >= int64_t(bytes));
    CHECK_FALSE(reading.is_below(AT_ONCE_BYTES));

    const Effort touching;
    const std::vector<std::byte> voxels(bytes, std::byte(1));
    CHECK(std::ranges::count(voxels, std::byte(1)) == int64_t(bytes));
    CHECK_FALSE(touching.is_below(AT_ONCE_BYTES));
}

TEST_CASE("a raw layout larger than any file is refused at once")
{
    const TemporaryFolder folder;
    const fs::path path = folder.write("a.raw", std::string(1024, 'x'));
    const Effort effort;
    const int64_t side = int64_t{1} << 20;
    CHECK(contains(error_of([&] {
                       open_raw(path, {Size3(side), VoxelType::float32});
                   }),
                   "holds 1024 bytes; expected at least 4611686018427387904 for"));
    CHECK(contains(error_of([&] {
                       open_raw(path, {Size3(side), VoxelType::float32, false, int64_t{1} << 62});
                   }),
                   "offset is 4611686018427387904; expected"));
    CHECK(contains(error_of([&] {
                       open_raw(path, {{2048, 2048, 1024}, VoxelType::uint16});
                   }),
                   "holds 1024 bytes; expected at least 8589934592 for"));
    CHECK(contains(error_of([&] {
                       open_raw(path, {{0, 1, 1}, VoxelType::uint8});
                   }),
                   "a.raw: size along x is 0; expected"));
    CHECK(effort.is_below(AT_ONCE_BYTES));
}

TEST_CASE("a raw file cut short while it is open is an error, not a signal")
{
    const TemporaryFolder folder;
    const fs::path path = folder.write("a.raw", std::string(262144, 'x'));
    const auto source = open_raw(path, {Size3(64), VoxelType::uint8});
    fs::resize_file(path, 1000);
    CHECK(error_of([&] { voxels_of<uint8_t>(*source); }) ==
          path.string() + ": ended after 1000 bytes; expected 262144: it was truncated while open");
    CHECK(voxels_in<uint8_t>(*source, {Size3(0), Size3(8, 8, 1)}) == std::vector<uint8_t>(64, 'x'));
    fs::remove(path);
    CHECK(voxels_in<uint8_t>(*source, {Size3(0), Size3(8, 8, 1)}) == std::vector<uint8_t>(64, 'x'));
}

TEST_CASE("numbered files of one slice each are a volume, from the first one or from their folder")
{
    const TemporaryFolder folder;
    const std::string bytes = marked_bytes();
    const RawLayout layout{{5, 4, 3}, VoxelType::uint8, false, 2};
    const std::pair<std::vector<std::string>, std::string> series[] = {
        {{"quarter.9", "quarter.10", "quarter.11"}, "a"},
        {{"s007x2.raw", "s007x3.raw", "s007x4.raw"}, "b"},
        {{"s_099_8bit.raw", "s_100_8bit.raw", "s_101_8bit.raw"}, "c"},
        {{"098", "099", "100"}, "d"},
    };
    for (const auto& [names, below] : series) {
        CAPTURE(below);
        fs::create_directory(folder.path / below);
        folder.write(below + "/read me 12.txt", "not a slice");
        for (size_t z = 0; z < 3; ++z) folder.write(below + "/" + names[z], "--" + bytes.substr(20 * z, 20));
        check_marked(*open_raw(folder.path / below, layout));
        CHECK(warns_of(*open_raw(folder.path / below, layout),
                       "3 files, " + names[0] + " to " + names[2] + ", were read as slices"));
        if (below != "c") check_marked(*open_raw(folder.path / below / names[0], layout));
    }
    CHECK(contains(error_of([&] { open_raw(folder.path / "a/quarter.10", layout); }), "quarter.12: cannot be opened"));
    CHECK(contains(error_of([&] {
                       open_raw(folder.path / "a", {{5, 4, 4}, VoxelType::uint8, false, 2});
                   }),
                   "is a folder with 3 files of 22 bytes; expected 4 files, one for each slice"));
    folder.write("a/quarter.11", "short");
    CHECK(contains(error_of([&] { open_raw(folder.path / "a/quarter.9", layout); }),
                   "quarter.11: holds 5 bytes; expected 22, the size of one slice, as in quarter.9"));
}

TEST_CASE("where nobody states the byte order, what neighbours suggest is said, as a guess")
{
    const TemporaryFolder folder;
    std::string little;
    std::string big;
    for (int i = 0; i < 40 * 30 * 20; ++i) {
        const int voxel = 1000 + 7 * (i % 40) + 3 * (i / 40 % 30);
        little += {char(voxel % 256), char(voxel / 256)};
        big += {char(voxel / 256), char(voxel % 256)};
    }
    const RawLayout layout{{40, 30, 20}, VoxelType::uint16};
    const auto plain = open_raw(folder.write("a.raw", little), layout);
    CHECK(warns_of(*plain, "no byte order stated; little-endian assumed"));
    CHECK_FALSE(warns_of(*plain, "guess"));
    const auto other = open_raw(folder.write("a.raw", big), layout);
    CHECK(warns_of(*other,
                   "little-endian assumed, though neighbouring voxels are more alike as big-endian, which is a guess"));
    CHECK(voxels_of<uint16_t>(*other)[0] == 0xe803);  // the guess does not change voxels
    CHECK_FALSE(warns_of(*open_raw(folder.path / "a.raw", {{40, 30, 20}, VoxelType::uint16, true}), "byte order"));
    CHECK(warns_of(*open_volume(folder.write("b_40x30x20.raw", big)), "which is a guess"));
}

TEST_CASE("what is no file is refused in words, without waiting")
{
    const TemporaryFolder folder;
    const fs::path fifo = folder.path / "fifo.raw";
    REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
    const fs::path zero = folder.path / "zero.raw";
    fs::create_symlink("/dev/zero", zero);
    const RawLayout layout{{2, 2, 2}, VoxelType::uint8};
    for (const fs::path& path : {fifo, zero}) {
        CHECK(refusal(path) == path.string() + ": is a pipe or device; expected a file");
        CHECK(error_of([&] { open_raw(path, layout); }) == path.string() + ": is a pipe or device; expected a file");
    }
    CHECK(contains(refusal(folder.path), ": is a folder without shvr/session.json and without a volume; expected"));
    CHECK(contains(refusal(folder.path), ", or slices of bare voxels with --raw WxHxD:TYPE"));
    CHECK(error_of([&] { open_raw(folder.path, layout); }) ==
          folder.path.string() + ": is a folder with 0 files of 4 bytes; expected 2 files, one for each slice");
    const fs::path missing = folder.path / "missing.raw";
    CHECK(refusal(missing) == missing.string() + ": cannot be opened: No such file or directory");
    CHECK(contains(refusal(folder.path / std::string(300, 'n')), "cannot be opened: File name too long"));
}

TEST_CASE("names with spaces and other alphabets are names like any other")
{
    const TemporaryFolder folder;
    const fs::path path = folder.write("Blüte 5x4x3 8bit.raw", marked_bytes());
    check_marked(*open_volume(path));
    CHECK(open_volume(path)->info().name == "Blüte 5x4x3 8bit.raw");
}

TEST_CASE("a raw file with nothing beside it says how to open it")
{
    const TemporaryFolder folder;
    const fs::path path = folder.write("a.raw", marked_bytes());
    CHECK(refusal(path) == path.string() +
                               ": holds bare voxels, and no file beside it states their size and type; expected --raw "
                               "WxHxD:TYPE, as in --raw 512x512x300:uint16:little:0");
    const fs::path other = folder.write("a.xyz", marked_bytes());
    CHECK(refusal(other) ==
          other.string() +
              ": is in no format known here; expected OME-Zarr, TIFF, NRRD, MetaImage, NIfTI, DICOM, PNG, BMP, JPEG, "
              "RAW with a side-car, or bare voxels with --raw WxHxD:TYPE");
}

TEST_CASE("a raw file opens by the JSON beside it, and the JSON opens the raw file")
{
    const TemporaryFolder folder;
    const fs::path raw = folder.write("a.raw", marked_bytes());
    for (const char* name : {"a.json", "a.raw.json"}) {
        const fs::path side_car = folder.write(name, SIDE_CAR);
        for (const fs::path& path : {raw, side_car}) {
            const auto source = open_volume(path);
            check_marked(*source);
            CHECK(source->info().name == "a.raw");
            CHECK(source->info().spacing == glm::dvec3(1, 2, 3.5));
            CHECK(source->info().unit == "um");
            CHECK(source->info().warnings.empty());
        }
        fs::remove(side_car);
    }
    const Sample<int16_t> sample = sample_of<int16_t>(60, true);
    folder.write("b.raw", "12" + sample.file);
    const auto source =
        open_volume(folder.write("b.json", R"({"size": [5, 4, 3], "type": "int16", "endian": "big", "offset": 2})"));
    CHECK(voxels_of<int16_t>(*source) == sample.voxels);
    CHECK(warns_of(*source, "no spacing stated; 1 voxel assumed"));
}

TEST_CASE("a JSON side-car is read strictly")
{
    const TemporaryFolder folder;
    folder.write("a.raw", marked_bytes());
    const auto refused = [&](const std::string& text) { return refusal(folder.write("a.json", text)); };
    const std::string at = (folder.path / "a.json").string();
    CHECK(refused(R"({"size": [5,4,3], "type": "uint8", "spaceing": [1,1,1]})") ==
          at + ": unknown key spaceing; expected one of: size, type, endian, offset, spacing, unit");
    CHECK(refused(R"({"size": [5,4], "type": "uint8"})") ==
          at + ": key size is [5,4]; expected three whole numbers, [x, y, z]");
    CHECK(refused(R"({"size": [5,4,3]})") == at + ": key type is missing; expected " + VOXEL_TYPE_NAMES);
    CHECK(refused(R"({"type": "uint8"})") == at + ": key size is missing; expected three whole numbers, [x, y, z]");
    CHECK(contains(refused("{"), "is not JSON: "));
    const std::string deep = std::string(200'000, '[') + std::string(200'000, ']');
    CHECK(refused(R"({"size": )" + deep + "}") == at + ": JSON nests deeper than 64 levels; expected size and type");
    CHECK(contains(refused("[]"), "is in no format known here"));
    CHECK(contains(refused(R"({"shvr_session": 1})"), "is in no format known here"));
    for (const char* bad : {R"("size": [0,4,3])",
                            R"("size": [-5,4,3])",
                            R"("size": [5.5,4,3])",
                            R"("size": [2147483648,4,3])",
                            R"("size": [9223372036854775808,4,3])",
                            R"("size": [1e999,4,3])",
                            R"("size": "5x4x3")",
                            R"("type": 8)",
                            R"("type": "int64")",
                            R"("endian": "middle")",
                            R"("endian": 1)",
                            R"("offset": -1)",
                            R"("offset": 1.5)",
                            R"("offset": 9223372036854775807)",
                            R"("spacing": [1,1])",
                            R"("spacing": [1,1,0])",
                            R"("spacing": [1,1,-2])",
                            R"("spacing": 1)",
                            R"("spacing": [1,1,"1"])",
                            R"("unit": 3)"}) {
        const std::string key(std::string_view(bad).substr(1, std::string_view(bad).find('"', 1) - 1));
        CAPTURE(bad);
        const std::string start = key == "size" ? R"({"type": "uint8", )" : R"({"size": [5,4,3], )";
        const std::string said = refused(start + bad + "}");
        CHECK((said.starts_with(sentence(at, ": key ", key)) || contains(said, "is not JSON: ")));
        CHECK(contains(said, "expected"));
    }
}

TEST_CASE("a JSON side-car cut anywhere is an error or says the same")
{
    const TemporaryFolder folder;
    folder.write("a.raw", marked_bytes());
    const std::string whole = SIDE_CAR;
    for (size_t length = 0; length < whole.size(); ++length) {
        CHECK(refusal(folder.write("a.json", whole.substr(0, length))) != "");
    }
}

TEST_CASE("the scanners' side-cars are understood")
{
    const TemporaryFolder folder;
    const std::string voxels = marked_bytes() + marked_bytes();
    folder.write("root.raw", voxels);
    const std::string nsi =
        "ObjectFileName: root.raw\r\nResolution:     5 4 3\r\nSliceThickness: 0.1 0.1 0.25\r\n"
        "Format:         USHORT\r\nObjectModel:    DENSITY\r\n";
    const fs::path dat = folder.write("root.dat", nsi);
    for (const fs::path& path : {dat, folder.path / "root.raw"}) {
        const auto source = open_volume(path);
        CHECK(source->info().size == Size3(5, 4, 3));
        CHECK(source->info().type == VoxelType::uint16);
        CHECK(source->info().spacing == glm::dvec3(0.1, 0.1, 0.25));
        CHECK(source->info().unit == "mm");
        CHECK(warns_of(*source, "little-endian assumed"));
        CHECK(voxels_of<uint16_t>(*source)[0] == 0x0201);
    }

    const std::string xml = R"(<?xml version="1.0"?>
<RAWFileData>
    <ObjectFileName>root.raw</ObjectFileName>
    <Format>UCHAR</Format>
    <DataSlope>2</DataSlope>
    <Resolution X="5" Y='4'  Z = "3" T="1" />
    <Spacing X="0.0001" Y="0.0002" Z="0.00025"/>
    <Orientation X0="1" X1="0" X2="0" Y0="0" Y1="1" Y2="0" Z0="0" Z1="0" Z2="1" />
</RAWFileData>)";
    const auto source = open_volume(folder.write("root.dat", xml));
    check_marked(*source);
    CHECK(source->info().spacing.x == doctest::Approx(100.0));
    CHECK(source->info().spacing.z == doctest::Approx(250.0));
    CHECK(source->info().unit == "um");
    CHECK(warns_of(*source, "DataSlope is \"2\"; voxels are shown as stored"));

    const std::string spacing = R"(<Spacing X="0.0001" Y="0.0002" Z="0.00025"/>)";
    std::string without = xml;
    without.erase(without.find(spacing), spacing.size());
    CHECK(warns_of(*open_volume(folder.write("root.dat", without)), "no spacing stated; 1 voxel assumed"));

    fs::rename(folder.path / "root.raw", folder.path / "renamed.raw");
    CHECK(warns_of(*open_volume(folder.write("renamed.dat", xml)),
                   "root.raw does not exist; renamed.raw was read instead"));
}

TEST_CASE("a scanner's side-car that is broken is refused by field")
{
    const TemporaryFolder folder;
    folder.write("root.raw", marked_bytes());
    const auto refused = [&](const std::string& text) { return refusal(folder.write("root.dat", text)); };
    const std::string at = (folder.path / "root.dat").string();
    CHECK(refused("ObjectFileName: root.raw\nFormat: UCHAR\n") ==
          at + ": Resolution is missing; expected three whole numbers from 1 to 1048576");
    CHECK(contains(refused("ObjectFileName: root.raw\nResolution: 5 4 3\nFormat: QUAD\n"),
                   "Format is \"QUAD\"; expected"));
    CHECK(contains(refused("ObjectFileName: root.raw\nResolution: 5 4 3\nResolution: 5 4 3\n"), "stated twice"));
    CHECK(contains(
        refused("<RAWFileData><Format>UCHAR</Format><Resolution X=\"5\" Y=\"4\" Z=\"3\" T=\"2\"/></RAWFileData>"),
        "Resolution T is \"2\"; expected 1"));
    CHECK(contains(refused("<RAWFileData><Format>UCHAR</Format><Resolution X=\"5\" Y=\"4\"/></RAWFileData>"),
                   "Resolution is \"5 4 missing\"; expected"));
    const fs::path lost = folder.write("lost.dat", "ObjectFileName: gone.raw\nResolution: 5 4 3\nFormat: UCHAR\n");
    CHECK(refusal(lost) ==
          lost.string() +
              ": ObjectFileName is \"gone.raw\"; expected the name of a file in the same folder, or lost.raw");
    const std::string whole =
        "<RAWFileData><ObjectFileName>root.raw</ObjectFileName><Format>UCHAR</Format>"
        "<Resolution X=\"5\" Y=\"4\" Z=\"3\" T=\"1\"/><Spacing X=\"1\" Y=\"1\" Z=\"1\"/></RAWFileData>";
    for (size_t length = 0; length < whole.size(); ++length) {
        const fs::path path = folder.write("root.dat", whole.substr(0, length));
        if (refusal(path).empty()) check_marked(*open_volume(path));
    }
}

TEST_CASE("a size in the file's name is used, and said to be a guess")
{
    const TemporaryFolder folder;
    const Sample<int16_t> sample = sample_of<int16_t>(60, false);
    const auto words = open_volume(folder.write("stent_5x4x3_int16le.raw", sample.file));
    CHECK(voxels_of<int16_t>(*words) == sample.voxels);
    CHECK(warns_of(*words, "size 5x4x3 and type int16 were inferred from the file name"));
    CHECK_FALSE(warns_of(*words, "endian"));

    const auto bits = open_volume(folder.write("scan-5x4x3-16bit.raw", sample.file));
    CHECK(bits->info().type == VoxelType::uint16);
    CHECK(warns_of(*bits, "little-endian assumed"));
    CHECK(voxels_of<uint16_t>(*open_volume(folder.write("s_5x4x3_uint16_be.raw", "ab" + sample.file.substr(2))))[0] ==
          0x6162);

    CHECK(open_volume(folder.write("b_5X4X3.raw", marked_bytes()))->info().type == VoxelType::uint8);
    CHECK(open_volume(folder.write("c_5x4x3", std::string(240, 'x')))->info().type == VoxelType::float32);
    CHECK(contains(refusal(folder.write("d_5x4x3.raw", std::string(61, 'x'))),
                   "holds 61 bytes, which is not 1, 2, 4 or 8"));
    CHECK(contains(refusal(folder.write("e_5x4x3_8bit.raw", "x")), "holds 1 bytes; expected at least 60"));
    CHECK(contains(refusal(folder.write("f_0x4x3.raw", "x")), "size along x is 0; expected"));
    CHECK(contains(refusal(folder.write("f_99999999999x99999999999x99999999999.raw", "x")), "expected 1 to 1048576"));
    CHECK(contains(refusal(folder.write("g_5x4.raw", "x")), "no file beside it"));
    CHECK(contains(refusal(folder.write("short_root.raw", "x")), "no file beside it"));
}
