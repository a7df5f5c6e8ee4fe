#pragma once
// The preferences that are numbers, and the words for those that are choices, as the window of preferences and the
// palette show them. Any thread.

#include "engine/workbench/models/preferences.h"

namespace shvr::ui {

struct PreferenceNumber {
    const char* key = "";  ///< in the file of preferences
    const char* label = "";
    const char* unit = "";
    const char* hint = "";
    double least = 0.0, most = 0.0;
};
inline constexpr PreferenceNumber TEXT_SIZE{.key = "font_pixels",
                                            .label = "Text",
                                            .unit = "pixels",
                                            .hint = "Font size at a scale of 1.",
                                            .least = Preferences::MIN_FONT_PIXELS,
                                            .most = Preferences::MAX_FONT_PIXELS};
inline constexpr PreferenceNumber WINDOW_SCALE{.key = "scale",
                                               .label = "Scale",
                                               .unit = "times",
                                               .hint = "Size of everything except the picture.",
                                               .least = Preferences::MIN_SCALE,
                                               .most = Preferences::MAX_SCALE};
inline constexpr PreferenceNumber DEVICE_BUDGET{
    .key = "budget_device_mib",
    .label = "GPU memory",
    .unit = "MiB",
    .hint = "Device memory for volumes, pictures and paint. Applies from the next start.",
    .least = Preferences::MIN_BUDGET_MIB,
    .most = Preferences::MAX_BUDGET_MIB};
inline constexpr PreferenceNumber HOST_BUDGET{
    .key = "budget_host_mib",
    .label = "Memory",
    .unit = "MiB",
    .hint =
        "Main memory for bricks on their way to the device, from the next start; imports that need more are "
        "refused.",
    .least = Preferences::MIN_BUDGET_MIB,
    .most = Preferences::MAX_BUDGET_MIB};
inline constexpr PreferenceNumber PREFERENCE_NUMBERS[] = {TEXT_SIZE, WINDOW_SCALE, DEVICE_BUDGET, HOST_BUDGET};

constexpr const char* key_set_in_words(KeySet set)
{
    return set == KeySet::modern ? "usual" : "from the SHVR thesis";
}

}  // namespace shvr::ui
