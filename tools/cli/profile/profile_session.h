#pragma once
// `shvr profile --script`: a session of work, action by action, on the workbench that the window uses; repeated if the
// noise is to be measured.

#include "tools/cli/profile/profile_report.h"

namespace shvr::cli {

struct ProfiledAction {
    int line = 0;                         ///< line in the script
    std::string action;                   ///< its key "op"
    double begin_ms = 0.0, end_ms = 0.0;  ///< time on the host's clock, from the first action
    // Times from the beginning of the action; each is null if its event did not happen before the next action.
    std::optional<double> paint_ms;       ///< time until the voxels that the action changed are painted; null: their
                                          ///< number is unchanged
    std::optional<double> sketch_ms;      ///< time until every pane shows at least a sketch of the result
    std::optional<double> sharp_ms;       ///< time until every pane shows the result sharp
    uint64_t submits = 0;                 ///< submissions of the picture
    uint64_t allocations = 0;             ///< allocations of device memory
    uint64_t uploads = 0, evictions = 0;  ///< paged bricks only
    int64_t voxels_painted = 0;           ///< increase of the number of voxels in groups; below 0: decrease
    uint64_t device_bytes = 0;
};
using Replayed = std::vector<ProfiledAction>;  ///< the whole script, done once

struct SessionProfile {
    std::string input, script, device, driver;
    glm::uvec2 size{0};
    std::vector<Replayed> replays;  ///< at least one; all have the same actions; the last one ran on the input itself
    Json bytes;
    uint64_t device_budget = 0, host_budget = 0;
};

/// Labels of the times of the whole script, in the section "whole".
inline constexpr std::pair<const char*, const char*> WHOLE_SCRIPT[] = {{"paint_ms", "to paint, all actions"},
                                                                       {"sketch_ms", "to sketch, all actions"},
                                                                       {"sharp_ms", "to sharp, all actions"},
                                                                       {"session_ms", "from begin to end"}};

/// Executes the script, as `shvr annotate --actions` does: its painting is
/// kept in the journal. All `replays` but the last run on copies of the work,
/// so that each begins with the same state. Each has a device of its own.
SessionProfile profile_session(const std::string& input, const std::string& script, int replays, const Common& common);

/// README.md lists the keys.
Json summary_of(const SessionProfile& profile);
std::string session_text(const Json& summary);
std::string trace_of(const SessionProfile& profile);
std::string csv_of(const SessionProfile& profile);
std::string page_of(const SessionProfile& profile);

}  // namespace shvr::cli
