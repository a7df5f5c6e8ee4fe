// Content of other programs in an image that is replaced: found, kept by saves, and a reason to refuse exports.

#include "engine/projects/foreign_content.h"

#include <fstream>
#include <functional>
#include <map>

#include <doctest/doctest.h>

#include "engine/annotation/files/mask_import.h"
#include "engine/annotation/files/mask_source.h"
#include "engine/annotation/files/offset_import.h"
#include "engine/projects/import_volume.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

VolumeInfo volume_of(const Size3& size)
{
    VolumeInfo info = volume_of_size(size, {0.5, 0.25, 1.5});
    info.type = VoxelType::uint8;
    info.unit = "um";
    return info;
}

Mask mask_of(const Size3& size)
{
    Mask mask(size);
    MaskBrickChange change{0, {}};
    append_run<uint8_t>(change.runs, 0, 7, 0, 3);
    mask.apply(change, Direction::forwards);
    return mask;
}

LabelImage looks(uint8_t red)
{
    return {.colors = {{3, {red, 2, 3, 4}, "three"}},
            .painted_on = "xxh3-128:00",
            .journal = LabelImage::Journal{"session.journal", 7, 0x12}};
}

void replace_in(const fs::path& file, const std::string& what, const std::string& with)
{
    std::string text = bytes_of_file(file);
    const size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    text.replace(at, what.size(), with);
    std::ofstream(file) << text;
}

std::map<std::string, std::string> files_in(const fs::path& folder)
{
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
        if (!entry.is_directory() && !entry.is_symlink())
            files[entry.path().lexically_relative(folder).string()] = bytes_of_file(entry.path());
    return files;
}

struct Addition {
    const char* named;  ///< as in ForeignContent
    std::function<void(const fs::path& image)> make;
    bool is_in_numbers = true;  ///< likewise in an image of numbers
    bool is_value = false;      ///< an attribute's, which exports may change
};

void write(const fs::path& file, const std::string& text)
{
    fs::create_directories(file.parent_path());
    std::ofstream(file) << text;
}

const std::vector<Addition>& additions()
{
    static const std::string ARRAY = R"({"zarr_format": 2, "shape": [2], "chunks": [2], "dtype": "|u1", "order": "C",
        "compressor": null, "fill_value": 0, "filters": null})";
    static const std::vector<Addition> LIST{
        {"scores", [](const fs::path& image) { write(image / "scores/.zarray", ARRAY); }},
        {"9", [](const fs::path& image) { write(image / "9/.zarray", ARRAY); }},
        {"3",  // a level that halves the one before, which SHVR would not have made
         [](const fs::path& image) {
             fs::copy(image / "2", image / "3", fs::copy_options::recursive);
             replace_in(image / "3/.zarray", "17,\n        17,\n        17", "9,\n        9,\n        9");
         },
         false},
        {".zmetadata", [](const fs::path& image) { write(image / ".zmetadata", "{}"); }},
        {"reviewer in .zattrs",
         [](const fs::path& image) { replace_in(image / ".zattrs", "{", "{\"reviewer\": \"Anna\","); }},
        {"multiscales.omero in .zattrs",
         [](const fs::path& image) { replace_in(image / ".zattrs", "\"version\":", "\"omero\": 1, \"version\":"); }},
        {"image-label.colors in .zattrs", [](const fs::path& image) { replace_in(image / ".zattrs", "200", "201"); },
         false, true},
        {".zattrs", [](const fs::path& image) { write(image / ".zattrs", "{"); }},
        {"0/.zattrs", [](const fs::path& image) { write(image / "0/.zattrs", "{}"); }},
        {"0", [](const fs::path& image) { replace_in(image / "0/.zarray", "{", "{\"note\": 1,"); }},
        {"0/9/9/9", [](const fs::path& image) { write(image / "0/9/9/9", "chunk"); }},
        {"0/00/0/0", [](const fs::path& image) { write(image / "0/00/0/0", "chunk"); }},
        {"0/0.0.0", [](const fs::path& image) { write(image / "0/0.0.0", "chunk"); }},
        {"notes.txt", [](const fs::path& image) { write(image / "notes.txt", "mine"); }},
        {"v3/scores", [](const fs::path& image) { write(image / "v3/scores", "mine"); }},
        {"elsewhere", [](const fs::path& image) { fs::create_symlink("/nowhere", image / "elsewhere"); }},
    };
    return LIST;
}

}  // namespace

// Kind (annotation files): a label image to which another program added arrays, levels, attributes, chunks, or files.
TEST_CASE("what another program adds to a label image is kept by a save, with a message, and refuses an export")
{
    const VolumeInfo volume = volume_of(Size3(66));
    const Mask mask = mask_of(volume.size);
    for (const Addition& addition : additions()) {
        CAPTURE(addition.named);
        const TemporaryFolder folder;
        const fs::path image = folder.path / "m.zarr", old = folder.path / "m.zarr.old";
        CHECK(save_mask_as(image, mask, volume, looks(200), Foreign::kept).empty());
        CHECK(save_mask_as(image, mask, volume, looks(200), Foreign::kept).empty());
        const auto own = files_in(image);
        addition.make(image);
        const auto before = files_in(image);
        const bool is_label_image = fs::file_size(image / ".zattrs") > 1;
        if (is_label_image) {
            CHECK(foreign_content(image, own.at(".zattrs")).names == std::vector<std::string>{addition.named});
            const std::string refused = error_of([&] { save_mask_as(image, mask, volume, looks(200)); });
            CHECK(refused.empty() == addition.is_value);
            if (addition.is_value) addition.make(image);  // replaced by the export
            if (!addition.is_value) CHECK(contains(refused, sentence("holds ", addition.named, " of another program")));
            CHECK(files_in(image) == before);
            const std::string said = save_mask_as(image, mask, volume, looks(200), Foreign::kept);
            CHECK(contains(said, sentence(image.string(), ": held ", addition.named)));
            CHECK(contains(said, "kept as " + old.string()));
            CHECK(files_in(old) == before);
            CHECK(files_in(image) == own);
            CHECK(save_mask_as(image, mask, volume, looks(200), Foreign::kept).empty());
        } else {
            CHECK_FALSE(error_of([&] { save_mask_as(image, mask, volume, looks(200), Foreign::kept); }).empty());
            CHECK(files_in(image) == before);
        }
    }
}

TEST_CASE("the same holds for offsets, and for OME-Zarr 0.5")
{
    const VolumeInfo volume = volume_of(Size3(66));
    const DensityField field(volume.size, volume.type);
    for (const Addition& addition : additions()) {
        if (!addition.is_in_numbers || std::string(addition.named) == ".zattrs") continue;
        CAPTURE(addition.named);
        const TemporaryFolder folder;
        const fs::path image = folder.path / "o.zarr";
        CHECK(save_offsets_as(image, field, volume, Foreign::kept).empty());
        CHECK(save_offsets_as(image, field, volume, Foreign::kept).empty());
        addition.make(image);
        CHECK(contains(save_offsets_as(image, field, volume, Foreign::kept), addition.named));
        CHECK(save_offsets_as(image, field, volume, Foreign::kept).empty());
    }
    const TemporaryFolder folder;
    const fs::path image = folder.path / "m.zarr";
    const auto save = [&] {
        return export_mask(image, mask_of(volume.size), volume, looks(1), OmeZarrVersion::v0_5, {}, Foreign::kept);
    };
    CHECK(save().empty());
    CHECK(save().empty());
    replace_in(image / "zarr.json", "\"zarr_format\": 3", "\"zarr_format\": 3, \"consolidated_metadata\": {}");
    replace_in(image / "zarr.json", "\"ome\":", "\"omero\": 1, \"ome\":");
    CHECK(contains(save(), "held consolidated_metadata in zarr.json, omero in zarr.json of"));
    write(image / "0/c/0/0/1x", "chunk");
    CHECK(contains(save(), "held 0/c/0/0/1x of"));
    CHECK(save().empty());
}

TEST_CASE("files of file browsers neither refuse nor keep an image, and stay in it")
{
    const VolumeInfo volume = volume_of(Size3(66));
    const Mask mask = mask_of(volume.size);
    const TemporaryFolder folder;
    const fs::path image = folder.path / "m.zarr";
    save_mask_as(image, mask, volume);
    for (const char* const name : {".DS_Store", "Thumbs.db", "desktop.ini", "._0", "0/.DS_Store"})
        write(image / name, name);
    const auto before = files_in(image);
    for (const Foreign foreign : {Foreign::kept, Foreign::refused}) {
        CHECK(save_mask_as(image, mask, volume, {}, foreign).empty());
        CHECK(files_in(image) == before);
    }
    CHECK(save_mask_as(image, mask, volume, {}, Foreign::excluded).empty());
    CHECK(bytes_of_file(image / ".DS_Store") == ".DS_Store");
    const MaskSource labels(mask, volume);
    export_label_image(labels, image, {});
    CHECK_FALSE(fs::exists(folder.path / "m.zarr.old"));
}
