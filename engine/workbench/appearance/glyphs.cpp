#include "engine/workbench/appearance/glyphs.h"

namespace shvr::ui {

namespace {

// Latin letters; dashes, quotation marks and dots; arrows and other symbols that panels use.
constexpr std::pair<uint32_t, uint32_t> ALWAYS[] = {{0x20, 0x7e},     {0xa0, 0x17f},    {0x2010, 0x2026},
                                                    {0x2190, 0x2195}, {0x221a, 0x221a}, {0x2248, 0x2248},
                                                    {0x2264, 0x2265}, {0xfffd, 0xfffd}};
constexpr uint32_t FIRST_RARE = 0x530;  ///< after Greek and Cyrillic

/// Removes the first character from `text` and returns it; returns 0 for invalid UTF-8.
uint32_t take_character(std::string_view& text)
{
    const uint8_t first = uint8_t(text.front());
    text.remove_prefix(1);
    if (first < 0x80) return first;
    const size_t more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : first >= 0xc0 ? 1 : 0;
    if (more == 0 || text.size() < more) return 0;
    uint32_t character = first & (0x3fu >> more);
    for (size_t i = 0; i < more; ++i) {
        const uint8_t next = uint8_t(text[i]);
        if ((next & 0xc0) != 0x80) return 0;
        character = character << 6 | (next & 0x3fu);
    }
    text.remove_prefix(more);
    return character;
}

}  // namespace

GlyphSet::GlyphSet()
{
    for (const auto& [first, last] : ALWAYS)
        for (uint32_t character = first; character <= last; ++character) wanted_.set(character);
}

bool GlyphSet::add(uint32_t character)
{
    if (character < 0x80 || character >= LIMIT || wanted_[character]) return false;
    wanted_.set(character);
    has_rare_ = has_rare_ || character >= FIRST_RARE;
    return true;
}

bool GlyphSet::add(std::string_view text)
{
    bool is_new = false;
    while (!text.empty()) is_new = add(take_character(text)) || is_new;
    return is_new;
}

std::vector<std::pair<uint16_t, uint16_t>> GlyphSet::ranges() const
{
    std::vector<std::pair<uint16_t, uint16_t>> runs;
    for (uint32_t character = 1; character < LIMIT; ++character) {
        if (!wanted_[character]) continue;
        if (!runs.empty() && uint32_t{runs.back().second} + 1 == character)
            runs.back().second = uint16_t(character);
        else
            runs.emplace_back(uint16_t(character), uint16_t(character));
    }
    return runs;
}

}  // namespace shvr::ui
