#include "engine/session/label_looks.h"

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/base/image.h"
#include "engine/formats/zarr/ome_zarr_labels.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// A label image with nothing but these attributes.
class Store {
public:
    explicit Store(const std::string& image_label)
    {
        folder.write(".zattrs", "{\"multiscales\": [], \"image-label\": " + image_label + "}");
    }
    LabelLooks looks() const { return read_label_looks(folder.path); }
    TemporaryFolder folder;
};

GroupSettings look(const std::string& name, std::optional<glm::dvec3> color = {}, std::optional<double> opacity = {},
                   uint8_t parent = 0)
{
    return {.name = name, .parent = parent, .color = color, .opacity = opacity};
}

Mask painted_in(std::initializer_list<uint8_t> groups)
{
    Mask mask({32, 1, 1});
    uint16_t at = 0;
    for (const uint8_t group : groups) {
        mask.apply({0, {{at, at, 0, group}}}, Direction::forwards);
        ++at;
    }
    return mask;
}

}  // namespace

TEST_CASE("looks are those of the groups that are painted or set up, with what they inherit")
{
    Groups groups;
    groups[7] = look("vein", glm::dvec3(1.0, 0.0, srgb_decode(128 / 255.0)), 0.2);
    groups[9] = look("", {}, {}, 7);
    const auto looks = label_looks(groups, painted_in({2, 9}));
    REQUIRE(looks.size() == 3);
    CHECK((looks[0].value == 2 && looks[0].name == "group 2" &&
           looks[0].rgba == std::array<uint8_t, 4>{17, 166, 153, 255}));
    CHECK((looks[1].value == 7 && looks[1].name == "vein" && looks[1].rgba == std::array<uint8_t, 4>{255, 0, 128, 51}));
    CHECK((looks[2].value == 9 && looks[2].name == "group 9" && looks[2].rgba == looks[1].rgba));
}

TEST_CASE("groups that a session does not define take what the label image says, where it says something else")
{
    const Store store(R"({"version": "0.4", "colors": [
        {"label-value": 1, "rgba": [243, 100, 151, 255]}, {"label-value": 2, "rgba": [17, 166, 153, 128]},
        {"label-value": 3, "rgba": [0, 255, 0, 255]}, {"label-value": 4, "rgba": [1, 2, 3, 4]},
        {"label-value": 0, "rgba": [9, 9, 9, 9]}, {"label-value": 256, "rgba": [9, 9, 9, 9]},
        {"label-value": -1, "rgba": [9, 9, 9, 9]}, {"label-value": 3, "rgba": [5, 5, 5, 5]}],
        "properties": [{"label-value": 1, "name": "group 1"}, {"label-value": 5, "name": "wire", "area": 4},
                       {"label-value": 2, "area": 4}, {"label-value": 4, "name": "theirs"}]})");
    Groups groups{{4, look("mine")}};
    CHECK(take_label_looks(store.folder.path, groups).empty());
    REQUIRE(groups.size() == 4);  // 1 has the default look
    CHECK(groups.at(2) == look("", {}, 128 / 255.0));
    CHECK(groups.at(3) == look("", glm::dvec3(0.0, 1.0, 0.0)));
    CHECK(groups.at(4) == look("mine"));
    CHECK(groups.at(5) == look("wire"));
}

TEST_CASE("what was written is read again: the same looks to the last of 8 bits")
{
    Groups groups;
    for (int group = 1; group < 256; ++group)
        groups[uint8_t(group)] = look(sentence("name \"", group, "\" \xc3\xa4"),
                                      glm::dvec3(group / 255.0, 1.0 - group / 300.0, 0.5), group % 17 / 16.0);
    const auto looks = label_looks(groups, Mask({4, 4, 4}));
    const TemporaryFolder folder;
    const MemorySource labels = memory_source({4, 4, 4}, VoxelType::uint8, std::vector<uint8_t>(64));
    export_label_image(labels, folder.path / "a.zarr", {.colors = looks});
    Groups read;
    CHECK(take_label_looks(folder.path / "a.zarr", read).empty());
    const auto again = label_looks(read, Mask({4, 4, 4}));
    REQUIRE(again.size() == looks.size());
    for (size_t i = 0; i < looks.size(); ++i) {
        CHECK(again[i].value == looks[i].value);
        CHECK(again[i].name == looks[i].name);
        CHECK((again[i].rgba == looks[i].rgba));
    }
}

TEST_CASE("entries that are none are left out with one sentence for each list")
{
    const char* const bad_colors[] = {"5",
                                      "null",
                                      "{}",
                                      R"({"label-value": "1", "rgba": [1, 2, 3, 4]})",
                                      R"({"label-value": 1.5, "rgba": [1, 2, 3, 4]})",
                                      R"({"label-value": 18446744073709551615, "rgba": [1, 2, 3, 4]})",
                                      R"({"label-value": 1, "rgba": [1, 2, 3]})",
                                      R"({"label-value": 1, "rgba": [1, 2, 3, 256]})",
                                      R"({"label-value": 1, "rgba": [-1, 2, 3, 4]})",
                                      R"({"label-value": 1, "rgba": [0.5, 2, 3, 4]})",
                                      R"({"label-value": 1, "rgba": "red"})"};
    for (const char* bad : bad_colors) {
        CAPTURE(bad);
        const LabelLooks looks =
            Store(sentence(R"({"colors": [{"label-value": 2, "rgba": [1, 2, 3, 4]}, )", bad, ", ", bad, "]}")).looks();
        CHECK(looks.looks.size() == 1);
        REQUIRE(looks.warnings.size() == 1);
        CHECK(contains(looks.warnings[0], ".zattrs: key image-label.colors.1 is "));
        CHECK(contains(looks.warnings[0], "four whole numbers from 0 to 255; it is left out"));
    }
    const LabelLooks names =
        Store(R"({"colors": {}, "properties": [{"label-value": 1, "name": 5}, {"label-value": 2, "name": "b"}]})")
            .looks();
    REQUIRE(names.warnings.size() == 2);
    CHECK(contains(names.warnings[0], "image-label.colors is {}; expected a list"));
    CHECK(contains(names.warnings[1], "image-label.properties.0 is "));
    REQUIRE(names.looks.size() == 1);
    CHECK((names.looks[0].value == 2 && names.looks[0].name == "b" && !names.looks[0].rgba));
    // A label without a colour.
    CHECK(Store(R"({"colors": [{"label-value": 3}]})").looks().looks.empty());
    CHECK(Store(R"({"colors": [{"label-value": 3}]})").looks().warnings.empty());
}

TEST_CASE("what is no label image says nothing, and a broken one is a warning")
{
    const TemporaryFolder folder;
    Groups groups;
    CHECK(take_label_looks({}, groups).empty());
    CHECK(take_label_looks(folder.path / "none.zarr", groups).empty());
    CHECK(take_label_looks(folder.write("a.mask", "abc"), groups).empty());
    CHECK(Store("5").looks().looks.empty());
    folder.write(".zattrs", R"({"multiscales": []})");
    CHECK(take_label_looks(folder.path, groups).empty());
    folder.write(".zattrs", "{");
    const auto warnings = take_label_looks(folder.path, groups);
    REQUIRE(warnings.size() == 1);
    CHECK(contains(warnings[0], ".zattrs: is not JSON: "));
    CHECK(groups.empty());
}
