#include "engine/formats/zarr/project_knowledge.h"

#include <cmath>
#include <cstring>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/zarr/project_bytes.h"
#include "engine/formats/zarr/store/zarr_json.h"
#include "engine/volume/source.h"
#include "engine/volume/voxel_numbers.h"
#include "shaders/bricks.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

ProjectTable table_for(const VolumeInfo& info, int level)
{
    return {.kind = "ranges",
            .level = level,
            .element_bytes = 2 * bytes_of(info.type),
            .counts = size_of_level(size_of_level(info.size, level), 5)};
}

/// Returns the chunks whose checksum is not 0, which are the stored ones.
std::vector<StoredChunk> stored_chunks_of(const ProjectTable& table)
{
    std::vector<StoredChunk> chunks;
    const size_t first = table.is_sparse ? 1 : 0;
    for (size_t place = first; place < table.elements.size() / sizeof(uint64_t); ++place) {
        StoredChunk chunk{.index = table.is_sparse ? table.keys[place - 1] : place, .checksum = 0};
        std::memcpy(&chunk.checksum, table.elements.data() + place * sizeof(uint64_t), sizeof(uint64_t));
        if (chunk.checksum != 0) chunks.push_back(chunk);
    }
    return chunks;
}

template <class Read>
void try_to(const Read& read, std::vector<std::string>& warnings)
{
    try {
        read();
    } catch (const NewerProject&) {
        throw;
    } catch (const Error& error) {
        warnings.push_back(sentence(error.what(), "; it is not used"));
    }
}

/// Side, in voxels, of the chunks that an import writes on every level.
constexpr int64_t PROJECT_CHUNK = 64;

std::string list_of(const std::vector<int64_t>& numbers)
{
    std::string list;
    for (const int64_t number : numbers) list += sentence(list.empty() ? "[" : ",", number);
    return list + "]";
}

/// Adds a warning for each array whose metadata differ from those that the import wrote.
void check_arrays(const fs::path& folder, const ProjectRecord& record, std::vector<std::string>& warnings)
{
    for (int level = 0; level < record.levels; ++level) {
        const ZarrPlace array = zarr_folder(folder / std::to_string(level));
        const bool is_3 = array.has("zarr.json");
        if (!is_3 && !array.has(".zarray")) continue;  // opening the image reports the missing array
        const auto warn = [&](const char* key, const auto& found, const auto& expected) {
            warnings.push_back(sentence(
                array.path_of(is_3 ? "zarr.json" : ".zarray").string(), ": key ", key, " is ", found, "; expected ",
                expected, ", as the import wrote it: another program changed it, and its new value is used"));
        };
        ZarrMetadata found;
        try {
            found = read_zarr_metadata(array, is_3 ? 3 : 2);
        } catch (const Error&) {
            continue;  // opening the image reports this error
        }
        const Size3 size = size_of_level(record.info.size, level);
        const std::vector<int64_t> shape{size.z, size.y, size.x}, chunks(3, PROJECT_CHUNK);
        double fill = 0.0;
        load_voxels(found.type, found.fill.data(), std::span(&fill, 1));
        if (found.shape != shape) warn("shape", list_of(found.shape), list_of(shape));
        if (found.chunks != chunks) warn(is_3 ? "chunk_shape" : "chunks", list_of(found.chunks), list_of(chunks));
        if (found.type != record.info.type)
            warn(is_3 ? "data_type" : "dtype", name_of(found.type), name_of(record.info.type));
        if (fill != record.fill && !(std::isnan(fill) && std::isnan(record.fill)))
            warn("fill_value", digits_of(fill), digits_of(record.fill));
        if (found.separator != '/')
            warn(is_3 ? "separator" : "dimension_separator", in_quotes(std::string(1, found.separator)), "\"/\"");
    }
}

}  // namespace

namespace {

/// Larger tables of a project at an address are not read: they would take longer than what they save.
constexpr int64_t MAX_REMOTE_TABLE_BYTES = int64_t{64} << 20;
constexpr int64_t MAX_REMOTE_RECORD_BYTES = int64_t{1} << 20;

ProjectTable checksums_for(const ZarrVolume& volume, int level)
{
    return {.kind = "checksum", .level = level, .element_bytes = sizeof(uint64_t), .counts = volume.counts()};
}

/// Reads a table below an address; fails if it is missing, too large or damaged.
ProjectTable remote_table(const ZarrPlace& place, const fs::path& name, const ProjectTable& expected)
{
    const std::optional<std::vector<std::byte>> bytes =
        place.store->read(place.key(name.string()), MAX_REMOTE_TABLE_BYTES);
    const fs::path file = place.path_of(name.string());
    if (!bytes) fail(file.string(), ": is missing; expected a table of the project");
    return project_table_of(*bytes, file, expected);
}

void take_info(const VolumeInfo& known, VolumeInfo& info)
{
    info.spacing = known.spacing;
    info.unit = known.unit;
    info.spacing_from = known.spacing_from;
    info.unit_from = known.unit_from;
    info.directions = known.directions;
    info.origin = known.origin;
    info.frame = known.frame;
    info.warnings = known.warnings;
}

}  // namespace

ProjectKnowledge read_remote_knowledge(const ZarrPlace& place, VolumeInfo& info, std::vector<ZarrVolume>& volumes)
{
    ProjectKnowledge knowledge;
    if (!place.has(PROJECT_RECORD)) return knowledge;
    std::vector<std::string> damage{
        sentence(place.path_of("").string(),
                 ": is a project on another machine, of which only the image is read; expected its folder, for "
                 "annotations and looks: copy it to this machine")};
    try_to(
        [&] {
            ProjectRecord record = project_record_of(read_zarr_json(place, PROJECT_RECORD, MAX_REMOTE_RECORD_BYTES));
            const bool fits =
                record.info.size == info.size && record.info.type == info.type && record.levels >= int(volumes.size());
            if (!fits)
                fail(place.path_of(PROJECT_RECORD).string(), ": describes another volume; expected that of this image");
            knowledge.record = std::move(record);
        },
        damage);
    if (knowledge.record) {
        take_info(knowledge.record->info, info);
        std::vector<ZarrWant> wants;
        for (int level = 0; level < int(volumes.size()); ++level)
            for (const fs::path& name : {ranges_path({}, level), checksums_path({}, level)})
                wants.push_back({.key = place.key(name.string()), .bytes = MAX_REMOTE_TABLE_BYTES});
        place.store->prepare(wants);
        knowledge.ranges.resize(volumes.size());
        for (int level = 0; level < int(volumes.size()); ++level) {
            const auto index = size_t(level);
            try_to(
                [&] {
                    knowledge.ranges[index] =
                        remote_table(place, ranges_path({}, level), table_for(knowledge.record->info, level));
                },
                damage);
            try_to(
                [&] {
                    volumes[index].expect(stored_chunks_of(
                        remote_table(place, checksums_path({}, level), checksums_for(volumes[index], level))));
                },
                damage);
        }
    }
    info.warnings.insert(info.warnings.end(), damage.begin(), damage.end());
    return knowledge;
}

ProjectKnowledge read_project_knowledge(const fs::path& folder, VolumeInfo& info, std::vector<ZarrVolume>& volumes)
{
    ProjectKnowledge knowledge;
    const fs::path file = folder / PROJECT_RECORD;
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return knowledge;
    std::vector<std::string> damage;
    try_to(
        [&] {
            ProjectRecord record = read_project_record(file);
            check_arrays(folder, record, damage);
            const bool fits =
                record.info.size == info.size && record.info.type == info.type && record.levels >= int(volumes.size());
            if (!fits) fail(file.string(), ": describes another volume; expected that of this folder");
            knowledge.record = std::move(record);
        },
        damage);
    if (knowledge.record) take_info(knowledge.record->info, info);
    knowledge.ranges.resize(volumes.size());
    for (int level = 0; level < int(volumes.size()); ++level) {
        const auto index = size_t(level);
        try_to(
            [&] { knowledge.ranges[index] = read_project_table(ranges_path(folder, level), table_for(info, level)); },
            damage);
        try_to(
            [&] {
                const ProjectTable table =
                    read_project_table(checksums_path(folder, level), checksums_for(volumes[index], level));
                volumes[index].expect(stored_chunks_of(table));
            },
            damage);
    }
    info.warnings.insert(info.warnings.end(), damage.begin(), damage.end());
    return knowledge;
}

std::optional<ValueRange> range_of(const ProjectKnowledge& knowledge, const VolumeInfo& info, int level,
                                   const Size3& brick)
{
    const auto index = size_t(level);
    if (index >= knowledge.ranges.size() || !knowledge.ranges[index]) return std::nullopt;
    const ProjectTable& table = *knowledge.ranges[index];
    return range_of(info.type, table.at(brick.x + table.counts.x * (brick.y + table.counts.y * brick.z)));
}

}  // namespace shvr
