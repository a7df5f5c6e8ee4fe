#include "engine/projects/levels/import_tally.h"

#include <algorithm>
#include <cstring>

namespace shvr {
namespace {

using Bytes = std::span<const std::byte>;

size_t values_of(VoxelType type)
{
    return bytes_of(type) <= 2 ? size_t{1} << (8 * bytes_of(type)) : 0;
}

template <class Bits>
void count_values(Bytes voxels, std::vector<int64_t>& counts)
{
    Bits value;
    for (size_t at = 0; at < voxels.size(); at += sizeof(Bits)) {
        std::memcpy(&value, voxels.data() + at, sizeof(Bits));
        ++counts[value];
    }
}

}  // namespace

ValueCounts::ValueCounts(VoxelType type, int workers)
    : type_(type), counts_(size_t(workers), std::vector<int64_t>(values_of(type)))
{}

void ValueCounts::add(Bytes voxels, int worker)
{
    std::vector<int64_t>& counts = counts_[size_t(worker)];
    if (bytes_of(type_) == 1) count_values<uint8_t>(voxels, counts);
    if (bytes_of(type_) == 2) count_values<uint16_t>(voxels, counts);
}

void ValueCounts::add(Bytes voxel, int64_t times, int worker)
{
    if (counts_[0].empty()) return;
    uint16_t bits = 0;
    std::memcpy(&bits, voxel.data(), bytes_of(type_));
    counts_[size_t(worker)][bits] += times;
}

void ValueCounts::merge(StateReader& state)
{
    std::vector<int64_t> added(counts_[0].size());
    state.take_all(added);
    for (size_t value = 0; value < added.size(); ++value) counts_[0][value] += added[value];
}

std::vector<int64_t> ValueCounts::total() const
{
    std::vector<int64_t> total = counts_[0];
    for (size_t worker = 1; worker < counts_.size(); ++worker) {
        for (size_t value = 0; value < total.size(); ++value) total[value] += counts_[worker][value];
    }
    return total;
}

std::optional<VolumeStatistics> ValueCounts::statistics() const
{
    const std::vector<int64_t> counts = total();
    if (counts.empty()) return std::nullopt;
    const bool is_signed = type_ == VoxelType::int8 || type_ == VoxelType::int16;
    if (!is_signed) return statistics_of(counts, 0);
    // In the order of their bit patterns, negative values come after all others.
    const auto half = std::ptrdiff_t(counts.size() / 2);
    std::vector<int64_t> ascending(counts.begin() + half, counts.end());
    ascending.insert(ascending.end(), counts.begin(), counts.begin() + half);
    return statistics_of(ascending, -int(half));
}

ImportTally::ImportTally(const VolumeInfo& info, int64_t slices_at_once, int workers)
    : hashes_(size_t(info.size.z)), hashers_(size_t(slices_at_once)), counts_(info.type, workers)
{}

SliceHasher& ImportTally::hasher_of(int64_t slice)
{
    return hashers_[size_t(slice) % hashers_.size()];
}

void ImportTally::add(int64_t slice, Bytes rows, int worker)
{
    hasher_of(slice).add(rows);
    counts_.add(rows, worker);
}

void ImportTally::finish(int64_t lower, int64_t upper)
{
    for (int64_t slice = lower; slice < upper; ++slice) {
        hashes_[size_t(slice)] = hasher_of(slice).finish();
    }
}

std::string ImportTally::content_hash() const
{
    return shvr::content_hash(hashes_);
}

void ImportTally::save(StateWriter& state) const
{
    state.put_all(hashes_);
    counts_.save(state);
}

void ImportTally::load(StateReader& state)
{
    state.take_all(hashes_);
    counts_.load(state);
}

void ImportTally::merge(StateReader& state, int64_t lower, int64_t upper)
{
    std::vector<SliceHash> hashes(hashes_.size());
    state.take_all(hashes);
    std::copy(hashes.begin() + lower, hashes.begin() + upper, hashes_.begin() + lower);
    counts_.merge(state);
}

}  // namespace shvr
