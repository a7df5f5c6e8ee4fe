#include "ui/panels/dialogs/field_widgets.h"

#include <algorithm>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "ui/panels/dialogs/file_chooser.h"
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

/// One for all fields: at most one is shown.
FileChooser chooser({.title = "Choose a file or a folder",
                     .verb = "Choose",
                     .note = "A new name can be typed, too.",
                     .wanted = FileChooser::Wanted::any});
ImGuiID chooser_of = 0;

class Widgets : public Fields {
public:
    using Fields::choice;
    using Fields::color;
    using Fields::number;
    using Fields::section;
    using Fields::vector;
    void any_flag(std::string_view name, std::optional<bool>& value, const About& about) override
    {
        bool is_set = value.value_or(false);
        if (ImGui::Checkbox(title_of(name).c_str(), &is_set)) value = is_set;
        tell(about);
    }
    void number(std::string_view name, std::optional<double>& value, const NumberRange&, const About& about) override
    {
        double shown = value.value_or(0.0);
        if (ImGui::InputDouble(title_of(name).c_str(), &shown, 0.0, 0.0, value ? "%.6g" : "")) value = shown;
        tell(about);
    }
    void any_whole(std::string_view name, std::optional<int64_t>& value, int64_t lower, int64_t upper,
                   const About& about) override
    {
        int64_t shown = value.value_or(lower);
        if (ImGui::InputScalar(title_of(name).c_str(), ImGuiDataType_S64, &shown))
            value = std::clamp(shown, lower, upper);
        tell(about);
    }
    void choice(std::string_view name, std::string& value, const std::vector<std::string_view>& names,
                const About& about) override
    {
        if (ImGui::BeginCombo(title_of(name).c_str(), value.c_str())) {
            for (const std::string_view each : names)
                if (ImGui::Selectable(std::string(each).c_str(), each == value)) value = each;
            ImGui::EndCombo();
        }
        tell(about);
    }
    void text(std::string_view name, std::string& value, const About& about) override
    {
        ImGui::InputTextWithHint(title_of(name).c_str(), words_for(about, ImGui::CalcItemWidth()).c_str(), &value);
        tell(about);
    }
    void path(std::string_view name, std::filesystem::path& value, const About& about) override
    {
        std::string shown = value.string();
        want_glyphs(shown);
        ImGui::PushID(std::string(name).c_str());
        const float button = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x;
        const float width = ImGui::CalcItemWidth() - button;
        ImGui::SetNextItemWidth(width);
        if (ImGui::InputTextWithHint("##path", words_for(about, width).c_str(), &shown)) value = shown;
        tell(about);
        ImGui::SameLine(0.0f, ImGui::GetStyle().ItemInnerSpacing.x);
        const ImGuiID id = ImGui::GetID("##path");
        if (ImGui::Button("...", {ImGui::GetFrameHeight(), 0.0f})) {
            chooser_of = id;
            chooser.ask(value, places(value, {}));
        }
        // A chooser is drawn by the field that asked for it.
        if (chooser_of == id)
            if (const auto path = chooser.draw()) value = *path;
        ImGui::SameLine(0.0f, ImGui::GetStyle().ItemInnerSpacing.x);
        ImGui::TextUnformatted(title_of(name).c_str());
        ImGui::PopID();
    }
    void color(std::string_view, std::optional<glm::dvec4>&, bool, const About&) override {}
    void vector(std::string_view name, std::optional<glm::dvec3>& value, const NumberRange&,
                const About& about) override
    {
        glm::dvec3 shown = value.value_or(glm::dvec3(0.0));
        if (ImGui::InputScalarN(title_of(name).c_str(), ImGuiDataType_Double, &shown.x, 3, nullptr, nullptr, "%.6g"))
            value = shown;
        tell(about);
    }
    void numbers(std::string_view, std::optional<glm::dvec2>&, const NumberRange&, const About&) override {}
    void wholes(std::string_view name, std::vector<int64_t>& value, int64_t lower, int64_t upper,
                const About& about) override
    {
        if (ImGui::InputScalarN(title_of(name).c_str(), ImGuiDataType_S64, value.data(), int(value.size())))
            for (int64_t& each : value) each = std::clamp(each, lower, upper);
        tell(about);
    }
    void other(std::string_view, const std::function<void(const JsonNode&)>&,
               const std::function<std::optional<std::string>()>&, const About&) override
    {}
    /// An optional section is opened by a box, and closing that takes it away again.
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
        ImGui::Checkbox(title_of(name).c_str(), &is_set);
        return is_set;
    }
    void mention(std::string_view, const About& about) override { tell(about); }

private:
    /// What an empty field is for, as far as there is room.
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
};

}  // namespace

bool draw_fields(const Fields::Visit& visit)
{
    const bool has_chooser = chooser.is_open();
    Widgets widgets;
    ImGui::PushItemWidth(22.0f * ImGui::GetFontSize());
    visit(widgets);
    ImGui::PopItemWidth();
    return has_chooser;
}

}  // namespace shvr::ui
