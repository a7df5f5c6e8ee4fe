// Settings of touch: guidance, modes of the pull, groups that are felt, and where tools act.

#include <algorithm>
#include <cmath>

#include <imgui/imgui.h>

#include "engine/workbench/bindings/hints.h"
#include "engine/workbench/edits/edit.h"
#include "engine/workbench/lists/group_list.h"
#include "engine/workbench/models/hand_view.h"
#include "engine/workbench/words/touch_words.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// Draws a row of buttons, one for each value.
template <class Value>
std::optional<Value> radio(Value value)
{
    std::optional<Value> chosen;
    for (const Spelling<Value>& each : spellings_of(value)) {
        if (each.value != spellings_of(value).front().value) ImGui::SameLine();
        const TouchWords words = words_of(each.value);
        if (ImGui::RadioButton(words.name, value == each.value)) chosen = each.value;
        hint(words.hint);
    }
    return chosen;
}

void threshold(const Model& model, Actions& actions)
{
    label("Haptic threshold");
    const auto [lower, upper] = model.statistics.range();
    double intensity = model.haptic_threshold();
    ImGui::SetNextItemWidth(-1.0f);
    const bool is_other = slider_scalar("##felt", ImGuiDataType_Double, &intensity, &lower, &upper,
                                        is_float(model.volume.type) ? "%.4g" : "%.0f");
    if (!resets("probe.haptic_threshold", actions) && is_other)
        set(actions, model, [&](Session& s) { s.probe.haptic_threshold = intensity; });
    hint("Voxels at or above this intensity are felt. The line \"haptic\" in the transfer function.");
}

void strength(const Model& model, Actions& actions)
{
    const FeelSettings& touch = model.session.probe.touch;
    double percent = 100.0 * touch.strength;
    const bool is_other = slider("Strength", percent, 0.0, 100.0, "%.0f %%", ImGuiSliderFlags_AlwaysClamp);
    if (!resets("probe.touch.strength", actions) && is_other)
        set(actions, model, [&](Session& s) { s.probe.touch.strength = std::round(percent) / 100.0; });
    hint(sentence("Strength of the pull. ", name_with_key("stronger", model.keymap), ", ",
                  name_with_key("weaker", model.keymap), ".")
             .c_str());
    if (touch.mode != TouchMode::surface) return;
    double filled = 100.0 * touch.surface_share;
    const bool is_moved = slider("Holds from", filled, 1.0, 100.0, "%.0f %% filled", ImGuiSliderFlags_AlwaysClamp);
    if (!resets("probe.touch.surface_share", actions) && is_moved)
        set(actions, model, [&](Session& s) { s.probe.touch.surface_share = std::round(filled) / 100.0; });
    hint("A surface holds once this share of the probe lies in it.");
}

void finer(const Model& model, Actions& actions)
{
    if (!ImGui::TreeNode("Stiffness and damping")) return;
    const FeelSettings& touch = model.session.probe.touch;
    double stiffness = touch.stiffness, damping = touch.damping;
    const bool is_stiffer =
        slider("Stiffness", stiffness, 0.0, MAX_STIFFNESS, "%.0f N/m", ImGuiSliderFlags_AlwaysClamp);
    if (!resets("probe.touch.stiffness", actions) && is_stiffer)
        set(actions, model, [&](Session& s) { s.probe.touch.stiffness = std::round(stiffness); });
    hint("Stiffness for a 2.5 mm probe. The device's own limit also applies.");
    const bool is_damped =
        slider("Damping", damping, 0.0, MAX_FELT_DAMPING, "%.2f N s/m", ImGuiSliderFlags_AlwaysClamp);
    if (!resets("probe.touch.damping", actions) && is_damped)
        set(actions, model, [&](Session& s) { s.probe.touch.damping = std::round(100.0 * damping) / 100.0; });
    hint("Slows the hand in contact, which keeps it calm.");
    ImGui::TreePop();
}

/// Draws the choice of groups that can be felt: all groups, or the ticked groups.
void groups(const Model& model, Actions& actions)
{
    const std::vector<uint8_t>& felt = model.session.probe.touch.groups;
    std::string preview = felt.empty() ? "everything" : "";
    for (const uint8_t group : felt)
        preview += (preview.empty() ? "" : ", ") +
                   (group == 0 ? std::string("unpainted") : group_of(model.session.groups, group).name);
    label("Feels");
    ImGui::SetNextItemWidth(-1.0f);
    const bool is_open = ImGui::BeginCombo("##groups", verbatim(preview).c_str());
    hint("Colour groups that are felt. New paint and offsets are felt at once.");
    if (!is_open) return;
    if (ImGui::Selectable("everything", felt.empty(), ImGuiSelectableFlags_DontClosePopups))
        set(actions, model, [&](Session& s) { s.probe.touch.groups.clear(); });
    const auto row = [&](uint8_t group, const std::string& name) {
        bool is_felt = std::ranges::find(felt, group) != felt.end();
        if (!ImGui::Checkbox(sentence(verbatim(name), "##", int(group)).c_str(), &is_felt)) return;
        set(actions, model, [&](Session& s) {
            std::vector<uint8_t>& all = s.probe.touch.groups;
            std::erase(all, group);
            if (is_felt) all.push_back(group);
            std::ranges::sort(all);
        });
    };
    row(0, "unpainted");
    for (const auto& [number, settings] : model.session.groups)
        row(number, group_of(model.session.groups, number).name);
    ImGui::EndCombo();
}

void flag(const char* text, const char* meaning, const Model& model, Actions& actions, bool FeelSettings::*member)
{
    bool is_on = model.session.probe.touch.*member;
    if (ImGui::Checkbox(text, &is_on)) set(actions, model, [&](Session& s) { s.probe.touch.*member = is_on; });
    hint(meaning);
}

void tools(const Model& model, Actions& actions)
{
    ImGui::Separator();
    flag("Act at the middle", "Paints and sets nodes at the middle of what the probe touches: on the centre line.",
         model, actions, &FeelSettings::at_proxy);
    flag("Width from touch", "New nodes get the radius of a tube that fills the probe as much as the felt structure.",
         model, actions, &FeelSettings::overlap_radius);
    flag("To nodes", "Where a node lies in the probe, tools act at it, and a new node becomes a link with it.", model,
         actions, &FeelSettings::to_nodes);
    flag("To centre lines", "Where a centre line passes through the probe, tools act on it, and a new node divides it.",
         model, actions, &FeelSettings::to_lines);
    flag("Feel hidden parts",
         "Feels what the picture does not show, too: what is cut away or transparent, and hidden groups. Off: what is "
         "seen is what is felt.",
         model, actions, &FeelSettings::feels_hidden);
    flag("Click at contact",
         "A short push against your hand where the probe begins to touch something. Only for devices with motors.",
         model, actions, &FeelSettings::clicks);
    label("Plane");
    if (const auto plane = radio(model.session.probe.touch.plane))
        set(actions, model, [&](Session& s) { s.probe.touch.plane = *plane; });
    double scale = model.session.interaction.workspace_scale;
    const bool is_moved = slider("Workspace", scale, MIN_WORKSPACE_SCALE, MAX_WORKSPACE_SCALE, "%.2f times",
                                 ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    if (!resets("interaction.workspace_scale", actions) && is_moved)
        set(actions, model, [&](Session& s) { s.interaction.workspace_scale = scale; });
    hint(sentence("Distance that the probe moves with the hand. At 1, the device's whole reach is the height of the "
                  "view; below, the hand is steadier; above, it reaches farther. ",
                  name_with_key("larger_workspace", model.keymap), ", ",
                  name_with_key("smaller_workspace", model.keymap), ".")
             .c_str());
}

}  // namespace

void touch_panel(const Model& model, Actions& actions)
{
    bool assists = model.session.probe.guided;
    if (ImGui::Checkbox(sentence("Guidance", key_in_brackets("guide", model.keymap), "##guide").c_str(), &assists))
        set(actions, model, [&](Session& s) { s.probe.guided = assists; });
    hint("Pulls the probe towards what it touches, so that it stays on a root while you move along.");
    if (model.hand && model.hand->is_let_go) {
        ImGui::SameLine();
        if (ImGui::SmallButton("Take up again")) actions.emplace_back(LetGo{false});
    } else {
        ImGui::SameLine();
        if (ImGui::SmallButton("Let go")) actions.emplace_back(LetGo{true});
        hint(sentence("Switches all force off at once. ", name_with_key("let_go", model.keymap), ".").c_str());
    }
    label("Touches");
    if (const auto mode = radio(model.session.probe.touch.mode))
        set(actions, model, [&](Session& s) { s.probe.touch.mode = *mode; });
    label("Pull");
    if (const auto law = radio(model.session.probe.guidance))
        set(actions, model, [&](Session& s) { s.probe.guidance = *law; });
    threshold(model, actions);
    strength(model, actions);
    groups(model, actions);
    finer(model, actions);
    tools(model, actions);
    device_section(model, actions);
}

}  // namespace shvr::ui
