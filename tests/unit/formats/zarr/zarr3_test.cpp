// Features of Zarr version 3 and of archives that version 2 lacks: shards, checksums, other spellings, the layouts of
// other programs (tests/data/make_zarr3.py); and damaged or malicious files of both.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "engine/formats/open_volume.h"
#include "engine/formats/zarr/crc32c.h"
#include "engine/formats/zarr/ome_zarr_labels.h"
#include "engine/formats/zarr/zarr_chunks.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path DATA = "tests/data/zarr3";  // tests run in the repository's root

int phantom(int64_t x, int64_t y, int64_t z)
{
    return int(x + 10 * y + 100 * z - 99);
}

std::vector<fs::path> forms_of(const std::string& name)
{
    return {DATA / name, DATA / (name + ".ozx")};
}

/// A copy of one of the examples, for tests to damage.
class Copy : public TemporaryFolder {
public:
    explicit Copy(const std::string& name) : root(path / name)
    {
        fs::copy(DATA / name, root, fs::copy_options::recursive);
    }
    std::string refusal() const
    {
        return error_of([&] { voxels_of<int16_t>(*open_volume(root)); });
    }
    void write(const std::string& file, std::string_view content) const
    {
        std::ofstream(root / file, std::ios::binary).write(content.data(), std::streamsize(content.size()));
    }
    std::string read(const std::string& file) const { return bytes_of_file(root / file); }
    void change(const std::string& file, const std::function<void(Json&)>& change) const
    {
        Json document = Json::parse(read(file));
        change(document);
        write(file, document.dump());
    }
    /// The message after a change of zarr.json.
    std::string refusal_after(const std::function<void(Json&)>& change) const
    {
        this->change("zarr.json", change);
        const Effort effort;
        std::string said = refusal();
        CHECK(effort.is_below(AT_ONCE_BYTES));
        return said;
    }

    fs::path root;
};

std::string refusal_of(const fs::path& path)
{
    return error_of([&] { voxels_of<int16_t>(*open_volume(path)); });
}

template <class T>
T number_at(const std::string& bytes, size_t at)
{
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

template <class T>
void set_number(std::string& bytes, size_t at, T value)
{
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}

/// Makes the checksum of an index at the end of a shard hold again.
void sign(std::string& shard, size_t index_bytes)
{
    const size_t begin = shard.size() - index_bytes - 4;
    set_number(shard, shard.size() - 4, crc32c(std::as_bytes(std::span(shard.data() + begin, index_bytes))));
}

}  // namespace

TEST_CASE("zarr 3: the checksum is that of RFC 3720")
{
    const auto of = [](std::string_view text) { return crc32c(std::as_bytes(std::span(text))); };
    CHECK(of("123456789") == 0xe3069283u);
    CHECK(of("") == 0u);
    CHECK(of(std::string(32, '\0')) == 0x8a9136aau);
    CHECK(of(std::string(32, '\xff')) == 0x62a8ab43u);
    std::string ascending;
    for (int i = 0; i < 32; ++i) ascending += char(i);
    CHECK(of(ascending) == 0x46dd794eu);
}

TEST_CASE("zarr 3: shards in every form give their chunks")
{
    for (const char* name : {"shard_end", "shard_start", "shard_usual", "shard_small", "shard_index_big",
                             "shard_checksums", "shard_transposed", "shard_reversed"}) {
        for (const fs::path& path : forms_of(name)) {
            CAPTURE(path);
            CHECK(is_chirality_phantom(*open_volume(path)));
        }
    }
    CHECK(open_volume(DATA / "shard_end")->block() == Size3(3, 4, 2));
    CHECK(open_volume(DATA / "shard_transposed")->block() == Size3(3, 4, 2));
    for (const fs::path& path : forms_of("shard_shared"))
        CHECK(voxels_of<int16_t>(*open_volume(path)) == std::vector<int16_t>(96, 7));
}

TEST_CASE("zarr 3: chunks without a place in their shard, and shards that are not there, hold the fill value")
{
    for (const fs::path& path : forms_of("shard_sparse")) {
        CAPTURE(path);
        const auto source = open_volume(path);
        const std::vector<int16_t> voxels = voxels_of<int16_t>(*source);
        REQUIRE(voxels.size() == 60);
        for (int i = 0; i < 60; ++i) {
            const int x = i % 5;
            CHECK(voxels[size_t(i)] == (x < 2 || x == 4 ? -7 : phantom(x, i / 5 % 4, i / 20)));
        }
        CHECK_FALSE(source->brick_range(0, {0, 0, 0}).has_value());
    }
}

TEST_CASE("zarr 3: every spelling of keys, names and codecs")
{
    for (const char* name : {"keys_default", "keys_short", "keys_v2", "keys_v2_slash", "checksum_after",
                             "checksum_before", "checksum_alone", "transpose_twice", "needless_keys"}) {
        for (const fs::path& path : forms_of(name)) {
            CAPTURE(path);
            CHECK(is_chirality_phantom(*open_volume(path)));
        }
    }
    for (const fs::path& path : forms_of("short_names")) {
        const std::vector<uint8_t> voxels = voxels_of<uint8_t>(*open_volume(path));
        REQUIRE(voxels.size() == 60);
        CHECK(voxels[0] == 1);
        CHECK(voxels[59] == uint8_t(phantom(4, 3, 2) + 100));
    }
}

TEST_CASE("zarr 3: an array that names its axes is read along them")
{
    for (const fs::path& path : forms_of("axes_named")) {
        const auto source = open_volume(path);
        CHECK(is_chirality_phantom(*source));
        CHECK_FALSE(warns_of(*source, "does not name its axes"));
    }
    const Copy partly("axes_named");
    partly.change("zarr.json", [](Json& node) { node["dimension_names"] = {nullptr, "x", "x", "y"}; });
    CHECK(contains(partly.refusal(), "key shape is [5,1,3,4]; expected three axes z, y, x, all others 1 voxel long"));
}

TEST_CASE("zarr 3: fill values by their bits, as words, and null")
{
    for (size_t form = 0; form < 2; ++form) {
        const auto last = [&](const char* name, auto zero) {
            const auto voxels = voxels_of<decltype(zero)>(*open_volume(forms_of(name)[form]));
            REQUIRE(voxels.size() == 60);
            CHECK(voxels[0] == decltype(zero)(-99));
            return voxels[4];  // x is 4: the chunk that is not there
        };
        CHECK(std::isnan(last("fills_hex_nan", 0.0F)));
        CHECK(last("fills_hex_number", 0.0F) == -7.0F);
        CHECK(last("fills_hex_double", 0.0) == 7.0);
        CHECK(last("fills_positive_infinity", 0.0F) == std::numeric_limits<float>::infinity());
        CHECK(last("fills_null", int16_t{0}) == 0);
    }
}

TEST_CASE("ome-zarr 0.5: the layouts of other programs, as folders and as archives")
{
    for (const char* name : {"layout_ngff_zarr", "layout_tensorstore", "series", "with_labels"}) {
        for (const fs::path& path : forms_of(name)) {
            CAPTURE(path);
            const auto source = open_volume(path);
            CHECK(is_chirality_phantom(*source));
            CHECK(source->levels() == 3);
            CHECK(source->info().spacing == glm::dvec3(0.5, 0.5, 1.25));
            CHECK(source->info().unit == "mm");
            CHECK(source->info().warnings.empty());
        }
    }
    // A path may lead into an archive.
    for (const char* path : {"series.ozx/0", "series.ozx/0/", "series.ozx", "zip_two_images.ozx/1"})
        CHECK(is_chirality_phantom(*open_volume(DATA / path)));
    CHECK(is_chirality_phantom(*open_volume(DATA / "series.ozx/0/0", {.channel = "1", .frame = "1"})));
    CHECK(open_volume(DATA / "zip_two_images.ozx/1")->info().name == "1");
    CHECK(contains(refusal_of(DATA / "zip_two_images.ozx"), "zip_two_images.ozx/0"));
    CHECK(contains(refusal_of(DATA / "series.ozx/7"), "has no zarr.json here"));
}

TEST_CASE("ome-zarr 0.5: labels have their names and colours")
{
    for (const fs::path& path : forms_of("with_labels")) {
        CAPTURE(path);
        const fs::path labels = path / "labels/cells";
        const std::vector<uint8_t> voxels = voxels_of<uint8_t>(*open_volume(labels));
        REQUIRE(voxels.size() == 60);
        for (int i = 0; i < 60; ++i) CHECK(voxels[size_t(i)] == (phantom(i % 5, i / 5 % 4, i / 20) > 100 ? 3 : 0));
        const LabelLooks found = read_label_looks(labels);
        REQUIRE(found.looks.size() == 1);
        CHECK(found.looks[0].value == 3);
        CHECK(found.looks[0].name == "vessel");
        CHECK(found.looks[0].rgba == std::array<uint8_t, 4>{255, 128, 0, 128});
        CHECK(read_label_looks(path).looks.empty());
    }
}

TEST_CASE("ome-zarr 0.5: other versions, and attributes in the wrong place, are refused in words")
{
    for (const fs::path& path : forms_of("version_later")) {
        CHECK(contains(refusal_of(path),
                       "zarr.json: key attributes.ome.version is \"0.6\"; expected \"0.5\": earlier "
                       "versions have Zarr version 2, and later ones are not supported yet"));
    }
    for (const fs::path& path : forms_of("version_unknown"))
        CHECK(contains(refusal_of(path), "key attributes.ome.version is missing; expected the version of OME-Zarr"));
    for (const fs::path& path : forms_of("version_not_in_ome"))
        CHECK(contains(refusal_of(path), "key attributes.ome is missing; expected the attributes of OME-Zarr 0.5"));
    const Copy lacking("image_04");
    CHECK(contains(lacking.refusal_after([](Json& node) { node["attributes"]["ome"]["multiscales"][0].erase("axes"); }),
                   "multiscales.0.axes is missing"));
    const Copy old("image_04");
    CHECK(
        contains(old.refusal_after([](Json& node) { node["attributes"]["ome"]["multiscales"][0]["version"] = "0.4"; }),
                 "multiscales.0.version is \"0.4\"; expected one of \"0.5\""));
    const Copy plate("series");
    CHECK(contains(plate.refusal_after([](Json& node) { node["attributes"]["ome"]["plate"] = Json::object(); }),
                   "is a plate of many images"));
    const Copy strange("image_04");
    CHECK(contains(strange.refusal_after([](Json& node) {
        node["new"] = {{"must_understand", true}};
    }),
                   "key new is {\"must_understand\":true}; expected no such key"));
    const Copy names("image_04");
    names.change("0/zarr.json", [](Json& node) { node["dimension_names"] = {"x", "y", "z"}; });
    CHECK(warns_of(*open_volume(names.root), "0/zarr.json: calls axis 0 \"x\", the image \"z\", which is used"));
    const Copy none("image_04");
    fs::remove(none.root / "0/zarr.json");
    CHECK(contains(none.refusal(), "0/zarr.json: cannot be opened: No such file"));
}

TEST_CASE("zarr 3: hostile metadata is refused by field, at once")
{
    const auto refusals = [](const char* example, const char* key, const std::vector<Json>& values) {
        for (const Json& value : values) {
            const Copy copy(example);
            const std::string said =
                copy.refusal_after([&](Json& node) { node[Json::json_pointer(std::string("/") + key)] = value; });
            CAPTURE(key);
            CAPTURE(value.dump());
            CAPTURE(said);
            CHECK(contains(said, "zarr.json: key "));
            CHECK(contains(said, "; expected "));
        }
    };
    const Json huge = uint64_t{1} << 63;
    refusals("dots", "zarr_format", {2, 4, "3", nullptr});
    refusals("dots", "node_type", {"table", 3, nullptr});
    refusals("dots", "shape", {{0, 4, 5}, {-3, 4, 5}, {huge, 4, 5}, {"3", 4, 5}, Json::array(), 3, {4, 5}});
    refusals("dots", "data_type",
             {"complex64", "int128", "bfloat16", "r16", "<i2", 2, {{"name", "complex64"}}, Json::object()});
    refusals("dots", "chunk_grid", {"regular", {{"name", "rectilinear"}}, 3, nullptr, Json::object()});
    refusals("dots", "chunk_grid/configuration/chunk_shape",
             {{0, 1, 1}, {1, 1}, {1024, 1024, 1024}, {int64_t{1} << 62, 4, 1}, nullptr});
    refusals("dots", "chunk_key_encoding", {"v3", 1, {{"name", "default"}, {"configuration", {{"separator", "-"}}}}});
    refusals("dots", "fill_value", {"NaN", "0x0000", 1.5, 40000, true, Json::array()});
    refusals("fills_hex_nan", "fill_value", {"0x7fc0", "0x7fc0000g", "0x7fc000000", "7fc00000", "nan", true, 1e39});
    refusals("dots", "storage_transformers", {Json::array({{{"name", "sharding"}}})});
    refusals("dots", "dimension_names", {{"z", "y"}, {1, 2, 3}, "zyx"});
    const Json bytes = {{"name", "bytes"}, {"configuration", {{"endian", "little"}}}};
    const Json gzip = {{"name", "gzip"}, {"configuration", {{"level", 1}}}};
    const auto transpose = [](const Json& order) -> Json {
        return {{"name", "transpose"}, {"configuration", {{"order", order}}}};
    };
    refusals("dots", "codecs",
             {Json::array(), 3, nullptr, Json::array({gzip}), Json::array({bytes, bytes}), Json::array({gzip, bytes}),
              Json::array({bytes, gzip, gzip}), Json::array({bytes, {{"name", "bitround"}}}), Json::array({"bytes"}),
              Json::array({bytes, transpose({0, 1, 2})}), Json::array({transpose({0, 1}), bytes}),
              Json::array({transpose({0, 0, 1}), bytes}), Json::array({transpose({0, 1, 3}), bytes}),
              Json::array({{{"name", "bytes"}, {"configuration", {{"endian", "middle"}}}}}),
              Json::array({"sharding_indexed"}), Json(std::vector<Json>(17, bytes))});
    const std::string sharding = "codecs/0/configuration/";
    const auto of_shard = [&](const char* key, const std::vector<Json>& values) {
        refusals("shard_end", (sharding + key).c_str(), values);
    };
    of_shard("chunk_shape", {{3, 4, 3}, {0, 4, 3}, {8, 4, 6}, {2, 4}, nullptr});
    of_shard("codecs", {Json::array(), nullptr, Json::array({gzip}), Json::array({{{"name", "sharding_indexed"}}})});
    of_shard("index_codecs",
             {Json::array(), nullptr, Json::array({bytes, gzip}), Json::array({transpose({0, 1, 2}), bytes})});
    of_shard("index_location", {"middle", 1});
    const Copy whole("shard_end");
    CHECK(contains(whole.refusal_after([&](Json& node) { node["codecs"].push_back(gzip); }),
                   "expected no codec after it: shards that are compressed as a whole are not supported"));
    // Four million chunks in a shard are one too many.
    const Copy many("shard_end");
    CHECK(contains(many.refusal_after([&](Json& node) {
        node["chunk_grid"]["configuration"]["chunk_shape"] = {1 << 12, 1 << 12, 1};
        node["codecs"][0]["configuration"]["chunk_shape"] = {1, 1, 1};
    }),
                   "expected shards of at most 4194304 chunks"));
}

TEST_CASE("zarr 3: an index that is damaged or lies is refused, and what it says right is read")
{
    const Copy copy("shard_end");
    constexpr size_t INDEX = 4 * 16;  // of 2 x 1 x 2 chunks, before its checksum
    const std::string whole = copy.read("c/0/0/0");
    REQUIRE(whole.size() > INDEX + 4);
    const size_t index = whole.size() - INDEX - 4;
    // Every bit of the index and its checksum counts.
    for (size_t at = index; at < whole.size(); ++at) {
        std::string spoiled = whole;
        spoiled[at] = char(spoiled[at] ^ 0x10);
        copy.write("c/0/0/0", spoiled);
        REQUIRE(contains(copy.refusal(), "c/0/0/0 (index): is damaged: its CRC-32C is "));
    }
    for (size_t length = 0; length < INDEX + 4; length += 7) {
        copy.write("c/0/0/0", whole.substr(0, length));
        REQUIRE(contains(copy.refusal(), "expected at least 68, the index of a shard"));
    }
    // A signed index may lie too.
    const auto says = [&](size_t number, uint64_t offset, uint64_t bytes) {
        std::string lying = whole;
        set_number(lying, index + 16 * number, offset);
        set_number(lying, index + 16 * number + 8, bytes);
        sign(lying, INDEX);
        copy.write("c/0/0/0", lying);
        const Effort effort;
        std::string said = copy.refusal();
        CHECK(effort.is_below(AT_ONCE_BYTES));
        return said;
    };
    const auto offset = number_at<uint64_t>(whole, index), bytes = number_at<uint64_t>(whole, index + 8);
    constexpr uint64_t NONE = ~uint64_t{0};
    CHECK(says(0, offset, bytes).empty());
    for (const uint64_t far : {uint64_t(whole.size()), uint64_t{1} << 40, uint64_t{1} << 63, NONE - 1, NONE})
        CHECK(contains(says(0, far, bytes), "c/0/0/0 (chunk 0,0,0): is said to be "));
    for (const uint64_t much : {uint64_t(whole.size()) + 1, uint64_t{1} << 62, NONE - 1, NONE})
        CHECK(contains(says(0, offset, much), "c/0/0/0 (chunk "));
    CHECK(contains(says(0, index + 8, 8), "expected them between bytes 0 and "));  // in the index itself
    CHECK(contains(says(1, offset + 1, bytes), "shares bytes with another chunk of its shard"));
    CHECK(contains(says(0, offset, bytes - 1), "(chunk 0,0,0): "));
    CHECK(contains(says(0, 0, 0), "(chunk 0,0,0): "));
    // Each of the other chunks can be read.
    static_cast<void>(says(3, uint64_t{1} << 40, bytes));
    const auto source = open_volume(copy.root);
    CHECK(voxels_in<int16_t>(*source, {{0, 0, 0}, {3, 4, 2}})[0] == phantom(0, 0, 0));
    CHECK(contains(error_of([&] { voxels_in<int16_t>(*source, {{3, 0, 2}, {5, 4, 3}}); }), "(chunk 1,0,1): "));
    CHECK(says(0, NONE, NONE).empty());
    CHECK(voxels_of<int16_t>(*open_volume(copy.root))[0] == 0);
    CHECK_FALSE(open_volume(copy.root)->brick_range(0, {0, 0, 0}).has_value());
}

TEST_CASE("zarr 3: a chunk whose checksum does not hold is named")
{
    for (const char* name : {"checksum_after", "checksum_before", "checksum_alone"}) {
        const Copy copy(name);
        const std::string whole = copy.read("c/0/0/0");
        for (size_t at = 0; at < whole.size(); ++at) {
            std::string spoiled = whole;
            spoiled[at] = char(spoiled[at] ^ 0x01);
            copy.write("c/0/0/0", spoiled);
            const std::string said = copy.refusal();
            CAPTURE(at);
            // zstd may find it first, or not at all where a bit means nothing.
            if (name != std::string("checksum_before")) REQUIRE(contains(said, "c/0/0/0: is damaged: its CRC-32C is "));
            if (said.empty()) REQUIRE(is_chirality_phantom(*open_volume(copy.root)));
        }
        for (size_t length = 0; length < whole.size(); ++length) {
            copy.write("c/0/0/0", whole.substr(0, length));
            REQUIRE(contains(copy.refusal(), "c/0/0/0: "));
        }
    }
}

TEST_CASE("zarr: the chunks that are stored are listed, in folders, archives and shards")
{
    const auto listed = [](const fs::path& path, int version, std::vector<std::optional<int64_t>> at, int64_t most) {
        const ZarrPlace place = zarr_place(path).value();
        const ZarrChunks chunks(place, read_zarr_metadata(place, version));
        std::vector<std::vector<int64_t>> found;
        const bool is_all = chunks.list(at, most, [&](std::span<const int64_t> chunk) {
            CHECK_FALSE(chunks.is_missing(chunk));
            found.emplace_back(chunk.begin(), chunk.end());
        });
        std::ranges::sort(found);
        return std::pair(is_all, found);
    };
    const std::optional<int64_t> any;
    using Numbers = std::vector<std::vector<int64_t>>;
    std::vector<std::pair<fs::path, int>> whole{{"tests/data/zarr/dots", 2}, {"tests/data/zarr/slashes", 2}};
    for (const char* name : {"dots", "slashes", "keys_default", "keys_v2", "keys_v2_slash"})
        for (const fs::path& path : forms_of(name)) whole.emplace_back(path, 3);
    for (const auto& [path, version] : whole) {
        CAPTURE(path);
        const Numbers all{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0, 1, 1}, {1, 0, 0}, {1, 0, 1}, {1, 1, 0}, {1, 1, 1}};
        CHECK(listed(path, version, {any, any, any}, 8) == std::pair(true, all));
        CHECK_FALSE(listed(path, version, {any, any, any}, 7).first);
        CHECK(listed(path, version, {any, 1, 0}, 8) == std::pair(true, Numbers{{0, 1, 0}, {1, 1, 0}}));
    }
    for (const fs::path& path : forms_of("shard_end")) {
        // A shard of 2 x 1 x 2 chunks, all in the array.
        const Numbers all{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 1}};
        CHECK(listed(path, 3, {any, any, any}, 4) == std::pair(true, all));
        CHECK_FALSE(listed(path, 3, {any, any, any}, 3).first);
        CHECK(listed(path, 3, {1, any, any}, 4) == std::pair(true, Numbers{{1, 0, 0}, {1, 0, 1}}));
    }
    // Chunks of 2 x 2 x 2 voxels in shards of 4 x 4 x 4; those with x below 2 are fill value.
    for (const fs::path& path : forms_of("shard_sparse")) {
        CHECK(listed(path, 3, {any, any, any}, 9) ==
              std::pair(true, Numbers{{0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 1}}));
    }
    // Nothing is stored of an array without chunks.
    const Copy empty("shard_end");
    fs::remove_all(empty.root / "c");
    CHECK(listed(empty.root, 3, {any, any, any}, 0) == std::pair(true, Numbers()));
}

TEST_CASE("zarr 3: an array whose shard is gone is empty there, one that is gone itself is not")
{
    const Copy copy("shard_end");
    const auto source = open_volume(copy.root);
    fs::remove_all(copy.root / "c");
    CHECK(voxels_of<int16_t>(*open_volume(copy.root)) == std::vector<int16_t>(60, 0));
    CHECK(source->brick_range(0, {0, 0, 0}).value() == ValueRange{0.0, 0.0});
    fs::remove_all(copy.root);
    CHECK(contains(error_of([&] { voxels_of<int16_t>(*source); }), "zarr.json: no longer exists"));
}
