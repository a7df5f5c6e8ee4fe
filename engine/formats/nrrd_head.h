#pragma once
// The header of an NRRD file as its lines (http://teem.sourceforge.net/nrrd/format.html), and the segments that 3D
// Slicer describes in it, so that a program that replaces the file can keep the fields that it does not understand. Any
// thread.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shvr {

struct NrrdPair {
    std::string key, value;
    bool operator==(const NrrdPair&) const = default;
};

struct NrrdHead {
    int version = 4;                      ///< 1 to 6
    std::vector<std::string> comments{};  ///< with their '#'
    std::vector<NrrdPair> fields{};       ///< "field: value"; names in lower case
    std::vector<NrrdPair> pairs{};        ///< "key:=value", unescaped
};

/// Null if there is no such file, or it is not NRRD. Lines that are neither are left out.
std::optional<NrrdHead> read_nrrd_head(const std::filesystem::path& path);
/// "key:=value", escaped.
std::string spelled(const NrrdPair& pair);
/// Sets the value of a key, or adds it at the end.
void set_pair(std::vector<NrrdPair>& pairs, std::string_view key, std::string value);

/// A segment: "Segment3_Name", "Segment3_LabelValue" and so on.
struct NrrdSegment {
    int64_t number = 0;       ///< 3
    int64_t label_value = 0;  ///< value of its voxels in its layer; unstated: one more than its number
    int64_t layer = 0;        ///< overlapping segments lie in several layers, the first axis of the file
    /// Group of its voxels in a mask: its label value; if a segment of another layer has that too, the next free one
    /// above all label values.
    int64_t group = 0;
    std::string name{};
    std::string color{};  ///< "0.5 0.68 0.5": shares of sRGB; empty: not stated
};
/// In the order of their first key.
std::vector<NrrdSegment> segments_of(const NrrdHead& head);

}  // namespace shvr
