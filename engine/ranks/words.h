#pragma once
// The texts of mail between desk and workers: a word, and what belongs to it.
//
//   worker to desk: want | rows LOWER UPPER, with the pixels | done REPORT | failed SENTENCE; the last two end a worker
//   desk to worker: draw LOWER UPPER | end

#include <charconv>
#include <string>
#include <string_view>

#include "engine/base/error.h"
#include "engine/ranks/row_plan.h"

namespace shvr {

class RankWords {
public:
    static constexpr const char *WANT = "want", *ROWS = "rows", *DONE = "done", *FAILED = "failed", *DRAW = "draw",
                                *END = "end";

    static std::string draw(const RowStrip& strip) { return sentence(DRAW, ' ', strip.lower, ' ', strip.upper); }
    static std::string rows(const RowStrip& strip) { return sentence(ROWS, ' ', strip.lower, ' ', strip.upper); }
    static std::string done(const std::string& report) { return sentence(DONE, ' ', report); }
    static std::string failed(const std::string& why) { return sentence(FAILED, ' ', why); }

    explicit RankWords(std::string_view text) : text_(text), word_(text.substr(0, text.find(' '))) {}
    std::string_view kind() const { return word_; }
    std::string rest() const { return std::string(text_.substr(std::min(word_.size() + 1, text_.size()))); }
    bool is_last() const { return word_ == DONE || word_ == FAILED; }
    RowStrip strip() const
    {
        RowStrip strip;
        const std::string numbers = rest();
        const char* const end = numbers.data() + numbers.size();
        const auto lower = std::from_chars(numbers.data(), end, strip.lower);
        SHVR_CHECK(lower.ec == std::errc() && lower.ptr < end, text_);
        const auto upper = std::from_chars(lower.ptr + 1, end, strip.upper);
        SHVR_CHECK(upper.ec == std::errc() && strip.lower <= strip.upper, text_);
        return strip;
    }

private:
    std::string_view text_, word_;
};

}  // namespace shvr
