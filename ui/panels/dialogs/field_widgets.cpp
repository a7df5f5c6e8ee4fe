#include "ui/panels/dialogs/field_widgets.h"

#include <algorithm>
#include <utility>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "ui/files/file_list.h"
#include "ui/panels/dialogs/file_chooser.h"
#include "ui/panels/field_keys.h"
#include "ui/panels/imgui_keys.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// "break_loops" -> "Break loops"
std::string title_of(std::string_view key)
{
    std::string title(key);
    std::ranges::replace(title, '_', ' ');
    if (title.starts_with("ome zarr")) title.replace(0, 8, "OME-Zarr");
    if (!title.empty() && title[0] >= 'a' && title[0] <= 'z') title[0] = char(title[0] - 'a' + 'A');
    return title;
}

/// All fields share this chooser, since at most one chooser is shown at a time.
FileChooser chooser({.title = "Choose a file or a folder",
                     .verb = "Choose",
                     .note = "A new name can be typed, too.",
                     .wanted = FileChooser::Wanted::any});
ImGuiID chooser_of = 0;
FieldKeys first_keys;  ///< gives the keyboard to the first path of a dialog that has just opened

constexpr float NAME_COLUMN = 9.0f, VALUE_WIDTH = 26.0f;  ///< in font sizes

/// Draws the name at the left. Returns the label for the next widget: an id without visible text.
std::string begin_row(std::string_view name)
{
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(title_of(name).c_str());
    ImGui::SameLine(NAME_COLUMN * ImGui::GetFontSize());
    ImGui::SetNextItemWidth(VALUE_WIDTH * ImGui::GetFontSize());
    return "##" + std::string(name);
}

/// Returns the first file name extension in a key's meaning: ".swc" in "nodes: .swc, .txt"; empty: none.
std::string first_ending(std::string_view meaning)
{
    const size_t at = meaning.find(": .");
    if (at == std::string_view::npos) return {};
    const std::string_view listed = meaning.substr(at + 2);
    return std::string(listed.substr(0, listed.find_first_of(", ")));
}

class Widgets : public Fields {
public:
    Widgets(const std::filesystem::path& beside, bool begins) : beside_(beside), begins_(begins) {}
    using Fields::choice;
    using Fields::color;
    using Fields::number;
    using Fields::section;
    using Fields::vector;
    void any_flag(std::string_view name, std::optional<bool>& value, const About& about) override
    {
        bool is_set = value.value_or(false);
        if (ImGui::Checkbox(begin_row(name).c_str(), &is_set)) value = is_set;
        tell(about);
        words_beside(about, VALUE_WIDTH - 2.0f);
    }
    void number(std::string_view name, std::optional<double>& value, const NumberRange&, const About& about) override
    {
        double shown = value.value_or(0.0);
        if (ImGui::InputDouble(begin_row(name).c_str(), &shown, 0.0, 0.0, value ? "%.6g" : "")) value = shown;
        tell(about);
    }
    void any_whole(std::string_view name, std::optional<int64_t>& value, int64_t lower, int64_t upper,
                   const About& about) override
    {
        int64_t shown = value.value_or(lower);
        if (ImGui::InputScalar(begin_row(name).c_str(), ImGuiDataType_S64, &shown))
            value = std::clamp(shown, lower, upper);
        tell(about);
    }
    void choice(std::string_view name, std::string& value, const std::vector<std::string_view>& names,
                const About& about) override
    {
        constexpr float WIDTH = 8.0f;
        const std::string id = begin_row(name);
        ImGui::SetNextItemWidth(WIDTH * ImGui::GetFontSize());
        if (ImGui::BeginCombo(id.c_str(), value.c_str())) {
            for (const std::string_view each : names)
                if (ImGui::Selectable(std::string(each).c_str(), each == value)) value = each;
            ImGui::EndCombo();
        }
        tell(about);
        words_beside(about, VALUE_WIDTH - WIDTH - 0.5f);
    }
    void text(std::string_view name, std::string& value, const About& about) override
    {
        const std::string id = begin_row(name);
        ImGui::InputTextWithHint(id.c_str(), words_for(about, VALUE_WIDTH * ImGui::GetFontSize()).c_str(), &value);
        tell(about);
    }
    void path(std::string_view name, std::filesystem::path& value, const About& about) override
    {
        std::string shown = value.string();
        want_glyphs(shown);
        ImGui::PushID(std::string(name).c_str());
        begin_row(name);
        const float button = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x;
        const float width = VALUE_WIDTH * ImGui::GetFontSize() - button;
        ImGui::SetNextItemWidth(width);
        const bool is_first = std::exchange(is_before_paths_, false);
        if (is_first) first_keys.before_field(begins_);
        if (ImGui::InputTextWithHint("##path", words_for(about, width).c_str(), &shown)) value = shown;
        if (!ImGui::IsItemActive() && is_typed_address(shown)) value = without_query(shown);
        if (is_first) first_keys.after_field();
        tell(about);
        ImGui::SameLine(0.0f, ImGui::GetStyle().ItemInnerSpacing.x);
        const ImGuiID id = ImGui::GetID("##path");
        if (ImGui::Button("...", {ImGui::GetFrameHeight(), 0.0f})) {
            chooser_of = id;
            const std::filesystem::path begin = value.empty() ? new_file(name, about) : value;
            chooser.ask(begin, places(begin, {}));
        }
        // The chooser is drawn by the field that opened it, and only this field takes its path.
        if (chooser_of == id)
            if (const auto path = chooser.draw()) value = *path;
        ImGui::PopID();
    }
    void color(std::string_view, std::optional<glm::dvec4>&, bool, const About&) override {}
    void vector(std::string_view name, std::optional<glm::dvec3>& value, const NumberRange&,
                const About& about) override
    {
        glm::dvec3 shown = value.value_or(glm::dvec3(0.0));
        if (ImGui::InputScalarN(begin_row(name).c_str(), ImGuiDataType_Double, &shown.x, 3, nullptr, nullptr, "%.6g"))
            value = shown;
        tell(about);
    }
    void numbers(std::string_view, std::optional<glm::dvec2>&, const NumberRange&, const About&) override {}
    void wholes(std::string_view name, std::vector<int64_t>& value, int64_t lower, int64_t upper,
                const About& about) override
    {
        if (ImGui::InputScalarN(begin_row(name).c_str(), ImGuiDataType_S64, value.data(), int(value.size())))
            for (int64_t& each : value) each = std::clamp(each, lower, upper);
        tell(about);
    }
    void other(std::string_view, const std::function<void(const JsonNode&)>&,
               const std::function<std::optional<std::string>()>&, const About&) override
    {}
    /// Draws a section. An optional section has a check box (`has`), which adds the section or removes it.
    void section(std::string_view name, const Visit& visit, const About&) override
    {
        ImGui::PushID(std::string(name).c_str());
        ImGui::Indent();
        visit(*this);
        ImGui::Unindent();
        ImGui::PopID();
    }
    void items(std::string_view, size_t, size_t, const VisitItem&, const About&) override {}
    void entries(std::string_view, std::vector<std::string>, std::string_view, const VisitEntry&, const About&) override
    {}
    bool has(std::string_view name, bool is_set) override
    {
        ImGui::Checkbox(begin_row(name).c_str(), &is_set);
        return is_set;
    }
    void mention(std::string_view, const About& about) override { tell(about); }

private:
    /// Returns a default path for a key that names a file to be written, such as "/scans/spike-trace.swc".
    std::filesystem::path new_file(std::string_view name, const About& about) const
    {
        const std::string ending = name == "project" ? "" : first_ending(about.meaning);
        if (beside_.empty() || (ending.empty() && name != "project")) return beside_.parent_path();
        return beside_.string() + "-" + std::string(name) + ending;
    }
    /// Writes a description to the right of a widget that shows no text itself.
    static void words_beside(const About& about, float fonts)
    {
        ImGui::SameLine();
        ImGui::TextDisabled("%s", shortened(about.meaning, fonts * ImGui::GetFontSize()).c_str());
    }
    /// Returns the description for an empty field, shortened to the field's width.
    static std::string words_for(const About& about, float width)
    {
        return shortened(about.meaning, width - 2.0f * ImGui::GetStyle().FramePadding.x);
    }
    static void tell(const About& about)
    {
        std::string text = about.meaning;
        if (*about.allowed || *about.unit) text += sentence("\n", *about.allowed ? about.allowed : about.unit);
        if (*about.standard) text += sentence("\nUsually: ", about.standard);
        if (!text.empty()) hint(text.c_str());
    }

    std::filesystem::path beside_;
    bool begins_ = false, is_before_paths_ = true;
};

}  // namespace

bool enter_confirms()
{
    if (!ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows)) return false;
    return ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false) ||
           ImGui::IsKeyPressed(ImGui::GetKeyIndex(KEYPAD_ENTER), false);
}

bool draw_fields(const Fields::Visit& visit, const std::filesystem::path& beside, bool begins)
{
    const bool has_chooser = chooser.is_open();
    Widgets widgets(beside, begins);
    visit(widgets);
    return has_chooser;
}

}  // namespace shvr::ui
