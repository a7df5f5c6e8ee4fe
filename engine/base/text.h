#pragma once
// Handles untrusted text: trims it, splits it, parses numbers strictly, and makes it safe to quote in a message. Any
// thread.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace shvr {

/// '0' ... '9', in any locale.
inline bool is_digit(char character)
{
    return character >= '0' && character <= '9';
}

std::string_view trimmed(std::string_view text);
std::string lower_case(std::string_view text);
std::vector<std::string_view> words_of(std::string_view text);
/// Whether the text contains control characters, which terminals interpret.
bool has_controls(std::string_view text);
/// The text with each control character replaced by a question mark.
std::string printable(std::string_view text);
/// Prepares a text for a message: in quotes, at most 60 characters, without control characters.
std::string in_quotes(std::string_view text);
/// Removes the first line and its line end from `rest`, and returns the line. "\r\n" counts as one line end.
std::string_view take_line(std::string_view& rest);

/// The text without line ends: blanks between its lines that are not empty.
std::string one_line(std::string_view text);

std::optional<int64_t> whole_of(std::string_view word);
std::optional<double> number_of(std::string_view word);  ///< may be NaN or infinite

/// Returns the fewest digits that parse back to exactly the same number.
std::string digits_of(double value);
/// The same for people: without an exponent where the number is 0 or between 1e-6 and 1e15 in size.
std::string plain_digits_of(double value);
std::string digits_of(const glm::dvec3& value);  ///< separated by spaces
std::string digits_of(const glm::i64vec3& value);

/// "1 voxel", "2 voxels"
inline std::string counted(int64_t count, const char* thing)
{
    return std::to_string(count) + ' ' + thing + (count == 1 ? "" : "s");
}

}  // namespace shvr
