#include "engine/workbench/sight/figure_measures.h"

#include <algorithm>
#include <utility>

#include "engine/base/text.h"
#include "engine/workbench/sight/figure_texts.h"
#include "engine/workbench/sight/measure_lines.h"

namespace shvr::ui {

namespace {

/// Widths, in lines of text.
constexpr double SIDE = 0.1, ARC = 0.07, LEADER = 0.05, DOT_RADIUS = 0.15, AVOIDED_AROUND_DOTS = 0.5;

/// Returns the label, its name shortened so that it fits into the width with the value; empty if the value is too wide.
std::string fitted(const MeasureLabel& label, double width, const FigurePane& drawn)
{
    const std::string whole = label.text();
    const std::vector<std::string> parts{whole, ": " + label.value, label.value};
    const std::vector<double> widths = widths_of(parts, drawn.line(), drawn.draw_texts());
    if (widths[0] <= width) return whole;
    if (widths[2] > width) return {};
    return MeasureLabel{shortened(label.name, width - widths[1], drawn.line(), drawn.draw_texts()), label.value}.text();
}

/// Writes labels next to their lines. Returns which of them are written: those that cover nothing.
std::vector<bool> write_labels(FigurePane& drawn, const std::vector<std::string>& texts, std::vector<LabelPlace> places,
                               std::span<const LabelLine> lines, std::span<const size_t> keys, LabelMemory* memory)
{
    const double line = drawn.line();
    const glm::dvec2 margin = LABEL_MARGIN * (line / FONT_UNITS);
    std::vector<glm::dvec2> sizes;
    for (const double width : widths_of(texts, line, drawn.draw_texts()))
        sizes.push_back(glm::dvec2(width, line) + 2.0 * margin);
    const std::vector<LabelPlace> before = places;
    for (const FigurePane::Box& box : drawn.taken()) {  // which stay
        places.push_back({.at = box.begin});
        sizes.push_back(box.end - box.begin);
    }
    spread_as_before(places, sizes, drawn.size(), lines, keys, memory);
    std::vector<bool> is_written;
    std::vector<FigurePane::Words> words;
    std::vector<LabelLine> leaders;
    for (size_t i = 0; i < texts.size(); ++i) {
        const glm::dvec2 begin = places[i].at - places[i].anchor * sizes[i];
        const FigurePane::Box box{begin, begin + sizes[i]};
        is_written.push_back(drawn.is_free(box));
        if (!is_written.back()) continue;
        drawn.take(box);
        words.push_back({begin + margin, {0.0, 0.0}, texts[i]});
        if (const auto leader = leader_of(before[i], places[i], sizes[i])) leaders.push_back(*leader);
    }
    drawn.lines(leaders, std::max(1.0, LEADER * line));
    drawn.write(words, line);
    return is_written;
}

}  // namespace

void draw_measurements(FigurePane& drawn, const Pane& pane, std::span<const Measurement> all, const VolumeInfo& volume,
                       LabelMemory* memory, bool is_first, std::vector<std::string>& left_out)
{
    if (all.empty()) {
        if (is_first) left_out.emplace_back("the measurements are left out: the session has none");
        return;
    }
    const double line = drawn.line();
    std::vector<LabelLine> sides, arcs;
    std::vector<LabelPlace> places;
    std::vector<std::string> wholes, texts;
    std::vector<size_t> keys;
    size_t seen = 0;
    for (size_t i = 0; i < all.size(); ++i) {
        const MeasureLines shown = lines_of(all[i], pane, volume, line / FONT_UNITS);
        sides.insert(sides.end(), shown.sides.begin(), shown.sides.end());
        arcs.insert(arcs.end(), shown.arc.begin(), shown.arc.end());
        if (!shown.label) continue;
        ++seen;
        MeasureLabel label = label_of(all[i], i + 1, volume);
        label.value += shown.note;
        std::string text = fitted(label, drawn.size().x - drawn.edge(), drawn);
        if (text.empty()) continue;
        places.push_back(*shown.label);
        keys.push_back(i + 1);
        wholes.push_back(label.text());
        texts.push_back(std::move(text));
    }
    if (is_first && pane.kind == Pane::Kind::main && seen < all.size())
        left_out.push_back(sentence(counted(int64_t(all.size() - seen), "measurement"), " of ", all.size(),
                                    " cannot be seen: outside of the picture"));
    drawn.lines(sides, std::max(1.5, SIDE * line));
    drawn.lines(arcs, std::max(1.2, ARC * line));
    std::vector<LabelLine> avoided = sides;
    for (const LabelLine& side : sides)
        for (const glm::dvec2& end : {side.from, side.to}) {
            drawn.dot(end, DOT_RADIUS * line);
            avoided.push_back(avoided_around(end, AVOIDED_AROUND_DOTS * line));
        }
    const std::vector<bool> is_written = write_labels(drawn, texts, std::move(places), avoided, keys, memory);
    bool is_shortened = false;
    for (size_t i = 0; i < texts.size(); ++i) is_shortened = is_shortened || (is_written[i] && texts[i] != wholes[i]);
    if (is_shortened) left_out.emplace_back("names of measurements are shortened: the picture is too small for them");
    if (const ptrdiff_t missing = ptrdiff_t(seen) - std::ranges::count(is_written, true); missing > 0)
        left_out.push_back(sentence(counted(missing, "label"), " of measurements ", missing == 1 ? "is" : "are",
                                    " left out: the picture is too small for ", missing == 1 ? "it" : "all of them"));
}

}  // namespace shvr::ui
