// The dialog that loads annotation: the file, what it is, and what loading it would change, before it does.

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <utility>

#include <imgui/imgui.h>

#include "engine/workbench/forms/form_names.h"
#include "engine/workbench/lists/group_list.h"
#include "ui/files/annotation_beside.h"
#include "ui/files/asked.h"
#include "ui/panels/color_field.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/imgui_keys.h"
#include "ui/panels/panels.h"
#include "ui/panels/style.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr const char* TITLE = "Load annotation";
constexpr size_t MAX_ROWS_SHOWN = 12;  ///< the table scrolls beyond

constexpr std::pair<FileUse, const char*> USES[] = {{FileUse::by_contents, "as it states"},
                                                    {FileUse::mask, "mask"},
                                                    {FileUse::offsets, "offsets"},
                                                    {FileUse::trace, "trace"},
                                                    {FileUse::look, "transfer function"}};

struct AnnotationDialog {
    std::string path;  ///< as typed
    FileUse use = FileUse::by_contents;
    bool is_shown = false, is_being_read = false;
    bool is_refused = false;    ///< Enter was pressed while nothing can be loaded: the field gets the keyboard again
    bool is_suggested = false;  ///< the path was just taken from `found`, and its field is to show it
    std::string asked_path;     ///< the typed path that is asked about, or was
    Asked<There> looking_at;    ///< what is at `asked_path`
    There there = There::folder;
    std::filesystem::path previewed;  ///< what the last preview was asked of
    std::filesystem::path shown;      ///< the file of the model's preview in the last frame; empty: there was none
    FileUse previewed_use = FileUse::by_contents;
    Asked<std::vector<FoundFile>> looking;
    std::vector<FoundFile> found;  ///< annotation in the folder of the scan
};
AnnotationDialog asking;

FileUse use_of(const LoadPreview& preview)
{
    return preview.is_mesh                  ? FileUse::mesh
           : !preview.part                  ? FileUse::look
           : *preview.part == Part::mask    ? FileUse::mask
           : *preview.part == Part::offsets ? FileUse::offsets
                                            : FileUse::trace;
}

void count_cell(int64_t voxels, const char* sign)
{
    ImGui::TableNextColumn();
    if (voxels > 0) ImGui::Text("%s%lld", sign, static_cast<long long>(voxels));
}

/// Draws a row for each group that gains or loses voxels.
void group_table(const Groups& groups, const LoadPreview& preview)
{
    const float rows = float(std::min(preview.groups.size(), MAX_ROWS_SHOWN)) + 1.5f;
    constexpr ImGuiTableFlags FLAGS = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_ScrollY;
    if (!ImGui::BeginTable("changes", 5, FLAGS, {0.0f, rows * ImGui::GetFrameHeight()})) return;
    ImGui::TableSetupScrollFreeze(0, 1);
    for (const char* title : {"Group", "Voxels now", "Gained", "Lost", "Voxels then"}) ImGui::TableSetupColumn(title);
    ImGui::TableHeadersRow();
    for (const MaskPreview::Group& row : preview.groups) {
        ImGui::TableNextColumn();
        const float side = ImGui::GetTextLineHeight();
        ImGui::PushID(row.group);
        ImGui::ColorButton("##color", encoded(group_of(groups, uint8_t(row.group)).color),
                           ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop, {side, side});
        ImGui::PopID();
        ImGui::SameLine();
        ImGui::TextUnformatted(label_of_group(groups, uint8_t(row.group)).c_str());
        ImGui::TableNextColumn();
        ImGui::Text("%lld", static_cast<long long>(row.before));
        count_cell(row.gained, "+");
        count_cell(row.lost, "-");
        ImGui::TableNextColumn();
        ImGui::Text("%lld", static_cast<long long>(row.after()));
    }
    ImGui::EndTable();
}

/// Takes the file of a preview that this dialog has not asked for, because it was dropped. Returns whether it did.
bool follow_drops(const Model& model)
{
    const std::filesystem::path present = model.load_preview ? model.load_preview->path : std::filesystem::path();
    const bool is_dropped = std::exchange(asking.shown, present) != present && present != asking.previewed;
    if (!is_dropped || present.empty()) return false;
    asking.path = asking.asked_path = present.string();
    asking.there = There::file;
    asking.previewed = present;
    asking.use = asking.previewed_use = FileUse::by_contents;
    return true;
}

/// Begins with the file that was dropped, or else with the newest annotation of the scan in its folder.
void begin(const Model& model)
{
    asking = {.is_shown = true};
    if (follow_drops(model)) return;
    const std::vector<std::filesystem::path> own{model.session.mask_path, model.session.trace_path,
                                                 model.session.density_path, model.session.volume_path};
    const std::filesystem::path base = base_of(model);
    const std::vector<std::string> stems{base.filename().string(),
                                         stem_of(model.session.volume_path).filename().string()};
    asking.looking = Asked<std::vector<FoundFile>>(
        [folder = base.parent_path(), own, stems] { return annotation_beside(folder, own, stems); });
}

/// Takes what the disk has answered, and asks about what was typed since.
void follow_disk(const Model& model)
{
    if (auto found = asking.looking.take()) {
        asking.found = std::move(*found);
        if (asking.path.empty() && !asking.found.empty()) {
            asking.path = asking.found.front().path.string();
            asking.is_suggested = true;
        }
    }
    if (asking.path != asking.asked_path) {
        asking.asked_path = asking.path;
        asking.there = There::folder;
        asking.looking_at =
            Asked<There>([path = placed(asking.path, base_of(model).parent_path())] { return what_is_at(path); });
    }
    if (const auto there = asking.looking_at.take()) asking.there = *there;
}

bool names_scan(const Model& model)
{
    return placed(asking.path, base_of(model).parent_path()) == model.session.volume_path;
}

/// Asks for a preview of what is typed, once it names a file.
void follow_preview(const Model& model, Actions& actions)
{
    const std::filesystem::path path = placed(asking.path, base_of(model).parent_path());
    const bool is_known = asking.previewed == path && asking.previewed_use == asking.use;
    const bool is_there = asking.there == There::file && !names_scan(model);
    if (is_known || (!is_there && asking.previewed.empty())) return;
    asking.previewed = is_there ? path : std::filesystem::path();
    asking.previewed_use = asking.use;
    actions.push_back(PreviewLoad{asking.previewed, asking.use});
}

void use_row()
{
    field_name("Contents");
    bool is_first = true;
    for (const auto& [use, name] : USES) {
        if (!std::exchange(is_first, false)) ImGui::SameLine();
        if (ImGui::RadioButton(name, asking.use == use)) asking.use = use;
    }
}

/// Lists annotation in the folder of the scan; a click takes a file.
void found_row()
{
    if (asking.found.empty()) return;
    field_name("Nearby");
    constexpr size_t MAX_FILES = 4;
    ImGui::BeginGroup();
    for (size_t i = 0; i < std::min(asking.found.size(), MAX_FILES); ++i) {
        const FoundFile& file = asking.found[i];
        ImGui::PushID(int(i));
        want_glyphs(file.name);
        if (ImGui::Selectable(verbatim(file.name + "   " + file.about).c_str(), asking.path == file.path.string(), 0,
                              {26.0f * ImGui::GetFontSize(), 0.0f}))
            asking.path = file.path.string();
        ImGui::PopID();
    }
    ImGui::EndGroup();
}

void what_changes(const Model& model)
{
    const bool is_asked = !asking.previewed.empty();
    if (asking.there == There::nothing && !asking.path.empty())
        return dialog_note(
            "", trimmed(asking.path).empty() ? "Type the name of a file." : asking.path + ": there is no such file");
    if (names_scan(model))
        return dialog_note("", asking.path + ": is the scan that is open; expected annotation of it");
    if (!is_asked || !model.load_preview || model.load_preview->path != asking.previewed) {
        dialog_note(is_asked ? "is being read ..." : "A mask, density offsets, a trace, a transfer function or a mesh.",
                    "");
        return;
    }
    const LoadPreview& preview = *model.load_preview;
    if (preview.is_being_read) return dialog_note("is being read ...", "");
    if (!preview.failure.empty()) return dialog_note("", preview.failure);
    ImGui::TextUnformatted(preview.changes.c_str());
    if (!preview.groups.empty()) group_table(model.session.groups, preview);
    std::string notes;
    for (const std::string& note : preview.notes) notes += note + '\n';
    dialog_note(notes + (preview.changes_anything ? "Undo takes it back." : ""), "");
}

}  // namespace

void load_preview_dialog(const Model& model, Actions& actions)
{
    const bool is_wanted = model.is_open && (model.dialog == Dialog::load || model.load_preview);
    const bool begins = is_wanted && !asking.is_shown;
    if (begins) {
        begin(model);
        ImGui::OpenPopup(TITLE);
        if (model.dialog != Dialog::load) actions.push_back(ShowDialog{Dialog::load});
    }
    if (!asking.is_shown) return;
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    size_dialog();
    if (!begin_dialog(TITLE, ImGuiWindowFlags_AlwaysAutoResize)) {
        // Another popup closed it.
        asking.is_shown = false;
        if (is_wanted) actions.insert(actions.end(), {PreviewLoad{}, ShowDialog{}});
        return;
    }
    const bool has_chooser = path_chooser_is_open();
    const bool is_filled = follow_drops(model) || std::exchange(asking.is_suggested, false) ||
                           std::exchange(asking.is_refused, false);  // a field lets go of the keyboard at Enter
    path_row("File", asking.path, "mask, offsets, trace, transfer function or mesh", base_of(model).parent_path() / "",
             is_filled || begins);
    use_row();
    found_row();
    follow_disk(model);
    follow_preview(model, actions);
    what_changes(model);
    const LoadPreview* const preview = model.load_preview;
    asking.is_being_read = preview && preview->is_being_read;
    const bool can_load = preview && !preview->is_being_read && preview->failure.empty() && preview->changes_anything &&
                          preview->path == asking.previewed && asking.path == asking.asked_path && !names_scan(model);
    const ImVec2 button{6.0f * ImGui::GetFontSize(), 0.0f};
    ImGui::BeginDisabled(!can_load);
    const bool is_entered = !has_chooser && enter_confirms();
    asking.is_refused = is_entered && !can_load;
    const bool loads = ImGui::Button("Load", button) || (can_load && is_entered);
    ImGui::EndDisabled();
    ImGui::SameLine();
    const bool leaves = ImGui::Button("Cancel", button) || !is_wanted ||
                        (!has_chooser && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape)));
    if (loads) actions.push_back(LoadAnnotation{preview->path, use_of(*preview)});
    keep_above(ImGui::GetMainViewport()->WorkPos.y + ImGui::GetMainViewport()->WorkSize.y);
    if (!loads && leaves && is_wanted) actions.push_back(PreviewLoad{});
    if (loads || leaves) {
        if (model.dialog == Dialog::load) actions.push_back(ShowDialog{});
        ImGui::CloseCurrentPopup();
        asking.is_shown = false;
    }
    ImGui::EndPopup();
}

bool load_dialog_waits()
{
    return asking.is_shown && (asking.is_being_read || asking.looking.is_pending() || asking.looking_at.is_pending());
}

}  // namespace shvr::ui
