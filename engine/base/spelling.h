#pragma once
// Spellings of the values of an enumeration in files and messages, in one place: a table next to the enumeration, and a
// function `spellings_of(Enumeration)` that returns the table and is found by argument-dependent lookup.
//
//   enum class Paging { automatic, always, never };
//   inline constexpr Spelling<Paging> PAGINGS[] = {{Paging::automatic, "automatic"}, ...};
//   constexpr std::span<const Spelling<Paging>> spellings_of(Paging) { return PAGINGS; }

#include <span>
#include <string_view>
#include <vector>

#include "engine/base/error.h"

namespace shvr {

template <class Value>
struct Spelling {
    Value value;
    std::string_view name;
};

template <class Value>
std::string_view spelled(Value value)
{
    for (const Spelling<Value>& each : spellings_of(value))
        if (each.value == value) return each.name;
    SHVR_CHECK(false, "a value without a spelling: ", int(value));
    return {};
}

template <class Value>
std::vector<std::string_view> names_of(std::span<const Spelling<Value>> spellings)
{
    std::vector<std::string_view> names;
    for (const Spelling<Value>& each : spellings) names.push_back(each.name);
    return names;
}

}  // namespace shvr
