// Files that hold more than one volume: colours, palettes, thumbnails, pages of several sizes.

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "tests/support/tiff_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

std::string refusal(const fs::path& path, const OpenOptions& options = {})
{
    const std::string said = error_of([&] { open_volume(path, options); });
    return said.starts_with(path.string()) ? said.substr(path.string().size()) : said;
}

std::vector<uint8_t> voxels_for(const fs::path& path, const std::string& channel)
{
    return voxels_of<uint8_t>(*open_volume(path, {.channel = channel}));
}

std::vector<uint16_t> ramp(size_t entries, double scale)
{
    std::vector<uint16_t> palette;
    for (int color = 0; color < 3; ++color) {
        for (size_t i = 0; i < entries; ++i) palette.push_back(uint16_t(scale * double(i)));
    }
    return palette;
}

TiffSpec square(int side, int bits = 8)
{
    return {.width = side, .height = side, .bits = bits};
}

}  // namespace

TEST_CASE("a colour TIFF names its channels, and gives the one that is chosen")
{
    const TemporaryFolder folder;
    TiffSpec spec{.width = 2, .height = 1, .bits = 8, .samples = 3, .photometric = PHOTOMETRIC_RGB};
    for (const bool is_planar : {false, true}) {
        spec.is_planar = is_planar;
        const fs::path path = write_tiff(folder.path / "x.tif", spec, {"rgbRGB", "stuSTU"});
        CHECK(refusal(path) ==
              ": has 3 channels (red, green, blue); expected one: choose with --channel red, green or blue");
        CHECK(voxels_for(path, "red") == std::vector<uint8_t>{'r', 'R', 's', 'S'});
        CHECK(voxels_for(path, "Green") == std::vector<uint8_t>{'g', 'G', 't', 'T'});
        CHECK(voxels_for(path, "3") == std::vector<uint8_t>{'b', 'B', 'u', 'U'});
        CHECK(refusal(path, {.channel = "alpha"}) == ": has no channel \"alpha\"; expected red, green or blue");
        CHECK(refusal(path, {.channel = "4"}) == ": has no channel \"4\"; expected red, green or blue");
        CHECK(refusal(path, {.channel = "red", .frame = "2"}) == ": has no time point \"2\"; expected 1");
        CHECK(open_volume(path, {.channel = "red", .frame = "1"})->info().size == Size3(2, 1, 2));
    }
    spec.is_planar = false;
    spec.samples = 4;
    for (const std::vector<uint16_t>& extra :
         {std::vector<uint16_t>{EXTRASAMPLE_ASSOCALPHA}, {EXTRASAMPLE_UNASSALPHA}, {EXTRASAMPLE_UNSPECIFIED}, {}}) {
        spec.extra_samples = extra;
        const fs::path path = write_tiff(folder.path / "x.tif", spec, {"rgbaRGBA"});
        CHECK(refusal(path) ==
              ": has 4 channels (red, green, blue, alpha); expected one: choose with --channel red, "
              "green, blue or alpha");
        CHECK(voxels_for(path, "alpha") == std::vector<uint8_t>{'a', 'A'});
    }
}

TEST_CASE("grey with alpha, CMYK and unnamed samples are channels too")
{
    const TemporaryFolder folder;
    TiffSpec grey{.width = 2, .height = 1, .bits = 8, .samples = 2, .extra_samples = {EXTRASAMPLE_UNASSALPHA}};
    const fs::path path = write_tiff(folder.path / "x.tif", grey, {"gaGA"});
    CHECK(refusal(path) == ": has 2 channels (grey, alpha); expected one: choose with --channel grey or alpha");
    CHECK(voxels_for(path, "grey") == std::vector<uint8_t>{'g', 'G'});
    TiffSpec cmyk{.width = 1, .height = 1, .bits = 8, .samples = 4, .photometric = PHOTOMETRIC_SEPARATED};
    CHECK(contains(refusal(write_tiff(path, cmyk, {"cmyk"})), "(cyan, magenta, yellow, black)"));
    CHECK(voxels_for(path, "black") == std::vector<uint8_t>{'k'});
    TiffSpec many{.width = 1, .height = 1, .bits = 8, .samples = 40};
    CHECK(refusal(write_tiff(path, many, {std::string(40, 'x')})) ==
          ": has 40 channels (1, 2, 3, 4, 5, 6, 7, 8, ...); expected one: choose with --channel 1 to 40");
}

TEST_CASE("a palette is read by its numbers or by its colours, and a grey one needs no choice")
{
    const TemporaryFolder folder;
    const fs::path path = folder.path / "x.tif";
    TiffSpec spec{.width = 3, .height = 1, .bits = 8, .photometric = PHOTOMETRIC_PALETTE};
    spec.palette = ramp(256, 257.0);
    write_tiff(path, spec, {std::string("\0\1\xff", 3)});
    CHECK(voxels_for(path, "") == std::vector<uint8_t>{0, 1, 255});

    for (size_t i = 0; i < 256; ++i) spec.palette[i] = uint16_t(257 * (255 - i));  // red falls
    write_tiff(path, spec, {std::string("\0\1\xff", 3)});
    CHECK(refusal(path) ==
          ": has 4 channels (index, red, green, blue); expected one: choose with --channel index, red, green or blue");
    CHECK(voxels_for(path, "index") == std::vector<uint8_t>{0, 1, 255});
    CHECK(voxels_for(path, "red") == std::vector<uint8_t>{255, 254, 0});
    CHECK(voxels_for(path, "blue") == std::vector<uint8_t>{0, 1, 255});

    spec.description = "ImageJ=1.53t\n";  // to ImageJ a palette only displays numbers
    write_tiff(path, spec, {std::string("\0\1\xff", 3)});
    CHECK(voxels_for(path, "") == std::vector<uint8_t>{0, 1, 255});
    CHECK(warns_of(*open_volume(path), "the colours of its lookup table were left out"));

    TiffSpec small{.width = 4, .height = 1, .bits = 4, .photometric = PHOTOMETRIC_PALETTE};
    small.palette = ramp(16, 1000.0);
    write_tiff(path, small, {"\x0f\x21"});
    CHECK(voxels_for(path, "index") == std::vector<uint8_t>{0, 15, 2, 1});
    const auto wide = open_volume(path, {.channel = "green"});
    CHECK(wide->info().type == VoxelType::uint16);
    CHECK(voxels_of<uint16_t>(*wide) == std::vector<uint16_t>{0, 15000, 2000, 1000});
    const auto grey = open_volume(path);
    CHECK(voxels_of<uint16_t>(*grey) == std::vector<uint16_t>{0, 15000, 2000, 1000});
    CHECK(warns_of(*grey, "its palette is grey: the palette's greys are taken; --channel index takes its numbers"));
}

TEST_CASE("thumbnails and masks are left out, and it is said")
{
    const TemporaryFolder folder;
    const fs::path path = folder.path / "x.tif";
    {
        TiffWriter writer(path, "wl");
        TiffSpec thumbnail = square(2);
        thumbnail.subfile_type = FILETYPE_REDUCEDIMAGE;
        TiffSpec mask = square(4);
        mask.subfile_type = FILETYPE_MASK;
        for (const char voxel : {'a', 'b', 'c'}) {  // interleaved, as a microscope's software does
            writer.page(square(4), std::string(16, voxel));
            writer.page(thumbnail, std::string(4, 't'));
        }
        writer.page(mask, std::string(16, 'm'));
    }
    const auto source = open_volume(path);
    CHECK(source->info().size == Size3(4, 4, 3));
    CHECK(voxels_in<uint8_t>(*source, {{3, 3, 0}, {4, 4, 3}}) == std::vector<uint8_t>{'a', 'b', 'c'});
    CHECK(warns_of(*source, "4 pages are smaller copies or masks and were left out"));

    TiffSpec alone = square(2);
    alone.subfile_type = FILETYPE_REDUCEDIMAGE;
    CHECK(open_volume(write_tiff(path, alone, {"abcd"}))->info().size == Size3(2, 2, 1));
}

TEST_CASE("of series of pages the largest is taken, and what lies within it is refused")
{
    const TemporaryFolder folder;
    const fs::path path = folder.path / "x.tif";
    {
        TiffWriter writer(path, "wl");
        writer.page(square(3), std::string(9, 'l'));
        for (const char voxel : {'a', 'b'}) writer.page(square(4), std::string(16, voxel));
        writer.page(square(4, 16), std::string(32, 'w'));
        writer.page(square(2), std::string(4, 's'));
    }
    const auto source = open_volume(path);
    CHECK(source->info().size == Size3(4, 4, 2));
    CHECK(voxels_in<uint8_t>(*source, {{0, 0, 0}, {1, 1, 2}}) == std::vector<uint8_t>{'a', 'b'});
    CHECK(warns_of(*source,
                   "1 page of 3x3 pixels of uint8 from page 1 on was left out: the volume is the 2 pages of 4x4 "
                   "pixels of uint8"));
    CHECK(warns_of(*source, "1 page of 4x4 pixels of uint16 from page 4 on was left out"));
    fs::remove(path);
    {
        TiffWriter writer(path, "wl");
        writer.page(square(4), std::string(16, 'a'));
        writer.page(square(3), std::string(9, 'l'));
        for (const char voxel : {'b', 'c'}) writer.page(square(4), std::string(16, voxel));
    }
    CHECK(refusal(path) ==
          ": page 2 has 3x3 pixels of uint8; expected 4x4 pixels of uint8, as the pages before and after it");
}

TEST_CASE("pages may be stored in different ways")
{
    const TemporaryFolder folder;
    const fs::path path = folder.path / "x.tif";
    {
        TiffWriter writer(path, "wb");
        TiffSpec spec = square(4, 16);
        std::vector<uint16_t> page(16, 1000);
        writer.page(spec, bytes_of_numbers(page));
        spec.compression = COMPRESSION_LZW;
        spec.rows_per_strip = 1;
        writer.page(spec, bytes_of_numbers(std::vector<uint16_t>(16, 2000)));
        spec.tile = 16;
        spec.compression = COMPRESSION_ADOBE_DEFLATE;
        writer.page(spec, bytes_of_numbers(std::vector<uint16_t>(16, 3000)));
    }
    const auto source = open_volume(path);
    CHECK(source->info().size == Size3(4, 4, 3));
    CHECK(voxels_in<uint16_t>(*source, {{3, 3, 0}, {4, 4, 3}}) == std::vector<uint16_t>{1000, 2000, 3000});
}

TEST_CASE("stacks of other programs that are no pages are refused by name")
{
    const TemporaryFolder folder;
    TiffSpec spec = square(2);
    spec.more = [](TIFF* tiff) {
        static const TIFFFieldInfo FIELD[] = {
            {33629, 1, 1, TIFF_LONG, FIELD_CUSTOM, 1, 0, const_cast<char*>("UIC2Tag")}};
        TIFFMergeFieldInfo(tiff, FIELD, 1);
        TIFFSetField(tiff, 33629, 7u);
    };
    const fs::path path = write_tiff(folder.path / "x.stk", spec, {"abcd"});
    CHECK(refusal(path) ==
          ": is a stack of MetaMorph (UIC2); expected a TIFF with a page for each slice: save it as "
          "TIFF, for example from Fiji");
}
