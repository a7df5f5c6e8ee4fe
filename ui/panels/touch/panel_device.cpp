// The haptic device: which devices are present, which one is in use, and its state.

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>

#include <imgui/imgui.h>

#include "engine/workbench/models/hand_view.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

void said(const Finding& finding)
{
    const bool is_weighty = finding.weight != Weight::done;
    if (is_weighty) ImGui::PushStyleColor(ImGuiCol_Text, finding.weight == Weight::error ? ERROR_TEXT : WARNING);
    ImGui::TextWrapped("%s", finding.text.c_str());
    if (is_weighty) ImGui::PopStyleColor();
}

void device_list(const Model& model, const HandView& hand, Actions& actions)
{
    for (const DeviceListing& device : hand.devices) {
        const bool is_mouse = device.kind == DeviceKind::mouse;
        const bool is_used = device.id == hand.in_use || (is_mouse && !hand.moves_probe && hand.in_use.empty());
        ImGui::PushID(device.id.c_str());
        if (ImGui::RadioButton(verbatim(name_in_words(device.name, device.serial)).c_str(), is_used))
            actions.emplace_back(UseDevice{device.id});
        if (!device.connection.empty()) hint(device.connection.c_str());
        ImGui::Indent();
        ImGui::PushStyleColor(ImGuiCol_Text, ThemeColor{ColorRole::faint_text});
        ImGui::TextWrapped("%s", state_in_words(device, hand).c_str());
        ImGui::PopStyleColor();
        ImGui::Unindent();
        ImGui::PopID();
    }
    if (!hand.has_looked) ImGui::TextUnformatted("Looking for devices ...");
    if (ImGui::SmallButton("Look again")) actions.emplace_back(FindDevices{});
    hint("Devices plugged in later are found automatically within seconds.");
    ImGui::SameLine();
    bool is_automatic = model.preferences.device.name.empty();
    if (ImGui::Checkbox("Automatic", &is_automatic) && is_automatic) actions.emplace_back(UseDevice{});
    hint("Uses the first usable device. Your choice is kept for all scans.");
}

void puck(const Model& model, const HandView& hand, Actions& actions)
{
    if (!hand.is_puck) return;
    label("It moves");
    const PuckMoves moves = model.preferences.puck;
    if (ImGui::RadioButton("the view", moves == PuckMoves::view)) actions.emplace_back(Prefer{R"({"puck":"view"})"});
    ImGui::SameLine();
    if (ImGui::RadioButton("the probe", moves == PuckMoves::probe)) actions.emplace_back(Prefer{R"({"puck":"probe"})"});
}

/// Draws the force of the last five seconds.
void force_plot(const HandView& hand, const ServoState& servo)
{
    const std::vector<float> bars = plot_of(hand.tap);
    const float highest = std::max(0.5f, *std::ranges::max_element(bars));
    text_label("Force");
    ImGui::Text("%.2f N now, %.2f N at most in 5 s", glm::length(servo.step.force_n),
                double(*std::ranges::max_element(bars)));
    const ImVec2 size{ImGui::GetContentRegionAvail().x, 3.0f * ImGui::GetFontSize()};
    ImGui::PushStyleVar(ImGuiStyleVar_DisabledAlpha, 1.0f);
    ImGui::BeginDisabled();  // suppresses the plot's own tooltip, which would number the bars
    ImGui::PlotLines("##force", bars.data(), int(bars.size()), 0, nullptr, 0.0f, highest, size);
    ImGui::EndDisabled();
    ImGui::PopStyleVar();
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        ImGui::SetTooltip("The last five seconds, the newest at the right; the upper edge is %.1f N.", double(highest));
}

/// Draws a plot with a logarithmic scale, on which one late tick in a million is still visible.
void lateness_plot(const TimeHistogram& lateness)
{
    std::array<float, TimeHistogram::BINS> heights{};
    for (size_t bin = 0; bin < heights.size(); ++bin) heights[bin] = std::log1p(float(lateness.counts[bin]));
    const ImVec2 size{ImGui::GetContentRegionAvail().x, 2.2f * ImGui::GetFontSize()};
    // Disabling the plot suppresses its own tooltip, which would show logarithms.
    ImGui::PushStyleVar(ImGuiStyleVar_DisabledAlpha, 1.0f);
    ImGui::BeginDisabled();
    ImGui::PlotHistogram("##lateness", heights.data(), int(heights.size()), 0, nullptr, 0.0f, FLT_MAX, size);
    ImGui::EndDisabled();
    ImGui::PopStyleVar();
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
    ImGui::SetTooltip(
        "How late steps began: the first bar below 1 \u00b5s, each further one twice as late;\n"
        "heights are logarithmic. Half below %.0f \u00b5s, 99.9 %% below %.0f \u00b5s, worst %.3f ms.",
        lateness.quantile_us(0.5), lateness.quantile_us(0.999), double(lateness.worst_ns) * 1e-6);
}

void figures(const Model& model, const HandView& hand, const ServoState& servo)
{
    text_label("Touch");
    ImGui::Text("%s, %.0f %% of the probe filled", servo.step.in_contact ? "in contact" : "not in contact",
                100.0 * servo.step.relevant_share);
    force_plot(hand, servo);
    if (const std::string heat = heat_in_words(hand.tap.heat, servo.caps); !heat.empty()) {
        text_label("Motors");
        ImGui::TextWrapped("%s", heat.c_str());
        hint("Estimated from the forces of the last seconds, not measured.");
    }
    text_label("Delay");
    const double delay_s = servo.step.latency_s > 0.0 ? servo.step.latency_s : servo.caps.latency_s;
    ImGui::Text("%.1f ms to the hand, %.0f ms old what is felt", 1e3 * delay_s, model.relevance_age_ms);
    hint(
        "From the force to where the device says that it acts; and the age of the region around the probe. Above 50 "
        "ms the force fades out.");
    text_label("Rhythm");
    ImGui::TextWrapped("%s", rhythm_in_words(servo).c_str());
    hint("The servo runs at 1 kHz; a step is late if it began more than 1 ms after its time.");
    if (hand.tap.lost_states > 0) {
        text_label("Lost");
        ImGui::Text("%llu readings of the device", static_cast<unsigned long long>(hand.tap.lost_states));
    }
    lateness_plot(servo.lateness);
    static const uint64_t allowed = allowed_realtime_priority();
    said(realtime_in_words(hand.is_realtime, allowed));
}

void recording(const HandView& hand, Actions& actions)
{
    if (hand.recorded_s) {
        if (ImGui::SmallButton("End the recording")) actions.emplace_back(StopRecording{});
        ImGui::SameLine();
        ImGui::Text("%.1f s", *hand.recorded_s);
    } else {
        if (ImGui::SmallButton("Record the stylus")) actions.emplace_back(RecordStylus{});
        hint("Records motion and forces of the stylus to a file next to the session, for a bug report or for replay.");
    }
    if (hand.recording.empty()) return;
    ImGui::PushStyleColor(ImGuiCol_Text, ThemeColor{ColorRole::faint_text});
    ImGui::TextWrapped("%s", hand.recording.c_str());
    ImGui::PopStyleColor();
}

}  // namespace

void device_section(const Model& model, Actions& actions)
{
    if (!model.hand) return;
    const HandView& hand = *model.hand;
    ImGui::Separator();
    device_list(model, hand, actions);
    puck(model, hand, actions);
    if (hand.moves_probe) {
        ImGui::SameLine();
        if (ImGui::SmallButton("Calibrate")) actions.emplace_back(CalibrateDevice{});
        hint("Put the stylus into its holder first.");
    }
    if (model.servo) {
        for (const Finding& finding : findings_of(hand, *model.servo, model.session.probe.guided)) said(finding);
        figures(model, hand, *model.servo);
    } else if (!hand.trouble.empty()) {
        said({Weight::warning, hand.trouble});
    }
    recording(hand, actions);
}

}  // namespace shvr::ui
