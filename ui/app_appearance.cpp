// Appearance of the interface and keyboard focus: theme, scale, fonts, and the use of panels by keyboard.

#include <algorithm>

#include <imgui/imgui.h>
#include <imgui/imgui_internal.h>

#include "engine/workbench/bindings/preferences_file.h"
#include "engine/workbench/models/preferences.h"
#include "ui/app.h"
#include "ui/panels/field_keys.h"
#include "ui/thumbnails/thumbnails.h"

namespace shvr::ui {

namespace {

/// Requests the characters of all names given by the user. Derived texts, such as history entries, add no characters.
void want_glyphs_of(const Model& model)
{
    want_glyphs(model.volume.name);
    want_glyphs(model.session_path.native());
    want_glyphs(model.holder);
    want_glyphs(model.outside);
    for (const auto& [group, settings] : model.session.groups) want_glyphs(settings.name);
    for (const auto& [name, camera] : model.session.cameras) want_glyphs(name);
    for (const std::filesystem::path& path : model.preferences.recent) want_glyphs(path.native());
}

/// Acts as if a navigation key had been pressed: frames the window's first item, which then gets the keyboard.
void give_keyboard_to(ImGuiWindow* window, ImGuiNavLayer layer)
{
    if (!window) return;
    ImGuiContext& context = *ImGui::GetCurrentContext();
    ImGui::FocusWindow(window);
    context.NavLayer = layer;
    ImGui::NavInitWindow(window, true);
    context.NavDisableHighlight = false;
    context.NavDisableMouseHover = true;
}

}  // namespace

/// Adapts style and fonts to the preferences, to the window's screen, and to names in other scripts. Between frames.
void App::follow_appearance()
{
    const Model now = bench_->model();
    want_glyphs_of(now);
    want_typed_glyphs();
    if (std::exchange(read_messages_, bench_->messages().count()) != bench_->messages().count())
        for (const Message& message : bench_->messages().all()) want_glyphs(message.text);
    const Preferences& preferences = now.preferences;
    const Appearance wanted{.theme = preferences.theme,
                            .font_pixels = preferences.font_pixels,
                            .scale = std::clamp(preferences.scale.value_or(window_.content_scale()),
                                                Preferences::MIN_SCALE, Preferences::MAX_SCALE)};
    if (wanted == appearance_ && !fonts_are_stale()) return;
    appearance_ = wanted;
    set_style(appearance_);
    window_.renew_fonts();
    keep_drawing(0.5);  // while panels settle into their new places
}

/// Puts the window where it was when it was closed last. The workbench reports preferences that are not valid.
void App::begin_at_kept_place()
{
    if (!options_.settings_folder.empty()) set_thumbnail_folder(options_.settings_folder / "pictures");
    if (!options_.keeps_place) return;
    try {
        const Preferences preferences = load_preferences(preferences_file(options_.settings_folder));
        const auto kept = preferences.layout.windows.find(MAIN_WINDOW);
        if (kept == preferences.layout.windows.end() || !kept->second.at || !kept->second.size) return;
        window_.put({glm::ivec2(*kept->second.at), glm::ivec2(*kept->second.size)});
    } catch (const Error&) {
    }
}

void App::keep_place()
{
    if (!options_.keeps_place) return;
    const Window::Place now = window_.place();
    const glm::dvec2 at(now.at), size(now.size);
    const auto& windows = bench_->model().preferences.layout.windows;
    const auto kept = windows.find(MAIN_WINDOW);
    if (kept != windows.end() && kept->second == WindowPlace{at, size}) return;
    static_cast<void>(bench_->apply(Prefer{patch_of_window(MAIN_WINDOW, at, size)}));
}

/// Call after panels or the menu were used by keyboard; otherwise, the framed item would react to the next Space key.
void App::leave_panels() const
{
    const bool has_popup = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    if (ImGui::GetIO().NavVisible && !has_popup && !field_has_keys()) ImGui::SetWindowFocus(nullptr);
}

/// Gives the keyboard to a panel or menu on request. Call inside a frame, when Dear ImGui knows its windows.
void App::follow_focus()
{
    const std::string what = bench_->take_focus();
    if (what == "panels") give_keyboard_to(ImGui::FindWindowByName(SIDE_PANEL), ImGuiNavLayer_Main);
    if (what == "menu") give_keyboard_to(ImGui::FindWindowByName("##MainMenuBar"), ImGuiNavLayer_Menu);
}

}  // namespace shvr::ui
