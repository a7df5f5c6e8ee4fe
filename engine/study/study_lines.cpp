#include "engine/study/study_lines.h"

#include <cmath>
#include <limits>

#include "engine/base/file.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

constexpr int64_t MAX_STUDY_BYTES = int64_t(1) << 28;  // a million rows
constexpr const char* REMAKE = "; delete the line or the file, and `shvr study` makes its rows again";

std::vector<std::string_view> fields_in(std::string_view line)
{
    std::vector<std::string_view> fields;
    for (size_t comma = 0; comma != line.npos; line = comma == line.npos ? line : line.substr(comma + 1)) {
        comma = line.find(',');
        fields.push_back(line.substr(0, comma));
    }
    return fields;
}

}  // namespace

void StudyLine::refuse(size_t field, std::string_view expected) const
{
    fail(place, ", column ", names[field], ": ", in_quotes(fields[field]), " is not ", expected, REMAKE);
}

double StudyLine::number(size_t field) const
{
    const std::optional<double> number = number_of(fields[field]);
    if (!number || !std::isfinite(*number)) refuse(field, "a finite number");
    return *number;
}

double StudyLine::number_or_nan(size_t field) const
{
    return fields[field].empty() ? std::numeric_limits<double>::quiet_NaN() : number(field);
}

uint32_t StudyLine::whole(size_t field) const
{
    const std::optional<int64_t> number = whole_of(fields[field]);
    if (!number || *number < 0 || *number > std::numeric_limits<uint32_t>::max())
        refuse(field, "a whole number from 0 to 4294967295");
    return uint32_t(*number);
}

StudyCondition StudyLine::condition() const
{
    return {.task = spelled_value<StudyTask>(0),
            .touch = spelled_value<StudyTouch>(1),
            .law = spelled_value<ProxyLaw>(2),
            .probe_radii = number(3),
            .noise = number(4)};
}

std::string study_header(std::span<const std::string_view> names)
{
    std::string line;
    for (const std::string_view name : names) line.append(name).append(",");
    line.back() = '\n';
    return line;
}

void read_study_lines(const std::filesystem::path& file, std::span<const std::string_view> names,
                      const std::function<void(const StudyLine&)>& take)
{
    const std::string text = read_text(file, MAX_STUDY_BYTES);
    std::string_view rest = text;
    const std::string_view found = take_line(rest);
    const std::string header = study_header(names), expected = header.substr(0, header.size() - 1);
    if (found != expected)
        fail(file.string(), ": line 1 is ", in_quotes(found), ", not the header of this file of a study, ",
             in_quotes(expected), REMAKE);
    for (size_t number = 2; !rest.empty(); ++number) {
        const StudyLine line{
            .place = sentence(file.string(), ": line ", number), .names = names, .fields = fields_in(take_line(rest))};
        if (line.fields.size() != names.size())
            fail(line.place, " has ", line.fields.size(), " fields, not ", names.size(), REMAKE);
        take(line);
    }
}

}  // namespace shvr
