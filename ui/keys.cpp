#include "ui/keys.h"

#include <algorithm>
#include <cmath>

#include <GLFW/glfw3.h>

#include "ui/trace_ops.h"

namespace shvr::ui {

namespace {

// Step sizes of a tap.
constexpr double TURN_DEGREES = 3.0;
constexpr double MOVE_HEIGHTS = 0.05;
constexpr double CUT_SHARE = 0.01;
constexpr double CLIP_SHARE = 0.01;
constexpr double PROBE_FACTOR = 1.1;

constexpr double SLOWED = 0.2;
constexpr double BLEND_STEP = 0.05;
constexpr double MAX_BLEND = 20.0;
constexpr double TAPS_PER_SECOND = 5.0;  ///< of a held key
constexpr double LONGEST_FRAME_S = 0.5;  ///< after a hung frame a held key must not throw the view far away
constexpr int MODIFIERS = GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SHIFT;  ///< not Caps Lock and other locks

// ---- Key actions. Those with parameters appear several times in the table.

Action undo(const Model&, double)
{
    return Undo{};
}

Action redo(const Model&, double)
{
    return Redo{};
}

template <uint8_t GROUP>
Action choose(const Model&, double)
{
    return ChooseGroup{GROUP};
}

Action next_brush(const Model& model, double)
{
    BrushSettings brush = model.brush();
    brush.brush = BRUSHES[(size_t(brush.brush) + 1) % BRUSHES.size()].brush;
    return SetBrush{brush};
}

template <int DIRECTION>
Action scale_probe(const Model&, double amount)
{
    return ScaleProbe{std::pow(PROBE_FACTOR, DIRECTION * amount)};
}

template <Arrangement ARRANGEMENT>
Action arrange(const Model& model, double)
{
    ViewSettings view = model.session.view;
    view.arrangement = ARRANGEMENT;
    return SetView{view};
}

Action next_law(const Model& model, double)
{
    return SetProxyLaw{model.law == ProxyLaw::potential ? ProxyLaw::mean : ProxyLaw::potential};
}

template <int RIGHT, int UP, int FORWARD>
Action move(const Model&, double amount)
{
    return Move{MOVE_HEIGHTS * amount * glm::dvec3(RIGHT, UP, FORWARD)};
}

template <int RIGHT, int UP>
Action orbit(const Model&, double amount)
{
    return Orbit{TURN_DEGREES * RIGHT * amount, TURN_DEGREES * UP * amount};
}

template <int DIRECTION>
Action roll(const Model&, double amount)
{
    return Roll{TURN_DEGREES * DIRECTION * amount};
}

enum class Plane { lower, upper };

template <int AXIS, Plane PLANE, int DIRECTION>
Action move_cut(const Model&, double amount)
{
    return MoveCut{AXIS, PLANE == Plane::upper, CUT_SHARE * DIRECTION * amount};
}

template <bool FAR, int DIRECTION>
Action move_clip(const Model&, double amount)
{
    return MoveClip{FAR, CLIP_SHARE * DIRECTION * amount};
}

/// Steps of a twentieth; snaps values near 0 to 0, which costs nothing to render.
double stepped(double value, double amount)
{
    const double next = std::clamp(value + BLEND_STEP * amount, 0.0, MAX_BLEND);
    return next < 1e-9 ? 0.0 : next;
}

template <int DIRECTION>
Action blend_size(const Model& model, double amount)
{
    DistanceBlend blend = model.session.blend;
    blend.size = stepped(blend.size, DIRECTION * amount);
    return SetBlend{blend};
}

template <int DIRECTION>
Action blend_rate(const Model& model, double amount)
{
    DistanceBlend blend = model.session.blend;
    blend.rate = stepped(blend.rate, DIRECTION * amount);
    return SetBlend{blend};
}

template <uint8_t GROUP>
Action regroup(const Model&, double)
{
    return Trace{GroupOp{GROUP}};
}

template <int DIRECTION>
Action scale_selected(const Model& model, double amount)
{
    return Trace{scaled(model, std::pow(PROBE_FACTOR, DIRECTION * amount))};
}

template <int DIRECTION>
Action scale_nodes(const Model& model, double amount)
{
    return Trace{scaled_nodes_of_group(model, std::pow(PROBE_FACTOR, DIRECTION * amount))};
}

// ---- The table

using Act = Action (*)(const Model&, double);

/// A key that acts once per press.
constexpr KeyBinding tap(int key, int mods, const char* group, const char* name, Act action)
{
    return {.key = key, .mods = mods, .group = group, .name = name, .action = action};
}

/// A key that acts once per press, and by a fifth with Shift.
constexpr KeyBinding step(int key, int mods, const char* group, const char* name, Act action)
{
    return {.key = key, .mods = mods, .is_slowed = true, .group = group, .name = name, .action = action};
}

/// A key that acts while held, and slowly with Shift.
constexpr KeyBinding hold(int key, int mods, const char* group, const char* name, Act action)
{
    return {
        .key = key, .mods = mods, .is_slowed = true, .repeats = true, .group = group, .name = name, .action = action};
}

constexpr int CTRL = GLFW_MOD_CONTROL, ALT = GLFW_MOD_ALT, SHIFT = GLFW_MOD_SHIFT;
constexpr const char *WORK = "Work", *PAINTING = "Painting", *TRACING = "Tracing", *PROBE = "Probe", *VIEWS = "Views",
                     *TURN = "Turn the view", *MOVE = "Move the view", *CUT = "Cutting planes", *CLIP = "Clip planes",
                     *BLEND = "Distance blending";

constexpr KeyBinding BINDINGS[] = {
    tap(GLFW_KEY_Z, CTRL, WORK, "Undo", undo),
    tap(GLFW_KEY_Z, CTRL | SHIFT, WORK, "Redo", redo),
    tap(GLFW_KEY_S, CTRL, WORK, "Save", [](const Model&, double) -> Action { return Save{}; }),
    tap(GLFW_KEY_P, 0, WORK, "Screenshot", [](const Model&, double) -> Action { return Screenshot{}; }),
    tap(GLFW_KEY_P, CTRL, WORK, "Large screenshot", [](const Model&, double) -> Action { return Screenshot{true}; }),
    tap(GLFW_KEY_F8, 0, WORK, "Update ambient occlusion",
        [](const Model&, double) -> Action { return UpdateOcclusion{}; }),
    tap(GLFW_KEY_F12, 0, WORK, "Keys and mouse",
        [](const Model& m, double) -> Action { return ShowHelp{!m.shows_help}; }),
    tap(GLFW_KEY_Q, CTRL, WORK, "Quit", [](const Model&, double) -> Action { return Quit{}; }),

    tap(GLFW_KEY_F6, 0, VIEWS, "Slices", arrange<Arrangement::slices>),
    tap(GLFW_KEY_F9, 0, VIEWS, "Overview", arrange<Arrangement::overview>),
    tap(GLFW_KEY_F10, 0, VIEWS, "Full screen", arrange<Arrangement::single>),
    tap(GLFW_KEY_F11, 0, VIEWS, "Two eyes", arrange<Arrangement::stereo>),

    // The application begins and ends the stroke.
    tap(GLFW_KEY_F, 0, PAINTING, "Paint while held", nullptr),
    tap(GLFW_KEY_F5, 0, PAINTING, "Preview of the brush",
        [](const Model& m, double) -> Action { return ShowPreview{!m.session.probe.preview}; }),
    tap(GLFW_KEY_0, 0, PAINTING, "Eraser", choose<0>),
    tap(GLFW_KEY_1, 0, PAINTING, "Group 1", choose<1>),
    tap(GLFW_KEY_2, 0, PAINTING, "Group 2", choose<2>),
    tap(GLFW_KEY_3, 0, PAINTING, "Group 3", choose<3>),
    tap(GLFW_KEY_4, 0, PAINTING, "Group 4", choose<4>),
    tap(GLFW_KEY_5, 0, PAINTING, "Group 5", choose<5>),
    tap(GLFW_KEY_6, 0, PAINTING, "Group 6", choose<6>),
    tap(GLFW_KEY_7, 0, PAINTING, "Group 7", choose<7>),
    tap(GLFW_KEY_8, 0, PAINTING, "Group 8", choose<8>),
    tap(GLFW_KEY_9, 0, PAINTING, "Group 9", choose<9>),
    tap(GLFW_KEY_END, 0, PAINTING, "Next brush", next_brush),
    hold(GLFW_KEY_RIGHT_BRACKET, 0, PAINTING, "Larger brush", scale_probe<1>),
    hold(GLFW_KEY_LEFT_BRACKET, 0, PAINTING, "Smaller brush", scale_probe<-1>),

    tap(GLFW_KEY_X, 0, TRACING, "Paint or trace",
        [](const Model& m, double) -> Action { return SetTool{m.tool == Tool::paint ? Tool::trace : Tool::paint}; }),
    tap(GLFW_KEY_N, 0, TRACING, "Add a node, linked with the selected one",
        [](const Model& m, double) -> Action { return Trace{node_at_probe(m)}; }),
    // The application begins and ends it.
    tap(GLFW_KEY_M, 0, TRACING, "Move the selected node while held", nullptr),
    tap(GLFW_KEY_COMMA, 0, TRACING, "Link the selected node with the nearest",
        [](const Model& m, double) -> Action { return Trace{link_with_nearest(m)}; }),
    tap(GLFW_KEY_PERIOD, 0, TRACING, "Select the nearest node, then its internode",
        [](const Model& m, double) -> Action { return Trace{nearest_selection(m)}; }),
    tap(GLFW_KEY_PERIOD, SHIFT, TRACING, "Select the whole segment",
        [](const Model&, double) -> Action { return Trace{SelectSegmentOp{}}; }),
    tap(GLFW_KEY_SLASH, 0, TRACING, "Deselect", [](const Model&, double) -> Action { return Trace{DeselectOp{}}; }),
    tap(GLFW_KEY_DELETE, 0, TRACING, "Delete what is selected",
        [](const Model&, double) -> Action { return Trace{DeleteOp{}}; }),
    step(GLFW_KEY_EQUAL, 0, TRACING, "Larger selected nodes, or internodes of the group", scale_selected<1>),
    step(GLFW_KEY_MINUS, 0, TRACING, "Smaller selected nodes, or internodes of the group", scale_selected<-1>),
    step(GLFW_KEY_EQUAL, ALT, TRACING, "Larger nodes of the group", scale_nodes<1>),
    step(GLFW_KEY_MINUS, ALT, TRACING, "Smaller nodes of the group", scale_nodes<-1>),
    tap(GLFW_KEY_1, CTRL, TRACING, "Selected to group 1", regroup<1>),
    tap(GLFW_KEY_2, CTRL, TRACING, "Selected to group 2", regroup<2>),
    tap(GLFW_KEY_3, CTRL, TRACING, "Selected to group 3", regroup<3>),
    tap(GLFW_KEY_4, CTRL, TRACING, "Selected to group 4", regroup<4>),
    tap(GLFW_KEY_5, CTRL, TRACING, "Selected to group 5", regroup<5>),
    tap(GLFW_KEY_6, CTRL, TRACING, "Selected to group 6", regroup<6>),
    tap(GLFW_KEY_7, CTRL, TRACING, "Selected to group 7", regroup<7>),
    tap(GLFW_KEY_8, CTRL, TRACING, "Selected to group 8", regroup<8>),
    tap(GLFW_KEY_9, CTRL, TRACING, "Selected to group 9", regroup<9>),

    tap(GLFW_KEY_SPACE, 0, PROBE, "Guide the probe",
        [](const Model& m, double) -> Action { return Assist{!m.assistance}; }),
    tap(GLFW_KEY_F4, 0, PROBE, "Iso-surface around the probe",
        [](const Model& m, double) -> Action {
            return ShowShell{!m.session.probe.shell, m.session.probe.shell_opacity};
        }),
    tap(GLFW_KEY_HOME, 0, PROBE, "Next kind of guidance", next_law),
    hold(GLFW_KEY_PAGE_UP, 0, PROBE, "Larger probe", scale_probe<1>),
    hold(GLFW_KEY_PAGE_DOWN, 0, PROBE, "Smaller probe", scale_probe<-1>),

    hold(GLFW_KEY_W, ALT, TURN, "Turn up", orbit<0, 1>),
    hold(GLFW_KEY_S, ALT, TURN, "Turn down", orbit<0, -1>),
    hold(GLFW_KEY_A, ALT, TURN, "Turn left", orbit<-1, 0>),
    hold(GLFW_KEY_D, ALT, TURN, "Turn right", orbit<1, 0>),
    hold(GLFW_KEY_Q, ALT, TURN, "Roll left", roll<-1>),
    hold(GLFW_KEY_E, ALT, TURN, "Roll right", roll<1>),

    hold(GLFW_KEY_W, 0, MOVE, "Move forward", move<0, 0, 1>),
    hold(GLFW_KEY_S, 0, MOVE, "Move back", move<0, 0, -1>),
    hold(GLFW_KEY_A, 0, MOVE, "Move left", move<-1, 0, 0>),
    hold(GLFW_KEY_D, 0, MOVE, "Move right", move<1, 0, 0>),
    hold(GLFW_KEY_Q, 0, MOVE, "Move down", move<0, -1, 0>),
    hold(GLFW_KEY_E, 0, MOVE, "Move up", move<0, 1, 0>),

    hold(GLFW_KEY_Y, 0, CUT, "Near x cut inwards", move_cut<0, Plane::lower, 1>),
    hold(GLFW_KEY_Y, CTRL, CUT, "Near x cut outwards", move_cut<0, Plane::lower, -1>),
    hold(GLFW_KEY_U, 0, CUT, "Near y cut inwards", move_cut<1, Plane::lower, 1>),
    hold(GLFW_KEY_U, CTRL, CUT, "Near y cut outwards", move_cut<1, Plane::lower, -1>),
    hold(GLFW_KEY_I, 0, CUT, "Near z cut inwards", move_cut<2, Plane::lower, 1>),
    hold(GLFW_KEY_I, CTRL, CUT, "Near z cut outwards", move_cut<2, Plane::lower, -1>),
    hold(GLFW_KEY_H, 0, CUT, "Far x cut inwards", move_cut<0, Plane::upper, -1>),
    hold(GLFW_KEY_H, CTRL, CUT, "Far x cut outwards", move_cut<0, Plane::upper, 1>),
    hold(GLFW_KEY_J, 0, CUT, "Far y cut inwards", move_cut<1, Plane::upper, -1>),
    hold(GLFW_KEY_J, CTRL, CUT, "Far y cut outwards", move_cut<1, Plane::upper, 1>),
    hold(GLFW_KEY_K, 0, CUT, "Far z cut inwards", move_cut<2, Plane::upper, -1>),
    hold(GLFW_KEY_K, CTRL, CUT, "Far z cut outwards", move_cut<2, Plane::upper, 1>),

    hold(GLFW_KEY_T, 0, BLEND, "More distance blending", blend_size<1>),
    hold(GLFW_KEY_T, CTRL, BLEND, "Less distance blending", blend_size<-1>),
    hold(GLFW_KEY_R, 0, BLEND, "Blending sets in later", blend_rate<1>),
    hold(GLFW_KEY_R, CTRL, BLEND, "Blending sets in sooner", blend_rate<-1>),

    hold(GLFW_KEY_C, 0, CLIP, "Near clip plane away", move_clip<false, 1>),
    hold(GLFW_KEY_C, CTRL, CLIP, "Near clip plane closer", move_clip<false, -1>),
    hold(GLFW_KEY_V, 0, CLIP, "Far clip plane closer", move_clip<true, -1>),
    hold(GLFW_KEY_V, CTRL, CLIP, "Far clip plane away", move_clip<true, 1>),
};

/// The modifiers are exactly the binding's; if Shift slows the binding, it may be down or not.
bool mods_match(const KeyBinding& binding, int mods)
{
    const int counted = binding.is_slowed ? MODIFIERS & ~GLFW_MOD_SHIFT : MODIFIERS;
    return (mods & counted) == binding.mods;
}

double rate(const KeyBinding& binding, int mods)
{
    return binding.is_slowed && (mods & GLFW_MOD_SHIFT) ? SLOWED : 1.0;
}

/// Bindings that the keyboard's auto-repeat may trigger: single steps of the history.
bool steps_through_history(const KeyBinding& binding)
{
    return binding.action == undo || binding.action == redo;
}

int mods_held(const Window& window)
{
    const auto either = [&](int left, int right, int mod) {
        return window.is_down(left) || window.is_down(right) ? mod : 0;
    };
    return either(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL, GLFW_MOD_CONTROL) |
           either(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT, GLFW_MOD_ALT) |
           either(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT, GLFW_MOD_SHIFT);
}

std::string name_of_key(int key)
{
    switch (key) {
        case GLFW_KEY_SPACE: return "Space";
        case GLFW_KEY_DELETE: return "Delete";
        case GLFW_KEY_HOME: return "Home";
        case GLFW_KEY_END: return "End";
        case GLFW_KEY_PAGE_UP: return "Page Up";
        case GLFW_KEY_PAGE_DOWN: return "Page Down";
        default: break;
    }
    if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F25) return "F" + std::to_string(key - GLFW_KEY_F1 + 1);
    return std::string(1, char(key));  // GLFW's codes of printable keys are ASCII
}

}  // namespace

std::span<const KeyBinding> key_bindings()
{
    return BINDINGS;
}

std::string name_of(const KeyBinding& binding)
{
    std::string name;
    if (binding.mods & GLFW_MOD_CONTROL) name += "Ctrl + ";
    if (binding.mods & GLFW_MOD_ALT) name += "Alt + ";
    if (binding.mods & GLFW_MOD_SHIFT) name += "Shift + ";
    return name + name_of_key(binding.key);
}

void key_pressed(const KeyEvent& event, const Model& model, Actions& actions)
{
    if (!event.pressed) return;
    for (const KeyBinding& binding : key_bindings()) {
        if (!binding.action || binding.key != event.key || !mods_match(binding, event.mods)) continue;
        if (event.repeated && !steps_through_history(binding)) continue;
        actions.push_back(binding.action(model, rate(binding, event.mods)));
    }
}

void keys_held(const Window& window, double seconds, const Model& model, Actions& actions)
{
    const int mods = mods_held(window);
    const double taps = TAPS_PER_SECOND * std::clamp(seconds, 0.0, LONGEST_FRAME_S);
    for (const KeyBinding& binding : key_bindings()) {
        if (!binding.repeats || !window.is_down(binding.key) || !mods_match(binding, mods)) continue;
        // After Ctrl + S, a hand that lets go of Ctrl first holds S for a moment.
        if (!mods_match(binding, window.mods_of_press(binding.key))) continue;
        actions.push_back(binding.action(model, taps * rate(binding, mods)));
    }
}

}  // namespace shvr::ui
