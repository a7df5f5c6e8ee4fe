// The thesis's appendix C, typed from its pages, against the set of keys that is called after it. Its section 4.2.3
// gives the directions: W, S, A, D, Q, E move forward, backward, left, right, up and down.

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "engine/workbench/bindings/keymap.h"

using namespace shvr::ui;

namespace {

struct Printed {
    const char* key;         ///< as a chord
    const char* function;    ///< as printed
    const char* id;          ///< id of the shortcut in question
    bool is_slowed = false;  ///< "Shift - Slow Rate"
};

constexpr Printed APPENDIX_C[] = {
    // Annotation
    {"Ctrl+Z", "Undo", "undo"},
    {"Ctrl+Shift+Z", "Redo", "redo"},
    {"N", "Add Node", "add_node"},
    {"M", "Move Node", "drag_node"},
    {",", "Add Internode between Nearby and Selected Node", "link_nearest"},
    {".", "Select Nearby Node/Internode", "select_nearest"},
    {"/", "Deselect Selected Node/Internode", "deselect"},
    {"Delete", "Delete Selected Node/Internode", "delete_selected"},
    {"0", "Change Colour Group", "eraser"},
    {"1", "Change Colour Group", "group_1"},
    {"2", "Change Colour Group", "group_2"},
    {"3", "Change Colour Group", "group_3"},
    {"4", "Change Colour Group", "group_4"},
    {"5", "Change Colour Group", "group_5"},
    {"6", "Change Colour Group", "group_6"},
    {"7", "Change Colour Group", "group_7"},
    {"8", "Change Colour Group", "group_8"},
    {"9", "Change Colour Group", "group_9"},
    {"Ctrl+0", "Change Colour Group of Selected Node/Internode", "regroup_0"},
    {"Ctrl+1", "Change Colour Group of Selected Node/Internode", "regroup_1"},
    {"Ctrl+2", "Change Colour Group of Selected Node/Internode", "regroup_2"},
    {"Ctrl+3", "Change Colour Group of Selected Node/Internode", "regroup_3"},
    {"Ctrl+4", "Change Colour Group of Selected Node/Internode", "regroup_4"},
    {"Ctrl+5", "Change Colour Group of Selected Node/Internode", "regroup_5"},
    {"Ctrl+6", "Change Colour Group of Selected Node/Internode", "regroup_6"},
    {"Ctrl+7", "Change Colour Group of Selected Node/Internode", "regroup_7"},
    {"Ctrl+8", "Change Colour Group of Selected Node/Internode", "regroup_8"},
    {"Ctrl+9", "Change Colour Group of Selected Node/Internode", "regroup_9"},
    {"End", "Cycle Painting Modes", "next_brush"},
    {"]", "Increase Painting Size", "larger_brush"},
    {"[", "Decrease Painting Size", "smaller_brush"},
    // Interaction
    {"Space", "Toggle Haptic Assistance", "guide"},
    {"Home", "Cycle Haptic Modes", "next_mode"},
    {"PageUp", "Increase Probe Size", "larger_probe"},
    {"PageDown", "Decrease Probe Size", "smaller_probe"},
    // Navigation
    {"Alt+W", "Rotate View", "turn_up", true},
    {"Alt+S", "Rotate View", "turn_down", true},
    {"Alt+A", "Rotate View", "turn_left", true},
    {"Alt+D", "Rotate View", "turn_right", true},
    {"Alt+Q", "Rotate View", "roll_left", true},
    {"Alt+E", "Rotate View", "roll_right", true},
    {"W", "Translate View", "move_forward", true},
    {"S", "Translate View", "move_back", true},
    {"A", "Translate View", "move_left", true},
    {"D", "Translate View", "move_right", true},
    {"Q", "Translate View", "move_up", true},
    {"E", "Translate View", "move_down", true},
    {"R", "Increase Blend Rate", "later_blending", true},
    {"Ctrl+R", "Decrease Blend Rate", "sooner_blending", true},
    {"T", "Increase Blend Size", "more_blending", true},
    {"Ctrl+T", "Decrease Blend Size", "less_blending", true},
    {"Y", "Increase Near Cutting Planes", "near_x_in", true},
    {"U", "Increase Near Cutting Planes", "near_y_in", true},
    {"I", "Increase Near Cutting Planes", "near_z_in", true},
    {"Ctrl+Y", "Decrease Near Cutting Planes", "near_x_out", true},
    {"Ctrl+U", "Decrease Near Cutting Planes", "near_y_out", true},
    {"Ctrl+I", "Decrease Near Cutting Planes", "near_z_out", true},
    {"H", "Decrease Far Cutting Planes", "far_x_in", true},
    {"J", "Decrease Far Cutting Planes", "far_y_in", true},
    {"K", "Decrease Far Cutting Planes", "far_z_in", true},
    {"Ctrl+H", "Increase Far Cutting Planes", "far_x_out", true},
    {"Ctrl+J", "Increase Far Cutting Planes", "far_y_out", true},
    {"Ctrl+K", "Increase Far Cutting Planes", "far_z_out", true},
    {"F7", "Increase Workspace Scale", "larger_workspace"},
    {"Ctrl+F7", "Decrease Workspace Scale", "smaller_workspace"},
    // Visualization
    {"P", "Save Screenshot", "screenshot"},
    {"-", "Change Size of Selected Node, or of Internodes in Selected Colour Group", "smaller_selected", true},
    {"=", "Change Size of Selected Node, or of Internodes in Selected Colour Group", "larger_selected", true},
    {"Alt+-", "Change Size of All Nodes in Selected Colour Group", "smaller_nodes", true},
    {"Alt+=", "Change Size of All Nodes in Selected Colour Group", "larger_nodes", true},
    {"C", "Increase Near Clipping Plane", "near_clip_away", true},
    {"Ctrl+C", "Decrease Near Clipping Plane", "near_clip_closer", true},
    {"V", "Decrease Far Clipping Plane", "far_clip_closer", true},
    {"Ctrl+V", "Increase Far Clipping Plane", "far_clip_away", true},
    {"F1", "Toggle Arrow", "arrow"},
    {"F2", "Toggle Volumetric Rendering", "volume"},
    {"F3", "Toggle Mesh Objects", "meshes"},
    {"F4", "Toggle Thin Shell Iso-Surface", "shell"},
    {"F8", "Update Ambient Occlusion Volume", "update_occlusion"},
    {"F9", "Overview Viewing Mode", "overview"},
    {"F10", "Full Screen Viewing Mode", "single_view"},
    {"F11", "Stereoscopic Viewing Mode", "stereo"},
};

}  // namespace

// Kind (Window): the keys of the thesis
TEST_CASE("every key of the thesis's appendix C means in its set what is printed there")
{
    const Keymap thesis(KeySet::thesis);
    for (const Printed& printed : APPENDIX_C) {
        const std::string key = printed.key, function = printed.function;
        CAPTURE(key);
        CAPTURE(function);
        Chord chord = chord_of(printed.key).value();
        const Shortcut* const meant = thesis.shortcut_for(chord);
        REQUIRE(meant);
        CHECK(thesis.holders_of(chord).size() == 1);
        CHECK(std::string(meant->id) == printed.id);
        if (printed.is_slowed) CHECK(meant->is_slowed());
        if (!printed.is_slowed) continue;
        chord.shift = true;
        CHECK(thesis.shortcut_for(chord) == meant);
    }
}

TEST_CASE("no key and no shortcut stands in appendix C twice")
{
    std::map<std::string, int> keys, ids;
    for (const Printed& printed : APPENDIX_C) ++keys[printed.key], ++ids[printed.id];
    CHECK(keys.size() == std::size(APPENDIX_C));
    CHECK(ids.size() == std::size(APPENDIX_C));
}
