#include "tools/cli/movie/movie_views.h"

#include <algorithm>
#include <set>

#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/text.h"
#include "engine/session/label_looks.h"
#include "engine/session/looks/key_look.h"
#include "engine/session/picture_session.h"
#include "engine/session/session_patch.h"
#include "engine/session/transfer_presets.h"

namespace shvr::cli {

namespace {

namespace fs = std::filesystem;

constexpr int64_t MAX_VIEW_BYTES = int64_t{16} << 20;
constexpr const char* CAMERA = "camera";
/// The sections of a session that a movie mixes.
const std::set<std::string> SECTIONS{"transfer_function", "groups", "unpainted", "light", "blend", "cut"};

std::vector<std::string> split(const std::string& keys)
{
    std::vector<std::string> parts(1);
    int depth = 0;
    bool is_quoted = false, is_escaped = false;
    for (const char c : keys) {
        if (is_quoted) {
            is_quoted = is_escaped || c != '"';
            is_escaped = !is_escaped && c == '\\';
        } else if (c == '"') {
            is_quoted = depth > 0;  // only JSON has quoted texts; a name may contain a quote
        } else if (c == '{' || c == '[') {
            ++depth;
        } else if (c == '}' || c == ']') {
            --depth;
        } else if (c == ',' && depth <= 0) {
            parts.emplace_back();
            continue;
        }
        parts.back() += c;
    }
    for (std::string& part : parts) part = std::string(trimmed(part));
    return parts;
}

/// Reads a camera, or settings.
void read_object(const std::string& text, const std::string& origin, StatedView& view)
{
    const JsonDocument document(text, origin, {.depth = 16, .expected = "a camera or settings of a session"});
    const std::vector<std::string> names = document.root().names();
    const auto is_section = [](const std::string& name) { return name == CAMERA || SECTIONS.contains(name); };
    if (std::ranges::none_of(names, is_section)) {
        view.camera = document.root().dump();
        return;
    }
    Json patch = Json::object();
    for (const std::string& name : names) {
        const JsonNode value = document.root()[name];
        if (name == CAMERA)
            view.camera = value.is_object() ? value.dump() : value.text("the name of a camera, or a camera");
        else if (SECTIONS.contains(name))
            patch[name] = Json::parse(value.dump());
        else
            fail(origin, ": key ", printable(name),
                 " is not what views of a movie can differ in; expected camera, transfer_function, groups, unpainted, "
                 "light, blend or cut; --set sets the others for all views");
    }
    // A preset replaces the session's points.
    const auto function = patch.find("transfer_function");
    if (function != patch.end() && function->contains("preset") && !function->contains("points"))
        (*function)["points"] = nullptr;
    if (!patch.empty()) view.patch = patch.dump();
}

/// Reads a session from its text. `file`: the file that contains it.
void read_whole(const std::string& text, const fs::path& file, StatedView& view)
{
    view.session = parse_session(text, fs::absolute(file).lexically_normal().parent_path(), file.string());
    const JsonDocument document(text, file.string(), {});
    view.has_transfer_function = document.root()["transfer_function"].exists();
}

StatedView stated_view(const std::string& text)
{
    StatedView view{.name = text};
    const std::string extension =
        text.starts_with('{') ? std::string() : lower_case(fs::path(text).extension().string());
    if (text.empty())
        throw UsageError("--keys names an empty view; expected views separated by commas, as in front,left");
    if (text.starts_with('{')) {
        read_object(text, "--keys", view);
    } else if (extension == ".png" || extension == ".tif" || extension == ".tiff") {
        const std::optional<PictureSession> picture = session_in_picture(text);
        if (!picture)
            fail(text, fs::exists(text) ? ": is no picture that holds its session" : ": does not exist",
                 "; expected a picture that holds its session");
        read_whole(picture->text, text, view);
    } else if (extension == ".json") {
        const std::string content = read_text(text, MAX_VIEW_BYTES);
        const JsonDocument document(content, text, {});
        if (document.root()["shvr_session"].exists())
            read_whole(content, text, view);
        else
            read_object(content, text, view);
    } else {
        view.camera = text;
    }
    return view;
}

void expect_volume(const StatedView& view, const Session& session)
{
    const auto path = [](const Session& of) { return of.volume_path.lexically_normal(); };
    const bool is_same = view.session->procedural == session.procedural && path(*view.session) == path(session);
    if (!is_same)
        fail(view.name, ": is a view of ",
             view.session->procedural ? "a computed volume" : view.session->volume_path.string(),
             "; expected a view of ", session.procedural ? "the computed volume" : session.volume_path.string(),
             ", which the movie shows");
}

TransferFunction function_of(Session& session, bool is_stated, const VolumeStatistics& statistics)
{
    if (!is_stated) return automatic_transfer_function(statistics);
    if (session.transfer_preset.empty()) return session.transfer_function;
    return transfer_function_of(transfer_preset_named(session.transfer_preset), statistics);
}

}  // namespace

std::vector<StatedView> stated_views(const std::string& keys)
{
    std::vector<StatedView> views;
    if (keys.empty()) return views;
    for (const std::string& text : split(keys)) views.push_back(stated_view(text));
    return views;
}

void check_view(const StatedView& view, const Session& session, const VolumeInfo& volume)
{
    if (view.session) return expect_volume(view, session);
    try {
        check_camera(view.camera, session, volume);
    } catch (const Error& error) {
        fail("--keys: view ", in_quotes(view.name), ": ", error.what(),
             "; a view may also be settings in braces, a session (.json) or a picture that holds one (.png)");
    }
}

MovieView view_of(const StatedView& view, const Opened& opened, const std::string& camera)
{
    const VolumeInfo& volume = opened.source->info();
    MovieView result{.name = view.name, .session = opened.session, .camera = {}};
    Session& session = result.session;
    if (view.session) {
        Session stated = *view.session;
        static_cast<void>(take_label_looks(stated.mask_path, stated.groups));
        session.transfer_function = function_of(stated, view.has_transfer_function, opened.statistics);
        session.groups = stated.groups;
        session.unpainted = stated.unpainted;
        session.light = stated.light;
        session.blend = stated.blend;
        session.cut = stated.cut;
        result.camera = camera_named(stated, stated.camera_name, volume);
        return result;
    }
    session = with_key_look(std::move(session), view.camera);
    if (!view.patch.empty()) {
        Session stated = patched(session, view.patch);
        const Json patch = Json::parse(view.patch);
        if (patch.contains("transfer_function"))
            session.transfer_function = function_of(stated, true, opened.statistics);
        if (patch.contains("groups")) session.groups = stated.groups;
        if (patch.contains("unpainted")) session.unpainted = stated.unpainted;
        if (patch.contains("light")) session.light = stated.light;
        if (patch.contains("blend")) session.blend = stated.blend;
        if (patch.contains("cut")) session.cut = stated.cut;
    }
    result.camera = camera_named(session, view.camera.empty() ? camera : view.camera, volume);
    return result;
}

}  // namespace shvr::cli
