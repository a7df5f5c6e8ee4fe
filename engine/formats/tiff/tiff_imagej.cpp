// Reads ImageJ's description: lines of "key=value", the first of which states ImageJ's version. (ImageJ's
// ij/io/FileSaver.java writes it, ij/io/FileOpener.java reads it.)

#include <charconv>
#include <cmath>
#include <map>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/tiff/tiff_description.h"

namespace shvr {
namespace {

/// Decodes \uXXXX, which Java's Properties write for non-ASCII characters.
std::string without_escapes(std::string_view text)
{
    std::string plain;
    for (size_t at = 0; at < text.size(); ++at) {
        uint32_t code = 0;
        const char* const digits = text.data() + at + 2;
        const bool is_escape = text.substr(at).starts_with("\\u") && text.size() - at >= 6 &&
                               std::from_chars(digits, digits + 4, code, 16).ptr == digits + 4 && code >= 0x80;
        if (!is_escape) {
            plain += text[at];
            continue;
        }
        // Encoded as UTF-8.
        if (code < 0x800) {
            plain += char(0xc0 | code >> 6);
        } else {
            plain += char(0xe0 | code >> 12);
            plain += char(0x80 | (code >> 6 & 0x3f));
        }
        plain += char(0x80 | (code & 0x3f));
        at += 5;
    }
    return plain;
}

class Lines {
public:
    Lines(std::string subject, std::string_view text) : subject_(std::move(subject))
    {
        while (!text.empty()) {
            const std::string_view line = take_line(text);
            const size_t separator = line.find('=');
            if (separator == std::string_view::npos) continue;
            values_.emplace(trimmed(line.substr(0, separator)), trimmed(line.substr(separator + 1)));
        }
    }

    std::string text(const char* key) const
    {
        const auto found = values_.find(key);
        return found == values_.end() ? std::string() : found->second;
    }
    std::optional<double> number(const char* key) const { return number_of(text(key)); }
    /// 0 if nothing is stated.
    int64_t count(const char* key) const
    {
        const std::string stated = text(key);
        if (stated.empty()) return 0;
        const std::optional<int64_t> count = whole_of(stated);
        if (!count || *count < 1 || *count > int64_t(MAX_TIFF_PAGES)) {
            fail(subject_, ": ", key, " is ", in_quotes(stated), "; expected a whole number from 1 to ",
                 MAX_TIFF_PAGES);
        }
        return *count;
    }

private:
    std::string subject_;
    std::map<std::string, std::string> values_;
};

/// Parses space-separated numbers, one for each component of `Value`; null if they are malformed.
template <class Value, size_t COUNT>
std::optional<Value> numbers_of(const std::string& text)
{
    const std::vector<std::string_view> words = words_of(text);
    Value value{0.0};
    if (words.size() != COUNT) return {};
    for (size_t i = 0; i < COUNT; ++i) {
        const std::optional<double> number = number_of(words[i]);
        if (!number || !std::isfinite(*number)) return {};
        if constexpr (COUNT == 3)
            value[int(i)] = *number;
        else
            value[int(i / 3)][int(i % 3)] = *number;
    }
    return value;
}

/// Reads the lines "shvr_...", which only this program writes.
void read_own_lines(const Lines& lines, TiffDescription& description)
{
    description.place = {numbers_of<glm::dvec3, 3>(lines.text("shvr_spacing")),
                         numbers_of<glm::dvec3, 3>(lines.text("shvr_origin")),
                         numbers_of<glm::dmat3, 9>(lines.text("shvr_directions")), printable(lines.text("shvr_frame"))};
    description.content = printable(lines.text("shvr_content"));
    warn_of_content(description.warnings, description.content);
}

void read_calibration(const Lines& lines, TiffDescription& description)
{
    const std::optional<double> function = lines.number("cf");
    if (!function) return;
    const double offset = lines.number("c0").value_or(0.0);
    const double slope = lines.number("c1").value_or(1.0);
    if (*function == 0.0 && offset == -32768.0 && slope == 1.0) {
        description.counts_from_minus_32768 = true;
        return;
    }
    if (*function == 0.0 && offset == 0.0 && slope == 1.0) return;
    // In ImageJ, function codes 20 and 21 mean "no calibration"; 21 is shown as uncalibrated optical density.
    if (*function == 20.0 || *function == 21.0) return;
    description.warnings.push_back(
        *function == 0.0 ? sentence("intensities are calibrated as ", offset, " + ", slope,
                                    " times what is stored; they are shown as stored")
                         : std::string("intensities are calibrated by a curve; they are shown as stored"));
}

}  // namespace

TiffDescription read_imagej_description(const std::string& subject, std::string_view text)
{
    const Lines lines(subject + ": its ImageJ description", text);
    TiffDescription description{.writer = TiffDescription::Writer::imagej};
    const int64_t images = std::max<int64_t>(1, lines.count("images"));
    description.channels = std::max<int64_t>(1, lines.count("channels"));
    description.frames = std::max<int64_t>(1, lines.count("frames"));
    description.slices = lines.count("slices");
    // If the number of slices is missing, it is computed: the number of images per channel and frame.
    if (description.slices == 0) {
        description.slices = std::max<int64_t>(1, images / (description.channels * description.frames));
    }
    const int64_t product = description.slices * description.channels;  // each at most 2^20
    if (images > 1 && (product > images || product * description.frames != images)) {
        fail(subject, ": its ImageJ description counts ", images, " images but ", description.channels, " x ",
             description.slices, " x ", description.frames,
             " channels, slices and frames; expected equal counts: save it again, for example from Fiji");
    }

    const std::string unit = without_escapes(lines.text("unit"));
    const std::string y_unit = without_escapes(lines.text("yunit"));
    const std::string z_unit = without_escapes(lines.text("zunit"));
    description.unit[0] = unit;
    description.unit[1] = y_unit.empty() ? unit : y_unit;
    description.unit[2] = z_unit.empty() ? unit : z_unit;
    // Ignores the sign: old versions of ImageJ wrote a signed distance between slices.
    if (const std::optional<double> spacing = lines.number("spacing"); spacing && std::isfinite(*spacing)) {
        if (*spacing != 0.0) description.spacing[2] = std::abs(*spacing);
    }
    read_own_lines(lines, description);
    read_calibration(lines, description);
    return description;
}

}  // namespace shvr
