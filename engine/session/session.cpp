#include "engine/session/session.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/formats/restated.h"
#include "engine/formats/zarr/project.h"
#include "engine/look/session_color.h"
#include "engine/projects/import_files.h"
#include "engine/remote/address.h"
#include "engine/session/first_look.h"
#include "engine/session/label_looks.h"
#include "engine/session/picture_session.h"
#include "engine/session/session_keys.h"
#include "engine/session/transfer_presets.h"
#include "engine/volume/content_hash.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

constexpr int64_t MAX_SESSION_BYTES = int64_t{16} << 20;

bool is_session_file(const fs::path& path)
{
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
    return extension == ".json";
}

/// The smallest session for a volume file.
JsonDocument document_for_volume(const fs::path& path)
{
    JsonDocument document = session_document(R"({"shvr_session": 1, "volume": {}})", path.string());
    // Assigned as a path, not parsed from JSON text, since a path need not be valid UTF-8.
    document.value()["volume"]["path"] = whole_path(take_query(path.string())).string();
    return document;
}

/// Recreates the missing session file of a project as an import would make it: with the project's annotation, if there
/// is any, and the default look.
JsonDocument document_for_project(const fs::path& session_file, std::vector<std::string>& losses)
{
    losses.push_back(sentence(session_file.string(),
                              ": is missing; expected the project's session with its looks; a new project's is taken, "
                              "which finds volume and annotation, and saving in the window writes it"));
    JsonDocument document = session_document(import_session(), session_file.string());
    // Also finds the files of projects of earlier versions, which were never converted.
    const fs::path folder = session_file.parent_path();
    std::error_code ignored;
    if (fs::exists(folder / "paint.mask", ignored) && !fs::exists(folder.parent_path() / "labels" / "paint", ignored))
        document.value()["annotation"] = {{"mask", "paint.mask"}};
    return document;
}

}  // namespace

namespace {

/// Multiplies the opacities of the points. Since the function is linear between points, this multiplies all of it.
TransferFunction multiplied(const TransferFunction& function, double factor)
{
    std::vector<ControlPoint> points(function.points().begin(), function.points().end());
    for (ControlPoint& point : points) point.opacity *= factor;
    return TransferFunction(std::move(points));
}

}  // namespace

Groups Session::shown_groups() const
{
    Groups shown = groups;
    for (int group = 1; view.solo && group < 256; ++group)
        if (*view.solo == 0 || !is_within(groups, uint8_t(group), *view.solo)) shown[uint8_t(group)].visible = false;
    return shown;
}

Look Session::look() const
{
    Look look{transfer_function, shown_groups(), light, blend, cut, render, view.slices, view.meshes};
    const bool shows_unpainted = unpainted.visible && view.solo.value_or(0) == 0;
    const double factor = shows_unpainted ? unpainted.opacity : 0.0;
    if (factor != 1.0) look.transfer_function = multiplied(transfer_function, factor);
    // Hides the volume by a cut that leaves nothing. Slices, which ignore cuts, and surfaces stay visible.
    if (!view.volume) look.cut.upper = look.cut.lower;
    return look;
}

fs::path session_file_of(const fs::path& path)
{
    if (path.empty())
        fail("the file name is empty; expected a session file (.json), a project folder or a volume file");
    std::error_code ignored;  // inaccessible files are treated as absent
    if (!fs::exists(path, ignored)) {
        if (leads_into_archive(path)) return {};
        if (is_address(path.string())) return {};  // a volume elsewhere; sessions are local
        fail(path.string(), ": does not exist; expected a session file (.json), a project folder or a volume file");
    }
    if (!fs::is_directory(path, ignored)) return is_session_file(path) ? path : fs::path();
    const fs::path file = path / PROJECT_SESSION;
    const bool is_project = fs::is_regular_file(file, ignored) || fs::exists(path / PROJECT_RECORD, ignored);
    return is_project ? file : fs::path();  // some volumes are folders
}

std::unique_ptr<VolumeSource> open_source(const Session& session)
{
    if (session.procedural) return open_procedural(*session.procedural);
    if (session.raw_layout)
        return with_nodata(open_raw(session.volume_path, *session.raw_layout), session.open_options.nodata);
    return open_volume(session.volume_path, session.open_options);
}

namespace {

void expect_volume_of_picture(const fs::path& picture, const Session& session)
{
    std::error_code ignored;
    if (session.procedural || fs::exists(session.volume_path, ignored) || leads_into_archive(session.volume_path) ||
        leads_to_network(session.volume_path))
        return;
    fail(picture.string(), ": is a picture of ", session.volume_path.string(),
         ", which is not there; expected it where it was, as seen from the picture: put both back, or say where it is "
         "with --set volume.path=...");
}

/// Reads each setting with those before it, to report errors even in settings that later ones replace.
void check_replaced_settings(const JsonDocument& document, const std::vector<std::string>& settings,
                             const fs::path& folder)
{
    const auto key_of = [](const std::string& setting) { return setting.substr(0, setting.find('=')); };
    for (size_t i = 0; i + 1 < settings.size(); ++i) {
        const std::string key = key_of(settings[i]);
        const bool is_replaced = std::any_of(settings.begin() + ptrdiff_t(i) + 1, settings.end(), [&](const auto& by) {
            const std::string later = key_of(by);
            return key == later || key.starts_with(later + ".") ||
                   (later == "render.quality" && key.starts_with("render."));
        });
        if (!is_replaced) continue;
        JsonDocument alone = session_document("{}", document.origin());
        alone.value() = document.value();
        apply_settings(alone, {settings.begin(), settings.begin() + ptrdiff_t(i) + 1});
        static_cast<void>(read_session(alone, folder));
    }
}

std::pair<JsonDocument, UnmeasuredSession> open_unmeasured(const fs::path& path,
                                                           const std::vector<std::string>& settings)
{
    const fs::path session_file = session_file_of(path);
    const fs::path file = session_file.empty() ? path : session_file;
    UnmeasuredSession opened;
    std::error_code ignored;
    const std::optional<PictureSession> picture =
        session_file.empty() ? session_in_picture(path) : std::optional<PictureSession>();
    JsonDocument document = picture                ? session_document(picture->text, path.string())
                            : session_file.empty() ? document_for_volume(path)
                            : fs::exists(fs::symlink_status(file, ignored))
                                ? session_document(read_text(file, MAX_SESSION_BYTES), file.string())
                                : document_for_project(file, opened.losses);
    check_replaced_settings(document, settings, fs::absolute(file).parent_path());
    opened.removed = removed_keys_in(document, document.origin());
    apply_settings(document, settings);
    if (opened.removed.empty()) opened.removed = removed_keys_in(document, "--set");
    Session& session = opened.session;
    session = read_session(document, fs::absolute(file).parent_path());
    if (!session_file.empty()) session.journal_path = journal_beside(session_file);
    if (picture) expect_volume_of_picture(path, session);
    if (picture && !picture->project.empty()) {
        opened.pictured = picture->project;
        session.journal_path = journal_beside(picture->project);
    }
    opened.source = open_source(session);
    // Opening an address has asked for that already, and warns of it.
    if (session_file.empty() && !picture && !leads_to_network(path)) {
        if (std::string sentence = archived_project(path); !sentence.empty()) opened.losses.push_back(sentence);
    }
    // For a project with a valid record, the volume's hash is known without reading voxels.
    const fs::path record = session.volume_path / PROJECT_RECORD;
    if (!session.procedural && opened.source->statistics() && fs::exists(record, ignored))
        session.volume_hash = read_project_record(record).content_hash;
    return {std::move(document), std::move(opened)};
}

}  // namespace

UnmeasuredSession open_unmeasured_session(const fs::path& path, const std::vector<std::string>& settings)
{
    return open_unmeasured(path, settings).second;
}

namespace {

/// Checks that intensities fit float32, the type of transfer function points on the GPU and in files.
void expect_range_of_points(const Session& session, const VolumeStatistics& statistics)
{
    constexpr double LARGEST = std::numeric_limits<float>::max();
    const ValueRange range = statistics.range();
    if (std::abs(range.lower) <= LARGEST && std::abs(range.upper) <= LARGEST) return;
    fail(session.volume_path.string(), ": its intensities go from ", range.lower, " to ", range.upper,
         "; expected the range of float32, up to ", LARGEST,
         ", in which a transfer function can be made: scale them down, or give one with --tf");
}

/// Measures a volume by its finest level that is small.
VolumeStatistics measure_at_first_look(const VolumeSource& source, const MeasureOptions& options)
{
    if (source.statistics()) return measure(source, options);
    for (int level = 0; level < source.levels(); ++level) {
        const glm::dvec3 size(size_of_level(source.info().size, level));
        if (size.x * size.y * size.z > double(MAX_VOXELS_OF_FIRST_LOOK)) continue;
        if (level == 0) break;
        VolumeStatistics statistics = measure_level(source, level, options);
        statistics.measured_level = level;
        return statistics;
    }
    return measure(source, options);
}

using Measure = VolumeStatistics (*)(const VolumeSource& source, const MeasureOptions& options);

OpenedSession open_measured(const fs::path& path, const std::vector<std::string>& settings,
                            const OpeningOptions& options, Measure measure_remote)
{
    auto [document, unmeasured] = open_unmeasured(path, settings);
    if (options.before_reading) options.before_reading(unmeasured.session, *unmeasured.source);
    OpenedSession opened{std::move(unmeasured.session),
                         std::move(unmeasured.source),
                         {},
                         {},
                         unmeasured.losses,
                         unmeasured.pictured,
                         unmeasured.removed};
    const HashedSource hashed(*opened.source);
    opened.statistics = leads_to_network(opened.session.volume_path) ? measure_remote(hashed, options.measure)
                                                                     : measure(hashed, options.measure);
    if (opened.session.volume_hash.empty()) opened.session.volume_hash = hashed.hash();
    opened.warnings = warnings_of(opened.statistics);
    for (std::string& warning : take_label_looks(opened.session.mask_path, opened.session.groups))
        opened.warnings.push_back(std::move(warning));
    const bool is_stated = document.root()["transfer_function"].exists() && opened.session.transfer_preset.empty();
    if (!is_stated) expect_range_of_points(opened.session, opened.statistics);
    if (std::string& preset = opened.session.transfer_preset; !preset.empty())
        opened.session.transfer_function =
            transfer_function_of(transfer_preset_named(std::exchange(preset, {})), opened.statistics);
    if (!document.root()["transfer_function"].exists()) {
        TransferFunction& function = opened.session.transfer_function;
        function = automatic_transfer_function(opened.statistics);
        opened.warnings.push_back(sentence("no transfer function given; a ramp from ", function.lower(), " to ",
                                           function.upper(), " was made from the histogram"));
    }
    return opened;
}

}  // namespace

OpenedSession open_session(const fs::path& path, const std::vector<std::string>& settings,
                           const OpeningOptions& options)
{
    return open_measured(path, settings, options, measure);
}

OpenedSession open_session_for_first_look(const fs::path& path, const std::vector<std::string>& settings,
                                          const OpeningOptions& options)
{
    return open_measured(path, settings, options, measure_at_first_look);
}

fs::path journal_beside(const fs::path& session_file)
{
    return fs::absolute(session_file).replace_extension(".journal");
}

Camera camera_named(const Session& session, const std::string& name_or_json, const VolumeInfo& volume)
{
    const bool is_chosen = !name_or_json.empty() || session.cameras.contains("front");
    const std::string name = !is_chosen ? side_of_largest_face(volume) : name_or_json.empty() ? "front" : name_or_json;
    const std::string origin = "camera";
    if (is_camera_object(name)) {
        const JsonDocument document = session_document(name, origin);
        return camera_of(read_camera(document.root()), volume);
    }
    if (const auto found = session.cameras.find(name); found != session.cameras.end())
        return camera_of(found->second, volume);
    std::string known;
    for (const auto& [camera, spec] : session.cameras) known += camera + ", ";
    for (const std::string& side : camera_sides()) {
        if (side == name) return camera_looking(side, volume);
        if (!session.cameras.contains(side)) known += side + ", ";
    }
    fail("camera is \"", name, "\"; expected one of ", known, "or a JSON object");
}

std::vector<std::string> camera_names(const Session& session)
{
    std::vector<std::string> names;
    for (const auto& [name, camera] : session.cameras) names.push_back(name);
    for (const std::string& side : camera_sides())
        if (!session.cameras.contains(side)) names.push_back(side);
    return names;
}

fs::path session_folder(const Session& session)
{
    const fs::path& beside = session.journal_path.empty() ? session.volume_path : session.journal_path;
    return fs::absolute(beside).lexically_normal().parent_path();
}

fs::path mesh_path(const Session& session, const MeshLook& mesh)
{
    return (session_folder(session) / mesh.file).lexically_normal();
}

}  // namespace shvr
