#pragma once
// Which characters the font must hold: those of European languages from the start, any other once a text has it. Pure;
// one thread.

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
    /// UTF-8; broken bytes are skipped. Returns whether it has a character that no text before had.
    bool add(std::string_view text);
    bool add(uint32_t character);
    /// Whether there is any that not every font has.
    bool has_rare() const { return has_rare_; }
    /// First and last of each run, ascending.
    std::vector<std::pair<uint16_t, uint16_t>> ranges() const;

private:
    std::bitset<LIMIT> wanted_;
    bool has_rare_ = false;
};

}  // namespace shvr::ui
