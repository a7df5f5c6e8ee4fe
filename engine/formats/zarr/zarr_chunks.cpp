#include "engine/formats/zarr/zarr_chunks.h"

#include <algorithm>
#include <cstring>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "engine/formats/byte_order.h"
#include "engine/formats/zarr/zarr_codec.h"

namespace shvr {
namespace {

constexpr int64_t KEPT_INDEX_BYTES = int64_t{16} << 20;
/// Maximum number of names that stray() searches for a name like a chunk's that belongs to no chunk of the array.
constexpr int64_t MAX_NAMES_LOOKED_AT = 1024;

/// Whether a key consists of numbers with separators between them, perhaps after a "c": "0.1.2" or "c/0/1/2".
bool is_like_chunk(std::string_view key)
{
    if (key.starts_with("c/") || key.starts_with("c.")) key.remove_prefix(2);
    for (;;) {
        const size_t end = std::min(key.size(), key.find_first_of("./"));
        const bool is_number = end > 0 && key.substr(0, end).find_first_not_of("0123456789") == std::string_view::npos;
        if (!is_number || end == key.size()) return is_number;
        key.remove_prefix(end + 1);
    }
}

/// The position of a chunk in a shard, as the shard's index states it.
struct IndexEntry {
    uint64_t offset, bytes;
    auto operator<=>(const IndexEntry&) const = default;
};

uint64_t end_of(const IndexEntry& entry)
{
    uint64_t end = 0;
    return __builtin_add_overflow(entry.offset, entry.bytes, &end) ? ~uint64_t{0} : end;
}

/// Returns the entries that overlap another entry, in ascending order. Entries with identical positions count as one,
/// since some writers store equal chunks once.
std::vector<IndexEntry> overlapping(std::vector<IndexEntry> entries)
{
    std::ranges::sort(entries);
    const auto repeated = std::ranges::unique(entries);
    entries.erase(repeated.begin(), repeated.end());
    std::vector<IndexEntry> found;
    const IndexEntry* last = nullptr;  // the entry that reaches furthest so far
    for (const IndexEntry& entry : entries) {
        if (entry.bytes == 0) continue;
        if (last != nullptr && entry.offset < end_of(*last)) found.insert(found.end(), {*last, entry});
        if (last == nullptr || end_of(entry) > end_of(*last)) last = &entry;
    }
    std::ranges::sort(found);
    return found;
}

}  // namespace

ZarrChunks::ZarrChunks(ZarrPlace array, ZarrMetadata metadata)
    : array_(std::move(array)), metadata_(std::move(metadata)), indices_(KEPT_INDEX_BYTES)
{}

std::string ZarrChunks::key_of(std::span<const int64_t> chunk) const
{
    std::vector<int64_t> numbers(chunk.begin(), chunk.end());
    if (metadata_.sharding) {
        for (size_t axis = 0; axis < numbers.size(); ++axis)
            numbers[axis] /= metadata_.sharding->shape[axis] / metadata_.chunks[axis];
    }
    return metadata_.key_of(numbers);
}

std::filesystem::path ZarrChunks::path_of(std::span<const int64_t> chunk) const
{
    return array_.path_of(key_of(chunk));
}

std::string ZarrChunks::name_of(std::span<const int64_t> chunk) const
{
    std::string name = path_of(chunk).string();
    if (!metadata_.sharding) return name;
    name += " (chunk ";
    for (size_t axis = 0; axis < chunk.size(); ++axis) name += sentence(axis == 0 ? "" : ",", chunk[axis]);
    return name + ")";
}

std::optional<std::vector<std::byte>> ZarrChunks::read(std::span<const int64_t> chunk) const
{
    const std::string key = key_of(chunk);
    const int64_t longest = longest_stored(int64_t(metadata_.chunk_bytes()));
    if (!metadata_.sharding) return array_.store->read(array_.key(key), longest);
    const Part part = part_of(chunk, key);
    if (part.offset == ABSENT && part.bytes == ABSENT) return std::nullopt;
    if (part.offset == SHARED && part.bytes == 0)
        fail(name_of(chunk), ": shares bytes with another chunk of its shard; expected bytes of its own");
    const auto index = uint64_t(metadata_.sharding->index_bytes(metadata_.chunks));
    const auto shard = uint64_t(array_.store->size_of(array_.key(key)).value_or(0));
    const uint64_t lower = metadata_.sharding->is_index_first ? index : 0;
    const uint64_t upper = metadata_.sharding->is_index_first ? shard : shard - std::min(shard, index);
    if (part.offset < lower || part.offset > upper || part.bytes > upper - part.offset) {
        fail(name_of(chunk), ": is said to be ", part.bytes, " bytes at byte ", part.offset,
             "; expected them between bytes ", lower, " and ", upper, " of the shard");
    }
    if (part.bytes > uint64_t(longest))
        fail(name_of(chunk), ": holds ", part.bytes, " bytes; expected at most ", longest);
    std::vector<std::byte> stored(size_t(part.bytes));
    array_.store->read_part(array_.key(key), int64_t(part.offset), stored);
    return stored;
}

void ZarrChunks::prepare(std::span<const std::vector<int64_t>> chunks) const
{
    const int64_t longest = longest_stored(int64_t(metadata_.chunk_bytes()));
    if (metadata_.sharding) prepare_indices(chunks);
    std::vector<ZarrWant> wants;
    for (const std::vector<int64_t>& chunk : chunks) {
        const std::string key = key_of(chunk);
        if (!metadata_.sharding) {
            wants.push_back({.key = array_.key(key), .bytes = longest});
            continue;
        }
        try {
            const Part part = part_of(chunk, key);
            if (part.bytes > 0 && part.bytes <= uint64_t(longest) && part.offset < uint64_t{1} << 62)
                wants.push_back({.key = array_.key(key), .offset = int64_t(part.offset), .bytes = int64_t(part.bytes)});
        } catch (const Stopped&) {
            throw;
        } catch (const Error&) {
            continue;  // reading the chunk reports it
        }
    }
    array_.store->prepare(wants);
}

/// Reads the indices of these chunks' shards ahead, except for indices that are cached.
void ZarrChunks::prepare_indices(std::span<const std::vector<int64_t>> chunks) const
{
    const ZarrSharding& sharding = *metadata_.sharding;
    const int64_t bytes = sharding.index_bytes(metadata_.chunks);
    std::vector<ZarrWant> wants;
    for (const std::vector<int64_t>& chunk : chunks) {
        const std::string key = array_.key(key_of(chunk));
        const bool is_known = std::ranges::find(wants, key, &ZarrWant::key) != wants.end() ||
                              indices_.has({0, int64_t(shard_number(chunk))});
        if (!is_known) wants.push_back({.key = key, .offset = sharding.is_index_first ? 0 : -bytes, .bytes = bytes});
    }
    array_.store->prepare(wants);
}

bool ZarrChunks::is_missing(std::span<const int64_t> chunk) const
{
    const std::string key = key_of(chunk);
    if (!metadata_.sharding) return array_.store->lacks(array_.key(key));
    try {
        const Part part = part_of(chunk, key);
        return part.offset == ABSENT && part.bytes == ABSENT;
    } catch (const Error&) {
        return false;
    }
}

/// Calls `take` with the indices of each stored chunk of a shard that lies inside the array. Returns false as soon as
/// `take` returns false.
template <class Take>
bool ZarrChunks::list_shard(std::span<const int64_t> shard, const Take& take) const
{
    const ZarrSharding& sharding = *metadata_.sharding;
    const size_t axes = shard.size();
    std::vector<int64_t> first(axes), count(axes), chunk(axes);
    for (size_t axis = 0; axis < axes; ++axis) {
        const int64_t along = sharding.shape[axis] / metadata_.chunks[axis];
        first[axis] = shard[axis] * along;
        count[axis] = std::min(along, (metadata_.shape[axis] - 1) / metadata_.chunks[axis] + 1 - first[axis]);
    }
    const std::string key = metadata_.key_of(shard);
    for (chunk = first;;) {
        const Part part = part_of(chunk, key);
        if ((part.offset != ABSENT || part.bytes != ABSENT) && !take(chunk)) return false;
        size_t axis = axes;
        while (axis > 0 && ++chunk[axis - 1] == first[axis - 1] + count[axis - 1]) {
            chunk[axis - 1] = first[axis - 1];
            --axis;
        }
        if (axis == 0) return true;
    }
}

bool ZarrChunks::list(std::span<const std::optional<int64_t>> at, int64_t most,
                      const std::function<void(std::span<const int64_t>)>& take) const
{
    const auto counted = [&](std::span<const int64_t> chunk) {
        for (size_t axis = 0; axis < chunk.size(); ++axis)
            if (at[axis].value_or(chunk[axis]) != chunk[axis]) return true;
        if (--most < 0) return false;
        take(chunk);
        return true;
    };
    std::string folder;  // the innermost folder with all matching chunks
    if (metadata_.separator == '/') {
        folder = metadata_.has_prefix ? "c/" : "";
        for (size_t axis = 0; axis + 1 < at.size() && at[axis]; ++axis) {
            const int64_t along = metadata_.sharding ? metadata_.sharding->shape[axis] / metadata_.chunks[axis] : 1;
            folder += sentence(*at[axis] / along, "/");
        }
    }
    int64_t names_left = 8 * std::min(most, int64_t{1} << 48) + (1 << 16);
    return array_.store->list(array_.key(folder), [&](std::string_view name) {
        if (--names_left < 0) return false;
        const std::vector<int64_t> numbers = chunk_numbers(metadata_, folder + std::string(name));
        if (numbers.empty()) return true;
        return metadata_.sharding ? list_shard(numbers, counted) : counted(numbers);
    });
}

std::string ZarrChunks::stray() const
{
    std::string found;
    int64_t left = MAX_NAMES_LOOKED_AT;
    try {
        array_.store->list(array_.key(""), [&](std::string_view key) {
            if (is_like_chunk(key) && chunk_numbers(metadata_, key).empty())
                found = array_.path_of(std::string(key)).string();
            return found.empty() && --left > 0;
        });
    } catch (const Error&) {
        return {};  // reading reports the reason
    }
    return found;
}

Block ZarrChunks::decoded(std::span<const std::byte> stored, const std::string& name) const
{
    check_stored_size(metadata_.codecs, stored.size(), metadata_.chunk_bytes(), name);
    Block chunk(metadata_.chunk_bytes());
    decode_chunk(metadata_.codecs, stored, chunk, name);
    if (metadata_.big_endian) swap_bytes(chunk, bytes_of(metadata_.type));
    return chunk;
}

ZarrChunks::Part ZarrChunks::part_of(std::span<const int64_t> chunk, const std::string& shard) const
{
    const ZarrSharding& sharding = *metadata_.sharding;
    size_t place = 0;
    for (const size_t axis : sharding.order) {
        const int64_t along = sharding.shape[axis] / metadata_.chunks[axis];
        place = place * size_t(along) + size_t(chunk[axis] % along);
    }
    const auto index = indices_.get({0, int64_t(shard_number(chunk))}, [&] { return index_of(shard); });
    if (index->empty()) return {ABSENT, ABSENT};
    Part part{};
    std::memcpy(&part, index->data() + place * sizeof(Part), sizeof(Part));
    return part;
}

/// Returns the number of a chunk's shard. Unsigned, so that overflow in absurdly large arrays only wraps around.
uint64_t ZarrChunks::shard_number(std::span<const int64_t> chunk) const
{
    const ZarrSharding& sharding = *metadata_.sharding;
    uint64_t number = 0;
    for (size_t axis = 0; axis < chunk.size(); ++axis) {
        const int64_t shards = (metadata_.shape[axis] - 1) / sharding.shape[axis] + 1;
        number = number * uint64_t(shards) + uint64_t(chunk[axis] / (sharding.shape[axis] / metadata_.chunks[axis]));
    }
    return number;
}

/// Returns a shard's index, with one Part per chunk; empty if the shard does not exist.
Block ZarrChunks::index_of(const std::string& shard) const
{
    const ZarrSharding& sharding = *metadata_.sharding;
    const std::string name = array_.path_of(shard).string();
    const int64_t index_bytes = sharding.index_bytes(metadata_.chunks);
    const auto edge = array_.store->read_edge(array_.key(shard), !sharding.is_index_first, index_bytes);
    if (!edge) return {};
    if (edge->value_bytes < index_bytes)
        fail(name, ": holds ", edge->value_bytes, " bytes; expected at least ", index_bytes, ", the index of a shard");
    std::span<const std::byte> content = edge->bytes;
    for (int i = 0; i < sharding.checksums; ++i) content = without_checksum(content, name + " (index)");
    Block index(content.begin(), content.end());
    if (sharding.is_big_endian) swap_bytes(index, sizeof(uint64_t));

    std::vector<IndexEntry> entries(index.size() / sizeof(IndexEntry));
    std::memcpy(entries.data(), index.data(), index.size());
    std::vector<IndexEntry> present;
    for (const IndexEntry& entry : entries) {
        if (entry != IndexEntry{ABSENT, ABSENT}) present.push_back(entry);
    }
    const std::vector<IndexEntry> shared = overlapping(std::move(present));
    if (shared.empty()) return index;
    for (IndexEntry& entry : entries) {
        if (std::ranges::binary_search(shared, entry)) entry = {SHARED, 0};
    }
    std::memcpy(index.data(), entries.data(), index.size());
    return index;
}

std::vector<int64_t> chunk_numbers(const ZarrMetadata& metadata, std::string_view key)
{
    const std::vector<int64_t>& side = metadata.sharding ? metadata.sharding->shape : metadata.chunks;
    std::string_view rest = key;
    if (metadata.has_prefix) rest.remove_prefix(std::min<size_t>(rest.size(), 2));
    std::vector<int64_t> numbers;
    while (numbers.size() < side.size()) {
        const size_t end = std::min(rest.size(), rest.find(metadata.separator));
        const std::optional<int64_t> number = whole_of(rest.substr(0, end));
        const size_t axis = numbers.size();
        if (!number || *number < 0 || *number > (metadata.shape[axis] - 1) / side[axis]) return {};
        numbers.push_back(*number);
        rest.remove_prefix(std::min(rest.size(), end + 1));
    }
    // Rejects other spellings of the same numbers, as in "00", which are different keys.
    return metadata.key_of(numbers) == key ? numbers : std::vector<int64_t>();
}

}  // namespace shvr
