#include "engine/base/image.h"

#include <doctest/doctest.h>
#include <png.h>
#include <sys/resource.h>
#include <tiffio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <string>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/image_file.h"
#include "engine/base/image_tiff.h"
#include "tests/support/bounds.h"

using namespace shvr;

namespace {

/// The PNG that libpng makes of pixels in one of its formats. It takes 16-bit formats as linear, and the file says so.
std::vector<std::byte> png_of(png_uint_32 format, int width, int height, const void* pixels, const void* palette = {},
                              png_uint_32 palette_entries = 0)
{
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = format;
    image.colormap_entries = palette_entries;
    std::vector<std::byte> file(4096 + 16 * size_t(width * height));
    png_alloc_size_t bytes = file.size();
    REQUIRE(png_image_write_to_memory(&image, file.data(), &bytes, 0, pixels, 0, palette) != 0);
    file.resize(bytes);
    return file;
}

void append_number(std::vector<std::byte>& file, uint32_t number)
{
    for (const int shift : {24, 16, 8, 0}) file.push_back(std::byte(number >> shift));
}

void append_chunk(std::vector<std::byte>& file, const std::string& type, const std::string& data)
{
    append_number(file, uint32_t(data.size()));
    const std::string content = type + data;
    uint32_t crc = 0xffffffffu;
    for (const char c : content) {
        crc ^= uint8_t(c);
        for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
    }
    for (const char c : content) file.push_back(std::byte(c));
    append_number(file, ~crc);
}

/// A PNG file of one stored (uncompressed) deflate block; `rows` holds a filter byte before each row.
std::vector<std::byte> bare_png(uint32_t width, uint32_t height, char depth, char type, const std::string& rows,
                                const std::string& transparency = {})
{
    std::vector<std::byte> file;
    for (const char c : {'\x89', 'P', 'N', 'G', '\r', '\n', '\x1a', '\n'}) file.push_back(std::byte(c));
    std::vector<std::byte> sizes;
    append_number(sizes, width);
    append_number(sizes, height);
    std::string header(reinterpret_cast<const char*>(sizes.data()), sizes.size());
    append_chunk(file, "IHDR", header + depth + type + std::string(3, '\0'));
    if (!transparency.empty()) append_chunk(file, "tRNS", transparency);
    uint32_t a = 1, b = 0;
    for (const char c : rows) {
        a = (a + uint8_t(c)) % 65521;
        b = (b + a) % 65521;
    }
    const auto low = [](size_t number) { return char(number & 0xff); };
    const auto high = [](size_t number) { return char(number >> 8 & 0xff); };
    const std::string block{
        '\x78', '\x01', '\x01', low(rows.size()), high(rows.size()), low(~rows.size()), high(~rows.size())};
    append_chunk(file, "IDAT", block + rows + std::string{high(b), low(b), high(a), low(a)});
    append_chunk(file, "IEND", {});
    return file;
}

Image8 noise(int width, int height, unsigned seed)
{
    std::mt19937 random(seed);
    Image8 image{width, height, {}};
    for (int value = 0; value < 4 * width * height; ++value) image.rgba.push_back(uint8_t(random()));
    return image;
}

bool holds_chunk(const std::vector<std::byte>& file, const char* type)
{
    const std::string text(reinterpret_cast<const char*>(file.data()), file.size());
    return text.find(type) != std::string::npos;
}

ImageF one_pixel(float red, float green, float blue, float alpha)
{
    return {1, 1, {red, green, blue, alpha}};
}

std::vector<uint8_t> bytes_of(float red, float green, float blue, float alpha)
{
    return to_image8(one_pixel(red, green, blue, alpha)).rgba;
}

constexpr float NOT_A_NUMBER = std::numeric_limits<float>::quiet_NaN();
constexpr float ENDLESS = std::numeric_limits<float>::infinity();

}  // namespace

TEST_CASE("the sRGB curve goes through its anchors")
{
    // Published values, to the published digits.
    for (const auto& [linear, level, digits] :
         {std::array{0.0031308, 10.3, 0.05}, {0.18, 117.65, 0.005}, {0.2140411, 127.50, 0.005}, {0.5, 187.52, 0.005}}) {
        CAPTURE(linear);
        test::check_below("levels of 255, to the published digit",
                          std::abs(255.0 * srgb_encode(linear) - level) / digits, 1.0);
    }
    CHECK(srgb_encode(0.0) == 0.0);
    CHECK(srgb_encode(1.0) == doctest::Approx(1.0).epsilon(1e-15));
}

TEST_CASE("decoding undoes encoding")
{
    double largest = 0.0;
    for (int step = 0; step <= 100000; ++step) {
        const double linear = step / 100000.0;
        largest = std::max(largest, std::abs(srgb_decode(srgb_encode(linear)) - linear));
    }
    test::check_below("largest", largest, 1e-8);
}

TEST_CASE("256 greys come back from linear light as they were")
{
    for (int level = 0; level < 256; ++level) {
        const auto linear = float(srgb_decode(level / 255.0));
        const auto grey = uint8_t(level);
        CAPTURE(level);
        const std::vector<uint8_t> found = bytes_of(linear, linear, linear, 1.0f);
        CHECK(found == std::vector<uint8_t>{grey, grey, grey, 255});
        test::check_below("levels off", std::abs(double(found[0]) - level), 0.0);
    }
}

TEST_CASE("premultiplied colour is divided by alpha before it is encoded")
{
    CHECK(bytes_of(0.25f, 0.5f, 0.125f, 0.5f) == std::vector<uint8_t>{188, 255, 137, 128});
    SUBCASE("nothing is left where alpha is nothing")
    {
        CHECK(bytes_of(0.5f, 0.5f, 0.5f, 0.0f) == std::vector<uint8_t>{0, 0, 0, 0});
        CHECK(bytes_of(0.001f, 0.001f, 0.001f, 0.001f) == std::vector<uint8_t>{0, 0, 0, 0});
    }
    SUBCASE("what is out of range is moved into it")
    {
        CHECK(bytes_of(7.0f, -1.0f, 1.0f, 1.0f) == std::vector<uint8_t>{255, 0, 255, 255});
        CHECK(bytes_of(1.0f, 1.0f, 1.0f, 3.0f) == std::vector<uint8_t>{156, 156, 156, 255});
    }
}

TEST_CASE("values that are no numbers are counted and become defined bytes")
{
    const ImageF image{2, 1, {NOT_A_NUMBER, ENDLESS, -ENDLESS, 1.0f, 0.0f, 0.5f, 0.0f, NOT_A_NUMBER}};
    CHECK(count_not_finite(image) == 4);
    CHECK(to_image8(image).rgba == std::vector<uint8_t>{0, 255, 0, 255, 0, 0, 0, 0});
    CHECK(count_not_finite(one_pixel(0.0f, 1.0f, 2.0f, 3.0f)) == 0);
}

TEST_CASE("a picture comes back from a PNG file as it was")
{
    for (const auto& [width, height] : {std::pair(1, 1), {256, 1}, {1, 300}, {37, 41}}) {
        const Image8 image = noise(width, height, 1);
        const auto file = encode_png(image, "noise");
        CHECK(decode_png(file, "noise") == image);
        CHECK(holds_chunk(file, "sRGB"));
    }
}

TEST_CASE("PNG files of every kind become 8-bit RGBA")
{
    const auto pixel = [](const std::vector<std::byte>& file, size_t x) {
        const Image8 image = decode_png(file, "test");
        return std::vector<uint8_t>(&image.rgba[4 * x], &image.rgba[4 * x] + 4);
    };
    SUBCASE("grey")
    {
        const uint8_t grey[] = {0, 77, 255};
        CHECK(pixel(png_of(PNG_FORMAT_GRAY, 3, 1, grey), 1) == std::vector<uint8_t>{77, 77, 77, 255});
    }
    SUBCASE("grey with alpha")
    {
        const uint8_t grey[] = {77, 9};
        CHECK(pixel(png_of(PNG_FORMAT_GA, 1, 1, grey), 0) == std::vector<uint8_t>{77, 77, 77, 9});
    }
    SUBCASE("RGB")
    {
        const uint8_t colors[] = {1, 2, 3, 4, 5, 6};
        CHECK(pixel(png_of(PNG_FORMAT_RGB, 2, 1, colors), 1) == std::vector<uint8_t>{4, 5, 6, 255});
    }
    SUBCASE("palette with alpha")
    {
        const uint8_t palette[] = {1, 2, 3, 255, 10, 20, 30, 40};
        const uint8_t indices[] = {0, 1};
        const auto file = png_of(PNG_FORMAT_RGBA_COLORMAP, 2, 1, indices, palette, 2);
        CHECK(pixel(file, 0) == std::vector<uint8_t>{1, 2, 3, 255});
        CHECK(pixel(file, 1) == std::vector<uint8_t>{10, 20, 30, 40});
    }
    SUBCASE("1 bit, one colour transparent")
    {
        const auto file = bare_png(3, 1, 1, 0, std::string{'\0', '\x40'}, std::string(2, '\0'));
        CHECK(pixel(file, 0) == std::vector<uint8_t>{0, 0, 0, 0});
        CHECK(pixel(file, 1) == std::vector<uint8_t>{255, 255, 255, 255});
    }
    SUBCASE("16 bits in linear light, as the file says")
    {
        const uint16_t linear[] = {0, 32768, 65535};
        const std::vector<uint8_t> middle = pixel(png_of(PNG_FORMAT_LINEAR_Y, 3, 1, linear), 1);
        // 188 by the exact curve; libpng takes a power of 2.2 for it.
        CHECK(middle == std::vector<uint8_t>{186, 186, 186, 255});
    }
}

TEST_CASE("16-bit values without a word on light are sRGB and rounded to nearest")
{
    std::string row(1, '\0');
    for (int level = 0; level < 256; ++level) {
        // The outermost 16-bit values that are nearest to this level: 257 * level -+ 128.
        const int offset = level % 2 == 0 ? std::max(-128, -257 * level) : std::min(128, 257 * (255 - level));
        row += char((257 * level + offset) >> 8);
        row += char((257 * level + offset) & 0xff);
    }
    const Image8 image = decode_png(bare_png(256, 1, 16, 0, row), "test");
    for (size_t level = 0; level < 256; ++level) CHECK(image.rgba[4 * level] == level);
}

TEST_CASE("a PNG file cut anywhere is refused in words")
{
    const auto file = encode_png(noise(64, 48, 2), "noise");
    for (size_t size = 0; size < file.size(); size += size + 128 < file.size() ? 64 : 1) {
        CAPTURE(size);
        CHECK_THROWS_AS(decode_png(std::span(file).first(size), "cut"), Error);
    }
}

TEST_CASE("a PNG file with changed bytes is read or refused, and nothing else")
{
    const auto file = encode_png(noise(16, 16, 3), "noise");
    std::mt19937 random(4);
    int refused = 0;
    for (int round = 0; round < 2000; ++round) {
        auto changed = file;
        changed[random() % changed.size()] ^= std::byte(1u << random() % 8);
        try {
            const Image8 image = decode_png(changed, "changed");
            CHECK(image.rgba.size() == 4 * size_t(image.width) * size_t(image.height));
        } catch (const Error&) {
            ++refused;
        }
    }
    CHECK(refused > 1000);
}

TEST_CASE("hostile sizes are refused before the pixels take memory")
{
    const auto refusal = [](uint32_t width, uint32_t height) {
        try {
            static_cast<void>(decode_png(bare_png(width, height, 8, 6, std::string(5, '\0')), "bad.png"));
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(refusal(0, 1) == "bad.png: the picture is 0 x 1 pixels; expected 1 to 268435456 of them");
    CHECK(refusal(0xffffffffu, 0xffffffffu) ==
          "bad.png: the picture is 4294967295 x 4294967295 pixels; expected 1 to 268435456 of them");
    CHECK(refusal(16385, 16384).find("expected 1 to 268435456 of them") != std::string::npos);
    CHECK(refusal(16384, 16384) ==
          "bad.png: holds 73 bytes, too few for the 16384 x 16384 pixels that its header tells of");
    CHECK_THROWS_AS(encode_png({0, 0, {}}, "empty"), Error);
    CHECK_THROWS_AS(encode_png({1 << 15, 1 << 15, {}}, "large"), Error);
}

TEST_CASE("what is no PNG file is named")
{
    const std::string text = "GIF89a, which this is not either";
    CHECK_THROWS_WITH_AS(decode_png(std::as_bytes(std::span(text)), "a.gif"), "a.gif: is no PNG file", Error);
    CHECK_THROWS_WITH_AS(read_png("/missing/a.png"), "/missing/a.png: cannot be opened: No such file or directory",
                         Error);
}

TEST_CASE("PNG files are written and read by path")
{
    const auto path = std::filesystem::temp_directory_path() / ("shvr image test " + std::to_string(::getpid()));
    const Image8 first = noise(8, 9, 5), second = noise(9, 8, 6);
    write_png(path, first);
    CHECK(read_png(path) == first);
    write_png(path, second);
    CHECK(read_png(path) == second);
    std::filesystem::remove(path);
}

namespace {

ImageF noise_of_light(int width, int height)
{
    const Image8 bytes = noise(width, height, 7);
    ImageF image{width, height, {}};
    for (const uint8_t byte : bytes.rgba) image.rgba.push_back(float(byte) / 200.0f);
    return image;
}

/// Adds an image's rows a few at a time.
void add_in_bands(ImageWriter& writer, const ImageF& image, int band)
{
    const size_t row = 4 * size_t(image.width);
    for (int y = 0; y < image.height; y += band) {
        const int rows = std::min(band, image.height - y);
        const auto from = image.rgba.begin() + std::ptrdiff_t(row) * y;
        writer.add({image.width, rows, {from, from + std::ptrdiff_t(row) * rows}});
    }
}

std::vector<std::byte> bytes_in(const std::filesystem::path& path)
{
    return read_file(path, 1 << 24);
}

}  // namespace

TEST_CASE("pictures written row by row have the bytes of those written at once")
{
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("shvr rows test " + std::to_string(::getpid()));
    std::filesystem::create_directory(folder);
    const ImageF image = noise_of_light(61, 47);
    write_png(folder / "whole.png", to_image8(image));
    write_pfm(folder / "whole.pfm", image);
    CHECK(read_png(folder / "whole.png") == to_image8(image));
    for (const char* extension : {".png", ".pfm"})
        for (const int band : {1, 5, 47}) {
            CAPTURE(band);
            const std::filesystem::path path = folder / (std::string("rows") + extension);
            const std::unique_ptr<ImageWriter> writer = image_writer(path, image.width, image.height);
            add_in_bands(*writer, image, band);
            CHECK(!std::filesystem::exists(path));
            writer->commit();
            CHECK(bytes_in(path) == bytes_in(folder / (std::string("whole") + extension)));
            std::filesystem::remove(path);
        }

    // Abandoned, a picture leaves the old file and nothing else.
    const std::vector<std::byte> before = bytes_in(folder / "whole.png");
    {
        const std::unique_ptr<ImageWriter> writer = image_writer(folder / "whole.png", 61, 47);
        add_in_bands(*writer, noise_of_light(61, 20), 5);
    }
    CHECK(bytes_in(folder / "whole.png") == before);
    CHECK(std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()) == 2);
    std::filesystem::remove_all(folder);
}

TEST_CASE("a TIFF has the pixels of the PNG, its texts and its resolution")
{
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("shvr tiff test " + std::to_string(::getpid()));
    std::filesystem::create_directory(folder);
    const std::filesystem::path path = folder / "a.tif";
    const PictureTexts texts{{"SHVR session", "{\"a\": \"\u00e4\"}"}, {PICTURE_DPI, "300"}, {"SHVR project", "b"}};
    for (const bool is_opaque : {true, false}) {
        CAPTURE(is_opaque);
        ImageF image = noise_of_light(700, 410);  // several strips, the last one not full
        for (size_t at = 0; at < image.rgba.size(); at += 4)
            if (is_opaque || at < image.rgba.size() / 2) image.rgba[at + 3] = 1.0f;  // transparent only further down
        const std::unique_ptr<ImageWriter> writer = image_writer(path, image.width, image.height, texts);
        add_in_bands(*writer, image, 37);
        writer->commit();
        CHECK(read_tiff_text(path, "SHVR session") == texts[0].second);
        CHECK(read_tiff_text(path, "SHVR project") == "b");
        CHECK(read_tiff_text(path, PICTURE_DPI) == "300");
        TIFF* const tiff = TIFFOpen(path.c_str(), "r");
        REQUIRE(tiff);
        const Image8 expected = to_image8(image);
        uint16_t samples = 0, unit = 0;
        float resolution = 0.0f;
        TIFFGetField(tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
        TIFFGetField(tiff, TIFFTAG_RESOLUTIONUNIT, &unit);
        TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &resolution);
        CHECK(samples == (is_opaque ? 3 : 4));
        CHECK(unit == RESUNIT_INCH);
        CHECK(resolution == 300.0f);
        int different = 0;
        std::vector<uint8_t> row(size_t(TIFFScanlineSize(tiff)));
        for (int y = 0; y < image.height; ++y) {
            CHECK(TIFFReadScanline(tiff, row.data(), uint32_t(y)) == 1);
            for (int x = 0; x < image.width; ++x)
                for (int c = 0; c < samples; ++c)
                    different += row[size_t(x * samples + c)] != expected.rgba[size_t(4 * (y * image.width + x) + c)];
        }
        CHECK(different == 0);
        TIFFClose(tiff);
    }
    const std::vector<std::byte> whole = bytes_in(path);
    for (size_t length = 0; length < whole.size(); length += 1 + whole.size() / 97) {
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(whole.data()), std::streamsize(length));
        CHECK(read_tiff_text(path, "SHVR session") == std::nullopt);
    }
    CHECK_THROWS_WITH_AS(image_writer(path, 40000, 40000), doctest::Contains("choose a name that ends in .png"), Error);
    std::filesystem::remove_all(folder);
}

TEST_CASE("a picture may have 65536 pixels along each side and no more")
{
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("shvr sides test " + std::to_string(::getpid()) + ".png");
    CHECK_NOTHROW(image_writer(path, 65536, 65536));
    for (const auto& [width, height] : {std::pair{65537, 1}, {1, 65537}, {0, 1}, {1, 0}})
        CHECK_THROWS_WITH_AS(image_writer(path, width, height),
                             sentence(path.string(), ": the picture is ", width, " x ", height,
                                      " pixels; expected 1 to 65536 along each side")
                                 .c_str(),
                             Error);
    CHECK(!std::filesystem::exists(path));
}

TEST_CASE("a picture that the disk does not take fails with the system's reason")
{
    // Noise fills the 8 KiB that libpng buffers many times over; the writer stops at the first refused byte.
    const std::unique_ptr<ImageWriter> full =
        image_writer(std::filesystem::temp_directory_path() / "shvr full test.png", 300, 300);
    rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
    void (*old_handler)(int) = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{4096, before.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
    std::string said;
    try {
        full->add(noise_of_light(300, 300));
    } catch (const Error& error) {
        said = error.what();
    }
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, old_handler);
    CHECK(said.find("shvr full test.png: cannot be written: File too large") != std::string::npos);
}

TEST_CASE("texts in a picture come back as they were, and damaged ones are refused")
{
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("shvr-texts-" + std::to_string(::getpid()) + ".png");
    std::string longer;
    for (int i = 0; i < 50000; ++i) longer += "wörter ";
    Image8 image{3, 2, std::vector<uint8_t>(24, 200)};
    write_png(path, image, {{"SHVR session", "{\"a\": 1}"}, {"SHVR project", longer}});
    CHECK(read_png_text(path, "SHVR session") == "{\"a\": 1}");
    CHECK(read_png_text(path, "SHVR project") == longer);
    CHECK(read_png_text(path, "other") == std::nullopt);
    CHECK((read_png(path).rgba == image.rgba));
    CHECK(std::filesystem::file_size(path) < longer.size() / 10);  // they are compressed

    std::vector<std::byte> file = read_file(path, 1 << 20);
    const std::vector<std::byte> whole = file;
    const auto write = [&](const std::vector<std::byte>& bytes) {
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    };
    file[100] ^= std::byte{1};  // in the first text
    write(file);
    CHECK_THROWS_WITH_AS(static_cast<void>(read_png_text(path, "SHVR session")),
                         doctest::Contains("its texts cannot be read"), Error);
    write({whole.begin(), whole.begin() + 90});
    CHECK_THROWS_AS(static_cast<void>(read_png_text(path, "SHVR session")), Error);
    write({whole.begin(), whole.begin() + 4});
    CHECK(read_png_text(path, "SHVR session") == std::nullopt);
    CHECK_THROWS_WITH_AS(write_png(path, image, {{"k", std::string(MAX_PICTURE_TEXT + 1, 'x')}}),
                         doctest::Contains("expected at most"), Error);
    std::filesystem::remove(path);
}
