#include "engine/session/transfer_presets.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/base/assets.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/session/session_keys.h"

namespace shvr {

namespace {

constexpr int64_t MAX_FILE_BYTES = 1 << 20;
constexpr double MAX_PLACE = 1e6;
constexpr size_t MAX_NAME_BYTES = 100;

std::vector<std::filesystem::path> preset_files(const std::filesystem::path& folder)
{
    std::vector<std::filesystem::path> files;
    std::error_code ignored;
    for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder, ignored))
        if (entry.path().extension() == ".json") files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

}  // namespace

TransferPreset parse_transfer_preset(const std::string& text, const std::string& name, const std::string& origin)
{
    const JsonDocument json(text, origin, {.expected = "a transfer function"});
    const JsonNode document = json.root();
    document.allow({"note", "points", "extends"});
    TransferPreset preset{.name = name, .note = document["note"].text("a sentence"), .points = {}};
    preset.extends = document["extends"].flag(true);
    double last = -MAX_PLACE;
    for (const JsonNode& element : document["points"].elements()) {
        element.allow({"at", "color", "opacity"});
        ControlPoint point;
        point.intensity = element["at"].number({last, MAX_PLACE});
        point.color = read_color(element["color"]);
        point.opacity = element["opacity"].number(SHARE);
        last = point.intensity;
        preset.points.push_back(point);
    }
    if (preset.points.size() < 2) document["points"].refuse("at least two points");
    return preset;
}

std::vector<TransferPreset> transfer_presets()
{
    const std::filesystem::path folder = asset_folder("transfer_functions");
    std::vector<TransferPreset> presets;
    if (folder.empty()) return presets;
    for (const std::filesystem::path& file : preset_files(folder)) presets.push_back(read_transfer_preset(file));
    return presets;
}

TransferPreset read_transfer_preset(const std::filesystem::path& file)
{
    return parse_transfer_preset(read_text(file, MAX_FILE_BYTES), file.stem().string(), file.string());
}

std::vector<TransferPreset> own_transfer_presets(const std::filesystem::path& folder,
                                                 std::vector<std::string>& warnings)
{
    std::vector<TransferPreset> presets;
    for (const std::filesystem::path& file : preset_files(folder)) {
        try {
            presets.push_back(read_transfer_preset(file));
            presets.back().is_own = true;
        } catch (const Error& error) {
            warnings.emplace_back(error.what());
        }
    }
    return presets;
}

std::string why_no_name(const std::string& name, const char* kind)
{
    const bool is_blank = name.find_first_not_of(' ') == std::string::npos;
    const char* const wrong = is_blank                              ? "is empty"
                              : name[0] == '.'                      ? "begins with a dot"
                              : name.find('/') != std::string::npos ? "has a /"
                              : has_controls(name)                  ? "has characters that cannot be shown"
                              : name.size() > MAX_NAME_BYTES        ? "is too long"
                                                                    : nullptr;
    if (!wrong) return {};
    return sentence(in_quotes(name), " is no name for a ", kind, ", since it ", wrong, "; expected 1 to ",
                    MAX_NAME_BYTES, " bytes without /, not beginning with a dot");
}

std::filesystem::path preset_file(const std::filesystem::path& folder, const std::string& name)
{
    if (const std::string why = why_no_name(name, "transfer function"); !why.empty()) fail(why);
    return folder / (name + ".json");
}

/// Rounds colours to 8 bits per channel, as files store them. Does not round fractions (`at`).
TransferPreset preset_of(const TransferFunction& function, const std::string& name, const VolumeStatistics& statistics)
{
    const TissueRange tissue = tissue_range(statistics);
    TransferPreset preset{.name = name, .note = "Kept by hand.", .points = {}, .extends = false, .is_own = true};
    preset.points.assign(function.points().begin(), function.points().end());
    if (preset.points.size() < 2)
        fail("the transfer function has ", preset.points.size(), " points; expected at least two");
    for (ControlPoint& point : preset.points) {
        point.intensity = (point.intensity - tissue.lower) / (tissue.upper - tissue.lower);
        if (!(std::abs(point.intensity) <= MAX_PLACE))
            fail("the transfer function has a point too far from the volume's intensities to be kept; expected one ",
                 "within a million times the range of its tissue");
    }
    return preset;
}

std::string text_of(const TransferPreset& preset)
{
    TransferPreset written = preset;  // a copy, because fields take mutable objects
    return write_fields({},
                        [&](Fields& f) {
                            f.text("note", written.note, {});
                            f.flag("extends", written.extends, {});
                            f.items("points", written.points.size(), SIZE_MAX,
                                    [&](Fields& point, size_t index, size_t) {
                                        ControlPoint& each = written.points[index];
                                        point.number("at", each.intensity, {-MAX_PLACE, MAX_PLACE}, {});
                                        point.color("color", each.color, {});
                                        point.number("opacity", each.opacity, SHARE, {});
                                    },
                                    {});
                        }) +
           "\n";
}

TransferPreset transfer_preset_named(const std::string& name)
{
    const std::vector<TransferPreset> presets = transfer_presets();
    const auto found = std::ranges::find(presets, name, &TransferPreset::name);
    if (found != presets.end()) return *found;
    std::string names;
    for (const TransferPreset& preset : presets) names += (names.empty() ? "" : ", ") + preset.name;
    fail("transfer_function.preset is \"", name, "\"; expected one of: ", names);
}

TransferFunction transfer_function_of(const TransferPreset& preset, const VolumeStatistics& statistics)
{
    const TissueRange tissue = tissue_range(statistics);
    std::vector<ControlPoint> points = preset.points;
    for (ControlPoint& point : points) point.intensity = tissue.lower + point.intensity * (tissue.upper - tissue.lower);
    if (const double maximum = statistics.range().upper; preset.extends && points.back().intensity < maximum) {
        points.push_back(points.back());
        points.back().intensity = maximum;
    }
    return TransferFunction(std::move(points));
}

}  // namespace shvr
