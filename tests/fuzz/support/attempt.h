#pragma once
// What a target does with one input. An `Error` in good words is fine, and so is none; any other exception leaves the
// target, and that, like a report of a sanitizer, is a finding. One thread.

#include <functional>
#include <string>

namespace shvr::fuzz {

/// What became of the last input; the replay counts it.
struct Outcome {
    bool was_accepted = false;  ///< the first attempt on it threw no error
    std::string refusal{};      ///< what it threw otherwise
};
Outcome& last_outcome();

/// Ends the program with `claim` where it is false: the input is a finding.
void expect(bool claim, const std::string& what);

/// True where `action` threw no `Error`. What an error says must be one sentence that a terminal can show.
bool passes(const std::function<void()>& action);
/// The same for the step that decides whether the input is taken.
bool accepts(const std::function<void()>& action);

}  // namespace shvr::fuzz
