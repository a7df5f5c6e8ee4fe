// The start page, which is shown while nothing is open: what this is, what to open, and what was opened last.

#include <algorithm>
#include <filesystem>
#include <memory>
#include <mutex>
#include <thread>

#include <imgui/imgui.h>

#include "engine/remote/address.h"
#include "engine/workbench/bindings/hints.h"
#include "engine/workbench/models/preferences.h"
#include "engine/workbench/models/project_picture.h"
#include "ui/files/file_list.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"
#include "ui/thumbnails/thumbnails.h"

namespace shvr::ui {

namespace {

constexpr int COLUMNS = 4;
constexpr float WIDTH = 56.0f;  ///< in font sizes, as all lengths here
constexpr float BUTTON = 12.0f;

/// Returns whether a path no longer exists. The paths are checked in the background when the list changes. No caller
/// waits for the check, not even at exit: a network that does not answer takes minutes to fail.
bool is_gone(const std::filesystem::path& path, const std::vector<std::filesystem::path>& recent)
{
    struct Search {
        std::mutex mutex;
        std::vector<std::filesystem::path> gone;
    };
    static std::vector<std::filesystem::path> known;
    static auto search = std::make_shared<Search>();
    if (known != recent) {
        known = recent;
        search = std::make_shared<Search>();
        std::thread([search = search, recent] {
            for (const std::filesystem::path& each : recent) {
                std::error_code ignored;
                if (is_typed_address(each.string()) || std::filesystem::exists(each, ignored) ||
                    is_within_archive(each))
                    continue;
                const std::scoped_lock lock(search->mutex);
                search->gone.push_back(each);
            }
        }).detach();
    }
    const std::scoped_lock lock(search->mutex);
    return std::ranges::find(search->gone, path) != search->gone.end();
}

/// Draws the picture of a project, or the place of one. `gone`: the project is no longer there.
void picture(const std::filesystem::path& path, const ImVec2& begin, const ImVec2& end, bool gone)
{
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(begin, end, shade_of(ColorRole::chart));
    if (gone || draw_thumbnail(path, begin, end)) return;
    const char* const text = "no picture yet";
    const ImVec2 size = ImGui::CalcTextSize(text);
    list.AddText({0.5f * (begin.x + end.x - size.x), 0.5f * (begin.y + end.y - size.y)},
                 shade_of(ColorRole::faint_text), text);
}

/// Draws one of those opened last: its picture, its name and its folder; for a missing path, a cross that removes the
/// entry.
void card(const std::filesystem::path& path, bool gone, const ImVec2& size, Actions& actions)
{
    const ImGuiStyle& style = ImGui::GetStyle();
    const float line = ImGui::GetTextLineHeight(), cross = ImGui::GetFrameHeight();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec2 inner{at.x + style.FramePadding.x, at.y + style.FramePadding.x};
    const float width = size.x - 2.0f * style.FramePadding.x;
    ImGui::SetItemAllowOverlap();
    if (ImGui::Selectable("##recent", false,
                          gone ? ImGuiSelectableFlags_Disabled : ImGuiSelectableFlags_AllowItemOverlap, size))
        actions.push_back(Open{path});
    hint(path.c_str());
    const float height = width * float(PROJECT_PICTURE_HEIGHT) / float(PROJECT_PICTURE_WIDTH);
    picture(path, inner, {inner.x + width, inner.y + height}, gone);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const std::string name = path.filename().string() + (gone ? "   (gone)" : "");
    list.AddText({inner.x, inner.y + height + 2.0f}, shade_of(gone ? ColorRole::faint_text : ColorRole::text),
                 shortened(name, width).c_str());
    list.AddText({inner.x, inner.y + height + 2.0f + line}, shade_of(ColorRole::faint_text),
                 shortened(path.parent_path().string(), width).c_str());
    if (!gone) return;
    const ImVec2 next = ImGui::GetCursorScreenPos();
    ImGui::SetCursorScreenPos({inner.x + width - cross, inner.y});
    if (ImGui::Button("x", {cross, cross})) actions.push_back(ForgetRecent{path});
    hint("is no longer there: forget it");
    ImGui::SetCursorScreenPos(next);
}

/// Lists what was opened last as cards, which scroll where there is little room.
void recent_cards(const Model& model, Actions& actions)
{
    const auto& recent = model.preferences.recent;
    want_thumbnails(recent, ImGui::IsWindowAppearing());
    const ImGuiStyle& style = ImGui::GetStyle();
    const float room = ImGui::GetContentRegionAvail().x - style.ScrollbarSize;
    const float width = (room - float(COLUMNS - 1) * style.ItemSpacing.x) / float(COLUMNS);
    const float picture_height =
        (width - 2.0f * style.FramePadding.x) * float(PROJECT_PICTURE_HEIGHT) / float(PROJECT_PICTURE_WIDTH);
    const ImVec2 size{width, picture_height + 2.0f * ImGui::GetTextLineHeight() + 3.0f * style.FramePadding.x};
    const auto rows = float((recent.size() + COLUMNS - 1) / COLUMNS);
    const float most = std::max(ImGui::GetMainViewport()->WorkSize.y - 20.0f * ImGui::GetFontSize(), size.y);
    ImGui::BeginChild("recent", {0.0f, std::min(rows * (size.y + style.ItemSpacing.y), most)});
    for (size_t i = 0; i < recent.size(); ++i) {
        if (i % COLUMNS > 0) ImGui::SameLine();
        ImGui::PushID(int(i));
        card(recent[i], is_gone(recent[i], recent), size, actions);
        ImGui::PopID();
    }
    ImGui::EndChild();
}

/// Draws a button, and what it is for.
bool button_row(const char* name, const char* about)
{
    const bool is_pressed = ImGui::Button(name, {BUTTON * ImGui::GetFontSize(), 0.0f});
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("%s", about);
    return is_pressed;
}

/// Says what is being opened, or why the last attempt failed.
void state_of_opening(const Model& model)
{
    if (!model.opening.empty()) {
        ImGui::Spacing();
        ImGui::TextUnformatted(("Opening " + std::string(model.opening) + " ...").c_str());
    } else if (!model.open_failure.empty()) {
        ImGui::Spacing();
        ImGui::PushTextWrapPos(0.0f);
        ImGui::PushStyleColor(ImGuiCol_Text, WARNING);
        ImGui::TextUnformatted(std::string(model.open_failure).c_str());
        ImGui::PopStyleColor();
        ImGui::PopTextWrapPos();
    }
}

}  // namespace

void start_page(const Model& model, Actions& actions)
{
    const float font = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({std::min(WIDTH * font, ImGui::GetMainViewport()->WorkSize.x), 0.0f});
    ImGui::Begin("Start", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::TextUnformatted("SHVR");
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(
        "Looks at 3-D scans, such as micro-CT of plants and vessels, as translucent volumes and in slices.");
    ImGui::TextUnformatted(
        "Marks structures: paint voxels by brushes that follow the scan, and trace centre lines node by node.");
    ImGui::TextUnformatted(
        "Saves masks, traces and measures for other programs. Every step can be undone, and the scan is never "
        "changed.");
    ImGui::PopTextWrapPos();
    ImGui::Spacing();
    if (button_row(("Open..." + key_in_brackets("open", model.keymap)).c_str(), "a scan of your own, or drop it here"))
        actions.push_back(AskOpen{true});
    hint((names_of_formats("or") +
          "; a folder of slices, a session, a project or the address of an OME-Zarr. Voxels without a header: File, "
          "Open with options.")
             .c_str());
    if (button_row("Open the example", "small vessels, made by the program, to try things on"))
        actions.push_back(OpenExample{});
    state_of_opening(model);
    if (!model.preferences.recent.empty()) {
        ImGui::Spacing();
        ImGui::Separator();
        ImGui::TextDisabled("Recent");
        recent_cards(model, actions);
    }
    ImGui::End();
}

}  // namespace shvr::ui
