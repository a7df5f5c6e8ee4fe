// TIFFs that are truncated, damaged, or malicious: each is refused quickly with a message, and libtiff prints nothing.

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>

#include <chrono>
#include <random>

#include "engine/formats/open_volume.h"
#include "tests/support/tiff_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

/// Redirects standard error to a file during its lifetime.
class CaughtStderr {
public:
    explicit CaughtStderr(const fs::path& path) : path_(path), kept_(::dup(2))
    {
        std::fflush(stderr);
        const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        ::dup2(file, 2);
        ::close(file);
    }
    CaughtStderr(const CaughtStderr&) = delete;
    ~CaughtStderr() { restore(); }

    std::string text()
    {
        restore();
        return bytes_of_file(path_);
    }

private:
    void restore()
    {
        if (kept_ < 0) return;
        std::fflush(stderr);
        ::dup2(kept_, 2);
        ::close(kept_);
        kept_ = -1;
    }

    fs::path path_;
    int kept_;
};

/// Directories written byte by byte, little-endian: libtiff would refuse to write these.
class HandMade {
public:
    struct Field {
        uint16_t tag;
        uint16_t type;  // 3: 16 bits, 4: 32 bits
        uint32_t count;
        uint32_t value;
    };

    explicit HandMade(uint32_t first_directory) : bytes_("II*\0", 4) { add(first_directory, 4); }

    void add(uint64_t number, size_t bytes)
    {
        for (size_t i = 0; i < bytes; ++i) bytes_ += char(number >> 8 * i);
    }
    void directory(const std::vector<Field>& fields, uint32_t next)
    {
        add(fields.size(), 2);
        for (const Field& field : fields) {
            add(field.tag, 2);
            add(field.type, 2);
            add(field.count, 4);
            add(field.value, 4);
        }
        add(next, 4);
    }
    uint32_t size() const { return uint32_t(bytes_.size()); }
    const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
};

using Fields = std::vector<HandMade::Field>;

/// A page of 8 x 8 voxels of uint8 in one strip at byte 8.
Fields page_fields()
{
    return {{256, 4, 1, 8}, {257, 4, 1, 8}, {258, 3, 1, 8}, {259, 3, 1, 1}, {262, 3, 1, 1},
            {273, 4, 1, 8}, {277, 3, 1, 1}, {278, 4, 1, 8}, {279, 4, 1, 64}};
}

Fields with(Fields fields, const Fields& changes)
{
    for (const HandMade::Field& change : changes) {
        const auto place =
            std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f.tag >= change.tag; });
        if (place != fields.end() && place->tag == change.tag) {
            *place = change;
        } else {
            fields.insert(place, change);
        }
    }
    return fields;
}

class Hostile : public TemporaryFolder {
public:
    /// The refusal of a file of 1 KiB with one page of these fields, without the path.
    std::string refusal(const Fields& changes) const
    {
        HandMade tiff(72);
        for (int i = 0; i < 64; ++i) tiff.add(uint64_t(i), 1);
        tiff.directory(with(page_fields(), changes), 0);
        return refusal_of(tiff.bytes() + std::string(1024 - tiff.size(), '\0'));
    }
    std::string refusal_of(const std::string& bytes) const
    {
        const fs::path file = write("a.tif", bytes);
        const Effort effort;
        std::string said = error_of([&] {
            const auto source = open_volume(file);
            std::vector<std::byte> voxels(size_t(voxel_count(source->info())) * bytes_of(source->info().type));
            source->read({Size3(0), source->info().size}, voxels);
        });
        CHECK(effort.is_below(AT_ONCE_BYTES));
        if (!said.starts_with(file.string())) return said;
        return said.substr(file.string().size());
    }
};

/// Tiny but complete files, with their voxels.
struct Sample {
    std::string name;
    std::string bytes;
};

std::vector<Sample> samples()
{
    const TemporaryFolder folder;
    std::vector<Sample> samples;
    const auto add = [&](const char* name, TiffSpec spec, const char* mode) {
        spec.format = SAMPLEFORMAT_INT;
        samples.push_back({name, bytes_of_file(write_tiff(folder.path / "a.tif", spec, chirality_pages(), mode))});
    };
    add("bare", {}, "wl");
    add("bare BigTIFF, big-endian", {.rows_per_strip = 1}, "wb8");
    add("LZW", {.compression = COMPRESSION_LZW, .predictor = 2}, "wb");
    add("Deflate in strips", {.compression = COMPRESSION_ADOBE_DEFLATE, .rows_per_strip = 2}, "wl");
    add("tiles", {.compression = COMPRESSION_PACKBITS, .tile = 16}, "wl");
    samples.push_back({"long ImageJ", bytes_of_file("tests/data/tiff/imagej_long_big_endian.tif")});
    return samples;
}

}  // namespace

TEST_CASE("a TIFF cut anywhere is an error, or still says the same")
{
    const TemporaryFolder folder;
    CaughtStderr terminal(folder.path / "stderr");
    for (const Sample& sample : samples()) {
        CAPTURE(sample.name);
        for (size_t length = 0; length < sample.bytes.size(); ++length) {
            const fs::path path = folder.write("a.tif", sample.bytes.substr(0, length));
            CAPTURE(length);
            bool says_the_same = false;
            const std::string said = error_of([&] {
                const std::unique_ptr<VolumeSource> source = open_volume(path);
                // A stack that ends with the fields of a directory may have been no longer: it is read with a warning.
                says_the_same =
                    is_chirality_phantom(*source) || warns_of(*source, "was cut before the offset of a next one");
            });
            CHECK((says_the_same || contains(said, "; expected ")));
        }
    }
    CHECK(terminal.text() == "");
}

TEST_CASE("the memory for a block is no more than its bytes can decode to")
{
    const Hostile hostile;
    // A byte of a fax may be eight white rows, of 1 bit a pixel: of 65024 channels that would be 130 MB.
    CHECK(contains(hostile.refusal({{256, 4, 1, 4101},
                                    {257, 4, 1, 4},
                                    {258, 3, 1, 1},
                                    {277, 3, 1, 65024},
                                    {259, 3, 1, COMPRESSION_CCITTFAX4}}),
                   "has 65024 samples of 1 bits a pixel by CCITT group 4; expected one of 1 bit"));
    // 64 bytes of Zstandard hold 4 MiB at most, and no more for being few.
    CHECK(contains(
        hostile.refusal({{256, 4, 1, 8192}, {257, 4, 1, 8192}, {278, 4, 1, 8192}, {259, 3, 1, COMPRESSION_ZSTD}}),
        "expected enough for 67108864 bytes of voxels"));
}

TEST_CASE("a damaged TIFF is read or refused, and libtiff says nothing to the terminal")
{
    const TemporaryFolder folder;
    CaughtStderr terminal(folder.path / "stderr");
    std::mt19937 random(11);
    int refused = 0;
    for (const Sample& sample : samples()) {
        CAPTURE(sample.name);
        for (int i = 0; i < 1500; ++i) {
            std::string bytes = sample.bytes;
            for (auto changes = random() % 3 + 1; changes > 0; --changes) {
                const char values[] = {'\0', '\xff', '\x7f', '\x01', char(random())};
                bytes[random() % bytes.size()] = values[random() % std::size(values)];
            }
            try {
                const auto source = open_volume(folder.write("a.tif", bytes));
                const int64_t voxels = voxel_count(source->info());
                if (voxels > 1 << 20) continue;
                std::vector<std::byte> memory(size_t(voxels) * bytes_of(source->info().type));
                source->read({Size3(0), source->info().size}, memory);
            } catch (const Error& error) {
                ++refused;
                const std::string said = error.what();
                CHECK(contains(said, "expected"));
                CHECK(std::none_of(said.begin(), said.end(), [](char character) {
                    return static_cast<unsigned char>(character) < 0x20 || character == 0x7f;
                }));
            }
        }
    }
    CHECK(refused > 1000);
    CHECK(terminal.text() == "");
}

TEST_CASE("a TIFF that lies about sizes is refused by field, before memory is taken")
{
    const Hostile hostile;
    CHECK(hostile.refusal({}) == "");
    CHECK(hostile.refusal({{256, 4, 1, 0}}) == ": page 1: ImageWidth is 0; expected 1 to 1048576");
    CHECK(hostile.refusal({{256, 4, 1000, 8}}) == ": page 1: ImageWidth is not within the file; expected 1 to 1048576");
    CHECK(hostile.refusal({{257, 4, 1, 0}}) == ": page 1: ImageLength is 0; expected 1 to 1048576");
    CHECK(hostile.refusal({{256, 4, 1, 0x80000000}}) == ": page 1: ImageWidth is 2147483648; expected 1 to 1048576");
    CHECK(hostile.refusal({{257, 4, 1, 0xffffffff}}) == ": page 1: ImageLength is 4294967295; expected 1 to 1048576");
    // 10 TB in 1 KiB: uncompressed, and compressed.
    CHECK(hostile.refusal(
              {{256, 4, 1, 1048576}, {257, 4, 1, 1048576}, {258, 3, 1, 64}, {278, 4, 1, 1048576}, {339, 3, 1, 3}}) ==
          ": holds 1024 bytes; expected enough for 1 page of 1048576x1048576 pixels of float64: it is truncated, or "
          "ImageWidth and ImageLength are wrong");
    for (const uint32_t compression : {COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS,
                                       COMPRESSION_ZSTD, COMPRESSION_LZMA, COMPRESSION_JPEG}) {
        CAPTURE(compression);
        const Fields size = {{256, 4, 1, 1048576}, {257, 4, 1, 1048576}, {259, 3, 1, compression}};
        CHECK(contains(hostile.refusal(with(size, {{278, 4, 1, 1}})), "expected"));
        CHECK(contains(hostile.refusal(with(size, {{278, 4, 1, 1048576}})), "expected"));
        CHECK(contains(
            hostile.refusal({{259, 3, 1, compression}, {256, 4, 1, 60000}, {257, 4, 1, 60000}, {278, 4, 1, 60000}}),
            "expected"));
    }
    CHECK(hostile.refusal({{278, 4, 1, 4}, {273, 3, 2, 32 << 16 | 8}, {279, 3, 2, 31 << 16 | 32}}) ==
          ": page 1: strip 2 of 2 is 31 bytes by StripByteCounts; expected enough for 32 bytes of voxels");
    // The pixels take 64 bytes, and are there; compressed ones may take all that is stated.
    CHECK(hostile.refusal({{279, 4, 1, 2000}}).empty());
    CHECK(hostile.refusal({{259, 3, 1, COMPRESSION_LZW}, {279, 4, 1, 2000}}) ==
          ": page 1: its voxels are 2000 bytes at byte 8 by StripOffsets and StripByteCounts; expected them within the "
          "1024 bytes of the file");
    CHECK(contains(hostile.refusal({{273, 4, 1, 0xffffffff}}), "are 64 bytes at byte 4294967295 by StripOffsets"));
    CHECK(contains(hostile.refusal({{273, 4, 1, 0}}), "is missing"));
    CHECK(hostile.refusal({{273, 4, 0x40000000, 8}}) ==
          ": page 1: StripOffsets has 1073741824 values at byte 8; expected as many as fit into the 1024 bytes of the "
          "file");
    CHECK(contains(hostile.refusal({{278, 4, 1, 0}}), "expected"));
    CHECK(contains(hostile.refusal({{258, 3, 1, 0}}), "expected"));
    CHECK(contains(hostile.refusal({{258, 3, 1, 65535}}), "expected"));
    CHECK(contains(hostile.refusal({{277, 3, 1, 0}}), "expected"));
    CHECK(contains(hostile.refusal({{277, 3, 1, 65535}}), "expected"));
    CHECK(contains(hostile.refusal({{322, 4, 1, 0xfffffff0}, {323, 4, 1, 0xfffffff0}, {324, 4, 1, 8}, {325, 4, 1, 64}}),
                   "expected"));
    CHECK(contains(hostile.refusal({{322, 4, 1, 0}, {323, 4, 1, 0}, {324, 4, 1, 8}, {325, 4, 1, 64}}), "expected"));
    CHECK(hostile.refusal({{320, 3, 0x7fffffff, 8}, {262, 3, 1, 3}}) == "");  // without its palette it counts as grey
    CHECK(contains(hostile.refusal({{259, 3, 1, 33005}}), "Compression is 33005 (JPEG 2000); expected none, LZW"));
    CHECK(contains(hostile.refusal({{259, 3, 1, 12345}}), "expected"));
}

TEST_CASE("strips that overlap are refused")
{
    const Hostile hostile;
    for (const uint32_t second : {8u, 40u, 71u}) {
        HandMade tiff(8 + 128 + 16);
        for (int i = 0; i < 128; ++i) tiff.add(7, 1);
        for (const uint32_t number : {8u, second, 64u, 64u}) tiff.add(number, 4);
        tiff.directory(with(page_fields(), {{257, 4, 1, 16}, {273, 4, 2, 136}, {279, 4, 2, 144}}), 0);
        CHECK(hostile.refusal_of(tiff.bytes()) ==
              sentence(": page 1: a strip starts at byte ", second,
                       "; expected at least 72, where the one before it ends: ", "they overlap"));
    }
    // A thousand pages of one strip.
    HandMade tiff(8 + 64);
    for (int i = 0; i < 64; ++i) tiff.add(7, 1);
    const uint32_t bytes = 2 + 12 * 9 + 4;
    for (uint32_t page = 0; page < 1000; ++page) {
        tiff.directory(with(page_fields(), {{256, 4, 1, 1024}, {257, 4, 1, 64}, {278, 4, 1, 64}, {279, 4, 1, 65536}}),
                       page == 999 ? 0 : 72 + (page + 1) * bytes);
    }
    CHECK(contains(hostile.refusal_of(tiff.bytes()), "bytes of voxels in StripByteCounts; expected at most the"));
}

TEST_CASE("chains of pages that do not end are refused")
{
    const Hostile hostile;
    const uint32_t bytes = 2 + 12 * 9 + 4;
    const auto chain = [&](uint32_t pages, uint32_t back_to) {
        HandMade tiff(8 + 4096);
        for (int i = 0; i < 4096; ++i) tiff.add(7, 1);
        for (uint32_t page = 0; page < pages; ++page) {
            const Fields fields = with(page_fields(), {{256, 4, 1, 1}, {257, 4, 1, 1}, {279, 4, 1, 1}});
            tiff.directory(fields, page + 1 == pages ? 8 + 4096 + back_to * bytes : 8 + 4096 + (page + 1) * bytes);
        }
        return tiff.bytes();
    };
    CHECK(hostile.refusal_of(chain(1, 0)) ==
          ": page 2 starts where an earlier page does, at byte 4104; expected a chain of pages that ends");
    CHECK(contains(hostile.refusal_of(chain(3, 1)), "starts where an earlier page does, at byte"));
    CHECK(contains(hostile.refusal_of(chain(1000, 500)), "expected"));

    HandMade empty(8);
    empty.add(0, 2);
    empty.add(8, 4);
    CHECK(hostile.refusal_of(empty.bytes()) == ": page 1 has a directory of 0 fields; expected 1 to 4096");
    HandMade large(8);
    large.add(65535, 2);
    CHECK(hostile.refusal_of(large.bytes()) == ": page 1 has a directory of 65535 fields; expected 1 to 4096");
    // Overlapping directories with many fields each.
    HandMade woven(8);
    const Fields many(400, {256, 4, 1, 8});
    woven.directory(many, 0);
    std::string bytes_of_woven = woven.bytes();
    for (size_t i = 10; i + 24 < bytes_of_woven.size(); i += 24) bytes_of_woven[i] = char(i);
    CHECK(contains(hostile.refusal_of(bytes_of_woven), "expected"));
    CHECK(hostile.refusal_of(std::string("II*\0\0\0\0\0", 8)) == ": has no pages; expected at least one");
    CHECK(hostile.refusal_of(std::string("MM\0*\0\0\1", 7)) == ": holds 7 bytes; expected a TIFF's header of 8");
    CHECK(hostile.refusal_of("") == ": begins with \"\"; expected the first bytes of a TIFF, II or MM");
    CHECK(contains(hostile.refusal_of(std::string("II*\0\xff\xff\xff\xff", 8)),
                   "page 1 starts at byte 4294967295; expected less than the 8 bytes of the file"));
}

TEST_CASE("more than a million pages are refused")
{
    const TemporaryFolder folder;
    const uint32_t pages = (1u << 20) + 1;
    const uint32_t bytes = 2 + 12 * 2 + 4;
    HandMade tiff(8);
    for (uint32_t page = 0; page < pages; ++page) {
        tiff.directory({{256, 4, 1, 1}, {257, 4, 1, 1}}, 8 + (page + 1) * bytes);
    }
    const fs::path path = folder.write("a.tif", tiff.bytes());
    CHECK(error_of([&] { open_volume(path); }) ==
          path.string() + ": holds more than 1048576 pages; expected at most that many");
}

TEST_CASE("a bomb of zeros is read piece by piece, without more memory than the pieces")
{
    const TemporaryFolder folder;
    TiffSpec spec{.width = 4096, .height = 4096, .bits = 8, .compression = COMPRESSION_ADOBE_DEFLATE};
    spec.rows_per_strip = 64;
    const fs::path path = write_tiff(folder.path / "a.tif", spec, {std::string(spec.page_bytes(), '\0')});
    CHECK(fs::file_size(path) < spec.page_bytes() / 500);
    const auto source = open_volume(path);
    CHECK(voxels_in<uint8_t>(*source, {{4000, 4000, 0}, {4001, 4001, 1}}) == std::vector<uint8_t>{0});

    // A strip that decodes to more than its page states is read up to the page's size.
    std::string bytes = bytes_of_file(path);
    fs::remove(path);
    spec = {.width = 64, .height = 64, .bits = 8, .compression = COMPRESSION_ADOBE_DEFLATE};
    TIFF* const bomb = TIFFOpen(folder.write("bomb.tif", bytes).c_str(), "r");
    std::string strip(4096, '\0');
    const tmsize_t length = TIFFReadRawStrip(bomb, 0, strip.data(), 4096);
    TIFFClose(bomb);
    REQUIRE(length > 0);
    TiffWriter(path, "wl").raw_page(spec, strip.substr(0, size_t(length)));
    CHECK(voxels_of<uint8_t>(*open_volume(path)) == std::vector<uint8_t>(64 * 64, 0));
}

TEST_CASE("a TIFF cut short while it is open is an error, not a signal")
{
    const TemporaryFolder folder;
    for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW}) {
        TiffSpec spec{.width = 256, .height = 256, .bits = 16, .compression = compression};
        std::string page;
        for (size_t i = 0; i < spec.page_bytes(); ++i) page += char(i * i >> 7);
        const fs::path path = write_tiff(folder.path / "a.tif", spec, {page, page});
        const auto source = open_volume(path);
        fs::resize_file(path, 1000);
        CHECK(contains(error_of([&] { voxels_of<uint16_t>(*source); }), "expected"));
    }
}

TEST_CASE("what is no file is refused in words, without waiting, and what is no TIFF is left to others")
{
    const TemporaryFolder folder;
    const fs::path fifo = folder.path / "a.tif";
    REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
    CHECK(error_of([&] { open_volume(fifo); }) == fifo.string() + ": is a pipe or device; expected a file");
    const fs::path zip = folder.write("b.tif", "PK\3\4 and so on");
    CHECK(error_of([&] { open_volume(zip); }) ==
          zip.string() + ": begins with \"PK??\"; expected the first bytes of a TIFF, II or MM");
    CHECK(contains(error_of([&] { open_volume(folder.write("c.xyz", "II in Roman numbers")); }),
                   "is in no format known"));
}
