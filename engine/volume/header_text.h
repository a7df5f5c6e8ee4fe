#pragma once
// What the readers of text headers share: the head of a file, fields by name, numbers read strictly, spacing and unit.
// Every refusal is one sentence: file, field, value found, value expected. Headers come from strangers: what is quoted
// is cut short and freed of control characters. Any thread may call these.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/volume/volume.h"

namespace shvr {

/// No header is longer.
inline constexpr size_t LONGEST_HEADER = size_t{1} << 20;

/// The first bytes of a file, at most `max_bytes`. Fails where it is no regular file or cannot be read.
std::string read_head(const std::filesystem::path& path, size_t max_bytes = LONGEST_HEADER);

std::string_view trimmed(std::string_view text);
std::string lower_case(std::string_view text);
std::vector<std::string_view> words_of(std::string_view text);
/// Whether it would change what a terminal does. No name of a file that a header states has such characters.
bool has_controls(std::string_view text);
/// With a question mark for each such character.
std::string printable(std::string_view text);
/// For messages: in quotes, at most 60 characters, no control characters.
std::string in_quotes(std::string_view text);
/// The text up to the next line end, which is taken off `rest` as well; "\r\n" counts as one.
std::string_view take_line(std::string_view& rest);

std::optional<int64_t> whole_of(std::string_view word);
std::optional<double> number_of(std::string_view word);  ///< may be NaN or infinite

/// The shortest digits that are read back as the same number.
std::string digits_of(double value);
std::string digits_of(const glm::dvec3& value);  ///< with spaces between
std::string digits_of(const Size3& value);

/// "micron", "µm", "micrometer" -> "um"; what is unknown stays as it is, but for control characters, and is cut at 60.
std::string plain_unit(std::string_view unit);

/// The fields of one header. Names are matched without regard to case.
class HeaderFields {
public:
    explicit HeaderFields(std::filesystem::path path) : path_(std::move(path)) {}

    const std::filesystem::path& path() const { return path_; }
    /// Fails where the field is there already.
    void add(std::string_view name, std::string_view value);

    bool has(const char* name) const { return find(name) != nullptr; }
    const std::string* find(const char* name) const;
    const std::string& required(const char* name, const char* expected) const;
    [[noreturn]] void refuse(const char* name, const std::string& expected) const;

    int64_t whole(const char* name, int64_t fallback, int64_t lower, int64_t upper) const;
    std::vector<double> numbers(const char* name, size_t count) const;
    Size3 size(const char* name) const;                                ///< required, each 1 ... 2^20
    std::vector<int64_t> sizes(const char* name, size_t count) const;  ///< as `size`, of `count` axes
    VoxelType type(const char* name) const;                            ///< required
    bool flag(const char* name, bool fallback) const;
    glm::dvec3 spacing(const char* name) const;  ///< three numbers, finite and above 0

    /// Where the header says its voxels are: relative to the header's folder, or absolute.
    std::filesystem::path data_file(const char* name) const;

private:
    std::filesystem::path path_;
    std::map<std::string, std::string> values_;
};

/// Puts spacing and unit into `info`, with a warning for each that is not stated. A spacing without a unit is taken as
/// `usual_unit`, unless it is 1 1 1, which means voxels.
void apply_spacing(VolumeInfo& info, const std::optional<glm::dvec3>& spacing, const std::optional<std::string>& unit,
                   const char* usual_unit);

inline constexpr const char* NO_BYTE_ORDER = "no byte order stated; little-endian assumed";

}  // namespace shvr
