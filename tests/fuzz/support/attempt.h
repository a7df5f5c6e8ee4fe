#pragma once
// Runs a target on one input. An `Error` with a good message is fine, and so is no error; any other exception leaves
// the target and is a finding, like a sanitizer's report. One thread.

#include <functional>
#include <string>

namespace shvr::fuzz {

/// The outcome of the last input, which the replay counts.
struct Outcome {
    bool was_accepted = false;  ///< the first attempt on it threw no error
    std::string refusal{};      ///< message of its error otherwise
};
Outcome& last_outcome();

/// Ends the program with message `what` if `claim` is false: the input is a finding.
void expect(bool claim, const std::string& what);

/// True if `action` threw no `Error`. An error's message must be one sentence that a terminal can show.
bool passes(const std::function<void()>& action);
/// The same for the step that decides whether the input is accepted.
bool accepts(const std::function<void()>& action);

}  // namespace shvr::fuzz
