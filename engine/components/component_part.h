#pragma once
// A part of a volume's slices, labelled by a process of its own, and the file that keeps it until another process joins
// all parts. The parts' labels depend on how the volume was split; the numbers that joining gives do not.

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/components/labelled_range.h"

namespace shvr {

struct SliceRange {
    int64_t lower = 0, upper = 0;
};

/// Ranges that threads have labelled, in order.
struct SlicesDone {
    std::deque<LabelledRange> ranges;
    int64_t peak_bytes = 0;
};
/// Returns the blocks of a sparse volume that can hold voxels at or above the threshold; null: all blocks.
std::optional<StoredBlocks> stored_above(const VolumeSource& source, double threshold);
/// Labels the slices of a range; `runs`: keeps their runs, unless null.
SlicesDone label_slices(const VolumeSource& source, const ComponentOptions& options,
                        const std::optional<StoredBlocks>& stored, const SliceRange& slices, RunFile* runs);

/// Labels the slices of a range and writes them to `file`, which appears once it is complete. `with_runs`: keeps what
/// labels of voxels need; otherwise components can only be counted. `note`: is called at the end; its text is kept.
void write_component_part(const VolumeSource& source, const ComponentOptions& options, const SliceRange& slices,
                          const std::filesystem::path& file, const std::function<std::string()>& note = {});

class ComponentPart {
public:
    /// Reads the description. Fails with a sentence if the file is not what write_component_part writes, or is part of
    /// a volume of another size.
    ComponentPart(const std::filesystem::path& file, const Size3& size);

    const SliceRange& slices() const { return slices_; }
    const std::string& note() const { return note_; }
    std::deque<LabelledRange> read_ranges() const;
    /// Appends the file of the part's runs.
    void add_runs(std::deque<RunFile>& files) const;

private:
    [[noreturn]] void refuse() const;

    std::filesystem::path file_;
    Size3 size_;
    SliceRange slices_;
    std::string note_;
    std::vector<RunFile::Place> places_;
    std::vector<std::byte> ranges_;  ///< as written, to be read once
};

/// Joins parts that follow each other, from slice 0 to the last one, into the components of the whole volume. Fails
/// with a sentence if they do not. `options`: as find_components has them.
std::unique_ptr<Components> join_components(const VolumeSource& source, const ComponentOptions& options,
                                            const std::vector<ComponentPart>& parts);

}  // namespace shvr
