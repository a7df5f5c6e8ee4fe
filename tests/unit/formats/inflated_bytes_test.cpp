#include "engine/formats/inflated_bytes.h"

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

#include <doctest/doctest.h>
#include <zlib.h>

#include "engine/formats/open_volume.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

constexpr int ZLIB = 15;
constexpr int GZIP = 15 + 16;

std::string deflated(std::string_view data, int wrapping)
{
    z_stream stream{};
    REQUIRE(::deflateInit2(&stream, 6, Z_DEFLATED, wrapping, 8, Z_DEFAULT_STRATEGY) == Z_OK);
    std::string packed(::deflateBound(&stream, data.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(data.data()));
    stream.avail_in = static_cast<uInt>(data.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    REQUIRE(::deflate(&stream, Z_FINISH) == Z_STREAM_END);
    packed.resize(stream.total_out);
    ::deflateEnd(&stream);
    return packed;
}

/// Compresses to about a half, with references far back.
std::string noisy_bytes(size_t count)
{
    std::mt19937 random(1);  // seed 1
    std::string bytes(count, '\0');
    for (size_t i = 0; i < count; ++i) {
        const auto bits = unsigned(random());
        bytes[i] = bits % 3 == 0 && i > 30000 ? bytes[i - 30000 + bits % 7] : char(bits >> 28);
    }
    return bytes;
}

std::unique_ptr<VoxelBytes> opened(const fs::path& path, int64_t wanted, int64_t skip = 0)
{
    return bytes_of_deflated({.file = open_input_file(path), .skip_bytes = skip, .wanted_bytes = wanted});
}

std::string read_from(const VoxelBytes& bytes, int64_t offset, size_t count)
{
    std::string read(count, '?');
    bytes.read(offset, std::as_writable_bytes(std::span(read)));
    return read;
}

}  // namespace

TEST_CASE("any part of compressed bytes is what was compressed there, from several threads too")
{
    const TemporaryFolder folder;
    const size_t count = (size_t{13} << 20) + 12345;
    const std::string all = noisy_bytes(count);
    const fs::path one = folder.write("one.gz", deflated(all, GZIP));
    const fs::path zlib = folder.write("one.z", deflated(all, ZLIB));
    const size_t third = count / 3;
    const fs::path many = folder.write("many.gz", deflated(all.substr(0, third), GZIP) + deflated("", GZIP) +
                                                      deflated(all.substr(third, 7), GZIP) +
                                                      deflated(all.substr(third + 7), GZIP) + "left alone");
    for (const fs::path& path : {one, zlib, many}) {
        CAPTURE(path.filename().string());
        const auto bytes = opened(path, int64_t(count) - 100, 100);
        // Backwards first, while nothing is known of the file yet.
        CHECK(read_from(*bytes, int64_t(count) - 300, 200) == all.substr(count - 200));
        CHECK(read_from(*bytes, 0, 1000) == all.substr(100, 1000));
        size_t wrong[3] = {};
        const auto check = [&](unsigned seed) {
            std::mt19937 random(seed);
            for (int i = 0; i < 40; ++i) {
                const size_t offset = random() % (count - 100);
                const size_t length = std::min<size_t>(count - 100 - offset, random() % 100000);
                wrong[seed] += read_from(*bytes, int64_t(offset), length) != all.substr(100 + offset, length);
            }
        };
        {
            std::vector<std::jthread> threads;
            for (unsigned seed = 0; seed < 3; ++seed) threads.emplace_back(check, seed);
        }
        CHECK(wrong[0] + wrong[1] + wrong[2] == 0);
        CHECK(read_from(*bytes, 0, count - 100) == all.substr(100));
    }
    CHECK(inflated_head(many, third + 9) == all.substr(0, third + 9));
}

TEST_CASE("compressed bytes that are damaged, cut short or too few are an error where they are met")
{
    const TemporaryFolder folder;
    const std::string all = noisy_bytes(3000000);
    const std::string packed = deflated(all, GZIP);
    const auto refusal_of = [&](const std::string& file, int64_t wanted) {
        const fs::path path = folder.write("a.gz", file);
        return error_of([&] {
            const auto bytes = opened(path, wanted);
            read_from(*bytes, 0, size_t(wanted));
        });
    };
    const std::string at = (folder.path / "a.gz").string();
    CHECK(refusal_of(packed, 3000000).empty());
    CHECK(refusal_of(packed, 3000001) ==
          at + ": holds 3000000 decompressed bytes; expected 3000001 for the voxels that its header states");
    CHECK(contains(refusal_of(packed.substr(0, packed.size() / 2), 3000000),
                   "is truncated: its compressed data ends after"));
    CHECK(contains(refusal_of(packed.substr(0, packed.size() - 1), 3000000), "is truncated"));
    std::string damaged = packed;
    damaged[damaged.size() - 6] = char(damaged[damaged.size() - 6] ^ 1);
    CHECK(contains(refusal_of(damaged, 3000000), "is damaged after 3000000 decompressed bytes: incorrect data check"));
    const size_t sound = 2000000;
    const std::string first = deflated(all.substr(0, sound), GZIP);
    damaged = first + deflated(all.substr(sound), GZIP);
    damaged[first.size() + 10] = '\xff';  // no block has that type
    CHECK(refusal_of(damaged, 3000000) ==
          at + ": is damaged after 2000000 decompressed bytes: invalid block type; expected deflated data");
    CHECK(contains(refusal_of("PK\3\4", 10), "begins as neither gzip nor zlib does; expected one of them"));
    CHECK(contains(refusal_of("\x1f", 10), "is missing; expected one of them"));
    CHECK(contains(refusal_of("", 10), "is missing; expected one of them"));

    // Bytes before the damage can be read repeatedly.
    folder.write("a.gz", damaged);
    const auto bytes = opened(folder.path / "a.gz", 3000000);
    for (int i = 0; i < 3; ++i) {
        CHECK(contains(error_of([&] { read_from(*bytes, 2900000, 100); }), "is damaged after "));
        CHECK(read_from(*bytes, 1000, 500000) == all.substr(1000, 500000));
    }
}

TEST_CASE("a size that no deflate stream of this length can hold is refused at once, a bomb is read in small pieces")
{
    const TemporaryFolder folder;
    const std::string header = "NRRD0004\ntype: double\ndimension: 3\nencoding: gzip\nendian: little\nsizes: ";
    const Effort effort;
    for (const char* size : {"1048576 1048576 1000000", "1048576 1048576 1", "4096 4096 64", "100 100 10"}) {
        const fs::path path = folder.write("a.nrrd", header + size + "\n\n" + deflated("few bytes", GZIP));
        CHECK(contains(error_of([&] { open_volume(path); }), "compressed bytes, which cannot become more than "));
    }
    CHECK(effort.is_below(AT_ONCE_BYTES));

    const fs::path bomb =
        folder.write("b.nrrd", header + "1048576 8 1\n\n" + deflated(std::string(size_t{64} << 20, '\0'), GZIP));
    CHECK(fs::file_size(bomb) < 100000);
    const auto source = open_volume(bomb);
    CHECK(voxels_in<double>(*source, {{1000000, 7, 0}, {1000010, 8, 1}}) == std::vector<double>(10));
}

TEST_CASE("a compressed volume equals the one it was made of, box by box")
{
    const TemporaryFolder folder;
    const std::string voxels = noisy_bytes(size_t{150} * 130 * 110 * 2);
    const std::string header =
        "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 150 130 110\nendian: big\nspacings: 1 1 1\nencoding: ";
    const auto bare = open_volume(folder.write("bare.nrrd", header + "raw\n\n" + voxels));
    const auto packed = open_volume(folder.write("packed.nrrd", header + "gzip\n\n" + deflated(voxels, GZIP)));
    std::mt19937 random(5);  // seed 5
    for (int i = 0; i < 30; ++i) {
        const Size3 lower(random() % 140, random() % 120, random() % 100);
        const VoxelBox box{lower, glm::min(lower + Size3(random() % 40 + 1), bare->info().size)};
        CHECK(voxels_in<uint16_t>(*bare, box) == voxels_in<uint16_t>(*packed, box));
    }
    CHECK(voxels_of<uint16_t>(*bare) == voxels_of<uint16_t>(*packed));
    CHECK(measure(*bare).mean == measure(*packed).mean);
}
