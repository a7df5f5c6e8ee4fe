#pragma once
// The characters that the font must contain: those of European languages, and any others that occur in displayed texts.
// Pure; one thread.

#include <bitset>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace shvr::ui {

class GlyphSet {
public:
    static constexpr uint32_t LIMIT = 0x10000;  ///< Dear ImGui knows no characters above

    GlyphSet();
    /// Adds UTF-8 text, skipping invalid bytes. Returns whether the text has a character that was not added before.
    bool add(std::string_view text);
    bool add(uint32_t character);
    /// Returns whether any added character is rare, that is, missing from some fonts.
    bool has_rare() const { return has_rare_; }
    /// Returns the first and last character of each contiguous range, ascending.
    std::vector<std::pair<uint16_t, uint16_t>> ranges() const;

private:
    std::bitset<LIMIT> wanted_;
    bool has_rare_ = false;
};

}  // namespace shvr::ui
