// The font atlas: European letters and every other character that a text has used so far, from this machine's fonts.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "engine/workbench/appearance/glyphs.h"
#include "ui/panels/font_files.h"
#include "ui/panels/style.h"
#include "ui/thumbnails/thumbnails.h"

namespace shvr::ui {

namespace {

/// The panels' font is the first of these files that exists; if none exists, Dear ImGui's own font.
constexpr const char* FONTS[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",    // Debian, Ubuntu
                                 "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",  // Fedora
                                 "/usr/share/fonts/TTF/DejaVuSans.ttf",                // Arch
                                 "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
                                 "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"};
/// The font of headings, at the same places; without one, headings have the panels' font.
constexpr const char* BOLD_FONTS[] = {
    "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf", "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans-Bold.ttf",
    "/usr/share/fonts/TTF/DejaVuSans-Bold.ttf", "/usr/share/fonts/truetype/noto/NotoSans-Bold.ttf",
    "/usr/share/fonts/truetype/liberation/LiberationSans-Bold.ttf"};
/// Height of small texts, of the panels' font.
constexpr double SMALL = 0.86;
/// Headings and small texts are the program's own, in English.
constexpr ImWchar ENGLISH[] = {0x20, 0xff, 0};
/// Fonts tried in this order for characters that the panels' font lacks. They are large, so they are read only when
/// such a character is needed.
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
std::array<ImFont*, 3> fonts{};     // by TextRole

std::vector<ImWchar> ranges_of(const GlyphSet& glyphs)
{
    std::vector<ImWchar> ranges;
    for (const auto& [first, last] : glyphs.ranges()) ranges.insert(ranges.end(), {first, last});
    ranges.push_back(0);
    return ranges;
}

enum class For { screen, picture };

/// Returns null if there is no such file.
ImFont* add_font(ImFontAtlas& atlas, const char* path, float pixels, bool is_merged, For purpose, const ImWchar* ranges)
{
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return nullptr;
    ImFontConfig config;
    config.MergeMode = is_merged;
    if (is_merged || purpose == For::picture) config.OversampleH = 1;  // an atlas pixel is a picture pixel
    return atlas.AddFontFromFileTTF(path, pixels, &config, ranges);
}

/// Adds the first of the fonts that this machine has; null if it has none.
ImFont* add_first(ImFontAtlas& atlas, std::span<const char* const> paths, double pixels, For purpose,
                  const ImWchar* ranges)
{
    const float size = float(std::max(1.0, std::round(pixels)));
    for (const char* path : paths)
        if (ImFont* const font = add_font(atlas, path, size, false, purpose, ranges)) return font;
    return nullptr;
}

/// `ranges`: those of `glyphs`; must outlive the atlas.
void fill(ImFontAtlas& atlas, double pixels, For purpose, const GlyphSet& glyphs, const std::vector<ImWchar>& ranges)
{
    const float size = float(std::max(1.0, std::round(pixels)));
    if (!add_first(atlas, FONTS, pixels, purpose, ranges.data())) {
        ImFontConfig config;
        config.SizePixels = size;
        config.OversampleH = 1;
        atlas.AddFontDefault(&config);
    }
    if (glyphs.has_rare())
        for (const char* path : FALLBACKS) add_font(atlas, path, size, true, purpose, ranges.data());
}

/// Returns the next character of a UTF-8 text and its length in bytes. An invalid byte counts as one character.
std::pair<ImWchar, size_t> next_character(std::string_view text)
{
    const auto byte = [&](size_t i) { return i < text.size() ? uint32_t(uint8_t(text[i])) : 0u; };
    const uint32_t first = byte(0);
    if (first < 0x80) return {ImWchar(first), 1};
    if ((first & 0xe0) == 0xc0) return {ImWchar((first & 0x1f) << 6 | (byte(1) & 0x3f)), 2};
    if ((first & 0xf0) == 0xe0) return {ImWchar((first & 0x0f) << 12 | (byte(1) & 0x3f) << 6 | (byte(2) & 0x3f)), 3};
    return {ImWchar('?'), (first & 0xf8) == 0xf0 ? 4 : 1};
}

TextImage image_of(std::string_view text, const ImFont& font, const uint8_t* atlas, const glm::ivec2& atlas_pixels)
{
    const ImVec2 size = font.CalcTextSizeA(font.FontSize, FLT_MAX, 0.0f, text.data(), text.data() + text.size());
    TextImage image{.pixels = {int(std::ceil(size.x)), int(std::ceil(font.FontSize))}, .coverage{}};
    image.coverage.assign(size_t(image.pixels.x) * size_t(image.pixels.y), 0);
    float pen = 0.0f;
    for (size_t at = 0; at < text.size();) {
        const auto [character, bytes] = next_character(text.substr(at));
        at += bytes;
        const ImFontGlyph* const glyph = font.FindGlyph(character);
        if (!glyph) continue;
        const glm::ivec2 from(std::lround(glyph->U0 * float(atlas_pixels.x)),
                              std::lround(glyph->V0 * float(atlas_pixels.y)));
        const glm::ivec2 to(std::lround(glyph->U1 * float(atlas_pixels.x)),
                            std::lround(glyph->V1 * float(atlas_pixels.y)));
        const glm::ivec2 corner(std::lround(pen + glyph->X0), std::lround(glyph->Y0));
        for (int y = 0; y < to.y - from.y; ++y)
            for (int x = 0; x < to.x - from.x; ++x) {
                const glm::ivec2 pixel = corner + glm::ivec2(x, y);
                if (pixel.x < 0 || pixel.y < 0 || pixel.x >= image.pixels.x || pixel.y >= image.pixels.y) continue;
                uint8_t& covered = image.coverage[size_t(pixel.x) + size_t(image.pixels.x) * size_t(pixel.y)];
                covered = std::max(covered, atlas[size_t(from.x + x) + size_t(atlas_pixels.x) * size_t(from.y + y)]);
            }
        pen += glyph->AdvanceX;
    }
    return image;
}

}  // namespace

std::string interface_font()
{
    std::error_code unknown;
    for (const char* path : FONTS)
        if (std::filesystem::is_regular_file(path, unknown)) return path;
    return {};
}

void load_fonts(double pixels)
{
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    atlas.Clear();
    glyph_ranges = ranges_of(known_glyphs);
    fill(atlas, pixels, For::screen, known_glyphs, glyph_ranges);
    fonts = {atlas.Fonts[0], add_first(atlas, BOLD_FONTS, pixels, For::screen, ENGLISH),
             add_first(atlas, FONTS, SMALL * pixels, For::screen, ENGLISH)};
    build_with_thumbnails(atlas);
    is_atlas_stale = false;
}

TextIn::TextIn(TextRole role)
{
    ImFont* const font = fonts[size_t(role)];
    ImGui::PushFont(font ? font : fonts[0]);
}

TextIn::~TextIn()
{
    ImGui::PopFont();
}

std::vector<TextImage> draw_texts(std::span<const std::string> texts, double pixels)
{
    GlyphSet glyphs = known_glyphs;
    for (const std::string& text : texts) glyphs.add(text);
    const std::vector<ImWchar> ranges = ranges_of(glyphs);
    ImFontAtlas atlas;
    fill(atlas, pixels, For::picture, glyphs, ranges);
    uint8_t* coverage = nullptr;
    glm::ivec2 size(0);
    atlas.GetTexDataAsAlpha8(&coverage, &size.x, &size.y);
    std::vector<TextImage> images;
    for (const std::string& text : texts) images.push_back(image_of(text, *atlas.Fonts[0], coverage, size));
    return images;
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
    return is_atlas_stale || thumbnails_are_stale();
}

}  // namespace shvr::ui
