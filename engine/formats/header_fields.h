#pragma once
// Functions shared by the readers of text headers: the start of a file, fields by name, spacing and unit. Each error is
// one sentence with the file, the field, the value found and the value expected. Any thread may call these.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/text.h"
#include "engine/formats/stored_numbers.h"
#include "engine/volume/volume.h"

namespace shvr {

/// The maximum length of a header.
inline constexpr size_t MAX_HEADER_BYTES = size_t{1} << 20;

/// Returns the first bytes of a file, at most `max_bytes`. Fails if `path` is not a regular file or cannot be read.
std::string read_head(const std::filesystem::path& path, size_t max_bytes = MAX_HEADER_BYTES);

/// The fields of one header. Names are case-insensitive.
class HeaderFields {
public:
    explicit HeaderFields(std::filesystem::path path) : path_(std::move(path)) {}

    const std::filesystem::path& path() const { return path_; }
    /// Fails if the field exists already.
    void add(std::string_view name, std::string_view value);

    bool has(const char* name) const { return find(name) != nullptr; }
    const std::string* find(const char* name) const;
    const std::string& required(const char* name, const char* expected) const;
    [[noreturn]] void refuse(const char* name, const std::string& expected) const;

    int64_t whole(const char* name, int64_t fallback, int64_t lower, int64_t upper) const;
    std::vector<double> numbers(const char* name, size_t count) const;
    Size3 size(const char* name) const;                                ///< required, each 1 ... 2^20
    std::vector<int64_t> sizes(const char* name, size_t count) const;  ///< like `size`, for `count` axes
    VoxelType type(const char* name) const;                            ///< required
    /// Like `type`, but allows 64-bit integers: returns the type for reading their bits, and their kind.
    std::pair<VoxelType, StoredNumber> type_or_wide(const char* name) const;
    bool flag(const char* name, bool fallback) const;
    glm::dvec3 spacing(const char* name) const;  ///< three numbers, finite and above 0

    /// Returns the path of the voxel file that the header names (see `file_stated`).
    std::filesystem::path data_file(const char* name) const;

private:
    std::filesystem::path path_;
    std::map<std::string, std::string> values_;
};

/// Returns the file that a header names, either absolutely or relative to the header's folder. Headers are often moved
/// together with their data, even between operating systems: if the named file does not exist, a file of the same name
/// in the header's folder is used instead. `stated` may be a Windows path.
std::filesystem::path file_stated(const std::filesystem::path& header, const std::string& stated);

/// Sets spacing and unit of `info`, and adds a warning for each that the file does not state. A spacing without a unit
/// is assumed to be in `usual_unit`, but in voxels if it is 1 1 1.
void apply_spacing(VolumeInfo& info, const std::optional<glm::dvec3>& spacing, const std::optional<std::string>& unit,
                   const char* usual_unit);

/// Warns that a file opened as a scan holds labels. The warning begins with `holds`, as in "the image holds labels".
/// Does nothing if `warnings` already says so, as in a project, which keeps the warnings of its source.
void warn_of_labels(std::vector<std::string>& warnings, const char* holds);
/// Likewise for files written by this program, whose header names their content: warns if it is "mask" or "offsets".
void warn_of_content(std::vector<std::string>& warnings, std::string_view content);

inline constexpr const char* NO_BYTE_ORDER = "no byte order stated; little-endian assumed";

}  // namespace shvr
