#pragma once
// Numbers as a person types them, with a decimal point or a decimal comma. Pure; any thread.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace shvr {

/// Reads "1.5" or "1,5", with spaces around it. A comma is a decimal comma, never a separator of thousands. Null: the
/// text is not one finite number.
std::optional<double> typed_number(std::string_view text);
/// Reads a whole number, of digits alone. Null: the text is none.
std::optional<int64_t> typed_whole(std::string_view text);

/// Whether a number may become of the text by typing on: "", "-", "1e".
bool may_become_number(std::string_view text);
bool may_become_whole(std::string_view text);

/// Returns the text with a decimal point, if it is a number with a decimal comma; otherwise the same text.
std::string with_decimal_point(std::string_view text);

}  // namespace shvr
