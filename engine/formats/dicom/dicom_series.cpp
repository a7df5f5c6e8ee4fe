#include "engine/formats/dicom/dicom_series.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "engine/base/error.h"
#include "engine/formats/choice.h"
#include "engine/formats/data_files.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/orientation.h"

namespace shvr {
namespace {

/// Positions closer than this count as equal: files state them with about six digits.
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

/// Size, type and direction of a slice: slices with equal ones can be stacked.
using Kind = std::tuple<int64_t, int64_t, int, std::array<int64_t, 6>>;

Kind kind_of(const DicomFile& file, const DicomFrame& frame)
{
    std::array<int64_t, 6> direction{};
    for (int i = 0; i < 3; ++i) {
        direction[size_t(i)] = std::llround(frame.along_x[i] * 1000.0);
        direction[size_t(i) + 3] = std::llround(frame.along_y[i] * 1000.0);
    }
    return {file.columns, file.rows, int(file.type), direction};
}

/// The slices of the most frequent kind; leaves out, for example, a scout image next to an axial series.
std::vector<Placed> slices_of_one_kind(const std::vector<DicomFile>& files, VolumeInfo& info)
{
    std::map<Kind, std::vector<Placed>> kinds;
    size_t count = 0;
    for (size_t i = 0; i < files.size(); ++i) {
        for (size_t j = 0; j < files[i].frames.size(); ++j, ++count) {
            const DicomFrame& frame = files[i].frames[j];
            kinds[kind_of(files[i], frame)].push_back({{i, j}, 0.0, &files[i], &frame});
        }
    }
    const auto most = std::max_element(kinds.begin(), kinds.end(),
                                       [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    if (const size_t others = count - most->second.size(); others > 0) {
        info.warnings.push_back(sentence(counted(others, "slice"), " of another size, type or direction ignored"));
    }
    return std::move(most->second);
}

/// Sorts along the normal, or by slice numbers if files do not state positions. Returns whether they do.
bool sort_slices(std::vector<Placed>& slices, VolumeInfo& info)
{
    const bool are_placed = std::all_of(slices.begin(), slices.end(), [](const Placed& slice) {
        return slice.frame->position.has_value() && slice.frame->has_orientation;
    });
    const glm::dvec3 normal = glm::cross(slices[0].frame->along_x, slices[0].frame->along_y);
    for (Placed& slice : slices) {
        if (are_placed) slice.along = glm::dot(*slice.frame->position, normal);
    }
    const auto number = [](const Placed& slice) {
        return std::tuple(slice.file->time_number, slice.file->instance_number, slice.slice.file, slice.slice.frame);
    };
    std::sort(slices.begin(), slices.end(), [&](const Placed& a, const Placed& b) {
        return a.along != b.along ? a.along < b.along : number(a) < number(b);
    });
    if (!are_placed && slices.size() > 1) {
        info.warnings.emplace_back("slices do not state their positions; they are sorted by instance number");
    }
    return are_placed;
}

/// Removes duplicate files, which are common in exports.
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

/// If there are several slices at each position, keeps those of one time point.
void choose_time(const std::string& where, const OpenOptions& options, std::vector<Placed>& slices)
{
    std::vector<size_t> begins;  // of positions
    for (size_t i = 0; i < slices.size(); ++i) {
        if (i == 0 || slices[i].along - slices[begins.back()].along > SAME_PLACE_MM) begins.push_back(i);
    }
    const size_t times = slices.size() / begins.size();
    for (size_t i = 0; i < begins.size(); ++i) {
        if (begins[i] == i * times && slices.size() == begins.size() * times) continue;
        fail(where, ": holds ", slices.size(), " slices at ", begins.size(),
             " positions, but more or fewer than usual at ", with_digits(slices[begins[i]].along),
             " mm; expected equally many at each position");
    }
    const auto chosen = size_t(chosen_frame(where, options, int64_t(times)));
    std::vector<Placed> of_time;
    for (const size_t begin : begins) {
        std::vector<Placed> here(slices.begin() + std::ptrdiff_t(begin),
                                 slices.begin() + std::ptrdiff_t(begin + times));
        std::sort(here.begin(), here.end(), [](const Placed& a, const Placed& b) {
            return std::tuple(a.file->time_number, a.file->instance_number, a.slice.file, a.slice.frame) <
                   std::tuple(b.file->time_number, b.file->instance_number, b.slice.file, b.slice.frame);
        });
        of_time.push_back(here[chosen]);
    }
    slices = std::move(of_time);
}

/// The most frequent distance between slices, with a warning about others.
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

/// The step from slice to slice. Their first pixels need not be aligned: gantries tilt.
glm::dvec3 step_between(const std::vector<Placed>& slices, double distance, const glm::dvec3& normal)
{
    const glm::dvec3 way = *slices.back().frame->position - *slices.front().frame->position;
    const double height = glm::dot(way, normal);
    return height > 0.0 ? way * (distance / height) : normal * distance;
}

void describe_space(const std::vector<Placed>& slices, bool are_placed, VolumeInfo& info)
{
    const DicomFile& file = *slices[0].file;
    const DicomFrame& frame = *slices[0].frame;
    const glm::dvec3 normal = glm::cross(frame.along_x, frame.along_y);
    if (!frame.spacing) return apply_spacing(info, {}, {}, "mm");
    if (file.spacing_is_at_detector) {
        info.warnings.emplace_back("the spacing within slices is that at the detector; in the object it is smaller");
    }
    glm::dvec3 step = normal * frame.spacing->x;
    if (are_placed && slices.size() > 1) {
        step = step_between(slices, find_distance(slices, info), normal);
    } else if (file.distance) {
        step = normal * *file.distance;
        if (slices.size() > 1) {
            info.warnings.push_back(sentence("slices are taken to be ", *file.distance,
                                             " mm apart, the spacing or thickness that the file states"));
        }
    } else {
        info.warnings.push_back(
            sentence("the distance between slices is not stated; ", frame.spacing->x, " mm is assumed, as along x"));
    }
    const glm::dmat3 steps(frame.along_x * frame.spacing->x, frame.along_y * frame.spacing->y, step);
    const glm::dvec3 origin = frame.position.value_or(glm::dvec3(0.0));
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
    std::vector<Placed> slices = slices_of_one_kind(files, volume.info);
    const bool are_placed = sort_slices(slices, volume.info);
    leave_out_copies(slices, volume.info);
    if (are_placed) choose_time(where, options, slices);
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
