#pragma once
// Derives inputs from a seed in a fixed order: the same seed and number give the same bytes on every machine.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace shvr::fuzz {

/// Lengths to which a seed is cut: all lengths of a small seed, `most` of a larger one, denser at its start.
std::vector<size_t> cuts_of(size_t length, size_t most);

/// `seed` with a deeply nested value before each of its first JSON values.
std::vector<std::string> nested(std::string_view seed);

/// `seed` after one to three changes: bits flipped, bytes and integers set to values that overflow, numbers in text
/// replaced, parts duplicated, removed, or copied from `other`.
std::string mutated(std::string_view seed, std::string_view other, uint64_t number);

}  // namespace shvr::fuzz
