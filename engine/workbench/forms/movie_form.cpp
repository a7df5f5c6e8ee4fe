#include "engine/workbench/forms/movie_form.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/text.h"
#include "engine/movie/frame_folder.h"
#include "engine/movie/movie.h"
#include "engine/movie/movie_encoder.h"
#include "engine/session/looks/key_look.h"
#include "engine/tasks/task_output.h"
#include "engine/workbench/forms/form_names.h"

namespace shvr::ui {

namespace {

const char* ending_of(MovieKind kind)
{
    return kind == MovieKind::webm ? ".webm" : kind == MovieKind::mp4 ? ".mp4" : "";
}

bool has_length(const MovieForm& form)
{
    const double frames = std::round(form.seconds * form.more.frames_per_second);
    return frames >= 1.0 && frames <= double(MAX_MOVIE_FRAMES);
}

bool has_size(const MovieForm& form)
{
    const glm::ivec2& size = form.more.pixels;
    const bool is_file = form.kind != MovieKind::frames;
    return size.x >= 1 && size.y >= 1 && !(is_file && (size.x % 2 != 0 || size.y % 2 != 0));
}

}  // namespace

MovieForm suggested_movie(const Model& model, const MovieForm& last)
{
    MovieForm form = last;
    form.path = form.suggested = base_of(model).string() + "-movie";
    form.keeps_shown = false;
    if (form.suggested != last.suggested) form.offered.clear();  // another scan's
    choose_kind(form, last.kind);
    const MovieForm fresh;  // for numbers that were refused when the dialog was closed
    if (!has_length(form)) form.seconds = fresh.seconds, form.more.frames_per_second = fresh.more.frames_per_second;
    if (!has_size(form)) form.more.pixels = fresh.more.pixels;
    form.elements = suggested_elements(model, last.elements);
    const std::vector<std::string> names = camera_names(model.session);
    std::erase_if(form.views, [&](const std::string& view) { return std::ranges::find(names, view) == names.end(); });
    offer_kept_looks(form, model.session);
    return form;
}

void offer_kept_looks(MovieForm& form, const Session& session)
{
    const auto has = [](const std::vector<std::string>& names, const std::string& name) {
        return std::ranges::find(names, name) != names.end();
    };
    std::erase_if(form.offered, [&](const std::string& view) { return !session.key_looks.contains(view); });
    std::vector<std::string> added;
    for (const auto& [view, look] : session.key_looks)
        if (session.cameras.contains(view) && !has(form.offered, view)) added.push_back(view);
    // "view 10" comes after "view 9".
    std::ranges::sort(added, {}, [](const std::string& view) { return std::pair(view.size(), view); });
    for (const std::string& view : added) {
        form.offered.push_back(view);
        if (!has(form.views, view)) form.views.push_back(view);
        form.goes_through_views = true;
    }
}

void move_up(MovieForm& form, size_t view)
{
    if (view > 0 && view < form.views.size()) std::swap(form.views[view - 1], form.views[view]);
}

std::string change_between(const Session& session, const std::string& from, const std::string& to)
{
    const KeyLook a = key_look_of(session, from), b = key_look_of(session, to);
    std::string words;
    const auto add = [&](bool is_other, const char* part) {
        if (is_other) words += (words.empty() ? "changes " : ", ") + std::string(part);
    };
    add(a.cut != b.cut, "cut");
    add(a.transfer_function != b.transfer_function, "transfer function");
    add(a.groups != b.groups, "groups");
    add(a.unpainted != b.unpainted, "unpainted voxels");
    add(a.light != b.light, "light");
    add(a.blend != b.blend, "distance blending");
    return words;
}

void choose_kind(MovieForm& form, MovieKind kind)
{
    form.kind = kind;
    std::filesystem::path path = trimmed(form.path);
    if (is_movie_file(path)) path.replace_extension();
    form.path = path.string() + ending_of(kind);
}

std::string why_not(const MovieForm& form)
{
    if (trimmed(form.path).empty()) return "no name is given; expected that of a file, or of a folder for frames";
    if (form.goes_through_views && form.views.size() < 2)
        return "no way is chosen; expected at least two views to go through";
    if (!has_length(form))
        return sentence("the movie has ", form.seconds, " s at ", form.more.frames_per_second,
                        " frames per second; expected 1 to ", MAX_MOVIE_FRAMES, " frames");
    if (!has_size(form))
        return sentence("the size is ", form.more.pixels.x, " x ", form.more.pixels.y, " pixels; expected ",
                        form.kind == MovieKind::frames ? "numbers from 1" : "even numbers from 2");
    return {};
}

MovieTask task_of(const MovieForm& form, const std::filesystem::path& folder)
{
    MovieTask task = form.more;
    task.path = placed_new(form.path, folder);
    if (form.kind != MovieKind::frames && !is_movie_file(task.path)) task.path += ending_of(form.kind);
    task.elements = elements_of(form.elements);
    task.views.clear();
    if (form.goes_through_views)
        for (const std::string& view : form.views) task.views += (task.views.empty() ? "" : "\n") + view;
    task.turntable_degrees = form.goes_through_views ? 0.0 : form.degrees;
    task.frames = int(std::clamp(std::round(form.seconds * task.frames_per_second), 1.0, double(MAX_MOVIE_FRAMES)));
    return task;
}

void check(const MovieTask& task)
{
    if (!is_movie_file(task.path)) return check_frame_folder(task.path, task.frames);
    check_movie_file(task.path, task.pixels);
    check_output_place(task.path);
}

std::vector<std::filesystem::path> replaced_files(const MovieTask& task)
{
    std::error_code ignored;
    const bool is_file = is_movie_file(task.path);
    const std::filesystem::path first = is_file ? task.path : task.path / frame_file(0, task.frames);
    if (!std::filesystem::exists(first, ignored)) return {};
    return {first};
}

}  // namespace shvr::ui
