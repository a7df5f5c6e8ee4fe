#include "engine/session/outside_files.h"

#include <algorithm>

#include "engine/base/atomic_writer.h"
#include "engine/formats/zarr/project.h"

namespace shvr {

namespace fs = std::filesystem;

namespace {

bool is_within(const fs::path& path, const fs::path& folder)
{
    const fs::path relative = path.lexically_relative(folder);
    return !relative.empty() && *relative.begin() != "..";
}

/// The folder that a session owns.
fs::path folder_of_session(const fs::path& session_file)
{
    const fs::path folder = fs::absolute(session_file).lexically_normal().parent_path();
    const bool is_project = folder / session_file.filename() == folder.parent_path() / PROJECT_SESSION;
    return fs::weakly_canonical(is_project ? folder.parent_path() : folder);
}

/// Whether the command line sets a key of the section "annotation", alone or with the whole section.
bool is_set(const std::vector<std::string>& settings, const std::string& key)
{
    return std::ranges::any_of(settings, [&](const std::string& setting) {
        return setting.starts_with("annotation." + key + "=") || setting.starts_with("annotation=");
    });
}

}  // namespace

std::string files_outside(const Session& session, const fs::path& session_file,
                          const std::vector<std::string>& settings)
{
    const fs::path folder = folder_of_session(session_file);
    std::string words;
    const auto note = [&](const std::string& what, const fs::path& path) {
        if (path.empty()) return;
        const fs::path target = link_target(path);
        if (!is_within(target, folder)) words += (words.empty() ? "" : ", ") + what + ", which is " + target.string();
    };
    // Unnamed files lie next to the mask.
    const bool is_mask_set = is_set(settings, "mask");
    const auto goes_with_mask = [&](const fs::path& path) {
        return is_mask_set && path.parent_path() == session.mask_path.parent_path() &&
               path.stem() == session.mask_path.stem();
    };
    if (!is_mask_set) note("annotation.mask", session.mask_path);
    if (!is_set(settings, "trace") && !goes_with_mask(session.trace_path)) note("annotation.trace", session.trace_path);
    if (!is_set(settings, "density") && !goes_with_mask(session.density_path))
        note("annotation.density", session.density_path);
    note("the journal", session.journal_path);
    note("the session's file", session_file);
    return words;
}

}  // namespace shvr
