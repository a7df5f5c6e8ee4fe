#include "engine/workbench/words/settings_words.h"

#include <algorithm>
#include <cmath>

#include "engine/session/quality.h"
#include "engine/session/words/number_words.h"
#include "engine/session/words/setting_words.h"
#include "engine/workbench/bindings/tools.h"
#include "engine/workbench/words/touch_words.h"

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

/// Returns the distance by which all points were shifted; null if anything else was changed.
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

std::string sentence_about(const TransferFunction& was, const TransferFunction& is, const IntensityWords& intensity)
{
    const std::optional<double> shift = shift_between(was, is);
    if (shift)
        return "Transfer function shifted by " + (std::abs(*shift) < 1.0 ? number_in_words(*shift) : intensity(*shift));
    return sentence("Transfer function of ", is.points().size(), " points, from ", intensity(is.lower()), " to ",
                    intensity(is.upper()));
}

/// Describes a change of the curve from arriving ambient light to displayed light.
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

/// Describes a change of the settings of touch. Returns an empty text if only numbers changed, which need no words.
std::string sentence_about(const FeelSettings& was, const FeelSettings& is)
{
    if (was.mode != is.mode) return words_of(is.mode).sentence;
    if (was.strength != is.strength) return sentence("Strength ", std::round(100.0 * is.strength), " %");
    if (was.groups != is.groups && is.groups.empty()) return "Everything at or above the haptic threshold is felt";
    if (was.plane != is.plane) return words_of(is.plane).sentence;
    if (was.at_proxy != is.at_proxy)
        return is.at_proxy ? "Tools act at the middle of what is touched" : "Tools act at the probe";
    if (was.to_nodes != is.to_nodes)
        return is.to_nodes ? "Tools act at a node in the probe's ball" : "Nodes draw no tool";
    if (was.to_lines != is.to_lines)
        return is.to_lines ? "Tools act on a centre line in the probe's ball, and a new node divides it"
                           : "Centre lines draw no tool";
    if (was.feels_hidden != is.feels_hidden)
        return is.feels_hidden ? "What is cut away, hidden or transparent is felt, too"
                               : "Only what the picture shows is felt";
    if (was.clicks != is.clicks)
        return is.clicks ? "A haptic device clicks where contact begins" : "Contact begins without a click";
    return {};
}

/// Returns a sentence about a change of settings that needs more words than the new value; empty for other changes.
std::string special_sentence(const Session& was, const Session& is, const IntensityWords& intensity)
{
    const ProbeSettings &before = was.probe, &after = is.probe;
    if (was.view.arrangement != is.view.arrangement) return sentence_about(is.view);
    if (before.brush.group != after.brush.group) return sentence_about_group(is);
    if (before.brush.brush != after.brush.brush) return sentence("Brush: ", row_of(after.brush.brush).name);
    if (before.tool != after.tool) return sentence_of(after.tool);
    if (before.guided != after.guided)
        return after.guided ? "Guidance on: the probe is pulled to what is at or above the haptic threshold"
                            : "Guidance off";
    if (before.guidance != after.guidance) return words_of(after.guidance).sentence;
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
        return is.view.meshes ? "Nodes, internodes, meshes and the probe's ball are drawn"
                              : "Nodes, internodes, meshes and the probe's ball are not drawn";
    if (was.view.cut_box != is.view.cut_box)
        return is.view.cut_box ? "The clip box is drawn: drag its handles to cut"
                               : "The clip box is not drawn; it still cuts";
    if (was.view.plane_handles != is.view.plane_handles)
        return is.view.plane_handles ? "The oblique cutting plane is drawn with its handles, where there is one"
                                     : "The oblique cutting plane is not drawn; it still cuts";
    if (was.view.solo != is.view.solo) return sentence_about_solo(is);
    if (was.interaction.workspace_scale != is.interaction.workspace_scale) {
        const double scale = std::round(100.0 * is.interaction.workspace_scale) / 100.0;
        return sentence("Workspace scale ", scale, ": the probe moves ", scale, " times as far as at 1");
    }
    if (!(was.transfer_function == is.transfer_function))
        return sentence_about(was.transfer_function, is.transfer_function, intensity);
    if (was.render.paging != is.render.paging)
        return is.render.paging == Paging::always  ? "The volume is loaded in pieces, as the view needs them"
               : is.render.paging == Paging::never ? "The volume is loaded as a whole"
                                                   : "The volume is loaded in pieces only if it is too large otherwise";
    if (const auto quality = quality_of(is.render); quality && was.render != is.render)
        return sentence("Render quality: ", quality->name);
    if (was.light.occlusion.mapping != is.light.occlusion.mapping)
        return sentence_about(was.light.occlusion, is.light.occlusion);
    if (was.light.shaded != is.light.shaded) return is.light.shaded ? "Shading on" : "Shading off";
    if (was.render.preintegration != is.render.preintegration)
        return is.render.preintegration ? "Narrow peaks on: none is missed between samples"
                                        : "Narrow peaks off: samples may miss them";
    if (was.render.gradient != is.render.gradient)
        return is.render.gradient == Gradient::analytic ? "Gradient inside voxels: faster, and steps show at voxels"
                                                        : "Gradient over one voxel: smooth shading";
    if (was.render.exact_integral != is.render.exact_integral)
        return is.render.exact_integral ? "Exact integral on: light is integrated between borders of voxels"
                                        : "Exact integral off: light is sampled in steps";
    return {};
}

}  // namespace

IntensityWords::IntensityWords(VoxelType type, const ValueRange& range)
{
    constexpr double FEW_VALUES = 20.0;  // of which fractions matter
    are_whole_ = !is_float(type) && range.upper - range.lower > FEW_VALUES;
}

double IntensityWords::said(double intensity) const
{
    return are_whole_ ? std::round(intensity) : intensity;
}

std::string IntensityWords::operator()(double intensity) const
{
    return number_in_words(said(intensity));
}

Session IntensityWords::said(Session session) const
{
    const auto say = [this](std::optional<double>& intensity) {
        if (intensity) intensity = said(*intensity);
    };
    say(session.probe.brush.threshold);
    say(session.probe.haptic_threshold);
    say(session.view.slices.black);
    say(session.view.slices.white);
    if (session.probe.brush.density) say(session.probe.brush.density->offset);
    return session;
}

std::string change_in_words(const Session& was, const Session& is, const IntensityWords& intensity)
{
    std::string said = special_sentence(was, is, intensity);
    if (said.empty()) said = capitalised(difference_in_words(intensity.said(was), intensity.said(is)));
    // Intensities that differ by less than a whole number.
    return said.empty() ? capitalised(difference_in_words(was, is)) : said;
}

}  // namespace shvr::ui
