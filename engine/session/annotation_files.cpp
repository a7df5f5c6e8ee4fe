#include "engine/session/annotation_files.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "engine/annotation/files/mask_import.h"
#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/zarr/project.h"
#include "engine/projects/import_volume.h"

namespace shvr {

namespace fs = std::filesystem;

namespace {

bool is_there(const fs::path& path)
{
    std::error_code ignored;
    return fs::exists(fs::symlink_status(path, ignored));
}

bool ends_with(const fs::path& path, const char* extension)
{
    return lower_case(path.extension().string()) == extension;
}

/// Returns "scan" for scan.labels.zarr, scan.zarr and scan.mask.
fs::path stem_of(const fs::path& mask)
{
    fs::path stem = mask.has_filename() ? mask : mask.parent_path();
    if (!ends_with(stem, ".zarr")) return stem.replace_extension();
    stem.replace_extension();
    return ends_with(stem, ".labels") ? stem.replace_extension() : stem;
}

fs::path with_suffix(fs::path stem, const char* suffix)
{
    return stem += suffix;
}

/// Returns a file next to a mask, or in IMAGE/shvr for a mask in IMAGE/labels, which may only contain label images.
fs::path beside(const fs::path& mask, const char* suffix)
{
    const fs::path stem = stem_of(mask), folder = stem.parent_path();
    const bool is_among_labels = folder.filename() == "labels" && !mask.has_extension();
    return with_suffix(is_among_labels ? folder.parent_path() / "shvr" / stem.filename() : stem, suffix);
}

/// Returns the first of "paint", "paint-2" and so on for which no file with this suffix exists.
fs::path free_name(const fs::path& stem, const char* suffix)
{
    fs::path name = with_suffix(stem, suffix);
    for (int number = 2; is_there(name); ++number) name = with_suffix(stem, sentence("-", number, suffix).c_str());
    return name;
}

bool is_within(const fs::path& path, const fs::path& folder)
{
    const fs::path relative = path.lexically_relative(folder);
    return !relative.empty() && *relative.begin() != "..";
}

/// Returns the folder of a session: the project's folder, or else the session file's. Does not resolve links.
fs::path folder_of_session(const fs::path& session_file)
{
    const fs::path folder = fs::absolute(session_file).lexically_normal().parent_path();
    const bool is_project = folder / session_file.filename() == folder.parent_path() / PROJECT_SESSION;
    return is_project ? folder.parent_path() : folder;
}

/// Returns the first symbolic link among `path` and its parents inside the folder; empty if there is none.
fs::path link_on_way(const fs::path& path, const fs::path& folder)
{
    const fs::path whole = fs::absolute(path).lexically_normal();
    if (!is_within(whole, folder)) return {};
    fs::path way = folder;
    for (const fs::path& piece : whole.lexically_relative(folder)) {
        way /= piece;
        std::error_code ignored;
        if (fs::is_symlink(way, ignored)) return way;
    }
    return {};
}

/// Whether the command line sets this key of the section "annotation", or the whole section.
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
    const fs::path named_folder = folder_of_session(session_file), folder = fs::weakly_canonical(named_folder);
    std::string words;
    const auto note = [&](const std::string& what, const fs::path& path) {
        if (path.empty()) return;
        const fs::path target = link_target(path);
        if (is_within(target, folder)) return;
        const fs::path link = link_on_way(path, named_folder);
        words += (words.empty() ? "" : ", ") + what + ", which is " + target.string();
        if (!link.empty()) words += ", since " + link.string() + " is a link";
    };
    // With `mask` set by the user, files whose names derive from the mask's are the user's choice, too.
    const bool is_mask_set = is_set(settings, "mask");
    const auto goes_with_mask = [&](const fs::path& path) {
        return is_mask_set && (path == trace_beside(session.mask_path) || path == offsets_beside(session.mask_path));
    };
    if (!is_mask_set) note("annotation.mask", saved_mask_path(session.mask_path));
    if (!is_set(settings, "trace") && !goes_with_mask(session.trace_path)) note("annotation.trace", session.trace_path);
    if (!is_set(settings, "density") && !goes_with_mask(session.density_path))
        note("annotation.density", session.density_path);
    note("the journal", session.journal_path);
    note("the session's file", session_file);
    return words;
}

fs::path mask_beside(const fs::path& session_file)
{
    const fs::path stem = fs::path(session_file).replace_extension();
    const fs::path sparse = with_suffix(stem, ".labels.zarr"), dense = with_suffix(stem, ".mask");
    return is_there(dense) && !is_there(sparse) ? dense : sparse;
}

fs::path offsets_beside(const fs::path& mask)
{
    const fs::path dense = fs::path(mask).replace_extension(".offset");
    return !is_label_image(mask) || is_there(dense) ? dense : beside(mask, ".offsets.zarr");
}

fs::path trace_beside(const fs::path& mask)
{
    const fs::path plain = fs::path(mask).replace_extension(".graphml");
    return !is_label_image(mask) || is_there(plain) ? plain : beside(mask, ".graphml");
}

void name_annotation(Session& session, const fs::path& session_file)
{
    const fs::path stem = fs::path(session_file).replace_extension();
    session.mask_path = with_suffix(stem, ".labels.zarr");
    session.trace_path = with_suffix(stem, ".graphml");
    session.density_path = with_suffix(stem, ".offsets.zarr");
    session.journal_path = journal_beside(session_file);
}

std::optional<AnnotationNames> sparse_names(const Session& session, const fs::path& session_file)
{
    const fs::path file = fs::absolute(session_file).lexically_normal();
    const fs::path project = file.parent_path().parent_path();
    if (file != project / PROJECT_SESSION) return std::nullopt;
    const auto is_dense = [&](const fs::path& path, const char* extension) {
        return ends_with(path, extension) && is_within(fs::absolute(path).lexically_normal(), project);
    };
    AnnotationNames names{session.mask_path, session.trace_path, session.density_path};
    if (is_dense(names.mask, ".mask")) {
        const bool is_image = is_there(project / ".zattrs") || is_there(project / "zarr.json");
        const fs::path stem = stem_of(names.mask);
        names.mask = is_image ? free_name(project / "labels" / stem.filename(), "") : free_name(stem, ".zarr");
    }
    if (is_dense(names.density, ".offset")) names.density = free_name(stem_of(names.density), ".offsets.zarr");
    if (names.mask == session.mask_path && names.density == session.density_path) return std::nullopt;
    return names;
}

std::string with_names(const std::string& text, const AnnotationNames& names, const fs::path& session_file)
{
    const fs::path folder = fs::absolute(session_file).parent_path();
    auto document = nlohmann::ordered_json::parse(text);
    nlohmann::ordered_json& annotation = document["annotation"];
    const std::pair<const char*, const fs::path&> keys[] = {
        {"mask", names.mask}, {"trace", names.trace}, {"density", names.density}};
    for (const auto& [key, path] : keys)
        if (!path.empty()) annotation[key] = path.lexically_proximate(folder).generic_string();
    return document.dump(4) + "\n";
}

}  // namespace shvr
