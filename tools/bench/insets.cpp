#include "tools/bench/insets.h"

#include <algorithm>
#include <cmath>
#include <iomanip>

#include "engine/base/error.h"
#include "tools/report/glyphs.h"

namespace shvr::bench {

namespace {

constexpr int CELL = 176, GAP = 8, TITLE = 34, LINE = 14;  // pixels of the sheet

double square_at(const ImageF& picture, const ImageF& truth, int x, int y)
{
    const size_t pixel = 4 * (size_t(y) * size_t(truth.width) + size_t(x));
    double sum = 0.0;
    for (size_t channel = 0; channel < 3; ++channel) {
        const double difference = double(picture.rgba[pixel + channel]) - double(truth.rgba[pixel + channel]);
        sum += difference * difference;
    }
    return sum;
}

void write_word(Image8& image, int x, int y, const std::string& text)
{
    for (size_t i = 0; i < text.size(); ++i)
        for (int column = 0; column < report::GLYPH_COLUMNS; ++column)
            for (int row = 0; row <= report::GLYPH_ROWS; ++row) {
                if (!report::glyph_has(text[i], column, row)) continue;
                const int at_x = x + int(i) * (report::GLYPH_COLUMNS + 1) + column, at_y = y + row;
                if (at_x < 0 || at_y < 0 || at_x >= image.width || at_y >= image.height) continue;
                uint8_t* const pixel = &image.rgba[4 * (size_t(at_y) * size_t(image.width) + size_t(at_x))];
                std::fill_n(pixel, 3, uint8_t(40));
            }
}

void put(Image8& image, const Image8& part, int x, int y)
{
    for (int row = 0; row < part.height; ++row)
        std::copy_n(part.rgba.begin() + int64_t(row) * part.width * 4, size_t(part.width) * 4,
                    image.rgba.begin() + 4 * (int64_t(y + row) * image.width + x));
}

}  // namespace

Window worst_window(const ImageF& picture, const ImageF& truth)
{
    Window worst{0, 0, std::max(truth.width / 4, 1), std::max(truth.height / 4, 1)};
    // Summed-area table: each entry is the sum over all pixels above and to the left.
    const int across = truth.width + 1;
    std::vector<double> sums(size_t(across) * size_t(truth.height + 1));
    const auto sum = [&](int x, int y) -> double& { return sums[size_t(y) * size_t(across) + size_t(x)]; };
    for (int y = 0; y < truth.height; ++y)
        for (int x = 0; x < truth.width; ++x)
            sum(x + 1, y + 1) = square_at(picture, truth, x, y) + sum(x, y + 1) + sum(x + 1, y) - sum(x, y);
    double most = -1.0;
    for (int y = 0; y + worst.height <= truth.height; ++y)
        for (int x = 0; x + worst.width <= truth.width; ++x) {
            const double here =
                sum(x + worst.width, y + worst.height) - sum(x, y + worst.height) - sum(x + worst.width, y) + sum(x, y);
            // Equal sums of errors differ by rounding, so a window must be clearly worse to replace an earlier one.
            if (here > most + 1e-12) most = here, worst.x = x, worst.y = y;
        }
    return worst;
}

Image8 enlarged(const ImageF& picture, const Window& window, int times)
{
    ImageF part{window.width * times, window.height * times, {}};
    for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < part.width; ++x) {
            const int from_x = window.x + x / times, from_y = window.y + y / times;
            const auto pixel = picture.rgba.begin() + 4 * (int64_t(from_y) * picture.width + from_x);
            part.rgba.insert(part.rgba.end(), pixel, pixel + 4);
        }
    return to_image8(part);
}

double rmse_in(const ImageF& picture, const ImageF& truth, const Window& window)
{
    double sum = 0.0;
    for (int y = 0; y < window.height; ++y)
        for (int x = 0; x < window.width; ++x) sum += square_at(picture, truth, window.x + x, window.y + y);
    return std::sqrt(sum / (3.0 * window.width * window.height));
}

Insets insets_of(const Pictures& pictures)
{
    Insets insets{{}, {{"truth", &pictures.reference}}};
    for (const auto* const list : {&pictures.of_qualities, &pictures.of_peers})
        for (const auto& [name, picture] : *list) insets.pictures.emplace_back(name, &picture);
    const auto named = std::ranges::find(pictures.of_qualities, "interactive", &std::pair<std::string, ImageF>::first);
    insets.window =
        worst_window(named == pictures.of_qualities.end() ? pictures.reference : named->second, pictures.reference);
    return insets;
}

Image8 sheet_of(const Results& results, const std::vector<Pictures>& pictures)
{
    size_t most = 1;
    for (const Pictures& each : pictures) most = std::max(most, insets_of(each).pictures.size());
    const int rows = std::max(int(pictures.size()), 1), row_height = CELL * 3 / 4 + TITLE + GAP;
    Image8 sheet{GAP + int(most) * (CELL + GAP), GAP + rows * row_height, {}};
    sheet.rgba.assign(size_t(sheet.width) * size_t(sheet.height) * 4, 255);
    for (size_t row = 0; row < pictures.size(); ++row) {
        const Insets insets = insets_of(pictures[row]);
        const int times = std::max(std::min(CELL / insets.window.width, CELL * 3 / 4 / insets.window.height), 1);
        for (size_t column = 0; column < insets.pictures.size(); ++column) {
            const auto& [name, picture] = insets.pictures[column];
            const int x = GAP + int(column) * (CELL + GAP), y = GAP + int(row) * row_height;
            write_word(sheet, x, y, results.scenes[row].name + (column == 0 ? ": truth" : ": " + name));
            if (column > 0)
                write_word(sheet, x, y + LINE,
                           sentence("RMSE here ", std::setprecision(2),
                                    rmse_in(*picture, pictures[row].reference, insets.window)));
            // A window that does not fit into a cell is cropped at its right and lower end.
            Window shown = insets.window;
            shown.width = std::min(shown.width, CELL / times);
            shown.height = std::min(shown.height, CELL * 3 / 4 / times);
            put(sheet, enlarged(*picture, shown, times), x, y + TITLE);
        }
    }
    return sheet;
}

}  // namespace shvr::bench
