#pragma once
// Inputs made of a seed in a fixed order: the same seed and number give the same bytes on every machine.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace shvr::fuzz {

/// Lengths to which a seed is cut: every one of a small seed, `most` spread over a larger one, more of them at its
/// start.
std::vector<size_t> cuts_of(size_t length, size_t most);

/// `seed` with a value of very deep nesting before each of its first values of JSON.
std::vector<std::string> nested(std::string_view seed);

/// `seed` after one to three changes: bits flipped, bytes and integers set to values that overflow, numbers in text
/// exchanged, parts doubled, taken out, or taken from `other`.
std::string mutated(std::string_view seed, std::string_view other, uint64_t number);

}  // namespace shvr::fuzz
