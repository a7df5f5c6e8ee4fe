#pragma once
// Describes a volume, session or project, with the statistics of its voxels, for `shvr info`. Any thread.

#include "engine/tasks/task_options.h"

namespace shvr {

struct DescribeTask {
    static constexpr const char* TITLE = "Describe volume";

    std::filesystem::path input;
    bool exact = false;                     ///< measures all voxels, even if a sample or a coarser level would suffice
    bool allows_incomplete = false;         ///< leaves out voxels that cannot be read
    std::vector<std::string> settings;      ///< "key=value" settings of a session
    OptionNames names = OptionNames::keys;  ///< how messages name options; not an option itself
};
void fields(Fields& f, DescribeTask& task);

struct DescribeResult {
    VolumeInfo info;
    VolumeStatistics statistics;
    int levels = 1;
    int64_t voxels_not_read = 0;
    std::filesystem::path mask;         ///< the session's mask; empty: none
    std::vector<std::string> warnings;  ///< including the warnings of `info`
    std::vector<std::string> losses;    ///< saved data that is missing
};

DescribeResult run(const DescribeTask& task, ProgressReporter& reporter);

}  // namespace shvr
