#pragma once
// Fields in which a number is typed, with a decimal point or a decimal comma. Dear ImGui's own fields filter characters
// before a callback sees them: they leave out the comma, and read "1,5" as 15. Between Window::begin_ui and
// Window::present, main thread.
//
// While a text is not a number, the value is the one from before the typing, and the text has a frame in the colour of
// errors. A field of a dialog keeps such a text when it is left, so that the dialog cannot be confirmed with a number
// that was not meant (refused_number). A slider or a dragged number then shows its value again, and says below itself
// what is wrong.

#include <optional>
#include <span>
#include <string>

#include <imgui/imgui.h>
#include <glm/glm.hpp>

namespace shvr::ui {

/// Fields of dialogs, without a visible label ("##value"). They show all digits of a number (plain_digits_of), and
/// return whether the value changed.
bool number_field(const char* id, double& value);
bool whole_field(const char* id, int64_t& value);
bool whole_field(const char* id, int32_t& value);
/// An empty field means null.
bool number_field(const char* id, std::optional<double>& value);
bool whole_field(const char* id, std::optional<int64_t>& value);
/// Several fields in a row.
bool number_fields(const char* id, glm::dvec3& values);
bool whole_fields(const char* id, std::span<int64_t> values);
bool whole_fields(const char* id, std::span<int32_t> values);

/// Returns what is wrong with a text that a field of this frame shows; empty: each is a number. After the fields.
std::string refused_number();

/// Returns whether a slider or a dragged number is being typed over: then `typed_over` takes its place.
bool is_typed_over(const char* id);
/// The field over a slider. `type`: double, int32_t or uint32_t.
bool typed_over(const char* id, ImGuiDataType type, void* value, const void* lower, const void* upper,
                const char* format);
/// Around the call of a slider that may be typed over: keeps the characters of the first frame for `typed_over`. At its
/// end, says below the slider what is wrong with the text that was typed over it last.
class TypedLater {
public:
    explicit TypedLater(const char* id);
    ~TypedLater();
    TypedLater(const TypedLater&) = delete;
    TypedLater& operator=(const TypedLater&) = delete;

private:
    ImGuiID slider_;
    ImVector<ImWchar> characters_;
};

}  // namespace shvr::ui
