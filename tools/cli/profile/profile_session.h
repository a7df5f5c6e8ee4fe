#pragma once
// `shvr profile --script`: a session of work, action by action, on the workbench that the window uses.

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

struct SessionProfile {
    std::string input, script, device, driver;
    glm::uvec2 size{0};
    std::vector<ProfiledAction> actions;
    Json bytes;
    uint64_t device_budget = 0, host_budget = 0;
};

/// Does what the script says, as `shvr annotate --actions` does: what it paints is kept in the journal.
SessionProfile profile_session(const std::string& input, const std::string& script, const Common& common);

/// README.md lists the keys.
Json summary_of(const SessionProfile& profile);
std::string session_text(const Json& summary);
std::string trace_of(const SessionProfile& profile);
std::string csv_of(const SessionProfile& profile);
std::string page_of(const SessionProfile& profile);

}  // namespace shvr::cli
