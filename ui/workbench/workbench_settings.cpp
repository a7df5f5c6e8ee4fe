// Settings: how they change, what follows from it, and which of it becomes a step of the history.

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/session/quality.h"
#include "engine/session/session_patch.h"
#include "ui/workbench/bindings/tools.h"
#include "ui/workbench/edit.h"
#include "ui/workbench/lists/group_steps.h"
#include "ui/workbench/workbench.h"

namespace shvr::ui {

namespace {

std::string name_of(StereoOutput output)
{
    switch (output) {
        case StereoOutput::side_by_side: return "side by side";
        case StereoOutput::top_bottom: return "one above the other";
        case StereoOutput::anaglyph: return "for red and cyan glasses";
    }
    return {};
}

std::string sentence_about(const ViewSettings& view)
{
    switch (view.arrangement) {
        case Arrangement::single: return "Single view";
        case Arrangement::stereo: return "Two eyes: " + name_of(view.stereo.output);
        case Arrangement::overview: return "Overview: drag in a map to move the camera";
        case Arrangement::slices: return "Slices through the probe: the wheel moves a slice";
    }
    return {};
}

std::string sentence_about_group(const Session& session)
{
    const uint8_t group = session.probe.brush.group;
    if (group == 0) return "Eraser: painting removes voxels from their group";
    return sentence("Group ", int(group), ": ", group_of(session.groups, group).name);
}

std::string sentence_about_solo(const Session& session)
{
    const std::optional<uint8_t> solo = session.view.solo;
    if (!solo) return "All groups that are visible are drawn";
    return *solo == 0 ? std::string("Only what no group holds is drawn")
                      : sentence("Only group ", int(*solo), " is drawn: ", group_of(session.groups, *solo).name);
}

/// How far all points were moved, where that is all.
std::optional<double> shift_between(const TransferFunction& was, const TransferFunction& is)
{
    const auto before = was.points(), after = is.points();
    if (before.size() != after.size() || before.empty()) return std::nullopt;
    const double shift = after[0].intensity - before[0].intensity;
    for (size_t i = 0; i < before.size(); ++i) {
        const bool is_same_look = after[i].color == before[i].color && after[i].opacity == before[i].opacity;
        const double moved = after[i].intensity - before[i].intensity;
        if (!is_same_look || std::abs(moved - shift) > 1e-6 * std::max(1.0, std::abs(shift))) return std::nullopt;
    }
    return shift;
}

std::string sentence_about(const TransferFunction& was, const TransferFunction& is)
{
    const std::optional<double> shift = shift_between(was, is);
    if (shift) return sentence("Transfer function shifted by ", *shift);
    return sentence("Transfer function of ", is.points().size(), " points, from ", is.lower(), " to ", is.upper());
}

/// How the light that arrives is mapped to what is seen.
std::string sentence_about(const OcclusionSettings& was, const OcclusionSettings& is)
{
    const auto &before = was.mapping, &after = is.mapping;
    const std::string off = is.strength > 0.0 ? "" : "; occlusion is off, its strength is 0";
    if (after.empty()) return "Occlusion curve: a power again" + off;
    if (before.size() != after.size())
        return sentence("Occlusion curve: ",
                        before.empty()                 ? "points from now on"
                        : before.size() < after.size() ? "a point added"
                                                       : "a point removed",
                        ", ", after.size(), " of them", off);
    const auto [old, moved] = std::ranges::mismatch(before, after);
    const auto percent = [](double share) { return sentence(std::round(100.0 * share), " %"); };
    return sentence("Occlusion curve, point ", moved - after.begin() + 1, ": where ", percent(moved->arrives),
                    " of the light arrives, ", percent(moved->seen), " is seen", off);
}

/// Empty where only numbers changed, which say enough themselves.
std::string sentence_about(const FeelSettings& was, const FeelSettings& is)
{
    if (was.mode != is.mode) {
        switch (is.mode) {
            case TouchMode::proximity: return "Touching: pulled to the middle of all that is near";
            case TouchMode::surface: return "Touching: held on surfaces, until you pull towards yourself";
            case TouchMode::object: return "Touching: follows the object first touched, and no neighbour";
        }
    }
    if (was.strength != is.strength) return sentence("Strength ", std::round(100.0 * is.strength), " %");
    if (was.groups != is.groups && is.groups.empty()) return "Everything at or above the haptic threshold is felt";
    if (was.plane != is.plane)
        return is.plane == TouchPlane::none ? std::string("The probe moves freely")
                                            : sentence("The probe stays in its plane across ", spelled(is.plane));
    if (was.at_proxy != is.at_proxy)
        return is.at_proxy ? "Tools act at the middle of what is touched" : "Tools act at the probe";
    if (was.to_nodes != is.to_nodes)
        return is.to_nodes ? "Tools act at a node in the probe's ball" : "Nodes draw no tool";
    if (was.to_lines != is.to_lines)
        return is.to_lines ? "Tools act on a centre line in the probe's ball, and a new node divides it"
                           : "Centre lines draw no tool";
    if (was.clicks != is.clicks)
        return is.clicks ? "A haptic device clicks where contact begins" : "Contact begins without a click";
    return {};
}

/// Changes for which there is more to say than what was set.
std::string special_sentence(const Session& was, const Session& is)
{
    const ProbeSettings &before = was.probe, &after = is.probe;
    if (was.view.arrangement != is.view.arrangement) return sentence_about(is.view);
    if (before.brush.group != after.brush.group) return sentence_about_group(is);
    if (before.brush.brush != after.brush.brush) return sentence("Brush: ", row_of(after.brush.brush).name);
    if (before.tool != after.tool) return sentence_of(after.tool);
    if (before.guided != after.guided)
        return after.guided ? "Guidance on: the probe is pulled to what is at or above the haptic threshold"
                            : "Guidance off";
    if (before.guidance != after.guidance)
        return after.guidance == Guidance::potential ? "Guidance: smooth"
               : after.guidance == Guidance::mean    ? "Guidance: mean of what is relevant"
                                                     : "Guidance: mean of 3000 random points";
    if (before.touch != after.touch) return sentence_about(before.touch, after.touch);
    if (before.shell != after.shell)
        return after.shell ? "Iso-surface around the probe on, at the paint threshold"
                           : "Iso-surface around the probe off";
    if (before.preview != after.preview)
        return after.preview ? "Preview of the brush on: what it would change is shown" : "Preview of the brush off";
    if (before.arrow != after.arrow) return after.arrow ? "Arrow towards the probe on" : "Arrow towards the probe off";
    if (before.silhouette != after.silhouette)
        return after.silhouette ? "Silhouette of the probe on" : "Silhouette of the probe off";
    if (was.view.volume != is.view.volume)
        return is.view.volume ? "The volume is drawn" : "The volume is not drawn, except in slices";
    if (was.view.meshes != is.view.meshes)
        return is.view.meshes ? "Nodes, internodes and the probe's ball are drawn"
                              : "Nodes, internodes and the probe's ball are not drawn";
    if (was.view.cut_box != is.view.cut_box)
        return is.view.cut_box ? "The edges of the cutting planes are drawn"
                               : "The edges of the cutting planes are not drawn";
    if (was.view.solo != is.view.solo) return sentence_about_solo(is);
    if (was.interaction.workspace_scale != is.interaction.workspace_scale)
        return sentence("Workspace scale ", std::round(100.0 * is.interaction.workspace_scale) / 100.0,
                        ": so much farther the probe goes than at 1");
    if (!(was.transfer_function == is.transfer_function))
        return sentence_about(was.transfer_function, is.transfer_function);
    if (const auto quality = quality_of(is.render); quality && was.render != is.render)
        return sentence("Render quality: ", quality->name);
    if (was.light.occlusion.mapping != is.light.occlusion.mapping)
        return sentence_about(was.light.occlusion, is.light.occlusion);
    if (was.light.shaded != is.light.shaded) return is.light.shaded ? "Shading on" : "Shading off";
    if (was.render.preintegration != is.render.preintegration)
        return is.render.preintegration ? "Narrow peaks on: none is missed between samples"
                                        : "Narrow peaks off: samples may miss them";
    return {};
}

/// Whether pictures of the volume are the same: these settings are drawn over them, or not at all.
bool look_the_same(Session before, const Session& after)
{
    before.probe = after.probe;  // which is drawn by itself, as distances are
    before.measurements = after.measurements;
    if (!shows_occlusion(before.light) && !shows_occlusion(after.light)) before.light.occlusion = after.light.occlusion;
    return before == after;
}

}  // namespace

void Workbench::act(const Set& action)
{
    if (action.patch.empty()) return log_instead({Set{"{}"}});  // a key for what is so already
    Session after = patched(document_->session, action.patch);
    if (!after.transfer_preset.empty())
        after.transfer_function = transfer_function_of(transfer_preset_named(std::exchange(after.transfer_preset, {})),
                                                       document_->statistics);
    document_->choose_thresholds(after);
    document_->choose_for_volume(after);
    const Session before = document_->session;
    take_session(std::move(after));
    if (is_hand_down_ && !session_before_hand_) session_before_hand_ = before;
    const Session& since = session_before_hand_ ? *session_before_hand_ : before;
    std::string said = special_sentence(since, document_->session);
    if (said.empty()) said = difference_in_words(since, document_->session);
    if (!said.empty()) say(std::move(said));
}

void Workbench::act(const NewGroup&)
{
    const uint8_t next = unused_group(model());
    if (next == 0) fail("all 255 groups are in use; expected one that nothing is painted, traced or described with");
    act(edited(document_->session, [&](Session& s) {
        s.groups[next].name = group_of(s.groups, next).name;
        s.probe.brush.group = next;
    }));
}

void Workbench::act(const EndStep&)
{
    record_settings();
}

void Workbench::take_session(Session session)
{
    Document& document = *document_;
    Session before = std::exchange(document.session, std::move(session));
    const Session& after = document.session;
    try {
        settings_changed(before);
    } catch (...) {
        document.session = before;
        throw;
    }
    note_edit();
    if (!look_the_same(std::move(before), after)) look_again();
}

/// Updates the window's data about the trace; the annotator passes changes to the scene itself.
void Workbench::show_changes(const Command& command)
{
    Document& document = *document_;
    const bool is_traced = std::ranges::any_of(
        command.changes, [](const Change& change) { return std::holds_alternative<TraceChange>(change); });
    if (is_traced) document.drags_node = false;
    const bool is_set = std::ranges::any_of(
        command.changes, [](const Change& change) { return std::holds_alternative<SettingChange>(change); });
    if (!is_set) return;
    const Session before = document.session;
    document.take_settings();
    if (!look_the_same(before, document.session)) look_again();
}

/// What follows from settings beside another picture.
void Workbench::settings_changed(const Session& before)
{
    Document& document = *document_;
    const Session& after = document.session;
    if (before.render.sampling != after.render.sampling || before.render.paging != after.render.paging) {
        want_reload(before.render);
    } else if (before.groups != after.groups) {
        renderer_.scene().show_surfaces(document.surfaces, document.annotator.document().trace, after.groups);
    }
    constexpr double CUT_GLOW_S = 1.5;
    if (before.cut != after.cut) cut_shown_until_s_ = options_.now_s() + CUT_GLOW_S;
    if (before.probe.tool != after.probe.tool) {
        if (document.annotator.stroke_is_open()) document.annotator.end_stroke();
        if (document.drags_node) act(DragNode{false});
        document.measuring_from.reset();
    }
}

/// View, probe and the like go into the journal when the hand rests, and every few seconds while it does not.
void Workbench::note_to_keep()
{
    last_change_s_ = options_.now_s();
    if (!to_keep_since_s_) to_keep_since_s_ = last_change_s_;
}

void Workbench::follow_view()
{
    constexpr double REST_S = 0.2, LONGEST_S = 5.0;
    const double now = options_.now_s();
    if (!to_keep_since_s_ || (now - last_change_s_ < REST_S && now - *to_keep_since_s_ < LONGEST_S)) return;
    to_keep_since_s_.reset();
    document_->keep_settings();
}

void Workbench::note_edit()
{
    note_to_keep();
    document_->note_edit();
    settings_to_record_ = was_set_in_this_turn_ = true;
}

/// Makes a step of the history of what was set, once the hand has let go: one drag is one step.
void Workbench::follow_settings()
{
    const bool is_being_set = std::exchange(was_set_in_this_turn_, false) || is_hand_down_;
    if (!is_hand_down_) session_before_hand_.reset();
    if (!settings_to_record_ || is_being_set) return;
    record_settings();
}

/// Of what follows, undo is to take back that first.
void Workbench::record_settings()
{
    if (document_->annotator.stroke_is_running() || document_->annotator.work().is_saving_as()) return;
    settings_to_record_ = false;
    if (document_->record_settings() && log_) log_(line_of(EndStep{}));
}

}  // namespace shvr::ui
