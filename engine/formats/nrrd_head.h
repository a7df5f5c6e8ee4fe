#pragma once
// Reads the header of an NRRD file line by line (http://teem.sourceforge.net/nrrd/format.html), and the segments that
// 3D Slicer describes in it. A program that replaces the file can thus keep the fields that it does not understand. Any
// thread may call these.

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
    bool operator==(const NrrdHead&) const = default;
};

/// Returns null if the file does not exist or is not NRRD. Lines that are no comments, fields or pairs are left out.
std::optional<NrrdHead> read_nrrd_head(const std::filesystem::path& path);
/// Returns the header at the start of a text; null if it is not NRRD.
std::optional<NrrdHead> nrrd_head_in(std::string_view text);
/// Returns lines from which `nrrd_head_in` reads an equal header.
std::vector<std::string> lines_of(const NrrdHead& head);
/// "key:=value", escaped.
std::string spelled(const NrrdPair& pair);
/// Sets the value of a key, or appends the pair if the key is missing.
void set_pair(std::vector<NrrdPair>& pairs, std::string_view key, std::string value);

/// A segment: "Segment3_Name", "Segment3_LabelValue" and so on.
struct NrrdSegment {
    int64_t number = 0;       ///< 3
    int64_t label_value = 0;  ///< value of the segment's voxels in its layer; default: `number` + 1
    int64_t layer = 0;        ///< index along the file's first axis; overlapping segments lie in different layers
    /// The group that holds the segment's voxels in a mask: its label value or, if a segment of another layer has the
    /// same label value, the next free number above all label values.
    int64_t group = 0;
    std::string name{};
    std::string color{};  ///< "0.5 0.68 0.5": sRGB components; empty if not stated
};
/// Returns the segments in the order in which their first keys appear in the header.
std::vector<NrrdSegment> segments_of(const NrrdHead& head);
/// Returns the key/value pairs of a segment, without the prefix "Segment3_" in their keys.
std::vector<NrrdPair> pairs_of(const NrrdHead& head, const NrrdSegment& segment);
std::string segment_key(const NrrdSegment& segment, std::string_view name);

}  // namespace shvr
