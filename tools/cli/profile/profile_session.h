#pragma once
// `shvr profile --script`: a session of work, action by action, on the workbench that the window uses; several times,
// where the noise is to be known.

#include "tools/cli/profile/profile_report.h"

namespace shvr::cli {

struct ProfiledAction {
    int line = 0;                         ///< of the script
    std::string action;                   ///< its key "op"
    double begin_ms = 0.0, end_ms = 0.0;  ///< on the host's clock, from the first action
    // From the beginning of the action; null where that did not happen before the next action.
    std::optional<double> paint_ms;       ///< until the voxels that it changed are painted; null: as many are as before
    std::optional<double> sketch_ms;      ///< until every pane shows at least a sketch of it
    std::optional<double> sharp_ms;       ///< until every pane shows it sharp
    uint64_t submits = 0;                 ///< of the picture
    uint64_t allocations = 0;             ///< of device memory
    uint64_t uploads = 0, evictions = 0;  ///< of bricks, where they are paged
    int64_t voxels_painted = 0;           ///< more in groups than before; below 0: less
    uint64_t device_bytes = 0;
};
using Replayed = std::vector<ProfiledAction>;  ///< the whole script, done once

struct SessionProfile {
    std::string input, script, device, driver;
    glm::uvec2 size{0};
    std::vector<Replayed> replays;  ///< at least one, all of the same actions; the last one is the input's own
    Json bytes;
    uint64_t device_budget = 0, host_budget = 0;
};

/// Of the whole script, in the section "whole", as people read them.
inline constexpr std::pair<const char*, const char*> WHOLE_SCRIPT[] = {{"paint_ms", "to paint, all actions"},
                                                                       {"sketch_ms", "to sketch, all actions"},
                                                                       {"sharp_ms", "to sharp, all actions"},
                                                                       {"session_ms", "from begin to end"}};

/// Does what the script says, as `shvr annotate --actions` does: what it paints is kept in the journal. Of `replays`
/// all but the last are done on copies of the work, so that each begins with the same. Every one has a device of its
/// own.
SessionProfile profile_session(const std::string& input, const std::string& script, int replays, const Common& common);

/// README.md lists the keys.
Json summary_of(const SessionProfile& profile);
std::string session_text(const Json& summary);
std::string trace_of(const SessionProfile& profile);
std::string csv_of(const SessionProfile& profile);
std::string page_of(const SessionProfile& profile);

}  // namespace shvr::cli
