#include "engine/workbench/actions/figure_text.h"

#include <utility>

#include "engine/base/error.h"
#include "engine/session/fields.h"
#include "engine/session/picture_session.h"

namespace shvr::ui {

namespace {

constexpr const char* ELEMENTS_TEXT = "SHVR figure";
constexpr size_t MAX_BYTES = size_t{64} << 10;
const JsonLimits LIMITS{.depth = 8, .expected = "the elements of a figure"};

void record_fields(Fields& f, DrawnElements& elements)
{
    int64_t version = 1;
    f.whole("shvr_figure", version, 1, 1, {.meaning = "version of this format", .is_required = true});
    element_fields(f, elements);
    std::optional<double> text_pixels;
    if (elements.text_pixels > 0.0) text_pixels = elements.text_pixels;
    f.number("text_pixels", text_pixels, {MIN_TEXT_PIXELS, MAX_TEXT_PIXELS}, {"height of a line of text"});
    elements.text_pixels = text_pixels.value_or(0.0);
}

DrawnElements read_elements(const std::string& text, const std::string& origin)
{
    if (text.size() > MAX_BYTES)
        fail(origin, ": the elements of the figure take ", text.size(), " bytes; expected at most ", MAX_BYTES);
    const JsonDocument document(text, origin, LIMITS);
    DrawnElements elements;
    read_fields(document.root(), {}, [&](Fields& f) { record_fields(f, elements); });
    return elements;
}

}  // namespace

void add_elements(PictureTexts& texts, const DrawnElements& elements)
{
    if (elements.is_empty()) return;
    DrawnElements written = elements;  // a copy, since visitors take mutable values
    std::string text = write_fields({}, [&](Fields& f) { record_fields(f, written); });
    static_cast<void>(read_elements(text, "the figure"));
    texts.emplace_back(ELEMENTS_TEXT, std::move(text));
}

std::optional<DrawnElements> elements_in_picture(const std::filesystem::path& picture)
{
    const std::optional<std::string> text = text_in_picture(picture, ELEMENTS_TEXT);
    return text ? std::optional(read_elements(*text, picture.string())) : std::nullopt;
}

}  // namespace shvr::ui
