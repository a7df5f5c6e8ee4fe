#include "ui/screen_text.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <unordered_map>

#include <imgui/imgui.h>
#include <imgui/imgui_internal.h>

#include "engine/base/error.h"

namespace shvr::ui {

namespace {

/// Tolerances in pixels, since glyphs are snapped to whole pixels.
constexpr float NEAR = 0.75f, CUT = 1.0f;
constexpr int MAX_SPACES = 3;  ///< in a row within one text

struct Box {
    glm::vec2 begin{0}, end{0};
};

/// Two triangles that show one glyph, as ImFont::RenderText emits them.
struct Quad {
    Box place, texels;
};

/// A glyph and the font that has it.
struct Found {
    const ImFontGlyph* glyph = nullptr;
    const ImFont* font = nullptr;
};

class Glyphs {
public:
    explicit Glyphs(const ImFontAtlas& atlas) : atlas_(atlas) {}

    Found at(const Box& texels)
    {
        const glm::vec2 middle = 0.5f * (texels.begin + texels.end);
        const auto [known, is_new] = known_.try_emplace(key_of(texels));
        if (!is_new) return known->second;
        for (const ImFont* font : atlas_.Fonts)
            for (const ImFontGlyph& glyph : font->Glyphs)
                if (glyph.Visible && middle.x > glyph.U0 && middle.x < glyph.U1 && middle.y > glyph.V0 &&
                    middle.y < glyph.V1)
                    known->second = {&glyph, font};
        return known->second;
    }

private:
    static uint64_t key_of(const Box& texels)
    {
        uint32_t parts[4];
        std::memcpy(parts, &texels, sizeof parts);
        return (uint64_t(parts[0]) << 32 | parts[1]) ^ (uint64_t(parts[2]) * 0x9e3779b97f4a7c15u) ^ parts[3];
    }

    const ImFontAtlas& atlas_;
    std::unordered_map<uint64_t, Found> known_;
};

std::string utf8_of(unsigned int character)
{
    char text[5] = {};
    ImTextCharToUtf8(text, character);
    return text;
}

/// Returns the quad whose six indices begin at `index`; null if the indices do not form a quad.
std::optional<Quad> quad_at(const ImDrawList& list, unsigned int index)
{
    const ImDrawIdx* const at = &list.IdxBuffer[int(index)];
    const unsigned int first = at[0];
    constexpr unsigned int STEPS[] = {0, 1, 2, 0, 2, 3};
    for (unsigned int i = 0; i < 6; ++i)
        if (at[i] != first + STEPS[i]) return std::nullopt;
    const ImDrawVert &a = list.VtxBuffer[int(first)], &c = list.VtxBuffer[int(first) + 2];
    if (!(a.uv.x < c.uv.x && a.uv.y < c.uv.y && a.pos.x < c.pos.x && a.pos.y < c.pos.y)) return std::nullopt;
    return Quad{{{a.pos.x, a.pos.y}, {c.pos.x, c.pos.y}}, {{a.uv.x, a.uv.y}, {c.uv.x, c.uv.y}}};
}

/// Joins the glyphs of one draw list into texts.
class Lines {
public:
    Lines(std::string window, std::vector<ScreenText>& texts, Glyphs& glyphs)
        : window_(std::move(window)), texts_(texts), glyphs_(glyphs)
    {}

    void add(const Quad& quad, const ImVec4& clip)
    {
        const auto [glyph, font] = glyphs_.at(quad.texels);
        if (!glyph) return;
        // Reconstructs the quad of the whole glyph, of which clipping may have removed a part.
        const glm::vec2 scale = (quad.place.end - quad.place.begin) / (quad.texels.end - quad.texels.begin);
        const glm::vec2 whole_begin = quad.place.begin - (quad.texels.begin - glm::vec2(glyph->U0, glyph->V0)) * scale;
        const glm::vec2 whole_end = quad.place.end + (glm::vec2(glyph->U1, glyph->V1) - quad.texels.end) * scale;
        const float size = (whole_end.x - whole_begin.x) / (glyph->X1 - glyph->X0);
        const float pen = whole_begin.x - glyph->X0 * size, top = whole_begin.y - glyph->Y0 * size;
        const glm::vec2 begin = glm::max(quad.place.begin, {clip.x, clip.y});
        const glm::vec2 end = glm::min(quad.place.end, {clip.z, clip.w});
        const bool is_seen = begin.x < end.x && begin.y < end.y;

        if (font != font_ || !continues(pen, top, size, is_seen)) begin_text(top, *font);
        ScreenText* const text = has_text_ ? &texts_.back() : nullptr;
        // Characters entirely beyond the edge are not drawn, so a text cut between two characters is not detected.
        const bool is_cut = begin.x > whole_begin.x + CUT || end.x < whole_end.x - CUT;
        if (is_seen && !text) {
            texts_.push_back({.text = {}, .window = window_, .begin = begin, .end = end});
            has_text_ = true;
        }
        if (is_seen) {
            ScreenText& now = texts_.back();
            now.text += utf8_of(glyph->Codepoint);
            now.begin = glm::min(now.begin, begin);
            now.end = glm::max(now.end, end);
            now.is_cut |= is_cut;
            now.is_scrolled |= begin.y > whole_begin.y + CUT || end.y < whole_end.y - CUT;
        } else if (text && quad.place.end.y > clip.y && quad.place.begin.y < clip.w) {
            text->is_cut = true;
        }
        next_pen_ = pen + glyph->AdvanceX * size;
    }

private:
    /// Returns whether the glyph continues the current text; if so, appends the spaces in between.
    bool continues(float pen, float top, float size, bool is_seen)
    {
        if (!has_text_ || std::abs(top - top_) > NEAR) return false;
        const float space = font_->GetCharAdvance(' ') * size, spaces = (pen - next_pen_) / space;
        const float whole = std::round(spaces);
        if (whole < 0.0f || whole > MAX_SPACES || std::abs(spaces - whole) * space > NEAR) return false;
        if (is_seen) texts_.back().text.append(size_t(whole), ' ');
        return true;
    }
    void begin_text(float top, const ImFont& font)
    {
        has_text_ = false;
        top_ = top;
        font_ = &font;
    }

    std::string window_;
    std::vector<ScreenText>& texts_;
    Glyphs& glyphs_;
    const ImFont* font_ = nullptr;  ///< the font of the present text
    bool has_text_ = false;
    float next_pen_ = 0.0f, top_ = 0.0f;
};

/// Removes texts that another covers: their rims (app_draw.cpp), which are the same texts some pixels away.
void remove_rims(std::vector<ScreenText>& texts)
{
    constexpr float MOST = 3.0f;
    std::vector<ScreenText> kept;
    for (size_t i = 0; i < texts.size(); ++i) {
        const bool is_rim = i + 1 < texts.size() && texts[i].text == texts[i + 1].text &&
                            texts[i].window == texts[i + 1].window &&
                            glm::all(glm::lessThan(glm::abs(texts[i].begin - texts[i + 1].begin), glm::vec2(MOST)));
        if (!is_rim) kept.push_back(std::move(texts[i]));
    }
    texts = std::move(kept);
}

std::string quoted(const std::string& text)
{
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') quoted += '\\';
        quoted += uint8_t(c) < 0x20 ? ' ' : c;
    }
    return quoted + '"';
}

}  // namespace

std::vector<ScreenText> screen_texts(const ImDrawData& drawn, const ImFontAtlas& fonts)
{
    std::vector<ScreenText> texts;
    Glyphs glyphs(fonts);
    for (int number = 0; number < drawn.CmdListsCount; ++number) {
        const ImDrawList& list = *drawn.CmdLists[number];
        Lines lines(list._OwnerName ? list._OwnerName : "", texts, glyphs);
        for (const ImDrawCmd& command : list.CmdBuffer) {
            const unsigned int end = command.IdxOffset + command.ElemCount;
            for (unsigned int index = command.IdxOffset; index + 6 <= end;) {
                const std::optional<Quad> quad = quad_at(list, index);
                if (quad) lines.add(*quad, command.ClipRect);
                index += quad ? 6 : 3;
            }
        }
    }
    remove_rims(texts);
    const glm::vec2 scale(drawn.FramebufferScale.x, drawn.FramebufferScale.y);
    for (ScreenText& text : texts) {
        text.begin *= scale;
        text.end *= scale;
    }
    return texts;
}

std::string json_of(const std::vector<ScreenText>& texts, const FrameState& frame)
{
    std::string json = sentence("{\"frame\":", frame.number, ",\"sharp\":", frame.is_sharp ? "true" : "false",
                                ",\"kept\":", frame.is_kept ? "true" : "false", ",\"texts\":[");
    for (const ScreenText& text : texts)
        json += sentence(&text == texts.data() ? "" : ",", "\n{\"text\":", quoted(text.text),
                         ",\"window\":", quoted(text.window), ",\"box\":[", text.begin.x, ',', text.begin.y, ',',
                         text.end.x, ',', text.end.y, "],\"cut\":", text.is_cut ? "true" : "false",
                         ",\"scrolled\":", text.is_scrolled ? "true" : "false", '}');
    return json + "]}\n";
}

}  // namespace shvr::ui
