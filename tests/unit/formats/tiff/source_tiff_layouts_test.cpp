// TIFFs as writers other than libtiff lay them out (tests/data/make_tiff_layouts.py): what others read, we read, with a
// warning where something had to be taken for granted.

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "tests/support/tiff_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

const fs::path LAYOUTS = "tests/data/tiff_layouts";

std::vector<uint8_t> grey(bool is_inverted = false)
{
    std::vector<uint8_t> voxels;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 5; ++x) voxels.push_back(uint8_t(is_inverted ? 155 - x - 10 * y : x + 10 * y + 100));
    return voxels;
}

const std::vector<uint8_t> BITS{1, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 1, 0};

std::vector<uint8_t> inverted(std::vector<uint8_t> bits)
{
    for (uint8_t& bit : bits) bit = uint8_t(1 - bit);
    return bits;
}

}  // namespace

TEST_CASE("TIFFs of other writers' layouts are read, and what was assumed is said")
{
    struct Layout {
        const char* name;
        std::vector<uint8_t> voxels;
        std::string warns{};  ///< in addition to the warning that no spacing is stated
    };
    const Layout layouts[] = {
        {"directory_cut", grey(), "the directory of page 1 was cut before the offset of a next one"},
        {"odd_offset", grey()},
        {"bilevel_bare", BITS},
        {"bilevel_bare_big_endian", BITS},
        {"bilevel_old_white", inverted(BITS), "in the file 0 is white (MinIsWhite); intensities were inverted"},
        {"bilevel_low_bit_first", BITS},
        {"no_byte_counts", grey()},
        {"no_photometric", grey()},
        {"no_rows_per_strip", grey()},
        {"byte_counts_0", grey()},
        {"byte_counts_too_large", grey(), "page 1 states more bytes in StripByteCounts than the file holds"},
        {"rows_without_end", grey()},
        {"sides_in_bytes", grey()},
        {"old_subfile", grey()},
        {"resolution_0", grey()},
        {"palette_grey", grey()},
        {"palette_grey_of_8_bits", grey()},
        {"palette_inverted", grey(true), "its palette is grey: the palette's greys are taken; --channel index"},
    };
    for (const Layout& layout : layouts) {
        CAPTURE(layout.name);
        const std::unique_ptr<VolumeSource> source = open_volume(LAYOUTS / (layout.name + std::string(".tif")));
        REQUIRE(source->info().size == Size3(5, 4, 1));
        CHECK(voxels_of<uint8_t>(*source) == layout.voxels);
        CHECK(source->info().warnings.size() == (layout.warns.empty() ? 1 : 2));
        if (!layout.warns.empty()) CHECK(warns_of(*source, layout.warns));
    }
    CHECK(size_t(std::distance(fs::directory_iterator(LAYOUTS), fs::directory_iterator())) == std::size(layouts) + 1);
}

TEST_CASE("a palette of colours is the one that has to be chosen from")
{
    const fs::path path = LAYOUTS / "palette_colours.tif";
    CHECK(error_of([&] { open_volume(path); }) == path.string() +
                                                      ": has 4 channels (index, red, green, blue); expected one: "
                                                      "choose with --channel index, red, green or blue");
    CHECK(voxels_of<uint8_t>(*open_volume(path, {.channel = "index"})) == grey());
    CHECK(voxels_of<uint8_t>(*open_volume(path, {.channel = "blue"})) == grey());
}
