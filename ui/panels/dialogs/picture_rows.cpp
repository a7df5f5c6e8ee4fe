#include "ui/panels/dialogs/picture_rows.h"

#include <algorithm>
#include <array>
#include <optional>
#include <type_traits>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/machine/clipboard.h"
#include "engine/base/machine/programs.h"
#include "engine/base/text.h"
#include "engine/workbench/forms/form_names.h"
#include "ui/files/asked.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/dialogs/figure_preview.h"
#include "ui/panels/number_field.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// Programs of this machine that pictures need, found in the background.
struct Programs {
    bool has_ffmpeg = false;
    ClipboardProgram clipboard{};
};

/// Returns null until they are known.
const Programs* programs()
{
    static Asked<Programs> asked([] { return Programs{shvr::is_installed("ffmpeg"), clipboard_program()}; });
    static std::optional<Programs> known;
    if (!known) known = asked.take(AT_ONCE);
    return known ? &*known : nullptr;
}

void narrow_field(const char* id, auto& value)
{
    ImGui::SetNextItemWidth(5.0f * ImGui::GetFontSize());
    if constexpr (std::is_same_v<decltype(value), double&>)
        number_field(id, value);
    else
        whole_field(id, value);
}

void words_after(const char* words)
{
    ImGui::SameLine();
    ImGui::TextDisabled("%s", words);
}

void size_rows(SizeForm& size)
{
    field_name("Size");
    narrow_field("##width", size.width);
    ImGui::SameLine();
    ImGui::TextUnformatted("x");
    ImGui::SameLine();
    narrow_field("##height", size.height);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(6.0f * ImGui::GetFontSize());
    if (ImGui::BeginCombo("##unit", size.is_in_mm ? "mm" : "pixels")) {
        if (ImGui::Selectable("mm", size.is_in_mm)) change_unit(size, true);
        if (ImGui::Selectable("pixels", !size.is_in_mm)) change_unit(size, false);
        ImGui::EndCombo();
    }
    if (!size.is_in_mm) return;
    field_name("Resolution");
    narrow_field("##resolution", size.dots_per_inch);
    words_after("dots per inch");
    hint("Journals ask for 300 or more.");
}

void elements_rows(DrawnElements& drawn)
{
    field_name("Draw");
    ImGui::Checkbox("Scale bar", &drawn.has_scale_bar);
    hint("A line of a rounded length; in perspective, it says where it holds.");
    ImGui::SameLine();
    ImGui::Checkbox("Colour bar", &drawn.has_color_bar);
    hint("Colours and opacity of the transfer function, with intensities.");
    ImGui::SameLine();
    ImGui::Checkbox("Legend", &drawn.has_legend);
    hint("Colours and names of the groups that are painted or traced.");
    ImGui::SameLine();
    ImGui::Checkbox("Axes", &drawn.has_axes);
    hint("Directions of x, y and z.");
    field_name("");
    ImGui::Checkbox("Measurements", &drawn.has_measurements);
    hint("Lines, names and values of the measurements.");
    field_name("Title");
    want_glyphs(drawn.title);
    ImGui::InputTextWithHint("##title", "none", &drawn.title);
}

void text_rows(ElementsForm& form)
{
    field_name("Label");
    ImGui::SetNextItemWidth(21.0f * ImGui::GetFontSize());
    want_glyphs(form.next_text);
    ImGui::InputTextWithHint("##label", "a text at the probe, with a dot", &form.next_text);
    ImGui::SameLine();
    if (ImGui::Button("Add")) add_text(form);
    hint("Keeps the label, so that another one can be typed.");
    std::vector<TextInFigure>& texts = form.drawn.texts;
    for (size_t i = 0; i < texts.size(); ++i) {
        ImGui::PushID(int(i));
        field_name("");
        want_glyphs(texts[i].text);
        const bool is_removed = ImGui::SmallButton("Remove");
        ImGui::SameLine();
        ImGui::TextUnformatted(texts[i].text.c_str());
        ImGui::PopID();
        if (is_removed) texts.erase(texts.begin() + std::ptrdiff_t(i--));
    }
}

const char* name_of(MovieKind kind)
{
    return kind == MovieKind::webm ? "WebM" : kind == MovieKind::mp4 ? "MP4" : "Frames as PNG";
}

void kind_row(MovieForm& form)
{
    const Programs* const known = programs();
    const bool has_ffmpeg = !known || known->has_ffmpeg;
    if (!has_ffmpeg && form.kind != MovieKind::frames) choose_kind(form, MovieKind::frames);
    field_name("Format");
    ImGui::SetNextItemWidth(10.0f * ImGui::GetFontSize());
    if (ImGui::BeginCombo("##format", name_of(form.kind))) {
        for (const MovieKind kind : {MovieKind::webm, MovieKind::mp4, MovieKind::frames}) {
            const bool is_offered = has_ffmpeg || kind == MovieKind::frames;
            const std::string name = sentence(name_of(kind), is_offered ? "" : " (install the package ffmpeg)");
            const ImGuiSelectableFlags flags = is_offered ? 0 : ImGuiSelectableFlags_Disabled;
            if (ImGui::Selectable(name.c_str(), kind == form.kind, flags)) choose_kind(form, kind);
        }
        ImGui::EndCombo();
    }
    if (!has_ffmpeg) words_after("WebM and MP4 need the package ffmpeg");
}

/// Draws a view, and what changes on the way to it. Returns whether it is to be removed.
bool view_row(MovieForm& form, size_t view, const Session& session)
{
    const std::string& name = form.views[view];
    want_glyphs(name);
    const bool is_removed = ImGui::SmallButton("Remove");
    ImGui::SameLine();
    ImGui::BeginDisabled(view == 0);
    const bool is_moved = ImGui::SmallButton("Up");
    ImGui::EndDisabled();
    ImGui::SameLine();
    const std::string change = view > 0 ? change_between(session, form.views[view - 1], name) : std::string();
    const float room = ImGui::GetContentRegionAvail().x;
    ImGui::TextUnformatted(shortened(name, change.empty() ? room : 0.5f * room).c_str());
    hint(name.c_str());
    if (!change.empty()) {
        ImGui::SameLine();
        ImGui::TextDisabled("%s", shortened(change, ImGui::GetContentRegionAvail().x).c_str());
        hint(change.c_str());
    }
    if (is_moved) move_up(form, view);
    return is_removed;
}

void views_rows(MovieForm& form, const Model& model)
{
    offer_kept_looks(form, model.session);
    for (size_t i = 0; i < form.views.size(); ++i) {
        ImGui::PushID(int(i));
        field_name(i == 0 ? "Views" : "");
        const bool is_removed = view_row(form, i, model.session);
        ImGui::PopID();
        if (is_removed) form.views.erase(form.views.begin() + std::ptrdiff_t(i--));
    }
    field_name(form.views.empty() ? "Views" : "");
    ImGui::SetNextItemWidth(10.0f * ImGui::GetFontSize());
    if (ImGui::BeginCombo("##view", "Add a view")) {
        for (const std::string& name : camera_names(model.session))
            if (ImGui::Selectable(verbatim(name).c_str())) form.views.push_back(name);
        ImGui::EndCombo();
    }
    hint("Views that were kept (View > Kept views) and sides; the movie slows down at each.");
    ImGui::SameLine();
    form.keeps_shown = ImGui::Button("Add what is shown");
    hint(
        "Keeps the view with its cut, transfer function, groups, light and distance blending, which change on the way "
        "from view to view. For the next one close this dialog, change the picture, and choose View > Kept views > "
        "Keep this view for a movie.");
}

void motion_rows(MovieForm& form, const Model& model)
{
    constexpr const char *TURNS = "turns the volume", *GOES = "goes from view to view";
    field_name("The movie");
    ImGui::SetNextItemWidth(13.0f * ImGui::GetFontSize());
    if (ImGui::BeginCombo("##motion", form.goes_through_views ? GOES : TURNS)) {
        if (ImGui::Selectable(TURNS, !form.goes_through_views)) form.goes_through_views = false;
        if (ImGui::Selectable(GOES, form.goes_through_views)) form.goes_through_views = true;
        ImGui::EndCombo();
    }
    if (form.goes_through_views) return views_rows(form, model);
    ImGui::SameLine();
    narrow_field("##degrees", form.degrees);
    words_after("degrees");
}

void length_row(MovieForm& form)
{
    field_name("Length");
    narrow_field("##seconds", form.seconds);
    words_after("s at");
    ImGui::SameLine();
    narrow_field("##rate", form.more.frames_per_second);
    words_after("frames per second");
}

}  // namespace

bool draw_form(FigureForm& form, const Model& model, const KnownScan&, bool begins)
{
    const bool has_chooser = path_chooser_is_open();
    path_row("File", form.path, ".png or .tif", base_of(model).parent_path() / "", begins);
    size_rows(form.size);
    elements_rows(form.elements.drawn);
    if (more_heading()) {
        field_name("Background");
        ImGui::Checkbox("Transparent", &form.more.is_transparent);
        text_rows(form.elements);
    }
    figure_preview(task_of(form, base_of(model).parent_path()), model, begins);
    return has_chooser;
}

bool draw_form(MovieForm& form, const Model& model, const KnownScan&, bool begins)
{
    const bool has_chooser = path_chooser_is_open();
    path_row("File", form.path, "the movie, or a folder for its frames", base_of(model).parent_path() / "", begins);
    kind_row(form);
    motion_rows(form, model);
    length_row(form);
    field_name("Size");
    narrow_field("##width", form.more.pixels.x);
    ImGui::SameLine();
    ImGui::TextUnformatted("x");
    ImGui::SameLine();
    narrow_field("##height", form.more.pixels.y);
    words_after("pixels");
    elements_rows(form.elements.drawn);
    if (more_heading()) text_rows(form.elements);
    return has_chooser;
}

std::string about(const FigureForm& form, const Model& model, const KnownScan&)
{
    const glm::ivec2 pixels = pixels_of(form.size);
    const std::filesystem::path folder = placed_new(form.path, base_of(model).parent_path()).parent_path();
    return sentence("Draws ", pixels.x, " x ", pixels.y, " pixels to ", folder.string(),
                    ". The file keeps the session and what is drawn over it, from which shvr render makes it again.");
}

std::string about(const MovieForm& form, const Model& model, const KnownScan&)
{
    const MovieTask task = task_of(form, base_of(model).parent_path());
    return sentence("Draws ", counted(task.frames, "frame"), " of ", task.pixels.x, " x ", task.pixels.y, " pixels to ",
                    task.path.parent_path().string(), ", in the background.");
}

bool copy_button(const std::string& why)
{
    const Programs* const known = programs();
    const bool is_missing = known && !known->clipboard.is_installed;
    const std::string name = is_missing ? "Copy picture needs " + known->clipboard.package : "Copy picture";
    ImGui::BeginDisabled(!why.empty() || is_missing || !known);
    const bool is_pressed = ImGui::Button((name + "###copy").c_str());
    ImGui::EndDisabled();
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        ImGui::SetTooltip(
            "%s", is_missing ? sentence("Install the package ", known->clipboard.package, " and start again").c_str()
                             : "Puts the figure into the clipboard, for other programs");
    return is_pressed;
}

}  // namespace shvr::ui
