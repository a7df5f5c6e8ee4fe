#include "engine/formats/dicom/dicom_series.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "engine/base/error.h"
#include "engine/formats/choice.h"
#include "engine/formats/data_files.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/orientation.h"

namespace shvr {
namespace {

/// Positions closer than this count as equal, since files round positions to about six digits.
constexpr double SAME_PLACE_MM = 1e-3;
/// Distances may differ by this fraction.
constexpr double SAME_DISTANCE = 0.01;

/// A slice and the values that determine its order.
struct Placed {
    DicomSlice slice{};
    double along = 0.0;  ///< mm, along the normal
    const DicomFile* file = nullptr;
    const DicomFrame* frame = nullptr;
};

std::string with_digits(double number)
{
    return sentence(std::setprecision(6), number);
}

/// Tolerance for direction cosines, which files state with few digits and scanners compute again for each slice.
constexpr double SAME_DIRECTION = 2e-3;

/// Whether two slices can be stacked: their sizes and types are equal, and their directions differ only by rounding.
bool are_of_one_kind(const Placed& a, const Placed& b)
{
    const auto are_near = [](const glm::dvec3& one, const glm::dvec3& other) {
        return glm::all(glm::lessThan(glm::abs(one - other), glm::dvec3(SAME_DIRECTION)));
    };
    return a.file->columns == b.file->columns && a.file->rows == b.file->rows && a.file->type == b.file->type &&
           are_near(a.frame->along_x, b.frame->along_x) && are_near(a.frame->along_y, b.frame->along_y);
}

/// Returns the largest set of stackable slices. Others, such as a scout image next to an axial series, are left out.
std::vector<Placed> slices_of_one_kind(const std::vector<Placed>& all, VolumeInfo& info)
{
    std::vector<std::vector<Placed>> kinds;
    for (const Placed& slice : all) {
        const auto kind = std::find_if(kinds.begin(), kinds.end(),
                                       [&](const auto& each) { return are_of_one_kind(each.front(), slice); });
        if (kind == kinds.end())
            kinds.push_back({slice});
        else
            kind->push_back(slice);
    }
    const auto most =
        std::max_element(kinds.begin(), kinds.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (const size_t others = all.size() - most->size(); others > 0) {
        info.warnings.push_back(sentence(counted(others, "slice"), " of another size, type or direction ignored"));
    }
    return std::move(*most);
}

constexpr std::string_view STACK = "stack ";

/// Returns all slices or, if the files hold several stacks of slices, those of the stack that the options choose.
std::vector<Placed> choose_stack(const std::string& where, const std::vector<DicomFile>& files, OpenOptions& options)
{
    std::vector<Placed> all;
    std::map<std::string, size_t> stacks;
    for (size_t i = 0; i < files.size(); ++i)
        for (size_t j = 0; j < files[i].frames.size(); ++j) {
            all.push_back({{i, j}, 0.0, &files[i], &files[i].frames[j]});
            if (!files[i].frames[j].stack.empty()) ++stacks[files[i].frames[j].stack];
        }
    const bool are_single =
        std::all_of(stacks.begin(), stacks.end(), [](const auto& each) { return each.second == 1; });
    if (stacks.size() < 2 || are_single) return all;
    Choice choice{"frame", {}};
    std::string choices;
    for (const auto& [name, slices] : stacks) {
        choice.values.push_back(std::string(STACK) + name);
        choice.titles.push_back(sentence(STACK, name, " (", slices, " slices)"));
        choices += (choices.empty() ? "" : ", ") + choice.titles.back();
    }
    const auto chosen = std::find(choice.values.begin(), choice.values.end(), options.frame);
    if (chosen == choice.values.end())
        throw ChoiceNeeded(sentence(where, ": ",
                                    options.frame.empty() ? sentence("holds ", stacks.size(), " stacks of slices")
                                                          : sentence("frame is ", in_quotes(options.frame)),
                                    "; expected a frame, one of: ", choices),
                           {std::move(choice)});
    const std::string name = chosen->substr(STACK.size());
    options.frame.clear();
    std::erase_if(all, [&](const Placed& slice) { return slice.frame->stack != name; });
    return all;
}

/// Returns a sort key for slices at the same position.
auto number_of(const Placed& slice)
{
    return std::tuple(slice.frame->time_number, slice.file->time_number, slice.file->instance_number, slice.slice.file,
                      slice.slice.frame);
}

/// Sorts slices along their normal, or by number if some lack a position. Returns whether all state positions.
bool sort_slices(std::vector<Placed>& slices, VolumeInfo& info)
{
    const bool are_placed = std::all_of(slices.begin(), slices.end(), [](const Placed& slice) {
        return slice.frame->position.has_value() && slice.frame->has_orientation;
    });
    const glm::dvec3 normal = glm::cross(slices[0].frame->along_x, slices[0].frame->along_y);
    for (Placed& slice : slices) {
        if (are_placed) slice.along = glm::dot(*slice.frame->position, normal);
    }
    std::sort(slices.begin(), slices.end(), [&](const Placed& a, const Placed& b) {
        return a.along != b.along ? a.along < b.along : number_of(a) < number_of(b);
    });
    if (!are_placed && slices.size() > 1) {
        info.warnings.emplace_back("slices do not state their positions; they are sorted by instance number");
    }
    return are_placed;
}

/// Removes duplicates of slices, which are common in exports.
void leave_out_copies(std::vector<Placed>& slices, VolumeInfo& info)
{
    std::set<std::pair<std::string, size_t>> seen;
    const size_t before = slices.size();
    std::erase_if(slices, [&](const Placed& slice) {
        return !slice.file->instance_uid.empty() && !seen.emplace(slice.file->instance_uid, slice.slice.frame).second;
    });
    if (slices.size() < before) {
        info.warnings.push_back(sentence(counted(before - slices.size(), "duplicate slice"), " ignored"));
    }
}

/// Groups consecutive slices at equal positions.
std::vector<std::vector<Placed>> by_position(const std::vector<Placed>& slices)
{
    std::vector<std::vector<Placed>> positions;
    for (const Placed& slice : slices) {
        if (positions.empty() || slice.along - positions.back().front().along > SAME_PLACE_MM) positions.emplace_back();
        positions.back().push_back(slice);
    }
    for (std::vector<Placed>& here : positions)
        std::sort(here.begin(), here.end(),
                  [](const Placed& a, const Placed& b) { return number_of(a) < number_of(b); });
    return positions;
}

/// Number of slices that most positions have.
size_t usual_count(const std::vector<std::vector<Placed>>& positions)
{
    std::map<size_t, size_t> counts;
    for (const std::vector<Placed>& here : positions) ++counts[here.size()];
    return std::max_element(counts.begin(), counts.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
}

/// If some positions have repeated or missing slices, takes the first or the last slice at each position, as chosen.
void choose_repeated(const std::string& where, const OpenOptions& options, VolumeInfo& info,
                     const std::vector<std::vector<Placed>>& positions, std::vector<Placed>& slices)
{
    const size_t usual = usual_count(positions);
    const auto odd = std::find_if(positions.begin(), positions.end(),
                                  [&](const std::vector<Placed>& here) { return here.size() != usual; });
    const std::string found =
        sentence("holds ", counted(odd->size(), "slice"), " at ", with_digits(odd->front().along), " mm (",
                 odd->back().file->path.filename().string(), "), but ", usual, " at most other positions");
    if (options.frame != "first" && options.frame != "last") {
        Choice choice{"frame", {"first", "last"}, {"first at each position", "last at each position"}};
        throw ChoiceNeeded(sentence(where, ": ", found, "; expected frame \"first\" or \"last\", to take one at each"),
                           {std::move(choice)});
    }
    std::vector<Placed> chosen;
    for (const std::vector<Placed>& here : positions)
        chosen.push_back(options.frame == "first" ? here.front() : here.back());
    info.warnings.push_back(sentence(found, "; the ", options.frame, " slice at each position is read"));
    slices = std::move(chosen);
}

/// If there are several slices at each position, keeps those of one time point. If all slices state one position and no
/// times, keeps all of them and returns false: only the first slice's position is then meaningful.
bool choose_time(const std::string& where, const OpenOptions& options, VolumeInfo& info, std::vector<Placed>& slices)
{
    const std::vector<std::vector<Placed>> positions = by_position(slices);
    const auto time_of = [](const Placed& slice) {
        return std::pair(slice.frame->time_number, slice.file->time_number);
    };
    const bool has_times = std::any_of(slices.begin(), slices.end(),
                                       [&](const Placed& slice) { return time_of(slice) != time_of(slices.front()); });
    if (positions.size() == 1 && slices.size() > 1 && (!has_times || options.frame == "z")) {
        slices = positions.front();
        info.warnings.push_back(
            sentence("all ", slices.size(), " slices state one position; they are stacked in order"));
        return false;
    }
    const size_t times = positions.front().size();
    if (!std::all_of(positions.begin(), positions.end(), [&](const auto& here) { return here.size() == times; })) {
        choose_repeated(where, options, info, positions, slices);
        return true;
    }
    const auto chosen = size_t(chosen_frame(where, options, int64_t(times)));
    slices.clear();
    for (const std::vector<Placed>& here : positions) slices.push_back(here[chosen]);
    return true;
}

/// Returns the median distance between neighbouring slices; warns if there are other distances.
double find_distance(const std::vector<Placed>& slices, VolumeInfo& info)
{
    std::vector<double> distances;
    for (size_t i = 1; i < slices.size(); ++i) distances.push_back(slices[i].along - slices[i - 1].along);
    std::vector<double> sorted = distances;
    const auto middle = sorted.begin() + std::ptrdiff_t(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double usual = *middle;
    constexpr size_t MAX_WARNINGS = 4;
    size_t odd = 0;
    for (size_t i = 0; i < distances.size(); ++i) {
        if (std::abs(distances[i] - usual) <= SAME_DISTANCE * usual) continue;
        if (++odd > MAX_WARNINGS) continue;
        const double missing = std::round(distances[i] / usual) - 1.0;
        const bool are_missing = missing >= 1.0 && std::abs(distances[i] / usual - missing - 1.0) < 0.1;
        info.warnings.push_back(
            sentence("slices ", i + 1, " and ", i + 2, " (", slices[i].file->path.filename().string(), ", ",
                     slices[i + 1].file->path.filename().string(), ") are ", with_digits(distances[i]), " mm apart",
                     are_missing ? sentence(" (", counted(size_t(missing), "slice"), " missing)") : std::string(),
                     ", but most others are ", with_digits(usual), " mm apart; all are drawn at that distance"));
    }
    if (odd > MAX_WARNINGS) {
        info.warnings.push_back(
            sentence(counted(odd - MAX_WARNINGS, "further pair"), " of slices at an unusual distance"));
    }
    return usual;
}

/// Returns the step between slices. If the gantry was tilted, this step is not parallel to the slices' normal.
glm::dvec3 step_between(const std::vector<Placed>& slices, double distance, const glm::dvec3& normal)
{
    const glm::dvec3 way = *slices.back().frame->position - *slices.front().frame->position;
    const double height = glm::dot(way, normal);
    return height > 0.0 ? way * (distance / height) : normal * distance;
}

/// Warns of slices whose pixel spacing differs from the first slice's spacing, with which all slices are drawn.
void warn_of_spacings(const std::vector<Placed>& slices, VolumeInfo& info)
{
    constexpr double SAME_SPACING = 1e-4;
    const glm::dvec2 usual = *slices.front().frame->spacing;
    size_t others = 0;
    const Placed* odd = nullptr;
    for (const Placed& slice : slices) {
        const glm::dvec2 own = slice.frame->spacing.value_or(usual);
        if (glm::all(glm::lessThanEqual(glm::abs(own - usual), SAME_SPACING * usual))) continue;
        if (others++ == 0) odd = &slice;
    }
    if (odd == nullptr) return;
    const glm::dvec2 own = *odd->frame->spacing;
    info.warnings.push_back(sentence("Pixel Spacing changes within the series: ", counted(others, "slice"),
                                     ", the first of them ", odd->file->path.filename().string(), ", ",
                                     others == 1 ? "states " : "state ", own.y, " x ", own.x, " mm, the first slice ",
                                     usual.y, " x ", usual.x, " mm, and all are drawn with that"));
}

/// Returns the step along the normal between slices that state no positions, from their stated distance or thickness.
glm::dvec3 stated_step(const std::vector<Placed>& slices, const glm::dvec3& normal, VolumeInfo& info)
{
    const DicomFrame& frame = *slices[0].frame;
    if (!frame.distance) {
        info.warnings.push_back(
            sentence("the distance between slices is not stated; ", frame.spacing->x, " mm is assumed, as along x"));
        return normal * frame.spacing->x;
    }
    if (slices.size() > 1) {
        info.warnings.push_back(sentence("slices are taken to be ", std::abs(*frame.distance),
                                         " mm apart, the spacing or thickness that the file states"));
    }
    return normal * std::abs(*frame.distance);
}

void describe_space(std::vector<Placed>& slices, bool are_placed, VolumeInfo& info)
{
    const DicomFile& file = *slices[0].file;
    const glm::dvec3 normal = glm::cross(slices[0].frame->along_x, slices[0].frame->along_y);
    if (!slices[0].frame->spacing) return apply_spacing(info, {}, {}, "mm");
    if (file.spacing_is_at_detector) {
        info.warnings.emplace_back("the spacing within slices is that at the detector; in the object it is smaller");
    }
    warn_of_spacings(slices, info);
    glm::dvec3 step{0.0}, origin = slices[0].frame->position.value_or(glm::dvec3(0.0));
    if (are_placed && slices.size() > 1) {
        step = step_between(slices, find_distance(slices, info), normal);
    } else {
        step = stated_step(slices, normal, info);
        if (slices[0].frame->distance.value_or(0.0) < 0.0) {
            origin -= step * double(slices.size() - 1);
            std::reverse(slices.begin(), slices.end());
        }
    }
    const DicomFrame& frame = *slices[0].frame;
    const glm::dmat3 steps(frame.along_x * frame.spacing->x, frame.along_y * frame.spacing->y, step);
    apply_spacing(info, place(info, steps, origin, frame.has_orientation ? "LPS" : ""), "mm", "mm");
    if (file.tilt_degrees != 0.0) {
        info.warnings.push_back(sentence("the gantry was tilted by ", with_digits(file.tilt_degrees), " degrees"));
    }
}

}  // namespace

std::vector<DicomFile> choose_series(const std::string& where, std::vector<DicomFile> files, const OpenOptions& options)
{
    std::map<std::pair<int64_t, std::string>, std::vector<size_t>> series;
    for (size_t i = 0; i < files.size(); ++i) series[{files[i].series_number, files[i].series_uid}].push_back(i);

    std::string choices;
    Choice choice{"channel", {}};
    std::vector<const std::vector<size_t>*> chosen;
    int64_t number = 0;
    for (const auto& [key, members] : series) {
        const DicomFile& first = files[members[0]];
        size_t slices = 0;
        for (const size_t member : members) slices += files[member].frames.size();
        ++number;
        choices += sentence(number == 1 ? "" : ", ", number, " ", in_quotes(first.series_description), " (", slices,
                            " slices)");
        choice.values.push_back(std::to_string(number));
        choice.titles.push_back(sentence(number, "  ", first.series_description, " (", slices, " slices)"));
        const bool is_chosen = options.channel.empty() ? series.size() == 1
                                                       : options.channel == std::to_string(number) ||
                                                             options.channel == first.series_description ||
                                                             options.channel == first.series_uid;
        if (is_chosen) chosen.push_back(&members);
    }
    if (chosen.size() != 1) {
        const std::string found = options.channel.empty() ? sentence("holds ", series.size(), " series")
                                                          : sentence("channel is ", in_quotes(options.channel));
        throw ChoiceNeeded(
            sentence(where, ": ", found, "; expected a channel, the number or the description of one of: ", choices),
            {std::move(choice)});
    }
    std::vector<DicomFile> members;
    for (const size_t member : *chosen[0]) members.push_back(std::move(files[member]));
    return members;
}

DicomVolume arrange_slices(const std::string& where, const std::vector<DicomFile>& files, const OpenOptions& options)
{
    DicomVolume volume;
    OpenOptions of_time = options;
    std::vector<Placed> slices = slices_of_one_kind(choose_stack(where, files, of_time), volume.info);
    bool are_placed = sort_slices(slices, volume.info);
    leave_out_copies(slices, volume.info);
    if (are_placed) are_placed = choose_time(where, of_time, volume.info, slices);
    volume.info.size = {slices[0].file->columns, slices[0].file->rows, int64_t(slices.size())};
    describe_space(slices, are_placed, volume.info);
    for (const Placed& slice : slices) volume.slices.push_back(slice.slice);
    return volume;
}

std::string counted(size_t number, const char* thing)
{
    return sentence(number, " ", thing, number == 1 ? "" : "s");
}

}  // namespace shvr
