// Folders of PNG, BMP and JPEG slices, and the logs of SkyScan next to slices.

#include <algorithm>

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "tests/support/volume_files.h"
#include "tests/unit/formats/slices/picture_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

constexpr int64_t WIDTH = 5, HEIGHT = 4;

/// The value of a pixel; slices differ.
int64_t value_at(int64_t x, int64_t y, int64_t z)
{
    return 1 + x + 10 * y + 60 * z;
}

std::vector<std::string> rows_of(int64_t z, int bytes = 1, int64_t factor = 1)
{
    std::vector<std::string> rows;
    for (int64_t y = 0; y < HEIGHT; ++y) {
        std::string& row = rows.emplace_back();
        for (int64_t x = 0; x < WIDTH; ++x) {
            const int64_t value = factor * value_at(x, y, z);
            if (bytes == 2) row += char(value >> 8);
            row += char(value);
        }
    }
    return rows;
}

std::string grey_png(int64_t z)
{
    return png_of({.width = WIDTH, .height = HEIGHT}, rows_of(z));
}

/// Whether each voxel is `factor` times value_at, read at once and in single boxes.
template <class Value>
bool holds_values(const VolumeSource& source, int64_t slices, int64_t factor = 1)
{
    if (source.info().size != Size3(WIDTH, HEIGHT, slices)) return false;
    for (int64_t z = 0; z < slices; ++z)
        for (int64_t y = 0; y < HEIGHT; ++y) {
            std::vector<Value> row(WIDTH), middle(2);
            source.read({{0, y, z}, {WIDTH, y + 1, z + 1}}, std::as_writable_bytes(std::span(row)));
            source.read({{2, y, z}, {4, y + 1, z + 1}}, std::as_writable_bytes(std::span(middle)));
            for (int64_t x = 0; x < WIDTH; ++x)
                if (int64_t(row[size_t(x)]) != factor * value_at(x, y, z)) return false;
            if (middle[0] != row[2] || middle[1] != row[3]) return false;
        }
    return true;
}

std::string grey_palette(int colors)
{
    std::string palette;
    for (int i = 0; i < colors; ++i) palette += std::string(3, char(i)) + '\0';
    return palette;
}

}  // namespace

// Kind (Slices): PNG, BMP and JPEG slices in the order of their numbers
TEST_CASE("a folder of grey pictures is a volume, in the order of the numbers in its names")
{
    const TemporaryFolder folder;
    SUBCASE("PNG of 8 bits")
    {
        for (const int64_t z : {0, 1, 2}) folder.write(sentence("s", 8 + z, ".png"), grey_png(z));
        const auto source = open_volume(folder.path);
        CHECK(source->info().format == "png");
        CHECK(source->info().type == VoxelType::uint8);
        CHECK(holds_values<uint8_t>(*source, 3));
        CHECK(warns_of(*source, "no spacing stated"));
    }
    SUBCASE("PNG of 16 bits, interlaced or not")
    {
        folder.write("a1.png", png_of({.width = WIDTH, .height = HEIGHT, .bits = 16}, rows_of(0, 2, 300)));
        folder.write("a2.png", png_of({.width = WIDTH, .height = HEIGHT, .bits = 16}, rows_of(1, 2, 300)));
        const auto source = open_volume(folder.path);
        CHECK(source->info().type == VoxelType::uint16);
        CHECK(holds_values<uint16_t>(*source, 2, 300));
    }
    SUBCASE("PNG with a grey palette, in any order")
    {
        std::string palette;
        for (int i = 0; i < 256; ++i) palette += std::string(3, char(255 - i));
        for (const int64_t z : {0, 1}) {
            std::vector<std::string> rows = rows_of(z);
            for (std::string& row : rows)
                for (char& index : row) index = char(255 - uint8_t(index));
            folder.write(sentence("p_", z, ".png"),
                         png_of({.width = WIDTH, .height = HEIGHT, .color_type = 3, .palette = palette}, rows));
        }
        CHECK(holds_values<uint8_t>(*open_volume(folder.path), 2));
    }
    SUBCASE("BMP with the grey palette of scanners")
    {
        for (const int64_t z : {0, 1, 2})
            folder.write(sentence("rec", z, ".bmp"), bmp_of(WIDTH, 8, grey_palette(256), rows_of(z)));
        const auto source = open_volume(folder.path);
        CHECK(source->info().format == "bmp");
        CHECK(holds_values<uint8_t>(*source, 3));
    }
    SUBCASE("JPEG, within its accuracy, and a warning")
    {
        std::vector<std::string> rows;
        for (int y = 0; y < 8; ++y) rows.emplace_back(16, char(20 * y));
        folder.write("j1.jpg", jpeg_of(16, 1, rows));
        folder.write("j2.jpeg", jpeg_of(16, 1, rows, true));
        const auto source = open_volume(folder.path);
        CHECK(source->info().format == "jpeg");
        CHECK(source->info().size == Size3(16, 8, 2));
        CHECK(warns_of(*source, "JPEG changes intensities"));
        std::vector<uint8_t> voxels(256);
        source->read({{0, 0, 0}, {16, 8, 2}}, std::as_writable_bytes(std::span(voxels)));
        for (size_t i = 0; i < voxels.size(); ++i) CHECK(std::abs(int(voxels[i]) - int(20 * (i / 16 % 8))) <= 2);
    }
    SUBCASE("one picture is a volume of one slice")
    {
        CHECK(holds_values<uint8_t>(*open_volume(folder.write("one.png", grey_png(0))), 1));
        CHECK(holds_values<uint8_t>(*open_volume(folder.write("one", bmp_of(WIDTH, 8, grey_palette(256), rows_of(0)))),
                                    1));
    }
}

TEST_CASE("colours are chosen, the alpha of grey pictures is left out")
{
    const TemporaryFolder folder;
    std::vector<std::string> colors, with_alpha;
    for (const std::string& row : rows_of(0)) {
        std::string &three = colors.emplace_back(), &two = with_alpha.emplace_back();
        for (const char value : row) {
            three += {'\x07', value, '\x09'};
            two += {value, '\x05'};
        }
    }
    const fs::path png = folder.write("c.png", png_of({.width = WIDTH, .height = HEIGHT, .color_type = 2}, colors));
    CHECK(
        contains(error_of([&] { open_volume(png); }), "holds 3 channels; expected channel to choose one: 1 to 3, red"));
    CHECK(holds_values<uint8_t>(*open_volume(png, {.channel = "green"}), 1));
    const fs::path bmp = folder.write("c.bmp", bmp_of(WIDTH, 24, {}, colors));
    CHECK(holds_values<uint8_t>(*open_volume(bmp, {.channel = "2"}), 1));
    const auto grey =
        open_volume(folder.write("g.png", png_of({.width = WIDTH, .height = HEIGHT, .color_type = 4}, with_alpha)));
    CHECK(holds_values<uint8_t>(*grey, 1));
    CHECK(warns_of(*grey, "its alpha channel was left out"));
    std::vector<std::string> jpeg(8, std::string(24, '\x40'));
    CHECK(contains(error_of([&] { open_volume(folder.write("c.jpg", jpeg_of(8, 3, jpeg))); }), "holds 3 channels"));
}

// Kind (Slices): thumbnails, missing slices and decimal positions
TEST_CASE("stray pictures are left out, gaps are told, decimals are in order, series are refused")
{
    const TemporaryFolder folder;
    for (const int64_t z : {0, 1, 2})
        folder.write(sentence("z_", 8.5 + 0.5 * double(z), z == 1 ? ".0.png" : ".png"), grey_png(z));
    folder.write("Thumbs.db", "no picture");
    const std::string small = png_of({.width = 2, .height = 1}, {"ab"});
    SUBCASE("decimals")
    {
        CHECK(holds_values<uint8_t>(*open_volume(folder.path), 3));
        folder.write("z_11.png", grey_png(0));  // another pattern, of the same size, with fewer numbers
        CHECK(warns_of(*open_volume(folder.path), "\"z_11.png\" is not numbered like the slices"));
    }
    SUBCASE("a gap")
    {
        folder.write("z_11.5.png", grey_png(3));
        CHECK(warns_of(*open_volume(folder.path),
                       "the numbers of \"z_9.5.png\" and \"z_11.5.png\" are 2 apart, those "
                       "before 0.5; slices may be missing"));
    }
    SUBCASE("thumbnails: without numbers, of another size, of another format")
    {
        folder.write("preview.png", grey_png(0));
        folder.write("thumb_8.5.png", small);
        folder.write("preview.jpg", jpeg_of(8, 1, std::vector<std::string>(8, std::string(8, 'a'))));
        const auto source = open_volume(folder.path);
        CHECK(holds_values<uint8_t>(*source, 3));
        CHECK(warns_of(*source,
                       "\"preview.png\", \"thumb_8.5.png\" are not numbered like the slices or of another size"));
    }
    SUBCASE("a slice of another size")
    {
        folder.write("z_10.0.png", small);
        CHECK(contains(error_of([&] { open_volume(folder.path); }),
                       "z_10.0.png: has 2x1 pixels of uint8; expected 5x4 pixels of uint8, as z_8.5.png"));
    }
    SUBCASE("two series")
    {
        for (const int64_t z : {0, 1}) folder.write(sentence("other", z, ".png"), grey_png(z));
        CHECK(contains(error_of([&] { open_volume(folder.path); }), "holds 2 series of slices"));
    }
}

// Kind (Slices): pictures that are damaged, truncated or made to exhaust memory
TEST_CASE("damaged pictures and bombs are refused before memory is taken")
{
    const TemporaryFolder folder;
    const Effort effort;
    const auto refusal = [&](const char* name, const std::string& bytes) {
        const fs::path file = folder.write(name, bytes);
        return error_of([&] {
            const auto source = open_volume(file);
            std::vector<std::byte> voxels(size_t(source->info().size.x * source->info().size.y) *
                                          bytes_of(source->info().type));
            source->read({Size3(0), source->info().size}, voxels);
        });
    };
    CHECK(contains(refusal("bomb.png", png_of({.width = 1 << 20, .height = 1 << 20}, {"a"})),
                   "expected at least 1065418243 for its 1099511627776 bytes of pixels"));
    CHECK(
        contains(refusal("side.png", png_of({.width = 1 << 21, .height = 1}, {"a"})), "expected 1 to 1048576 a side"));
    const std::string png = grey_png(0);
    for (size_t bytes = 8; bytes + 12 < png.size(); ++bytes) {
        CAPTURE(bytes);
        CHECK(contains(refusal("cut.png", png.substr(0, bytes)), "is no sound PNG"));
    }
    std::string flipped = png;
    flipped[60] = char(flipped[60] ^ 1);
    CHECK(contains(refusal("flipped.png", flipped), "is no sound PNG"));
    const std::string jpeg = jpeg_of(64, 1, std::vector<std::string>(64, std::string(64, 'a')));
    for (const size_t bytes : {size_t{4}, size_t{100}, jpeg.size() / 2, jpeg.size() - 8}) {
        CAPTURE(bytes);
        CHECK(contains(refusal("cut.jpg", jpeg.substr(0, bytes)), "is no sound JPEG"));
    }
    std::string huge = jpeg;
    const size_t at = huge.find("\xff\xc0") + 5;
    huge.replace(at, 4, std::string(4, '\xf0'));
    CHECK(contains(refusal("huge.jpg", huge), "of pixels: it is truncated, or its size is wrong"));
    const std::string bmp = bmp_of(WIDTH, 8, grey_palette(256), rows_of(0));
    for (size_t bytes = 20; bytes < bmp.size(); bytes += 7) {
        CAPTURE(bytes);
        CHECK(contains(refusal("cut.bmp", bmp.substr(0, bytes)), "expected "));
    }
    std::string packed = bmp;
    packed[30] = 1;
    CHECK(contains(refusal("packed.bmp", packed), "compression is 1; expected 0: save it without compression"));
    CHECK(contains(refusal("named.png", "nothing"), "is no PNG file by its first bytes"));
    CHECK(effort.is_below(AT_ONCE_BYTES));
}

// Kind (Slices): the log of SkyScan and NRecon next to slices
TEST_CASE("the log next to slices states their spacing")
{
    const TemporaryFolder folder;
    for (const int64_t z : {0, 1, 2}) folder.write(sentence("bone_rec000", z, ".png"), grey_png(z));
    folder.write("bone.log", "[Acquisition]\r\nImage Pixel Size (um)=9.5\r\n");
    const auto write_log = [&](const std::string& lines) {
        folder.write("bone_rec.log",
                     "[System]\r\nScanner=Skyscan1172\r\n[Acquisition]\r\nImage Pixel Size (um)=  4.0\r\n"
                     "[Reconstruction]\r\n" +
                         lines);
    };
    SUBCASE("the pixel size of the reconstruction, and its step")
    {
        write_log("Pixel Size (um)=17.5\r\nSection to Section Step=2\r\nResult Image Width (pixels)=5\r\n");
        const VolumeInfo info = open_volume(folder.path)->info();
        CHECK(info.spacing == glm::dvec3(17.5, 17.5, 35.0));
        CHECK(info.unit == "um");
        CHECK(info.spacing_from == Provenance::file);
        CHECK(std::ranges::none_of(info.warnings, [](const std::string& text) { return contains(text, "spacing"); }));
    }
    SUBCASE("that of the acquisition, if none is stated for the reconstruction")
    {
        write_log("Section to Section Step=1\r\n");
        CHECK(open_volume(folder.path)->info().spacing == glm::dvec3(4.0));
    }
    SUBCASE("a log of slices of another size, and a malformed one, are left out")
    {
        write_log("Pixel Size (um)=17.5\nResult Image Width (pixels)=10\n");
        const auto source = open_volume(folder.path);
        CHECK(source->info().spacing == glm::dvec3(1.0));
        CHECK(warns_of(*source,
                       "result image width (pixels) is 10; expected 5, as the slices have; this log is left out"));
        write_log("Pixel Size (um)=many\n");
        CHECK(warns_of(*open_volume(folder.path), "is \"many\"; expected a number above 0; this log is left out"));
    }
}
