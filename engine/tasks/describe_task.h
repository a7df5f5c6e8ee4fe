#pragma once
// What a volume, session or project is, with the statistics of its voxels: what `shvr info` does. Any thread.

#include "engine/tasks/task_options.h"

namespace shvr {

struct DescribeTask {
    static constexpr const char* TITLE = "Describe volume";

    std::filesystem::path input;
    bool exact = false;                 ///< all voxels, also of volumes for which a sample or a coarser level would do
    bool allows_incomplete = false;     ///< voxels that cannot be read count nowhere
    std::vector<std::string> settings;  ///< "key=value" of a session
    OptionNames names = OptionNames::keys;  ///< in messages; not an option
};
void fields(Fields& f, DescribeTask& task);

struct DescribeResult {
    VolumeInfo info;
    VolumeStatistics statistics;
    int levels = 1;
    int64_t voxels_not_read = 0;
    std::filesystem::path mask;         ///< of a session; empty: none
    std::vector<std::string> warnings;  ///< also those of `info`
    std::vector<std::string> losses;    ///< what is not there although it was saved
};

DescribeResult run(const DescribeTask& task, ProgressReporter& reporter);

}  // namespace shvr
