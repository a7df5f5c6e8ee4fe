// Dialogs for opening with choices: the file's kind, the resources that loading takes, and values from the user in
// place of the file's. Also shows the spacing of the open volume, and lets the user correct it.

#include <algorithm>
#include <string>
#include <utility>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/error.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/forms/voxel_size.h"
#include "engine/workbench/lists/load_form.h"
#include "engine/workbench/models/preferences.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/dialogs/file_chooser.h"
#include "ui/panels/field_keys.h"
#include "ui/panels/number_field.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr const char *LOAD = "Open with options", *SPACING = "Correct the spacing";

FileChooser choosing({.title = "Look at a file",
                      .verb = "Look",
                      .note = "Any file with voxels, also bare ones; nothing is loaded yet."});

struct LoadDialog {
    LoadForm form;
    std::string path;
    std::vector<Choice> choices;             ///< choices that the file was found to offer
    int levels = 0;                          ///< number of levels that the file was found to have; 0: not known
    std::string spacing_text = "1 x 1 x 1";  ///< as typed (voxel_size.h)
    bool is_asked_for = false;
};
LoadDialog loading;

/// Adds the choices that the file offers now. Keeps earlier choices, even if the file no longer offers them.
void follow_choices(const Candidate* candidate)
{
    if (!candidate || candidate->path != loading.path) return;
    for (const Choice& choice : candidate->choices) {
        std::erase_if(loading.choices, [&](const Choice& known) { return known.key == choice.key; });
        loading.choices.push_back(choice);
    }
}

/// Draws a list if the file offers several choices, otherwise a text field.
bool choice_field(const char* label, const char* key, std::string& value)
{
    const auto found = std::ranges::find(loading.choices, key, &Choice::key);
    if (found == loading.choices.end()) return ImGui::InputText(label, &value);
    const auto at = std::ranges::find(found->values, value);
    const std::string title =
        at != found->values.end() ? found->titles[size_t(at - found->values.begin())] : "choose one of them";
    bool is_changed = false;
    const std::string shown = verbatim(value.empty() || at != found->values.end() ? title : value);
    if (!ImGui::BeginCombo(label, shown.c_str())) return false;
    for (size_t i = 0; i < found->values.size(); ++i) {
        want_glyphs(found->titles[i]);
        if (!ImGui::Selectable(verbatim(found->titles[i]).c_str(), found->values[i] == value)) continue;
        value = found->values[i];
        is_changed = true;
    }
    ImGui::EndCombo();
    return is_changed;
}

/// Lets the user select a level if a file has several.
bool level_field(int& level)
{
    if (loading.levels < 2) return false;
    const auto title = [](int of) {
        return of == 0 ? std::string("0  the finest") : sentence(of, "  voxels ", int64_t{1} << of, " times as wide");
    };
    if (!ImGui::BeginCombo("size", title(level).c_str())) return false;
    const int before = level;
    for (int each = 0; each < loading.levels; ++each)
        if (ImGui::Selectable(title(each).c_str(), each == level)) level = each;
    ImGui::EndCombo();
    return level != before;
}

struct SpacingDialog {
    std::string text;  ///< as typed (voxel_size.h)
    FieldKeys keys;
    bool is_shown = false;
    bool takes_keys = false;   ///< the field gets the keyboard in the next frame
    bool ends_at_end = false;  ///< and then has the cursor behind the text
};
SpacingDialog correcting;

int put_cursor_behind(ImGuiInputTextCallbackData* data)
{
    if (std::exchange(correcting.ends_at_end, false))
        data->CursorPos = data->SelectionStart = data->SelectionEnd = data->BufTextLen;
    return 0;
}

/// Draws the size of a voxel. Returns whether it was changed to another size.
bool spacing_field(std::string& text, glm::dvec3& spacing, std::string& unit)
{
    constexpr ImGuiInputTextFlags FLAGS = ImGuiInputTextFlags_AutoSelectAll | ImGuiInputTextFlags_CallbackAlways;
    const bool is_changed = ImGui::InputText("size of a voxel", &text, FLAGS, put_cursor_behind);
    hint("As in 0.8 x 0.8 x 1.2 um, or 4 um. Without a unit, that stays as it is.");
    const std::optional<VoxelSize> size = voxel_size_of(text);
    if (!is_changed || !size || !why_no_voxel_size(text).empty()) return false;
    spacing = size->spacing;
    if (!size->unit.empty()) unit = size->unit;
    return true;
}

void label_behind(const char* words)
{
    ImGui::SameLine(0.0f, ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::TextUnformatted(words);
}

/// True where something changed.
bool bare_fields(LoadForm& form)
{
    bool is_changed = ImGui::Checkbox("Bare voxels, without a header", &form.is_bare);
    hint("A file of numbers only: enter the size along x, y and z and the type of a voxel.");
    if (!form.is_bare) return is_changed;
    is_changed |= whole_fields("##size", form.size);
    label_behind("voxels along x, y, z");
    for (int& side : form.size) side = std::clamp(side, 1, 1 << 20);
    if (ImGui::BeginCombo("type", name_of(form.type))) {
        for (const VoxelType type : {VoxelType::uint8, VoxelType::int8, VoxelType::uint16, VoxelType::int16,
                                     VoxelType::uint32, VoxelType::int32, VoxelType::float32, VoxelType::float64})
            if (ImGui::Selectable(name_of(type), type == form.type)) {
                form.type = type;
                is_changed = true;
            }
        ImGui::EndCombo();
    }
    is_changed |= ImGui::Checkbox("big-endian", &form.is_big_endian);
    hint("Byte order of a number. Most machines write little-endian.");
    is_changed |= whole_field("##skipped", form.offset_bytes);
    label_behind("bytes to skip at the beginning");
    form.offset_bytes = std::max(form.offset_bytes, 0);
    return is_changed;
}

void about(const Candidate& candidate)
{
    ImGui::PushTextWrapPos(0.0f);
    if (candidate.is_being_read) {
        ImGui::TextDisabled("is being looked at ...");
    } else {
        if (!candidate.kind.empty()) {
            ImGui::TextUnformatted(sentence(candidate.kind, ", ", size_in_words(candidate.volume)).c_str());
            if (candidate.levels > 1)
                ImGui::TextUnformatted(sentence("In ", candidate.levels,
                                                " sizes, each half of the one before; what the picture needs is read")
                                           .c_str());
            ImGui::TextDisabled("Spacing: %s. Unit: %s.", in_words(candidate.volume.spacing_from),
                                in_words(candidate.volume.unit_from));
            ImGui::TextUnformatted(("Takes " + candidate.memory).c_str());
        }
        for (const std::string& warning : candidate.warnings) ImGui::TextDisabled("%s", warning.c_str());
        ImGui::PushStyleColor(ImGuiCol_Text, WARNING);
        if (!candidate.failure.empty()) ImGui::TextUnformatted(candidate.failure.c_str());
        ImGui::PopStyleColor();
    }
    ImGui::PopTextWrapPos();
}

void load_dialog(const Model& model, Actions& actions)
{
    if (std::exchange(loading.is_asked_for, false)) ImGui::OpenPopup(LOAD);
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({36.0f * ImGui::GetFontSize(), 0.0f});
    if (!begin_dialog(LOAD, ImGuiWindowFlags_NoSavedSettings)) return;
    follow_choices(model.candidate);
    LoadForm& form = loading.form;
    ImGui::PushItemWidth(14.0f * ImGui::GetFontSize());
    want_glyphs(loading.path);
    ImGui::TextWrapped("%s", loading.path.c_str());
    ImGui::Spacing();
    bool is_changed = bare_fields(form);
    if (!form.is_bare) {
        is_changed |= choice_field("channel or series", "channel", form.channel);
        hint("If there are several: red, green, blue, alpha, a name in the file, or a number from 1.");
        is_changed |= choice_field("time point", "frame", form.frame);
        hint("If the file has several: a number from 1.");
        is_changed |= level_field(form.level);
        if (loading.levels > 1)
            hint("A coarser size is opened as a volume of its own: it takes less memory, and its paint fits it alone.");
    }
    is_changed |= ImGui::Checkbox("State the spacing", &form.states_spacing);
    hint("Replaces the spacing in the file, or supplies a missing one.");
    if (form.states_spacing) is_changed |= spacing_field(loading.spacing_text, form.spacing, form.unit);
    ImGui::PopItemWidth();
    std::string wrong = refused_number();
    if (wrong.empty() && form.states_spacing) wrong = why_no_voxel_size(loading.spacing_text);
    if (!wrong.empty()) dialog_note("", wrong);
    const std::string settings = settings_of(form);
    const Candidate* const candidate = model.candidate;
    const bool is_current = candidate && candidate->settings == settings && candidate->path == loading.path;
    if (is_current && !candidate->is_being_read && candidate->failure.empty())
        loading.levels = candidate->levels + form.level;
    if (is_changed || !is_current) actions.push_back(LookAtFile{loading.path, settings});
    ImGui::Separator();
    if (candidate) about(*candidate);
    ImGui::Separator();
    const ImVec2 button{9.0f * ImGui::GetFontSize(), 0.0f};
    const bool can_open = wrong.empty() && is_current && !candidate->is_being_read && candidate->failure.empty();
    bool closes = false;
    ImGui::BeginDisabled(!can_open);
    if (ImGui::Button("Open", button)) {
        actions.push_back(Open{loading.path, settings});
        closes = true;
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    const bool can_import = can_open && !candidate->is_project && settings.empty();
    ImGui::BeginDisabled(!can_import);
    if (ImGui::Button("Import as project...", button)) {
        ask_to_import(loading.path, actions);
        closes = true;
    }
    ImGui::EndDisabled();
    hint("A folder with the volume in several sizes, which opens at once; the file itself stays as it is.");
    ImGui::SameLine();
    closes |= ImGui::Button("Cancel", button) || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
    if (closes) {
        actions.push_back(LookAtFile{});
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
}

void spacing_dialog(const Model& model, Actions& actions)
{
    const bool is_asked_for = model.dialog == Dialog::spacing;
    bool is_begun = false;
    if (is_asked_for && !std::exchange(correcting.is_shown, true)) {
        correcting.text = text_of(VoxelSize{model.volume.spacing, model.volume.unit});
        correcting.takes_keys = correcting.ends_at_end = false;
        is_begun = true;
        ImGui::OpenPopup(SPACING);
    }
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({32.0f * ImGui::GetFontSize(), 0.0f});
    if (!correcting.is_shown) return;
    if (!begin_dialog(SPACING, ImGuiWindowFlags_NoSavedSettings)) {
        correcting.is_shown = false;
        if (is_asked_for) actions.push_back(ShowDialog{});
        return;
    }
    ImGui::TextWrapped("Now %s (%s).", size_in_words(model.volume).c_str(), in_words(model.volume.spacing_from));
    ImGui::PushItemWidth(14.0f * ImGui::GetFontSize());
    correcting.keys.before_field(std::exchange(correcting.takes_keys, false) || is_begun);
    CorrectSpacing action{model.volume.spacing, model.volume.unit};
    spacing_field(correcting.text, action.spacing, action.unit);
    correcting.keys.after_field();
    ImGui::PopItemWidth();
    const std::optional<VoxelSize> size = voxel_size_of(correcting.text);
    if (size) action = {size->spacing, size->unit.empty() ? model.volume.unit : size->unit};
    std::string why = why_no_voxel_size(correcting.text, model.volume.unit);
    if (why.empty()) why = why_not(model, action);
    dialog_note("Paint and nodes stay at their voxels; lengths follow. The work is saved and opened again.", why);
    const ImVec2 button{8.0f * ImGui::GetFontSize(), 0.0f};
    ImGui::BeginDisabled(!why.empty());
    const bool is_entered = enter_confirms();
    const bool is_confirmed = ImGui::Button("Correct", button) || (is_entered && why.empty());
    // Enter has made the field release the keyboard: typing goes on where it was.
    if (is_entered && !why.empty()) correcting.takes_keys = correcting.ends_at_end = true;
    ImGui::EndDisabled();
    ImGui::SameLine();
    const bool is_left = ImGui::Button("Cancel", button) || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
    if (is_confirmed || is_left || !is_asked_for) {
        ImGui::CloseCurrentPopup();
        correcting.is_shown = false;
        if (is_asked_for) actions.push_back(ShowDialog{});
    }
    if (is_confirmed) actions.push_back(action);
    ImGui::EndPopup();
}

}  // namespace

void load_dialogs(const Model& model, Actions& actions)
{
    const auto& recent = model.preferences.recent;
    const std::filesystem::path begin = recent.empty() ? std::filesystem::path() : recent.front().parent_path();
    if (const auto path = answer_of(choosing, Dialog::open_with_options, begin, model, actions)) {
        if (loading.path != path->string()) {
            loading.path = path->string();
            loading.choices.clear();
            loading.form.channel.clear();
            loading.form.frame.clear();
            loading.form.level = loading.levels = 0;
        }
        loading.is_asked_for = true;
    }
    load_dialog(model, actions);
    spacing_dialog(model, actions);
}

}  // namespace shvr::ui
