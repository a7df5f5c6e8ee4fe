#include "ui/panels/dialogs/field_widgets.h"

#include <algorithm>
#include <utility>

#include <imgui/imgui.h>
#include <imgui/imgui_internal.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/text.h"
#include "engine/tasks/task_options.h"
#include "ui/files/file_list.h"
#include "ui/panels/dialogs/file_chooser.h"
#include "ui/panels/field_keys.h"
#include "ui/panels/imgui_keys.h"
#include "ui/panels/number_field.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// All fields share this chooser, since at most one chooser is shown at a time.
FileChooser chooser({.title = "Choose a file or a folder",
                     .verb = "Choose",
                     .note = "A new name can be typed, too.",
                     .wanted = FileChooser::Wanted::any});
ImGuiID chooser_of = 0;
FieldKeys first_keys;     ///< gives the keyboard to the first path of a dialog that has just opened
ImGuiID first_field = 0;  ///< that path; others leave `first_keys` alone

/// In font sizes. A value with less room than MIN_BESIDE is below its name.
constexpr float NAME_COLUMN = 9.0f, VALUE_WIDTH = 26.0f, MIN_BESIDE = 12.5f;
constexpr float MIN_DIALOG = 18.0f;  ///< width of the narrowest dialog, in font sizes

/// Draws the name at the left. Returns the label for the next widget: an id without visible text.
std::string begin_row(std::string_view name)
{
    const std::string title = option_title(name);
    const bool is_beside = ImGui::GetContentRegionAvail().x >= (NAME_COLUMN + MIN_BESIDE) * ImGui::GetFontSize();
    if (is_beside) ImGui::AlignTextToFramePadding();
    if (is_beside || !title.empty()) ImGui::TextUnformatted(title.c_str());
    if (is_beside) ImGui::SameLine(NAME_COLUMN * ImGui::GetFontSize());
    ImGui::SetNextItemWidth(width_of_value(VALUE_WIDTH));
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

/// Draws the field of a path, with room for the button of its chooser.
bool path_field(std::string& path, const std::string& hint_text, float width, const std::string& tooltip)
{
    want_glyphs(path);
    const float button = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x;
    ImGui::SetNextItemWidth(width - button);
    bool is_changed = ImGui::InputTextWithHint("##path", hint_text.c_str(), &path, ImGuiInputTextFlags_AutoSelectAll);
    if (!ImGui::IsItemActive() && is_typed_address(path))
        is_changed |= std::exchange(path, without_query(path)) != path;  // a query is a credential
    if (!tooltip.empty()) hint(tooltip.c_str());
    return is_changed;
}

/// Draws the button of the chooser, to the right of the field of a path.
bool path_button(std::string& path, const std::filesystem::path& begin)
{
    ImGui::SameLine(0.0f, ImGui::GetStyle().ItemInnerSpacing.x);
    const ImGuiID id = ImGui::GetID("##path");
    if (ImGui::Button("...", {ImGui::GetFrameHeight(), 0.0f})) {
        chooser_of = id;
        const std::filesystem::path from = path.empty() ? begin : std::filesystem::path(path);
        chooser.ask(from, places(from, {}));
    }
    hint("Choose a file or a folder");
    // A chooser is drawn by the field that opened it.
    if (chooser_of != id) return false;
    const auto chosen = chooser.draw();
    if (chosen) path = chosen->string();
    return chosen.has_value();
}

class Widgets : public Fields {
public:
    Widgets(const std::filesystem::path& beside, bool begins, std::span<const std::string_view> left_out)
        : beside_(beside), begins_(begins), left_out_(left_out)
    {}
    using Fields::choice;
    using Fields::color;
    using Fields::number;
    using Fields::section;
    using Fields::vector;
    void any_flag(std::string_view name, std::optional<bool>& value, const About& about) override
    {
        if (is_left_out(name)) return;
        bool is_set = value.value_or(false);
        if (ImGui::Checkbox(begin_row(name).c_str(), &is_set)) value = is_set;
        tell(about);
        words_beside(about, VALUE_WIDTH - 2.0f);
    }
    void number(std::string_view name, std::optional<double>& value, const NumberRange&, const About& about) override
    {
        if (is_left_out(name)) return;
        number_field(begin_row(name).c_str(), value);
        tell(about);
    }
    void any_whole(std::string_view name, std::optional<int64_t>& value, int64_t lower, int64_t upper,
                   const About& about) override
    {
        if (is_left_out(name)) return;
        // An empty field leaves a key that must have a value its own.
        if (whole_field(begin_row(name).c_str(), value) && value) value = std::clamp(*value, lower, upper);
        tell(about);
    }
    void choice(std::string_view name, std::string& value, const std::vector<std::string_view>& names,
                const About& about) override
    {
        if (is_left_out(name)) return;
        constexpr float WIDTH = 8.0f;
        const std::string id = begin_row(name);
        ImGui::SetNextItemWidth(width_of_value(WIDTH));
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
        if (is_left_out(name)) return;
        const std::string id = begin_row(name);
        ImGui::InputTextWithHint(id.c_str(), words_for(about, width_of_value(VALUE_WIDTH)).c_str(), &value);
        tell(about);
    }
    void path(std::string_view name, std::filesystem::path& value, const About& about) override
    {
        if (is_left_out(name)) return;
        std::string shown = value.string();
        ImGui::PushID(std::string(name).c_str());
        begin_row(name);
        const float width = width_of_value(VALUE_WIDTH);
        const ImGuiID id = ImGui::GetID("##path");
        const bool begins = std::exchange(is_before_paths_, false) && begins_;
        if (begins) first_field = id;
        if (first_field == id) first_keys.before_field(begins);
        bool is_changed = path_field(shown, words_for(about, width), width, tooltip_of(about));
        if (first_field == id) first_keys.after_field();
        is_changed |= path_button(shown, new_file(name, about));
        if (is_changed) value = shown;
        ImGui::PopID();
    }
    void color(std::string_view, std::optional<glm::dvec4>&, bool, const About&) override {}
    void vector(std::string_view name, std::optional<glm::dvec3>& value, const NumberRange&,
                const About& about) override
    {
        if (is_left_out(name)) return;
        glm::dvec3 shown = value.value_or(glm::dvec3(0.0));
        if (number_fields(begin_row(name).c_str(), shown)) value = shown;
        tell(about);
    }
    void numbers(std::string_view, std::optional<glm::dvec2>&, const NumberRange&, const About&) override {}
    void wholes(std::string_view name, std::vector<int64_t>& value, int64_t lower, int64_t upper,
                const About& about) override
    {
        if (whole_fields(begin_row(name).c_str(), value))
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
    /// Returns the description if it fits; a mark otherwise, whose tooltip has it: no text is cut.
    static std::string fitting(const char* meaning, float width, const char* mark)
    {
        return ImGui::CalcTextSize(meaning).x <= width ? meaning : mark;
    }
    /// Writes a description to the right of a widget that has no text.
    static void words_beside(const About& about, float fonts)
    {
        ImGui::SameLine();
        ImGui::TextDisabled("%s", fitting(about.meaning, width_of_value(fonts), "(?)").c_str());
        tell(about);
    }
    /// Returns the description to show in an empty field.
    static std::string words_for(const About& about, float width)
    {
        return fitting(about.meaning, width - 2.0f * ImGui::GetStyle().FramePadding.x, "");
    }
    static std::string tooltip_of(const About& about)
    {
        std::string text = about.meaning;
        if (*about.allowed || *about.unit) text += sentence("\n", *about.allowed ? about.allowed : about.unit);
        if (*about.standard && !about.is_required) text += sentence("\nIf empty: ", about.standard);
        return text;
    }
    static void tell(const About& about)
    {
        const std::string text = tooltip_of(about);
        if (!text.empty()) hint(text.c_str());
    }
    bool is_left_out(std::string_view name) const { return std::ranges::find(left_out_, name) != left_out_.end(); }

    std::filesystem::path beside_;
    bool begins_ = false, is_before_paths_ = true;
    std::span<const std::string_view> left_out_;
};

}  // namespace

bool enter_confirms()
{
    if (!ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows)) return false;
    return ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false) ||
           ImGui::IsKeyPressed(ImGui::GetKeyIndex(KEYPAD_ENTER), false);
}

bool path_chooser_is_open()
{
    return chooser.is_open();
}

void field_name(const char* name)
{
    begin_row(name);
}

float width_of_value(float fonts)
{
    return std::min(fonts * ImGui::GetFontSize(), std::max(ImGui::GetContentRegionAvail().x, 1.0f));
}

void beside_or_below(float width)
{
    ImGui::SameLine();
    if (ImGui::GetContentRegionAvail().x >= width) return;
    ImGui::NewLine();
    field_name("");
}

void button_beside_or_below(const char* label)
{
    beside_or_below(ImGui::CalcTextSize(label).x + 2.0f * ImGui::GetStyle().FramePadding.x);
}

bool path_row(const char* name, std::string& path, const char* meaning, const std::filesystem::path& begin, bool begins)
{
    ImGui::PushID(name);
    begin_row(name);
    const ImGuiID id = ImGui::GetID("##path");
    if (begins) {
        first_field = id;
        if (ImGui::GetActiveID() == id) ImGui::ClearActiveID();  // it would keep what it shows, not take `path`
    }
    if (first_field == id) first_keys.before_field(begins);
    bool is_changed = path_field(path, meaning, width_of_value(VALUE_WIDTH), meaning);
    if (first_field == id) first_keys.after_field();
    is_changed |= path_button(path, begin);
    ImGui::PopID();
    return is_changed;
}

void size_dialog(float share)
{
    const float font = ImGui::GetFontSize();
    const float width = (NAME_COLUMN + VALUE_WIDTH + 4.0f) * font + 4.0f * ImGui::GetStyle().WindowPadding.x;
    const ImVec2 room = ImGui::GetMainViewport()->WorkSize;
    const float most = std::min(std::max(share * room.x, MIN_DIALOG * font), room.x);
    ImGui::SetNextWindowSize({std::min(width, most), 0.0f});
    ImGui::SetNextWindowSizeConstraints({0.0f, 0.0f}, room);  // a longer dialog scrolls
    ImGui::SetNextWindowScroll({0.0f, -1.0f});
}

void keep_above(float lower_edge)
{
    const ImVec2 at = ImGui::GetWindowPos();
    const float top = std::max(lower_edge - ImGui::GetWindowHeight(), ImGui::GetMainViewport()->WorkPos.y);
    if (at.y > top) ImGui::SetWindowPos({at.x, top});
}

bool more_heading()
{
    return ImGui::TreeNodeEx("More", ImGuiTreeNodeFlags_NoTreePushOnOpen | ImGuiTreeNodeFlags_SpanAvailWidth);
}

void dialog_note(const std::string& about, const std::string& failure)
{
    ImGui::PushTextWrapPos(
        std::min((NAME_COLUMN + VALUE_WIDTH) * ImGui::GetFontSize(), ImGui::GetContentRegionMax().x));
    want_glyphs(failure);
    if (failure.empty()) {
        ImGui::TextDisabled("%s", about.empty() ? " " : about.c_str());
    } else {
        ImGui::PushStyleColor(ImGuiCol_Text, WARNING);
        ImGui::TextUnformatted(failure.c_str());
        ImGui::PopStyleColor();
    }
    ImGui::PopTextWrapPos();
}

bool draw_fields(const Fields::Visit& visit, const std::filesystem::path& beside, bool begins,
                 std::span<const std::string_view> left_out)
{
    const bool has_chooser = chooser.is_open();
    Widgets widgets(beside, begins, left_out);
    visit(widgets);
    return has_chooser;
}

}  // namespace shvr::ui
