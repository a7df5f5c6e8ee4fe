// The font atlas: European letters, and every other character that a text had so far, from whatever fonts are here.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "ui/panels/style.h"
#include "ui/workbench/appearance/glyphs.h"

namespace shvr::ui {

namespace {

/// The first that exists is the panels' font; otherwise Dear ImGui's own.
constexpr const char* FONTS[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",    // Debian, Ubuntu
                                 "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",  // Fedora
                                 "/usr/share/fonts/TTF/DejaVuSans.ttf",                // Arch
                                 "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
                                 "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"};
/// What the one before has not, the next may have. Read only once a rare character is known_glyphs: they are large.
constexpr const char* FALLBACKS[] = {
    "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf",  // fonts-droid-fallback
    "/usr/share/fonts-droid-fallback/truetype/DroidSansFallback.ttf",
    "/usr/share/fonts/truetype/wqy/wqy-microhei.ttc",
    "/usr/share/fonts/opentype/noto/NotoSansCJK-Regular.ttc",
    "/usr/share/fonts/google-noto-cjk/NotoSansCJK-Regular.ttc",  // Fedora
    "/usr/share/fonts/noto-cjk/NotoSansCJK-Regular.ttc",         // Arch
    "/usr/share/fonts/truetype/noto/NotoSansArabic-Regular.ttf",
    "/usr/share/fonts/truetype/noto/NotoSansHebrew-Regular.ttf",
    "/usr/share/fonts/truetype/noto/NotoSansDevanagari-Regular.ttf",
    "/usr/share/fonts/truetype/noto/NotoSansThai-Regular.ttf",
    "/usr/share/fonts/truetype/freefont/FreeSans.ttf"};

GlyphSet known_glyphs;
bool is_atlas_stale = false;
std::vector<ImWchar> glyph_ranges;  // the atlas keeps a pointer to them

void fill_ranges()
{
    glyph_ranges.clear();
    for (const auto& [first, last] : known_glyphs.ranges()) glyph_ranges.insert(glyph_ranges.end(), {first, last});
    glyph_ranges.push_back(0);
}

bool add_font(const char* path, float pixels, bool is_merged)
{
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return false;
    ImFontConfig config;
    config.MergeMode = is_merged;
    if (is_merged) config.OversampleH = 1;
    return ImGui::GetIO().Fonts->AddFontFromFileTTF(path, pixels, &config, glyph_ranges.data()) != nullptr;
}

}  // namespace

void load_fonts(double pixels);

void load_fonts(double pixels)
{
    const float size = float(std::max(1.0, std::round(pixels)));
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    atlas.Clear();
    fill_ranges();
    const bool is_found = std::ranges::any_of(FONTS, [&](const char* path) { return add_font(path, size, false); });
    if (!is_found) {
        ImFontConfig config;
        config.SizePixels = size;
        atlas.AddFontDefault(&config);
    }
    if (known_glyphs.has_rare())
        for (const char* path : FALLBACKS) add_font(path, size, true);
    is_atlas_stale = false;
}

void want_glyphs(std::string_view text)
{
    is_atlas_stale = known_glyphs.add(text) || is_atlas_stale;
}

void want_typed_glyphs()
{
    for (const ImWchar character : ImGui::GetIO().InputQueueCharacters)
        is_atlas_stale = known_glyphs.add(uint32_t{character}) || is_atlas_stale;
}

bool fonts_are_stale()
{
    return is_atlas_stale;
}

}  // namespace shvr::ui
