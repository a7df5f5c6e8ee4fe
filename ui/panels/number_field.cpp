#include "ui/panels/number_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>

#include <imgui/imgui_internal.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/session/words/typed_number.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// A text that is not a number, in the field that shows it.
struct Refusal {
    std::string text;
    std::string shown;  ///< the value's own text
    bool is_whole = false;
    bool may_go_on = false;  ///< it is still typed, and may become a number: "-"
    int frame = -1;          ///< in which the field was drawn last
};
std::map<ImGuiID, Refusal> refusals;

/// What is said below a slider until the next click or character.
struct Note {
    ImGuiID slider = 0;
    std::string words;
    int since = -1;  ///< frame
};
Note note;

/// Characters of the frame in which a slider began to be typed over.
struct EarlyCharacters {
    ImGuiID slider = 0;
    ImVector<ImWchar> characters;
};
EarlyCharacters early;

constexpr double MAX_WHOLE = 9223372036854775807.0;  ///< 2^63: int64_t ends below

std::string words_of_refusal(const Refusal& refusal)
{
    const std::string found =
        trimmed(refusal.text).empty() ? std::string("a field is empty") : in_quotes(refusal.text) + " is not a number";
    if (!refusal.is_whole) return found + "; expected a number such as 1.5 or 1,5";
    if (const std::optional<double> number = typed_number(refusal.text)) {
        const bool is_whole = std::floor(*number) == *number && std::abs(*number) >= MAX_WHOLE;
        return in_quotes(refusal.text) + (!is_whole       ? " is not a whole number; expected one such as 12"
                                          : *number > 0.0 ? " is too large; expected a smaller number"
                                                          : " is too small; expected a larger number");
    }
    return found + "; expected a whole number such as 12";
}

template <class Number>
std::optional<Number> read(const std::string& text)
{
    if constexpr (std::is_same_v<Number, double>)
        return typed_number(text);
    else
        return typed_whole(text);
}

template <class Number>
bool may_become(const std::string& text)
{
    return std::is_same_v<Number, double> ? may_become_number(text) : may_become_whole(text);
}

template <class Number>
struct Field {
    const char* id;
    std::string shown;  ///< the value as text
    bool may_be_empty = false;
    bool is_over_slider = false;
    std::pair<Number, Number> limits{std::numeric_limits<Number>::lowest(), std::numeric_limits<Number>::max()};
};

/// What is being typed. One field at a time has the keyboard.
template <class Number>
struct Typing {
    ImGuiID field = 0;
    std::optional<Number> before{};  ///< the value when the typing began
    std::string shown{};             ///< its text
    std::string text{};
    bool is_wrong = false;
    int frame = -1;  ///< in which the field was drawn last
};

/// Takes what is typed into the value. Returns whether that changed.
template <class Number>
bool take(const Field<Number>& field, Typing<Number>& typing, std::optional<Number>& value)
{
    std::optional<Number> next = typing.before;  // with all of its digits, where the text is that of before
    typing.is_wrong = false;
    if (typing.text != typing.shown) {
        const std::optional<Number> number = read<Number>(typing.text);
        if (number)
            next = std::clamp(*number, field.limits.first, field.limits.second);
        else if (field.may_be_empty && trimmed(typing.text).empty())
            next.reset();
        else
            typing.is_wrong = true;
    }
    return std::exchange(value, next) != next;
}

/// Returns the text that a field keeps, if it is still about the same value.
const Refusal* kept(ImGuiID field, const std::string& shown, bool is_typed_in)
{
    const int frame = ImGui::GetFrameCount();
    std::erase_if(refusals, [&](const auto& each) { return each.second.frame + 1 < frame; });
    const auto found = refusals.find(field);
    if (found == refusals.end()) return nullptr;
    if (!is_typed_in && found->second.shown != shown) {
        refusals.erase(found);
        return nullptr;
    }
    found->second.frame = frame;
    return &found->second;
}

/// Draws the field's text, with a frame where it is refused.
void draw_text(const char* id, std::string& text, bool is_refused)
{
    if (is_refused) {
        ImGui::PushStyleColor(ImGuiCol_Text, ERROR_TEXT);
        ImGui::PushStyleColor(ImGuiCol_Border, ERROR_TEXT);
        ImGui::PushStyleVar(ImGuiStyleVar_FrameBorderSize, 2.0f);
    }
    ImGui::InputText(id, &text, ImGuiInputTextFlags_AutoSelectAll);
    if (!is_refused) return;
    ImGui::PopStyleVar();
    ImGui::PopStyleColor(2);
}

/// Below the widget that was drawn last, or above it in the lower part of the screen.
void draw_note(const std::string& words)
{
    const ImVec2 lower = ImGui::GetItemRectMin(), upper = ImGui::GetItemRectMax();
    const ImGuiViewport& screen = *ImGui::GetMainViewport();
    const bool is_right = lower.x + upper.x > 2.0f * screen.GetCenter().x;
    const bool is_low = upper.y > screen.Pos.y + 0.8f * screen.Size.y;
    ImGui::SetNextWindowPos({is_right ? upper.x : lower.x, is_low ? lower.y : upper.y}, ImGuiCond_Always,
                            {is_right ? 1.0f : 0.0f, is_low ? 1.0f : 0.0f});
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(24.0f * ImGui::GetFontSize());
    ImGui::PushStyleColor(ImGuiCol_Text, ERROR_TEXT);
    ImGui::TextUnformatted(words.c_str());
    ImGui::PopStyleColor();
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

template <class Number>
bool draw(const Field<Number>& field, std::optional<Number>& value)
{
    static Typing<Number> typing;
    const ImGuiID id = ImGui::GetID(field.id);
    const int frame = ImGui::GetFrameCount();
    const bool was_active = ImGui::GetActiveID() == id;
    const Refusal* const refusal = kept(id, field.shown, was_active);
    const bool is_refused = refusal && !refusal->may_go_on;
    const std::string before = refusal ? refusal->text : field.shown;
    std::string text = before;
    draw_text(field.id, text, is_refused);
    const bool is_active = ImGui::GetActiveID() == id;
    if (is_active && (typing.field != id || typing.frame + 1 < frame || ImGui::IsItemActivated()))
        typing = {.field = id, .before = value, .shown = field.shown, .text = before, .is_wrong = refusal != nullptr};
    // A field that was not drawn meanwhile, as of a dialog that was closed, starts afresh.
    if (typing.field == id && !is_active && typing.frame + 1 < frame) typing.field = 0;
    if (typing.field != id) return false;
    typing.frame = frame;
    const bool is_typed = (is_active || was_active) && std::exchange(typing.text, text) != text;
    const bool is_changed = is_typed && take(field, typing, value);
    refusals.erase(id);
    if (typing.is_wrong) {
        const Refusal now{.text = typing.text,
                          .shown = typing.shown,
                          .is_whole = !std::is_same_v<Number, double>,
                          .may_go_on = is_active && may_become<Number>(typing.text),
                          .frame = frame};
        if (is_active || !field.is_over_slider) refusals[id] = now;
        if (field.is_over_slider && !now.may_go_on) note = {id, words_of_refusal(now), frame};
    } else if (note.slider == id) {
        note = {};
    }
    if (note.slider == id) draw_note(note.words);
    if (!is_active) typing.field = 0;
    return is_changed;
}

template <class Number>
bool draw(const Field<Number>& field, Number& value)
{
    std::optional<Number> number = value;
    const bool is_changed = draw(field, number);
    value = number.value_or(value);
    return is_changed;
}

/// Draws `count` fields side by side in the width of one.
template <class Draw>
bool in_a_row(const char* id, size_t count, const Draw& draw_one)
{
    bool is_changed = false;
    ImGui::BeginGroup();
    ImGui::PushID(id);
    ImGui::PushMultiItemsWidths(int(count), ImGui::CalcItemWidth());
    for (size_t i = 0; i < count; ++i) {
        ImGui::PushID(int(i));
        if (i > 0) ImGui::SameLine(0.0f, ImGui::GetStyle().ItemInnerSpacing.x);
        is_changed |= draw_one(i);
        ImGui::PopID();
        ImGui::PopItemWidth();
    }
    ImGui::PopID();
    ImGui::EndGroup();
    return is_changed;
}

template <class Stored, class Number>
bool over_slider(Field<Number> field, void* value, const void* lower, const void* upper)
{
    Stored& stored = *static_cast<Stored*>(value);
    field.limits =
        std::minmax({Number(*static_cast<const Stored*>(lower)), Number(*static_cast<const Stored*>(upper))});
    field.is_over_slider = true;
    auto number = Number(stored);
    const bool is_changed = draw(field, number);
    if (is_changed) stored = Stored(number);
    return is_changed;
}

}  // namespace

bool number_field(const char* id, double& value)
{
    return draw(Field<double>{.id = id, .shown = plain_digits_of(value)}, value);
}

bool whole_field(const char* id, int64_t& value)
{
    return draw(Field<int64_t>{.id = id, .shown = std::to_string(value)}, value);
}

bool whole_field(const char* id, int32_t& value)
{
    int64_t number = value;
    Field<int64_t> field{.id = id, .shown = std::to_string(value)};
    field.limits = {std::numeric_limits<int32_t>::lowest(), std::numeric_limits<int32_t>::max()};
    const bool is_changed = draw(field, number);
    value = int32_t(number);
    return is_changed;
}

bool number_field(const char* id, std::optional<double>& value)
{
    const std::string shown = value ? plain_digits_of(*value) : std::string();
    return draw(Field<double>{.id = id, .shown = shown, .may_be_empty = true}, value);
}

bool whole_field(const char* id, std::optional<int64_t>& value)
{
    const std::string shown = value ? std::to_string(*value) : std::string();
    return draw(Field<int64_t>{.id = id, .shown = shown, .may_be_empty = true}, value);
}

bool number_fields(const char* id, glm::dvec3& values)
{
    return in_a_row(id, 3, [&](size_t i) { return number_field("##number", values[glm::length_t(i)]); });
}

bool whole_fields(const char* id, std::span<int64_t> values)
{
    return in_a_row(id, values.size(), [&](size_t i) { return whole_field("##number", values[i]); });
}

bool whole_fields(const char* id, std::span<int32_t> values)
{
    return in_a_row(id, values.size(), [&](size_t i) { return whole_field("##number", values[i]); });
}

std::string refused_number()
{
    const int frame = ImGui::GetFrameCount();
    for (const auto& [field, refusal] : refusals)
        if (refusal.frame == frame) return words_of_refusal(refusal);
    return {};
}

bool is_typed_over(const char* id)
{
    return ImGui::TempInputIsActive(ImGui::GetID(id));
}

bool typed_over(const char* id, ImGuiDataType type, void* value, const void* lower, const void* upper,
                const char* format)
{
    ImVector<ImWchar>& typed = ImGui::GetIO().InputQueueCharacters;
    if (early.slider == ImGui::GetID(id)) {
        for (const ImWchar character : typed) early.characters.push_back(character);
        typed = std::exchange(early, {}).characters;
    }
    std::array<char, 32> number_format{};
    std::array<char, 64> text{};
    const char* const bare = ImParseFormatTrimDecorations(format, number_format.data(), number_format.size());
    ImGui::DataTypeFormatString(text.data(), int(text.size()), type, value, bare);
    const std::string shown(trimmed(text.data()));
    switch (type) {
        case ImGuiDataType_Double:
            return over_slider<double>(Field<double>{.id = id, .shown = shown}, value, lower, upper);
        case ImGuiDataType_S32:
            return over_slider<int32_t>(Field<int64_t>{.id = id, .shown = shown}, value, lower, upper);
        case ImGuiDataType_U32:
            return over_slider<uint32_t>(Field<int64_t>{.id = id, .shown = shown}, value, lower, upper);
        default: SHVR_CHECK(false, "a slider of type ", type, "; expected double, int32_t or uint32_t");
    }
    return false;
}

TypedLater::TypedLater(const char* id) : slider_(ImGui::GetID(id))
{
    characters_.swap(ImGui::GetIO().InputQueueCharacters);
}

TypedLater::~TypedLater()
{
    ImGuiIO& io = ImGui::GetIO();
    characters_.swap(io.InputQueueCharacters);
    if (ImGui::TempInputIsActive(slider_)) early = {slider_, io.InputQueueCharacters};
    if (note.slider != slider_) return;
    const bool is_over = std::ranges::any_of(io.MouseClicked, std::identity()) || !io.InputQueueCharacters.empty();
    if (is_over && note.since < ImGui::GetFrameCount())
        note = {};
    else
        draw_note(note.words);
}

}  // namespace shvr::ui
