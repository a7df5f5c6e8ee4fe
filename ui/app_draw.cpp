// Draws a frame of the window: the panels' model, the lines over the panes, and the report of a run.

#include <algorithm>
#include <fstream>
#include <functional>
#include <utility>

#include <imgui/imgui.h>

#include "engine/base/image.h"
#include "engine/workbench/sight/marks.h"
#include "ui/app.h"
#include "ui/screen_text.h"

namespace shvr::ui {

namespace {

ImU32 color_of(const glm::dvec3& linear, float alpha)
{
    const auto encoded = [](double value) { return float(srgb_encode(std::clamp(value, 0.0, 1.0))); };
    return ImGui::GetColorU32(ImVec4(encoded(linear.r), encoded(linear.g), encoded(linear.b), alpha));
}

/// Draws a text with a rim, so that it can be read on any picture.
void draw_rimmed(ImDrawList& list, const ImVec2& at, const glm::dvec3& ink, const char* text)
{
    const auto reach = int(rim_width(ImGui::GetFontSize()));
    const ImU32 rim = color_of(rim_color(ink), 1.0f);
    for (int y = -reach; y <= reach; y += reach)
        for (int x = -reach; x <= reach; x += reach)
            if (x != 0 || y != 0) list.AddText({at.x + float(x), at.y + float(y)}, rim, text);
    list.AddText(at, color_of(ink, 1.0f), text);
}

/// Draws marks and their texts in a pane.
template <class OnScreen>
void draw_over(Marks marks, const glm::uvec2& pane, const OnScreen& on_screen, ImDrawList& list,
               LabelMemory* memory = nullptr)
{
    std::vector<glm::dvec2> sizes;
    for (const Label& label : marks.labels) {
        const ImVec2 size = ImGui::CalcTextSize(label.text.c_str());
        sizes.emplace_back(size.x, size.y);
    }
    spread_labels(marks, sizes, LABEL_MARGIN * double(ImGui::GetFontSize() / FONT_UNITS), pane, memory);
    for (const Stroke& stroke : marks.strokes)
        list.AddLine(on_screen(stroke.from), on_screen(stroke.to), color_of(stroke.color, 1.0f), float(stroke.width));
    for (const Label& label : marks.labels) {
        const ImVec2 size = ImGui::CalcTextSize(label.text.c_str()), at = on_screen(label.at);
        const ImVec2 begin{at.x - float(label.anchor.x) * size.x, at.y - float(label.anchor.y) * size.y};
        draw_rimmed(list, begin, label.color, label.text.c_str());
    }
}

}  // namespace

/// Returns false if the window cannot show the frame now.
bool App::draw_ui()
{
    const double begun = window_.now_s();
    const bool moves = something_moves(), is_open = bench_->is_open();
    // On a software device, presentation would wait for all earlier submissions. Waiting here instead makes that time
    // known, so that it can be subtracted from the frame's.
    if (is_open && renderer_->device().traits().is_cpu) bench_->screen().wait();
    const double waited_s = window_.now_s() - begun;
    follow_appearance();  // renewing fonts waits for the device, so it must precede the acquisition of an image
    if (!window_.is_ready()) return false;
    std::vector<View::Layer> layers;
    Layout layout{.begin = glm::uvec2(0), .end = window_.pixels()};
    window_.begin_ui();
    follow_focus();
    layout = draw_panels(model(), window_.pixels(), actions_);
    if (is_open) {
        const Document& document = bench_->document();
        draw_strokes();
        layers = document.screen.layers();
        drawn_revision_ = document.screen.revision();
        drew_complete_ = document.screen.complete();
        drawn_probe_voxel_ = document.probe_voxel();
    }
    viewport_.set_layout(layout);
    // Submits more work while presentation waits; not on a software device, where more work would prolong the wait.
    std::function<void(double)> go_on;
    if (is_open && !renderer_->device().traits().is_cpu)
        go_on = [this](double wait_ms) { bench_->screen().submit_ahead(wait_ms); };
    if (!window_.present(layers, viewport_.layout().begin, go_on)) return false;
    undrawable_since_s_.reset();
    if (!options_.screen_texts.empty()) write_screen_texts();
    // A window that appears without an event, such as a finished job's dialog, needs frames to determine its layout.
    const int windows = ImGui::GetIO().MetricsRenderWindows;
    if (std::exchange(drawn_windows_, windows) != windows) keep_drawing(0.0);
    if (is_open && !layers.empty())
        window_.set_title(bench_->document().volume().name + " - SHVR" +
                          (bench_->document().only_looks() ? " (read only)" : ""));
    report_.presented({.number = window_.frames_presented(),
                       .begun_s = begun,
                       .waited_s = waited_s,
                       .moves = moves,
                       .shows_picture = !layers.empty(),
                       .shows_sharp_picture = !layers.empty() && bench_->document().screen.complete()});
    // On a software device, a presented frame is done. A later report would add the wait for events to its duration.
    report_.done(window_.frames_done(), window_.now_s());
    return true;
}

/// Replaces the file atomically, since other processes read it while frames are drawn.
void App::write_screen_texts() const
{
    const ImDrawData* const drawn = ImGui::GetDrawData();
    if (!drawn) return;
    const FrameState frame{.number = window_.frames_presented(),
                           .is_sharp = bench_->is_open() && bench_->document().screen.complete(),
                           .is_kept = bench_->is_open() && !bench_->has_view_to_keep()};
    const std::filesystem::path written = options_.screen_texts.string() + ".new";
    std::ofstream(written) << json_of(screen_texts(*drawn, *ImGui::GetIO().Fonts), frame);
    std::filesystem::rename(written, options_.screen_texts);
}

/// Shows a notice until the first picture of the volume exists.
void App::say_that_it_is_coming() const
{
    const glm::dvec2 middle = 0.5 * glm::dvec2(viewport_.layout().begin + viewport_.layout().end);
    Marks words;
    words.labels.push_back({.at = middle,
                            .anchor = glm::dvec2(0.5),
                            .text = "The first picture is being made ...",
                            .color = glm::dvec3(1.0)});
    draw_over(
        words, window_.pixels(), [](const glm::dvec2& at) { return ImVec2(float(at.x), float(at.y)); },
        *ImGui::GetBackgroundDrawList());
}

/// Draws the lines over each pane: the probe's outline, even if the probe is hidden by the volume; in maps, the
/// camera's direction; and a line towards the point to which assistance pulls the probe.
void App::draw_strokes()
{
    const Document& document = bench_->document();
    if (!document.screen.shows_anything()) return say_that_it_is_coming();
    const ProbeLook look = document.probe_look();
    const TraceMarks marks = document.trace_marks();
    const ServoState* servo = document.touch.servo();
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const Model seen = model();
    const double units = ImGui::GetFontSize() / FONT_UNITS;
    label_memories_.resize(document.screen.parts().size());
    for (const Screen::Part& part : document.screen.parts()) {
        const glm::dvec2 origin(viewport_.layout().begin + part.pane.box.begin);
        const glm::uvec2 pixels = part.pane.box.end - part.pane.box.begin;
        const auto on_screen = [&](const glm::dvec2& pixel) {
            return ImVec2(float(pixel.x + origin.x), float(pixel.y + origin.y));
        };
        list.PushClipRect(on_screen(glm::dvec2(0.0)), on_screen(glm::dvec2(pixels)));
        for (const Stroke& stroke : document.screen.strokes(part, look, marks, bench_->shows_cut_box()))
            list.AddLine(on_screen(stroke.from), on_screen(stroke.to), color_of(stroke.color, 1.0f),
                         float(stroke.width));
        if (part.view->shown_camera()) {
            Pane shown = part.pane;
            shown.shot.camera = *part.view->shown_camera();
            const auto index = size_t(&part - document.screen.parts().data());
            draw_over(marks_of(seen, shown, index, units), pixels, on_screen, list, &label_memories_[index]);
        }
        const Camera* const camera = part.view->shown_camera();
        if (servo && servo->step.in_contact && camera) {
            const auto center = project(*camera, pixels, look.center),
                       proxy = project(*camera, pixels, servo->step.proxy);
            if (center && proxy) {
                list.AddLine(on_screen(center->pixel), on_screen(proxy->pixel), IM_COL32(255, 255, 255, 200), 1.5f);
                list.AddCircleFilled(on_screen(proxy->pixel), 3.0f, IM_COL32(255, 255, 255, 230));
            }
        }
        list.PopClipRect();
    }
}

Model App::model() const
{
    Model model = bench_->model();
    model.ui_frame_ms = report_.recent_frame_ms();
    return model;
}

AppReport App::report()
{
    AppReport report = report_.measured();
    report.gpu_name = renderer_->device().traits().name;
    report.status = bench_->messages().last();
    for (const Message& message : bench_->messages().all()) {
        report.messages.push_back(message.text);
        const bool is_loss = messages_at_stop_ && message.number > *messages_at_stop_ && message.weight != Weight::done;
        if (is_loss) report.stop_losses.push_back(message.text);
    }
    report.previewed_voxels = bench_->previewed_at_stroke();
    if (bench_->is_open()) {
        const Document& document = bench_->document();
        report.relevance_ms = document.touch.mirror_ms();
        report.view_submissions = document.screen.submissions();
        report.view_complete = document.screen.complete();
        report.servo = document.touch.last_state();
        report.probe_voxel = document.probe_voxel();
        report.voxels_by_group = document.annotator.document().mask.voxels_by_group();
        report.undoable = document.annotator.history().undoable();
        report.redoable = document.annotator.history().redoable();
    }
    report.validation_messages = renderer_->device().take_validation_messages();
    return report;
}

}  // namespace shvr::ui
