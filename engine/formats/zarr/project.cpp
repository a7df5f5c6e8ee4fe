#include "engine/formats/zarr/project.h"

#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/formats/open_volume.h"
#include "engine/formats/zarr/project_bytes.h"
#include "engine/formats/zarr/store/zarr_json.h"
#include "engine/formats/zarr/store/zarr_store.h"
#include "engine/remote/address.h"
#include "engine/volume/grid.h"

namespace shvr {
namespace {

using OrderedJson = nlohmann::ordered_json;
using Path = std::filesystem::path;

constexpr int VERSION = 1;
constexpr int64_t MAX_RECORD_BYTES = int64_t{1} << 20;
constexpr size_t HEADER_BYTES = 64;
constexpr char MAGIC[] = "SHVRTAB1";
/// Maximum size of a table: enough for the ranges of bricks in a volume of 10^13 voxels.
constexpr int64_t MAX_TABLE_BYTES = int64_t{2} << 30;
/// Maximum expansion of zstd: its smallest block, 4 bytes, decodes to 128 KiB, which is 32 KiB per byte.
constexpr int64_t MAX_OUT_OF_A_BYTE = int64_t{32} << 10;

// ---- volume.json ----------------------------------------------------------------------------------------------------

OrderedJson list_of(const glm::dvec3& vector)
{
    return {vector.x, vector.y, vector.z};
}

constexpr size_t MAX_FILL_VALUES = 16;
constexpr int64_t MAX_COUNT = std::numeric_limits<int64_t>::max();

glm::dmat3 read_matrix(const JsonNode& node)
{
    const std::vector<JsonNode> rows = node.elements(3, 3);
    return {rows[0].vector(any_number()), rows[1].vector(any_number()), rows[2].vector(any_number())};
}

/// Reads the provenance of a value. Projects by older versions lack this key; their values count as the file's.
Provenance read_provenance(const JsonNode& node)
{
    constexpr std::array<std::string_view, 3> NAMES{"assumed", "file", "given"};
    return node.exists() ? static_cast<Provenance>(node.choice(NAMES)) : Provenance::file;
}

VolumeStatistics read_statistics(const JsonNode& node)
{
    VolumeStatistics statistics{.minimum = node["min"].number(any_number()),
                                .maximum = node["max"].number(any_number()),
                                .mean = node["mean"].number(any_number()),
                                .not_finite = node["not_finite"].whole(0, MAX_COUNT)};
    for (const JsonNode& bin : node["histogram"].elements(256, 256))
        statistics.histogram.push_back(bin.whole(0, MAX_COUNT));
    if (!(statistics.minimum <= statistics.maximum)) node["max"].refuse("at least min");
    if (const JsonNode bulk = node["bulk"]; bulk.exists()) {
        statistics.bulk = {bulk["min"].number(any_number()), bulk["max"].number(any_number())};
        if (!(statistics.bulk->lower <= statistics.bulk->upper)) bulk["max"].refuse("at least min");
        statistics.beyond_bulk = bulk["beyond"].whole(0, MAX_COUNT);
        if (const JsonNode fill = bulk["fill"]; fill.exists())  // older projects have none
            for (const JsonNode& each : fill.elements(0, MAX_FILL_VALUES))
                statistics.fill.push_back({each["value"].number(any_number()), each["voxels"].whole(1, MAX_COUNT)});
    }
    return statistics;
}

// ---- Tables ---------------------------------------------------------------------------------------------------------

template <class T>
void put(std::vector<std::byte>& bytes, const T& value)
{
    const auto* const first = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof(T));
}

constexpr std::string_view SPARSE = "/s";

/// Returns the whole header except its checksum.
std::vector<std::byte> header_of(const ProjectTable& table, uint64_t frame_bytes)
{
    std::vector<std::byte> header;
    for (size_t i = 0; i < 8; ++i) put(header, MAGIC[i]);
    // "ranges", "checksum", "ranges/s", "checks/s"
    const std::string kind = table.is_sparse ? table.kind.substr(0, 8 - SPARSE.size()).append(SPARSE) : table.kind;
    for (size_t i = 0; i < 8; ++i) put(header, i < kind.size() ? kind[i] : '\0');
    put(header, int32_t(table.level));
    put(header, uint32_t(table.element_bytes));
    put(header, table.counts);
    put(header, frame_bytes);
    SHVR_CHECK(header.size() == HEADER_BYTES - sizeof(uint64_t), header.size());
    return header;
}

/// What is compressed.
std::vector<std::byte> content_of(const ProjectTable& table)
{
    const std::span<const std::byte> elements(table.elements);
    std::vector<std::byte> content;
    content.reserve(elements.size() + table.keys.size() * sizeof(uint64_t));
    const auto add = [&](std::span<const std::byte> bytes) {
        content.insert(content.end(), bytes.begin(), bytes.end());
    };
    add(elements.first(table.element_bytes));
    add(std::as_bytes(std::span(table.keys)));
    add(elements.subspan(table.element_bytes));
    return content;
}

uint64_t checksum_of(std::span<const std::byte> header, std::span<const std::byte> elements)
{
    // The header's hash seeds the elements' hash, so the result covers header and elements.
    return XXH3_64bits_withSeed(elements.data(), elements.size(), XXH3_64bits(header.data(), header.size()));
}

int64_t bytes_of_table(const Path& file, const ProjectTable& table)
{
    auto bytes = int64_t(table.element_bytes);
    for (int axis = 0; axis < 3; ++axis) {
        if (__builtin_mul_overflow(bytes, table.counts[axis], &bytes) || bytes > MAX_TABLE_BYTES) {
            fail(file.string(), ": would hold more than ", MAX_TABLE_BYTES >> 20, " MiB; expected a smaller volume");
        }
    }
    return bytes;
}

template <class T>
ValueRange range_as(std::span<const std::byte> element)
{
    T voxels[2];
    std::memcpy(voxels, element.data(), sizeof(voxels));
    return {double(voxels[0]), double(voxels[1])};
}

}  // namespace

std::string to_text(const ProjectRecord& record)
{
    const VolumeInfo& info = record.info;
    const VolumeStatistics& statistics = record.statistics;
    OrderedJson measured = {{"min", statistics.minimum},
                            {"max", statistics.maximum},
                            {"mean", statistics.mean},
                            {"not_finite", statistics.not_finite}};
    if (statistics.bulk) {
        measured["bulk"] = {
            {"min", statistics.bulk->lower}, {"max", statistics.bulk->upper}, {"beyond", statistics.beyond_bulk}};
        for (const ValueCount& fill : statistics.fill)
            measured["bulk"]["fill"].push_back({{"value", fill.value}, {"voxels", fill.voxels}});
    }
    measured["histogram"] = statistics.histogram;
    OrderedJson document = {
        {"shvr_volume", VERSION},
        {"source", record.source},
        {"preparation", record.preparation},
        {"size", {info.size.x, info.size.y, info.size.z}},
        {"type", name_of(info.type)},
        {"spacing", list_of(info.spacing)},
        {"unit", info.unit},
        {"spacing_from", name_of(info.spacing_from)},
        {"unit_from", name_of(info.unit_from)},
        {"directions", {list_of(info.directions[0]), list_of(info.directions[1]), list_of(info.directions[2])}},
        {"origin", list_of(info.origin)},
        {"frame", info.frame},
        {"levels", record.levels},
        {"content_hash", record.content_hash},
        {"statistics", measured},
        {"warnings", info.warnings}};
    if (std::isnan(record.fill))
        document["fill"] = "NaN";
    else if (record.fill != 0.0)
        document["fill"] = record.fill;
    return document.dump(1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

ProjectRecord read_project_record(const Path& file)
{
    return project_record_of(read_zarr_json(file, MAX_RECORD_BYTES));
}

ProjectRecord project_record_of(const JsonDocument& document)
{
    const JsonNode root = document.root();
    if (const JsonNode version = root["shvr_volume"]; version.whole(1, 1 << 30) > VERSION)
        throw NewerProject(version.refusal(sentence(
            VERSION, ", the newest that this version of SHVR knows: open the project with the one that wrote it")));
    ProjectRecord record;
    record.source = root["source"].any_text();
    record.preparation = root["preparation"].any_text();
    record.content_hash = root["content_hash"].any_text();
    record.levels = int(root["levels"].whole(1, 32));
    VolumeInfo& info = record.info;
    info.size = root["size"].size(MAX_SIDE);
    info.type = root["type"].parsed([](const std::string& name) { return voxel_type_of(name); }, VOXEL_TYPE_NAMES);
    info.spacing = root["spacing"].vector(any_number());
    if (!glm::all(glm::greaterThan(info.spacing, glm::dvec3(0.0)))) root["spacing"].refuse("three numbers above 0");
    info.unit = printable(root["unit"].any_text());
    info.spacing_from = read_provenance(root["spacing_from"]);
    info.unit_from = read_provenance(root["unit_from"]);
    info.directions = read_matrix(root["directions"]);
    if (!are_axes(info.directions)) root["directions"].refuse("three right-handed vectors of length 1");
    info.origin = root["origin"].vector(any_number());
    info.frame = printable(root["frame"].any_text());
    for (const JsonNode& warning : root["warnings"].elements()) info.warnings.push_back(printable(warning.any_text()));
    record.statistics = read_statistics(root["statistics"]);
    if (const JsonNode fill = root["fill"]; fill.exists())  // older projects have none
        record.fill = fill.is("NaN") ? std::numeric_limits<double>::quiet_NaN() : fill.number(any_number());
    return record;
}

Path ranges_path(const Path& project, int level)
{
    return project / sentence("shvr/ranges-", level);
}

Path checksums_path(const Path& project, int level)
{
    return project / sentence("shvr/checksums-", level);
}

void check_tables(const Path& project, const VolumeInfo& info)
{
    constexpr int64_t CHUNK = 64;
    static_cast<void>(bytes_of_table(ranges_path(project, 0),
                                     {.element_bytes = 2 * bytes_of(info.type), .counts = brick_grid(info.size)}));
    static_cast<void>(bytes_of_table(checksums_path(project, 0),
                                     {.element_bytes = sizeof(uint64_t), .counts = (info.size + (CHUNK - 1)) / CHUNK}));
}

std::span<const std::byte> ProjectTable::at(int64_t number) const
{
    auto place = size_t(number);
    if (is_sparse) {
        const auto found = std::ranges::lower_bound(keys, uint64_t(number));
        const bool is_listed = found != keys.end() && *found == uint64_t(number);
        place = is_listed ? size_t(found - keys.begin()) + 1 : 0;
    }
    return std::span(elements).subspan(place * element_bytes, element_bytes);
}

bool is_smaller_as_list(const ProjectTable& table, size_t listed)
{
    const auto element_bytes = double(table.element_bytes);
    const double all = double(table.counts.x) * double(table.counts.y) * double(table.counts.z) * element_bytes;
    return element_bytes + double(listed) * (element_bytes + sizeof(uint64_t)) < all;
}

ProjectTable stored_form(ProjectTable sparse, bool is_small)
{
    SHVR_CHECK(sparse.is_sparse && sparse.elements.size() == (sparse.keys.size() + 1) * sparse.element_bytes);
    if (!is_small && is_smaller_as_list(sparse, sparse.keys.size())) return sparse;
    ProjectTable table{
        .kind = sparse.kind, .level = sparse.level, .element_bytes = sparse.element_bytes, .counts = sparse.counts};
    table.elements.resize(size_t(bytes_of_table(sparse.kind, sparse)));
    const auto put_at = [&](size_t number, size_t place) {
        std::memcpy(table.elements.data() + number * table.element_bytes,
                    sparse.elements.data() + place * table.element_bytes, table.element_bytes);
    };
    for (size_t number = 0; number * table.element_bytes < table.elements.size(); ++number) put_at(number, 0);
    for (size_t i = 0; i < sparse.keys.size(); ++i) put_at(size_t(sparse.keys[i]), i + 1);
    return table;
}

std::vector<std::byte> to_bytes(const ProjectTable& table)
{
    const std::vector<std::byte> listed = table.is_sparse ? content_of(table) : std::vector<std::byte>();
    const std::vector<std::byte>& content = table.is_sparse ? listed : table.elements;
    SHVR_CHECK(table.is_sparse || content.size() == size_t(bytes_of_table(table.kind, table)), content.size());
    std::vector<std::byte> frame(ZSTD_compressBound(content.size()));
    const size_t made = ZSTD_compress(frame.data(), frame.size(), content.data(), content.size(), 3);
    SHVR_CHECK(ZSTD_isError(made) == 0, ZSTD_getErrorName(made));
    frame.resize(made);
    std::vector<std::byte> bytes = header_of(table, made);
    put(bytes, checksum_of(bytes, content));
    bytes.insert(bytes.end(), frame.begin(), frame.end());
    return bytes;
}

namespace {

/// Returns the content size that the frame states. Fails unless it fits a default and a whole number of keyed elements.
int64_t bytes_of_list(const Path& file, const ProjectTable& table, std::span<const std::byte> frame)
{
    const unsigned long long stated = ZSTD_getFrameContentSize(frame.data(), frame.size());
    const size_t each = table.element_bytes + sizeof(uint64_t);
    if (stated > size_t(MAX_TABLE_BYTES) || stated < table.element_bytes || (stated - table.element_bytes) % each != 0)
        fail(file.string(), ": states no possible length; expected that of a list of ", table.kind);
    return int64_t(stated);
}

void split_list(const Path& file, std::span<const std::byte> content, ProjectTable& table)
{
    const size_t count = (content.size() - table.element_bytes) / (table.element_bytes + sizeof(uint64_t));
    table.keys.resize(count);
    const std::span<const std::byte> keys = content.subspan(table.element_bytes, count * sizeof(uint64_t));
    if (count > 0) std::memcpy(table.keys.data(), keys.data(), keys.size());
    table.elements.assign(content.begin(), content.begin() + ptrdiff_t(table.element_bytes));
    const std::span<const std::byte> listed = content.subspan(table.element_bytes + keys.size());
    table.elements.insert(table.elements.end(), listed.begin(), listed.end());
    const auto all = uint64_t(table.counts.x * table.counts.y * table.counts.z);
    const bool ascends =
        std::ranges::is_sorted(table.keys) && std::ranges::adjacent_find(table.keys) == table.keys.end();
    if (!ascends || (count > 0 && table.keys.back() >= all))
        fail(file.string(), ": lists ", table.kind,
             " out of order or outside the volume; expected each once, by number");
}

}  // namespace

ProjectTable read_project_table(const Path& file, const ProjectTable& expected)
{
    return project_table_of(read_file(file, most_table_bytes()), file, expected);
}

int64_t most_table_bytes()
{
    return int64_t(HEADER_BYTES + ZSTD_compressBound(size_t(MAX_TABLE_BYTES)));
}

ProjectTable project_table_of(std::span<const std::byte> bytes, const Path& file, const ProjectTable& expected)
{
    if (bytes.size() < HEADER_BYTES || std::memcmp(bytes.data(), MAGIC, 8) != 0) {
        fail(file.string(), ": does not begin with ", MAGIC, "; expected a table of a project");
    }
    const std::span<const std::byte> frame = bytes.subspan(HEADER_BYTES);
    ProjectTable table = expected;
    const auto is_header = [&](bool is_sparse) {
        table.is_sparse = is_sparse;
        const std::vector<std::byte> header = header_of(table, frame.size());
        return std::memcmp(bytes.data(), header.data(), header.size()) == 0;
    };
    if (!is_header(true) && !is_header(false)) {
        fail(file.string(), ": is truncated or of another volume; expected ", expected.kind, " of ", expected.counts.x,
             "x", expected.counts.y, "x", expected.counts.z, " elements");
    }
    const int64_t decoded_bytes = table.is_sparse ? bytes_of_list(file, table, frame) : bytes_of_table(file, expected);
    if (decoded_bytes / MAX_OUT_OF_A_BYTE > int64_t(frame.size())) {
        fail(file.string(), ": holds ", frame.size(), " compressed bytes; expected enough for ", decoded_bytes);
    }
    std::vector<std::byte> content(size_t(decoded_bytes), std::byte{0});
    const size_t made = ZSTD_decompress(content.data(), content.size(), frame.data(), frame.size());
    uint64_t checksum = 0;
    const std::span<const std::byte> header = bytes.first(HEADER_BYTES - sizeof(checksum));
    std::memcpy(&checksum, bytes.data() + header.size(), sizeof(checksum));
    if (made != content.size() || checksum != checksum_of(header, content)) {
        fail(file.string(), ": is damaged; expected a table that matches its checksum");
    }
    if (table.is_sparse)
        split_list(file, content, table);
    else
        table.elements = std::move(content);
    return table;
}

ValueRange range_of(VoxelType type, std::span<const std::byte> element)
{
    switch (type) {
        case VoxelType::uint8: return range_as<uint8_t>(element);
        case VoxelType::int8: return range_as<int8_t>(element);
        case VoxelType::uint16: return range_as<uint16_t>(element);
        case VoxelType::int16: return range_as<int16_t>(element);
        case VoxelType::uint32: return range_as<uint32_t>(element);
        case VoxelType::int32: return range_as<int32_t>(element);
        case VoxelType::float32: return range_as<float>(element);
        case VoxelType::float64: return range_as<double>(element);
    }
    return {};
}

std::string archived_project(const std::filesystem::path& path)
{
    const bool is_remote = leads_to_network(path);
    if (!is_remote && !leads_into_archive(path)) return {};
    const std::optional<ZarrPlace> place = zarr_place(path);
    if (!place || !place->has(PROJECT_RECORD)) return {};
    return sentence(path.string(), ": is a project ", is_remote ? "on another machine" : "in an archive",
                    ", of which only the image is read; expected its folder, for annotations, looks and statistics: ",
                    is_remote ? "copy it to this machine" : "unpack the archive");
}

}  // namespace shvr
