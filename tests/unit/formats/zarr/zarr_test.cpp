// Zarr arrays and OME-Zarr images as other programs write them (tests/data/make_zarr.py), and malformed ones. The same
// arrays and images as Zarr version 3, in folders and archives (tests/data/make_zarr3.py), give the same.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <thread>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "engine/formats/open_volume.h"
#include "engine/formats/zarr/zarr_codec.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path DATA = "tests/data/zarr";  // tests run in the repository's root
const fs::path DATA_3 = "tests/data/zarr3";

/// An example as version 2, as version 3, and that as an archive.
std::vector<fs::path> forms_of(const std::string& name)
{
    return {DATA / name, DATA_3 / name, DATA_3 / (name + ".ozx")};
}

std::string text_of(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

int phantom(int64_t x, int64_t y, int64_t z)
{
    return int(x + 10 * y + 100 * z - 99);
}

/// Compares every voxel with `expected(x, y, z)` cast to T.
template <class T>
bool holds(const VolumeSource& source, const std::function<double(int64_t x, int64_t y, int64_t z)>& expected)
{
    if (source.info().size != Size3(5, 4, 3)) return false;
    const std::vector<T> voxels = voxels_of<T>(source);
    for (int64_t i = 0; i < 60; ++i) {
        const double value = expected(i % 5, i / 5 % 4, i / 20);
        const auto voxel = double(voxels[size_t(i)]);
        if (voxel != value && !(std::isnan(voxel) && std::isnan(value))) return false;
    }
    return true;
}

bool is_phantom(const VolumeSource& source)
{
    return source.info().type == VoxelType::int16 && holds<int16_t>(source, phantom);
}

template <class T>
bool holds_low_bits(const VolumeSource& source)
{
    constexpr int SHIFT = std::is_unsigned_v<T> ? 1 : 0;
    return holds<T>(source, [](int64_t x, int64_t y, int64_t z) {
        const int value = phantom(x, y, z) + SHIFT;
        if constexpr (std::is_integral_v<T>) return double(static_cast<T>(value));
        return double(value);
    });
}

/// A copy of one of the examples, for tests to damage.
class Copy : public TemporaryFolder {
public:
    explicit Copy(const std::string& name) : root(path / name)
    {
        fs::copy(DATA / name, root, fs::copy_options::recursive);
    }

    void change(const std::string& file, const std::function<void(Json&)>& change) const
    {
        Json document = Json::parse(text_of(root / file));
        change(document);
        write_text(file, document.dump());
    }
    void write_text(const std::string& file, std::string_view content) const
    {
        std::ofstream(root / file, std::ios::binary).write(content.data(), std::streamsize(content.size()));
    }
    std::string refusal() const
    {
        return error_of([&] { voxels_of<int16_t>(*open_volume(root)); });
    }
    /// The message if `key` of `file` is `value`.
    std::string refusal_of(const std::string& file, const std::string& key, const Json& value) const
    {
        change(file, [&](Json& document) { document[key] = value; });
        return refusal();
    }

    fs::path root;
};

std::vector<int16_t> level_of(const VolumeSource& source, int level, const VoxelBox& box)
{
    std::vector<int16_t> voxels(size_t(box.size().x * box.size().y * box.size().z));
    source.read_level(level, box, std::as_writable_bytes(std::span(voxels)));
    return voxels;
}

}  // namespace

TEST_CASE("zarr: every data type in both byte orders gives its values")
{
    for (const fs::path& path : forms_of("type_u1")) CHECK(holds_low_bits<uint8_t>(*open_volume(path)));
    for (const fs::path& path : forms_of("type_i1")) CHECK(holds_low_bits<int8_t>(*open_volume(path)));
    for (const std::string order : {"little", "big"}) {
        for (size_t form = 0; form < 3; ++form) {
            CAPTURE(order);
            CAPTURE(form);
            const auto opened = [&](const char* type) { return open_volume(forms_of("type_" + order + type)[form]); };
            CHECK(holds_low_bits<uint16_t>(*opened("_u2")));
            CHECK(holds_low_bits<int16_t>(*opened("_i2")));
            CHECK(holds_low_bits<uint32_t>(*opened("_u4")));
            CHECK(holds_low_bits<int32_t>(*opened("_i4")));
            CHECK(holds_low_bits<float>(*opened("_f4")));
            CHECK(holds_low_bits<double>(*opened("_f8")));
        }
    }
    CHECK(open_volume(DATA / "type_big_u4")->info().type == VoxelType::uint32);
    CHECK(open_volume(DATA / "type_little_f8")->info().type == VoxelType::float64);
}

TEST_CASE("zarr: every compressor and every shuffle of blosc is decoded")
{
    int found = 0;
    for (const fs::path& folder : {DATA, DATA_3}) {
        for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
            if (!entry.path().filename().string().starts_with("compressor_")) continue;
            CAPTURE(entry.path().string());
            CHECK(is_phantom(*open_volume(entry.path())));
            ++found;
        }
    }
    CHECK(found == 3 * 22);  // blosc: 6 codecs in 3 shuffles; zstd, zlib, gzip, none
}

TEST_CASE("zarr: order F, chunks of any shape, chunks larger than the array, leading axes and both separators")
{
    for (const char* name :
         {"order_f", "chunks_one", "chunks_whole", "chunks_larger", "leading_axes", "slashes", "dots"}) {
        for (const fs::path& path : forms_of(name)) {
            CAPTURE(path);
            CHECK(is_phantom(*open_volume(path)));
        }
    }
    for (const fs::path& path : forms_of("dots")) {
        CHECK(warns_of(*open_volume(path), "does not name its axes; z, y, x assumed"));
        CHECK(open_volume(path)->info().format == "ome-zarr");
        CHECK(open_volume(path)->info().name == path.filename());
    }
    CHECK(open_volume(DATA / "dots/")->info().name == "dots");
    for (const fs::path& path : forms_of("slashes")) CHECK(open_volume(path)->block() == Size3(4, 3, 2));
}

TEST_CASE("zarr: any box is the part of the volume it covers")
{
    std::vector<fs::path> paths = forms_of("slashes");
    paths.insert(paths.end(), {DATA_3 / "shard_small", DATA_3 / "shard_small.ozx"});
    for (const fs::path& path : paths) {
        CAPTURE(path);
        const auto source = open_volume(path);
        for (int64_t i = 0; i < 60; ++i) {
            for (int64_t j = i; j < 60; ++j) {
                const Size3 lower{i % 5, i / 5 % 4, i / 20};
                const Size3 upper{j % 5 + 1, j / 5 % 4 + 1, j / 20 + 1};
                if (!glm::all(glm::lessThan(lower, upper))) continue;
                const std::vector<int16_t> voxels = voxels_in<int16_t>(*source, {lower, upper});
                REQUIRE(voxels.front() == phantom(lower.x, lower.y, lower.z));
                REQUIRE(voxels.back() == phantom(upper.x - 1, upper.y - 1, upper.z - 1));
            }
        }
    }
}

TEST_CASE("zarr: a chunk that is not there holds the fill value: a number, NaN, infinity, or 0 for null")
{
    const auto with_fill = [](double fill) {
        return [fill](int64_t x, int64_t y, int64_t z) { return x >= 3 ? fill : phantom(x, y, z); };
    };
    for (size_t form = 0; form < 3; ++form) {
        CAPTURE(form);
        const auto opened = [&](const char* name) { return open_volume(forms_of(name)[form]); };
        CHECK(holds<int16_t>(*opened("fill_number"), with_fill(-7)));
        CHECK(holds<int16_t>(*opened("fill_null"), with_fill(0)));
        CHECK(holds<float>(*opened("fill_nan"), with_fill(std::nan(""))));
        CHECK(holds<double>(*opened("fill_infinity"), with_fill(-std::numeric_limits<double>::infinity())));
    }
}

TEST_CASE("zarr: what cannot be read is no missing chunk")
{
    const Copy copy("dots");
    fs::remove(copy.root / "1.1.1");
    fs::create_directory(copy.root / "1.1.1");
    CHECK(contains(copy.refusal(), "dots/1.1.1: is a folder; expected a file"));

    const Copy gone("dots");
    const auto source = open_volume(gone.root);
    fs::remove_all(gone.root);
    CHECK(contains(error_of([&] { voxels_of<int16_t>(*source); }), "dots/.zarray: no longer exists"));

    const Copy nested("slashes");
    fs::remove_all(nested.root / "1");
    nested.write_text("1", "a file where a folder should be");
    CHECK(contains(nested.refusal(), "slashes/1/0/0: cannot be examined: Not a directory"));
}

TEST_CASE("zarr: a damaged chunk is named, and all others can be read")
{
    for (const char* name : {"compressor_none", "compressor_zstd", "compressor_zlib", "compressor_gzip",
                             "compressor_blosc_lz4_1", "compressor_blosc_zstd_2"}) {
        CAPTURE(name);
        const Copy copy(name);
        const std::string whole = text_of(copy.root / "0.0.0");
        for (size_t length = 0; length < whole.size(); length += 1 + whole.size() / 100) {
            copy.write_text("0.0.0", std::string_view(whole).substr(0, length));
            CAPTURE(length);
            REQUIRE(contains(copy.refusal(), "/0.0.0: "));
            REQUIRE(contains(copy.refusal(), "; expected "));
        }
        copy.write_text("0.0.0", whole + whole + std::string(20000, 'x'));
        CHECK(contains(copy.refusal(), "/0.0.0: "));
        for (size_t at = 0; at < std::min<size_t>(whole.size(), 64); ++at) {
            for (const int bit : {0, 4, 6}) {
                std::string spoiled = whole;
                spoiled[at] = char(spoiled[at] ^ char(1 << bit));
                copy.write_text("0.0.0", spoiled);
                static_cast<void>(copy.refusal());  // an error or different voxels, and no more memory than the chunk's
            }
        }
    }
    const Copy copy("dots");
    copy.write_text("1.1.1", "short");
    const auto source = open_volume(copy.root);
    CHECK(contains(error_of([&] { voxels_of<int16_t>(*source); }), "dots/1.1.1: holds 5 bytes; expected 48"));
    CHECK(voxels_in<int16_t>(*source, {{0, 0, 0}, {5, 3, 2}}).size() == 30);
    CHECK(voxels_in<int16_t>(*source, {{0, 3, 2}, {4, 4, 3}})[0] == phantom(0, 3, 2));
}

TEST_CASE("zarr: a blosc header that lies about its sizes is refused before it is decoded")
{
    const Copy copy("compressor_blosc_zstd_1");
    const std::string whole = text_of(copy.root / "0.0.0");
    for (const size_t field : {4, 8, 12}) {  // bytes, block size, stored bytes
        for (const uint32_t lie : {0u, 1u, 4095u, 4097u, 0x7fffffffu, 0xffffffffu}) {
            std::string lying = whole;
            std::memcpy(lying.data() + field, &lie, sizeof(lie));
            copy.write_text("0.0.0", lying);
            CAPTURE(field);
            CAPTURE(lie);
            const std::string said = copy.refusal();
            if (field == 4) CHECK(contains(said, "its blosc header states"));
            if (field == 12) CHECK(contains(said, "as its blosc header says"));
        }
    }
}

TEST_CASE("zarr: hostile metadata is refused by field, at once")
{
    const Copy copy("dots");
    const Effort effort;
    const std::string at = (copy.root / ".zarray").string();
    const Json huge = uint64_t{1} << 63;
    const auto refusals = [&](const char* key, const std::vector<Json>& values) {
        for (const Json& value : values) {
            const Copy fresh("dots");
            const std::string said = fresh.refusal_of(".zarray", key, value);
            CAPTURE(value.dump());
            CAPTURE(said);
            CHECK(contains(said, key));
            CHECK(contains(said, "; expected "));
        }
    };
    refusals("shape", {{0, 4, 5},
                       {-3, 4, 5},
                       {huge, 4, 5},
                       {3.5, 4, 5},
                       {"3", 4, 5},
                       Json::array(),
                       3,
                       nullptr,
                       std::vector<int>(17, 1),
                       {4, 5}});
    refusals("chunks", {{0, 1, 1},
                        {-1, 1, 1},
                        {huge, 1, 1},
                        {1, 1},
                        {1024, 1024, 1024},
                        {1 << 30, 1 << 30, 1 << 30},
                        {int64_t{1} << 62, 4, 1},
                        nullptr});
    refusals("dtype", {"<i16", "<u3", "<f16", "|b2", "|S3", "i2", "<c8", "", 2, nullptr, Json::array({{"a", "<i2"}})});
    refusals("order", {"K", 1, nullptr});
    refusals("dimension_separator", {"", "..", "\\", 1});
    refusals("fill_value", {"NaN", 1.5, 40000, true, "AAA=", Json::array()});
    refusals("zarr_format", {1, 3, "2"});
    refusals("compressor", {"zlib", {{"level", 1}}, {{"id", "bz2"}}, {{"id", 7}}});
    refusals("filters", {Json::array({{{"id", "delta"}}}), "delta"});
    CHECK(contains(Copy("delta_filter").refusal(), "filters is [{\"astype\":\"<i2\""));
    CHECK(contains(Copy("lz4_alone").refusal(),
                   "compressor.id is \"lz4\"; expected one of \"blosc\", \"zstd\", \"zlib\", \"gzip\""));
    for (const char* key : {"shape", "chunks", "dtype", "order", "compressor", "zarr_format"}) {
        const Copy lacking("dots");
        lacking.change(".zarray", [&](Json& document) { document.erase(key); });
        CHECK(contains(lacking.refusal(), std::string(key) + " is missing; expected"));
    }
    // A side of 2^21 is just too large; nothing is allocated for it.
    const Copy long_axis("dots");
    CHECK(
        contains(long_axis.refusal_of(".zarray", "shape", {1 << 21, 4, 5}), "size along z is 2097152; expected 1 to"));
    CHECK(effort.is_below(AT_ONCE_BYTES));
}

TEST_CASE("zarr: metadata that are no metadata are refused at once, without the memory they ask for")
{
    const Copy copy("dots");
    const auto refusal = [&](std::string_view content) {
        copy.write_text(".zarray", content);
        const Effort effort;
        std::string said = error_of([&] { open_volume(copy.root); });
        CHECK(effort.is_below(AT_ONCE_BYTES));
        return said;
    };
    CHECK(contains(refusal(""), ".zarray: is not JSON: "));
    CHECK(contains(refusal("[]"), ".zarray: the document is []; expected an object"));
    CHECK(contains(refusal(std::string(1 << 20, '[')), ".zarray: JSON nests deeper than 64 levels"));
    CHECK(contains(refusal(std::string(1 << 19, '[') + std::string(1 << 19, ']')), "JSON nests deeper than 64 levels"));
    CHECK(contains(refusal(std::string((1 << 20) + 1, ' ')), "holds 1048577 bytes; expected at most 1048576"));
    std::string many = "{\"zarr_format\":2,\"shape\":[1";
    while (many.size() < 1000000) many += ",1";
    CHECK(contains(refusal(many + "]}"), "key shape is [1,1,1"));
    const std::string whole = text_of(DATA / "dots/.zarray");
    for (size_t length = 0; length + 1 < whole.size(); ++length) {
        REQUIRE(contains(refusal(std::string_view(whole).substr(0, length)), "is not JSON: "));
    }
}

TEST_CASE("ome-zarr: spacing, unit, origin and the chirality phantom survive, with axes in any order")
{
    for (const char* name : {"image_04", "image_group_scale", "image_axes_xzy", "image_floor", "series"}) {
        for (const fs::path& path : forms_of(name)) {
            CAPTURE(path);
            const auto source = open_volume(path);
            CHECK(is_phantom(*source));
            CHECK(source->info().spacing == glm::dvec3(0.5, 0.5, 1.25));
            CHECK(source->info().unit == "mm");
        }
    }
    for (const fs::path& path : forms_of("image_04")) CHECK(open_volume(path)->info().warnings.empty());
    for (const fs::path& path : forms_of("image_group_scale"))
        CHECK(open_volume(path)->info().origin == glm::dvec3(30, 20, 10));
    for (const fs::path& path : forms_of("image_mixed_units")) {
        const auto mixed = open_volume(path);
        CHECK(mixed->info().unit == "mm");
        CHECK(glm::length(mixed->info().spacing - glm::dvec3(0.5, 0.5, 1.25)) < 1e-15);
    }
    for (const char* name : {"image_01", "image_03"}) {
        CHECK(is_phantom(*open_volume(DATA / name)));
        CHECK(warns_of(*open_volume(DATA / name), "no spacing stated; 1 voxel assumed"));
    }
}

TEST_CASE("ome-zarr: levels count where they lie on level 0 as they should, others are left out and named")
{
    for (size_t form = 0; form < 3; ++form) {
        CAPTURE(form);
        const auto opened = [&](const char* name) { return open_volume(forms_of(name)[form]); };
        const auto whole = opened("image_04");
        REQUIRE(whole->levels() == 3);
        // The mean of 2 x 2 x 2 voxels at the lower corner, and of a single one at the upper corner.
        const std::vector<int16_t> coarse = level_of(*whole, 1, {{0, 0, 0}, {3, 2, 2}});
        CHECK(coarse.front() == -44);  // -99 + (0.5 + 5 + 50) is -43.5; ties go to even
        CHECK(coarse.back() == phantom(4, 2, 2) + 5);
        CHECK(level_of(*whole, 2, {{1, 0, 0}, {2, 1, 1}}).size() == 1);
        CHECK_FALSE(whole->brick_range(0, {0, 0, 0}).has_value());
        CHECK_FALSE(whole->statistics().has_value());

        CHECK(opened("image_no_translations")->levels() == 2);
        CHECK(opened("image_no_translations")->info().warnings.empty());
        CHECK(opened("image_group_scale")->levels() == 2);

        const auto shifted = opened("image_off_by_half");
        CHECK(shifted->levels() == 1);
        CHECK(warns_of(*shifted,
                       "level \"1\" of the image is left out: level \"1\" lies -0.5 voxels off along x, not 0.5"));
        const auto flat = opened("image_flat_levels");
        CHECK(flat->levels() == 1);
        CHECK(warns_of(*flat, "is left out: level \"1\" has 3 voxels along z, not 2"));
    }
    const Copy broken("image_04");
    for (const int level : {1, 2}) {
        const auto whole = open_volume(DATA / "image_04"), coarse = open_volume(DATA / "image_04", {.level = level});
        CHECK(coarse->levels() == 3 - level);
        CHECK(coarse->info().size == size_of_level(whole->info().size, level));
        const VoxelBox box{Size3(0), coarse->info().size};
        CHECK(level_of(*coarse, 0, box) == level_of(*whole, level, box));
        const double wider = std::ldexp(1.0, level);
        CHECK(coarse->info().spacing == wider * whole->info().spacing);
        // The centre of its first voxel is the centre of the voxels that it covers.
        const glm::dvec3 apart = coarse->info().origin - whole->info().origin;
        const glm::dvec3 expected = whole->info().directions * (0.5 * (wider - 1.0) * whole->info().spacing);
        CHECK(glm::length(apart - expected) < 1e-12);
        CHECK(warns_of(*coarse, "is opened: its voxels are"));
    }
    CHECK_THROWS_WITH(
        open_volume(DATA / "image_04", {.level = 3}),
        ((DATA / "image_04").string() + ": has no level 3; expected one from 0, the finest, to 2").c_str());
    CHECK(open_volume(DATA / "image_04", {.level = 1, .spacing = glm::dvec3(3.0), .unit = "mm"})->info().spacing ==
          glm::dvec3(3.0));
    fs::remove(broken.root / "1/.zarray");
    CHECK(open_volume(broken.root)->levels() == 1);
    CHECK(warns_of(*open_volume(broken.root),
                   "levels \"1\", \"2\" of the image are left out: level \"1\" cannot be read"));
}

TEST_CASE("ome-zarr: where a level's size was rounded down, its last voxels stand for what it lacks")
{
    for (const fs::path& path : forms_of("image_floor")) {
        CAPTURE(path);
        const auto source = open_volume(path);
        REQUIRE(source->levels() == 2);  // of 2 x 2 x 1 voxels, instead of 3 x 2 x 2
        const std::vector<int16_t> stored = level_of(*source, 1, {{0, 0, 0}, {2, 2, 1}});
        const std::vector<int16_t> wanted = level_of(*source, 1, {{0, 0, 0}, {3, 2, 2}});
        CHECK(wanted == std::vector<int16_t>{stored[0], stored[1], stored[1], stored[2], stored[3], stored[3],  //
                                             stored[0], stored[1], stored[1], stored[2], stored[3], stored[3]});
        CHECK(level_of(*source, 1, {{2, 1, 1}, {3, 2, 2}}) == std::vector<int16_t>{stored[3]});
    }
}

namespace {

/// An image whose levels have `side`, side / 2, ... voxels along each axis, in uncompressed chunks, none of which
/// exists.
class Sparse : public TemporaryFolder {
public:
    Sparse(int64_t side, int64_t chunk, const std::string& type, const std::vector<Json>& fills)
    {
        Json datasets = Json::array();
        for (size_t level = 0; level < fills.size(); ++level) {
            const int64_t factor = int64_t{1} << level;
            const std::string name = std::to_string(level);
            datasets.push_back(
                {{"path", name},
                 {"coordinateTransformations", {{{"type", "scale"}, {"scale", {factor, factor, factor}}}}}});
            const int64_t size = side / factor;
            const Json array = {{"zarr_format", 2}, {"shape", {size, size, size}}, {"chunks", {chunk, chunk, chunk}},
                                {"dtype", type},    {"compressor", nullptr},       {"fill_value", fills[level]},
                                {"order", "C"},     {"filters", nullptr}};
            fs::create_directory(path / name);
            write(name + "/.zarray", array.dump());
        }
        Json axes = Json::array();
        for (const char* name : {"z", "y", "x"}) axes.push_back({{"name", name}, {"type", "space"}});
        const Json image = {{"version", "0.4"}, {"axes", axes}, {"datasets", datasets}};
        write(".zattrs", Json({{"multiscales", Json::array({image})}}).dump());
    }
    std::optional<ValueRange> range(int level, const Size3& brick) const
    {
        return open_volume(path)->brick_range(level, brick);
    }
};

}  // namespace

TEST_CASE("ome-zarr: bricks of which no chunk is stored, in their level or below, are known to hold the fill values")
{
    const Sparse image(128, 32, "|u1", {7, 9, 8});
    image.write("0/0.0.0", std::string(32 * 32 * 32, 'v'));
    REQUIRE(open_volume(image.path)->levels() == 3);
    CHECK_FALSE(image.range(0, {0, 0, 0}).has_value());
    CHECK_FALSE(image.range(0, {1, 1, 1}).has_value());  // it reaches one voxel into the chunk
    CHECK(image.range(0, {2, 1, 1}).value() == ValueRange{7.0, 7.0});
    CHECK_FALSE(image.range(0, {4, 0, 0}).has_value());
    CHECK_FALSE(image.range(0, {-1, 0, 0}).has_value());
    CHECK_FALSE(image.range(3, {0, 0, 0}).has_value());
    CHECK_FALSE(image.range(1, {0, 0, 0}).has_value());
    CHECK(image.range(1, {1, 1, 1}).value() == ValueRange{7.0, 9.0});
    CHECK_FALSE(image.range(2, {0, 0, 0}).has_value());
    CHECK(voxels_in<uint8_t>(*open_volume(image.path), {{63, 31, 31}, {97, 65, 65}}) ==
          std::vector<uint8_t>(34 * 34 * 34, 7));

    // A coarse chunk says nothing about finer ones.
    image.write("1/1.1.1", std::string(32 * 32 * 32, 'v'));
    CHECK_FALSE(image.range(1, {1, 1, 1}).has_value());
    CHECK(image.range(0, {2, 2, 2}).value() == ValueRange{7.0, 7.0});

    // A chunk that cannot be examined is not a gap.
    fs::remove_all(image.path / "1/1.1.1");
    fs::create_symlink("1.1.1", image.path / "1/1.1.1");
    CHECK_FALSE(image.range(1, {1, 1, 1}).has_value());
    const auto source = open_volume(image.path);
    fs::remove_all(image.path / "0");
    CHECK_FALSE(source->brick_range(0, {3, 3, 3}).has_value());
}

TEST_CASE("ome-zarr: a gap of NaN has an empty range, and gaps are known however many files they lack")
{
    const auto nothing = Sparse(64, 32, "<f4", {"NaN"}).range(0, {1, 1, 1});
    REQUIRE(nothing.has_value());
    CHECK(nothing->lower > nothing->upper);
    CHECK(Sparse(64, 32, "<f4", {"NaN", -3.5}).range(1, {0, 0, 0}).value() == ValueRange{-3.5, -3.5});
    // 34 voxels along each axis are 6 chunks of 8, or 10 of 4: 1000 files, of which the folder's list knows.
    CHECK(Sparse(128, 8, "<i2", {-5}).range(0, {1, 1, 1}).value() == ValueRange{-5.0, -5.0});
    CHECK(Sparse(128, 4, "<i2", {-5}).range(0, {1, 1, 1}).value() == ValueRange{-5.0, -5.0});
    // Chunks of finer levels count.
    CHECK(Sparse(256, 64, "<i2", {0, 0, 0}).range(2, {0, 0, 0}).value() == ValueRange{0.0, 0.0});
    CHECK(Sparse(256, 16, "<i2", {0, 0, 0}).range(2, {0, 0, 0}).value() == ValueRange{0.0, 0.0});
}

TEST_CASE("ome-zarr: channels and time points are chosen by name or number, and never silently")
{
    for (const fs::path& path : forms_of("image_tczyx")) {
        CAPTURE(path);
        const auto value = [&](const OpenOptions& options) {
            return voxels_of<int16_t>(*open_volume(path, options))[0];
        };
        CHECK(value({.channel = "gfp", .frame = "2"}) == phantom(0, 0, 0) + 1500);
        CHECK(value({.channel = "1", .frame = "1"}) == phantom(0, 0, 0));
        CHECK(value({.channel = "3", .frame = "2"}) == phantom(0, 0, 0) + 2000);
        CHECK(contains(error_of([&] { open_volume(path); }),
                       "holds 3 channels; expected a channel to be chosen (1 to 3; 1 is \"DAPI\", 2 is \"GFP\")"));
        CHECK(contains(error_of([&] { open_volume(path, {.channel = "2"}); }),
                       "holds 2 frames; expected a frame to be chosen (1 to 2)"));
        CHECK(
            contains(error_of([&] { open_volume(path, {.channel = "red", .frame = "1"}); }), "has no channel \"red\""));
        CHECK(contains(error_of([&] { open_volume(path, {.channel = "4", .frame = "1"}); }), "has no channel \"4\""));
    }
    for (const fs::path& path : forms_of("image_04")) {
        CHECK(contains(error_of([&] { open_volume(path, {.frame = "2"}); }), "has no frame \"2\""));
        CHECK(is_phantom(*open_volume(path, {.channel = "1", .frame = "1"})));
    }
}

TEST_CASE("ome-zarr: what is no image of version 0.1 to 0.5 is refused in words")
{
    CHECK(contains(Copy("version_3").refusal(), "version_3/zarr.json: key attributes.ome.multiscales is missing"));
    CHECK(contains(Copy("image_05").refusal(), "multiscales.0.version is \"0.5\"; expected one of \"0.1\", \"0.2\""));
    for (const fs::path& path : forms_of("image_2d")) {
        CHECK(contains(error_of([&] { open_volume(path); }),
                       "expected a z axis too: two-dimensional images are not volumes"));
    }
    const Copy group("series");
    fs::rename(group.root / "0", group.root / "other");
    CHECK(contains(group.refusal(), "multiscales is missing; expected an OME-Zarr image"));
    const Copy several("series");
    fs::copy(several.root / "0", several.root / "1", fs::copy_options::recursive);
    CHECK(contains(several.refusal(), "holds several images; expected one of them, for example "));
    CHECK(contains(Copy("series").refusal_of(".zattrs", "plate", Json::object()), "is a plate of many images"));
    const TemporaryFolder empty;
    CHECK(contains(error_of([&] { open_volume(empty.path); }), "is a folder without shvr/session.json and without"));
}

TEST_CASE("ome-zarr: hostile attributes are refused by field, at once")
{
    const auto refusal = [](const std::function<void(Json & multiscale)>& change) {
        const Copy copy("image_04");
        copy.change(".zattrs", [&](Json& document) { change(document["multiscales"][0]); });
        const Effort effort;
        std::string said = error_of([&] { open_volume(copy.root); });
        CHECK(effort.is_below(AT_ONCE_BYTES));
        return said;
    };
    const auto with_dataset = [&](const char* key, const Json& value) {
        return refusal([&](Json& multiscale) { multiscale["datasets"][0][key] = value; });
    };
    for (const Json& path :
         {Json("../image_04/0"), Json("/etc"), Json(""), Json(7), Json("a/../../0"), Json(std::string("0\0x", 3))}) {
        CHECK(contains(with_dataset("path", path), "multiscales.0.datasets.0.path is "));
    }
    CHECK(contains(with_dataset("path", "nowhere"), "nowhere/.zarray: cannot be opened: No such file"));
    const auto scale = [](const Json& numbers) { return Json::array({{{"type", "scale"}, {"scale", numbers}}}); };
    for (const Json& numbers :
         {Json({1, 1}), Json({0, 1, 1}), Json({-1, 1, 1}), Json({"1", 1, 1}), Json(1), Json({"inf", 1, 1})}) {
        CHECK(contains(with_dataset("coordinateTransformations", scale(numbers)), "coordinateTransformations"));
    }
    for (const Json& steps : {Json("scale"), Json::array({"scale"}), Json::array({{{"type", "scale"}}}),
                              Json::array({{{"type", "rotation"}}}), Json(std::vector<int>(9, 1))}) {
        CHECK(contains(with_dataset("coordinateTransformations", steps), "datasets.0.coordinateTransformations"));
    }
    const auto with = [&](const char* key, const Json& value) {
        return refusal([&](Json& multiscale) { multiscale[key] = value; });
    };
    for (const Json& axes : {Json({"z", "y"}), Json({"z", "y", "x", "x"}), Json({"z", "y", "q"}), Json("zyx"), Json(7),
                             Json({"t", "c", "z", "y", "x", "w"}), Json({1, 2, 3}), Json({"y", "x"}),
                             Json::array({{{"name", "z"}, {"type", "wave"}}})}) {
        CHECK(contains(with("axes", axes), "multiscales.0.axes"));
    }
    for (const Json& datasets : {Json(), Json::array(), Json({1, 2}), Json::object()}) {
        CHECK(contains(with("datasets", datasets), "multiscales.0.datasets"));
    }
    CHECK(contains(refusal([](Json& multiscale) { multiscale.erase("datasets"); }), "datasets is missing"));
    const Copy other("image_03");
    other.change(".zattrs", [](Json& document) { document["multiscales"][0]["axes"] = {"z", "y", "x"}; });
    CHECK(contains(other.refusal(), "shape has 4 axes; expected 3, as the image says"));
    const Copy copy("image_04");
    for (const Json& multiscales : {Json(), Json::array(), Json({1}), Json("image")}) {
        CHECK(contains(copy.refusal_of(".zattrs", "multiscales", multiscales), "multiscales is "));
    }
}

TEST_CASE("zarr: many threads read one source, each its own boxes")
{
    const auto source = open_volume(DATA / "slashes");
    std::atomic<int> wrong = 0;
    {
        std::vector<std::jthread> threads;
        for (int thread = 0; thread < 8; ++thread) {
            threads.emplace_back([&, thread] {
                for (int i = 0; i < 200; ++i) {
                    const int64_t at = (i * 7 + thread * 13) % 60;
                    const Size3 voxel{at % 5, at / 5 % 4, at / 20};
                    wrong += voxels_in<int16_t>(*source, {voxel, voxel + int64_t{1}})[0] !=
                             phantom(voxel.x, voxel.y, voxel.z);
                }
            });
        }
    }
    CHECK(wrong == 0);
}

TEST_CASE("zarr: what we compress with blosc is decoded, and equal input gives equal bytes")
{
    std::vector<uint16_t> voxels(32 * 32 * 32);
    for (size_t i = 0; i < voxels.size(); ++i) voxels[i] = uint16_t(i * i / 7);
    const auto chunk = std::as_bytes(std::span(voxels));
    for (const int level : {0, 1, 5}) {
        const ZarrCompressor compressor{.kind = ZarrCompressor::Kind::blosc, .level = level};
        const std::vector<ZarrCompressor> codecs{compressor};
        std::vector<std::byte> memory, other(1000000, std::byte{7});
        const std::span<const std::byte> stored = compress_chunk(compressor, chunk, 2, memory);
        CHECK(std::ranges::equal(stored, compress_chunk(compressor, chunk, 2, other)));
        std::vector<std::byte> decoded(chunk.size());
        decode_chunk(codecs, stored, decoded, "chunk");
        CHECK(std::memcmp(decoded.data(), chunk.data(), chunk.size()) == 0);
    }
}
