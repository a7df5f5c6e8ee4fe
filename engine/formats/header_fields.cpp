#include "engine/formats/header_fields.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/volume/grid.h"
#include "engine/volume/unit.h"

namespace shvr {
namespace {}  // namespace

std::string read_head(const std::filesystem::path& path, size_t max_bytes)
{
    // Without O_NONBLOCK, opening a FIFO would block until a writer appears, before it can be recognised as a FIFO.
    const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!file) fail(path.string(), ": cannot be opened: ", reason_of(errno));
    struct stat status {};
    if (::fstat(file.number(), &status) != 0) fail(path.string(), ": cannot be examined: ", reason_of(errno));
    if (!S_ISREG(status.st_mode)) {
        fail(path.string(), ": is ", S_ISDIR(status.st_mode) ? "a folder" : "a pipe or device", "; expected a file");
    }
    std::string head(std::min(max_bytes, size_t(status.st_size)), '\0');
    size_t done = 0;
    while (done < head.size()) {
        const ssize_t count = ::read(file.number(), head.data() + done, head.size() - done);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path.string(), ": cannot be read: ", reason_of(errno));
        if (count == 0) break;
        done += size_t(count);
    }
    head.resize(done);
    return head;
}

void HeaderFields::add(std::string_view name, std::string_view value)
{
    const std::string plain(trimmed(name));
    if (!values_.emplace(lower_case(plain), std::string(trimmed(value))).second) {
        fail(path_.string(), ": ", in_quotes(plain), " is stated twice; expected once");
    }
}

const std::string* HeaderFields::find(const char* name) const
{
    const auto found = values_.find(lower_case(name));
    return found == values_.end() ? nullptr : &found->second;
}

const std::string& HeaderFields::required(const char* name, const char* expected) const
{
    const std::string* value = find(name);
    if (value == nullptr) fail(path_.string(), ": ", name, " is missing; expected ", expected);
    return *value;
}

void HeaderFields::refuse(const char* name, const std::string& expected) const
{
    const std::string* value = find(name);
    fail(path_.string(), ": ", name, " is ", value == nullptr ? std::string("missing") : in_quotes(*value),
         "; expected ", expected);
}

int64_t HeaderFields::whole(const char* name, int64_t fallback, int64_t lower, int64_t upper) const
{
    const std::string* value = find(name);
    if (value == nullptr) return fallback;
    const std::optional<int64_t> number = whole_of(*value);
    if (!number || *number < lower || *number > upper) {
        refuse(name, lower == upper ? sentence(lower) : sentence("a whole number from ", lower, " to ", upper));
    }
    return *number;
}

std::vector<double> HeaderFields::numbers(const char* name, size_t count) const
{
    std::vector<double> numbers;
    for (const std::string_view word : words_of(required(name, "numbers"))) {
        const std::optional<double> number = number_of(word);
        if (!number) refuse(name, sentence(count, " numbers"));
        numbers.push_back(*number);
    }
    if (numbers.size() != count) refuse(name, sentence(count, " numbers"));
    return numbers;
}

Size3 HeaderFields::size(const char* name) const
{
    const std::vector<int64_t> sides = sizes(name, 3);
    return {sides[0], sides[1], sides[2]};
}

std::vector<int64_t> HeaderFields::sizes(const char* name, size_t count) const
{
    const std::string expected =
        sentence(count == 3 ? "three" : std::to_string(count), " whole numbers from 1 to ", MAX_SIDE);
    std::vector<int64_t> sides;
    for (const std::string_view word : words_of(required(name, expected.c_str()))) {
        const std::optional<int64_t> side = whole_of(word);
        if (!side || *side < 1 || *side > MAX_SIDE) refuse(name, expected);
        sides.push_back(*side);
    }
    if (sides.size() != count) refuse(name, expected);
    return sides;
}

VoxelType HeaderFields::type(const char* name) const
{
    constexpr const char* EXPECTED = "integers of 8, 16 or 32 bits, signed or unsigned, or floats of 32 or 64 bits";
    const std::optional<VoxelType> type = voxel_type_of(required(name, EXPECTED));
    if (!type) refuse(name, EXPECTED);
    return *type;
}

std::pair<VoxelType, StoredNumber> HeaderFields::type_or_wide(const char* name) const
{
    constexpr const char* EXPECTED = "integers of 8, 16, 32 or 64 bits, signed or unsigned, or floats of 32 or 64 bits";
    const std::string& stated = required(name, EXPECTED);
    if (const auto type = voxel_type_of(stated)) return {*type, StoredNumber::plain};
    const std::optional<StoredNumber> number = wide_integer_of(stated);
    if (!number) refuse(name, EXPECTED);
    return {bits_type(*number), *number};
}

bool HeaderFields::flag(const char* name, bool fallback) const
{
    const std::string* value = find(name);
    if (value == nullptr) return fallback;
    const std::string lower = lower_case(*value);
    if (lower == "true" || lower == "t" || lower == "1") return true;
    if (lower == "false" || lower == "f" || lower == "0") return false;
    refuse(name, "True or False");
}

glm::dvec3 HeaderFields::spacing(const char* name) const
{
    const std::vector<double> numbers = this->numbers(name, 3);
    const bool valid =
        std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n) && n > 0.0; });
    if (!valid) refuse(name, "3 finite numbers above 0");
    return {numbers[0], numbers[1], numbers[2]};
}

std::filesystem::path HeaderFields::data_file(const char* name) const
{
    const std::string& stated = required(name, "the name of the file that holds the voxels");
    if (stated.empty() || has_controls(stated)) refuse(name, "the name of a file");
    return file_stated(path_, stated);
}

std::filesystem::path file_stated(const std::filesystem::path& header, const std::string& stated)
{
    std::filesystem::path file = header.parent_path() / stated;
    std::error_code ignored;
    const size_t separator = stated.find_last_of("/\\");
    if (separator == std::string::npos || std::filesystem::exists(file, ignored)) return file;
    const std::filesystem::path beside = header.parent_path() / stated.substr(separator + 1);
    return std::filesystem::is_regular_file(beside, ignored) ? beside : file;
}

void apply_spacing(VolumeInfo& info, const std::optional<glm::dvec3>& spacing, const std::optional<std::string>& unit,
                   const char* usual_unit)
{
    if (!spacing) {
        info.spacing = glm::dvec3(1.0);
        info.unit = "voxel";
        info.spacing_from = info.unit_from = Provenance::assumed;
        info.warnings.emplace_back("no spacing stated; 1 voxel assumed");
        return;
    }
    info.spacing = *spacing;
    info.spacing_from = Provenance::file;
    if (unit && !unit->empty()) {
        info.unit = plain_unit(*unit);
        info.unit_from = Provenance::file;
        return;
    }
    info.unit = info.spacing == glm::dvec3(1.0) ? "voxel" : usual_unit;
    info.warnings.push_back(sentence("spacing is stated without a unit; ", info.unit, " assumed"));
}

void warn_of_labels(std::vector<std::string>& warnings, const char* holds)
{
    constexpr const char* ADVICE = ": pictures blend neighbours, and imports need --labels";
    const auto says_so = [&](const std::string& warning) { return warning.ends_with(ADVICE); };
    if (std::ranges::none_of(warnings, says_so)) warnings.push_back(std::string(holds) + ADVICE);
}

void warn_of_content(std::vector<std::string>& warnings, std::string_view content)
{
    if (content == "mask") warn_of_labels(warnings, "the file holds groups of a mask, not a scan");
    if (content == "offsets") warnings.emplace_back("the file holds density offsets, not a scan");
}

}  // namespace shvr
