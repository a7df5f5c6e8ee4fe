#include "tests/fuzz/support/attempt.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "engine/base/error.h"

namespace shvr::fuzz {
namespace {

/// It may name a path, of PATH_MAX bytes at most.
constexpr size_t MAX_SENTENCE_BYTES = 1500 + 4096;

}  // namespace

Outcome& last_outcome()
{
    static Outcome outcome;
    return outcome;
}

void expect(bool claim, const std::string& what)
{
    if (claim) return;
    std::fprintf(stderr, "FINDING: %s\n", what.c_str());
    std::abort();
}

bool passes(const std::function<void()>& action)
{
    try {
        action();
        return true;
    } catch (const Error& error) {
        const std::string text = error.what();
        expect(!text.empty() && text.size() <= MAX_SENTENCE_BYTES,
               "an error of " + std::to_string(text.size()) + " bytes: " + text.substr(0, MAX_SENTENCE_BYTES));
        const bool has_controls = std::any_of(text.begin(), text.end(), [](char letter) {
            const auto byte = static_cast<unsigned char>(letter);
            return byte < 0x20 || byte == 0x7f;
        });
        expect(!has_controls, "an error with control characters: " + text);
        last_outcome().refusal = text;
        return false;
    }
}

bool accepts(const std::function<void()>& action)
{
    last_outcome().was_accepted = passes(action);
    return last_outcome().was_accepted;
}

}  // namespace shvr::fuzz
