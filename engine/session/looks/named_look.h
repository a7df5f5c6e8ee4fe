#pragma once
// A look that fits any scan: the transfer function relative to the intensities of its tissue, the light, and names,
// parents, colours and opacities of groups. Its file (README.md) is made from one scan and applied to others. Which
// groups are hidden or locked is work on one scan, not part of a look. Any thread.

#include <filesystem>
#include <string>
#include <vector>

#include "engine/session/transfer_presets.h"

namespace shvr {

struct NamedLook {
    std::string name;
    TransferPreset curve;
    Groups groups;
    Light light;
};

/// Returns the look of a session whose volume has these statistics. Fails if its transfer function cannot be kept
/// (preset_of).
NamedLook look_of(const Session& session, const std::string& name, const VolumeStatistics& statistics);
/// Returns the session with the look. Groups that the look does not have keep theirs; hidden and locked ones stay so.
/// Fails if the parents of both together would form a cycle.
Session with_look(Session session, const NamedLook& look, const VolumeStatistics& statistics);

std::string text_of(const NamedLook& look);
/// Parses the JSON of a look. Messages call the text `origin`. Fails on unknown, repeated and missing keys and on
/// values out of range.
NamedLook parse_look(const std::string& text, const std::string& name, const std::string& origin);
/// Returns whether the JSON is meant as a look: an object with the key `shvr_look`. Fails if it is no JSON.
bool is_look(const std::string& text, const std::string& origin);
NamedLook read_look(const std::filesystem::path& file);

/// Returns the looks in a folder, which need not exist, sorted by name. Leaves out malformed files, and returns the
/// reasons.
std::vector<NamedLook> looks_in(const std::filesystem::path& folder, std::vector<std::string>& warnings);
/// Returns the path of a look's file in a folder. Fails if the name cannot be a file name.
std::filesystem::path look_file(const std::filesystem::path& folder, const std::string& name);

}  // namespace shvr
