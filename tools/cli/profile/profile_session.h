#pragma once
// `shvr profile --script`: measures a session of work, action by action, on the workbench that the window uses. The
// session can be repeated to measure the noise.

#include "tools/cli/profile/profile_report.h"

namespace shvr::cli {

struct ProfiledAction {
    int line = 0;                         ///< line in the script
    std::string action;                   ///< its key "op"
    double begin_ms = 0.0, end_ms = 0.0;  ///< begin and end on the host's clock, since the first action
    // Times since the beginning of the action; null if the event did not happen before the next action.
    std::optional<double> paint_ms;       ///< time until the voxels that the action changes are painted; null: their
                                          ///< number is unchanged
    std::optional<double> sketch_ms;      ///< time until every pane shows the result at least as a sketch
    std::optional<double> sharp_ms;       ///< time until every pane shows the result sharp
    uint64_t submits = 0;                 ///< submissions of the picture
    uint64_t allocations = 0;             ///< allocations of device memory
    uint64_t uploads = 0, evictions = 0;  ///< paged bricks only
    int64_t voxels_painted = 0;           ///< change of the number of voxels in groups; may be negative
    uint64_t device_bytes = 0;
};
using Replayed = std::vector<ProfiledAction>;  ///< the whole script, done once

struct SessionProfile {
    std::string input, script, device, driver;
    glm::uvec2 size{0};
    std::vector<Replayed> replays;  ///< at least one; all have the same actions; the last used the input itself
    Json bytes;
    uint64_t device_budget = 0, host_budget = 0;
};

/// Keys and labels of the total times of the script, in the section "whole".
inline constexpr std::pair<const char*, const char*> WHOLE_SCRIPT[] = {{"paint_ms", "to paint, all actions"},
                                                                       {"sketch_ms", "to sketch, all actions"},
                                                                       {"sharp_ms", "to sharp, all actions"},
                                                                       {"session_ms", "from begin to end"}};

/// Executes the script, as `shvr annotate --actions` does: its painting is stored in the journal. All of the `replays`
/// except the last one run on copies of the input, so that each begins with the same state. Each has a device of its
/// own.
SessionProfile profile_session(const std::string& input, const std::string& script, int replays, const Common& common);

/// README.md lists the keys.
Json summary_of(const SessionProfile& profile);
std::string session_text(const Json& summary);
std::string trace_of(const SessionProfile& profile);
std::string csv_of(const SessionProfile& profile);
std::string page_of(const SessionProfile& profile);

}  // namespace shvr::cli
