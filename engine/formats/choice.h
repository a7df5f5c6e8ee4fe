#pragma once
// The choices that a file with several volumes offers, for callers that can let the user choose.

#include <string>
#include <utility>
#include <vector>

#include "engine/base/error.h"

namespace shvr {

struct Choice {
    static constexpr int64_t MAX_LISTED = 1000;

    std::string key;                    ///< "channel" or "frame", as in OpenOptions
    std::vector<std::string> values;    ///< each chooses one
    std::vector<std::string> titles{};  ///< display titles of the values

    /// Returns a choice with the values 1 to `count`; its titles show the names next to the numbers.
    static Choice numbered(std::string key, int64_t count, const std::vector<std::string>& names = {})
    {
        Choice choice{std::move(key), {}};
        for (int64_t i = 0; i < count && i < MAX_LISTED; ++i) {
            choice.values.push_back(std::to_string(i + 1));
            const bool has_name = i < int64_t(names.size()) && !names[size_t(i)].empty();
            choice.titles.push_back(choice.values.back() + (has_name ? "  " + names[size_t(i)] : ""));
        }
        return choice;
    }
};

/// Its message lists the choices, too.
class ChoiceNeeded : public Error {
public:
    ChoiceNeeded(const std::string& what, std::vector<Choice> choices) : Error(what), choices_(std::move(choices)) {}
    const std::vector<Choice>& choices() const { return choices_; }

private:
    std::vector<Choice> choices_;
};

}  // namespace shvr
