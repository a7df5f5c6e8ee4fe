#include "engine/workbench/bindings/hints.h"

#include "engine/base/error.h"

namespace shvr::ui {

std::string key_in_brackets(const char* id, const Keymap& keymap)
{
    const Shortcut* const shortcut = shortcut_named(id);
    SHVR_CHECK(shortcut, id);
    const std::string keys = keymap.text_of(*shortcut);
    return keys.empty() ? std::string() : " (" + keys + ")";
}

std::string name_with_key(const char* id, const Keymap& keymap)
{
    const std::string keys = key_in_brackets(id, keymap);
    return shortcut_named(id)->name + keys;
}

std::string first_hint(int number, const Keymap& keymap)
{
    const auto key = [&](const char* id) { return key_in_brackets(id, keymap); };
    switch (number) {
        case 0:
            return sentence(
                "Drag to turn the volume, and use the wheel to zoom. In the panel on the right, drag the curve's "
                "points until your structure appears. Fit",
                key("fit_view"), " brings the whole volume back into view.");
        case 1:
            return sentence("The bar at the top says what your next click does. Take Paint", key("tool_paint"),
                            " or Trace", key("tool_trace"),
                            ", choose a group next to it, and use the left button; the right button still turns.");
        default:
            return sentence("Everything can be undone", key("undo"), ", also settings, and is kept as you work. ",
                            "Find anything", key("palette"), " by its name; all keys are under Help", key("help"), ".");
    }
}

}  // namespace shvr::ui
