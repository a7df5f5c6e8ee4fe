#pragma once
// Numbers for reading, in messages and panels: not for files, which need all digits (digits_of). Pure; any thread.

#include <string>
#include <string_view>

namespace shvr {

/// Returns an integer with all of its digits, and other numbers with four significant digits, without an exponent from
/// 0.0001 up to 1e15: "1048576", "0.25", "12346".
std::string number_in_words(double value);

/// Returns the text with a capital first letter.
std::string capitalised(std::string_view text);

}  // namespace shvr
