// Zipped OME-Zarr (tests/data/make_zarr3.py): unusual archives, and archives that are damaged or made to harm.

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "engine/formats/zip/zip_archive.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

const fs::path DATA = "tests/data/zarr3";  // tests run in the repository's root

std::string refusal_of(const fs::path& path)
{
    return error_of([&] { voxels_of<int16_t>(*open_volume(path)); });
}

/// The message for an archive of these bytes, which must come at once.
std::string refusal_of_bytes(const TemporaryFolder& folder, const std::string& bytes)
{
    const fs::path path = folder.write("scan.ozx", bytes);
    const Effort effort;
    std::string said = refusal_of(path);
    CHECK(effort.is_below(AT_ONCE_BYTES));
    return said;
}

template <class T>
void set_number(std::string& bytes, size_t at, T value)
{
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}

constexpr std::string_view ENTRY("PK\1\2"), HEADER("PK\3\4"), END("PK\5\6"), END_64("PK\6\6"), LOCATOR("PK\6\7");

/// One of the archives, stored and with all sizes in front of their entries; in 64 bits, or not.
std::string archive_of(bool is_zip64)
{
    std::vector<fs::path> paths;
    for (const fs::directory_entry& entry : fs::directory_iterator(DATA)) {
        if (entry.path().extension() == ".ozx" && entry.path().filename().string().starts_with("compressor_"))
            paths.push_back(entry.path());
    }
    std::ranges::sort(paths);
    for (const fs::path& path : paths) {
        const std::string bytes = bytes_of_file(path);
        const size_t entry = bytes.find(ENTRY);
        const bool is_plain = entry != std::string::npos && bytes[entry + 8] == 0 && bytes[entry + 10] == 0;
        if (is_plain && (bytes.find(END_64) != std::string::npos) == is_zip64) return bytes;
    }
    return {};
}

}  // namespace

TEST_CASE("zip: entries are found by name, and whole")
{
    const ZipArchive archive(DATA / "image_04.ozx");
    REQUIRE(archive.find("zarr.json") != nullptr);
    CHECK(archive.find("nowhere") == nullptr);
    CHECK(archive.find("") == nullptr);
    for (const ZipEntry& entry : archive.entries()) {
        const std::vector<std::byte> bytes = archive.read(entry, 1 << 20);
        const std::string file = bytes_of_file(DATA / "image_04" / entry.name);
        CHECK(bytes.size() == file.size());
        CHECK(std::memcmp(bytes.data(), file.data(), file.size()) == 0);
    }
    CHECK(contains(error_of([&] { archive.read(*archive.find("zarr.json"), 10); }), "expected at most 10"));
}

TEST_CASE("zip: unusual archives of OME-Zarr are read")
{
    // The later of two entries with one name counts: the earlier zarr.json has no attributes.
    CHECK(is_chirality_phantom(*open_volume(DATA / "zip_twice.ozx")));
    CHECK(is_chirality_phantom(*open_volume(DATA / "zip_version_2.zip")));
    // Names that leave the folder ("..") are no names of values; nothing is unpacked.
    CHECK(is_chirality_phantom(*open_volume(DATA / "zip_climbing.ozx")));
    CHECK_FALSE(fs::exists(DATA / "climbed"));
    CHECK_FALSE(fs::exists("tests/data/climbed"));
    CHECK(contains(refusal_of(DATA / "zip_climbing.ozx/../climbed"), "has no zarr.json here"));
}

TEST_CASE("zip: what is no zipped OME-Zarr is refused in words")
{
    CHECK(contains(
        refusal_of(DATA / "zip_in_a_folder.ozx"),
        "has no zarr.json at its root; expected a zipped OME-Zarr: zip the content of its folder, not the folder"));
    CHECK(is_chirality_phantom(*open_volume(DATA / "zip_in_a_folder.ozx/scan.zarr")));
    CHECK(contains(refusal_of(DATA / "zip_empty.ozx"), "has no zarr.json at its root"));
    CHECK(contains(refusal_of(DATA / "zip_no_zarr.zip"), "has no zarr.json at its root; it holds "));
    CHECK(contains(refusal_of(DATA / "zip_no_zarr.zip"), " and no OME-Zarr: unpack it, and open what is in it"));
    CHECK(contains(refusal_of(DATA / "zip_encrypted.ozx"),
                   "zarr.json: is encrypted; expected no encryption: make the archive without a password"));
    CHECK(contains(refusal_of(DATA / "zip_bzip2.ozx"),
                   "zarr.json: is compressed with zip method 12; expected 0 (stored) or 8 (deflated): make the archive "
                   "without compression"));
    const TemporaryFolder folder;
    for (const std::string& text : {std::string(), std::string("x"), std::string(100000, 'x')})
        CHECK(contains(refusal_of_bytes(folder, text),
                       "scan.ozx: has no end record: it is truncated, or not a zip archive"));
    fs::create_directory(folder.path / "folder.ozx");
    CHECK(contains(refusal_of(folder.path / "folder.ozx"), "is a folder without shvr/session.json"));
}

TEST_CASE("zip: an archive that is cut anywhere is refused")
{
    const TemporaryFolder folder;
    for (const char* name : {"image_04.ozx", "image_group_scale.ozx", "image_flat_levels.ozx", "image_floor.ozx"}) {
        const std::string whole = bytes_of_file(DATA / name);
        for (size_t length = 0; length < whole.size(); length += 1 + whole.size() / 300)
            REQUIRE(contains(refusal_of_bytes(folder, whole.substr(0, length)), "scan.ozx: has no end record"));
    }
}

TEST_CASE("zip: any changed byte gives a refusal or the same voxels, and takes no memory to speak of")
{
    const TemporaryFolder folder;
    for (const char* name : {"compressor_none.ozx", "shard_end.ozx", "shard_start.ozx", "shard_usual.ozx"}) {
        const std::string whole = bytes_of_file(DATA / name);
        for (size_t at = 0; at < whole.size(); at += 1 + whole.size() / 700) {
            for (const int change : {0x01, 0x80, 0xff}) {
                std::string spoiled = whole;
                spoiled[at] = char(spoiled[at] ^ char(change));
                const fs::path path = folder.write("scan.ozx", spoiled);
                const std::string said = refusal_of(path);
                CAPTURE(name);
                CAPTURE(at);
                // Parts of shards are read without the CRC-32 of their entry; the index and zstd find most of it.
                if (said.empty() && name != std::string("shard_small.ozx"))
                    REQUIRE(open_volume(path)->info().type == VoxelType::int16);
            }
        }
    }
}

TEST_CASE("zip: sizes and places that lie are refused before memory is taken")
{
    const TemporaryFolder folder;
    const std::string whole = archive_of(false);
    const size_t entry = whole.find(ENTRY), end = whole.rfind(END), header = whole.find(HEADER);
    REQUIRE(entry != std::string::npos);
    REQUIRE(end != std::string::npos);
    const auto with = [&](size_t at, auto value) {
        std::string lying = whole;
        set_number(lying, at, value);
        return refusal_of_bytes(folder, lying);
    };
    CHECK(contains(with(entry + 24, uint32_t{0xfffffff0}), "holds 4294967280 bytes; expected at most 4194304"));
    CHECK(contains(with(entry + 24, uint32_t{4000000}), "; expected "));
    CHECK(contains(with(entry + 20, uint32_t{0xfffffff0}), "; expected "));
    CHECK(contains(with(entry + 16, uint32_t{1}), "zarr.json: is damaged: its CRC-32 is "));
    for (const uint32_t place : {1U, 0x7fffffffU, 0xfffffff0U, uint32_t(end)})
        CHECK(contains(with(entry + 42, place), "zarr.json: has no header at byte "));
    CHECK(contains(with(header + 30, 'Z'), "zarr.json: has no header at byte "));
    CHECK(contains(with(entry, uint32_t{0}), "entry 1 of its directory is damaged; expected a complete zip archive"));
    CHECK(contains(with(entry + 28, uint16_t{0xffff}), "entry 1 of its directory reaches beyond the directory"));
    CHECK(contains(with(entry + 30, uint16_t{0xffff}), "entry 1 of its directory reaches beyond the directory"));
    CHECK(contains(with(end + 10, uint16_t{0xffff}), "expected a single file"));
    std::string many = whole;
    set_number(many, end + 8, uint16_t{0xffff});
    set_number(many, end + 10, uint16_t{0xffff});
    CHECK(contains(refusal_of_bytes(folder, many), "states 65535 entries in a directory of "));
    CHECK(contains(with(end + 4, uint16_t{3}), "is one part of a multi-part archive"));
    CHECK(contains(with(end + 12, uint32_t{0xfffffff0}), "which overlaps the end record or lies behind it"));
    CHECK(contains(with(end + 16, uint32_t{0xfffffff0}), "which overlaps the end record or lies behind it"));
    CHECK(contains(with(end + 16, uint32_t(end)), "which overlaps the end record or lies behind it"));
}

TEST_CASE("zip: the records of zip64 are believed as far as they hold")
{
    const TemporaryFolder folder;
    const std::string whole = archive_of(true);
    REQUIRE_FALSE(whole.empty());
    const size_t record = whole.rfind(END_64), locator = whole.rfind(LOCATOR), entry = whole.find(ENTRY);
    const auto with = [&](size_t at, auto value) {
        std::string lying = whole;
        set_number(lying, at, value);
        return refusal_of_bytes(folder, lying);
    };
    for (const uint64_t place : {uint64_t{1}, uint64_t(locator), uint64_t{1} << 63, ~uint64_t{0}})
        CHECK(contains(with(locator + 8, place), "zip64 end record"));
    CHECK(contains(with(record + 32, uint64_t{1} << 60), "expected a single file"));
    std::string many = whole;
    set_number(many, record + 24, uint64_t{1} << 60);
    set_number(many, record + 32, uint64_t{1} << 60);
    CHECK(contains(refusal_of_bytes(folder, many), "states 1152921504606846976 entries"));
    CHECK(contains(with(record + 40, ~uint64_t{0}), "which overlaps the end record or lies behind it"));
    CHECK(contains(with(record + 48, ~uint64_t{0}), "which overlaps the end record or lies behind it"));
    // The first entry's sizes, behind its name: bytes, stored bytes, place.
    const auto name_bytes = size_t(static_cast<unsigned char>(whole[entry + 28]));
    const size_t field = entry + 46 + name_bytes + 4;
    for (const uint64_t lie : {uint64_t{1} << 40, uint64_t{1} << 63, ~uint64_t{0}}) {
        CHECK(contains(with(field, lie), "; expected "));
        CHECK(contains(with(field + 8, lie), "; expected "));
        CHECK(contains(with(field + 16, lie), "; expected "));
    }
    CHECK(contains(with(field - 2, uint16_t{8}), "lacks its zip64 sizes"));
}

TEST_CASE("zip: a bomb takes the memory of one chunk at most")
{
    // 4 MiB of zeros in 4 KiB: refused by the size that the directory says, or where that lies, by what comes out.
    const Effort effort;
    CHECK(contains(refusal_of(DATA / "zip_bomb.ozx"), "c/0/0/0: holds 4194304 bytes; expected at most 4216"));
    CHECK(contains(refusal_of(DATA / "zip_bomb_that_lies.ozx"), "c/0/0/0: cannot be inflated (its size differs)"));
    CHECK(effort.is_below(int64_t{3} << 20));
}
